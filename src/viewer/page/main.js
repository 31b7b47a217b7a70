// main.js: puts the page together.
import { Connection } from './connection.js';
import { App } from './app.js';
import { Panes } from './panes.js';
import { Input, MOVING } from './input.js';
import { Drawers, Settings } from './panels.js';
import { Modes } from './modes.js';
import { More } from './more.js';
import { Legend, DifferenceLegend } from './legend.js';
import { CityMap } from './map.js';
import { Ask } from './ask.js';
import { Layouts } from './compare.js';
import { Photo } from './photo.js';
import { Places } from './places.js';
import { Find } from './find.js';
import { Out } from './out.js';
import { Status } from './status.js';
import { Choice, typing, button } from './dom.js';
import { read, remember, restore, token } from './link.js';
import { help } from './help.js';

const $ = (id) => document.getElementById(id);

const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
const connection = new Connection(`${scheme}//${location.host}/ws?token=${encodeURIComponent(token(location.hash))}`);
const app = new App(connection);
const status = new Status($('status'), $('loading'), $('toasts'), app);
const panes = new Panes($('stage'), app);
const input = new Input($('stage'), panes, app);
const more = new More($('more'), $('laboratory'), app, { moving: $('moving'), tabs: $('tabs') });
const drawers = new Drawers($('tabs'), $('left'), $('right'), $('more'), (opened) => {
    if (opened) more.yield();
    panes.draw();
});
more.opened = () => ['left', 'right'].forEach((side) => drawers.close(side));
new Settings(app, drawers, panes);
new Modes($('views'), $('modes'), app);
new Legend($('legend'), $('stage'), app);
new DifferenceLegend($('legend-difference'), $('stage'), app);
const map = new CityMap(app, drawers, (light) => ask.lamp(light));
const ask = new Ask(app, drawers, map, panes, input);
const photo = new Photo(app, drawers, panes, input);
const places = new Places(app, drawers, new Find(app, drawers, ask));
const out = new Out(app, drawers, places, $('text'));
const layouts = new Layouts($('layouts'), app, panes);

const moving = new Choice($('moving'), (mode) => connection.send('navigate', { mode }));
moving.fill(MOVING.map(([name, text, title]) => ({ name, text, title })));
app.on('state', (state) => moving.set(state.navigate?.mode));
app.on('welcome', () => {
    $('scene-name').textContent = app.scene.name || 'Nocturne';
    document.title = app.scene.name ? `${app.scene.name} – Nocturne` : 'Nocturne';
});

// What is told once, to who does not see it.
app.on('said', (text) => ($('said').textContent = text));

input.on('pick', (hit) => (input.picker ? input.picker(hit) : ask.pick(hit)));
input.on('jump', (hit) => app.jump(hit));

// ---- the connection ----

let before = null; // what this client had set when the connection broke
let said = '';
function hello(again) {
    const size = panes.size();
    const text = `${size.width} ${size.height}`;
    if (!again && text === said) return;
    said = text;
    connection.send('hello', size);
}
let resized = 0;
app.on('size', () => {
    clearTimeout(resized);
    resized = setTimeout(() => connection.up && hello(false), 120);
});
connection.on('open', () => {
    hello(true);
    if (document.hidden) connection.send('watch', { on: false });
});
connection.on('closed', () => {
    if (app.state) before = remember(app);
});
function fromLink() {
    const view = read(location.hash);
    if (!view) return false;
    places.take(view.bookmarks);
    restore(app, view, true);
    return true;
}
app.on('ready', () => {
    const kept = before ?? reloaded();
    if (kept) restore(app, kept, false);
    else fromLink();
    before = null;
});
// A page that is loaded again is as it was, as long as its link is the same.
const KEPT = 'nocturne view';
window.addEventListener('pagehide', () => {
    try {
        if (app.state) sessionStorage.setItem(KEPT, JSON.stringify({ hash: location.hash, view: remember(app) }));
    } catch {
        // the browser keeps nothing: the view begins anew
    }
});
function reloaded() {
    try {
        const kept = JSON.parse(sessionStorage.getItem(KEPT) ?? 'null');
        sessionStorage.removeItem(KEPT);
        return kept?.hash === location.hash ? kept.view : null;
    } catch {
        return null;
    }
}
window.addEventListener('hashchange', () => app.state && fromLink());
document.addEventListener('visibilitychange', () => connection.send('watch', { on: !document.hidden }));

// ---- keys ----

const next = (choice) => choice.names[(choice.names.indexOf(choice.name) + 1) % choice.names.length];
const ACTS = [
    ['Enter', 'Enter', 'who lights what is under the pointer?', () => ask.pick(input.target())],
    ['g', 'G', 'go to what is under the pointer', () => app.jump(input.target())],
    ['n', 'N', 'next way of moving', () => connection.send('navigate', { mode: next(moving) })],
    ['y', 'Y', 'next layout', () => app.setLayout(next(layouts.choice))],
    ['z', 'Z', 'headlight: the city without its lights, and back', () => app.headlight()],
    ['v', 'V', 'the mouse looks, until Escape', () => input.lock()],
    ['r', 'R', 'rectangle in the picture', () => ask.rectangle()],
    ['h', 'H', 'hide all but the picture', () => document.body.classList.toggle('bare')],
    ['f', 'F', 'full screen', () => fullScreen()],
    ['p', 'P', 'settings', () => drawers.toggle('Settings')],
    ['m', 'M', 'map', () => drawers.toggle('Map')],
    ['t', 'T', 'table of lights', () => drawers.toggle('Lights')],
    ['/', '/', 'find by name', () => places.find()],
    ['b', 'B', 'places and bookmarks', () => drawers.toggle('Places')],
    ['o', 'O', 'photograph', () => drawers.toggle('Photo')],
    ['u', 'U', 'out: save, link, command', () => drawers.toggle('Out')],
    ['?', '?', 'this list', () => showHelp()],
];
const told = [
    ['1 … 9, [ and ]', 'what is shown'],
    ...ACTS.map(([, key, text]) => [key, text]),
    ['Escape', 'close, let go'],
];
const showHelp = () => help($('help'), told);

// Escape, wherever the focus is: what was begun is left, then what is open is closed.
function letGo() {
    const bare = document.body.classList.contains('bare');
    document.body.classList.remove('bare');
    return (
        bare ||
        ask.cancelTool() ||
        map.cancel() ||
        photo.cancel() ||
        more.close(true) ||
        drawers.back() ||
        more.close()
    );
}

function fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else document.documentElement.requestFullscreen?.().catch(() => {});
}

document.addEventListener('keydown', (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'Escape' && !document.querySelector('dialog[open]') && letGo()) event.preventDefault();
    if (typing(event)) return;
    const act = ACTS.find(([key]) => key === (event.key.length === 1 ? event.key.toLowerCase() : event.key));
    if (!act || event.repeat) return;
    event.preventDefault();
    act[3]();
});
$('tabs').append(button('?', showHelp, { 'aria-label': 'Keys', title: 'key ?' }));

globalThis.viewer = app; // for who looks into the page by its console, and for tests
connection.connect();
