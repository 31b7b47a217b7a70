#include "light/environment.h"

noc_map_light *noc_map_light_create(const noc_scene *scene, noc_log *log) {
    const noc_environment *e = scene->environment;
    size_t n = (size_t)e->light_width * (size_t)e->light_height;
    noc_map_light *m = noc_calloc(1, sizeof(*m));
    double *weight = noc_alloc_large(n, sizeof(*weight));
    if (m)
        m->sines = noc_alloc_large((size_t)e->light_height + 1, sizeof(*m->sines));
    if (!m || !weight || !m->sines) {
        noc_error(log, NOC_ERR_MEMORY, "environment: no memory for the light of %d x %d texels", e->light_width,
                  e->light_height);
        free(weight);
        noc_map_light_destroy(m);
        return NULL;
    }
    for (int y = 0; y <= e->light_height; y++)
        m->sines[y] = (float)noc_environment_sine(y, e->light_height);
    const float *c = e->light;
    for (int y = 0; y < e->light_height; y++) {
        double share = (double)m->sines[y] - m->sines[y + 1]; /* as places in it are drawn */
        for (int x = 0; x < e->light_width; x++, c += 3)
            *weight++ = (0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]) * share;
    }
    weight -= n;
    m->texels = noc_alias_of(weight, n, "environment", log);
    free(weight);
    if (!m->texels) {
        noc_map_light_destroy(m);
        return NULL;
    }
    m->bytes = m->texels->bytes + ((size_t)e->light_height + 1) * sizeof(*m->sines);
    return m;
}

void noc_map_light_destroy(noc_map_light *m) {
    if (!m)
        return;
    noc_alias_destroy(m->texels);
    free(m->sines);
    free(m);
}
