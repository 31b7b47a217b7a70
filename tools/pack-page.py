#!/usr/bin/env python3
"""pack-page.py OUT FILE...: files that the viewer serves, as C: their names, types and bytes (src/viewer/page.h)."""
import os
import sys

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".webmanifest": "application/manifest+json",
}

rows, names = [], set()
with open(sys.argv[1], "w", encoding="ascii") as out:
    out.write('#include "viewer/page.h"\n\n')
    for number, path in enumerate(sys.argv[2:]):
        name = os.path.basename(path)
        kind = TYPES.get(os.path.splitext(name)[1])
        if not kind or name in names:
            sys.exit("%s: %s" % (path, "its kind is not served" if not kind else "two files have this name"))
        names.add(name)
        with open(path, "rb") as file:
            data = file.read()
        out.write("static const unsigned char file%d[] = {" % number)
        for at in range(0, len(data), 32):
            out.write("\n" + ",".join(map(str, data[at:at + 32])) + ",")
        out.write("0};\n")
        rows.append('    {"%s", "%s", file%d, %d},\n' % (name, kind, number, len(data)))
    out.write("\nconst page_file page_files[] = {\n%s    {0},\n};\n" % "".join(rows))
