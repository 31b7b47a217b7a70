// places.js: cameras to go to: those of the program, bookmarks of this browser, and a path along them.
import { el, button } from './dom.js';
import { along, isCamera } from './camera.js';

const MOST = 64; // bookmarks: as many as a recipe is told
const LONGEST = 60; // characters of a name

export class Places {
    bookmarks = []; // { name, eye, target, fov }
    #playing = 0;

    constructor(app, drawers, finder) {
        this.app = app;
        this.drawers = drawers;
        this.finder = finder;
        this.named = el('div', { class: 'tools', role: 'group', 'aria-label': 'Views of the city' });
        this.list = el('ol', { class: 'bookmarks' });
        this.name = el('input', {
            type: 'text',
            placeholder: 'name',
            maxlength: LONGEST,
            'aria-label': 'Name of the bookmark',
        });
        const add = el(
            'form',
            { class: 'tools', on: { submit: (event) => (event.preventDefault(), this.add()) } },
            this.name,
            el('button', { type: 'submit', text: 'Add bookmark' }),
        );
        this.play = button('Play', () => this.toggle(), { 'aria-pressed': 'false', disabled: true });
        this.seconds = el('input', {
            type: 'number',
            min: 0.5,
            max: 120,
            step: 0.5,
            value: 4,
            'aria-label': 'Seconds from one to the next',
        });
        this.loop = el('input', { type: 'checkbox' });
        drawers.add(
            'Places',
            'right',
            el(
                'div',
                { class: 'body' },
                finder.root,
                el('h3', { text: 'Views of the city' }),
                this.named,
                el('h3', { text: 'Bookmarks' }),
                add,
                this.list,
                el('h3', { text: 'Path along the bookmarks' }),
                el(
                    'div',
                    { class: 'tools' },
                    this.play,
                    el('label', {}, this.seconds, ' s each'),
                    el('label', {}, this.loop, ' loop'),
                ),
            ),
            'B',
        );
        app.on('welcome', () => this.#welcome());
        document.addEventListener('pointerdown', (event) => event.target.closest?.('#stage') && this.stop());
    }

    find() {
        this.drawers.show('Places', false);
        this.finder.field.focus();
    }

    cameras() {
        return this.bookmarks;
    }

    take(bookmarks) {
        const whole = (one) => typeof one?.name === 'string' && isCamera(one);
        const name = (text) => text.replaceAll(/[\p{Cc}\p{Cs}]/gu, '').slice(0, LONGEST) || 'place';
        for (const one of (Array.isArray(bookmarks) ? bookmarks : []).filter(whole))
            if (this.bookmarks.length < MOST && !this.bookmarks.some((own) => own.name === name(one.name)))
                this.bookmarks.push({ name: name(one.name), eye: one.eye, target: one.target, fov: one.fov });
        this.#told();
    }

    add() {
        const camera = this.app.camera;
        if (!camera || this.bookmarks.length >= MOST) return;
        const name = this.#free(this.name.value.trim() || 'place');
        this.bookmarks.push({ name, eye: camera.eye, target: camera.target, fov: camera.fov });
        this.name.value = '';
        this.#told();
        this.app.emit('note', 'info', `Bookmark “${name}” added.`);
    }

    #free(name) {
        let free = name;
        for (let i = 2; this.bookmarks.some((one) => one.name === free); i++) free = `${name} ${i}`;
        return free;
    }

    get #key() {
        return `nocturne bookmarks ${this.app.scene.name ?? ''}`;
    }

    #welcome() {
        this.stop();
        this.named.replaceChildren(
            ...this.app.cameras.map((camera) => {
                const { name, text } = typeof camera === 'string' ? { name: camera } : camera;
                return button(name, () => this.go(name), { title: text });
            }),
        );
        try {
            this.bookmarks = [];
            this.take(JSON.parse(localStorage.getItem(this.#key) ?? '[]'));
        } catch {
            this.bookmarks = []; // the browser keeps nothing, or something else is there
        }
    }

    go(camera) {
        this.stop();
        this.app.goTo(camera);
    }

    #told() {
        try {
            localStorage.setItem(this.#key, JSON.stringify(this.bookmarks));
        } catch {
            // the browser keeps nothing: they last as long as the page
        }
        this.play.disabled = this.bookmarks.length < 2;
        this.list.replaceChildren(...this.bookmarks.map((one, i) => this.#row(one, i)));
    }

    #row(one, i) {
        const row = el('li', {});
        const go = button(one.name, () => this.go(one), { class: 'name', title: 'go there' });
        const rename = button(
            '✎',
            () => {
                const box = el('input', {
                    type: 'text',
                    value: one.name,
                    maxlength: LONGEST,
                    'aria-label': `New name of ${one.name}`,
                });
                const done = (keep) => {
                    if (keep && box.value.trim() && box.value.trim() !== one.name)
                        one.name = this.#free(box.value.trim());
                    this.#told();
                    this.list.children[i]?.querySelector('button').focus();
                };
                box.addEventListener('keydown', (event) => {
                    if (event.key !== 'Enter' && event.key !== 'Escape') return;
                    event.preventDefault();
                    done(event.key === 'Enter');
                });
                box.addEventListener('change', () => done(true));
                row.replaceChildren(box);
                box.select();
            },
            { 'aria-label': `Rename ${one.name}`, title: 'rename' },
        );
        const up = button(
            '↑',
            () => {
                if (i) [this.bookmarks[i - 1], this.bookmarks[i]] = [one, this.bookmarks[i - 1]];
                this.#told();
            },
            { 'aria-label': `Move ${one.name} up`, title: 'earlier on the path', disabled: i === 0 },
        );
        const remove = button('×', () => (this.bookmarks.splice(i, 1), this.#told()), {
            'aria-label': `Delete ${one.name}`,
            title: 'delete',
        });
        row.append(go, up, rename, remove);
        return row;
    }

    toggle() {
        if (this.#playing) this.stop();
        else this.#start();
    }

    stop() {
        cancelAnimationFrame(this.#playing);
        this.#playing = 0;
        this.#mark();
    }

    #mark() {
        this.play.textContent = this.#playing ? 'Stop' : 'Play';
        this.play.setAttribute('aria-pressed', Boolean(this.#playing));
    }

    #start() {
        if (this.bookmarks.length < 2) return;
        let last = performance.now(),
            t = 0;
        const step = (now) => {
            const legs = this.loop.checked ? this.bookmarks.length : this.bookmarks.length - 1;
            t += (now - last) / 1000 / Math.max(Number(this.seconds.value) || 4, 0.1);
            last = now;
            const over = t >= legs && !this.loop.checked;
            this.app.goTo(along(this.bookmarks, over ? legs : t % legs, this.loop.checked));
            if (over) return this.stop();
            this.#playing = requestAnimationFrame(step);
        };
        this.#playing = requestAnimationFrame(step);
        this.#mark();
    }
}
