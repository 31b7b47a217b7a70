#include "import/map/osm_ways.h"

#include "import/xml.h"

#include <zlib.h>

#define MOST_HEADER (64 << 10) /* bytes: the limits of the format */
#define MOST_BLOCK (32 << 20)

/* What a text is as a key, and what as a value. */
enum { KEY_BUILDING = 1, KEY_STREET = 2, VALUE_NO = 4, VALUE_LAMP = 8, KEY_PART = 16 };

static unsigned text_kind(const char *text, size_t size) {
    static const struct {
        const char *text;
        unsigned kind;
    } known[] = {
        { "building", KEY_BUILDING }, { "building:part", KEY_PART },
        { "highway", KEY_STREET },    { "area:highway", KEY_STREET },
        { "no", VALUE_NO },           { "street_lamp", VALUE_LAMP },
    };
    for (size_t i = 0; i < NOC_COUNT(known); i++)
        if (strlen(known[i].text) == size && !memcmp(text, known[i].text, size))
            return known[i].kind;
    return 0;
}

static osm_way way_of(unsigned key, unsigned value) {
    if (value & VALUE_NO)
        return OSM_NEITHER;
    if (key & (KEY_BUILDING | KEY_PART))
        return key & KEY_BUILDING ? OSM_BUILDING : OSM_PART;
    return key & KEY_STREET && !(value & VALUE_LAMP) ? OSM_STREET : OSM_NEITHER;
}

osm_way osm_way_of(const char *key, const char *value) {
    return way_of(text_kind(key, strlen(key)), text_kind(value, strlen(value)));
}

void osm_count_way(geo_features *features, osm_way way) {
    features->buildings += way >= OSM_PART;
    features->parts += way == OSM_PART;
    features->streets += way == OSM_STREET;
}

static bool go_on(noc_stream *stream, geo_sink *sink) {
    return !sink->progress || sink->progress(sink->ctx, noc_stream_progress(stream));
}

/* ---- XML ---- */

typedef struct xml_count {
    noc_stream *stream;
    geo_sink *sink;
    geo_features *features;
    bool within;
    osm_way way;
} xml_count;

static void on_start(void *user, const char *name, const char **attributes) {
    xml_count *x = user;
    if (!strcmp(name, "way") || !strcmp(name, "relation")) {
        x->within = true;
        x->way = OSM_NEITHER;
    }
    if (!x->within || strcmp(name, "tag") != 0)
        return;
    const char *key = "", *value = "";
    for (; *attributes; attributes += 2) {
        key = strcmp(attributes[0], "k") ? key : attributes[1];
        value = strcmp(attributes[0], "v") ? value : attributes[1];
    }
    x->way = NOC_MAX(x->way, osm_way_of(key, value));
}

static void on_end(void *user, const char *name) {
    xml_count *x = user;
    if (strcmp(name, "way") != 0 && strcmp(name, "relation") != 0)
        return;
    osm_count_way(x->features, x->way);
    x->within = false;
}

static noc_status after_chunk(void *user) {
    const xml_count *x = user;
    return go_on(x->stream, x->sink) ? NOC_OK : NOC_ERR_CANCELLED;
}

/* GDAL has read the file before, and has told of what else is wrong with it. */
static noc_status count_xml(noc_stream *stream, geo_sink *sink, geo_features *features) {
    xml_count x = { .stream = stream, .sink = sink, .features = features };
    xml_fault fault;
    XML_Parser xml = xml_create(NULL);
    if (!xml)
        return noc_no_memory(sink->log, noc_stream_name(stream));
    XML_SetUserData(xml, &x);
    XML_SetElementHandler(xml, on_start, on_end);
    noc_status status = xml_read(xml, &(xml_progress){ 0 }, stream, after_chunk, &x, &fault);
    XML_ParserFree(xml);
    if (!status && fault == XML_FAULT_MEMORY)
        status = noc_no_memory(sink->log, noc_stream_name(stream));
    return status;
}

/* ---- PBF: messages of protocol buffers, in blocks ---- */

typedef struct wire {
    const unsigned char *at, *end;
} wire;

typedef struct wire_field {
    unsigned number;
    uint64_t value; /* of a number */
    wire bytes;     /* of a text or message */
} wire_field;

static bool get_number(wire *w, uint64_t *value) {
    *value = 0;
    for (unsigned shift = 0; shift < 64 && w->at < w->end; shift += 7) {
        unsigned char byte = *w->at++;
        *value |= (uint64_t)(byte & 0x7f) << shift;
        if (byte < 0x80)
            return true;
    }
    return false;
}

/* False at the end, and where no field is. */
static bool get_field(wire *w, wire_field *f) {
    uint64_t tag, size = 0;
    *f = (wire_field){ 0 };
    if (!get_number(w, &tag))
        return false;
    f->number = (unsigned)(tag >> 3);
    switch (tag & 7) {
    case 0: return get_number(w, &f->value);
    case 1: size = 8; break;
    case 5: size = 4; break;
    case 2:
        if (!get_number(w, &size))
            return false;
        break;
    default: return false;
    }
    if (size > (uint64_t)(w->end - w->at))
        return false;
    f->bytes = (wire){ w->at, w->at + size };
    w->at += size;
    return true;
}

typedef NOC_ARRAY(unsigned char) text_kinds;

static bool read_texts(wire table, text_kinds *kinds) {
    wire_field f;
    kinds->len = 0;
    while (get_field(&table, &f))
        if (f.number == 1 &&
            !array_push(kinds, (unsigned char)text_kind((const char *)f.bytes.at, (size_t)(f.bytes.end - f.bytes.at))))
            return false;
    return true;
}

/* A way or a relation: in both field 2 lists its keys, field 3 their values, as numbers of texts. */
static osm_way read_way(wire message, const text_kinds *kinds) {
    wire keys = { 0 }, values = { 0 };
    wire_field f;
    while (get_field(&message, &f)) {
        keys = f.number == 2 ? f.bytes : keys;
        values = f.number == 3 ? f.bytes : values;
    }
    osm_way way = OSM_NEITHER;
    uint64_t key, value;
    while (get_number(&keys, &key) && get_number(&values, &value) && key < kinds->len && value < kinds->len) {
        osm_way one = way_of(kinds->data[key], kinds->data[value]);
        way = NOC_MAX(way, one);
    }
    return way;
}

/* False: memory was refused. */
static bool read_block(wire block, text_kinds *kinds, geo_features *features) {
    enum { TEXTS = 1, GROUP = 2, WAY = 3, RELATION = 4 };
    wire_field f, member;
    for (wire w = block; get_field(&w, &f);)
        if (f.number == TEXTS && !read_texts(f.bytes, kinds))
            return false;
    for (wire w = block; get_field(&w, &f);)
        while (f.number == GROUP && get_field(&f.bytes, &member))
            if (member.number == WAY || member.number == RELATION)
                osm_count_way(features, read_way(member.bytes, kinds));
    return true;
}

static void *z_alloc(void *unused, unsigned items, unsigned size) { return noc_calloc(items, size); }
static void z_free(void *unused, void *p) { free(p); }

typedef NOC_ARRAY(unsigned char) buffer;

typedef struct pbf_count {
    noc_stream *stream;
    geo_sink *sink;
    buffer blob, block;
    text_kinds kinds;
} pbf_count;

static noc_status no_memory(const pbf_count *p) { return noc_no_memory(p->sink->log, noc_stream_name(p->stream)); }

/* Reads so many bytes; *whole is false where there are fewer. */
static noc_status read_bytes(pbf_count *p, size_t size, bool *whole) {
    p->blob.len = 0;
    *whole = false;
    if (!array_reserve(&p->blob, size))
        return no_memory(p);
    for (size_t got = 1; p->blob.len < size && got; p->blob.len += got) {
        noc_status status = noc_stream_read(p->stream, p->blob.data + p->blob.len, size - p->blob.len, &got);
        if (status)
            return status;
    }
    *whole = p->blob.len == size;
    return NOC_OK;
}

static noc_status unpack(pbf_count *p, wire packed, uint64_t size, wire *block) {
    *block = (wire){ 0 };
    if (!size || size > MOST_BLOCK)
        return NOC_OK;
    if (!array_reserve(&p->block, (size_t)size))
        return no_memory(p);
    z_stream z = { .zalloc = z_alloc,
                   .zfree = z_free,
                   .next_in = (unsigned char *)packed.at,
                   .avail_in = (uInt)(packed.end - packed.at),
                   .next_out = p->block.data,
                   .avail_out = (uInt)size };
    if (inflateInit(&z) != Z_OK)
        return no_memory(p);
    int ended = inflate(&z, Z_FINISH);
    inflateEnd(&z);
    if (ended == Z_MEM_ERROR)
        return no_memory(p);
    if (ended == Z_STREAM_END)
        *block = (wire){ p->block.data, p->block.data + size - z.avail_out };
    return NOC_OK;
}

static noc_status count_blob(pbf_count *p, geo_features *features) {
    enum { RAW = 1, RAW_SIZE = 2, ZLIB = 3 };
    wire blob = { p->blob.data, p->blob.data + p->blob.len }, block = { 0 }, packed = { 0 };
    uint64_t size = 0;
    wire_field f;
    while (get_field(&blob, &f)) {
        block = f.number == RAW ? f.bytes : block;
        packed = f.number == ZLIB ? f.bytes : packed;
        size = f.number == RAW_SIZE ? f.value : size;
    }
    noc_status status = packed.at ? unpack(p, packed, size, &block) : NOC_OK;
    if (!status && block.at && !read_block(block, &p->kinds, features))
        status = no_memory(p);
    return status;
}

/* The size of the blob that a header announces, and whether it holds data of the map. */
static bool read_header(const pbf_count *p, size_t *size, bool *data) {
    wire header = { p->blob.data, p->blob.data + p->blob.len };
    wire_field f;
    *size = 0;
    *data = false;
    while (get_field(&header, &f)) {
        *data |= f.number == 1 && f.bytes.end - f.bytes.at == 7 && !memcmp(f.bytes.at, "OSMData", 7);
        if (f.number == 3 && f.value <= MOST_BLOCK)
            *size = (size_t)f.value;
    }
    return *size > 0;
}

static noc_status count_pbf(pbf_count *p, geo_features *features) {
    for (bool whole, data;;) {
        noc_status status = read_bytes(p, 4, &whole);
        if (status || !whole)
            return status;
        const unsigned char *b = p->blob.data;
        size_t size = (size_t)b[0] << 24 | (size_t)b[1] << 16 | (size_t)b[2] << 8 | b[3];
        if (!size || size > MOST_HEADER)
            return NOC_OK;
        status = read_bytes(p, size, &whole);
        if (status || !whole || !read_header(p, &size, &data))
            return status;
        status = read_bytes(p, size, &whole);
        if (status || !whole)
            return status;
        status = data ? count_blob(p, features) : NOC_OK;
        if (status)
            return status;
        if (!go_on(p->stream, p->sink))
            return NOC_ERR_CANCELLED;
    }
}

noc_status osm_count_ways(noc_stream *stream, bool pbf, geo_sink *sink, geo_features *features) {
    noc_status status = noc_stream_rewind(stream);
    if (status)
        return status;
    if (!pbf)
        return count_xml(stream, sink, features);
    pbf_count p = { .stream = stream, .sink = sink };
    status = count_pbf(&p, features);
    array_free(&p.blob);
    array_free(&p.block);
    array_free(&p.kinds);
    return status;
}
