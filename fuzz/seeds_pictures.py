"""Seeds of pictures: PNG, EXR, Radiance HDR, and two of them that are compared."""
import struct, zlib

from seedbox import parts, put

def png(width, height, depth, kind, pixels, extra=b"", interlaced=0):
    chunk = lambda tag, data: struct.pack(">I", len(data)) + tag + data + struct.pack(">I", zlib.crc32(tag + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR",
                                         struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, interlaced)) +
            extra +
            chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))


rgb = png(5, 4, 8, 2, b"".join(b"\0" + bytes((i * 7 + k * 40) % 256 for k in range(15)) for i in range(4)))
palette = struct.pack(">I", 6) + b"PLTE" + bytes(range(6)) + struct.pack(">I", zlib.crc32(b"PLTE" + bytes(range(6))))
put("png", "rgb.png", rgb)
put("png", "grey16.png", png(3, 3, 16, 0, (b"\1" + bytes(range(6))) * 3))
put("png", "palette.png", png(8, 2, 1, 3, (b"\0\x5a") * 2, palette))
put("png", "alpha.png", png(4, 4, 8, 6, (b"\2" + bytes(range(16))) * 4))
put("png", "interlaced.png", png(1, 1, 8, 2, b"\0abc", b"", 1))
# first column and row, steps
adam7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
put("png", "interlaced-9x9.png", png(9, 9, 8, 2,
                                     b"".join(b"\0" + bytes(3 * len(range(x, 9, dx))) for x, y, dx, dy in adam7
                                              for _ in range(y, 9, dy)), b"", 1))


def attribute(name, kind, data):
    return name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data


def exr(width, height, channels, compression, more=b""):

    list_ = b"".join(c + b"\0" + struct.pack("<iB3xii", t, 0, 1, 1) for c, t in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = (struct.pack("<II", 20000630, 2) + attribute(b"channels", b"chlist", list_) +
            attribute(b"compression", b"compression", bytes([compression])) +
            attribute(b"dataWindow", b"box2i", window) + attribute(b"displayWindow", b"box2i", window) +
            attribute(b"lineOrder", b"lineOrder", b"\0") +
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
            attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)) +
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + attribute(b"units", b"string", b"cd/m2") +
            more + b"\0")
    rows = []
    for y in range(height):
        row = b"".join(struct.pack("<%d%s" % (width, "Ief"[t]),
                                   *[(1 if t == 0 else 0.25) * (x + y + 1) if t else x for x in range(width)])
                       for c, t in channels)
        rows.append(row)
    lines = 16 if compression == 3 else 1
    blocks = [b"".join(rows[i:i + lines]) for i in range(0, height, lines)]
    if compression in (2, 3):
        packed = []
        for b in blocks:
            half = (len(b) + 1) // 2
            mixed = bytes(b[0::2]) + bytes(b[1::2])
            delta = bytes([mixed[0]]) + bytes((mixed[i] - mixed[i - 1] + 128) % 256 for i in range(1, len(mixed)))
            z = zlib.compress(delta)
            packed.append(z if len(z) < len(b) else b)
        blocks = packed
    at, offsets, body = len(head) + 8 * len(blocks), b"", b""
    for i, b in enumerate(blocks):
        offsets += struct.pack("<Q", at + len(body))
        body += struct.pack("<ii", i * lines, len(b)) + b
    return head + offsets + body


colours = [(b"B", 2), (b"G", 2), (b"R", 2)]


def tiled(width, height, side):
    """Not packed."""
    plain = exr(width, height, colours, 0)
    head = plain[:plain.index(b"units\0")]
    head = (head[:4] + struct.pack("<I", 2 | 0x200) + head[8:] + b"tiles\0tiledesc\0" +
            struct.pack("<iIIB", 9, side, side, 0) + b"\0")
    tiles = [(x, y) for y in range(0, height, side) for x in range(0, width, side)]
    at, offsets, body = len(head) + 8 * len(tiles), b"", b""
    for x, y in tiles:
        size = 12 * min(side, width - x) * min(side, height - y)
        offsets += struct.pack("<Q", at + len(body))
        body += struct.pack("<iiiii", x // side, y // side, 0, 0, size) + b"\0\0\x80\x3f" * (size // 4)
    return head + offsets + body


put("exr", "tiled.exr", tiled(20, 18, 16))
put("exr", "float.exr", exr(5, 4, colours, 0))
put("exr", "half.exr", exr(5, 4, [(b"A", 1), (b"B", 1), (b"G", 1), (b"R", 1)], 0))
put("exr", "zip.exr", exr(20, 18, colours, 3))
put("exr", "zips.exr", exr(20, 3, colours, 2))
put("exr", "grey.exr", exr(5, 4, [(b"Y", 2)], 0))
floats = lambda *v: struct.pack("<%df" % len(v), *v)
told = attribute(b"adoptedNeutral", b"v2f", floats(.3, .3)) + attribute(b"whiteLuminance", b"float", floats(80))
spaces = {
    "aces": (.7347, .2653, 0, 1, .0001, -.077, .32168, .33767),
    "xyz": (1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3),
    "line": (.64, .33, .3, .6, .47, .465, .3127, .329)
}
for name, xy in spaces.items():
    put("exr", name + ".exr",
        exr(3, 2, colours, 0,
            attribute(b"chromaticities", b"chromaticities", floats(*xy)) + told))
put("exr", "chroma.exr", exr(3, 2, [(b"BY", 2), (b"RY", 2), (b"Y", 2)], 0))
put("exr", "layer.exr", exr(3, 2, [(b"View.Combined." + c, t) for c, t in colours] + [(b"View.Depth.Z", 2)], 0))
put("exr", "layers.exr", exr(3, 2, [(layer + c, t) for layer in (b".", b"a.") for c, t in colours], 0))


def hdr(width, height, rows, more=""):
    return ("#?RADIANCE\n%sFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (more, height, width)).encode() + rows


put("hdr", "plain.hdr", hdr(4, 2, bytes(range(100, 132))))
put("hdr", "runs.hdr", hdr(10, 3, (b"\2\2\0\x0a" + b"\x8a\x80" * 3 + b"\x84\x81\6abcdef") * 3, "EXPOSURE=2.5\n"))
put("hdr", "exposed.hdr", hdr(2, 1, b"\x80\x90\xa0\x82" * 2, "# made here\nEXPOSURE=.5\nEXPOSURE=4\n"))
order = lambda size, rows, more="": ("#?RADIANCE\n%s\n%s\n" % (more, size)).encode() + rows
put("hdr", "old.hdr", hdr(600, 2, (b"\x80\x40\0\x81" + b"\1\1\1\x56\1\1\1\2" + b"\2\2\xc8\x81") * 2))
put("hdr", "columns.hdr", order("+X 2 -Y 9", b"\2\2\0\x09" + b"\x89\x80" * 4 + bytes(range(100, 136))))
put("hdr", "turned.hdr", order("-X 2 +Y 2", bytes(range(100, 116)), "COLORCORR= 1 2 .5\n"))
put("hdr", "xyze.hdr", order("+Y 1 -X 2", b"\x79\x7f\x8b\x81" * 2, "FORMAT=32-bit_rle_xyze\n"))
put("hdr", "primaries.hdr", order("-Y 1 +X 1", b"\x79\x7f\x8b\x81", "PRIMARIES=.7 .3 .2 .8 .1 .05 .33 .33\n"))
put("compare", "exr", parts(exr(5, 4, colours, 0), exr(5, 4, [(b"B", 1), (b"G", 1), (b"R", 1)], 0)))
put("compare", "png", parts(rgb, png(5, 4, 8, 2, (b"\0" + bytes(15)) * 4)))
put("compare", "wider", parts(exr(5, 4, colours, 0), exr(6, 4, colours, 0)))
put("compare", "higher", parts(exr(5, 4, colours, 0), exr(5, 5, colours, 0)))
put("compare", "lower", parts(exr(5, 5, colours, 0), exr(5, 4, colours, 0)))
put("compare", "mixed", parts(exr(5, 4, colours, 0), rgb))


# ---- textures ----


def jpeg(width, height, scans=0):
    """Of one grey, by hand: all codes are one bit. scans: of a progressive one, so many behind the first."""
    part = lambda kind, data: b"\xff" + bytes([kind]) + struct.pack(">H", len(data) + 2) + data
    table = lambda kind: part(0xc4, bytes([kind, 1]) + bytes(15) + b"\0")
    scan = lambda first, last, data: part(0xda, bytes([1, 1, 0, first, last, 0])) + data
    blocks = ((width + 7) // 8) * ((height + 7) // 8)
    bits = lambda each: bytes((each * blocks + 7) // 8)
    head = (b"\xff\xd8" + part(0xdb, b"\0" + b"\1" * 64) +
            part(0xc2 if scans else 0xc0, struct.pack(">BHHB", 8, height, width, 1) + bytes([1, 0x11, 0])) +
            table(0) + table(0x10))
    if scans:
        return head + scan(0, 0, bits(1)) + scan(1, 63, bits(1)) * scans + b"\xff\xd9"
    return head + scan(0, 63, bits(2)) + b"\xff\xd9"


put("pixels", "grey.jpg", jpeg(20, 9))
put("pixels", "progressive.jpg", jpeg(16, 16, 2))
put("pixels", "scans.jpg", jpeg(8, 8, 600))
put("pixels", "cut.jpg", jpeg(64, 64)[:-6])
put("pixels", "wide.jpg", jpeg(65500, 8)[:400])
put("pixels", "high.png", png(3, 1 << 30, 8, 2, b"\0" * 20))
put("pixels", "large.png", png(16384, 6400, 8, 0, b"\0" * 20))
put("pixels", "rgb.png", rgb)
put("pixels", "cut.png", rgb[:-30])
