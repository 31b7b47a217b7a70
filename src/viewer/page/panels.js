// panels.js: drawers with panels, and the panel of settings, which the schema makes.
import { el, button } from './dom.js';
import { Control, groupWords, same, toGroup } from './controls.js';

// What the tabs open: a drawer at each side; on a narrow window, one at a time.
export class Drawers {
    #panels = new Map();

    // home: what has the focus after a panel whose tab is not seen. changed(opened): told when a panel opens or closes.
    constructor(tabs, left, right, home, changed) {
        this.tabs = tabs;
        this.home = home;
        this.changed = changed;
        this.sides = { left, right };
        this.open = { left: null, right: null };
        this.newest = 'right'; // the side that was opened last
    }

    // A panel: name of its tab, side, element, and what is done when it is seen.
    add(name, side, root, key, seen = () => {}) {
        const tab = button(name, () => this.toggle(name), {
            'aria-expanded': 'false',
            title: `key ${key}`,
            'aria-keyshortcuts': key,
            'aria-controls': side,
        });
        const head = el(
            'div',
            { class: 'panel-head' },
            el('h2', { text: name }),
            button('×', () => this.toggle(name), { class: 'close', 'aria-label': `Close ${name}` }),
        );
        const panel = el('section', { class: 'panel', 'aria-label': name, hidden: true }, head, root);
        this.sides[side].append(panel);
        this.tabs.append(tab);
        this.#panels.set(name, { side, tab, panel, seen });
    }

    isOpen(name) {
        return this.open[this.#panels.get(name).side] === name;
    }

    toggle(name) {
        if (this.isOpen(name)) this.close(this.#panels.get(name).side);
        else this.show(name);
    }

    show(name, focus = true) {
        const { side, panel, seen } = this.#panels.get(name);
        if (window.matchMedia('(max-width: 900px)').matches) this.close(side === 'left' ? 'right' : 'left');
        if (!this.isOpen(name)) this.close(side);
        this.open[side] = name;
        this.newest = side;
        this.sides[side].hidden = false;
        panel.hidden = false;
        this.#told(side, true);
        seen();
        if (focus) panel.querySelector('.panel-head button').focus({ preventScroll: true });
    }

    close(side) {
        const name = this.open[side];
        if (!name) return;
        const { panel, tab } = this.#panels.get(name);
        const inside = panel.contains(document.activeElement);
        this.open[side] = null;
        panel.hidden = true;
        this.sides[side].hidden = true;
        this.#told(side);
        if (inside) (tab.offsetParent ? tab : this.home).focus();
    }

    #told(side, opened = false) {
        for (const [name, panel] of this.#panels)
            panel.tab.setAttribute('aria-expanded', this.open[panel.side] === name);
        document.body.classList.toggle(`${side}-open`, this.open[side] !== null);
        this.changed(opened);
    }

    // The side whose panel has the focus; undefined: none.
    focused() {
        return document.activeElement?.closest('.drawer')?.id;
    }

    // Closes the panel that has the focus, else the newest one. false: none is open.
    back() {
        const other = this.newest === 'left' ? 'right' : 'left';
        const side = this.focused() ?? (this.open[this.newest] ? this.newest : other);
        const some = this.open[side] !== null;
        this.close(side);
        return some;
    }
}

// Sets of values at once, with what they are; what the schema does not have is left out. Of a group of lights what is
// named is set: whether it is on, how bright, or which colour.
const PRESETS = [
    ['Evening, 19 h', { hour: 19, 'group.lamps': { on: true, scale: 1 } }],
    ['21 h', { hour: 21, 'group.lamps': { on: true, scale: 1 } }],
    ['Deep night, 3 h', { hour: 3, 'group.lamps': { on: true, scale: 1 } }],
    ['Deep night, 3 h, lamps at half', { hour: 3, 'group.lamps': { on: true, scale: 0.5 } }],
    ['After rain', { wet: 'on' }],
    ['Dry', { wet: 'off' }],
    ['All sodium', { 'group.lamps': { colour: '2000K' } }],
    ['All LED', { 'group.lamps': { colour: '4000K' } }],
    ['Lamps alone', { 'group.windows': { on: false }, 'group.cars': { on: false } }],
    ['Still', { preset: 'still' }],
    ['Moving', { preset: 'interactive' }],
];

const saysGroup = (value) =>
    typeof value !== 'object'
        ? value
        : Object.entries(value)
              .filter(([key]) => key !== 'on' || !('scale' in value))
              .map(([key, one]) => (key === 'on' ? (one ? 'on' : 'off') : one))
              .join(', ');

// What one looks for where a kind of options is meant.
const WORDS = { group: ['dim', 'dimming', 'off', 'on', 'brightness', 'colour', 'LED', 'sodium', 'kelvin'] };

export class Settings {
    #controls = new Map();
    #sections = [];

    constructor(app, drawers, panes) {
        this.app = app;
        this.panes = panes;
        this.search = el('input', {
            type: 'search',
            placeholder: 'Search settings',
            'aria-label': 'Search settings',
            on: { input: () => this.#filter(), keydown: (event) => this.#clear(event) },
        });
        this.which = el('div', {
            class: 'choice which',
            role: 'radiogroup',
            'aria-label': 'Which picture is set',
            hidden: true,
        });
        this.presets = el('div', { class: 'presets', role: 'group', 'aria-label': 'Presets' });
        this.list = el('div', { class: 'settings' });
        this.none = el('p', { class: 'quiet', text: 'No setting has these words.', hidden: true });
        const reset = button('All back to default', () => this.#reset(), { class: 'plain' });
        drawers.add(
            'Settings',
            'left',
            el(
                'div',
                { class: 'body' },
                this.search,
                this.which,
                this.presets,
                this.list,
                this.none,
                this.#size(),
                reset,
            ),
            'P',
            () => this.search.focus({ preventScroll: true }),
        );
        app.on('welcome', () => this.#make());
        app.on('state', () => this.#show());
        app.on('setting', (words) => {
            drawers.show('Settings');
            this.search.value = words;
            this.#filter();
        });
    }

    // Of this window alone: fewer pixels come faster.
    #size() {
        const parts = [
            ['1', 'all of the window'],
            ['0.75', '3/4'],
            ['0.5', 'half'],
            ['0.25', 'a quarter'],
        ];
        const box = el('select', { id: 'resolution' }, ...parts.map(([value, text]) => el('option', { value, text })));
        box.addEventListener('change', () => {
            this.panes.share = Number(box.value);
            this.app.emit('size');
        });
        return el('div', { class: 'tools' }, el('label', { for: 'resolution', text: 'Resolution' }), box);
    }

    #make() {
        const { look, world } = this.app.schema;
        const groups = new Map();
        const take = (options, set) => {
            for (const option of options) {
                if (option.group === 'Mode') continue; // the bar of modes and the legend have these
                if (!groups.has(option.group)) groups.set(option.group, []);
                groups.get(option.group).push([option, set]);
            }
        };
        take(look, (name, value, pulled) => this.app.set(name, value, this.app.editing, pulled));
        take(world, (name, value, pulled) => this.app.setWorld(name, value, pulled));
        const open = new Set(this.#sections.filter(({ root }) => root.open).map(({ name }) => name));
        if (!open.size) open.add([...groups.keys()][0]);
        this.#controls.clear();
        this.#sections = [...groups].map(([name, options]) => {
            const controls = options.map(([option, set]) => {
                const found = { ...option, found: () => this.app.ev100 };
                const control = new Control(found, (value, pulled) => set(option.name, value, pulled));
                this.#controls.set(option.name, control);
                return control;
            });
            const mark = el('span', { class: 'mark' });
            const root = el(
                'details',
                { open: open.has(name) },
                el('summary', {}, name, mark),
                ...this.#byClass(controls),
            );
            return { name, root, controls, mark };
        });
        this.list.replaceChildren(...this.#sections.map(({ root }) => root));
        this.#offer();
        this.#filter();
    }

    // Rows of a section; those of materials once more by class, material.CLASS.FIELD.
    #byClass(controls) {
        const rows = [],
            classes = new Map();
        for (const one of controls) {
            const [kind, name, field] = one.option.name.split('.');
            if (kind !== 'material' || !field) {
                rows.push(one.root);
                continue;
            }
            if (!classes.has(name)) {
                const root = el('details', { class: 'of-class' }, el('summary', { text: name }));
                classes.set(name, root);
                rows.push(root);
            }
            classes.get(name).append(one.root);
        }
        return rows;
    }

    #offer() {
        const known = PRESETS.filter(([, values]) => Object.keys(values).some((name) => this.app.option(name)));
        const says = (values) =>
            `sets ${Object.entries(values)
                .filter(([name]) => this.app.option(name))
                .map(([name, value]) => `${name.replace(/^group\./, '')} ${saysGroup(value)}`)
                .join(', ')}`;
        this.presets.replaceChildren(
            ...known.map(([name, values]) => button(name, () => this.apply(values), { title: says(values) })),
        );
        this.presets.hidden = !known.length;
    }

    apply(values) {
        for (const [name, given] of Object.entries(values)) {
            const control = this.#controls.get(name);
            const value = typeof given === 'object' ? toGroup({ ...groupWords(control?.value), ...given }) : given;
            control?.take(value);
            if (this.app.schema.world.some((one) => one.name === name)) this.app.setWorld(name, value);
            else if (this.app.schema.look.some((one) => one.name === name)) this.app.set(name, value);
        }
    }

    #show() {
        const { state } = this.app;
        if (!state) return;
        const several = (state.panes?.length ?? 1) > 1;
        for (const { name } of this.app.schema.world) this.#controls.get(name)?.share(several);
        const look = this.app.values();
        for (const [name, control] of this.#controls)
            control.show(look[name] ?? state.world?.values?.[name], this.app.idle(name));
        for (const { controls, mark } of this.#sections) {
            const changed = controls.filter((one) => !same(one.option, one.value)).length;
            mark.textContent = changed ? String(changed) : '';
            mark.title = `${changed} changed`;
        }
        this.#which(state.panes?.length ?? 1);
    }

    #which(count) {
        this.which.hidden = count < 2;
        if (count < 2) return;
        const names = this.app.state.panes.map(({ caption }, i) => [i, caption]);
        this.which.replaceChildren(
            el('span', { text: 'Sets picture' }),
            ...[...names, [-1, 'all']].map(([pane, text]) =>
                button(text, () => this.app.edit(pane), {
                    role: 'radio',
                    'aria-checked': String(this.app.editing === pane),
                }),
            ),
        );
    }

    #filter() {
        const words = this.search.value
            .toLowerCase()
            .split(/\s+/)
            .filter((one) => one);
        let any = false;
        for (const { name, root, controls } of this.#sections) {
            let found = 0;
            for (const { option, root: row } of controls) {
                const more = [...(option.choices ?? []), ...(WORDS[option.kind] ?? [])].join(' ');
                const text = `${name} ${option.name} ${option.help} ${more}`.toLowerCase();
                const hit = words.every((word) => text.includes(word));
                row.hidden = !hit;
                found += hit;
            }
            root.hidden = !found;
            for (const part of root.querySelectorAll('.of-class')) {
                part.hidden = !part.querySelector('.control:not([hidden])');
                if (words.length) part.open = true;
            }
            any ||= found > 0;
            if (words.length && found) root.open = true;
        }
        this.none.hidden = any || !words.length;
    }

    #clear(event) {
        if (event.key !== 'Escape' || !this.search.value) return;
        this.search.value = '';
        this.#filter();
        event.preventDefault();
    }

    #reset() {
        for (const [name, control] of this.#controls)
            if (!same(control.option, control.value)) this.apply({ [name]: control.option.value });
    }
}
