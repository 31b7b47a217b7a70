// link.js: the view as text behind # of the link, and back. What is the default is left out.
import { same } from './controls.js';

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

// world: the settings of all clients, too; a link restores them, a reconnected client does not.
export function restore(app, view, world) {
    const { connection, schema } = app;
    const text = (values, options) =>
        Object.entries(values ?? {}).filter(([name]) => options.some((one) => one.name === name));
    if (view.layout && view.layout !== app.state?.layout) connection.send('layout', { name: view.layout });
    if (view.navigate) connection.send('navigate', view.navigate);
    if (view.camera) app.goTo(view.camera);
    (view.panes ?? []).forEach((values, pane) => {
        const own = Object.fromEntries(text(values, schema.look));
        for (const option of schema.look) {
            const now = app.state?.panes?.[pane]?.values?.[option.name];
            if (own[option.name] !== undefined) app.set(option.name, own[option.name], pane);
            else if (now !== undefined && !same(option, now)) app.set(option.name, option.value, pane);
        }
    });
    if (world) for (const [name, value] of text(view.world, schema.world)) app.setWorld(name, value);
}
