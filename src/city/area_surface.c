/* Areas of maps as surfaces: water, lawns, squares. Their triangles are split until they follow the ground. */
#include "city/city.h"
#include "city/drape.h"

#include <math.h>

#define SHORT 4.0 /* m: shorter edges are not split, */
#define LONG 40.0 /* longer ones always are */
#define FLAT 0.01 /* m that the ground may lie off an edge */
enum { MOST_TRIANGLES = 4000000 };

static double ground_at(void *user, double x, double y) {
    double z;
    return noc_scene_ground(user, x, y, &z) ? z : NAN;
}

static noc_status add_mesh(noc_scene *scene, const drape *d, noc_class cls) {
    noc_material m = noc_class_material(cls);
    noc_mesh mesh = { .vertex_count = d->position.len / 3,
                      .positions = d->position.data,
                      .triangle_count = d->index.len / 3,
                      .indices = d->index.data,
                      .material = noc_scene_add_material(scene, &m) };
    bool made = mesh.material >= 0 && noc_scene_add_mesh(scene, &mesh) >= 0;
    return made ? NOC_OK : scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_ARGUMENT;
}

noc_status city_lay_area(noc_scene *scene, const geo_triangles *triangles, noc_class cls, double lift,
                         const noc_progress *progress, size_t *made) {
    drape d = { .scene = scene,
                .height = ground_at,
                .user = scene,
                .lift = lift,
                .flat = FLAT,
                .shortest = SHORT,
                .longest = LONG,
                .most = MOST_TRIANGLES };
    noc_status status = NOC_OK;
    for (size_t t = 0; t < triangles->indices.len / 3 && !status && !drape_is_full(&d); t++) {
        const double *at[3];
        for (size_t k = 0; k < 3; k++)
            at[k] = triangles->xyz.data + 3 * (size_t)triangles->indices.data[3 * t + k];
        if (t % 256 == 0 && progress && progress->update && !progress->update(progress->user, "areas", 0))
            status = NOC_ERR_CANCELLED;
        status = status ? status : drape_triangle(&d, at, progress);
    }
    if (d.no_memory)
        noc_scene_out_of_memory(scene);
    if (!status && drape_is_full(&d))
        noc_warn(scene->log, "areas of maps (%s) are too many or too large: some have no surface", noc_class_name(cls));
    *made = d.index.len / 3;
    if (!status && *made)
        status = add_mesh(scene, &d, cls);
    drape_free(&d);
    return status;
}
