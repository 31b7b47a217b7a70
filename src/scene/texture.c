/* Images that materials' albedo comes from, in the form that core/texture.h looks up: each with its pyramid of halves.
 */
#include "scene/scene.h"

#include <math.h>

/* What lies under an image's pixel of the next coarser level. */
typedef struct tap {
    int first;
    float share[3];
} tap;

enum { MOST_TEXTURES = 1 << 20 };

static float albedo_of(int code, bool linear) {
    double x = code / 255.0, a = linear ? x : x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
    return (float)NOC_CLAMP(a, NOC_TEXTURE_DARKEST, NOC_TEXTURE_BRIGHTEST);
}

/* Pixel i of `to` covers from / to pixels of the finer level, which are two or three. */
static tap tap_of(int i, int from, int to) {
    double lo = (double)i * from / to, hi = (double)(i + 1) * from / to;
    tap t = { .first = (int)lo };
    for (int k = 0; k < 3; k++) {
        double covered = NOC_MIN(hi, t.first + k + 1) - NOC_MAX(lo, t.first + k);
        t.share[k] = (float)(NOC_MAX(covered, 0) / (hi - lo));
    }
    return t;
}

static uint32_t pack(const float rgb[3]) {
    uint32_t texel = TEXEL_THERE;
    for (int c = 0; c < 3; c++)
        texel |= (uint32_t)(sqrtf(rgb[c]) * 1023 + 0.5f) << 10 * c;
    return texel;
}

static int half_of(int side) { return NOC_MAX(side / 2, 1); }

/* The next coarser level, by area. What has more holes than surface becomes one; colours are those of the surface. */
static void halve(const uint32_t *from, int width, int height, uint32_t *to) {
    const float unit = 1.0f / 1023;
    for (int y = 0; y < half_of(height); y++) {
        tap rows = tap_of(y, height, half_of(height));
        for (int x = 0; x < half_of(width); x++) {
            tap columns = tap_of(x, width, half_of(width));
            float sum[3] = { 0 }, holed[3] = { 0 }, holes = 0;
            for (int i = 0; i < 9; i++) {
                float share = rows.share[i / 3] * columns.share[i % 3];
                if (!(share > 0))
                    continue;
                uint32_t p = from[(size_t)(rows.first + i / 3) * (size_t)width + (size_t)(columns.first + i % 3)];
                bool hole = p & TEXEL_HOLE;
                holes += hole ? share : 0;
                for (int c = 0; c < 3; c++) {
                    float root = (float)(p >> 10 * c & 1023) * unit;
                    *(hole ? &holed[c] : &sum[c]) += root * root * share;
                }
            }
            bool all = !(holes < 1 - 1e-4f);
            for (int c = 0; c < 3 && holes > 0; c++)
                sum[c] = all ? holed[c] : NOC_MIN(sum[c] / (1 - holes), 1);
            *to++ = pack(sum) | (holes > 0.5f ? TEXEL_HOLE : 0);
        }
    }
}

/* Texels of all levels. */
static size_t texel_count(int width, int height, uint32_t *levels) {
    size_t count = 0;
    for (*levels = 0;; width = half_of(width), height = half_of(height)) {
        count += (size_t)width * (size_t)height;
        ++*levels;
        if (width == 1 && height == 1)
            return count;
    }
}

bool noc_scene_image_corners(const noc_scene *scene, size_t triangle, float at[3][2]) {
    if (!scene->materials.data[scene->triangle_material.data[triangle]].texture)
        return false;
    const noc_scene_mesh *mesh = &scene->meshes.data[noc_scene_mesh_of(scene, triangle)];
    const uint32_t *v = scene->indices.data + 3 * triangle;
    for (int corner = 0; corner < 3 && mesh->uv; corner++)
        memcpy(at[corner], scene->uv.data + 2 * (mesh->uv - 1 + (size_t)(v[corner] - mesh->first_vertex)),
               2 * sizeof(float));
    return mesh->uv;
}

size_t noc_texture_words(int width, int height) {
    uint32_t levels;
    return TEXTURE_HEAD + texel_count(width, height, &levels);
}

/* The first level that is kept: `whole` has room for it and the image. */
static uint32_t *first_level(uint32_t *whole, const noc_texture *t, int *width, int *height) {
    uint32_t code[3][256];
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++) {
            float rgb[3] = { 0 };
            rgb[c] = albedo_of(i, t->linear);
            code[c][i] = pack(rgb);
        }
    *width = t->width;
    *height = t->height;
    size_t count = (size_t)t->width * (size_t)t->height;
    for (size_t i = 0; i < count; i++)
        whole[i] = code[0][t->rgb[3 * i]] | code[1][t->rgb[3 * i + 1]] | code[2][t->rgb[3 * i + 2]] |
                   (t->holes && t->holes[i] ? TEXEL_HOLE : 0);
    for (int i = 0; i < t->leave_out; i++) {
        uint32_t *half = i % 2 ? whole : whole + count;
        halve(i % 2 ? whole + count : whole, *width, *height, half);
        *width = half_of(*width);
        *height = half_of(*height);
    }
    return t->leave_out % 2 ? whole + count : whole;
}

/* Fills the words of a texture that begins at `place`. */
static void fill(uint32_t *words, uint32_t place, noc_wrap wrap, const uint32_t *level, int width, int height) {
    uint32_t levels, *texel = words + TEXTURE_HEAD;
    texel_count(width, height, &levels);
    memset(words, 0, TEXTURE_HEAD * sizeof(*words));
    words[0] = levels | (uint32_t)wrap << 8;
    memcpy(texel, level, (size_t)width * (size_t)height * sizeof(*texel));
    for (uint32_t l = 0; l < levels; l++) {
        words[1 + 2 * l] = place + (uint32_t)(texel - words);
        words[2 + 2 * l] = (uint32_t)width | (uint32_t)height << 16;
        uint32_t *next = texel + (size_t)width * (size_t)height;
        if (l + 1 < levels)
            halve(texel, width, height, next);
        width = half_of(width);
        height = half_of(height);
        texel = next;
    }
}

/* FNV-1a of words, from two beginnings: of the shape and the first level, from which the others follow. */
static noc_scene_texture describe(const uint32_t *words, uint32_t place) {
    noc_scene_texture t = { place, { 0xcbf29ce484222325u, 0x84222325cbf29ce4u } };
    uint32_t shape[] = { words[0], words[2] };
    size_t count = (size_t)(words[2] & 0xffff) * (words[2] >> 16);
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < NOC_COUNT(shape); i++)
            t.content[k] = (t.content[k] ^ shape[i]) * 0x100000001b3u;
        for (size_t i = 0; i < count; i++)
            t.content[k] = (t.content[k] ^ words[TEXTURE_HEAD + i]) * 0x100000001b3u;
    }
    return t;
}

int noc_scene_add_texture(noc_scene *scene, const noc_texture *t) {
    if (!scene || !t || !t->rgb) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    if (t->width < 1 || t->width > NOC_TEXTURE_SIDE || t->height < 1 || t->height > NOC_TEXTURE_SIDE ||
        (unsigned)t->wrap > NOC_WRAP_CLAMP || t->leave_out < 0 || t->leave_out > 15) {
        noc_error(scene->log, NOC_ERR_ARGUMENT,
                  "texture: it must have 1..%d pixels a side, a wrap that is known, and leave out "
                  "0..15 levels",
                  NOC_TEXTURE_SIDE);
        return -1;
    }
    size_t pixels = (size_t)t->width * (size_t)t->height, first = scene->texels.len;
    int width = NOC_MAX(t->width >> t->leave_out, 1), height = NOC_MAX(t->height >> t->leave_out, 1);
    size_t words = noc_texture_words(width, height);
    if (first + words > INT32_MAX || scene->textures.len == MOST_TEXTURES) {
        noc_error(scene->log, NOC_ERR_UNSUPPORTED, "texture: more than %d textures, or 8 GiB of them, in a scene",
                  (int)MOST_TEXTURES);
        return -1;
    }
    uint32_t *whole = noc_alloc((pixels + (t->leave_out ? pixels / 2 + 1 : 0)) * sizeof(*whole));
    const uint32_t *level = whole ? first_level(whole, t, &width, &height) : NULL;
    noc_scene_lock_commit(scene); /* frames read the array */
    bool room = level && array_reserve(&scene->texels, first + words) &&
                array_reserve(&scene->textures, scene->textures.len + 1);
    if (room) {
        fill(scene->texels.data + first, (uint32_t)first, t->wrap, level, width, height);
        scene->texels.len = first + words;
        scene->textures.data[scene->textures.len++] = describe(scene->texels.data + first, (uint32_t)first);
    }
    noc_scene_unlock_commit(scene);
    free(whole);
    if (!room) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    return (int)scene->textures.len;
}
