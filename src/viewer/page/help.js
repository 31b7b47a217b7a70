// help.js: what hands and keys do, in one place.
import { el, button } from './dom.js';

const MOVING = [
    ['drag, one finger', 'turn'],
    ['right drag, Shift + drag, two fingers', 'pan'],
    ['wheel, pinch', 'nearer and farther'],
    ['click, tap', 'who lights this?'],
    ['double click, double tap', 'go there'],
    ['W A S D, arrows', 'forward, left, back, right'],
    ['E or Space, Q', 'up, down'],
    ['Shift, X', 'faster, slower'],
    ['I J K L', 'turn'],
    ['+, −', 'nearer and farther'],
];

// keys: [key, what it does], as main.js has them.
export function help(dialog, keys) {
    const list = (pairs) =>
        el('dl', { class: 'keys' }, ...pairs.flatMap(([key, text]) => [el('dt', { text: key }), el('dd', { text })]));
    const columns = el('div', { class: 'columns' }, list(MOVING), list(keys));
    const close = button('Close', () => dialog.close());
    dialog.replaceChildren(el('h2', { id: 'help-title', text: 'Hands and keys' }), columns, close);
    dialog.showModal();
}
