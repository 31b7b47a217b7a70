/* Images of base colours: beside the file, in it as data URIs or in its buffers, and where vertices are in them.
 *
 * The origin of texture coordinates is the image's upper left corner, that of ours its lower left one.
 * KHR_texture_transform is read as its text says: UVs are turned counter-clockwise as they are seen in the image. */
#include "import/mesh/gltf.h"

#include <math.h>
#include <stdio.h>

enum { REPEAT = 10497, CLAMP = 33071, MIRROR = 33648 };

static noc_wrap wrap_of(const gltf *g, const json_t *texture, const char *name) {
    size_t index;
    const json_t *sampler = gltf_index(texture, "sampler", &index) ? gltf_item(g, "samplers", index) : NULL;
    double u = gltf_number(sampler, "wrapS", REPEAT), v = gltf_number(sampler, "wrapT", REPEAT);
    if (u != v)
        geo_issue(g->issues, GEO_GUESSED, "texture that goes on upwards otherwise than sidewards, as it does sidewards",
                  name);
    return u == CLAMP ? NOC_WRAP_CLAMP : u == MIRROR ? NOC_WRAP_MIRROR : NOC_WRAP_REPEAT;
}

bool gltf_texture_of(const gltf *g, const json_t *material, gltf_texture *out) {
    const json_t *use = json_object_get(json_object_get(material, "pbrMetallicRoughness"), "baseColorTexture");
    const json_t *transform = gltf_extension(use, "KHR_texture_transform");
    *out = (gltf_texture){ .scale = { 1, 1 } };
    gltf_numbers(transform, "offset", 2, out->offset);
    gltf_numbers(transform, "scale", 2, out->scale);
    out->rotation = gltf_number(transform, "rotation", 0);
    if (!gltf_index(transform, "texCoord", &out->set))
        gltf_index(use, "texCoord", &out->set);
    return use && gltf_index(use, "index", &out->index);
}

bool gltf_texture_places(const gltf_texture *t, const json_t *primitive, size_t *accessor) {
    char key[40];
    snprintf(key, sizeof(key), "TEXCOORD_%zu", t->set);
    return gltf_index(json_object_get(primitive, "attributes"), key, accessor);
}

float *gltf_texture_uv(const gltf *g, const gltf_texture *t, const double *places, size_t count) {
    float *uv = noc_alloc_large(count * 2, sizeof(*uv));
    if (!uv) {
        noc_no_memory(g->log, g->name);
        return NULL;
    }
    double c = cos(t->rotation), s = sin(t->rotation);
    for (size_t i = 0; i < count; i++) {
        double u = t->scale[0] * places[2 * i], v = t->scale[1] * places[2 * i + 1];
        uv[2 * i] = (float)(c * u + s * v + t->offset[0]);
        uv[2 * i + 1] = (float)(1 - (c * v - s * u + t->offset[1]));
    }
    return uv;
}

noc_status gltf_note_images(const gltf *g, const noc_stream *stream) {
    const json_t *images = json_object_get(g->root, "images");
    bool noted = true;
    for (size_t i = 0; i < json_array_size(images) && noted; i++) {
        const char *uri = json_string_value(json_object_get(json_array_get(images, i), "uri"));
        char *name = uri && strncmp(uri, "data:", 5) ? noc_strdup(uri) : NULL;
        if (name)
            gltf_decode_percent(name);
        noted = name ? noc_stream_note_named(stream, name) : !uri || !strncmp(uri, "data:", 5);
        free(name);
    }
    return noted ? NOC_OK : noc_no_memory(g->log, g->name);
}

/* The image's bytes, or its file's name: *name, which the caller frees. *why: it is of no use. */
static noc_status find_image(const gltf *g, const json_t *item, size_t index, mesh_image *image, char **name,
                             const char **why) {
    const char *uri = json_string_value(json_object_get(item, "uri"));
    *name = uri && strncmp(uri, "data:", 5) ? noc_strdup(uri) : noc_format("%s#image %zu", g->name, index);
    if (!*name)
        return noc_no_memory(g->log, g->name);
    image->name = *name;
    if (!uri) {
        image->data = gltf_view(g, item, &image->size);
        *why = image->data ? NULL : "image whose bytes are not there";
    } else if (strncmp(uri, "data:", 5)) {
        gltf_decode_percent(*name);
        *why = strstr(uri, "://") ? "image on a network, which is not read" : NULL;
    } else {
        gltf_image *held = &g->decoded[index];
        if (!held->looked)
            held->data = gltf_decode_data(uri, &held->size, &held->good);
        held->looked = true;
        if (held->good && !held->data)
            return noc_no_memory(g->log, g->name);
        image->data = held->data;
        image->size = held->size;
        *why = held->good ? NULL : "image that is not base64";
    }
    return NOC_OK;
}

noc_status gltf_texture_give(const gltf *g, const gltf_texture *t, int material, const float albedo[3], uint8_t cutoff,
                             const char *name) {
    size_t source;
    const json_t *texture = gltf_item(g, "textures", t->index);
    const json_t *item = gltf_index(texture, "source", &source) ? gltf_item(g, "images", source) : NULL;
    if (!item) {
        geo_issue(g->issues, GEO_GUESSED, "image that is not there", name);
        return NOC_OK;
    }
    mesh_image image = { .wrap = wrap_of(g, texture, name), .cutoff = cutoff };
    memcpy(image.albedo, albedo, sizeof(image.albedo));
    char *path;
    const char *why = NULL;
    noc_status status = find_image(g, item, source, &image, &path, &why);
    if (!status && why)
        geo_issue(g->issues, GEO_GUESSED, why, name);
    else if (!status)
        status = g->place->image(g->place->ctx, material, &image);
    free(path);
    return status;
}
