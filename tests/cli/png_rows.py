"""Pixels of the 8-bit RGB pictures that the program writes."""
import struct
import zlib


def read(path):
    """Rows of (r, g, b)."""
    data, at, body = open(path, "rb").read(), 8, b""
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            w, h, depth, colours = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert (depth, colours) == (8, 2)
        elif kind == b"IDAT":
            body += data[at + 8:at + 8 + n]
        at += 12 + n
    raw, rows, last = zlib.decompress(body), [], bytearray(3 * w)
    for y in range(h):
        f, line = raw[y * (3 * w + 1)], bytearray(raw[y * (3 * w + 1) + 1:(y + 1) * (3 * w + 1)])
        for i in range(3 * w):
            a, b, c = (line[i - 3] if i > 2 else 0), last[i], (last[i - 3] if i > 2 else 0)
            p = a + b - c
            paeth = min((a, b, c), key=lambda v: abs(p - v))
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[f]) & 255
        rows.append([tuple(line[3 * x:3 * x + 3]) for x in range(w)])
        last = line
    return rows
