/* The map around the scene: what is seen, of which what lights is made again. */
#include "scene/keep.h"

void noc_keep_environment(noct_writer *w, const noc_scene *s) {
    const noc_environment *e = s->environment;
    if (!e)
        return;
    const int32_t sizes[] = { e->given, e->width, e->height };
    noct_put_array(w, "skysize", sizes, NOC_COUNT(sizes), sizeof(*sizes));
    noct_put_array(w, "sky", e->texels, (size_t)e->width * (size_t)e->height, 3 * sizeof(float));
}

/* One that was set before stays. */
noc_status noc_kept_environment(noct_file *f, noc_scene *s) {
    size_t count, texels, bad;
    const int32_t *size = noct_array(f, "skysize", sizeof(*size), &count);
    float *rgb = noct_array(f, "sky", 3 * sizeof(float), &texels);
    if (f->status || !(count || texels) || s->environment)
        return f->status;
    if (count != 3 || size[0] < 1 || size[0] > NOC_IMAGE_MAX_SIDE || size[1] < 2 || size[1] > NOC_IMAGE_MAX_SIDE ||
        size[2] != size[1] / 2 || texels != (size_t)size[1] * (size_t)size[2] || size[1] % 2 ||
        !noc_environment_fits(size[1], size[2]))
        return noct_wrong(f, "the map around it is none");
    s->environment = noc_environment_make(&(noc_image){ .width = size[1], .height = size[2], .rgb = rgb }, &bad);
    if (!s->environment)
        return noct_no_memory(f);
    s->environment->given = size[0];
    return bad ? noct_wrong(f, "the map around it does not shine") : NOC_OK;
}
