/* The places of a GML's geometries: each may have a CRS of its own, and numbers that are none. GDAL tells neither: it
 * leaves out the CRS of a layer that has several, and takes what is no number for 0. So the text is looked at first,
 * and says it in elements beside the geometry, which GDAL reads as fields of the feature. */
#include "import/map/source.h"
#include "import/map/columns.h"

#if NOC_HAVE_GDAL

#include <ctype.h>
#include <math.h>

enum { MOST_CRS = 64, LONGEST_NAME = 200, DEEPEST = 200, SHOWN = 40 };

/* An element that is open. */
typedef struct element {
    const char *tag;  /* its '<' */
    const char *name; /* local */
    size_t name_length;
    int crs; /* of geometries in it that name none; -1: unset */
} element;

/* A geometry that lies in no other. */
typedef struct geometry {
    const char *property, *begin, *name_end, *end; /* '<' of its parent and of itself, and behind its name and itself */
    int crs;
    bool named; /* by its own attribute */
    bool several;
    const char *broken; /* text where coordinates should be; NULL: none */
    size_t broken_length;
} geometry;

typedef struct scan {
    map_source *m;
    const char *text, *prefix; /* prefix: of GML's names, with its colon */
    size_t prefix_length;
    NOC_ARRAY(element) open;
    NOC_ARRAY(geometry) geometries;
    geometry now;
    noc_arena texts;
    size_t depth; /* of `open` with the geometry that is being read; 0: none */
    map_columns *columns;
} scan;

static bool is_name(const char *name, size_t length, const char *const *names, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (strlen(names[i]) == length && !memcmp(names[i], name, length))
            return true;
    return false;
}

static bool is_geometry(const scan *s, const element *e) {
    static const char *const names[] = {
        "Point",
        "LineString",
        "Curve",
        "Polygon",
        "Surface",
        "MultiPoint",
        "MultiCurve",
        "MultiLineString",
        "MultiSurface",
        "MultiPolygon",
        "MultiGeometry",
        "CompositeCurve",
        "Solid",
        "CompositeSurface",
        "MultiSolid",
        "OrientableCurve",
        "CompositeSolid",
        "PolyhedralSurface",
        "GeometricComplex",
        "TriangulatedSurface",
        "Tin",
        "SimplePolygon",
        "OrientableSurface",
    };
    size_t length = (size_t)(e->name - e->tag - 1);
    return length == s->prefix_length && !memcmp(e->tag + 1, s->prefix, length) &&
           is_name(e->name, e->name_length, names, NOC_COUNT(names));
}

/* The prefix that is declared for GML first; none where it is the default. */
static void find_prefix(scan *s) {
    static const char uri[] = "http://www.opengis.net/gml", key[] = "xmlns";
    s->prefix = "";
    for (const char *p = s->text; (p = strstr(p, uri)); p += strlen(uri)) {
        const char *end = p - 1, *name;
        while (end > s->text && (isspace((unsigned char)end[-1]) || end[-1] == '='))
            end--;
        for (name = end; name > s->text && !strchr(" \t\r\n<", name[-1]);)
            name--;
        size_t length = (size_t)(end - name), skip = strlen(key) + 1;
        if (p == s->text || length < strlen(key) || memcmp(name, key, strlen(key)))
            continue;
        s->prefix = length > skip ? arena_format(&s->texts, "%.*s:", (int)(length - skip), name + skip) : "";
        s->prefix = s->prefix ? s->prefix : "";
        break;
    }
    s->prefix_length = strlen(s->prefix);
}

static const char *local_name(const char *tag, size_t *length) {
    size_t whole = strcspn(tag, " \t\r\n/>"), prefix = strcspn(tag, ":");
    prefix = prefix < whole ? prefix + 1 : 0;
    *length = whole - prefix;
    return tag + prefix;
}

/* The value of an attribute in a tag, NULL: it has none. end: the tag's '>'. */
static const char *attribute(const char *p, const char *end, const char *wanted, size_t *length) {
    while ((p += strcspn(p, " \t\r\n/>")) < end) {
        p += strspn(p, " \t\r\n/");
        size_t name = strcspn(p, " \t\r\n=>/");
        const char *at = p;
        p += name + strspn(p + name, " \t\r\n");
        if (*p != '=')
            continue;
        p += 1 + strspn(p + 1, " \t\r\n");
        const char *close = *p == '"' || *p == '\'' ? strchr(p + 1, *p) : NULL;
        if (!close || close > end)
            return NULL;
        if (name == strlen(wanted) && !memcmp(at, wanted, name)) {
            *length = (size_t)(close - p - 1);
            return p + 1;
        }
        p = close + 1;
    }
    return NULL;
}

/* ---- CRSs ---- */

static noc_status number_crs(scan *s, const char *name, size_t length, int *number) {
    map_source *m = s->m;
    for (size_t i = 0; i < m->gml_crs.len; i++)
        if (strlen(m->gml_crs.data[i].name) == length && !memcmp(m->gml_crs.data[i].name, name, length)) {
            *number = (int)i;
            return NOC_OK;
        }
    if (length >= LONGEST_NAME || m->gml_crs.len == MOST_CRS)
        return noc_error(m->log, NOC_ERR_FORMAT, "%s: GML: %s", m->name,
                         length >= LONGEST_NAME ? "a CRS whose name has more than 200 letters" : "more than 64 CRSs");
    map_gml_crs crs = { .line = 1 };
    memcpy(crs.name, name, length);
    for (const char *p = s->text; p < name && (p = memchr(p, '\n', (size_t)(name - p))); p++)
        crs.line++;
    *number = (int)m->gml_crs.len;
    return array_push(&m->gml_crs, crs) ? NOC_OK : noc_no_memory(m->log, m->name);
}

/* Of a start tag. An envelope's is that of all that its feature or collection holds. */
static noc_status take_crs(scan *s, const char *end) {
    static const char *const boxes[] = { "Envelope", "Box" };
    element *e = &s->open.data[s->open.len - 1];
    size_t length;
    int crs = -1;
    const char *name = attribute(e->tag, end, "srsName", &length);
    bool box = s->open.len >= 3 && is_name(e->name, e->name_length, boxes, NOC_COUNT(boxes));
    if (!name || !length || !(box || s->depth))
        return NOC_OK;
    noc_status status = number_crs(s, name, length, &crs);
    if (status)
        return status;
    if (!s->depth) {
        s->open.data[s->open.len - 3].crs = crs;
        return NOC_OK;
    }
    s->now.named = s->now.named || s->depth == s->open.len;
    s->now.several = s->now.several || (s->now.crs >= 0 && s->now.crs != crs);
    s->now.crs = crs;
    return NOC_OK;
}

/* ---- coordinates ---- */

static bool is_number(const char *text, size_t length, char decimal) {
    char copy[128];
    double value;
    if (!length || length >= sizeof(copy))
        return false;
    memcpy(copy, text, length);
    copy[length] = 0;
    for (char *p = copy; *p; p++)
        *p = *p == decimal ? '.' : *p == '.' ? 'x' : *p;
    return isdigit((unsigned char)copy[strcspn(copy, "0123456789")]) && noc_parse_double(copy, &value);
}

/* Numbers between any of the separators: how many, 0 where one of them is none. */
static size_t count_numbers(const char *p, const char *end, const char *separators, char decimal) {
    size_t count = 0;
    for (; (p += strspn(p, separators)) < end; count++) {
        size_t length = NOC_MIN(strcspn(p, separators), (size_t)(end - p));
        if (!is_number(p, length, decimal))
            return 0;
        p += length;
    }
    return count;
}

/* The text of an element of coordinates, whose start tag ends at `end`. */
static void check_numbers(scan *s, const char *end) {
    static const char *const lists[] = { "pos", "posList", "X", "Y", "coordinates" };
    const element *e = &s->open.data[s->open.len - 1];
    if (!s->depth || s->now.broken || !is_name(e->name, e->name_length, lists, NOC_COUNT(lists)))
        return;
    const char *text = end + 1, *close = end[-1] == '/' ? text : text + strcspn(text, "<");
    char decimal = '.', separators[] = " \t\r\n \0";
    bool tuples = *e->name == 'c', single = e->name_length == 1;
    if (close > text && close[1] != '/')
        return; /* a comment in it: GDAL decides */
    size_t length;
    const char *value = tuples ? attribute(e->tag, end, "decimal", &length) : NULL;
    decimal = value && length == 1 ? *value : decimal;
    value = tuples ? attribute(e->tag, end, "cs", &length) : NULL;
    separators[4] = !tuples ? ' ' : value && length == 1 ? *value : ',';
    value = tuples ? attribute(e->tag, end, "ts", &length) : NULL;
    separators[5] = value && length == 1 ? *value : 0;
    size_t count = close > text ? count_numbers(text, close, separators, decimal) : 0;
    if (count >= (single ? 1u : 2u))
        return;
    text += strspn(text, " \t\r\n");
    s->now.broken = text;
    s->now.broken_length = close > text ? (size_t)(close - text) : 0;
}

/* ---- elements ---- */

static noc_status end_element(scan *s, const char *behind) {
    if (!s->open.len)
        return NOC_OK; /* GDAL says what is wrong */
    if (s->depth == s->open.len) {
        s->now.end = behind;
        s->now.crs = s->now.crs >= 0 ? s->now.crs : s->open.data[s->open.len - 1].crs;
        s->depth = 0;
        if (!array_push(&s->geometries, s->now))
            return noc_no_memory(s->m->log, s->m->name);
    }
    s->open.len--;
    return NOC_OK;
}

/* Elements in features, outside of geometries, are columns by their name and that of what they lie in. */
static noc_status count_column(scan *s) {
    uint64_t hash = MAP_COLUMN_SEED;
    for (size_t i = s->open.len - 2; i < s->open.len; i++) {
        const element *e = &s->open.data[i];
        for (size_t k = 0; k < e->name_length; k++)
            hash = map_column_hash(hash, e->name[k]);
        hash = map_column_hash(hash, '|');
    }
    return map_columns_add(s->columns, hash) ? NOC_OK : map_columns_refuse(s->m->name, s->m->format, s->m->log);
}

static noc_status start_element(scan *s, const char *tag, const char *end) {
    element e = { .tag = tag, .crs = s->open.len ? s->open.data[s->open.len - 1].crs : -1 };
    e.name = local_name(tag + 1, &e.name_length);
    if (s->open.len >= DEEPEST)
        return noc_error(s->m->log, NOC_ERR_FORMAT, "%s: GML: more than 200 elements in elements", s->m->name);
    if (!array_push(&s->open, e))
        return noc_no_memory(s->m->log, s->m->name);
    if (!s->depth && s->open.len >= 3 && is_geometry(s, &e)) {
        s->depth = s->open.len;
        s->now = (geometry){
            .property = s->open.data[s->open.len - 2].tag, .begin = tag, .name_end = e.name + e.name_length, .crs = -1
        };
    }
    noc_status status = take_crs(s, end);
    if (!status && !s->depth && s->open.len > 3)
        status = count_column(s);
    if (!status)
        check_numbers(s, end);
    return !status && end[-1] == '/' ? end_element(s, end + 1) : status;
}

/* Behind what is neither a start nor an end tag; NULL: it is one. */
static const char *skip_other(const char *p) {
    static const struct {
        const char *begin, *end;
    } others[] = { { "<!--", "-->" }, { "<![CDATA[", "]]>" }, { "<?", "?>" }, { "<!", ">" } };
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        if (!strncmp(p, others[i].begin, strlen(others[i].begin))) {
            const char *end = strstr(p + strlen(others[i].begin), others[i].end);
            return end ? end + strlen(others[i].end) : p + strlen(p);
        }
    return NULL;
}

/* The '>' of a tag, which may stand in its attributes, too; NULL: there is none. */
static const char *tag_end(const char *p) {
    while (*(p += strcspn(p, ">\"'")) && *p != '>') {
        const char *close = strchr(p + 1, *p);
        p = close ? close + 1 : p + strlen(p);
    }
    return *p ? p : NULL;
}

static noc_status scan_text(scan *s) {
    noc_status status = NOC_OK;
    for (const char *p = s->text; !status && (p = strchr(p, '<'));) {
        const char *other = skip_other(p), *end = other ? NULL : tag_end(p);
        if (!other && !end)
            break;
        if (!other)
            status = p[1] == '/' ? end_element(s, end + 1) : start_element(s, p, end);
        p = other ? other : end + 1;
    }
    return status;
}

/* ---- the text with what was found ---- */

/* CRSs of envelopes hold for geometries that name none, which have ended before anything behind them was known. */
static bool has_several(const scan *s) {
    int first = -1;
    for (size_t i = 0; i < s->geometries.len; i++) {
        const geometry *g = &s->geometries.data[i];
        if (g->several || (first >= 0 && g->crs >= 0 && g->crs != first))
            return true;
        first = first >= 0 ? first : g->crs;
    }
    return false;
}

typedef NOC_ARRAY(char) text_buffer;

static bool put(text_buffer *out, const char *text, size_t length) { return array_append(out, text, length); }

static bool put_text(text_buffer *out, char *text) {
    bool ok = text && put(out, text, strlen(text));
    free(text);
    return ok;
}

static bool put_broken(text_buffer *out, const geometry *g) {
    char shown[SHOWN + 1];
    size_t length = NOC_MIN(g->broken_length, (size_t)SHOWN);
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)g->broken[i];
        shown[i] = c == '&' || c > 126 ? '?' : c < ' ' ? ' ' : (char)c;
    }
    while (length && shown[length - 1] == ' ')
        length--;
    shown[length] = 0;
    /* in quotes, so that GDAL takes no number of it for one */
    return put_text(out, noc_format("<" MAP_GML_BROKEN ">\"%s\"</" MAP_GML_BROKEN ">", shown));
}

/* Up to behind the geometry; from: where the text goes on. */
static bool put_geometry(const scan *s, text_buffer *out, const geometry *g, bool several, const char **from) {
    bool ok = true, known = several && g->crs >= 0 && !g->several;
    if (g->property >= *from) { /* else it has another geometry, which has told */
        ok = put(out, *from, (size_t)(g->property - *from));
        if (ok && known)
            ok = put_text(out, noc_format("<" MAP_GML_CRS ">%d</" MAP_GML_CRS ">", g->crs));
        if (ok && g->broken)
            ok = put_broken(out, g);
        *from = g->property;
    }
    ok = ok && put(out, *from, (size_t)((g->broken ? g->begin : g->name_end) - *from));
    if (ok && known && !g->named && !g->broken)
        ok = put_text(out, noc_format(" srsName=\"%s\"", s->m->gml_crs.data[g->crs].name));
    *from = g->broken ? g->end : g->name_end;
    return ok;
}

static noc_status rewrite(scan *s, bool several) {
    text_buffer out = { 0 };
    const char *from = s->text;
    bool ok = true;
    for (size_t i = 0; i < s->geometries.len && ok; i++) {
        const geometry *g = &s->geometries.data[i];
        if (several || g->broken)
            ok = put_geometry(s, &out, g, several, &from);
    }
    ok = ok && put(&out, from, strlen(from) + 1);
    if (!ok) {
        array_free(&out);
        return noc_no_memory(s->m->log, s->m->name);
    }
    free(s->m->content);
    s->m->content = out.data;
    return NOC_OK;
}

noc_status map_gml_look_at_places(map_source *m) {
    scan s = { .m = m, .text = m->content, .columns = noc_calloc(1, sizeof(map_columns)) };
    if (!s.columns)
        return noc_no_memory(m->log, m->name);
    find_prefix(&s);
    noc_status status = s.texts.refused ? noc_no_memory(m->log, m->name) : scan_text(&s);
    bool broken = false;
    for (size_t i = 0; i < s.geometries.len; i++)
        broken = broken || s.geometries.data[i].broken;
    m->gml_several = has_several(&s);
    if (!status && (m->gml_several || broken))
        status = rewrite(&s, m->gml_several);
    array_free(&s.open);
    array_free(&s.geometries);
    arena_free(&s.texts);
    free(s.columns);
    return status;
}

#endif
