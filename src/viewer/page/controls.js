// controls.js: the control of one option, made from its row in the schema. Values are text, as on the command line.
import { el, button, clamp } from './dom.js';

const STEPS = 1000;
const HOLD = 600; // ms after a change in which what the program says does not move the control

// Where a slider stands for a number, 0 to 1, and back: where a range is long, small numbers have more room.
function scale(option) {
    const value = Number(option.value) || 0;
    const wide = Math.max(100, 10 * Math.abs(value)); // where there is no end to speak of
    const low = option.min > -1e5 ? option.min : -wide;
    let high = option.max < 1e5 ? option.max : low < 0 ? wide : Math.max(value * 10, low + 10);
    if (value && high / Math.abs(value) > 1000) high = value * 100;
    const cubic = low >= 0 && (high - low) / Math.max(Math.abs(value), (high - low) / 1e4) > 12;
    const bend = cubic ? 3 : 1;
    return {
        to: (number) => clamp((number - low) / (high - low), 0, 1) ** (1 / bend),
        from: (part) => low + (high - low) * part ** bend,
    };
}

// A number as text: as many figures as the slider has steps.
function say(option, number) {
    if (option.kind === 'int') return String(Math.round(number));
    return String(Number(number.toPrecision(3)));
}

function numeric(option, change, labels) {
    const map = scale(option);
    const box = el('input', {
        type: 'number',
        min: option.min,
        max: option.max,
        step: option.kind === 'int' ? 1 : 'any',
        ...labels,
    });
    const slider = el('input', {
        type: 'range',
        min: 0,
        max: STEPS,
        step: 1,
        ...labels,
        id: null, // the label is the box's
        'aria-label': `${option.name}, slider`,
    });
    const slide = () => {
        slider.value = map.to(Number(box.value)) * STEPS;
        slider.setAttribute('aria-valuetext', `${box.value} ${option.unit ?? ''}`);
    };
    box.addEventListener('change', () => {
        if (box.value === '' || !Number.isFinite(box.valueAsNumber)) return;
        const number = clamp(box.valueAsNumber, option.min ?? -Infinity, option.max ?? Infinity);
        box.value = option.kind === 'int' ? Math.round(number) : number;
        slide();
        change(box.value);
    });
    slider.addEventListener('input', () => {
        box.value = say(option, clamp(map.from(slider.value / STEPS), option.min ?? -Infinity, option.max ?? Infinity));
        slider.setAttribute('aria-valuetext', `${box.value} ${option.unit ?? ''}`);
        change(box.value, true);
    });
    const show = (text) => {
        box.value = Number.isFinite(Number(text)) ? Number(Number(text).toPrecision(6)) : '';
        slide();
    };
    const unit = option.unit ? el('span', { class: 'unit', text: option.unit }) : null;
    return { parts: [slider, el('span', { class: 'number' }, box, unit)], show, wide: true };
}

function bool(option, change, labels) {
    const box = el('input', {
        type: 'checkbox',
        role: 'switch',
        ...labels,
        on: { change: () => change(box.checked ? 'on' : 'off') },
    });
    return { parts: [box], show: (text) => (box.checked = text === 'on' || text === 'true') };
}

function choice(option, change, labels) {
    const names = option.kind === 'switch' ? ['auto', 'on', 'off'] : (option.choices ?? []);
    const box = el('select', { ...labels, on: { change: () => change(box.value) } });
    for (const name of names) box.append(el('option', { value: name, text: name }));
    return { parts: [box], show: (text) => (box.value = text === 'true' ? 'on' : text === 'false' ? 'off' : text) };
}

function text(option, change, labels) {
    const box = el('input', { type: 'text', ...labels, on: { change: () => change(box.value) } });
    return { parts: [box], show: (value) => (box.value = value) };
}

function colour(option, change, labels) {
    const box = el('input', { type: 'color', ...labels, on: { input: () => change(box.value, true) } });
    return { parts: [box], show: (value) => (box.value = value || '#808080') };
}

// A number, or auto, which the program finds: exposure. By hand it begins at what was found.
function automatic(option, change, labels) {
    const row = { ...option, kind: 'real', min: -10, max: 20, value: '3' };
    const numbers = numeric(row, change, { 'aria-label': `${option.name}, by hand` });
    const told = () => change(box.checked ? 'auto' : String(Number((option.found() ?? 3).toFixed(2))));
    const box = el('input', { type: 'checkbox', role: 'switch', ...labels, on: { change: told } });
    const show = (value) => {
        box.checked = value === 'auto';
        numbers.parts.forEach((part) => (part.hidden = box.checked));
        if (!box.checked) numbers.show(value);
    };
    return { parts: [el('span', { class: 'quiet', text: 'auto' }), box], below: numbers.parts, show };
}

// A group of lights, in the words of --group: on or off, how bright, and in which colour.
const LAMPS = [
    ['own', 'own', 'each light in its own colour'],
    ['2000K', 'sodium', 'as high-pressure sodium lamps, 2000 K'],
    ['3000K', 'warm LED', '3000 K'],
    ['4000K', 'LED', '4000 K'],
];

// A colour of a group's words as the swatch has it: a black body's by a fit, `own` the mean of its lights.
function shownAs(colour, own) {
    const kelvin = parseFloat(colour);
    if (!/k$/i.test(colour) || !(kelvin > 0)) return own || '#ffffff';
    const t = clamp(kelvin, 1000, 40000) / 100;
    const green = t <= 66 ? 99.47 * Math.log(t) - 161.12 : 288.12 * (t - 60) ** -0.0755;
    const red = t <= 66 ? 255 : 329.7 * (t - 60) ** -0.1332;
    const blue = t >= 66 ? 255 : t <= 19 ? 0 : 138.52 * Math.log(t - 10) - 305.04;
    return `#${[red, green, blue].map((one) => Math.round(clamp(one, 0, 255)).toString(16).padStart(2, '0')).join('')}`;
}

export function groupWords(value) {
    const words = { on: true, scale: 1, colour: 'own' };
    for (const word of String(value)
        .split(',')
        .map((one) => one.trim())) {
        if (word === 'off') words.on = false;
        else if (word === 'on') words.on = true;
        else if (/^(own|#|[\d.]+k$)/i.test(word)) words.colour = word;
        else if (word !== '' && Number.isFinite(Number(word))) words.scale = Number(word);
    }
    if (words.scale === 0) words.on = false;
    return words;
}

export function toGroup({ on, scale, colour }) {
    return on ? `${scale || 1},${colour}` : `off,${colour}`;
}

function group(option, change, labels) {
    let words = groupWords(option.value);
    const told = (pulled) => change(toGroup(words), pulled);
    const name = option.name.replace(/^group\./, '');
    const on = bool(option, (value) => ((words.on = value === 'on'), told(false)), labels);
    const brightness = { name: `${name}, brightness`, kind: 'real', min: 0, max: 4, value: '1', unit: '×' };
    const scaled = (value, pulled) => ((words.scale = Number(value)), (words.on = words.scale > 0), told(pulled));
    const dim = numeric(brightness, scaled, { 'aria-label': `${name}, brightness` });
    const dye = (value) => ((words.colour = value), told(false), mark());
    const buttons = LAMPS.map(([value, label, title]) => button(label, () => dye(value), { title, data: { value } }));
    const free = el('input', {
        type: 'color',
        title: 'another colour',
        'aria-label': `${name}, colour`,
        on: { change: () => dye(free.value) },
    });
    const mark = () => buttons.forEach((one) => one.setAttribute('aria-pressed', one.dataset.value === words.colour));
    const show = (value) => {
        words = groupWords(value);
        on.show(words.on ? 'on' : 'off');
        dim.show(String(words.scale));
        free.value = words.colour.startsWith('#') ? words.colour : shownAs(words.colour, option.colour);
        mark();
    };
    const colours = el('span', { class: 'colours', role: 'group', 'aria-label': `${name}, colour` }, ...buttons, free);
    return { parts: [...on.parts], below: [...dim.parts, colours], show };
}

// What a name does not say by itself.
const LABELS = { 'window-lit': 'share of windows lit at 21 h' };

const KINDS = { bool, switch: choice, choice, int: numeric, real: numeric, text, colour, group };

// root: the row. change(text, pulled) is called at most once an animation frame; pulled: by a slider.
export class Control {
    #changed = -Infinity; // by hand, ms
    #frame = 0;
    #next = null;

    constructor(option, change) {
        this.option = option;
        this.change = change;
        const name = LABELS[option.name] ?? option.name.replace(/^(group|material)\./, '').replaceAll(/[-.]/g, ' ');
        const id = `option-${option.name}`;
        const labels = { id, 'aria-describedby': `${id}-why` };
        this.made = (option.name === 'exposure' ? automatic : (KINDS[option.kind] ?? text))(
            option,
            (value, pulled) => this.#say(value, false, pulled),
            labels,
        );
        this.why = el('span', { class: 'why', id: `${id}-why` });
        this.shared = el('span', { class: 'mark', text: 'all pictures', hidden: true });
        this.back = button('↺', () => this.#say(option.value, true), {
            class: 'back',
            title: `back to ${option.value || 'empty'}`,
            'aria-label': `${name}: back to ${option.value || 'empty'}`,
        });
        const head = el(
            'div',
            { class: 'head' },
            el('label', { for: id, text: name }),
            ...(this.made.wide ? [] : this.made.parts),
            this.shared,
            this.back,
        );
        const below = this.made.wide ? this.made.parts : this.made.below;
        this.root = el(
            'div',
            { class: 'control', title: option.help, data: { name: option.name } },
            head,
            below ? el('div', { class: 'below' }, ...below) : null,
            this.why,
        );
        this.show(option.value);
    }

    // value: as the program tells it; why: it changes no picture, or undefined.
    show(value, why) {
        if (value === undefined) value = this.option.value;
        if (performance.now() - this.#changed > HOLD) {
            this.made.show(value);
            this.value = value;
        }
        this.back.hidden = same(this.option, value);
        this.root.classList.toggle('idle', Boolean(why));
        this.why.textContent = why ? `no effect: ${why}` : '';
    }

    // Another control has set it: the program tells it back in a moment.
    take(value) {
        this.made.show(value);
        this.value = value;
        this.#changed = performance.now();
    }

    // Is it of the scene, where several pictures are shown?
    share(shared) {
        this.shared.hidden = !shared;
    }

    #say(value, settled = false, pulled = false) {
        this.value = value;
        this.#changed = settled ? -Infinity : performance.now();
        this.#next = [value, pulled];
        if (!this.#frame)
            this.#frame = requestAnimationFrame(() => {
                this.#frame = 0;
                this.change(...this.#next);
            });
    }
}

// Is a value the default? 1 and 1.0, on and true are the same.
export function same(option, value) {
    const plain = (one) => (one === 'true' ? 'on' : one === 'false' ? 'off' : String(one ?? ''));
    const a = plain(value),
        b = plain(option.value);
    if (a === b) return true;
    if (option.kind === 'int' || option.kind === 'real') return Number(a) === Number(b);
    if (option.kind !== 'group') return false;
    return JSON.stringify(groupWords(a)) === JSON.stringify(groupWords(b));
}
