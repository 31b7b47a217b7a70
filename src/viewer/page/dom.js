// dom.js: elements in one call, and small things that all panels use.

// attributes: class, text, on (event to function), data (name to text), or any attribute; true sets a bare one.
export function el(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (value === undefined || value === null || value === false) continue;
        if (name === 'text') element.textContent = value;
        else if (name === 'on') for (const [kind, act] of Object.entries(value)) element.addEventListener(kind, act);
        else if (name === 'data') Object.assign(element.dataset, value);
        else if (name === 'value') element.value = value;
        else element.setAttribute(name, value === true ? '' : value);
    }
    element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
    return element;
}

export function button(text, act, attributes = {}) {
    return el('button', { type: 'button', text, on: { click: act }, ...attributes });
}

// Who wants to know of something says on(kind, act); who tells it says emit(kind, ...).
export class Emitter {
    #listeners = new Map();

    on(kind, act) {
        if (!this.#listeners.has(kind)) this.#listeners.set(kind, []);
        this.#listeners.get(kind).push(act);
    }

    emit(kind, ...values) {
        for (const act of this.#listeners.get(kind) ?? []) act(...values);
    }
}

// A row of buttons of which one is on: one stop of the Tab key, arrows go on.
export class Choice {
    #buttons = new Map();
    #name = null;

    constructor(root, choose) {
        this.root = root;
        this.choose = choose;
        root.addEventListener('keydown', (event) => this.#key(event));
    }

    // items: { name, text, title }
    fill(items) {
        this.#buttons.clear();
        this.root.replaceChildren();
        for (const item of items) {
            const one = button(item.text, () => this.choose(item.name), { role: 'radio', title: item.title });
            one.dataset.name = item.name;
            this.#buttons.set(item.name, one);
            this.root.append(one);
        }
        this.set(this.#name);
    }

    get names() {
        return [...this.#buttons.keys()];
    }

    get name() {
        return this.#name;
    }

    set(name) {
        this.#name = name;
        const stop = this.#buttons.has(name) ? name : this.names[0];
        for (const [own, one] of this.#buttons) {
            one.setAttribute('aria-checked', own === name);
            one.tabIndex = own === stop ? 0 : -1;
        }
    }

    #key(event) {
        const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
        if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
        const all = [...this.#buttons.values()];
        const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
        next.focus();
        next.click();
        event.preventDefault();
        event.stopPropagation();
    }
}

// A number for people: three figures, thousands apart.
export function number(value, figures = 3) {
    if (value === null || value === undefined || !Number.isFinite(value)) return '–';
    const size = Math.abs(value);
    if (size >= 1e15 || (size > 0 && size < 1e-4)) return value.toExponential(figures - 1);
    const decimals = size === 0 ? 0 : Math.max(0, figures - 1 - Math.floor(Math.log10(size)));
    return value.toLocaleString('en', { minimumFractionDigits: 0, maximumFractionDigits: Math.min(decimals, 10) });
}

// A name or id, which breaks behind its signs rather than in the middle of a number.
export function breaks(text) {
    const parts = String(text).split(/(?<=[_\-.:/])/);
    return parts.flatMap((part, i) => (i ? [el('wbr'), part] : [part]));
}

// Who points with a finger taps.
export const byTouch = () => window.matchMedia('(pointer: coarse)').matches;
export const click = () => (byTouch() ? 'Tap' : 'Click');

// 1234567 as "1.23 M".
export function short(value) {
    if (!Number.isFinite(value)) return '–';
    for (const [size, letter] of [
        [1e9, 'G'],
        [1e6, 'M'],
        [1e3, 'k'],
    ])
        if (Math.abs(value) >= size) return `${number(value / size)} ${letter}`;
    return number(value);
}

export const places = (place, decimals = 2) => place.map((one) => one.toFixed(decimals)).join(', ');
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

// Is a key meant for what has the focus, so that it moves nothing?
export function typing(event) {
    const at = event.target;
    if (!(at instanceof HTMLElement)) return false;
    if (at.matches('input, select, textarea, [contenteditable]') || at.closest('dialog')) return true;
    return (
        (event.key === ' ' || event.key === 'Enter') && at.matches('button, summary, a, [role=button], tr[tabindex]')
    );
}
