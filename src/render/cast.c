/* Rays of whoever picks, measures or walks. */
#include "render/view.h"

#include <math.h>

static bool in_order(const noc_ray *r) {
    double most = 0;
    for (int k = 0; k < 3; k++) {
        if (!(fabs(r->origin[k]) < 1e7 && isfinite(r->direction[k])))
            return false;
        most = fmax(most, fabs(r->direction[k]));
    }
    return most > 1e-100 && most < 1e100 && !isnan(r->far);
}

noc_status noc_view_cast(noc_view *v, const noc_ray *rays, size_t count, noc_hit *hits) {
    if (!v || (count && (!rays || !hits)))
        return noc_null(v ? v->log : NULL, __func__);
    for (size_t i = 0; i < count; i++)
        if (!in_order(&rays[i]))
            return noc_error(v->log, NOC_ERR_ARGUMENT,
                             "cast: ray %zu: its origin must be within 10 000 km, its direction finite and not 0, its "
                             "far a number",
                             i);
    noc_scene_lock_frame(v->scene); /* the structure follows what is published, and stays as it is */
    noc_status status = v->backend->cast(v->state, rays, count, hits);
    noc_scene_unlock_frame(v->scene);
    return status;
}
