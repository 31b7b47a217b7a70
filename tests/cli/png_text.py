"""png_text.py FILE [KEY]: the text chunks of a PNG, or one of them; "size" is width and height, "pixels" a checksum of
them. Checks every CRC."""
import struct
import sys
import zlib

data = open(sys.argv[1], "rb").read()
assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
texts, at, pixels = {}, 8, 0
while at < len(data):
    length, kind = struct.unpack(">I4s", data[at:at + 8])
    body = data[at + 8:at + 8 + length]
    assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body), "bad CRC"
    at += 12 + length
    if kind == b"IHDR":
        texts["size"] = "%d %d" % struct.unpack(">II", body[:8])
    elif kind == b"IDAT":
        pixels = zlib.crc32(body, pixels)
    elif kind == b"tEXt":
        key, value = body.split(b"\0", 1)
        texts[key.decode("latin-1")] = value.decode("latin-1")
    elif kind == b"iTXt":
        key, rest = body.split(b"\0", 1)
        texts[key.decode("latin-1")] = rest[2:].split(b"\0", 2)[2].decode("utf-8")
assert kind == b"IEND", "cut short"
texts["pixels"] = "%08x" % pixels
if len(sys.argv) > 2:
    print(texts.get(sys.argv[2], ""))
else:
    for key in texts:
        print("%s: %s" % (key, texts[key]))
