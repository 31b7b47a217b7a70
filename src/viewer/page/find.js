// find.js: streets, objects, lamps and groups by their names: what is found is asked about, or gone to.
import { el, button } from './dom.js';

const REST = 200; // ms after the last letter
const KINDS = { street: 'Streets', object: 'Buildings and objects', lamp: 'Lamps', group: 'Groups of lights' };

export class Find {
    #timer = 0;
    #asked = 0;

    constructor(app, drawers, ask) {
        this.app = app;
        this.drawers = drawers;
        this.ask = ask;
        this.field = el('input', {
            type: 'search',
            class: 'wide',
            maxlength: 100,
            placeholder: 'Find a street, building, lamp, group',
            'aria-label': 'Find a street, building, lamp or group by its name',
            on: { input: () => this.#later(), keydown: (event) => this.#key(event) },
        });
        this.said = el('p', { class: 'quiet', role: 'status' });
        this.list = el('div', { class: 'found' });
        this.root = el('div', { class: 'finder' }, this.field, this.said, this.list);
        app.on('welcome', () => this.#look());
    }

    #later() {
        clearTimeout(this.#timer);
        this.#timer = setTimeout(() => this.#look(), REST);
    }

    #key(event) {
        if (event.key === 'Enter') this.list.querySelector('button')?.click();
        else if (event.key === 'Escape' && this.field.value) this.field.value = '';
        else return;
        event.preventDefault();
        this.#later();
    }

    #look() {
        const text = this.field.value.trim();
        this.app.cancel(this.#asked);
        if (!text) return this.#show([], '');
        this.#asked = this.app.ask('find', { text }, (answer) => {
            if (answer.refused) return this.#show([], answer.refused);
            const more = answer.more ? ` and ${answer.more} more` : '';
            const count = answer.found.length;
            const nearest = answer.near.length ? 'Nothing is called so. The nearest names:' : 'Nothing is called so.';
            this.#show(count ? answer.found : answer.near, count ? `${count} found${more}` : nearest);
        });
    }

    #show(found, said) {
        this.said.textContent = said;
        this.list.replaceChildren(
            ...Object.entries(KINDS).flatMap(([kind, text]) => {
                const rows = found.filter((one) => one.kind === kind).map((one) => this.#row(one));
                return rows.length ? [el('h3', { text }), el('ul', { 'aria-label': text }, ...rows)] : [];
            }),
        );
    }

    #row(one) {
        const acts = {
            street: ['who lights this street?', () => this.ask.street(one.name)],
            object: ['who lights this object?', () => this.ask.object(one.name)],
            lamp: ['what is known of this lamp', () => this.ask.lamp(one)],
            group: ['its setting', () => this.app.emit('setting', one.name)],
        };
        const [title, act] = acts[one.kind];
        const go = button('Go there', () => this.#go(one), { 'aria-label': `Go to ${one.name}` });
        return el(
            'li',
            { data: { kind: one.kind } },
            button(one.name, act, { class: 'name', title }),
            one.kind === 'group' ? null : go,
        );
    }

    #go(one) {
        if (one.place) return this.app.look(one.place);
        this.app.ask('name', { [one.kind]: one.name }, ({ place, refused }) => {
            if (place) this.app.look(place, 50);
            else this.app.emit('note', 'warning', refused);
        });
    }
}
