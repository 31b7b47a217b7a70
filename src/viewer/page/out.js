// out.js: what leaves the viewer: pictures, recipe, tables, a link, the command line.
import { el, button } from './dom.js';
import { link } from './link.js';

export class Out {
    constructor(app, drawers, bookmarks, dialog) {
        this.app = app;
        this.dialog = dialog;
        this.bookmarks = bookmarks;
        this.command = el('textarea', { class: 'command', readonly: true, rows: 5, 'aria-label': 'Command line' });
        const pane = () => Math.max(app.editing, 0);
        drawers.add(
            'Out',
            'right',
            el(
                'div',
                { class: 'body' },
                el('h3', { text: 'Picture' }),
                el(
                    'div',
                    { class: 'tools' },
                    button('Save PNG', () => app.save('png', { pane: pane() })),
                    button('Save EXR', () => app.save('exr', { pane: pane() }), { title: 'linear, cd/m²' }),
                ),
                el('h3', { text: 'View' }),
                el(
                    'div',
                    { class: 'tools' },
                    button('Save recipe', () => app.save('recipe', { cameras: bookmarks.cameras() }), {
                        title: 'a file for every nocturne command',
                    }),
                    button('Copy link', () => this.copyLink(), { title: 'it restores this view' }),
                ),
                el('h3', { text: 'The same by command' }),
                this.command,
                el(
                    'div',
                    { class: 'tools' },
                    button('Copy command', () => this.copy('Command line', this.app.state?.command ?? '')),
                ),
            ),
            'U',
        );
        app.on('state', (state) => (this.command.value = state.command ?? ''));
        app.on('file', (file) => this.#download(file));
        app.on('copy', (what, text) => this.copy(what, text));
    }

    copyLink() {
        const hash = link(this.app, this.bookmarks);
        history.replaceState(null, '', hash);
        this.copy('Link', location.href);
    }

    // Into the clipboard, where the browser lets it; else shown, to be copied by hand.
    async copy(what, text) {
        try {
            await navigator.clipboard.writeText(text);
            this.app.emit('note', 'info', `${what} copied.`);
        } catch {
            const box = el('textarea', { readonly: true, rows: 6, 'aria-label': what });
            box.value = text;
            this.dialog.replaceChildren(
                el('h2', { id: 'text-title', text: what }),
                box,
                button('Close', () => this.dialog.close()),
            );
            this.dialog.showModal();
            box.select();
        }
    }

    #download({ name, body, frames }) {
        const url = URL.createObjectURL(new Blob([body]));
        const anchor = el('a', { href: url, download: name.replaceAll(/[/\\]/g, '_') || 'nocturne' });
        anchor.click();
        setTimeout(() => URL.revokeObjectURL(url), 10000);
        this.app.emit('note', 'info', `${anchor.download} saved${frames ? this.#mean(frames) : '.'}`);
    }

    #mean(frames) {
        const last = Number(this.app.values().frames) || Infinity;
        const more = frames < last ? ' Saved later it has more of them, and less noise.' : '';
        return `: the mean of ${frames} ${frames === 1 ? 'frame' : 'frames'}.${more}`;
    }
}
