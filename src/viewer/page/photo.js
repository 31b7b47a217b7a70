// photo.js: a photograph over the picture. It never leaves the browser: the program is told of clicked places alone,
// and finds the camera that it was taken with.
import { el, button, clamp, click, number } from './dom.js';

const LEAST = 4; // pairs

export class Photo {
    #bitmap = null;
    #pairs = []; // { photo: [x, y], place: [x, y, z] }
    #open = null; // the photo's half of a pair whose place is to be clicked
    #pairing = false;

    constructor(app, drawers, panes, input) {
        this.app = app;
        this.drawers = drawers;
        this.panes = panes;
        this.input = input;
        this.file = el('input', {
            type: 'file',
            accept: 'image/*',
            id: 'photo-file',
            'aria-label': 'Photograph',
            on: { change: () => this.#load() },
        });
        this.opacity = this.#slider('Opacity', 60);
        this.divider = this.#slider('Divider', 100);
        this.pairing = button('Set pairs', () => this.#pair(!this.#pairing), {
            'aria-pressed': 'false',
            disabled: true,
        });
        this.align = button('Find the camera', () => this.#align(), { disabled: true });
        this.remove = button('Take away', () => this.#remove(), { disabled: true });
        this.says = el('p', { class: 'quiet', role: 'status' });
        this.list = el('ol', { class: 'pairs' });
        drawers.add(
            'Photo',
            'right',
            el(
                'div',
                { class: 'body' },
                el('p', {
                    class: 'quiet',
                    text: 'A photograph of the same place, from this device. It stays in this browser.',
                }),
                this.file,
                this.opacity.row,
                this.divider.row,
                el('div', { class: 'tools' }, this.pairing, this.align, this.remove),
                this.says,
                this.list,
            ),
            'O',
        );
        panes.marks.push((context, pane) => this.#draw(context, pane));
    }

    #slider(name, value) {
        const box = el('input', { type: 'range', min: 0, max: 100, value, on: { input: () => this.panes.draw() } });
        return { box, row: el('label', { class: 'slider' }, name, box) };
    }

    async #load() {
        const file = this.file.files[0];
        if (!file) return;
        try {
            this.#bitmap = await createImageBitmap(file);
        } catch {
            this.app.emit('note', 'error', `${file.name} is no picture that this browser can show.`);
            return;
        }
        this.#pairs = [];
        this.#frame();
        this.#told();
        this.panes.draw();
    }

    // Where the photograph is wider than its pane the picture becomes as wide, so that all of it is seen.
    #frame() {
        this.panes.aspect = this.#bitmap ? this.#bitmap.width / this.#bitmap.height : 0;
        this.app.emit('size');
    }

    #remove() {
        this.#bitmap?.close();
        this.#bitmap = null;
        this.file.value = '';
        this.#frame();
        this.#pair(false);
        this.#pairs = [];
        this.#told();
        this.panes.draw();
    }

    // Over the picture it is as high as that: both have the camera's vertical angle.
    #rect(pane) {
        const rect = this.panes.rect(pane);
        const width = (rect.height * this.#bitmap.width) / this.#bitmap.height;
        return { x: rect.x + (rect.width - width) / 2, y: rect.y, width, height: rect.height };
    }

    // By turns: a point of the photograph, which covers the picture then, and the same one in the picture.
    #pair(on) {
        this.#pairing = on;
        this.#open = null;
        this.input.picker = on ? (hit) => this.#clicked(hit) : null;
        this.panes.root.classList.toggle('selecting', on);
        this.#told();
        this.panes.draw();
    }

    // Leaves the pairs; those that are set stay. false: none are being set.
    cancel() {
        const some = this.#pairing;
        if (some) this.#pair(false);
        return some;
    }

    #clicked(hit) {
        const rect = this.panes.rect(hit.pane),
            own = this.#rect(hit.pane);
        if (!this.#open) {
            const photo = [(rect.x + hit.x * rect.width - own.x) / own.width, hit.y];
            if (photo[0] < 0 || photo[0] > 1) return;
            this.#open = photo;
        } else {
            const photo = this.#open;
            this.#open = null;
            const id = this.app.ask('pixel', hit, (answer) => {
                if (answer.refused || (answer.done < 1 && !answer.place)) return;
                if (answer.done < 1) this.app.cancel(id); // who lights it is not asked
                if (!answer.place) this.says.textContent = `Nothing is there: ${click().toLowerCase()} a surface.`;
                else this.#pairs.push({ photo, place: answer.place });
                this.#told(!answer.place);
                this.panes.draw();
            });
        }
        this.#told();
        this.panes.draw();
    }

    #align() {
        const aspect = this.#bitmap.width / this.#bitmap.height;
        this.app.ask('align', { pairs: this.#pairs, aspect }, (answer) => {
            if (answer.refused) this.says.textContent = answer.refused;
            else if (answer.done >= 1) {
                this.#pair(false);
                const off = number(100 * answer.error, 2);
                this.says.textContent = `The camera was found: pairs are off by ${off} % of the photograph's height.`;
            }
        });
    }

    #told(keep = false) {
        const some = Boolean(this.#bitmap);
        this.pairing.disabled = this.remove.disabled = !some;
        this.pairing.setAttribute('aria-pressed', this.#pairing);
        this.align.disabled = this.#pairs.length < LEAST;
        if (!keep) {
            this.says.textContent = !some
                ? ''
                : this.#open
                  ? `Now ${click().toLowerCase()} the same point in the picture.`
                  : this.#pairing
                    ? `${click()} a point in the photograph (${this.#pairs.length} of at least ${LEAST} pairs).`
                    : '';
        }
        this.list.replaceChildren(
            ...this.#pairs.map((pair, i) =>
                el(
                    'li',
                    {},
                    pair.place.map((x) => x.toFixed(1)).join(', '),
                    ' ',
                    button('×', () => (this.#pairs.splice(i, 1), this.#told(), this.panes.draw()), {
                        'aria-label': `Remove pair ${i + 1}`,
                    }),
                ),
            ),
        );
    }

    #draw(context, pane) {
        if (!this.#bitmap) return;
        const rect = this.#rect(pane);
        const choosing = this.#pairing && !this.#open;
        const opacity = this.#pairing ? (choosing ? 1 : 0) : this.opacity.box.value / 100;
        const clip = choosing ? 1 : this.divider.box.value / 100;
        context.save();
        context.beginPath();
        context.rect(rect.x, rect.y, rect.width * clamp(clip, 0, 1), rect.height);
        context.clip();
        context.globalAlpha = opacity;
        context.drawImage(this.#bitmap, rect.x, rect.y, rect.width, rect.height);
        context.restore();
        if (!this.#pairing) return;
        context.font = '12px sans-serif';
        context.fillStyle = context.strokeStyle = '#ffd84d';
        const marks = choosing
            ? this.#pairs.map(({ photo }) => [rect.x + photo[0] * rect.width, rect.y + photo[1] * rect.height])
            : this.#pairs.map(({ place }) => this.panes.where(pane, place));
        marks.forEach((at, i) => {
            if (!at) return;
            context.strokeRect(at[0] - 4, at[1] - 4, 8, 8);
            context.fillText(i + 1, at[0] + 7, at[1] - 6);
        });
    }
}
