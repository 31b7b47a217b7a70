/* Once all surfaces are in: ground where there is none, and the lamps on it. */
#include "city/city.h"
#include "import/load.h"

#include <math.h>

#define COARSE_DISTANCE 100e3 /* m */
#define OUTSIDE 2000.0       /* m; lamps farther than this from the city do not light it */
#define GROUND_SHARE 0.2     /* of the extent that streets, lawns and water cover when they are the ground */

typedef struct extent {
    bool any;
    double lo[2], hi[2];
} extent;

static double distance_outside(const extent *e, const double *p) {
    double d[2];
    for (int k = 0; k < 2; k++)
        d[k] = NOC_MAX(NOC_MAX(e->lo[k] - p[k], p[k] - e->hi[k]), 0);
    return hypot(d[0], d[1]);
}

static extent city_extent(const noc_scene *scene) {
    extent e = { .any = scene->indices.len > 0 };
    for (int k = 0; e.any && k < 2; k++) {
        e.lo[k] = scene->bounds_min[k];
        e.hi[k] = scene->bounds_max[k];
    }
    return e;
}

/* What comes without terrain stands on a ground of ours, unless its streets and lawns are there; so do lamps alone. Scenes
 * that are no cities (meshes) are left as they are. */
static bool needs_ground(const importer *im, const extent *e) {
    bool city = false;
    for (size_t i = 0; i < im->input_count; i++)
        city = city || (im->inputs[i].reader && !im->inputs[i].reader->read_mesh && im->inputs[i].file.triangles);
    if (!e->any)
        return im->lamps.len > 0;
    if (!city)
        return false;
    for (size_t t = 0; t < im->scene->triangle_material.len; t++)
        if (im->scene->materials.data[im->scene->triangle_material.data[t]].cls == NOC_CLASS_TERRAIN)
            return false;
    extent all = *e; /* with the lamps that stand beside it */
    for (size_t i = 0; i < im->lamps.len; i++) {
        const double *p = im->lamps.data[i].lamp.xyz;
        for (int k = 0; k < 2 && distance_outside(e, p) <= OUTSIDE; k++) {
            all.lo[k] = NOC_MIN(all.lo[k], p[k]);
            all.hi[k] = NOC_MAX(all.hi[k], p[k]);
        }
    }
    return im->open_area < GROUND_SHARE * (all.hi[0] - all.lo[0]) * (all.hi[1] - all.lo[1]);
}

/* Under the city and the lamps that belong to it. Heights of lamps count only where nothing else has any: they often come
 * from another height system. */
static void lay_ground(importer *im, const extent *e) {
    double *points = noc_alloc((im->lamps.len + 1) * 3 * sizeof(*points));
    size_t n = 0;
    for (size_t i = 0; i < im->lamps.len; i++) {
        const double *p = im->lamps.data[i].lamp.xyz;
        if (!isfinite(p[0]) || !isfinite(p[1]) || (e->any && distance_outside(e, p) > OUTSIDE))
            continue;
        memcpy(points + 3 * n, p, 3 * sizeof(*points));
        if (e->any)
            points[3 * n + 2] = NAN;
        n++;
    }
    city_add_ground(im->scene, points, n);
    free(points);
    noc_info(im->log, e->any ? "no terrain in the inputs: a ground is laid under the city"
                             : "no surfaces in the inputs: a ground is laid under the lamps");
}

static bool shines(const noc_scene *scene) {
    if (scene->lights.len)
        return true;
    for (size_t i = 0; i < scene->meshes.len; i++) {
        const float *e = scene->materials.data[scene->meshes.data[i].material].emission;
        if (e[0] > 0 || e[1] > 0 || e[2] > 0)
            return true;
    }
    return false;
}

/* Positions are floats from the origin on: far from it they are coarse. */
static void warn_if_coarse(const importer *im) {
    const noc_scene *scene = im->scene;
    size_t far = 0, vertices = scene->positions.len / 3;
    double farthest = 0;
    for (size_t i = 0; i < vertices; i++) {
        double d = hypot((double)scene->positions.data[3 * i], (double)scene->positions.data[3 * i + 1]);
        if (!isfinite(d))
            continue; /* no triangle has it */
        far += d > COARSE_DISTANCE;
        farthest = NOC_MAX(farthest, d);
    }
    if (far && !im->far_said)
        noc_warn(im->log, "%zu of %zu vertices lie more than %.0f km from the scene's origin, the farthest %.0f km: positions "
                          "there are rounded to about %.2g m", far, vertices, COARSE_DISTANCE / 1e3, farthest / 1e3,
                 ldexp(1, ilogb(farthest) - 24));
}

static bool go_on(importer *im, double done) {
    const noc_progress *progress = &im->params->progress;
    if (progress->update && !progress->update(progress->user, "lamps", done))
        im->cancelled = true;
    return !im->cancelled;
}

static bool infer_update(void *user, const char *what, double done) {
    (void)what;
    return go_on(user, 0.9 + 0.1 * done);
}

/* Stands the lamps that were read; *nearest is the distance to the nearest of those outside. */
static size_t stand_lamps(importer *im, const extent *e, const city_lamp_params *params, double *nearest) {
    size_t outside = 0;
    *nearest = INFINITY;
    for (size_t i = 0; i < im->lamps.len; i++) {
        const pending_lamp *p = &im->lamps.data[i];
        input *in = &im->inputs[p->input];
        double d = e->any ? distance_outside(e, p->lamp.xyz) : 0;
        if (d > OUTSIDE) {
            geo_issue(in->issues, false, "lamp more than 2 km outside the city", p->lamp.id);
            *nearest = NOC_MIN(*nearest, d);
            outside++;
            continue;
        }
        int lights = city_add_lamp(im->scene, &p->lamp, params, false, in->issues);
        in->file.lights += lights > 0 ? (size_t)lights : 0;
        if (i % 256 == 0 && !go_on(im, 0.9 + 0.1 * (double)i / (double)im->lamps.len))
            break;
    }
    return outside;
}

noc_status finish_city(importer *im) {
    noc_scene *scene = im->scene;
    extent e = city_extent(scene);
    if (!e.any && !im->lamps.len && !scene->lights.len)
        noc_warn(im->log, "the inputs hold nothing that can be seen: no surfaces and no lamps");
    if (!go_on(im, 0.9))
        return NOC_ERR_CANCELLED;
    warn_if_coarse(im);
    if (needs_ground(im, &e))
        lay_ground(im, &e);
    city_lamp_params params = { im->params->lamp_height, im->params->lamp_lumens, im->params->lamp_kelvin, true,
                                city_floor(scene) };
    double nearest;
    size_t outside = stand_lamps(im, &e, &params, &nearest);
    if (im->cancelled)
        return NOC_ERR_CANCELLED;
    if (outside && outside == im->lamps.len)
        noc_warn(im->log, "all %zu lamp%s outside the city, the nearest %.1f km away: is one of the CRSs wrong?", outside,
                 outside == 1 ? " lies" : "s lie", nearest / 1000);
    else if (outside)
        noc_info(im->log, "outside the city, and left out: %zu of %zu lamps", outside, im->lamps.len);
    bool has_streets = im->buildings > 0 || im->has_roads;
    if (shines(scene))
        return NOC_OK;
    if (!im->params->infer_lamps || !has_streets) {
        bool warned = outside && outside == im->lamps.len;
        if ((e.any || im->lamps.len) && !warned)
            noc_warn(im->log, "nothing in the scene shines: %s", im->params->infer_lamps ?
                     "the inputs hold no lamps that could be used, and no streets or buildings to place some along" :
                     "the inputs hold no lamps that could be used, and none are to be placed");
        return NOC_OK;
    }
    geo_issues *issues = geo_issues_create();
    int lights;
    noc_status status = city_infer_lamps(scene, &params, &(noc_progress){ infer_update, im }, issues, &lights);
    geo_issues_destroy(issues);
    if (status)
        return status;
    const char *usable = im->lamps.len ? " that could be used" : "";
    if (lights > 0)
        noc_warn(im->log, "no lamps in the inputs%s: %d placed by a rule (inferred, not surveyed)", usable, lights);
    else
        noc_warn(im->log, "no lamps in the inputs%s, and no place for any was found: nothing in the scene shines", usable);
    return NOC_OK;
}
