// map-draw.js: what the map draws, and the message that its data come in.
import { clamp } from './dom.js';
import { axes } from './camera.js';

// A binary message of kind 3 as lists; moving: of cars alone.
export function readMap(body, moving) {
    const view = new DataView(body.buffer, body.byteOffset, body.byteLength);
    const found = moving ? { cars: [] } : { lights: [], cars: [], tracks: [], buildings: null };
    const f32 = (at) => view.getFloat32(at, true);
    const u32 = (at) => view.getUint32(at, true);
    const size = { 1: 24, 2: 16, 3: 12, 5: 1 };
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
                const line = u32(at + 8);
                if (found.tracks.at(-1)?.line !== line) found.tracks.push({ line, points: [] });
                found.tracks.at(-1).points.push([f32(at), f32(at + 4)]);
            }
        }
    }
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

export function drawMap(map, context, width, height) {
    context.fillStyle = '#0b0e14';
    context.fillRect(0, 0, width, height);
    grid(map, context, width, height);
    buildings(map, context);
    lines(map, context, map.data.tracks, '#2f5d62');
    lights(map, context, width, height);
    cars(map, context);
    regions(map, context);
    camera(map, context);
    marks(map, context);
}

function grid(map, context, width, height) {
    const step =
        [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000].find((one) => one * map.scale > 60) ?? 20000;
    map.scaleBar.textContent = `grid ${step >= 1000 ? `${step / 1000} km` : `${step} m`}`;
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

function lines(map, context, all, colour) {
    context.strokeStyle = colour;
    context.lineWidth = 1;
    context.beginPath();
    for (const { points } of all)
        points.forEach((point, i) => context[i ? 'lineTo' : 'moveTo'](...map.to(point)));
    context.stroke();
}

function lights(map, context, width, height) {
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
        context.fillStyle = rgb;
        context.strokeStyle = kind === 2 ? '#5fe0ff' : rgb;
        if (kind === 3 || size < 1.5) context.fillRect(x - size / 2, y - size / 2, size, size);
        else {
            context.beginPath();
            context.arc(x, y, size, 0, 7);
            context.fill();
        }
        if (kind !== 2) continue;
        context.lineWidth = 1;
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
    const points =
        map.drawing?.kind === 'rect' && map.drawing.points[1]
            ? ((a, b) => [a, [b[0], a[1]], b, [a[0], b[1]]])(...map.drawing.points)
            : map.drawing?.points.length
              ? map.drawing.points
              : map.region;
    if (!points) return;
    context.strokeStyle = context.fillStyle = '#7db4ff';
    context.lineWidth = 1.5;
    context.beginPath();
    points.forEach((point, i) => context[i ? 'lineTo' : 'moveTo'](...map.to(point)));
    if (!map.drawing || map.drawing.kind === 'rect') context.closePath();
    context.stroke();
    if (map.drawing) for (const point of points) context.fillRect(map.to(point)[0] - 3, map.to(point)[1] - 3, 6, 6);
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
