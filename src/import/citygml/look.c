/* look.c: app:Appearance: which images and colours the file gives to which surfaces. They stand anywhere in a file,
 * mostly behind all objects, so a pass of their own gathers them first, of files that hold any. Of several themes the
 * first one that names a surface is taken. */
#include "import/citygml/citygml.h"

#define MARK "surfaceData" /* in the name of the element that is around each texture and material */
#define LONGEST_NAME 4096  /* of an image */

/* Reads all of the file, block by block, until `found` is true of one. A block begins with the last `keep` bytes of
 * the one before it. */
static bool scan(cg_parser *p, size_t keep, bool (*found)(cg_parser *p, const char *block, size_t size)) {
    enum { CHUNK = 1 << 17 };
    char *buffer = noc_alloc(keep + CHUNK);
    bool is = false;
    if (!buffer)
        cg_no_memory(p);
    for (size_t kept = 0, got = 1; buffer && got && !is && !p->status;) {
        noc_status status = noc_stream_read(p->stream, buffer + kept, CHUNK, &got);
        if (!status && !p->sink->progress(p->sink->ctx, 0))
            status = NOC_ERR_CANCELLED;
        if (status) {
            p->status = status;
            break;
        }
        size_t have = kept + got;
        is = found(p, buffer, have);
        kept = NOC_MIN(have, keep);
        memmove(buffer, buffer + have - kept, kept);
    }
    free(buffer);
    return is && !p->status;
}

static bool holds_mark(cg_parser *p, const char *block, size_t size) {
    (void)p;
    return memmem(block, size, MARK, strlen(MARK)) != NULL;
}

/* Notes the images that a block names. A name that is cut at the block's end is met again in the next one. */
static bool note_images(cg_parser *p, const char *block, size_t size) {
    static const char before[] = "imageURI>";
    for (const char *at = block, *end = block + size; (at = memmem(at, (size_t)(end - at), before, strlen(before)));) {
        char name[LONGEST_NAME];
        at += strlen(before);
        const char *stop = memchr(at, '<', (size_t)(end - at));
        if (!stop)
            break;
        while (at < stop && strchr(" \t\r\n", *at))
            at++;
        while (stop > at && strchr(" \t\r\n", stop[-1]))
            stop--;
        noc_snprintf(name, sizeof(name), "%.*s", (int)NOC_MIN(stop - at, LONGEST_NAME), at);
        if (*name && !noc_stream_note_named(p->stream, name)) {
            cg_no_memory(p);
            break;
        }
    }
    return p->status != NOC_OK;
}

/* ---- what the elements say ---- */

/* The elements of app that are looked at. */
typedef enum word {
    WORD_OTHER,
    WORD_TEXTURE,
    WORD_MATERIAL,
    WORD_GEOREFERENCED,
    WORD_IMAGE,
    WORD_WRAP,
    WORD_FRONT,
    WORD_TARGET,
    WORD_LIST,
    WORD_GENERATED, /* TexCoordGen */
    WORD_COORDINATES,
    WORD_RING,
    WORD_DIFFUSE,
    WORD_SPECULAR,
    WORD_EMISSIVE,
    WORD_SHININESS,
    WORD_TRANSPARENCY,
} word;

static word word_of(const char *name) {
    static const struct {
        const char *name;
        word is;
    } words[] = {
        { "ParameterizedTexture", WORD_TEXTURE },
        { "X3DMaterial", WORD_MATERIAL },
        { "GeoreferencedTexture", WORD_GEOREFERENCED },
        { "imageURI", WORD_IMAGE },
        { "wrapMode", WORD_WRAP },
        { "isFront", WORD_FRONT },
        { "target", WORD_TARGET },
        { "TexCoordList", WORD_LIST },
        { "TexCoordGen", WORD_GENERATED },
        { "textureCoordinates", WORD_COORDINATES },
        { "ring", WORD_RING },
        { "diffuseColor", WORD_DIFFUSE },
        { "specularColor", WORD_SPECULAR },
        { "emissiveColor", WORD_EMISSIVE },
        { "shininess", WORD_SHININESS },
        { "transparency", WORD_TRANSPARENCY },
    };
    if (strncmp(name, "http://www.opengis.net/citygml/appearance/", 42))
        return WORD_OTHER;
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(words[i].name, cg_local_name(name)))
            return words[i].is;
    return WORD_OTHER;
}

static const char *attribute(const XML_Char **list, const char *name) {
    for (; *list; list += 2)
        if (!strcmp(list[0], name))
            return list[1];
    return NULL;
}

static const char *gml_id(const XML_Char **list) {
    for (; *list; list += 2)
        if (!strncmp(list[0], "http://www.opengis.net/gml", 26) && !strcmp(cg_local_name(list[0]), "id"))
            return list[1];
    return NULL;
}

/* An id without what is around it, "#id" or the id itself; NULL, and counted, where it leads out of the file. */
static char *trim_reference(cg_parser *p, char *text) {
    char *end = text + strlen(text);
    while (end > text && strchr(" \t\r\n", end[-1]))
        *--end = 0;
    text += strspn(text, " \t\r\n");
    text += *text == '#';
    if (*text && !strpbrk(text, "#/:"))
        return text;
    if (*text)
        geo_issue(p->sink->issues, GEO_GUESSED, "appearance of what is in another file", text);
    return NULL;
}

static void on_start(void *user, const XML_Char *name, const XML_Char **list) {
    cg_parser *p = user;
    cg_looks *k = &p->looks;
    word is = word_of(name);
    if (p->status || is == WORD_OTHER)
        return;
    k->text.len = 0;
    if (is == WORD_TEXTURE || is == WORD_MATERIAL || is == WORD_GEOREFERENCED) {
        cg_look look = { .material = is == WORD_MATERIAL,
                         .as = { .f0 = -1, .roughness = -1 },
                         .diffuse = { 0.8, 0.8, 0.8 },
                         .specular = { 1, 1, 1 },
                         .shininess = 0.2 };
        const char *id = is == WORD_MATERIAL ? gml_id(list) : NULL;
        if (id && !(look.as.name = arena_strdup(&p->persistent, id)))
            cg_no_memory(p);
        k->inside = array_push(&k->all, look);
        k->front = true;
        k->lists.len = k->named = 0;
        if (!k->inside)
            cg_no_memory(p);
        if (is == WORD_GEOREFERENCED)
            geo_issue(p->sink->issues, GEO_GUESSED, "georeferenced texture, which is not read", "");
    } else if (is == WORD_LIST) {
        k->lists.len = 0;
    } else if (is == WORD_COORDINATES || is == WORD_TARGET) {
        const char *id = attribute(list, is == WORD_TARGET ? "uri" : "ring");
        char **to = is == WORD_TARGET ? &k->target : &k->reference;
        free(*to);
        *to = noc_strdup(id);
        if (id && !*to)
            cg_no_memory(p);
    }
}

static void on_text(void *user, const XML_Char *text, int size) {
    cg_parser *p = user;
    if (p->status || !p->looks.inside)
        return;
    if (p->looks.text.len + (size_t)size > cg_most_numbers)
        cg_fail(p, NOC_ERR_FORMAT, "more than %zu bytes of text in an appearance", cg_most_numbers);
    else if (!array_append(&p->looks.text, text, (size_t)size))
        cg_no_memory(p);
}

/* The numbers of the text into values, up to `most`; how many there are. */
static size_t numbers_of(const char *text, double *values, size_t most) {
    size_t n = 0;
    const char *end = text + strlen(text);
    while (n < most && (text = noc_scan_double(text, end, &values[n])))
        n++;
    return n;
}

/* Coordinates of a ring, whose name stands beside them or comes later. */
static void add_list(cg_parser *p, const char *text) {
    cg_looks *k = &p->looks;
    size_t first = k->uv.len;
    const char *end = text + strlen(text);
    for (double x; (text = noc_scan_double(text, end, &x));)
        if (!array_push(&k->uv, (float)x))
            cg_no_memory(p);
    cg_ring_image ring = { .look = (uint32_t)k->all.len, .first = first, .count = (k->uv.len - first) / 2 };
    if (!array_push(&k->rings, ring) || !array_push(&k->lists, (uint32_t)k->rings.len - 1))
        cg_no_memory(p);
}

static void name_ring(cg_parser *p, size_t list, char *reference) {
    cg_looks *k = &p->looks;
    const char *id = reference ? trim_reference(p, reference) : NULL;
    uint64_t have;
    if (!id || list >= k->lists.len || !k->front || map_get(&k->by_ring, id, &have))
        return;
    if (!map_put(&k->by_ring, id, k->lists.data[list], NULL))
        cg_no_memory(p);
}

static void name_target(cg_parser *p, char *reference) {
    cg_looks *k = &p->looks;
    const char *id = reference ? trim_reference(p, reference) : NULL;
    uint64_t have;
    if (!id || !k->front || map_get(&k->by_target, id, &have))
        return;
    if (!map_put(&k->by_target, id, k->all.len, NULL))
        cg_no_memory(p);
}

noc_wrap cg_wrap_of(const char *mode) {
    return strstr(mode, "mirror") ? NOC_WRAP_MIRROR : strstr(mode, "wrap") ? NOC_WRAP_REPEAT : NOC_WRAP_CLAMP;
}

void cg_material_left_out(cg_parser *p, const cg_look *look) {
    if (look->emissive[0] > 0 || look->emissive[1] > 0 || look->emissive[2] > 0)
        geo_issue(p->sink->issues, GEO_GUESSED, "emissive colour, which has no unit and is left out", "");
}

static void end_material(cg_parser *p, cg_look *look) {
    import_x3d_colour(&look->as, look->diffuse);
    import_x3d_gloss(&look->as, look->specular, look->shininess);
    import_x3d_transparency(&look->as, look->transparency, p->sink->issues);
    cg_material_left_out(p, look);
}

static void end_image(cg_parser *p, cg_look *look, char *text) {
    char *end = text + strlen(text);
    while (end > text && strchr(" \t\r\n", end[-1]))
        *--end = 0;
    look->as.image = arena_strdup(&p->persistent, text + strspn(text, " \t\r\n"));
    if (!look->as.image || !noc_stream_note_named(p->stream, look->as.image))
        cg_no_memory(p);
}

static void on_end(void *user, const XML_Char *name) {
    cg_parser *p = user;
    cg_looks *k = &p->looks;
    word is = word_of(name);
    if (p->status || is == WORD_OTHER || !k->inside)
        return;
    cg_look *look = &k->all.data[k->all.len - 1];
    if (!array_push(&k->text, 0)) {
        cg_no_memory(p);
        return;
    }
    char *text = k->text.data;
    double number;
    switch (is) {
    case WORD_IMAGE: end_image(p, look, text); break;
    case WORD_WRAP: look->as.wrap = cg_wrap_of(text); break;
    case WORD_FRONT: k->front = !strstr(text, "false") && !strchr(text, '0'); break;
    case WORD_DIFFUSE: numbers_of(text, look->diffuse, 3); break;
    case WORD_SPECULAR: numbers_of(text, look->specular, 3); break;
    case WORD_EMISSIVE: numbers_of(text, look->emissive, 3); break;
    case WORD_SHININESS: numbers_of(text, &look->shininess, 1); break;
    case WORD_TRANSPARENCY: look->transparency = numbers_of(text, &number, 1) ? number : NAN; break;
    case WORD_TARGET:
        if (look->material)
            name_target(p, k->target ? k->target : text);
        break;
    case WORD_COORDINATES:
        add_list(p, text);
        /* without a ring's name the first one is that of the target, a polygon or ring; 3.0 names them later */
        if (k->reference || k->lists.len == 1)
            name_ring(p, k->lists.len - 1, k->reference ? k->reference : k->target);
        break;
    case WORD_RING: /* 3.0: after all lists, in their order */ name_ring(p, k->named++, text); break;
    case WORD_LIST: k->named = 0; break;
    case WORD_GENERATED:
        geo_issue(p->sink->issues, GEO_GUESSED, "texture placed by a matrix, which is not read", "");
        break;
    case WORD_MATERIAL: end_material(p, look); break;
    default: break;
    }
    k->inside = k->inside && is != WORD_TEXTURE && is != WORD_MATERIAL && is != WORD_GEOREFERENCED;
    k->text.len = 0;
    cg_affords(p,
               k->all.len * sizeof(*k->all.data) + k->uv.len * sizeof(*k->uv.data) +
                   k->rings.len * sizeof(*k->rings.data) + k->by_ring.keys.bytes + k->by_target.keys.bytes +
                   (k->by_ring.cap + k->by_target.cap) * 3 * sizeof(uint64_t) + p->persistent.bytes,
               "its appearances");
}

noc_status cg_read_looks(cg_parser *p) {
    bool wanted = p->sink->appearance, named = noc_stream_listener(p->stream)->on_named;
    if (!wanted && !named)
        return NOC_OK;
    bool any = wanted ? scan(p, strlen(MARK) - 1, holds_mark) : scan(p, LONGEST_NAME, note_images);
    noc_status status = p->status ? p->status : noc_stream_rewind(p->stream);
    if (!status && any)
        status = cg_parse(p, 0, &(cg_handlers){ on_start, on_end, on_text });
    return status || !any ? status : noc_stream_rewind(p->stream);
}

/* ---- what surfaces look like ---- */

void cg_looks_free(cg_looks *k) {
    array_free(&k->all);
    array_free(&k->rings);
    array_free(&k->uv);
    array_free(&k->text);
    array_free(&k->lists);
    map_free(&k->by_ring);
    map_free(&k->by_target);
    map_free(&k->pairs);
    free(k->reference);
    free(k->target);
}

void cg_ring_look(cg_parser *p, const char *id, size_t points, const char *report_id) {
    cg_looks *k = &p->looks;
    uint64_t found = 0;
    if (p->xml && *id && !p->polygon_material)
        p->polygon_material = cg_material_of(p, id);
    if (p->polygon_unplaced || (p->xml && !k->rings.len))
        return;
    p->polygon_unplaced = true;
    bool named = !p->xml || (*id && map_get(&k->by_ring, id, &found)) ||
                 (p->ring_exterior && p->polygon_id && map_get(&k->by_ring, p->polygon_id, &found));
    if (!named)
        return;
    const cg_ring_image *ring = p->xml ? &k->rings.data[found] : &k->given;
    if (!ring->look)
        return;
    if (ring->count != points && ring->count != points + 1) {
        cg_issue(p, GEO_GUESSED, "texture coordinates that do not fit their ring", *id ? id : report_id);
        return;
    }
    if (p->polygon_texture && p->polygon_texture != ring->look)
        return;
    p->polygon_texture = ring->look;
    size_t places = 2 * points;
    p->polygon_unplaced = !array_append(&p->ring_uv, k->uv.data + ring->first, places);
    if (p->polygon_unplaced)
        cg_no_memory(p);
}

uint32_t cg_material_of(const cg_parser *p, const char *id) {
    uint64_t found;
    return id && p->looks.by_target.len && map_get(&p->looks.by_target, id, &found) ? (uint32_t)found : 0;
}

void cg_spread_materials(cg_parser *p) {
    cg_object *o = &p->object;
    for (size_t i = 0; i < o->targets.len && p->looks.by_target.len; i++) { /* what is inside comes first */
        const cg_target *t = &o->targets.data[i];
        uint32_t material = cg_material_of(p, t->id);
        for (size_t s = t->first; material && s < (size_t)t->first + t->count; s++)
            if (o->surfaces.data[s].polygon && !o->surfaces.data[s].polygon->material)
                o->surfaces.data[s].polygon->material = material;
    }
}

uint32_t cg_appearance_of(cg_parser *p, uint32_t material, uint32_t texture) {
    cg_looks *k = &p->looks;
    char key[32];
    uint64_t found;
    uint32_t number = 0;
    if (!material && !texture)
        return 0;
    noc_snprintf(key, sizeof(key), "%u %u", material, texture);
    if (map_get(&k->pairs, key, &found))
        return (uint32_t)found;
    geo_appearance as = k->all.data[(material ? material : texture) - 1].as;
    if (texture) {
        as.image = k->all.data[texture - 1].as.image;
        as.wrap = k->all.data[texture - 1].as.wrap;
    }
    cg_stop(p, p->sink->appearance(p->sink->ctx, &as, &number));
    if (!p->status && !map_put(&k->pairs, key, number, NULL))
        cg_no_memory(p);
    return number;
}
