/* A name for all that a picture of a scene depends on, camera and parameters apart. */
#include "scene/scene.h"

#include <stdio.h>

/* FNV-1a of 128 bits: no guard against malice, but no two scenes meet by chance. */
typedef unsigned __int128 content_hash;

static content_hash add(content_hash h, const void *data, size_t size) {
    const content_hash prime = ((content_hash)1 << 88) | 0x13b;
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * prime;
    return h;
}

/* With its length, so that what ends one array cannot begin the next. */
static content_hash add_array(content_hash h, const void *data, size_t count, size_t size) {
    uint64_t length = count;
    h = add(h, &length, sizeof(length));
    return count ? add(h, data, count * size) : h;
}

void noc_scene_content(const noc_scene *s, char key[NOC_CONTENT_KEY]) {
    if (!s || !key)
        return;
    content_hash h = ((content_hash)0x6c62272e07bb0142u << 64) | 0x62b821756295c58du;
    h = add_array(h, s->positions.data, s->positions.len, sizeof(float));
    h = add_array(h, s->indices.data, s->indices.len, sizeof(uint32_t));
    h = add_array(h, s->triangle_material.data, s->triangle_material.len, sizeof(uint32_t));
    h = add_array(h, s->triangle_light.data, s->triangle_light.len, sizeof(uint32_t));
    h = add_array(h, s->material_records.data, s->material_records.len, sizeof(noc_material_record));
    for (size_t i = 0; i < s->materials.len; i++) { /* closures are not drawn, and light may leave both sides */
        uint32_t rest[] = { (uint32_t)s->materials.data[i].cls, s->materials.data[i].two_sided };
        h = add(h, rest, sizeof(rest));
    }
    h = add_array(h, s->lights.data, s->lights.len, sizeof(noc_light_record));
    snprintf(key, NOC_CONTENT_KEY, "%016llx%016llx", (unsigned long long)(h >> 64), (unsigned long long)h);
}
