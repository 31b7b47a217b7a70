// map.js: the map beside the picture: lights, cars, tracks, the camera with what it sees; pan and zoom; a click goes
// there; rectangles and polygons are drawn here. Metres of the scene, north (y) is up.
import { el, button, byTouch, clamp, number } from './dom.js';
import { drawMap, readMap, scaleOf } from './map-draw.js';

const AGAIN = 1000; // ms between two looks at cars that move
const HOVER = 200; // ms that the pointer rests before a name is asked for
const LOW = 40; // m over the ground: who is lower lands where the place is seen

export class CityMap {
    data = { lights: [], cars: [], tracks: [], streets: [], buildings: null };
    version = 0; // of the data
    layer = null; // what was drawn of them
    labels = []; // names of streets that are shown
    centre = [0, 0];
    scale = 1; // CSS pixels a metre
    drawing = null; // rectangle or polygon that is being drawn: { kind, points, done }
    region = null; // that was asked about: [[x, y], ...]
    place = null; // that was asked about
    #frame = 0;
    #drag = null;
    #pointers = new Map();
    #asked = false;
    #timer = 0;
    #fitted = false;
    #bounds = ''; // of the city that is shown
    #hover = 0;
    #naming = 0; // the question for a name

    // lamp(light): a click on a light.
    constructor(app, drawers, lamp) {
        this.app = app;
        this.drawers = drawers;
        this.lamp = lamp;
        this.canvas = el('canvas', {
            class: 'map',
            tabindex: 0,
            role: 'application',
            'aria-label': 'Map. Arrow keys move it, plus and minus zoom, Enter goes to the middle.',
        });
        this.scaleBar = el('div', { class: 'map-scale', role: 'img' });
        this.tip = el('div', { class: 'map-tip', role: 'status', hidden: true });
        const box = el(
            'div',
            { class: 'map-box' },
            this.canvas,
            el('div', { class: 'map-north', role: 'img', 'aria-label': 'North is up', text: '↑ N' }),
            this.scaleBar,
            this.tip,
        );
        this.hint = el('p', { class: 'quiet' });
        this.windows = el('input', { type: 'checkbox', checked: true, on: { change: () => this.redraw() } });
        this.follow = el('input', { type: 'checkbox', on: { change: () => this.#following() } });
        const tools = el(
            'div',
            { class: 'tools' },
            button('Whole city', () => this.fit()),
            button('To the camera', () => this.#toCamera()),
            el('label', {}, this.follow, ' follow'),
            el('label', {}, this.windows, ' windows'),
        );
        const marks = el(
            'ul',
            { class: 'labels' },
            ...[
                ['lamp', 'mapped lamp'],
                ['inferred', 'inferred lamp'],
                ['window', 'window'],
                ['car', 'car'],
                ['camera', 'camera'],
            ].map(([kind, text]) => el('li', {}, el('span', { class: `swatch ${kind}` }), text)),
        );
        this.root = el('div', { class: 'body map-body' }, tools, box, marks, this.hint);
        drawers.add('Map', 'right', this.root, 'M', () => this.#seen());
        this.#listen();
        app.on('welcome', () => this.#welcome());
        app.on('shown', () => (this.follow.checked && this.#following(), this.redraw()));
        app.on('highlight', () => this.redraw());
        new ResizeObserver(() => (this.#fitted || this.fit(), this.redraw())).observe(this.canvas);
        this.#say();
    }

    get open() {
        return this.drawers.isOpen('Map');
    }

    // Draws a region: kind rect or polygon, or null for none; done(points) has its corners.
    draw(kind, done) {
        this.drawing = kind && { kind, points: [], done };
        this.#say();
        this.redraw();
    }

    // false: nothing is being drawn.
    cancel() {
        const some = this.open && this.drawing !== null;
        if (some) this.draw(null);
        return some;
    }

    fit() {
        const bounds = this.app.scene.bounds?.flat();
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (!bounds || !width || !height) return;
        this.#fitted = true;
        this.centre = [(bounds[0] + bounds[3]) / 2, (bounds[1] + bounds[4]) / 2];
        this.scale =
            0.95 * Math.min(width / Math.max(bounds[3] - bounds[0], 1), height / Math.max(bounds[4] - bounds[1], 1));
        this.redraw();
    }

    redraw() {
        if (!this.#frame && this.open) this.#frame = requestAnimationFrame(() => ((this.#frame = 0), this.#draw()));
    }

    #say() {
        const words = byTouch()
            ? {
                  rect: 'Draw a rectangle on the map with a finger.',
                  polygon: 'Tap the corners; a double tap ends.',
                  none: 'A tap goes there, a tap on a light asks about it. A finger moves the map, two zoom.',
              }
            : {
                  rect: 'Drag a rectangle on the map.',
                  polygon: 'Click the corners; Enter or a double click ends. Escape: no polygon.',
                  none: 'A click goes there, a click on a light asks about it. Drag moves the map, the wheel zooms.',
              };
        this.hint.textContent = words[this.drawing?.kind ?? 'none'];
    }

    // Another city is seen as a whole first; of the same one the map stays as it was.
    #welcome() {
        const bounds = JSON.stringify(this.app.scene.bounds);
        if (bounds !== this.#bounds) this.#fitted = false;
        this.#bounds = bounds;
        this.#asked = false;
        this.#seen();
    }

    #seen() {
        if (!this.open) return;
        if (!this.#fitted) this.fit();
        if (!this.#asked) this.#ask();
    }

    // All once; then what moves alone, as long as somebody looks.
    #ask(moving = false) {
        this.#asked = true;
        clearTimeout(this.#timer);
        this.app.ask('lights', moving ? { moving } : {}, (answer) => {
            if (!answer.body) return;
            Object.assign(this.data, readMap(answer.body, moving));
            if (!moving) this.version++;
            this.redraw();
            if (this.data.cars.length) this.#timer = setTimeout(() => this.#again(), AGAIN);
        });
    }

    #again() {
        if (this.open && !document.hidden) this.#ask(true);
        else this.#timer = setTimeout(() => this.#again(), AGAIN);
    }

    #toCamera() {
        const camera = this.app.camera;
        if (!camera) return;
        this.centre = camera.eye.slice(0, 2);
        this.scale = Math.max(this.scale, 1.5);
        this.redraw();
    }

    #following() {
        if (this.follow.checked && this.app.camera) this.centre = this.app.camera.eye.slice(0, 2);
        this.redraw();
    }

    // ---- from metres to CSS pixels and back ----

    to([x, y]) {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        return [width / 2 + (x - this.centre[0]) * this.scale, height / 2 - (y - this.centre[1]) * this.scale];
    }

    from(px, py) {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        return [this.centre[0] + (px - width / 2) / this.scale, this.centre[1] - (py - height / 2) / this.scale];
    }

    zoom(steps, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2) {
        const before = this.from(px, py);
        this.scale = clamp(this.scale * 1.2 ** steps, 1e-3, 200);
        const after = this.from(px, py);
        this.centre = [0, 1].map((i) => this.centre[i] + before[i] - after[i]);
        this.redraw();
    }

    #listen() {
        const { canvas } = this;
        const point = (event) => [event.offsetX, event.offsetY];
        canvas.addEventListener(
            'wheel',
            (event) => {
                event.preventDefault();
                this.zoom(-Math.sign(event.deltaY), ...point(event));
            },
            { passive: false },
        );
        canvas.addEventListener('pointerdown', (event) => {
            canvas.setPointerCapture(event.pointerId);
            this.#pointers.set(event.pointerId, point(event));
            this.#drag = { start: point(event), moved: false };
            if (this.drawing?.kind === 'rect') this.drawing.points = [this.from(...point(event))];
        });
        canvas.addEventListener('pointermove', (event) => this.#moved(event, point(event)));
        canvas.addEventListener('pointerup', (event) => this.#up(event, point(event)));
        canvas.addEventListener('pointercancel', (event) => this.#pointers.delete(event.pointerId));
        canvas.addEventListener('pointerleave', () => this.#untip());
        canvas.addEventListener('dblclick', () => this.#close());
        canvas.addEventListener('keydown', (event) => this.#key(event));
    }

    #moved(event, now) {
        const before = this.#pointers.get(event.pointerId);
        if (!before) return this.#over(now);
        this.#untip();
        const others = [...this.#pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
        this.#pointers.set(event.pointerId, now);
        if (Math.hypot(now[0] - this.#drag.start[0], now[1] - this.#drag.start[1]) > 4) this.#drag.moved = true;
        if (others.length) {
            const spread = (at) => Math.hypot(at[0] - others[0][0], at[1] - others[0][1]) || 1;
            this.zoom(
                Math.log(spread(now) / spread(before)) / Math.log(1.2),
                (now[0] + others[0][0]) / 2,
                (now[1] + others[0][1]) / 2,
            );
        } else if (this.drawing?.kind === 'rect') {
            this.drawing.points[1] = this.from(...now);
        } else {
            this.centre = [
                this.centre[0] - (now[0] - before[0]) / this.scale,
                this.centre[1] + (now[1] - before[1]) / this.scale,
            ];
        }
        this.redraw();
    }

    #up(event, at) {
        this.#pointers.delete(event.pointerId);
        const clicked = this.#drag && !this.#drag.moved;
        if (this.drawing?.kind === 'rect') {
            const [a, b] = this.drawing.points;
            if (a && b) this.#settle([a, [b[0], a[1]], b, [a[0], b[1]]]);
        } else if (clicked && this.drawing) {
            this.drawing.points.push(this.from(...at));
        } else if (clicked) this.#click(at);
        this.redraw();
    }

    #close() {
        if (this.drawing?.kind !== 'polygon') return;
        // The second click of a double one lies where the first did.
        const points = this.drawing.points.filter(
            (point, i, all) => !i || Math.hypot(point[0] - all[i - 1][0], point[1] - all[i - 1][1]) * this.scale > 3,
        );
        if (points.length >= 3) this.#settle(points);
    }

    #settle(points) {
        const { done } = this.drawing;
        this.draw(null);
        done(points);
    }

    #click(at) {
        const near = this.#nearest(at);
        if (near) return this.lamp(near);
        this.goTo(this.from(...at));
    }

    #nearest(at) {
        let best = null,
            distance = 7;
        for (const light of this.data.lights) {
            if (light.kind === 4) continue;
            if (light.kind === 3 && (!this.windows.checked || this.scale < 2)) continue;
            const [x, y] = this.to(light.place);
            const own = Math.hypot(x - at[0], y - at[1]);
            if (own < distance) [best, distance] = [light, own];
        }
        return best;
    }

    // ---- names of what the pointer rests on ----

    #untip() {
        clearTimeout(this.#hover);
        this.app.cancel(this.#naming);
        this.tip.hidden = true;
    }

    #over(at) {
        this.#untip();
        this.#hover = setTimeout(() => this.#name(at, this.#nearest(at)), HOVER);
    }

    #name(at, light) {
        const tell = (text) => {
            this.tip.textContent = text;
            this.tip.hidden = !text;
            const right = at[0] > this.canvas.clientWidth / 2;
            this.tip.style.left = right ? '' : `${at[0] + 12}px`;
            this.tip.style.right = right ? `${this.canvas.clientWidth - at[0] + 12}px` : '';
            this.tip.style.top = `${clamp(at[1] - 12, 0, this.canvas.clientHeight - 28)}px`;
        };
        const about = light ? { light: light.light } : { at: this.from(...at) };
        this.#naming = this.app.ask('name', about, (answer) => {
            if (answer.refused) return;
            if (light) tell(`${answer.name || `${answer.kind} ${answer.light}`}, ${number(answer.lumens)} lm`);
            else if (answer.street) tell(answer.street);
            else tell(answer.building ? answer.object || 'building' : '');
        });
    }

    // To where a place is seen; who flies high stays as high, with what it turns about, or its eye, over the place.
    goTo(place) {
        this.app.ask('name', { at: place.slice(0, 2) }, (answer) => {
            const camera = this.app.camera;
            if (camera && answer.place && camera.eye[2] - answer.place[2] < LOW) this.app.look(answer.place);
            else this.#shift(place);
        });
    }

    #shift(place) {
        const camera = this.app.camera;
        if (!camera) return;
        const from = this.app.state?.navigate?.mode === 'orbit' ? camera.target : camera.eye;
        const by = [place[0] - from[0], place[1] - from[1], 0];
        const shift = (one) => one.map((x, i) => x + by[i]);
        this.app.goTo({ eye: shift(camera.eye), target: shift(camera.target), fov: camera.fov });
    }

    #key(event) {
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (step) this.centre = this.centre.map((x, i) => x + (step[i] * 40) / this.scale);
        else if (event.key === '+' || event.key === '=') this.zoom(1);
        else if (event.key === '-') this.zoom(-1);
        else if (event.key === 'Enter') this.drawing ? this.#enter() : this.goTo(this.centre);
        else if (event.key === ' ' && this.drawing) this.drawing.points.push([...this.centre]);
        else return;
        event.preventDefault();
        event.stopPropagation();
        this.redraw();
    }

    // By keys the space bar sets corners in the middle of the map; two are a rectangle.
    #enter() {
        const [a, b] = this.drawing.points;
        if (this.drawing.kind === 'polygon') this.#close();
        else if (a && b) this.#settle([a, [b[0], a[1]], b, [a[0], b[1]]]);
    }

    #draw() {
        const { canvas } = this;
        const ratio = window.devicePixelRatio || 1;
        const width = canvas.clientWidth,
            height = canvas.clientHeight;
        if (!width || !height) return;
        if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
        if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
        const { metres, text } = scaleOf(this.scale, 120);
        this.scaleBar.textContent = text;
        this.scaleBar.style.width = `${metres * this.scale}px`;
        this.scaleBar.setAttribute('aria-label', `Scale: this bar is ${text}`);
        const context = canvas.getContext('2d');
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        drawMap(this, context, width, height);
    }
}
