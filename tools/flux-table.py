#!/usr/bin/env python3
"""flux-table.py: what `nocturne info --json FILE...` tells of luminaires' files on stdin, as a table of their flux and
what they state of it. Files that state nothing are counted."""
import json
import sys

files = [f for f in json.load(sys.stdin)["files"] if "lumens" in f]
silent = [f for f in files if f["flux_error"] is None]
print("| file | format | found, lm | its lamps, lm | LOR | error |")
print("|---|---|---:|---:|---:|---:|")
for f in sorted((f for f in files if f["flux_error"] is not None), key=lambda f: f["path"].split("/")[-2:]):
    name, kind = "/".join(f["path"].split("/")[-2:]), f["format"].split(",")[0]
    lor = "%.1f %%" % (100 * f["light_output_ratio"]) if f["light_output_ratio"] else ""
    print("| %s | %s | %.0f | %.0f | %s | %+.2f %% |"
          % (name, kind, f["lumens"], f["lamp_lumens"], lor, 100 * f["flux_error"]))
print("\n%d files; %d of them state nothing to compare with." % (len(files), len(silent)))
