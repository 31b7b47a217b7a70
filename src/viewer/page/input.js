// input.js: mouse, wheel, keyboard and touch, gathered and sent once an animation frame; nothing is sent while nothing
// happens. Where the camera may go, the program decides.
import { Emitter, clamp, typing } from './dom.js';

// Ways of moving: name, what is shown, what is told.
export const MOVING = [
    ['orbit', 'Orbit', 'turn about what is looked at'],
    ['fly', 'Fly', 'go anywhere'],
    ['walk', 'Walk', 'at eye height, on the ground, not through walls'],
];
const HELD = {
    KeyW: 'forward',
    ArrowUp: 'forward',
    KeyS: 'back',
    ArrowDown: 'back',
    KeyA: 'left',
    ArrowLeft: 'left',
    KeyD: 'right',
    ArrowRight: 'right',
    KeyE: 'up',
    Space: 'up',
    PageUp: 'up',
    KeyQ: 'down',
    PageDown: 'down',
    ShiftLeft: 'fast',
    ShiftRight: 'fast',
    KeyX: 'slow',
};
const TURNING = { KeyJ: [-1, 0], KeyL: [1, 0], KeyI: [0, -1], KeyK: [0, 1] };
const ZOOMING = { Equal: 1, NumpadAdd: 1, Minus: -1, NumpadSubtract: -1 };
const ZOOM_SPEED = 6; // steps a second, by keys
const TURN_SPEED = 0.8; // heights of the picture a second, by keys
const CLICK = 5; // CSS pixels that a click may wander
const TWICE = 260; // ms between the clicks of a double one
const WHEEL_STEP = 100; // CSS pixels of a notch
const PINCH_STEP = 0.12; // of the logarithm of the fingers' distance

export class Input extends Emitter {
    #down = new Set(); // codes of keys
    #pointers = new Map(); // id -> [x, y]
    #gesture = null; // what the pointers do: turn, pan, pinch
    #turn = [0, 0];
    #pan = [0, 0];
    #zoom = 0;
    #at = [0.5, 0.5];
    #frame = 0;
    #last = 0;
    #idle = true;
    #click = null;

    // Tells of pick and jump ({ pane, x, y }), and of tool (event kind, hit), which may take a drag away.
    constructor(stage, panes, app) {
        super();
        this.stage = stage;
        this.panes = panes;
        this.app = app;
        this.picker = null; // what a pick does in place of asking
        this.tool = null; // { start(hit), drag(hit), end(hit) } while one selects in the picture
        stage.addEventListener('pointerdown', (event) => this.#press(event));
        stage.addEventListener('pointermove', (event) => this.#drag(event));
        for (const kind of ['pointerup', 'pointercancel'])
            stage.addEventListener(kind, (event) => this.#release(event));
        stage.addEventListener('dblclick', (event) => this.#twice(event));
        stage.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
        stage.addEventListener('contextmenu', (event) => event.preventDefault());
        document.addEventListener('keydown', (event) => this.#key(event, true));
        document.addEventListener('keyup', (event) => this.#key(event, false));
        window.addEventListener('blur', () => this.#letGo());
        document.addEventListener('pointerlockchange', () => this.#locked());
    }

    get locked() {
        return document.pointerLockElement === this.stage;
    }

    lock() {
        if (this.locked) document.exitPointerLock();
        else this.stage.requestPointerLock?.()?.catch?.(() => {});
    }

    #locked() {
        this.stage.classList.toggle('locked', this.locked);
        this.#wake();
    }

    #height() {
        return this.panes.rect(0).height || 1;
    }

    #press(event) {
        this.stage.focus({ preventScroll: true });
        const hit = this.panes.at(event.clientX, event.clientY);
        try {
            this.stage.setPointerCapture(event.pointerId);
        } catch {
            // a pointer that is gone already
        }
        this.#pointers.set(event.pointerId, [event.clientX, event.clientY]);
        if (this.tool && this.#pointers.size === 1 && event.button === 0) {
            this.#gesture = 'tool';
            if (hit) this.tool.start(hit);
            return;
        }
        const panning = event.button !== 0 || event.shiftKey;
        this.#gesture = this.#pointers.size > 1 ? 'pinch' : panning ? 'pan' : 'turn';
        this.#click =
            this.#pointers.size === 1 && event.button === 0 ? { x: event.clientX, y: event.clientY, hit } : null;
    }

    #drag(event) {
        const hit = this.panes.at(event.clientX, event.clientY);
        if (hit) this.#at = [hit.x, hit.y];
        if (this.locked) {
            this.#move(this.#turn, event.movementX, event.movementY);
            return;
        }
        const before = this.#pointers.get(event.pointerId);
        if (!before) return;
        const now = [event.clientX, event.clientY];
        const { spread, middle } = this.#fingers();
        this.#pointers.set(event.pointerId, now);
        if (this.#click && Math.hypot(now[0] - this.#click.x, now[1] - this.#click.y) > CLICK) this.#click = null;
        if (this.#gesture === 'tool') {
            if (hit) this.tool?.drag(hit);
        } else if (this.#gesture === 'pinch') {
            const after = this.#fingers();
            this.#move(this.#pan, after.middle[0] - middle[0], after.middle[1] - middle[1]);
            if (spread > 0 && after.spread > 0) this.#zoom += Math.log(after.spread / spread) / PINCH_STEP;
        } else if (!this.#click) {
            this.#move(this.#gesture === 'pan' ? this.#pan : this.#turn, now[0] - before[0], now[1] - before[1]);
        }
        this.#wake();
    }

    #fingers() {
        const [a, b] = [...this.#pointers.values()];
        if (!b) return { spread: 0, middle: a ?? [0, 0] };
        return { spread: Math.hypot(a[0] - b[0], a[1] - b[1]), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] };
    }

    #release(event) {
        if (!this.#pointers.delete(event.pointerId)) return;
        if (this.#gesture === 'tool') this.tool?.end(this.panes.at(event.clientX, event.clientY));
        else if (this.#click && event.type === 'pointerup') this.#clicked(this.#click.hit);
        this.#click = null;
        this.#gesture = this.#pointers.size === 1 ? 'turn' : null;
        this.#wake();
    }

    // One click picks, unless a second one follows: that goes there.
    #clicked(hit) {
        if (!hit) return;
        if (this.#timer) {
            this.#jump(hit);
            return;
        }
        this.#timer = setTimeout(() => {
            this.#timer = 0;
            this.emit('pick', hit);
        }, TWICE);
    }
    #timer = 0;

    #jump(hit) {
        clearTimeout(this.#timer);
        this.#timer = 0;
        this.emit('jump', hit);
    }

    // What the system takes for a double click is one, however late its second click is heard here.
    #twice(event) {
        const hit = this.panes.at(event.clientX, event.clientY);
        if (hit && this.#timer) this.#jump(hit);
    }

    // Where a key picks or goes to: under the pointer; the middle, where a dot is, without one.
    target() {
        const middle = this.locked || this.stage.matches(':focus-visible');
        const [x, y] = middle ? [0.5, 0.5] : this.#at;
        return { pane: Math.max(this.app.editing, 0), x, y };
    }

    #move(sum, x, y) {
        const height = this.#height();
        sum[0] += x / height;
        sum[1] += y / height;
        this.#wake();
    }

    #wheel(event) {
        event.preventDefault();
        const hit = this.panes.at(event.clientX, event.clientY);
        if (hit) this.#at = [hit.x, hit.y];
        const lines = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 300 : 1;
        this.#zoom -= (event.deltaY * lines) / WHEEL_STEP;
        this.#wake();
    }

    #key(event, down) {
        const known = event.code in HELD || event.code in TURNING || event.code in ZOOMING;
        if (!known) return;
        if (!down) {
            this.#down.delete(event.code);
            return this.#wake();
        }
        if (event.ctrlKey || event.metaKey || event.altKey || typing(event)) return;
        event.preventDefault();
        this.#down.add(event.code);
        this.#wake();
    }

    #letGo() {
        this.#down.clear();
        this.#pointers.clear();
        this.#gesture = null;
        this.#wake();
    }

    #wake() {
        if (this.#frame) return;
        this.#frame = requestAnimationFrame((now) => this.#send(now));
    }

    #send(now) {
        this.#frame = 0;
        const held = [...this.#down];
        const keys = [...new Set(held.map((code) => HELD[code]).filter((key) => key))];
        const steering = held.filter((code) => code in TURNING || code in ZOOMING);
        const fresh = this.#idle; // after a rest, time begins anew
        const seconds = fresh ? 1 / 60 : Math.min((now - this.#last) / 1000, 0.25);
        this.#last = now;
        for (const code of steering)
            if (code in ZOOMING) this.#zoom += ZOOMING[code] * ZOOM_SPEED * seconds;
            else for (const i of [0, 1]) this.#turn[i] += TURNING[code][i] * TURN_SPEED * seconds;
        const still = !keys.length && !steering.length;
        const nothing = still && !this.#zoom && !this.#turn.some(Boolean) && !this.#pan.some(Boolean);
        if (nothing && this.#idle) return;
        const sane = (values) => values.map((one) => clamp(one, -4, 4));
        this.app.move('input', {
            seconds,
            keys,
            turn: sane(this.#turn),
            pan: sane(this.#pan),
            zoom: clamp(this.#zoom, -50, 50),
            at: this.#at,
        });
        this.#turn = [0, 0];
        this.#pan = [0, 0];
        this.#zoom = 0;
        this.#idle = nothing;
        if (!still || !nothing) this.#wake();
    }
}
