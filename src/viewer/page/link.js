// link.js: the view as text behind # of the link, and back. What is the default is left out.
import { same } from './controls.js';
import { isCamera } from './camera.js';
import { LAYOUTS } from './compare.js';
import { fits } from './connection.js';
import { MOVING } from './input.js';

const MOST_PANES = 6; // of a client

function changed(options, values = {}) {
    const found = {};
    for (const option of options)
        if (values[option.name] !== undefined && !same(option, values[option.name]))
            found[option.name] = values[option.name];
    return found;
}

// What a view is, for a link, and to be restored after the connection broke.
export function remember(app) {
    const { state, schema, camera } = app;
    return {
        v: 1,
        camera: camera && { eye: camera.eye, target: camera.target, fov: camera.fov },
        navigate: state?.navigate,
        layout: state?.layout,
        panes: (state?.panes ?? []).map((pane) => changed(schema.look, pane.values)),
        world: changed(schema.world, state?.world?.values),
    };
}

// What stands behind #: the token of the program, and the view.
const parts = (hash) => new URLSearchParams(hash.replace(/^#/, ''));
export const token = (hash) => parts(hash).get('token') ?? '';

export function link(app, bookmarks) {
    const view = { ...remember(app), bookmarks: bookmarks.cameras() };
    return `#token=${encodeURIComponent(token(location.hash))}&view=${encodeURIComponent(JSON.stringify(view))}`;
}

export function read(hash) {
    try {
        const view = JSON.parse(parts(hash).get('view') ?? 'null');
        return view?.v === 1 ? view : null;
    } catch {
        return null; // no link of ours
    }
}

// Anybody can write a link, and other pages of the host can write what the browser keeps: what no view has is left out.
function sane(view, schema) {
    const of = (value) => (value !== null && typeof value === 'object' ? value : {});
    const known = (choices, value) => choices.some(([name]) => name === value);
    const plain = (value) => ['string', 'number', 'boolean'].includes(typeof value) && fits(String(value));
    const values = (options, from) => {
        const own = options.filter(({ name }) => Object.hasOwn(of(from), name) && plain(from[name]));
        return Object.fromEntries(own.map(({ name }) => [name, from[name]]));
    };
    const { camera, navigate, layout, panes, world } = of(view);
    const { mode, speed } = of(navigate);
    const fast = typeof speed === 'number' && speed >= 0 && speed <= 1000;
    return {
        camera: isCamera(camera) ? camera : null,
        navigate: known(MOVING, mode) ? { mode, ...(fast ? { speed } : {}) } : null,
        layout: known(LAYOUTS, layout) ? layout : null,
        panes: (Array.isArray(panes) ? panes : []).slice(0, MOST_PANES).map((from) => values(schema.look, from)),
        world: values(schema.world, world),
    };
}

// The mode comes last: a look is refused whose method cannot show it. The ends of its bar come behind its scale.
const MODE = ['show', 'show-scale', 'show-range', 'isolines'];

function restoreLook(app, pane, own) {
    const { look } = app.schema;
    const now = app.state?.panes?.[pane]?.values;
    const same_preset = (own.preset ?? app.option('preset')?.value) === now?.preset;
    const say = (option) => {
        const value = own[option.name] ?? option.value;
        const known = now?.[option.name];
        if (own[option.name] !== undefined || !same_preset || !same(option, known)) app.set(option.name, value, pane);
    };
    if ((now?.show ?? 'picture') !== 'picture') app.set('show', 'picture', pane);
    const others = look.filter(({ name }) => name !== 'preset' && !MODE.includes(name));
    for (const option of [...look.filter(({ name }) => name === 'preset'), ...others]) say(option);
    for (const name of MODE) {
        const value = own[name] ?? (name === 'show' ? app.option('show')?.value : undefined);
        if (value !== undefined) app.set(name, value, pane);
    }
}

// world: the settings of all clients, too; a link restores them, a reconnected client does not.
export function restore(app, told, world) {
    const { connection, schema } = app;
    const view = sane(told, schema);
    if (view.layout && view.layout !== app.state?.layout) app.setLayout(view.layout);
    if (view.camera) app.goTo(view.camera);
    if (view.navigate) connection.send('navigate', view.navigate); // there: here may be no place to stand
    view.panes.forEach((values, pane) => restoreLook(app, pane, values));
    if (!world) return;
    for (const option of schema.world) {
        const value = view.world[option.name] ?? option.value;
        const now = app.state?.world?.values?.[option.name];
        if (String(value) !== String(now) && !same({ ...option, value }, now)) app.setWorld(option.name, value);
    }
}
