/* Textures, and where the vertices of meshes are in them. */
#include "scene/keep.h"

typedef struct kept_texture {
    uint64_t content[2];
    uint32_t place, zero;
} kept_texture;
_Static_assert(sizeof(kept_texture) == 24, "it has no gaps");

void noc_keep_textures(noct_writer *w, const noc_scene *s) {
    if (!s->textures.len && !s->uv.len)
        return;
    noct_begin(w, "textures");
    for (size_t i = 0; i < s->textures.len; i++) {
        const noc_scene_texture *t = &s->textures.data[i];
        noct_put(w, &(kept_texture){ .content = { t->content[0], t->content[1] }, .place = t->place },
                 sizeof(kept_texture));
    }
    noct_end(w);
    noct_put_array(w, "texels", s->texels.data, s->texels.len, sizeof(uint32_t));
    noct_put_array(w, "uv", s->uv.data, s->uv.len / 2, 2 * sizeof(float));
}

/* A head whose levels lie among the texels: whatever is in those, a lookup stays in them. */
static bool texture_fits(const noc_scene *s, uint32_t place) {
    if (place > s->texels.len || s->texels.len - place < TEXTURE_HEAD)
        return false;
    const uint32_t *head = s->texels.data + place;
    uint32_t levels = head[0] & 0xff;
    bool ok = levels >= 1 && levels <= (TEXTURE_HEAD - 2) / 2 && head[0] >> 8 <= NOC_WRAP_CLAMP;
    for (uint32_t l = 0; ok && l < levels; l++) {
        size_t first = head[1 + 2 * l], width = head[2 + 2 * l] & 0xffff, height = head[2 + 2 * l] >> 16;
        ok = width >= 1 && width <= NOC_TEXTURE_SIDE && height >= 1 && height <= NOC_TEXTURE_SIDE &&
             first <= s->texels.len && width * height <= s->texels.len - first;
    }
    return ok;
}

static bool check_uv(const void *ctx, size_t first, size_t end) {
    const noc_scene *s = ctx;
    return noc_kept_finite(s->uv.data + 2 * first, 2 * (end - first), 1e6f);
}

noc_status noc_kept_textures(noct_file *f, noc_scene *s) {
    size_t count, words, places;
    const kept_texture *k = noct_array(f, "textures", sizeof(*k), &count);
    uint32_t *texels = noct_array(f, "texels", sizeof(*texels), &words);
    float *uv = noct_array(f, "uv", 2 * sizeof(*uv), &places);
    if (f->status)
        return f->status;
    if (words > INT32_MAX || places >= UINT32_MAX)
        return noct_wrong(f, "it has %zu words of textures", words);
    if (!array_reserve(&s->textures, count))
        return noct_no_memory(f);
    array_borrow(&s->texels, texels, words);
    array_borrow(&s->uv, uv, 2 * places);
    for (size_t i = 0; i < count; i++) {
        if (!texture_fits(s, k[i].place))
            return noct_wrong(f, "texture %zu is none", i);
        s->textures.data[s->textures.len++] = (noc_scene_texture){ k[i].place, { k[i].content[0], k[i].content[1] } };
    }
    return noct_each(f, places, check_uv, s) ? NOC_OK : noct_wrong(f, "a vertex has no place in an image");
}
