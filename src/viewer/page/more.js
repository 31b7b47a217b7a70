// more.js: what is behind More: layouts, the laboratory's modes, and in small windows all that has no room in the bar.
const KEPT = 'nocturne more';
const SMALL = '(max-width: 900px), (max-height: 480px)';
const NARROW = '(max-width: 1100px), (max-height: 480px)';

export class More {
    #small = window.matchMedia(SMALL);

    // panel: what the button discloses. moving, tabs: parts of the bar, which go to the panel where it is too short.
    constructor(button, panel, app, { moving, tabs }) {
        this.button = button;
        this.panel = panel;
        this.opened = () => {}; // called when it opens in a small window: there is room for one thing
        button.addEventListener('click', () => this.set(panel.hidden));
        this.#fit(moving, NARROW, () => panel.after(moving));
        this.#fit(tabs, SMALL, () => button.parentElement.append(tabs));
        this.#small.addEventListener('change', () => this.set(!panel.hidden));
        const says = button.appendChild(document.createElement('span'));
        for (const kind of ['state', 'pressed'])
            app.on(kind, () => {
                const behind = panel.querySelector(`[data-name="${app.show()}"]`);
                says.textContent = behind ? `: ${app.show()}` : '';
                button.classList.toggle('chosen', behind !== null);
            });
        this.set(this.#kept());
    }

    #fit(part, query, home) {
        const media = window.matchMedia(query);
        const put = () => (media.matches ? this.panel.prepend(part) : home());
        media.addEventListener('change', put);
        put();
    }

    // The page keeps whether it is open for as long as the browser keeps the session.
    #kept() {
        try {
            return sessionStorage.getItem(KEPT) === 'open';
        } catch {
            return false;
        }
    }

    set(open) {
        const inside = this.panel.contains(document.activeElement);
        this.panel.hidden = !open;
        this.button.setAttribute('aria-expanded', String(open));
        document.body.classList.toggle('more-open', open);
        if (!open && inside) this.button.focus();
        if (open && this.#small.matches) this.opened();
        try {
            sessionStorage.setItem(KEPT, open ? 'open' : 'closed');
        } catch {
            // the browser keeps nothing
        }
    }

    // Makes room for a panel in a small window.
    yield() {
        if (this.#small.matches && !this.panel.hidden) this.set(false);
    }

    // Closes it, and only if the focus is inside where that is asked. false: nothing was to be closed.
    close(inside = false) {
        if (this.panel.hidden || (inside && !this.panel.contains(document.activeElement))) return false;
        this.set(false);
        return true;
    }
}
