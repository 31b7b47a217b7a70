// status.js: figures of the picture, progress, notes, and the bar that says the program is away.
import { button, el, number, short } from './dom.js';

const WINDOW = 2000; // ms over which pictures are counted
const SHOWN = { error: 12000, warning: 8000, info: 4000 };

export class Status {
    #times = [];
    #latencies = [];
    #smoothed = []; // of each pane: is its newest picture?

    constructor(root, loading, toasts, app) {
        this.app = app;
        this.loading = loading;
        this.toasts = toasts;
        this.parts = {};
        for (const [name, title] of [
            ['pictures', 'pictures a second'],
            ['size', 'pixels of the picture'],
            ['frames', 'frames in its mean'],
            ['error', 'relative standard error of its mean'],
            ['rays', 'rays a second'],
            ['latency', 'from the hand to the picture, median'],
            ['aim', 'the dot in the middle of the picture is where these keys ask and go'],
            ['smoothed', 'this picture went through a filter for the eye; its numbers are no figures'],
        ]) {
            this.parts[name] = el('span', { class: name, title });
            root.append(this.parts[name]);
        }
        this.parts.aim.textContent = 'the dot: Enter asks who lights it, G goes there';
        app.on('shown', (picture) => this.#shown(picture));
        app.on('note', (level, text) => this.note(level, text));
        app.connection.on('t:note', ({ level, text }) => this.note(level, text));
        app.connection.on('t:loading', (message) => this.#load(message));
        app.connection.on('open', () => this.#wait('Connected', 0));
        app.connection.on('closed', (seconds) => this.#closed(seconds));
        app.on('welcome', ({ device }) => {
            this.parts.rays.title = `rays a second, by ${device}`;
            this.#wait('Drawing the first picture', 0);
        });
        setInterval(() => this.#tick(), 500);
        this.#wait('Connecting', 0);
    }

    note(level, text) {
        const toast = el('div', { class: `toast ${level}`, text, role: level === 'error' ? 'alert' : null });
        toast.addEventListener('click', () => toast.remove());
        this.toasts.append(toast);
        while (this.toasts.children.length > 5) this.toasts.firstChild.remove();
        setTimeout(() => toast.remove(), SHOWN[level] ?? SHOWN.info);
    }

    #wait(text, done) {
        this.loading.hidden = false;
        this.loading.replaceChildren(
            el('p', { text }),
            el('progress', { max: 1, value: done || null, 'aria-label': text }),
        );
    }

    #load({ what, done }) {
        this.#wait(what, done);
    }

    #closed(seconds) {
        this.#times = [];
        if (seconds === null) {
            this.#wait('Another viewer has this place, for nothing was done here for a while.', 0);
            this.loading.lastChild.replaceWith(button('Come back', () => this.app.connection.connect()));
            return;
        }
        const known = this.app.state !== null;
        this.#wait(
            `${known ? 'The program is away.' : 'The program is not there, or this link is an old one.'} ` +
                `Trying again in ${Math.max(1, Math.round(seconds))} s.`,
            0,
        );
    }

    #shown(picture) {
        const now = performance.now();
        this.loading.hidden = true;
        if (picture.pane === 0) this.#times.push(now);
        if (this.app.latency !== null) {
            this.#latencies.push(this.app.latency);
            this.app.latency = null;
            if (this.#latencies.length > 60) this.#latencies.shift();
        }
        const { size, frames, error } = this.parts;
        size.textContent = `${picture.width} × ${picture.height}`;
        frames.textContent = `${number(picture.frames, 6)} ${picture.frames === 1 ? 'frame' : 'frames'}`;
        error.textContent = Number.isFinite(picture.error) ? `error ${number(100 * picture.error, 2)} %` : '';
        this.#mark(picture);
        this.#tick();
    }

    // Which of the pictures went through the filter, by name where not all did.
    #mark(picture) {
        const panes = this.app.state?.panes ?? [];
        this.#smoothed[picture.pane] = picture.smoothed;
        this.#smoothed.length = Math.min(this.#smoothed.length, Math.max(panes.length, 1));
        const some = panes.filter((_, i) => this.#smoothed[i]).map(({ caption }) => caption);
        const names = some.length < panes.length ? `${some.join(', ')} ` : '';
        this.parts.smoothed.textContent = some.length ? `${names}smoothed, for display` : '';
    }

    #tick() {
        const now = performance.now();
        this.#times = this.#times.filter((time) => now - time < WINDOW);
        const { pictures, rays, latency } = this.parts;
        pictures.textContent = `${number(this.#times.length / (WINDOW / 1000), 2)} pictures/s`;
        const all = this.app.stats.reduce((sum, one) => sum + (one?.rays || 0), 0);
        rays.textContent = all ? `${short(all)} rays/s` : '';
        const sorted = [...this.#latencies].sort((a, b) => a - b);
        latency.textContent = sorted.length ? `${number(sorted[sorted.length >> 1], 2)} ms latency` : '';
    }
}
