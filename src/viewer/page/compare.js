// compare.js: layouts: one picture, two beside a divider, all methods, a difference from the reference.
import { el, button, number, Choice, clamp } from './dom.js';

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
        this.choice = new Choice(root, (name) => app.setLayout(name));
        this.choice.fill(LAYOUTS.map(([name, text, title]) => ({ name, text, title })));
        this.divider = this.#divider();
        this.hold = button('Hold A', () => panes.hold(!panes.held), {
            class: 'hold',
            title: 'A keeps its lamps, windows, hour and materials while you change them, and is compared with B',
            'aria-pressed': 'false',
            hidden: true,
        });
        this.hold.addEventListener('pointerdown', (event) => event.stopPropagation()); // it turns nothing
        panes.root.append(this.divider, this.hold);
        app.on('held', (held) => this.#held(held));
        app.on('state', (state) => this.#show(state));
        panes.root.addEventListener('click', (event) => this.#edit(event));
        this.#place(0.5);
    }

    #show(state) {
        this.choice.set(state.layout);
        this.divider.hidden = this.hold.hidden = state.layout !== 'divider';
    }

    // Two exposures that are found would hide what is dimmed: both pictures get that of A.
    #held(held) {
        this.hold.setAttribute('aria-pressed', String(held));
        const found = this.app.stats[0]?.ev100;
        if (held && this.app.values(1).exposure === 'auto' && Number.isFinite(found)) {
            for (const pane of [0, 1]) this.app.set('exposure', found.toFixed(2), pane);
            this.exposed = true;
            const text = 'A is held: change lamps, windows or the hour, and compare.';
            this.app.emit('note', 'info', `${text} Both are exposed for EV100 ${number(found)}.`);
        } else if (!held && this.exposed) {
            const panes = this.app.state?.panes?.length ?? 1;
            for (let pane = 0; pane < Math.min(panes, 2); pane++) this.app.set('exposure', 'auto', pane);
            this.exposed = false;
        }
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
