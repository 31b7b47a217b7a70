/* look.c: "appearance": the materials and images that the file gives to surfaces, by themes. Of several themes the
 * default one comes first, then they come in their order: the first that says something of a surface is taken.
 *
 * Looks become those of the parser, as citygml.h has them. Features of a sequence often tell the same ones again, so
 * that each is kept once. */
#include "import/cityjson/cityjson.h"

#include <math.h>

/* The parser's look that the key stands for; 0: memory was refused. */
static uint32_t look_of(cj_reading *r, const char *key, const cg_look *look) {
    cg_looks *k = &r->parser->looks;
    uint64_t found = 0;
    if (key && map_get(&r->known_looks, key, &found))
        return (uint32_t)found;
    if (!key || !array_push(&k->all, *look) || !map_put(&r->known_looks, key, k->all.len, NULL)) {
        cg_no_memory(r->parser);
        return 0;
    }
    cg_affords(r->parser, k->all.len * sizeof(*k->all.data) + r->known_looks.keys.bytes + r->parser->persistent.bytes,
               "its appearances");
    return (uint32_t)k->all.len;
}

/* Three numbers; false where there are none. */
static bool read_colour(const json_t *object, const char *key, double rgb[3]) {
    const json_t *list = json_object_get(object, key);
    if (json_array_size(list) != 3)
        return false;
    for (size_t i = 0; i < 3; i++)
        rgb[i] = json_number_value(json_array_get(list, i));
    return true;
}

static uint32_t read_material(cj_reading *r, const json_t *material) {
    cg_look look = { .material = true, .as = { .f0 = -1, .roughness = -1 }, .specular = { 1, 1, 1 }, .shininess = 0.2 };
    const json_t *shininess = json_object_get(material, "shininess");
    if (read_colour(material, "diffuseColor", look.diffuse))
        import_x3d_colour(&look.as, look.diffuse);
    if (json_is_number(shininess))
        look.shininess = json_number_value(shininess);
    if (read_colour(material, "specularColor", look.specular) || json_is_number(shininess))
        import_x3d_gloss(&look.as, look.specular, look.shininess);
    read_colour(material, "emissiveColor", look.emissive);
    const json_t *clear = json_object_get(material, "transparency");
    import_x3d_transparency(&look.as, clear && !json_is_number(clear) ? NAN : json_number_value(clear),
                            r->parser->sink->issues);
    const char *name = cj_text(material, "name");
    char *key =
        noc_format("m %d %.9g %.9g %.9g %.9g %.9g %.9g %s", look.as.coloured, look.as.albedo[0], look.as.albedo[1],
                   look.as.albedo[2], look.as.f0, look.as.roughness, look.as.transmittance, name);
    uint64_t known;
    if (key && *name && !map_get(&r->known_looks, key, &known) &&
        !(look.as.name = arena_strdup(&r->parser->persistent, name))) {
        free(key);
        key = NULL;
    }
    size_t before = r->parser->looks.all.len;
    uint32_t number = look_of(r, key, &look);
    if (r->parser->looks.all.len > before)
        cg_material_left_out(r->parser, &look);
    free(key);
    return number;
}

static uint32_t read_texture(cj_reading *r, const json_t *texture) {
    const char *image = cj_text(texture, "image"), *mode = cj_text(texture, "wrapMode");
    cg_look look = { .as = { .f0 = -1, .roughness = -1, .wrap = *mode ? cg_wrap_of(mode) : NOC_WRAP_REPEAT } };
    uint64_t known;
    char *key =
        noc_stream_note_named(r->parser->stream, image) ? noc_format("t %d %s", (int)look.as.wrap, image) : NULL;
    if (key && !map_get(&r->known_looks, key, &known) &&
        !(look.as.image = arena_strdup(&r->parser->persistent, image))) {
        free(key);
        key = NULL;
    }
    uint32_t number = look_of(r, key, &look);
    free(key);
    return number;
}

/* Notes their images alone. */
static void note_textures(cj_reading *r, const json_t *textures) {
    for (size_t i = 0; i < json_array_size(textures) && !r->parser->status; i++)
        if (!noc_stream_note_named(r->parser->stream, cj_text(json_array_get(textures, i), "image")))
            cg_no_memory(r->parser);
}

static uint32_t *read_list(cj_reading *r, const json_t *list, uint32_t (*read)(cj_reading *r, const json_t *one),
                           size_t *count) {
    *count = json_array_size(list);
    uint32_t *out = noc_calloc(*count + 1, sizeof(*out));
    if (!out)
        cg_no_memory(r->parser);
    for (size_t i = 0; i < *count && !r->parser->status; i++)
        out[i] = read(r, json_array_get(list, i));
    return out;
}

static float *read_places(cj_reading *r, const json_t *list, size_t *count) {
    *count = json_array_size(list);
    float *uv = noc_calloc(*count + 1, 2 * sizeof(*uv));
    if (!uv)
        cg_no_memory(r->parser);
    for (size_t i = 0; i < *count && uv; i++)
        for (size_t k = 0; k < 2; k++)
            uv[2 * i + k] = (float)json_number_value(json_array_get(json_array_get(list, i), k));
    return uv;
}

void cj_looks_read(cj_reading *r, json_t *root, cj_looks *out) {
    static const char *const defaults[CJ_LOOKS] = { "default-theme-material", "default-theme-texture" };
    const json_t *from = json_object_get(root, "appearance");
    cj_looks_free(out);
    out->there = json_is_object(from) && r->parser->sink->appearance;
    if (!out->there) {
        note_textures(r, json_object_get(from, "textures"));
        return;
    }
    out->number[CJ_MATERIAL] =
        read_list(r, json_object_get(from, "materials"), read_material, &out->count[CJ_MATERIAL]);
    if (!r->parser->status)
        out->number[CJ_TEXTURE] =
            read_list(r, json_object_get(from, "textures"), read_texture, &out->count[CJ_TEXTURE]);
    if (!r->parser->status)
        out->uv = read_places(r, json_object_get(from, "vertices-texture"), &out->uv_count);
    for (int i = 0; i < CJ_LOOKS && !r->parser->status; i++)
        if (!(out->theme[i] = noc_strdup(cj_text(from, defaults[i]))))
            cg_no_memory(r->parser);
    json_object_del(root, "appearance");
}

void cj_looks_free(cj_looks *looks) {
    for (int i = 0; i < CJ_LOOKS; i++) {
        free(looks->number[i]);
        free(looks->theme[i]);
    }
    free(looks->uv);
    *looks = (cj_looks){ 0 };
}

/* ---- of a geometry ---- */

cj_themes cj_themes_of(const cj_looks *looks, const json_t *geometry) {
    static const char *const keys[CJ_LOOKS] = { "material", "texture" };
    cj_themes t = { .looks = looks };
    for (int i = 0; i < CJ_LOOKS && looks->there; i++) {
        json_t *all = json_object_get(geometry, keys[i]), *theme = json_object_get(all, looks->theme[i]),
               *first = theme;
        const char *name;
        if (theme)
            t.theme[i][t.count[i]++] = theme;
        json_object_foreach(all, name, theme) {
            if (theme != first && t.count[i] < CJ_MOST_THEMES)
                t.theme[i][t.count[i]++] = theme;
        }
    }
    return t;
}

/* What a theme has at a surface's place among the nested lists; NULL: nothing. */
static const json_t *at_place(const json_t *theme, const size_t *path, int depth) {
    const json_t *values = json_object_get(theme, "values");
    for (int i = 0; i < depth; i++)
        values = json_array_get(values, path[i]);
    return json_is_null(values) ? NULL : values;
}

/* The look of that index; 0: none, or one that is not there, which is counted once a geometry. */
static uint32_t number_of(cj_themes *t, int kind, const json_t *index) {
    json_int_t i = json_integer_value(index);
    if (json_is_integer(index) && i >= 0 && (uint64_t)i < t->looks->count[kind])
        return t->looks->number[kind][i];
    t->missing = true;
    return 0;
}

uint32_t cj_material_at(cj_themes *t, const size_t *path, int depth) {
    for (size_t i = 0; i < t->count[CJ_MATERIAL]; i++) {
        const json_t *theme = t->theme[CJ_MATERIAL][i], *all = json_object_get(theme, "value");
        const json_t *index = all && !json_is_null(all) ? all : at_place(theme, path, depth);
        if (index)
            return number_of(t, CJ_MATERIAL, index);
    }
    return 0;
}

const json_t *cj_texture_at(const cj_themes *t, const size_t *path, int depth) {
    for (size_t i = 0; i < t->count[CJ_TEXTURE]; i++) {
        const json_t *rings = at_place(t->theme[CJ_TEXTURE][i], path, depth), *first = json_array_get(rings, 0);
        if (json_array_size(first) && !json_is_null(json_array_get(first, 0)))
            return rings;
    }
    return NULL;
}

void cj_ring_texture(cj_reading *r, cj_themes *t, const json_t *list) {
    cg_looks *k = &r->parser->looks;
    k->given = (cg_ring_image){ 0 };
    k->uv.len = 0;
    uint32_t look = json_array_size(list) > 1 ? number_of(t, CJ_TEXTURE, json_array_get(list, 0)) : 0;
    for (size_t i = 1; look && i < json_array_size(list); i++) {
        const json_t *index = json_array_get(list, i);
        json_int_t at = json_integer_value(index);
        if (!json_is_integer(index) || at < 0 || (uint64_t)at >= t->looks->uv_count) {
            t->missing = true;
            return;
        }
        if (!array_append(&k->uv, t->looks->uv + 2 * at, (size_t)2)) {
            cg_no_memory(r->parser);
            return;
        }
    }
    k->given = (cg_ring_image){ .look = look, .count = k->uv.len / 2 };
}
