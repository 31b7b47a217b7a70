/* Containers: gzip, zip, PNG, GLB and OpenStreetMap PBF. */
#include "mutate.h"

#include <zlib.h>

static uint32_t get(const uint8_t *p, int bytes, bool big_endian) {
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint32_t)p[i] << 8 * (big_endian ? bytes - 1 - i : i);
    return value;
}

static fuzz_part part_of(const fuzz_bytes *b) { return (fuzz_part){ b->len ? b->data : (const uint8_t *)"", b->len }; }

bool mutate_gzip(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    fuzz_bytes plain = { 0 }, now = { 0 };
    bool is = in.size > 18 && in.data[0] == 0x1f && in.data[1] == 0x8b && mutate_inflate(in, 15 + 16, &plain);
    if (is) {
        mutate_any(part_of(&plain), 4 * most, random, &now);
        mutate_deflate(part_of(&now), 15 + 16, out);
        if (!mutate_random(random, 16)) /* another member behind it */
            mutate_deflate(part_of(&plain), 15 + 16, out);
    }
    array_free(&plain);
    array_free(&now);
    return is;
}

/* ---- zip ---- */

enum { ZIP_MEMBERS = 16 };
typedef struct zip_member {
    fuzz_part name;
    fuzz_bytes content;
} zip_member;

/* Members by their local headers, as a writer that knows sizes beforehand leaves them. */
static int read_members(fuzz_part in, zip_member *m) {
    int n = 0;
    for (size_t at = 0; n < ZIP_MEMBERS && at + 30 <= in.size && !memcmp(in.data + at, "PK\3\4", 4); n++) {
        const uint8_t *h = in.data + at;
        size_t size = get(h + 18, 4, false), name = get(h + 26, 2, false), extra = get(h + 28, 2, false);
        if (size > in.size || at + 30 + name + extra + size > in.size)
            break;
        fuzz_part stored = { h + 30 + name + extra, size };
        m[n] = (zip_member){ .name = { h + 30, name } };
        if (get(h + 8, 2, false) == 8)
            mutate_inflate(stored, -15, &m[n].content);
        else
            FUZZ_REQUIRE(array_append(&m[n].content, stored.data, stored.size));
        at += 30 + name + extra + size;
    }
    return n;
}

static void put_header(fuzz_bytes *out, bool central, const zip_member *m, fuzz_part stored, bool packed,
                       size_t offset) {
    FUZZ_REQUIRE(array_append(out, (const uint8_t *)(central ? "PK\1\2" : "PK\3\4"), 4));
    if (central)
        mutate_put(out, 20, 2, false);
    mutate_put(out, 20, 2, false);
    mutate_put(out, 0, 2, false);
    mutate_put(out, packed ? 8 : 0, 2, false);
    mutate_put(out, 0x00210000, 4, false); /* 1980-01-01 */
    mutate_put(out, crc32(0, m->content.data, (uInt)m->content.len), 4, false);
    mutate_put(out, stored.size, 4, false);
    mutate_put(out, m->content.len, 4, false);
    mutate_put(out, m->name.size, 2, false);
    mutate_put(out, 0, 2, false);
    if (central) {
        mutate_put(out, 0, 10, false);
        mutate_put(out, offset, 4, false);
    }
    FUZZ_REQUIRE(array_append(out, m->name.data, m->name.size));
}

static void write_members(const zip_member *m, int n, uint32_t *random, fuzz_bytes *out) {
    fuzz_bytes directory = { 0 };
    size_t start = out->len;
    for (int i = 0; i < n; i++) {
        fuzz_bytes packed = { 0 };
        bool pack = mutate_random(random, 2);
        if (pack)
            mutate_deflate(part_of(&m[i].content), -15, &packed);
        fuzz_part stored = part_of(pack ? &packed : &m[i].content);
        put_header(&directory, true, &m[i], stored, pack, out->len - start);
        put_header(out, false, &m[i], stored, pack, 0);
        FUZZ_REQUIRE(array_append(out, stored.data, stored.size));
        array_free(&packed);
    }
    size_t at = out->len - start;
    FUZZ_REQUIRE(array_append(out, directory.data, directory.len));
    FUZZ_REQUIRE(array_append(out, (const uint8_t *)"PK\5\6\0\0\0", 8));
    mutate_put(out, (uint64_t)n, 2, false);
    mutate_put(out, (uint64_t)n, 2, false);
    mutate_put(out, directory.len, 4, false);
    mutate_put(out, at, 4, false);
    mutate_put(out, 0, 2, false);
    array_free(&directory);
}

bool mutate_zip(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    zip_member m[ZIP_MEMBERS];
    int n = read_members(in, m);
    if (n) {
        zip_member *chosen = &m[mutate_random(random, (uint32_t)n)];
        fuzz_bytes now = { 0 }, name = { 0 };
        if (mutate_random(random, 12)) {
            mutate_any(part_of(&chosen->content), 4 * most, random, &now);
            array_free(&chosen->content);
            chosen->content = now;
        } else {
            mutate_raw(chosen->name, chosen->name.size + 8, random, &name);
            chosen->name = part_of(&name);
        }
        write_members(m, n, random, out);
        array_free(&name);
    }
    for (int i = 0; i < n; i++)
        array_free(&m[i].content);
    return n > 0;
}

/* ---- PNG ---- */

enum { PNG_CHUNKS = 64 };

static void put_chunk(fuzz_bytes *out, const uint8_t type[4], fuzz_part data) {
    mutate_put(out, data.size, 4, true);
    size_t from = out->len;
    FUZZ_REQUIRE(array_append(out, type, 4));
    FUZZ_REQUIRE(array_append(out, data.data, data.size));
    mutate_put(out, crc32(0, out->data + from, (uInt)(out->len - from)), 4, true);
}

/* A chunk's content; where it is compressed, what was compressed. */
static void mutate_chunk(const uint8_t *type, fuzz_part data, size_t most, uint32_t *random, fuzz_bytes *out) {
    fuzz_bytes plain = { 0 }, now = { 0 };
    if (!memcmp(type, "IDAT", 4) && mutate_random(random, 4) && mutate_inflate(data, 15, &plain)) {
        mutate_raw(part_of(&plain), 8 * most, random, &now);
        mutate_deflate(part_of(&now), 15, out);
    } else {
        mutate_raw(data, most, random, out);
    }
    array_free(&plain);
    array_free(&now);
}

bool mutate_png(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    const uint8_t *chunk[PNG_CHUNKS];
    int n = 0;
    if (in.size < 33 || memcmp(in.data, "\x89PNG\r\n\x1a\n", 8))
        return false;
    for (size_t at = 8; n < PNG_CHUNKS && at + 12 <= in.size && get(in.data + at, 4, true) <= in.size - at - 12;) {
        chunk[n++] = in.data + at;
        at += 12 + get(in.data + at, 4, true);
    }
    if (!n)
        return false;
    int chosen = (int)mutate_random(random, (uint32_t)n), other = (int)mutate_random(random, (uint32_t)n);
    uint32_t what = mutate_random(random, 10);
    FUZZ_REQUIRE(array_append(out, in.data, 8));
    for (int i = 0; i < n; i++) {
        fuzz_bytes now = { 0 };
        const uint8_t *c = i == chosen && what == 2 ? chunk[other] : chunk[i];
        fuzz_part data = { c + 8, get(c, 4, true) };
        if (i == chosen && what > 2)
            mutate_chunk(c + 4, data, most, random, &now);
        else
            FUZZ_REQUIRE(array_append(&now, data.data, data.size));
        for (int k = i == chosen ? what == 0 ? 0 : what == 1 ? 2 : 1 : 1; k > 0; k--)
            put_chunk(out, c + 4, part_of(&now));
        array_free(&now);
    }
    return true;
}

/* ---- GLB ---- */

static void put_glb_chunk(fuzz_bytes *out, const char *type, fuzz_part data) {
    size_t padding = (4 - data.size % 4) % 4;
    mutate_put(out, data.size + padding, 4, false);
    FUZZ_REQUIRE(array_append(out, (const uint8_t *)type, 4));
    FUZZ_REQUIRE(array_append(out, data.data, data.size));
    for (; padding > 0; padding--)
        FUZZ_REQUIRE(array_push(out, *type == 'J' ? ' ' : 0));
}

bool mutate_glb(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    if (in.size < 20 || memcmp(in.data, "glTF", 4) || get(in.data + 12, 4, false) > in.size - 20)
        return false;
    fuzz_part json = { in.data + 20, get(in.data + 12, 4, false) };
    const uint8_t *rest = json.data + json.size, *end = in.data + in.size;
    fuzz_part bin = { end, 0 };
    if (end - rest >= 8)
        bin = (fuzz_part){ rest + 8, NOC_MIN(get(rest, 4, false), (size_t)(end - rest - 8)) };
    fuzz_bytes now = { 0 };
    bool in_json = !bin.size || mutate_random(random, 4);
    mutate_any(in_json ? json : bin, most, random, &now);
    size_t start = out->len;
    FUZZ_REQUIRE(array_append(out, in.data, 12));
    put_glb_chunk(out, "JSON", in_json ? part_of(&now) : json);
    if (bin.size)
        put_glb_chunk(out, "BIN\0", in_json ? bin : part_of(&now));
    for (int i = 0; i < 4; i++)
        out->data[start + 8 + (size_t)i] = (uint8_t)((out->len - start) >> 8 * i);
    array_free(&now);
    return true;
}

/* ---- protobuf ---- */

static const uint8_t *get_varint(const uint8_t *p, const uint8_t *end, uint64_t *value) {
    *value = 0;
    for (int shift = 0; p < end && shift < 64; shift += 7) {
        *value |= (uint64_t)(*p & 127) << shift;
        if (!(*p++ & 128))
            return p;
    }
    return NULL;
}

static void put_varint(fuzz_bytes *out, uint64_t value) {
    for (; value > 127; value >>= 7)
        FUZZ_REQUIRE(array_push(out, (uint8_t)(value | 128)));
    FUZZ_REQUIRE(array_push(out, (uint8_t)value));
}

typedef struct pb_field {
    const uint8_t *start, *end; /* with its tag */
    uint64_t tag;
    fuzz_part bytes; /* of wire type 2 */
} pb_field;
enum { PB_FIELDS = 512 };

/* Number of fields; 0 where the bytes are no message. */
static int read_fields(fuzz_part in, pb_field *f) {
    const uint8_t *p = in.data, *end = in.data + in.size;
    uint64_t value;
    int n = 0;
    for (; p < end && n < PB_FIELDS; n++) {
        f[n] = (pb_field){ .start = p };
        if (!(p = get_varint(p, end, &f[n].tag)) || !(f[n].tag >> 3) || f[n].tag >> 3 > 100)
            return 0;
        switch (f[n].tag & 7) {
        case 0: p = get_varint(p, end, &value); break;
        case 1: p = end - p >= 8 ? p + 8 : NULL; break;
        case 2:
            if (!(p = get_varint(p, end, &value)) || value > (size_t)(end - p))
                return 0;
            f[n].bytes = (fuzz_part){ p, (size_t)value };
            p += value;
            break;
        case 5: p = end - p >= 4 ? p + 4 : NULL; break;
        default: return 0;
        }
        if (!p)
            return 0;
        f[n].end = p;
    }
    return p == end ? n : 0;
}

/* Packed numbers of an array, of which one is changed. */
static void mutate_packed(fuzz_part in, uint32_t *random, fuzz_bytes *out) {
    const uint8_t *p = in.data, *end = in.data + in.size, *next;
    uint32_t chosen = mutate_random(random, (uint32_t)in.size + 1), i = 0;
    for (uint64_t value; p < end && (next = get_varint(p, end, &value)); p = next, i++) {
        if (i == chosen)
            value = mutate_random(random, 3) ? mutate_random(random, 300) : ~(uint64_t)0 >> mutate_random(random, 64);
        put_varint(out, value);
    }
    FUZZ_REQUIRE(array_append(out, p, (size_t)(end - p)));
}

static void mutate_message(fuzz_part in, int depth, uint32_t *random, fuzz_bytes *out) {
    pb_field *f = noc_alloc(sizeof(*f) * PB_FIELDS);
    int n = depth < 6 ? read_fields(in, f) : 0;
    int chosen = (int)mutate_random(random, (uint32_t)n), other = (int)mutate_random(random, (uint32_t)n);
    uint32_t what = mutate_random(random, 12);
    for (int i = 0; i < n; i++) {
        fuzz_bytes now = { 0 };
        if (i != chosen || what == 1) /* as it is; once more below */
            FUZZ_REQUIRE(array_append(out, f[i].start, (size_t)(f[i].end - f[i].start)));
        if (i != chosen || what == 0)
            continue;
        if (what <= 2) { /* this one twice, or another's in its place */
            int from = what == 1 ? i : other;
            FUZZ_REQUIRE(array_append(out, f[from].start, (size_t)(f[from].end - f[from].start)));
            continue;
        }
        put_varint(out, f[i].tag);
        if ((f[i].tag & 7) == 2) {
            mutate_message(f[i].bytes, depth + 1, random, &now);
            put_varint(out, now.len);
        } else {
            mutate_raw((fuzz_part){ f[i].start + 1, (size_t)(f[i].end - f[i].start) - 1 }, 10, random, &now);
        }
        FUZZ_REQUIRE(array_append(out, now.data, now.len));
        array_free(&now);
    }
    free(f);
    if (!n && what < 6)
        mutate_packed(in, random, out);
    else if (!n)
        mutate_raw(in, in.size + 16, random, out);
}

/* A blob of OpenStreetMap's format: length of its header (4 bytes), header {1: type, 3: length}, blob {1: raw | 2:
 * size, 3: zlib}. */
static bool put_blob(fuzz_part type, fuzz_part content, uint32_t *random, fuzz_bytes *out) {
    fuzz_bytes blob = { 0 }, header = { 0 }, packed = { 0 };
    bool raw = !mutate_random(random, 3);
    if (!raw) {
        mutate_deflate(content, 15, &packed);
        put_varint(&blob, 2 << 3);
        put_varint(&blob, content.size);
    }
    fuzz_part stored = raw ? content : part_of(&packed);
    put_varint(&blob, (raw ? 1 : 3) << 3 | 2);
    put_varint(&blob, stored.size);
    FUZZ_REQUIRE(array_append(&blob, stored.data, stored.size));
    put_varint(&header, 1 << 3 | 2);
    put_varint(&header, type.size);
    FUZZ_REQUIRE(array_append(&header, type.data, type.size));
    put_varint(&header, 3 << 3);
    put_varint(&header, blob.len);
    mutate_put(out, header.len, 4, true);
    FUZZ_REQUIRE(array_append(out, header.data, header.len));
    FUZZ_REQUIRE(array_append(out, blob.data, blob.len));
    array_free(&blob);
    array_free(&header);
    array_free(&packed);
    return true;
}

/* Type, content and end of the blob at p; NULL where there is none. */
static const uint8_t *read_blob(const uint8_t *p, const uint8_t *end, fuzz_part *type, fuzz_bytes *content) {
    pb_field *f = noc_alloc(sizeof(*f) * PB_FIELDS);
    const uint8_t *next = NULL;
    uint64_t size = 0;
    uint32_t length = end - p >= 4 ? get(p, 4, true) : UINT32_MAX;
    *type = (fuzz_part){ 0 };
    if (length <= 256 && (size_t)(end - p) - 4 >= length) {
        int n = read_fields((fuzz_part){ p + 4, length }, f);
        for (int i = 0; i < n; i++) {
            if (f[i].tag == (1 << 3 | 2))
                *type = f[i].bytes;
            if (f[i].tag == 3 << 3)
                get_varint(f[i].start + 1, f[i].end, &size);
        }
        p += 4 + length;
        if (type->size && size <= (size_t)(end - p)) {
            n = read_fields((fuzz_part){ p, (size_t)size }, f);
            for (int i = 0; i < n; i++) {
                if (f[i].tag == (1 << 3 | 2))
                    FUZZ_REQUIRE(array_append(content, f[i].bytes.data, f[i].bytes.size));
                else if (f[i].tag == (3 << 3 | 2))
                    mutate_inflate(f[i].bytes, 15, content);
            }
            next = n ? p + size : NULL;
        }
    }
    free(f);
    return next;
}

bool mutate_pbf(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    if (!in.size) /* and no data */
        return false;
    const uint8_t *p = in.data, *end = in.data + in.size;
    uint32_t chosen = mutate_random(random, 4), i = 0;
    (void)most;
    for (;; i++) {
        fuzz_part type;
        fuzz_bytes content = { 0 }, now = { 0 };
        const uint8_t *next = read_blob(p, end, &type, &content);
        if (next && (i == chosen || (next == end && i < chosen)))
            mutate_message(part_of(&content), 0, random, &now);
        else if (next)
            FUZZ_REQUIRE(array_append(&now, content.data, content.len));
        if (next)
            put_blob(type, part_of(&now), random, out);
        array_free(&content);
        array_free(&now);
        if (!next)
            break;
        p = next;
    }
    FUZZ_REQUIRE(array_append(out, p, (size_t)(end - p)));
    return i > 0;
}
