// camera.js: where a place of the scene is in the picture, and cameras between cameras. Metres, z up, fov in degrees
// from the lower to the upper edge.

const FAR = 1e6; // m, that a camera may be away

// Is it a camera that the program takes?
export function isCamera(one) {
    const near = (x) => Math.abs(x) <= FAR && typeof x === 'number';
    const place = (at) => Array.isArray(at) && at.length === 3 && at.every(near);
    return (
        place(one?.eye) &&
        place(one.target) &&
        Math.hypot(...minus(one.target, one.eye)) >= 1e-3 &&
        typeof one.fov === 'number' &&
        one.fov >= 1 &&
        one.fov <= 170
    );
}

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));

export function axes(camera) {
    const forward = unit(minus(camera.target, camera.eye));
    let right = cross(forward, [0, 0, 1]);
    if (Math.hypot(...right) < 1e-6) right = [1, 0, 0]; // straight up or down
    right = unit(right);
    return { forward, right, up: cross(right, forward) };
}

// [x, y] from 0 to 1, the upper left corner is 0 0; null behind the camera.
export function project(camera, aspect, place) {
    const { forward, right, up } = axes(camera);
    const d = minus(place, camera.eye);
    const depth = dot(d, forward);
    if (depth <= 1e-3) return null;
    const half = Math.tan((camera.fov * Math.PI) / 360) * depth;
    return [0.5 + dot(d, right) / (2 * half * aspect), 0.5 - dot(d, up) / (2 * half)];
}

export function moved(camera, by) {
    const add = (a) => a.map((x, i) => x + by[i]);
    return { eye: add(camera.eye), target: add(camera.target), fov: camera.fov };
}

// A smooth curve (Catmull-Rom) through numbers a, b, c, d, at t from b to c.
const curve = (a, b, c, d, t) =>
    0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t * t * t);

// The camera at t, in legs, along a path of cameras.
export function along(cameras, t, loop) {
    const count = cameras.length;
    const leg = Math.floor(t);
    const at = (i) => cameras[loop ? ((i % count) + count) % count : Math.min(Math.max(i, 0), count - 1)];
    const four = [at(leg - 1), at(leg), at(leg + 1), at(leg + 2)];
    const mix = (of) => curve(...four.map(of), t - leg);
    // Directions are mixed as such: targets far and near would turn the eye by jumps.
    const looks = four.map((camera) => unit(minus(camera.target, camera.eye)));
    const reach = mix((camera) => Math.hypot(...minus(camera.target, camera.eye)));
    const look = unit([0, 1, 2].map((i) => curve(...looks.map((one) => one[i]), t - leg)));
    const eye = [0, 1, 2].map((i) => mix((camera) => camera.eye[i]));
    return { eye, target: eye.map((x, i) => x + look[i] * Math.max(reach, 0.1)), fov: mix((camera) => camera.fov) };
}
