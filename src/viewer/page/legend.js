// legend.js: what the colours of a picture of numbers mean; its ends are handles, and it can be moved and folded.
import { el, button, number, clamp } from './dom.js';

const GAP = 10; // CSS pixels around it
const LOW = 220; // CSS pixels: in a pane so low it has no controls
const APART = 4; // CSS pixels between numbers
const STEP = 0.1; // of the room, by keys

export class Legend {
    #drawn = '';
    #at = { x: 0.5, y: 0, folded: false }; // of the room that the picture leaves, from its lower left corner

    // kept: where the browser keeps its place; fixed: its ends are those of the numbers, and are not set.
    constructor(root, stage, app, kept = 'nocturne legend', fixed = false) {
        this.root = root;
        this.stage = stage;
        this.app = app;
        this.kept = kept;
        this.fixed = fixed;
        this.title = el('div', { class: 'title' });
        this.grip = button('✥', () => {}, { 'aria-label': 'Move the legend', title: 'drag, or arrow keys' });
        this.fold = button('', () => this.#fold(!this.#at.folded), { class: 'fold' });
        this.head = el('div', { class: 'head' }, this.grip, this.title, this.fold);
        this.band = el('canvas', { class: 'band', width: 256, height: 1, 'aria-hidden': 'true' });
        this.ticks = el('div', { class: 'ticks', 'aria-hidden': 'true' });
        this.handles = ['low', 'high'].map((end) => this.#handle(end));
        this.scale = el('div', { class: 'scale' }, this.band, ...this.handles, this.ticks);
        this.auto = button('auto', () => app.set('show-range', 'auto'), { title: 'ends found from the numbers' });
        this.log = button('log', () => this.#toggle(), { title: 'logarithmic or linear', 'aria-pressed': 'false' });
        this.lines = el('input', {
            type: 'text',
            placeholder: '5,7.5,10,20',
            id: fixed ? null : 'isolines',
            'aria-label': 'Isolines',
            title: 'values, 5,7.5,10,20 (one: 5,), or how many at round ones; empty: none',
            on: { change: () => app.set('isolines', this.lines.value.replaceAll(/\s/g, '') || 0) },
        });
        this.tools = el('div', { class: 'tools' }, this.auto, this.log, el('label', {}, 'isolines ', this.lines));
        this.labels = el('ul', { class: 'labels' });
        root.append(this.head, this.scale, this.tools, this.labels);
        this.#movable();
        app.on('stats', () => this.show());
        app.on('state', () => this.show());
        app.on('waiting', () => this.#wait());
    }

    // That of a picture which is not what is pressed is dimmed with it, and sets nothing, unless a hand is on it: what
    // it has set is what is waited for, and an inert element loses the focus, and what is typed.
    #wait() {
        const waits = this.app.waiting.has(this.pane);
        this.root.classList.toggle('waiting', waits);
        this.root.inert = waits && !this.root.contains(document.activeElement);
    }

    // The pane that is edited, where it shows numbers; -1: none has a legend. A difference has one of its own.
    get pane() {
        const edited = Math.max(this.app.editing, 0);
        const pane = this.beside && edited === 2 ? 0 : edited;
        return this.app.stats[pane]?.show === 'picture' ? -1 : pane;
    }

    get beside() {
        return this.app.state?.layout === 'difference';
    }

    get legend() {
        return this.app.stats[this.pane]?.legend ?? null;
    }

    // Beside a difference, whose numbers are others, it stays in its own pane.
    get #box() {
        const own = this.beside ? this.stage.querySelector(`.pane[data-pane='${this.pane}']`) : null;
        return (own ?? this.stage).getBoundingClientRect();
    }

    show() {
        const { legend, fixed } = this;
        const mode = this.app.stats[this.pane]?.show;
        const values = this.app.values();
        this.root.hidden = !legend;
        if (this.root.hidden) return;
        const text = JSON.stringify([legend, mode, this.beside, this.pane, values.isolines, values['show-range']]);
        if (text === this.#drawn) return;
        this.#drawn = text;
        const unit = legend.unit && !legend.title.includes('[') ? ` [${legend.unit}]` : '';
        this.title.textContent = (legend.title || mode) + unit;
        const numbers = Boolean(legend.colours);
        this.scale.hidden = !numbers;
        this.tools.hidden = !numbers || fixed;
        for (const handle of this.handles) handle.hidden = fixed;
        this.labels.hidden = numbers;
        if (numbers) this.#numbers(legend, values);
        else
            this.labels.replaceChildren(
                ...(legend.labels ?? []).map(({ text, number: label, colour }) => {
                    const swatch = el('span', { class: 'swatch' });
                    swatch.style.background = colour;
                    return el('li', {}, swatch, mode === 'group' ? this.#group(label) : text);
                }),
            );
        this.#place();
    }

    // ---- where it is

    // By its head, with mouse, finger or arrow keys. What is beside head and handles goes through to the picture.
    #movable() {
        try {
            const kept = JSON.parse(localStorage.getItem(this.kept) ?? '{}');
            for (const side of ['x', 'y']) if (kept[side] >= 0 && kept[side] <= 1) this.#at[side] = kept[side];
            this.#at.folded = kept.folded === true;
        } catch {
            // the browser keeps nothing
        }
        let start = null;
        this.head.addEventListener('pointerdown', (event) => {
            if (event.button !== 0 || event.target === this.fold) return;
            start = { x: event.clientX, y: event.clientY, at: { ...this.#at } };
            this.head.setPointerCapture(event.pointerId);
        });
        this.head.addEventListener('pointermove', (event) => {
            if (!start) return;
            const room = this.#room();
            this.#move(
                start.at.x + (event.clientX - start.x) / (room.x || 1),
                start.at.y - (event.clientY - start.y) / (room.y || 1),
            );
        });
        for (const kind of ['pointerup', 'pointercancel'])
            this.head.addEventListener(kind, () => {
                if (start) this.#keep();
                start = null;
            });
        this.grip.addEventListener('keydown', (event) => {
            const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
            if (!step) return;
            this.#move(this.#at.x + STEP * step[0], this.#at.y + STEP * step[1]);
            this.#keep();
            event.preventDefault();
            event.stopPropagation();
        });
        this.#fold(this.#at.folded);
        const watch = new ResizeObserver(() => this.#place());
        watch.observe(this.stage);
        watch.observe(this.root);
    }

    #room() {
        const side = (picture, own) => Math.max(picture - own - 2 * GAP, 0);
        const { width, height } = this.#box;
        return { x: side(width, this.root.offsetWidth), y: side(height, this.root.offsetHeight) };
    }

    #move(x, y) {
        this.#at.x = clamp(x, 0, 1);
        this.#at.y = clamp(y, 0, 1);
        this.#place();
    }

    #place() {
        const box = this.#box;
        this.root.style.maxWidth = `${box.width - 2 * GAP}px`;
        this.root.classList.toggle('low', box.height < LOW);
        const room = this.#room();
        this.root.style.left = `${box.left + GAP + this.#at.x * room.x}px`;
        this.root.style.bottom = `${window.innerHeight - box.bottom + GAP + this.#at.y * room.y}px`;
        this.labels.classList.toggle('long', this.labels.scrollHeight > this.labels.clientHeight);
        this.#spread();
    }

    #fold(folded) {
        this.#at.folded = folded;
        this.root.classList.toggle('folded', folded);
        this.fold.textContent = folded ? '▴' : '▾';
        this.fold.title = folded ? 'unfold the legend' : 'fold the legend';
        this.fold.setAttribute('aria-label', this.fold.title);
        this.fold.setAttribute('aria-expanded', String(!folded));
        this.#place();
        this.#keep();
    }

    #keep() {
        try {
            localStorage.setItem(this.kept, JSON.stringify(this.#at));
        } catch {
            // the browser keeps nothing
        }
    }

    // ---- what it says

    // Groups of lights are numbered as the schema has them; 0 are those of none.
    #group(label) {
        const groups = this.app.schema.world.filter(({ kind }) => kind === 'group');
        return label ? (groups[label - 1]?.name.replace(/^group\./, '') ?? String(label)) : 'others';
    }

    #numbers(legend, values) {
        const context = this.band.getContext('2d');
        const gradient = context.createLinearGradient(0, 0, 256, 0);
        legend.colours.forEach((colour, i) =>
            gradient.addColorStop(i / Math.max(legend.colours.length - 1, 1), colour),
        );
        context.fillStyle = gradient;
        context.fillRect(0, 0, 256, 1);
        this.log.setAttribute('aria-pressed', Boolean(legend.log));
        this.auto.setAttribute('aria-pressed', !values['show-range'] || values['show-range'] === 'auto');
        if (document.activeElement !== this.lines)
            this.lines.value = values.isolines === '0' ? '' : (values.isolines ?? '');
        const { low, high } = legend;
        const within = (legend.isolines ?? []).filter((value) => value > low && value < high);
        const between = within.length ? within : ticks(legend).filter((value) => value > low && value < high);
        this.scale.classList.toggle('two', within.length > 0);
        this.ticks.replaceChildren(
            ...[low, high, ...between].map((value) => {
                const tick = el('span', { text: number(value) });
                tick.style.left = `${this.#part(legend, value) * 100}%`;
                return tick;
            }),
        );
        this.handles.forEach((handle, i) => {
            const end = i ? legend.high : legend.low;
            handle.setAttribute('aria-valuenow', end);
            handle.setAttribute('aria-valuetext', `${number(end)} ${legend.unit ?? ''}`);
            handle.style.left = `${i * 100}%`;
        });
    }

    // Both ends have their numbers, others where they touch none. Isolines have a second row, and always a tick.
    #spread() {
        const rows = [[], []];
        const two = this.scale.classList.contains('two');
        for (const tick of this.ticks.children) {
            const { left, right } = tick.getBoundingClientRect();
            const row = rows.findIndex((taken) =>
                taken.every((other) => left > other.right + APART || right < other.left - APART),
            );
            tick.classList.toggle('second', two && row === 1);
            tick.classList.toggle('bare', row < 0 || (!two && row === 1));
            rows[row]?.push({ left, right });
        }
    }

    #part(legend, value) {
        if (legend.log) return Math.log(value / legend.low) / Math.log(legend.high / legend.low);
        return (value - legend.low) / (legend.high - legend.low);
    }

    #value(legend, part) {
        if (legend.log) return legend.low * (legend.high / legend.low) ** part;
        return legend.low + (legend.high - legend.low) * part;
    }

    // A handle is pulled to where its colour shall be: pulled inwards, the range becomes narrower.
    #handle(end) {
        const handle = el('div', {
            class: `handle ${end}`,
            role: 'slider',
            tabindex: 0,
            'aria-label': `${end === 'low' ? 'Lower' : 'Upper'} end`,
            title: 'drag, or arrow keys',
        });
        let start = null;
        const pull = (part) => {
            const { legend } = start;
            const value = this.#value(legend, end === 'low' ? Math.min(part, 0.95) : Math.max(part, 0.05));
            this.#range(end === 'low' ? value : legend.low, end === 'low' ? legend.high : value);
        };
        handle.addEventListener('pointerdown', (event) => {
            start = { legend: this.legend, box: this.band.getBoundingClientRect() };
            handle.setPointerCapture(event.pointerId);
        });
        handle.addEventListener('pointermove', (event) => {
            if (start) pull(clamp((event.clientX - start.box.left) / start.box.width, -1, 2));
        });
        for (const kind of ['pointerup', 'pointercancel']) handle.addEventListener(kind, () => (start = null));
        handle.addEventListener('keydown', (event) => {
            const step = { ArrowLeft: -0.05, ArrowDown: -0.05, ArrowRight: 0.05, ArrowUp: 0.05 }[event.key];
            if (!step) return;
            start = { legend: this.legend };
            pull((end === 'low' ? 0 : 1) + step);
            start = null;
            event.preventDefault();
            event.stopPropagation();
        });
        return handle;
    }

    #range(low, high) {
        if (!(high > low)) return;
        const say = (value) => String(Number(value.toPrecision(4)));
        this.app.set('show-range', `${say(low)},${say(high)}`, this.app.editing, true);
    }

    #toggle() {
        this.app.set('show-range', 'auto'); // a logarithm does not begin at 0
        this.app.set('show-scale', this.legend?.log ? 'linear' : 'log');
    }
}

// That of a difference, over the pane that shows it.
export class DifferenceLegend extends Legend {
    constructor(root, stage, app) {
        super(root, stage, app, 'nocturne legend of differences', true);
    }

    get pane() {
        return this.beside ? 2 : -1;
    }
}

// Round values between the ends.
export function ticks(legend) {
    const { low, high, log } = legend;
    const found = [];
    if (log && low > 0) {
        const decades = Math.log10(high / low);
        const steps = decades > 5 ? [1] : decades > 2 ? [1, 3] : [1, 2, 5];
        const every = decades > 8 ? 2 : 1;
        for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += every)
            for (const step of steps)
                if (step * 10 ** power >= low && step * 10 ** power <= high) found.push(step * 10 ** power);
        return found;
    }
    const rough = (high - low) / 5;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= rough);
    for (let i = Math.ceil(low / step); i * step <= high; i++) found.push(i * step);
    return found;
}
