// compare.js: layouts: one picture, two beside a divider, all methods, a difference from the reference.
import { el, Choice, clamp } from './dom.js';

export const LAYOUTS = [
    ['single', 'One', 'one picture'],
    ['divider', 'A|B', 'two looks, A and B, and a divider between them'],
    ['methods', 'Methods', 'all methods beside each other'],
    ['difference', 'Difference', 'a look, the reference, and their difference'],
];
const STEP = 0.02;

export class Layouts {
    constructor(root, app, panes) {
        this.app = app;
        this.panes = panes;
        this.choice = new Choice(root, (name) => this.set(name));
        this.choice.fill(LAYOUTS.map(([name, text, title]) => ({ name, text, title })));
        this.divider = this.#divider();
        panes.root.append(this.divider);
        app.on('state', (state) => this.#show(state));
        panes.root.addEventListener('click', (event) => this.#edit(event));
        this.#place(0.5);
    }

    set(name) {
        this.app.connection.send('layout', { name });
    }

    #show(state) {
        this.choice.set(state.layout);
        this.divider.hidden = state.layout !== 'divider';
    }

    // A click on a caption says which picture the settings are of.
    #edit(event) {
        const caption = event.target.closest?.('.caption');
        if (caption) this.app.edit(Number(caption.parentElement.dataset.pane));
    }

    #place(split) {
        this.panes.setSplit(clamp(split, 0, 1));
        this.divider.style.left = `${this.panes.split * 100}%`;
        this.divider.setAttribute('aria-valuenow', Math.round(this.panes.split * 100));
    }

    #divider() {
        const bar = el('div', {
            class: 'divider',
            role: 'separator',
            tabindex: 0,
            'aria-label': 'Divider',
            'aria-orientation': 'vertical',
            'aria-valuemin': 0,
            'aria-valuemax': 100,
            hidden: true,
        });
        let held = false;
        bar.addEventListener('pointerdown', (event) => {
            held = true;
            bar.setPointerCapture(event.pointerId);
            event.stopPropagation(); // it turns nothing
        });
        bar.addEventListener('pointermove', (event) => {
            const box = this.panes.root.getBoundingClientRect();
            if (held) this.#place((event.clientX - box.left) / box.width);
            event.stopPropagation();
        });
        for (const kind of ['pointerup', 'pointercancel']) bar.addEventListener(kind, () => (held = false));
        bar.addEventListener('keydown', (event) => {
            const to = { ArrowLeft: this.panes.split - STEP, ArrowRight: this.panes.split + STEP, Home: 0, End: 1 }[
                event.key
            ];
            if (to === undefined) return;
            this.#place(to);
            event.preventDefault();
            event.stopPropagation();
        });
        return bar;
    }
}
