// panes.js: the pictures: one to six panes, each a canvas, with a second one above it for marks.
import { el, clamp, number } from './dom.js';
import { project } from './camera.js';
import { plain } from './modes.js';

const MOST_PIXELS = 1920 * 1080; // of all panes together, asked for
const LEAST = 16; // frames of both under which figures of a difference are those of noise
const ENOUGH = 64; // after so many they hardly are any more

export class Panes {
    panes = [];
    marks = []; // functions (context, pane, Panes) that draw above pictures

    constructor(root, app) {
        this.root = root;
        this.app = app;
        this.layout = 'single';
        this.split = 0.5; // of the divider
        this.share = 1; // of the window's resolution
        this.held = null; // { values, of, frozen, next }: A beside a divider keeps the scene's settings that it had
        this.aspect = 0; // that pictures have at least; 0: that of their pane
        app.on('picture', (picture) => this.#take(picture));
        app.on('state', (state) => this.#arrange(state));
        app.on('stats', () => this.#captions());
        app.on('pressed', () => this.#agree());
        app.connection.on('closed', () => this.#lost());
        app.on('highlight', () => this.draw());
        document.addEventListener('visibilitychange', () => this.#visible());
        new ResizeObserver(() => this.#sized()).observe(root);
        this.#arrange({ layout: 'single', panes: [{}] });
    }

    // What `hello` says: the pixels of one pane.
    size() {
        const box = this.panes[0].root.getBoundingClientRect();
        const all = this.layout === 'divider' ? 2 : this.panes.length;
        const ratio = Math.min(
            window.devicePixelRatio || 1,
            Math.sqrt(MOST_PIXELS / (box.width * box.height * all || 1)),
        );
        const side = (length) => clamp(Math.round(length * ratio * this.share), 16, 4096);
        return { width: side(box.width), height: side(Math.min(box.height, box.width / (this.aspect || 1e-9))) };
    }

    // Where a point of the window lies: { pane, x, y }, 0 to 1 in its picture; null beside it.
    at(clientX, clientY) {
        let pane = 0;
        if (this.layout === 'divider') {
            const box = this.root.getBoundingClientRect();
            pane = clientX - box.left > box.width * this.split ? 1 : 0;
        } else {
            pane = this.panes.findIndex(({ root }) => {
                const box = root.getBoundingClientRect();
                return clientX >= box.left && clientX <= box.right && clientY >= box.top && clientY <= box.bottom;
            });
        }
        if (pane < 0 || pane >= this.panes.length) return null;
        const box = this.panes[pane].root.getBoundingClientRect();
        const rect = this.rect(pane);
        const x = (clientX - box.left - rect.x) / rect.width,
            y = (clientY - box.top - rect.y) / rect.height;
        return x < 0 || x > 1 || y < 0 || y > 1 ? null : { pane, x, y };
    }

    // The rectangle of a pane that its picture fills, CSS pixels.
    rect(pane) {
        const { root, canvas } = this.panes[pane];
        const width = root.clientWidth,
            height = root.clientHeight;
        const fit = root.classList.contains('held') ? Infinity : width / canvas.width; // what is held keeps its height
        const scale = Math.min(fit, height / canvas.height);
        const size = { width: canvas.width * scale, height: canvas.height * scale };
        return { x: (width - size.width) / 2, y: (height - size.height) / 2, ...size };
    }

    // That of the picture in a pane.
    camera(pane) {
        return this.app.stats[pane]?.camera ?? this.app.camera;
    }

    // A place of the scene in a pane, CSS pixels; null where it is not seen.
    where(pane, place) {
        const camera = this.camera(pane);
        if (!camera || !place) return null;
        const rect = this.rect(pane);
        const at = project(camera, rect.width / rect.height, place);
        return at && [rect.x + at[0] * rect.width, rect.y + at[1] * rect.height];
    }

    // While A is held its picture stays as it is whenever the scene has other settings than now. It goes on where the
    // camera moves or A shows another mode, for what was held is another picture then.
    hold(on) {
        if (this.held?.next) this.#acknowledge(this.held.next);
        this.held = on ? { values: this.#settings(), of: null, frozen: false, next: null } : null;
        this.#freeze();
        this.app.emit('held', this.held !== null);
    }

    #settings() {
        return JSON.stringify(this.app.state?.world?.values ?? {});
    }

    #freeze() {
        const { held } = this;
        const frozen = held !== null && this.#settings() !== held.values;
        if (frozen && !held.frozen) held.of = this.#shows();
        if (held) held.frozen = frozen;
        this.panes[0].root.classList.toggle('held', frozen);
        this.#captions();
        this.#agree();
        if (!held?.next || this.app.changing) return;
        const { next } = held;
        held.next = null;
        this.#take(next);
    }

    // What the newest picture of A shows, by whatever lamps.
    #shows() {
        return JSON.stringify([this.camera(0), this.app.stats[0]?.show]);
    }

    // Does a picture of A, which is held, wait until it is told what the scene was set to?
    #waits(picture) {
        const waits = picture.pane === 0 && this.held && !this.held.frozen && this.app.changing;
        if (waits) this.held.next = picture;
        return waits;
    }

    // Is a picture of A one that is not shown, because A is held?
    #kept(picture) {
        if (picture.pane !== 0 || !this.held?.frozen) return false;
        if (this.#shows() === this.held.of) return true;
        const moved = JSON.stringify(this.camera(0)) !== JSON.stringify(JSON.parse(this.held.of)[0]);
        this.hold(false);
        const why = moved ? 'The camera has moved' : 'A shows another mode';
        this.app.emit('note', 'info', `${why}: A is not held any more.`);
        return false;
    }

    setSplit(split) {
        this.split = clamp(split, 0, 1);
        if (this.layout === 'divider' && this.panes[1])
            this.panes[1].root.style.clipPath = `inset(0 0 0 ${this.split * 100}%)`;
    }

    draw() {
        this.panes.forEach((pane, index) => {
            const { overlay, root } = pane;
            const ratio = window.devicePixelRatio || 1;
            const width = Math.round(root.clientWidth * ratio),
                height = Math.round(root.clientHeight * ratio);
            if (overlay.width !== width) overlay.width = width;
            if (overlay.height !== height) overlay.height = height;
            const context = overlay.getContext('2d');
            context.setTransform(ratio, 0, 0, ratio, 0, 0);
            context.clearRect(0, 0, root.clientWidth, root.clientHeight);
            for (const mark of this.marks) mark(context, index, this);
        });
    }

    #arrange(state) {
        const wanted = Math.max(state.panes?.length ?? 1, 1);
        const changed = wanted !== this.panes.length || state.layout !== this.layout;
        if ((state.layout ?? 'single') !== this.layout) this.#blank();
        this.layout = state.layout ?? 'single';
        while (this.panes.length > wanted) this.panes.pop().root.remove();
        while (this.panes.length < wanted) this.#add();
        this.states = state.panes ?? [];
        if (changed) this.#grid(wanted);
        if (this.held && this.layout !== 'divider') this.hold(false);
        this.#freeze();
        this.draw();
    }

    // Pictures of another layout would stand under names that are not theirs.
    #blank() {
        for (const pane of this.panes.slice(1)) {
            const { canvas, context } = pane;
            context.clearRect(0, 0, canvas.width, canvas.height);
            delete canvas.dataset.n;
            pane.made = null;
        }
    }

    #add() {
        const canvas = el('canvas', { class: 'picture', width: 16, height: 9, role: 'img', 'aria-label': 'Picture' });
        const overlay = el('canvas', { class: 'overlay', 'aria-hidden': 'true' });
        const caption = el('div', { class: 'caption' });
        const waits = el('p', { class: 'waits', role: this.panes.length ? null : 'status' });
        const lit = el('p', { class: 'lit', text: 'headlight: lit from the camera', hidden: true });
        const says = el('div', { class: 'says' }, waits, lit);
        const root = el('div', { class: 'pane', data: { pane: this.panes.length } }, canvas, overlay, caption, says);
        this.root.append(root);
        this.panes.push({
            root,
            canvas,
            overlay,
            caption,
            waits,
            lit,
            context: canvas.getContext('2d'),
            made: null, // what its picture was made with (App.agrees); null: none of this connection is there
            waiting: null,
            size: null,
        });
    }

    #grid(count) {
        this.root.dataset.layout = this.layout;
        for (const { root } of this.panes) root.style.clipPath = '';
        this.setSplit(this.split);
        const columns =
            this.layout === 'divider' ? 1 : bestColumns(count, this.root.clientWidth / this.root.clientHeight);
        this.root.dataset.columns = columns;
        this.root.dataset.rows = Math.ceil(count / columns);
        this.app.emit('size');
    }

    #sized() {
        this.#grid(this.panes.length);
        this.draw();
    }

    #captions() {
        this.panes.forEach(({ caption, root }, index) => {
            const stats = this.app.stats[index];
            const says = [this.states[index]?.caption ?? '', index === 0 && this.held?.frozen ? 'held' : ''];
            if (stats?.rmse !== undefined) says.push(...this.#difference(stats));
            caption.textContent = this.panes.length > 1 ? says.filter((one) => one).join(' · ') : '';
            root.classList.toggle('edited', this.panes.length > 1 && this.app.editing === index);
        });
    }

    // Its figures, as soon as they are of more than noise, or of all frames that there will be.
    #difference({ rmse, relmse, bias, frames }) {
        const last = Number(this.app.values(0).frames) || Infinity;
        const least = Math.min(LEAST, last);
        if (frames < least) return [`too early for figures: ${frames} of ${least} frames`];
        return [
            `RMSE ${number(rmse)} cd/m²`,
            `relMSE ${number(relmse)}`,
            `bias ${number(100 * (bias - 1), 2)} %`,
            frames < ENOUGH ? `early, after ${frames} ${frames === 1 ? 'frame' : 'frames'}` : '',
        ];
    }

    // Dims pictures that are not what is pressed, and says what is waited for. What states and pictures tell decides
    // that, and no clock.
    #agree() {
        const { app } = this;
        app.waiting.clear();
        this.panes.forEach(({ made, root, canvas, waits, lit }, index) => {
            const kept = made && index === 0 && this.held?.frozen; // by other lamps, as it is meant to be
            const agrees = kept ? made.show === app.show(0) : made && app.agrees(index, made);
            if (app.state && !agrees) app.waiting.add(index);
            const waiting = app.waiting.has(index);
            const { failed, caption } = this.states[index] ?? {};
            const name = caption === 'difference' ? 'the difference' : plain(app.show(index));
            waits.textContent = !waiting ? '' : failed ? `${name}: its frame failed` : `waiting for ${name}`;
            lit.hidden = made?.method !== 'headlight' || made.show !== 'picture';
            root.classList.toggle('waiting', waiting);
            canvas.setAttribute('aria-label', made?.show ? plain(made.show) : 'Picture');
            canvas.setAttribute('aria-busy', waiting);
        });
        app.emit('waiting');
    }

    // Pictures of a connection that broke are no answer to what is set in the next one.
    #lost() {
        for (const pane of this.panes) pane.made = null;
        if (this.held) this.held.next = null;
        this.#agree();
    }

    async #take(picture) {
        const pane = this.panes[picture.pane];
        const made = { ...this.app.stats[picture.pane], input: picture.input };
        if (!pane) return this.#acknowledge(picture); // of a layout that was left
        if (this.#waits(picture)) return;
        if (this.#kept(picture)) {
            this.app.shown(picture.input);
            return this.#acknowledge(picture);
        }
        let bitmap = null;
        try {
            bitmap = await createImageBitmap(new Blob([picture.body], { type: picture.type }));
        } catch {
            return this.#acknowledge(picture); // a broken picture is not shown, and holds nothing up
        }
        const { canvas, context } = pane;
        if (canvas.width !== bitmap.width) canvas.width = bitmap.width;
        if (canvas.height !== bitmap.height) canvas.height = bitmap.height;
        context.drawImage(bitmap, 0, 0);
        bitmap.close();
        canvas.dataset.n = picture.n;
        canvas.dataset.frames = picture.frames;
        canvas.dataset.input = picture.input;
        this.app.shown(picture.input);
        pane.made = made;
        pane.size = [picture.width, picture.height];
        this.#agree();
        this.draw();
        this.app.emit('shown', picture);
        this.#acknowledge(picture);
    }

    // A page that is not looked at asks for no more pictures.
    #acknowledge(picture) {
        if (document.hidden) this.panes[picture.pane] && (this.panes[picture.pane].waiting = picture);
        else this.app.connection.send('ack', { pane: picture.pane, n: picture.n });
    }

    #visible() {
        if (document.hidden) return;
        for (const pane of this.panes) {
            const waiting = pane.waiting;
            pane.waiting = null;
            if (waiting) this.#acknowledge(waiting);
        }
    }
}

// Columns of a grid whose cells are nearest to a picture's usual shape.
function bestColumns(count, aspect) {
    let best = 1,
        off = Infinity;
    for (let columns = 1; columns <= Math.min(count, 3); columns++) {
        const rows = Math.ceil(count / columns);
        const own = Math.abs(Math.log((aspect * rows) / columns / 1.6)) + 0.2 * (columns * rows - count);
        if (own < off) [best, off] = [columns, own];
    }
    return best;
}
