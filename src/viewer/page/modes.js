// modes.js: the bar of what is shown.
import { Choice, typing } from './dom.js';

// What is looked at most comes first, the rest as the program has it.
const FIRST = [
    ...['picture', 'luminance', 'illuminance', 'influential', 'influential-share', 'runner-up', 'runner-up-share'],
    ...['group', 'placed', 'lights'],
];

// A mode in plain words, of a label.
const PLAIN = { picture: 'the picture', influential: 'who lights it' };
export const plain = (name) => PLAIN[name] ?? name.replaceAll('-', ' ');

const order = (modes) => {
    const rank = ({ name }) => (FIRST.includes(name) ? FIRST.indexOf(name) : FIRST.length);
    return [...modes].sort((a, b) => rank(a) - rank(b));
};

export class Modes {
    constructor(bar, app) {
        this.app = app;
        this.bar = new Choice(bar, (name) => this.#press(name));
        app.on('welcome', () => {
            const modes = order(app.schema.modes);
            this.bar.fill(modes.map((mode) => ({ name: mode.name, text: mode.name, title: mode.text })));
        });
        for (const kind of ['state', 'pressed']) app.on(kind, () => this.bar.set(app.show()));
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
        if (next) this.#press(next);
    }

    // Numbers are of the city's lights, of which a headlight has none.
    #press(name) {
        if (name !== 'picture') this.app.headlight(false);
        this.app.set('show', name);
    }
}
