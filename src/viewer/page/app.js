// app.js: what the page knows: the schema, the state that the program last told, figures of the newest pictures. All
// panels read it here and hear of changes: welcome, state, pressed, stats, waiting, highlight, editing, picture.
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
    sent = 0; // messages that pictures answer: inputs, settings, layouts
    waiting = new Set(); // panes whose picture is not yet what is pressed
    #pressed = new Map(); // pane, -1: all -> number of the newest setting that was pressed, not pulled
    #shows = []; // modes that were pressed, and that no state answers yet: { n, pane, value }
    #edited = 0; // number of a pressed setting of the world whose version no state has told yet
    #version = 0; // of the world that pictures must show
    #changed = 0; // number of the newest setting of the world, pressed or pulled, that no state has told yet
    #lit = 'ris'; // the method before the headlight
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

    // pulled: by a slider, whose pictures follow it; else the picture waits for what is set.
    set(name, value, pane = this.editing, pulled = false) {
        const n = this.#say('set', { pane, name, value: String(value) });
        if (n && name === 'show') this.#shows.push({ n, pane, value });
        if (n && !pulled) this.#press(n, pane);
    }

    setWorld(name, value, pulled = false) {
        const n = this.#say('world', { name, value: String(value) });
        if (!n) return;
        this.#changed = n;
        if (pulled) return;
        this.#edited = n;
        this.#press(n, -1);
    }

    // Is the world set, and no state has told yet to what? Pictures that come meanwhile may be of either.
    get changing() {
        return this.#changed > 0;
    }

    // To the method that shows surfaces alone, and back to the one before.
    headlight(on = this.values().method !== 'headlight') {
        const { method } = this.values();
        if (on === (method === 'headlight')) return;
        if (on) this.#lit = method;
        this.set('method', on ? 'headlight' : this.#lit);
    }

    setLayout(name) {
        const n = ++this.sent;
        this.connection.send('layout', { name, n });
        this.#press(n, -1);
    }

    // Returns the message's number; 0: it was not sent.
    #say(t, values) {
        if (!fits(values.value)) {
            this.emit('note', 'error', `${values.name}: that text is too long.`);
            return 0;
        }
        const n = ++this.sent;
        this.connection.send(t, { ...values, n });
        return n;
    }

    #press(n, pane) {
        this.#pressed.set(this.#together ? -1 : pane, n);
        this.emit('pressed');
    }

    // Panes of a difference show one kind of numbers.
    get #together() {
        return this.state?.layout === 'difference';
    }

    // The mode of a pane that is pressed, whether the program has answered it or not.
    show(pane = Math.max(this.editing, 0)) {
        const newest = this.#shows.findLast((one) => one.pane < 0 || one.pane === pane || this.#together);
        return newest?.value ?? this.values(pane).show ?? 'picture';
    }

    // Returns true if a picture is of all that is pressed. made: { input, world, show, method } that it was made with.
    agrees(pane, made) {
        const { show, method } = made;
        const pressed = Math.max(this.#pressed.get(-1) ?? 0, this.#pressed.get(pane) ?? 0);
        const own = show === undefined || (show === this.show(pane) && method === this.values(pane).method);
        return own && made.input >= pressed && !this.#edited && made.world >= this.#version;
    }

    edit(pane) {
        this.editing = pane;
        this.emit('editing', pane);
        this.emit('state', this.state);
    }

    option(name) {
        return this.schema.look.find((one) => one.name === name) ?? this.schema.world.find((one) => one.name === name);
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
        this.#pressed.clear(); // what was lost with a connection is answered by none
        this.#shows = [];
        this.#edited = this.#version = this.#changed = 0;
        this.emit('welcome', message);
        if (message.state) this.#settle(message.state);
        this.emit('ready');
    }

    #settle(state) {
        this.state = state;
        if (state.input >= this.#changed) this.#changed = 0;
        this.#shows = this.#shows.filter(({ n }) => n > state.input);
        if (this.#edited && state.input >= this.#edited) {
            this.#edited = 0;
            this.#version = state.world.version;
        }
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
