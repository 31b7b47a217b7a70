// modes.js: the bar of what is shown, and the legend of numbers in colours, whose ends are handles.
import { el, Choice, button, number, clamp, typing } from './dom.js';

// What is looked at most comes first, the rest as the program has it.
const FIRST = [
    ...['picture', 'luminance', 'illuminance', 'influential', 'influential-share', 'runner-up', 'runner-up-share'],
    ...['group', 'placed', 'lights'],
];
const order = (modes) => {
    const rank = ({ name }) => (FIRST.includes(name) ? FIRST.indexOf(name) : FIRST.length);
    return [...modes].sort((a, b) => rank(a) - rank(b));
};

export class Modes {
    constructor(bar, app) {
        this.app = app;
        this.bar = new Choice(bar, (name) => app.set('show', name));
        app.on('welcome', () => {
            const modes = order(app.schema.modes);
            this.bar.fill(modes.map((mode) => ({ name: mode.name, text: mode.name, title: mode.text })));
        });
        app.on('state', () => this.bar.set(app.values().show ?? 'picture'));
        document.addEventListener('keydown', (event) => this.#key(event));
    }

    // 1 to 9 are the first modes, [ and ] go to the one before and after.
    #key(event) {
        if (typing(event) || event.ctrlKey || event.metaKey || event.altKey) return;
        const names = this.bar.names;
        const now = Math.max(names.indexOf(this.bar.name), 0);
        const step = { BracketLeft: -1, BracketRight: 1 }[event.code];
        const next = step
            ? names[(now + step + names.length) % names.length]
            : /^[1-9]$/.test(event.key)
              ? names[event.key - 1]
              : null;
        if (next) this.app.set('show', next);
    }
}

export class Legend {
    #drawn = '';

    constructor(root, app) {
        this.root = root;
        this.app = app;
        this.title = el('div', { class: 'title' });
        this.band = el('canvas', { class: 'band', width: 256, height: 1, 'aria-hidden': 'true' });
        this.ticks = el('div', { class: 'ticks', 'aria-hidden': 'true' });
        this.handles = ['low', 'high'].map((end) => this.#handle(end));
        this.scale = el('div', { class: 'scale' }, this.band, ...this.handles, this.ticks);
        this.auto = button('auto', () => app.set('show-range', 'auto'), { title: 'ends found from the numbers' });
        this.log = button('log', () => this.#toggle(), { title: 'logarithmic or linear', 'aria-pressed': 'false' });
        this.lines = el('input', {
            type: 'number',
            min: 0,
            max: 32,
            step: 1,
            value: 0,
            id: 'isolines',
            'aria-label': 'Isolines',
            on: { change: () => app.set('isolines', this.lines.value || 0) },
        });
        this.tools = el('div', { class: 'tools' }, this.auto, this.log, el('label', {}, 'isolines ', this.lines));
        this.labels = el('ul', { class: 'labels' });
        root.append(this.title, this.scale, this.tools, this.labels);
        app.on('stats', () => this.show());
        app.on('state', () => this.show());
    }

    // Of the pane that is edited.
    get legend() {
        return this.app.stats[Math.max(this.app.editing, 0)]?.legend ?? null;
    }

    show() {
        const legend = this.legend;
        const mode = this.app.mode();
        const values = this.app.values();
        this.root.hidden = !legend || mode.name === 'picture';
        if (this.root.hidden) return;
        const text = JSON.stringify([legend, mode.name, values.isolines, values['show-range']]);
        if (text === this.#drawn) return;
        this.#drawn = text;
        const unit = legend.unit && !legend.title.includes('[') ? ` [${legend.unit}]` : '';
        this.title.textContent = (legend.title || mode.name) + unit;
        const numbers = Boolean(legend.colours);
        this.scale.hidden = this.tools.hidden = !numbers;
        this.labels.hidden = numbers;
        if (numbers) this.#numbers(legend, values);
        else
            this.labels.replaceChildren(
                ...(legend.labels ?? []).map(({ text, number: label, colour }) => {
                    const swatch = el('span', { class: 'swatch' });
                    swatch.style.background = colour;
                    return el('li', {}, swatch, mode.name === 'group' ? this.#group(label) : text);
                }),
            );
    }

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
        if (document.activeElement !== this.lines) this.lines.value = Number(values.isolines) || 0;
        this.ticks.replaceChildren(
            ...ticks(legend).map((value) => {
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
        this.app.set('show-range', `${say(low)},${say(high)}`);
    }

    #toggle() {
        this.app.set('show-range', 'auto'); // a logarithm does not begin at 0
        this.app.set('show-scale', this.legend?.log ? 'linear' : 'log');
    }
}

// Round values between the ends, both of them where they are far from the others.
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
