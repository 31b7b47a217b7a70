// modes.js: what is shown: three buttons that say it in plain words, and the laboratory's modes behind More.
import { Choice, typing } from './dom.js';

// The modes that the bar has, under their words there.
const VIEWS = [
    ['picture', 'Picture', 'the city at night, as a camera takes it'],
    ['illuminance', 'Lux', 'illuminance in lx: how much light falls on each surface'],
    ['influential', 'Who lights it', 'each surface in the colour of the lamp or window that brings it the most light'],
];
// The laboratory's: what is looked at most comes first, the rest as the program has it.
const FIRST = ['luminance', 'influential-share', 'runner-up', 'runner-up-share', 'group', 'placed', 'lights'];

// A mode in plain words, of a label.
const PLAIN = { picture: 'the picture', influential: 'who lights it' };
export const plain = (name) => PLAIN[name] ?? name.replaceAll('-', ' ');

function others(modes) {
    const rank = ({ name }) => (FIRST.includes(name) ? FIRST.indexOf(name) : FIRST.length);
    return modes.filter(({ name }) => !VIEWS.some(([view]) => view === name)).sort((a, b) => rank(a) - rank(b));
}

export class Modes {
    constructor(views, bar, app) {
        this.app = app;
        this.views = new Choice(views, (name) => this.#press(name));
        this.bar = new Choice(bar, (name) => this.#press(name));
        this.views.fill(VIEWS.map(([name, text, title]) => ({ name, text, title })));
        app.on('welcome', () => {
            const modes = others(app.schema.modes);
            this.bar.fill(modes.map((mode) => ({ name: mode.name, text: mode.name, title: mode.text })));
        });
        for (const kind of ['state', 'pressed'])
            app.on(kind, () => [this.views, this.bar].forEach((one) => one.set(app.show())));
        document.addEventListener('keydown', (event) => this.#key(event));
    }

    // 1 to 9 are the first modes, [ and ] go to the one before and after.
    #key(event) {
        if (typing(event) || event.ctrlKey || event.metaKey || event.altKey) return;
        const names = [...this.views.names, ...this.bar.names];
        const now = Math.max(names.indexOf(this.app.show()), 0);
        const step = { BracketLeft: -1, BracketRight: 1 }[event.code];
        const next = step
            ? names[(now + step + names.length) % names.length]
            : /^[1-9]$/.test(event.key)
              ? names[event.key - 1]
              : null;
        if (next) this.#press(next);
    }

    // Numbers are of the city's lights, of which a headlight has none.
    #press(name) {
        if (name !== 'picture') this.app.headlight(false);
        this.app.set('show', name);
    }
}
