// connection.js: the WebSocket; docs/viewer-protocol.md has its messages. It comes back by itself when the program
// restarts or the tunnel breaks.
import { Emitter } from './dom.js';

const HEAD = 32;
const LONGEST_WAIT = 8; // seconds between two tries
const REPLACED = 4000; // the code with which it is closed when another client has its place
export const PICTURE = 1,
    FILE = 2,
    LIGHTS = 3;

const LONGEST_TEXT = 4096; // bytes
export const fits = (text) => new TextEncoder().encode(text).length <= LONGEST_TEXT;

// Texts as JSON is read: no half of a character, and no 0.
const plain = (key, value) => (typeof value === 'string' ? value.replaceAll(/[\0\p{Cs}]/gu, '') : value);

// The head of a binary message, and what follows it.
export function parse(buffer) {
    if (buffer.byteLength < HEAD) return null;
    const view = new DataView(buffer);
    const flags = view.getUint8(3);
    const name = view.getUint32(28, true);
    if (HEAD + name > buffer.byteLength) return null;
    return {
        kind: view.getUint8(0),
        pane: view.getUint8(1),
        type: view.getUint8(2) === 1 ? 'image/png' : 'image/jpeg',
        moving: (flags & 1) !== 0,
        smoothed: (flags & 2) !== 0,
        coloured: (flags & 4) !== 0,
        n: view.getUint32(4, true),
        input: view.getUint32(8, true),
        width: view.getUint16(12, true),
        height: view.getUint16(14, true),
        frames: view.getUint32(16, true),
        error: view.getFloat32(20, true),
        seconds: view.getFloat32(24, true),
        name: new TextDecoder().decode(new Uint8Array(buffer, HEAD, name)),
        body: new Uint8Array(buffer, HEAD + name),
        bytes: buffer.byteLength,
    };
}

export class Connection extends Emitter {
    #socket = null;
    #tries = 0;
    #timer = 0;

    // url: of the WebSocket. Tells open, closed (seconds until the next try; null: another client has this place, and
    // it does not try again by itself), each kind of text message as t:KIND, and binary ones as binary.
    constructor(url) {
        super();
        this.url = url;
    }

    get up() {
        return this.#socket?.readyState === WebSocket.OPEN;
    }

    connect() {
        clearTimeout(this.#timer);
        const socket = new WebSocket(this.url, 'nocturne-1');
        this.#socket = socket;
        socket.binaryType = 'arraybuffer';
        socket.onopen = () => this.emit('open');
        socket.onclose = ({ code }) => this.#closed(code);
        socket.onmessage = (event) => this.#message(event.data);
    }

    send(t, values = {}) {
        if (this.up) this.#socket.send(JSON.stringify({ ...values, t }, plain));
    }

    #message(data) {
        if (data instanceof ArrayBuffer) {
            const binary = parse(data);
            if (binary) this.emit('binary', binary);
            return;
        }
        const message = JSON.parse(data);
        this.#tries = 0; // it speaks: the next break is a new one
        this.emit(`t:${message.t}`, message);
    }

    #closed(code) {
        if (code === REPLACED) return this.emit('closed', null);
        const seconds = Math.min(LONGEST_WAIT, 0.5 * 2 ** this.#tries) * (0.8 + 0.4 * Math.random());
        this.#tries++;
        this.emit('closed', seconds);
        this.#timer = setTimeout(() => this.connect(), seconds * 1000);
    }
}
