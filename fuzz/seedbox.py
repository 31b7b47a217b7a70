"""What all of the seeds' modules use: where they go, and how several files become one input."""
import io, os, struct, sys, zipfile

root = sys.argv[1]


def put(corpus, name, data):
    os.makedirs(os.path.join(root, corpus), exist_ok=True)
    with open(os.path.join(root, corpus, name), "wb") as f:
        f.write(data.encode() if isinstance(data, str) else data)


def parts(*files):
    """Several files in one input: fuzz.h."""
    files = [f.encode() if isinstance(f, str) else f for f in files]
    return b"NFZ1" + b"".join(struct.pack("<I", len(f)) + f for f in files)


def zipped(**members):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as z:
        for name, data in members.items():
            z.writestr(zipfile.ZipInfo(name.replace("__", ".")), data)
    return out.getvalue()
