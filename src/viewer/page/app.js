// app.js: what the page knows: the schema, the state that the program last told, figures of the newest pictures. All
// panels read it here and hear of changes: welcome, state, stats, highlight, editing, picture.
import { fits } from './connection.js';
import { Emitter } from './dom.js';

export class App extends Emitter {
    schema = { look: [], world: [], modes: [] };
    scene = {};
    cameras = [];
    state = null;
    stats = []; // of each pane, the newest
    editing = 0; // the pane that controls act on; -1: all
    highlighted = []; // rows of answers: { light, place }
    sent = 0; // inputs
    #times = new Map(); // number of an input -> when it was sent, ms
    #asked = 0;
    #questions = new Map();
    latency = null; // of the newest input that came back as a picture, ms

    constructor(connection) {
        super();
        this.connection = connection;
        connection.on('t:welcome', (message) => this.#welcome(message));
        connection.on('t:state', (message) => this.#settle(message));
        connection.on('t:stats', (message) => this.#figures(message));
        connection.on('t:answer', (message) => this.#answer(message));
        connection.on('binary', (binary) => this.#binary(binary));
        connection.on('closed', () => this.#broken());
    }

    // Settings: of the look that is edited, and of the world.
    values(pane = Math.max(this.editing, 0)) {
        const panes = this.state?.panes ?? [];
        return panes[Math.min(pane, panes.length - 1)]?.values ?? {};
    }

    idle(name) {
        const panes = this.state?.panes ?? [];
        return (
            panes[Math.min(Math.max(this.editing, 0), panes.length - 1)]?.idle?.[name] ??
            this.state?.world?.idle?.[name]
        );
    }

    set(name, value, pane = this.editing) {
        this.#say('set', { pane, name, value: String(value) });
    }

    setWorld(name, value) {
        this.#say('world', { name, value: String(value) });
    }

    #say(t, values) {
        if (fits(values.value)) this.connection.send(t, values);
        else this.emit('note', 'error', `${values.name}: that text is too long.`);
    }

    edit(pane) {
        this.editing = pane;
        this.emit('editing', pane);
        this.emit('state', this.state);
    }

    option(name) {
        return this.schema.look.find((one) => one.name === name) ?? this.schema.world.find((one) => one.name === name);
    }

    mode(pane = Math.max(this.editing, 0)) {
        const show = this.values(pane).show ?? 'picture';
        return this.schema.modes.find((one) => one.name === show) ?? { name: show, text: '', unit: '' };
    }

    // EV100 of the newest picture, of the pane that is edited; null where it shows numbers.
    get ev100() {
        return this.stats[Math.max(this.editing, 0)]?.ev100 ?? null;
    }

    // The camera of the picture that is seen.
    get camera() {
        return this.stats.find((one) => one?.camera)?.camera ?? this.state?.camera ?? null;
    }

    // Messages that a picture answers are numbered, for the round trip.
    move(t, values) {
        const n = ++this.sent;
        if (this.#times.size > 200) this.#times.clear();
        this.#times.set(n, performance.now());
        this.connection.send(t, { ...values, n });
    }

    goTo(camera) {
        this.move(
            'camera',
            typeof camera === 'string'
                ? { name: camera, ...this.#still() }
                : { eye: camera.eye, target: camera.target, fov: camera.fov },
        );
    }

    // To where a place is seen from about so many metres.
    look(place, distance = 25) {
        this.move('jump', { place, distance, ...this.#still() });
    }

    jump(hit) {
        this.move('jump', { ...hit, ...this.#still() });
    }

    // Who wants less motion is there at once.
    #still() {
        return window.matchMedia('(prefers-reduced-motion: reduce)').matches ? { still: true } : {};
    }

    shown(input) {
        const sent = this.#times.get(input);
        if (sent === undefined) return;
        this.latency = performance.now() - sent;
        for (const n of this.#times.keys()) if (n <= input) this.#times.delete(n);
    }

    // Asks, and has progress(message) told until its done is 1. Returns the question's id, for cancel.
    ask(what, values, progress) {
        const id = ++this.#asked;
        this.#questions.set(id, progress);
        if (Object.values(values).every((one) => typeof one !== 'string' || fits(one)))
            this.connection.send('ask', { id, what, ...values });
        else queueMicrotask(() => this.#answer({ id, done: 1, refused: 'Its name is too long to be asked about.' }));
        return id;
    }

    save(what, values = {}) {
        const id = ++this.#asked;
        this.connection.send('save', { id, what, ...values });
        return id;
    }

    cancel(id) {
        if (this.#questions.delete(id)) this.connection.send('cancel', { id });
    }

    highlight(rows) {
        this.highlighted = rows;
        this.emit('highlight', rows);
    }

    #welcome(message) {
        this.schema = { look: [], world: [], modes: [], ...message.schema };
        this.scene = message.scene ?? {};
        this.cameras = message.cameras ?? [];
        this.stats = [];
        this.#times.clear();
        this.state = null;
        this.emit('welcome', message);
        if (message.state) this.#settle(message.state);
        this.emit('ready');
    }

    #settle(state) {
        this.state = state;
        const panes = state.panes?.length ?? 1;
        this.stats.length = Math.min(this.stats.length, panes);
        if (this.editing >= panes) this.editing = 0;
        this.emit('state', state);
    }

    #figures(message) {
        this.stats[message.pane ?? 0] = message;
        this.emit('stats', message);
    }

    #answer(message) {
        const progress = this.#questions.get(message.id);
        if (!progress) return;
        if (message.done >= 1) this.#questions.delete(message.id);
        progress(message);
    }

    #binary(binary) {
        if (binary.kind === 3) {
            const progress = this.#questions.get(binary.n);
            this.#questions.delete(binary.n);
            progress?.(binary);
        } else this.emit(binary.kind === 1 ? 'picture' : 'file', binary);
    }

    #broken() {
        for (const progress of this.#questions.values()) progress({ done: 1, refused: 'The program went away.' });
        this.#questions.clear();
    }
}
