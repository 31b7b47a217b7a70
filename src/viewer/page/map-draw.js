// map-draw.js: what the map draws, and the message that its data come in.
import { clamp, number } from './dom.js';
import { axes } from './camera.js';

const LABELS = 60; // names of streets at once

// A binary message of kind 3 as lists; moving: of cars alone.
export function readMap(body, moving) {
    const view = new DataView(body.buffer, body.byteOffset, body.byteLength);
    const found = moving ? { cars: [] } : { lights: [], cars: [], tracks: [], streets: [], buildings: null };
    const f32 = (at) => view.getFloat32(at, true);
    const u32 = (at) => view.getUint32(at, true);
    const size = { 1: 24, 2: 16, 3: 12, 5: 1, 6: 12, 7: 1 };
    let at = 0;
    while (at + 8 <= body.byteLength) {
        const kind = u32(at),
            count = u32(at + 4);
        at += 8;
        if (!size[kind] || at + count * size[kind] > body.byteLength) break;
        if (moving && kind !== 2) {
            at += count * size[kind];
            continue;
        }
        if (kind === 5) {
            found.buildings = readBuildings(view, at);
            at += count;
            continue;
        }
        if (kind === 7) {
            const bytes = new Uint8Array(body.buffer, body.byteOffset + at, count);
            const names = new TextDecoder().decode(bytes).split('\0');
            found.streets.forEach((street) => (street.name = names[street.line]));
            at += count;
            continue;
        }
        for (let i = 0; i < count; i++, at += size[kind]) {
            if (kind === 1) {
                const rgb = `rgb(${view.getUint8(at + 16)} ${view.getUint8(at + 17)} ${view.getUint8(at + 18)})`;
                found.lights.push({
                    place: [f32(at), f32(at + 4), f32(at + 8)],
                    lumens: f32(at + 12),
                    rgb,
                    kind: view.getUint8(at + 19),
                    light: u32(at + 20),
                });
            } else if (kind === 2) {
                found.cars.push({ place: [f32(at), f32(at + 4), f32(at + 8)], heading: f32(at + 12) });
            } else {
                const line = u32(at + 8),
                    all = kind === 6 ? found.streets : found.tracks;
                if (all.at(-1)?.line !== line) all.push({ line, points: [] });
                all.at(-1).points.push([f32(at), f32(at + 4)]);
            }
        }
    }
    found.lights?.sort((a, b) => a.kind - b.kind || (a.rgb < b.rgb ? -1 : a.rgb > b.rgb)); // few changes of colour
    return found;
}

// Where buildings are: corners in metres, and a picture of one pixel a cell.
function readBuildings(view, at) {
    const [x0, y0, x1, y1] = [0, 4, 8, 12].map((i) => view.getFloat32(at + i, true));
    const width = view.getUint32(at + 16, true),
        height = view.getUint32(at + 20, true);
    const picture = document.createElement('canvas');
    picture.width = width;
    picture.height = height;
    const pixels = new ImageData(width, height);
    for (let i = 0; i < width * height; i++)
        if (view.getUint8(at + 24 + i)) pixels.data.set([0x2b, 0x2f, 0x37, 255], 4 * i);
    picture.getContext('2d').putImageData(pixels, 0, 0);
    return { low: [x0, y0], high: [x1, y1], picture };
}

function buildings(map, context) {
    const found = map.data.buildings;
    if (!found) return;
    const [x0, y1] = map.to(found.low),
        [x1, y0] = map.to(found.high);
    context.drawImage(found.picture, x0, y0, x1 - x0, y1 - y0);
}

// What changes with the place and the scale alone is drawn once and kept: many lights take some time.
export function drawMap(map, context, width, height) {
    const ratio = window.devicePixelRatio || 1;
    const key = [...map.centre, map.scale, width, height, ratio, map.windows.checked, map.version].join();
    if (map.layer?.key !== key) {
        const picture = map.layer?.picture ?? document.createElement('canvas');
        picture.width = Math.round(width * ratio);
        picture.height = Math.round(height * ratio);
        const own = picture.getContext('2d');
        own.setTransform(ratio, 0, 0, ratio, 0, 0);
        drawStill(map, own, width, height);
        map.layer = { key, picture };
    }
    context.drawImage(map.layer.picture, 0, 0, width, height);
    cars(map, context);
    regions(map, context);
    camera(map, context);
    marks(map, context);
}

function drawStill(map, context, width, height) {
    context.fillStyle = '#0b0e14';
    context.fillRect(0, 0, width, height);
    grid(map, context, width, height);
    buildings(map, context);
    lines(map, context, map.data.streets, '#39435a', clamp(4 * map.scale, 1, 9));
    lines(map, context, map.data.tracks, '#2f5d62', 1);
    lights(map, context, width, height);
    labels(map, context, width, height);
}

// The scale: the longest of 1, 2, 5 times a power of ten that is not wider than so many pixels.
export function scaleOf(pixelsPerMetre, most) {
    const longest = most / pixelsPerMetre;
    const power = 10 ** Math.floor(Math.log10(longest));
    const metres = power * [5, 2, 1].find((one) => one * power <= longest);
    return { metres, text: metres >= 1000 ? `${number(metres / 1000)} km` : `${number(metres)} m` };
}

// Names of streets, along them: the longest first, each once, none over another.
function labels(map, context, width, height) {
    const near = ([x, y]) => x > -50 && y > -50 && x < width + 50 && y < height + 50;
    const shown = map.data.streets
        .filter(({ name }) => name)
        .map(({ name, points }) => ({ name, points: points.map((point) => map.to(point)).filter(near) }))
        .map((one) => ({ ...one, length: lengthOf(one.points) }))
        .sort((a, b) => b.length - a.length);
    const placed = [];
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    for (const { name, points, length } of shown) {
        if (placed.length === LABELS || length < 40) break;
        const wide = context.measureText(name).width;
        if (wide > length - 8 || placed.some((one) => one.name === name)) continue;
        const [from, at, to] = [-0.4 * wide, 0, 0.4 * wide].map((away) => along(points, length / 2 + away));
        const half = wide / 2 + 4;
        const over = (one) => Math.hypot(one.at[0] - at[0], one.at[1] - at[1]) < 0.7 * (one.half + half);
        const beyond = at[0] < 20 || at[1] < 8 || at[0] > width - 20 || at[1] > height - 8;
        if (beyond || placed.some(over)) continue;
        placed.push({ name, at, half });
        let angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
        if (Math.abs(angle) > Math.PI / 2) angle += Math.PI;
        context.save();
        context.translate(...at);
        context.rotate(angle);
        context.lineWidth = 3;
        context.strokeStyle = '#0b0e14';
        context.strokeText(name, 0, 0);
        context.fillStyle = '#c6d0e0';
        context.fillText(name, 0, 0);
        context.restore();
    }
    map.labels = placed.map(({ name }) => name);
}

const lengthOf = (points) =>
    points.reduce(
        (sum, point, i) => (i ? sum + Math.hypot(point[0] - points[i - 1][0], point[1] - points[i - 1][1]) : 0),
        0,
    );

// The point of a line so far from its beginning.
function along(points, length) {
    for (let i = 1; i < points.length; i++) {
        const [a, b] = [points[i - 1], points[i]];
        const own = Math.hypot(b[0] - a[0], b[1] - a[1]);
        if (own > 0 && length <= own) return [0, 1].map((k) => a[k] + (b[k] - a[k]) * Math.max(length / own, 0));
        length -= own;
    }
    return points.at(-1);
}

function grid(map, context, width, height) {
    const step =
        [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000].find((one) => one * map.scale > 60) ?? 20000;
    context.strokeStyle = '#161b24';
    context.lineWidth = 1;
    context.beginPath();
    const [x0, y1] = map.from(0, 0),
        [x1, y0] = map.from(width, height);
    for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) {
        const px = Math.round(map.to([x, 0])[0]) + 0.5;
        context.moveTo(px, 0);
        context.lineTo(px, height);
    }
    for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) {
        const py = Math.round(map.to([0, y])[1]) + 0.5;
        context.moveTo(0, py);
        context.lineTo(width, py);
    }
    context.stroke();
}

function lines(map, context, all, colour, width) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    for (const { points } of all)
        points.forEach((point, i) => context[i ? 'lineTo' : 'moveTo'](...map.to(point)));
    context.stroke();
}

function lights(map, context, width, height) {
    let last = null;
    for (const { place, lumens, rgb, kind } of map.data.lights) {
        if ((kind === 3 && !map.windows.checked) || kind === 4) continue; // cars are drawn as such
        const [x, y] = map.to(place);
        if (x < -9 || y < -9 || x > width + 9 || y > height + 9) continue;
        const lamp = kind === 1 || kind === 2;
        const size = clamp(
            (lamp ? 0.7 : 0.35) * Math.log10(Math.max(lumens, 1)) * clamp(Math.sqrt(map.scale), 0.5, 2),
            0.8,
            9,
        );
        context.globalAlpha = lumens > 0 ? (lamp ? 1 : 0.55) : 0.25;
        if (rgb !== last) context.fillStyle = last = rgb;
        if (kind === 3 || size < 1.5) context.fillRect(x - size / 2, y - size / 2, size, size);
        else {
            context.beginPath();
            context.arc(x, y, size, 0, 7);
            context.fill();
        }
        if (kind !== 2) continue;
        context.lineWidth = 1;
        context.strokeStyle = '#5fe0ff';
        context.strokeRect(x - size - 1.5, y - size - 1.5, 2 * size + 3, 2 * size + 3);
    }
    context.globalAlpha = 1;
}

function cars(map, context) {
    context.fillStyle = '#ff7d7d';
    for (const { place, heading } of map.data.cars) {
        const [x, y] = map.to(place);
        const long = clamp(2.2 * map.scale, 3, 12),
            wide = long * 0.55;
        const c = Math.cos(heading),
            s = -Math.sin(heading);
        context.beginPath();
        context.moveTo(x + c * long, y + s * long);
        context.lineTo(x - c * long - s * wide, y - s * long + c * wide);
        context.lineTo(x - c * long + s * wide, y - s * long - c * wide);
        context.fill();
    }
}

function regions(map, context) {
    const drawn =
        map.drawing?.kind === 'rect' && map.drawing.points[1]
            ? ((a, b) => [a, [b[0], a[1]], b, [a[0], b[1]]])(...map.drawing.points)
            : map.drawing?.points.length
              ? map.drawing.points
              : null;
    const rings = drawn ? [drawn] : (map.region ?? []);
    if (!rings.length) return;
    context.strokeStyle = context.fillStyle = '#7db4ff';
    context.lineWidth = 1.5;
    context.beginPath();
    for (const points of rings) {
        points.forEach((point, i) => context[i ? 'lineTo' : 'moveTo'](...map.to(point)));
        if (!map.drawing || map.drawing.kind === 'rect') context.closePath();
    }
    context.stroke();
    if (map.drawing) for (const point of rings[0]) context.fillRect(map.to(point)[0] - 3, map.to(point)[1] - 3, 6, 6);
    context.globalAlpha = 0.12;
    context.fill();
    context.globalAlpha = 1;
}

function camera(map, context) {
    const seen = map.app.camera;
    if (!seen) return;
    const [x, y] = map.to(seen.eye);
    const { forward, right } = axes(seen);
    const picture = map.app.stats[0]?.size ?? [16, 9];
    const half = Math.tan((seen.fov * Math.PI) / 360) * (picture[0] / picture[1]);
    const reach = 90;
    const ray = (side) => {
        const d = [forward[0] + right[0] * half * side, forward[1] + right[1] * half * side];
        const length = Math.hypot(...d) || 1;
        return [x + (d[0] / length) * reach, y - (d[1] / length) * reach];
    };
    context.fillStyle = 'rgb(255 255 255 / 14%)';
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(...ray(-1));
    context.lineTo(...ray(1));
    context.fill();
    context.fillStyle = '#fff';
    context.beginPath();
    context.arc(x, y, 4, 0, 7);
    context.fill();
}

function marks(map, context) {
    context.lineWidth = 2;
    for (const { place } of map.app.highlighted) {
        if (!place) continue;
        const [x, y] = map.to(place);
        context.strokeStyle = '#7dffb0';
        context.beginPath();
        context.arc(x, y, 9, 0, 7);
        context.stroke();
    }
    if (!map.place) return;
    const [x, y] = map.to(map.place);
    context.strokeStyle = '#ffd84d';
    context.beginPath();
    context.moveTo(x - 6, y);
    context.lineTo(x + 6, y);
    context.moveTo(x, y - 6);
    context.lineTo(x, y + 6);
    context.stroke();
}
