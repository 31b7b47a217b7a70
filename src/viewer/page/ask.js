// ask.js: who lights this? A click in the picture asks about a place; a rectangle, a polygon of the map or a building
// asks about a region. The answer is a ranked table, and each of its rows shows its light.
import { el, button, breaks, click, number, places } from './dom.js';

// Lines that are seen on bright and on dark pictures.
function rimmed(context, colour) {
    for (const [width, style] of [
        [5, 'rgb(0 0 0 / 75%)'],
        [2, colour],
    ]) {
        context.lineWidth = width;
        context.strokeStyle = style;
        context.stroke();
    }
}

const KINDS = {
    lamp: ['lamp', 'lamps'],
    window: ['window', 'windows'],
    car: ['light of cars', 'lights of cars'],
    surface: ['surface that shines', 'surfaces that shine'],
    other: ['other light', 'other lights'],
};

// "4 windows".
const kindWords = ({ kind, emitters }) =>
    kind in KINDS ? `${emitters.toLocaleString('en')} ${KINDS[kind][emitters === 1 ? 0 : 1]}` : kind;

// Lamps first, then windows, then the strongest.
const byKind = (kinds) => {
    const place = ({ kind }) => ['lamp', 'window', kind].indexOf(kind);
    return [...kinds].sort((a, b) => place(a) - place(b) || b.share - a.share);
};

// A table of a word and figures in each row.
function figures(kind, caption, heads, rows) {
    const cell = (text, i) => el('td', { class: i ? 'figure' : null, text });
    return el(
        'table',
        { class: `rows ${kind}` },
        el('caption', { class: 'hidden', text: caption }),
        el('thead', {}, el('tr', {}, ...heads.map((text) => el('th', { scope: 'col', text })))),
        el('tbody', {}, ...rows.map((row) => el('tr', {}, ...row.map(cell)))),
    );
}

export class Ask {
    #asked = 0; // the question that is shown
    #running = false;
    #answer = null;
    #what = '';
    #ranking = null; // the ranking that was left for a lamp's card: { what, answer, words, asked }
    #lit = new Set(); // lights whose rows are held
    #tool = null; // corners of the rectangle that is drawn in the picture
    #region = null; // that was asked: { values, camera, outline }

    constructor(app, drawers, map, panes, input) {
        this.app = app;
        this.drawers = drawers;
        this.map = map;
        this.panes = panes;
        this.input = input;
        this.building = button(
            'Whole object',
            () => {
                const { street, object } = this.#answer ?? {};
                if (street) this.street(street);
                else this.object(object, this.#answer);
            },
            { title: 'the building or street of the place that was asked about', disabled: true },
        );
        const tools = el(
            'div',
            { class: 'tools', role: 'group', 'aria-label': 'What is asked about' },
            button('Middle', () => this.pick({ pane: Math.max(app.editing, 0), x: 0.5, y: 0.5 }), {
                title: 'the middle of the picture',
            }),
            (this.rect = button('Rectangle', () => this.rectangle(), {
                title: 'drag it in the picture',
                'aria-pressed': 'false',
            })),
            button('Rectangle on map', () => this.#onMap('rect')),
            button('Polygon on map', () => this.#onMap('polygon')),
            this.building,
            (this.clear = button('Clear', () => this.#clear(), {
                title: 'no region, no answer',
                disabled: true,
            })),
        );
        this.out = el(
            'div',
            { class: 'answer', tabindex: -1, role: 'region', 'aria-label': 'Answer' },
            el('p', { class: 'quiet', text: `${click()} a place in the picture, or choose a region.` }),
        );
        drawers.add('Lights', 'right', el('div', { class: 'body' }, tools, this.out), 'T');
        panes.marks.push((context, pane) => this.#mark(context, pane));
        app.on('welcome', () => this.#forget());
    }

    pick(hit) {
        this.#outline(null);
        this.#ask('pixel', hit, 'this place');
    }

    street(street) {
        this.#about({ street }, street);
    }

    object(object, answer) {
        this.#about({ object }, `${answer ? this.#kind(answer) : 'object'} ${object}`);
    }

    lamp(light) {
        const answer = this.#answer;
        if (answer?.rows) this.#ranking = { answer, words: this.#what, asked: this.#asked };
        this.#ask('lamp', { light: light.light }, 'lamp');
        this.app.highlight([light]);
    }

    #back() {
        const { answer, words, asked } = this.#ranking;
        if (this.#running) this.app.cancel(this.#asked);
        this.app.highlight([]);
        this.#what = words;
        this.#asked = asked;
        this.#take('region', { ...answer, done: 1 });
        this.out.querySelector('tbody tr[tabindex]')?.focus();
    }

    // The next drag in the picture is a rectangle.
    rectangle() {
        if (this.input.tool) return this.#untool();
        const start = {};
        this.rect.setAttribute('aria-pressed', 'true');
        this.panes.root.classList.add('selecting');
        this.input.tool = {
            start: (hit) => Object.assign(start, hit),
            drag: (hit) => {
                if (hit.pane !== start.pane) return;
                this.#tool = {
                    pane: hit.pane,
                    rect: [
                        Math.min(start.x, hit.x),
                        Math.min(start.y, hit.y),
                        Math.max(start.x, hit.x),
                        Math.max(start.y, hit.y),
                    ],
                };
                this.panes.draw();
            },
            end: () => {
                const drawn = this.#tool;
                this.#untool();
                if (drawn && drawn.rect[2] - drawn.rect[0] > 0.002 && drawn.rect[3] - drawn.rect[1] > 0.002)
                    this.#about(drawn, 'this rectangle of the picture');
            },
        };
    }

    cancelTool() {
        if (!this.input.tool) return false;
        this.#untool();
        return true;
    }

    #untool() {
        this.input.tool = null;
        this.#tool = null;
        this.rect.setAttribute('aria-pressed', 'false');
        this.panes.root.classList.remove('selecting');
        this.panes.draw();
    }

    #onMap(kind) {
        this.drawers.show('Map');
        this.map.draw(kind, (polygon) =>
            this.#about({ polygon }, kind === 'rect' ? 'this rectangle of the map' : 'this polygon of the map'),
        );
    }

    #about(values, what) {
        this.#outline({ values, camera: this.panes.camera(values.pane ?? 0), outline: null });
        this.#ask('region', values, what);
    }

    // What is shown of a region until another one is asked about.
    #outline(region) {
        this.#region = region;
        this.map.region = region?.values.polygon ? [region.values.polygon] : null;
        this.map.redraw();
        this.panes.draw();
    }

    #clear() {
        if (this.#running) this.app.cancel(this.#asked);
        this.#running = false;
        this.#outline(null);
        this.#forget();
        this.out.replaceChildren(
            el('p', { class: 'quiet', text: `${click()} a place in the picture, or choose a region.` }),
        );
        this.map.redraw();
        this.panes.draw();
    }

    #forget() {
        this.#answer = null;
        this.#ranking = null;
        this.map.place = null;
        this.building.disabled = this.clear.disabled = true;
        this.app.highlight([]);
    }

    #ask(what, values, words) {
        if (this.#running) this.app.cancel(this.#asked);
        this.#what = words;
        this.#lit.clear();
        this.app.highlight([]);
        const inside = this.drawers.focused();
        this.drawers.show('Lights', false);
        if (inside) this.out.focus({ preventScroll: true }); // whose row or button may go
        this.clear.disabled = false;
        this.out.replaceChildren(el('p', { class: 'quiet', role: 'status', text: 'Asking …' }));
        this.#running = true;
        this.#asked = this.app.ask(what, values, (answer) => this.#take(what, answer));
    }

    #take(what, answer) {
        this.#running = answer.done < 1;
        if (answer.refused) {
            this.out.replaceChildren(el('p', { class: 'warn', text: answer.refused }));
            return;
        }
        this.#answer = answer;
        const { street, object } = what === 'lamp' ? {} : answer;
        this.building.disabled = !street && !object;
        this.building.textContent = `Whole ${street || (object ? this.#kind(answer) : 'object')}`;
        if (answer.outline && this.#region && !this.#region.outline) {
            this.#region.outline = answer.outline;
            this.map.region ??= answer.outline.map((ring) => ring.map((place) => place.slice(0, 2)));
        }
        if (answer.place) this.map.place = answer.place;
        if (what === 'lamp' && answer.place) this.app.highlight([{ light: answer.light, place: answer.place }]);
        this.map.redraw();
        if (answer.done >= 1) this.#tell(what, answer);
        const held = document.activeElement?.closest?.('tr')?.dataset.light;
        this.out.replaceChildren(
            ...(what === 'lamp' ? this.#lamp(answer) : this.#place(answer)),
            ...this.#table(answer),
        );
        if (held) this.out.querySelector(`tr[data-light="${held}"]`)?.focus();
        this.panes.draw();
    }

    #tell(what, answer) {
        const first = answer.rows?.[0];
        const most = first ? ` Most of it, ${number(100 * first.share)} %, by ${first.name || first.kind}.` : '';
        const kinds = byKind(answer.kinds ?? [])
            .map((one) => `${kindWords(one)} ${number(100 * one.share)} %`)
            .join(', ');
        const by = kinds && ` By kind: ${kinds}.`;
        const light =
            answer.lux !== undefined ? `${number(answer.lux)} lx.${by}${most}` : 'Nothing is there: the sky.';
        const lamp = `${answer.name || answer.kind}, ${number(answer.lumens)} lm.`;
        this.app.emit('said', what === 'lamp' ? lamp : `Who lights ${this.#what}? ${light}`);
    }

    #facts(pairs) {
        const list = el('dl', { class: 'facts' });
        for (const [name, value] of pairs)
            if (value !== undefined && value !== null && value !== '')
                list.append(el('dt', { text: name }), el('dd', {}, ...breaks(value)));
        return list;
    }

    #kind(answer) {
        if (['wall', 'roof', 'window', 'door', 'installation'].includes(answer.class)) return 'building';
        return { road: 'street', sidewalk: 'street' }[answer.class] ?? 'object';
    }

    #where(answer) {
        return [
            [(answer.crs?.name ?? 'CRS').replace(/ \(.*/, ''), answer.crs?.place && places(answer.crs.place)],
            ['scene', answer.place && `${places(answer.place)} m`],
        ];
    }

    #place(answer) {
        if (this.#what === 'this place' && !answer.place) return [el('p', { text: 'Nothing is there: the sky.' })];
        const lamp =
            answer.light !== undefined && answer.light !== null && answer.light >= 0
                ? button('This is a lamp: its card', () => this.lamp({ light: answer.light, place: answer.place }))
                : null;
        return [
            el('h3', { text: `Who lights ${this.#what}?` }),
            this.#facts([
                ...this.#where(answer),
                ['class', answer.class],
                ['street', answer.street],
                ['object', answer.object],
                ['area', answer.area && `${number(answer.area)} m²`],
                ['lamps', this.#estimate(answer.lamps, answer.lamps_error, 'lx')],
                ['windows', this.#estimate(answer.windows, answer.windows_error, 'lx')],
                ['all light', this.#estimate(answer.lux, answer.lux_error, 'lx')],
                ['maintenance', answer.maintenance < 1 && `lamps give ${answer.maintenance} of their flux`],
                ['luminance', this.#estimate(answer.luminance, answer.luminance_error, 'cd/m²')],
            ]),
            this.#classes(answer.classes ?? []),
            this.#kinds(answer.kinds ?? []),
            lamp,
        ].filter((one) => one);
    }

    // What a building's walls, roof and windows get; a street's road and pavements.
    #classes(classes) {
        if (classes.length < 2) return null;
        return figures(
            'surfaces',
            'Illuminance of its surfaces',
            ['surface', 'm²', 'lamps', 'windows', 'lx', '±'],
            classes.map((one) => [
                one.class,
                number(one.area),
                one.lamps === null ? '' : number(one.lamps),
                one.windows === null ? '' : number(one.windows),
                one.lux === null ? '' : number(one.lux),
                one.lux_error > 0 ? number(one.lux_error, 2) : '',
            ]),
        );
    }

    // What all lamps bring together, all windows, ...
    #kinds(kinds) {
        if (!kinds.length) return null;
        return figures(
            'kinds',
            'Sums by kind of light',
            ['by kind', 'share', '±', 'lx', '±'],
            byKind(kinds).map((one) => [
                kindWords(one),
                `${number(100 * one.share)} %`,
                one.error > 0 ? number(100 * one.error, 2) : '',
                number(one.lux),
                one.lux_error > 0 ? number(one.lux_error, 2) : '',
            ]),
        );
    }

    #estimate(value, error, unit) {
        if (value === undefined || value === null) return null;
        return `${number(value)}${error ? ` ± ${number(error, 2)}` : ''} ${unit}`;
    }

    #lamp(answer) {
        const kelvin = answer.kelvin ? `${number(answer.kelvin, 4)} K` : null;
        const go = answer.place ? button('Go there', () => this.app.look(answer.place)) : null;
        const back = this.#ranking ? button('Back to the ranking', () => this.#back()) : null;
        return [
            back,
            el('h3', { text: answer.name || `light ${answer.light ?? ''}` }),
            this.#facts([
                ['kind', answer.kind],
                ...this.#where(answer),
                ['height', Number.isFinite(answer.height) && `${number(answer.height)} m above ground`],
                ['flux', answer.lumens !== undefined && `${number(answer.lumens)} lm`],
                ['colour', kelvin],
                ['group', answer.group],
                ['street', answer.street],
                ['profile', answer.profile],
                ['power', answer.watts && `${number(answer.watts)} W`],
                ['file', answer.file],
                ...Object.entries(answer.tags ?? {}),
            ]),
            go,
            ...this.#reach(answer),
        ].filter((one) => one);
    }

    // What a lamp lights, as nocturne influence --lamp tells it.
    #reach({ reach, done, lumens }) {
        if (!reach) return done < 1 ? [el('p', { class: 'quiet', text: 'What it lights …' })] : [];
        const row = ({ name, class: kind, lumens: own }) =>
            el(
                'tr',
                {},
                el('td', {}, name || 'unnamed', ' ', el('span', { class: 'quiet', text: kind })),
                el('td', { class: 'figure', text: number(own) }),
                el('td', { class: 'figure', text: `${number((100 * own) / lumens)} %` }),
            );
        const heads = ['object', 'lm', 'of its flux'].map((text) => el('th', { scope: 'col', text }));
        return [
            el('h3', { text: 'What it lights' }),
            this.#facts([
                ['1 lx or more', `${number(reach.area)} m²`],
                ['brightest', `${number(reach.most)} lx`],
                ['0.1 lx as far as', reach.far > 0 && `${number(reach.far)} m`],
                ['meets surfaces', `${number(reach.met)} of ${number(lumens)} lm`],
                ['objects', reach.objects],
            ]),
            el(
                'table',
                { class: 'rows reach' },
                el('caption', { class: 'hidden', text: 'Objects by the light that they get of it' }),
                el('thead', {}, el('tr', {}, ...heads)),
                el('tbody', {}, ...reach.most_lit.map(row)),
            ),
        ];
    }

    #table(answer) {
        const rows = answer.rows ?? [];
        const progress =
            answer.done < 1
                ? el(
                      'div',
                      { class: 'tools' },
                      el('progress', { value: answer.done, max: 1, 'aria-label': 'Samples' }),
                      button('Enough', () => this.#enough()),
                  )
                : null;
        if (!rows.length)
            return [progress ?? (answer.rows ? el('p', { class: 'quiet', text: 'No light reaches it.' }) : '')];
        const most = Math.max(...rows.map((row) => row.share), 1e-9);
        const body = el('tbody', {}, ...rows.map((row, i) => this.#row(row, i, most)));
        const table = el(
            'table',
            { class: 'rows ranking' },
            el('caption', { class: 'hidden', text: 'Lights by what they bring' }),
            el(
                'thead',
                {},
                el('tr', {}, ...['', 'light', 'share', '±', 'lx'].map((text) => el('th', { scope: 'col', text }))),
            ),
            body,
        );
        const csv = answer.done >= 1 ? button('Save as CSV', () => this.app.save('csv', { of: this.#asked })) : null;
        return [progress, table, csv, answer.command ? this.#command(answer.command) : null].filter((one) => one);
    }

    // What asks the same in a terminal.
    #command(line) {
        const text = el('textarea', { class: 'command', readonly: true, rows: 3, 'aria-label': 'The same by command' });
        text.value = line;
        return el(
            'div',
            {},
            el('h3', { text: 'The same by command' }),
            text,
            button('Copy command', () => this.app.emit('copy', 'Command line', line)),
        );
    }

    #row(row, i, most) {
        const one = row.light >= 0;
        const named = row.name && row.name !== row.kind;
        const bar = el('span', { class: 'bar' });
        bar.style.width = `${(100 * row.share) / most}%`;
        const line = el(
            'tr',
            {
                data: { light: row.light },
                tabindex: one ? 0 : null,
                'aria-selected': one ? String(this.#lit.has(row.light)) : null,
            },
            el('td', { text: one ? i + 1 : '' }),
            el(
                'td',
                {},
                el('span', {}, ...breaks(named ? row.name : `${row.kind} ${one ? row.light : ''}`)),
                ' ',
                el('span', { class: 'quiet', text: named && one ? row.kind : '' }),
                bar,
            ),
            el('td', { class: 'figure', text: `${number(100 * row.share)} %` }),
            el('td', { class: 'figure quiet', text: row.error > 0 ? number(100 * row.error, 2) : '' }),
            el('td', { class: 'figure', text: number(row.lux) }),
        );
        if (!one) return line;
        const hold = () => {
            if (!this.#lit.delete(row.light)) this.#lit.add(row.light);
            line.setAttribute('aria-selected', this.#lit.has(row.light));
            this.#show(null);
        };
        const events = {
            click: hold,
            mouseenter: () => this.#show(row),
            mouseleave: () => this.#show(null),
            focus: () => this.#show(row),
            blur: () => this.#show(null),
            dblclick: () => this.lamp(row),
            keydown: (event) => {
                if (event.key === ' ') hold();
                else if (event.key === 'Enter') this.lamp(row);
                else if (event.key === 'ArrowDown' || event.key === 'ArrowUp')
                    (event.key === 'ArrowDown' ? line.nextSibling : line.previousSibling)?.focus?.();
                else return;
                event.preventDefault();
                event.stopPropagation();
            },
        };
        for (const [kind, act] of Object.entries(events)) line.addEventListener(kind, act);
        return line;
    }

    // The rectangle that was asked about, as long as its camera is there; else its outline in the scene, dashed.
    #markRegion(context, pane) {
        if (!this.#region || this.#tool) return;
        const { values, camera, outline } = this.#region;
        const now = this.panes.camera(pane);
        const same = (a, b) => a.every((x, i) => Math.abs(x - b[i]) < 1e-6 * (1 + Math.abs(x)));
        const here = camera && now && same(camera.eye, now.eye) && same(camera.target, now.target);
        context.strokeStyle = '#7db4ff';
        context.lineWidth = 1.5;
        context.beginPath();
        if (values.rect && here && pane === values.pane) {
            const rect = this.panes.rect(pane);
            const [x0, y0, x1, y1] = values.rect;
            context.rect(
                rect.x + x0 * rect.width,
                rect.y + y0 * rect.height,
                (x1 - x0) * rect.width,
                (y1 - y0) * rect.height,
            );
        } else {
            context.setLineDash([6, 4]);
            for (const ring of outline ?? []) {
                const points = [...ring, ...ring.slice(0, 1)].map((point) => this.panes.where(pane, point));
                points.forEach((at, i) => at && context[points[i - 1] ? 'lineTo' : 'moveTo'](...at));
            }
        }
        context.stroke();
        context.setLineDash([]);
    }

    #show(row) {
        const held = (this.#answer?.rows ?? []).filter((one) => this.#lit.has(one.light));
        this.app.highlight(row ? [row, ...held] : held);
    }

    #enough() {
        this.app.cancel(this.#asked);
        this.#running = false;
        if (this.#answer) this.#take('region', { ...this.#answer, done: 1 });
    }

    // The place, the lights of chosen rows, the rectangle: over the picture.
    #mark(context, pane) {
        if (this.#tool?.pane === pane) {
            const rect = this.panes.rect(pane);
            const [x0, y0, x1, y1] = this.#tool.rect;
            context.strokeStyle = '#7db4ff';
            context.lineWidth = 1.5;
            context.strokeRect(
                rect.x + x0 * rect.width,
                rect.y + y0 * rect.height,
                (x1 - x0) * rect.width,
                (y1 - y0) * rect.height,
            );
        }
        this.#markRegion(context, pane);
        const place =
            this.drawers.isOpen('Lights') && this.#what === 'this place'
                ? this.panes.where(pane, this.#answer?.place)
                : null;
        context.lineWidth = 2;
        for (const row of this.app.highlighted) {
            const at = this.panes.where(pane, row.place);
            if (!at) continue;
            context.beginPath();
            context.arc(at[0], at[1], 10, 0, 7);
            rimmed(context, '#7dffb0');
            if (!place) continue;
            context.globalAlpha = 0.6;
            context.setLineDash([4, 4]);
            context.beginPath();
            context.moveTo(...place);
            context.lineTo(...at);
            context.stroke();
            context.setLineDash([]);
            context.globalAlpha = 1;
        }
        if (!place) return;
        context.beginPath();
        for (const [x, y] of [
            [1, 0],
            [-1, 0],
            [0, 1],
            [0, -1],
        ]) {
            context.moveTo(place[0] + 3 * x, place[1] + 3 * y);
            context.lineTo(place[0] + 10 * x, place[1] + 10 * y);
        }
        rimmed(context, '#ffd84d');
    }
}
