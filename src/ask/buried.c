/* Why a place is dark: it lies in a body, or below the ground. */
#include "ask/ask.h"

#include <math.h>

enum { SIDES = 5, RAYS = SIDES + 2 }; /* rays to the sides; one down, one up */

#define LIFT 1e-3  /* m: rays begin so far over the place, which may lie on what it measures */
#define LEAST 2e-3 /* m below the ground; less is the step between two surfaces */

static const uint32_t buildings = 1u << NOC_CLASS_WALL | 1u << NOC_CLASS_ROOF | 1u << NOC_CLASS_WINDOW |
                                  1u << NOC_CLASS_DOOR | 1u << NOC_CLASS_INSTALLATION;

static const char *name_of(const noc_scene *scene, const noc_hit *hit) {
    const char *name = hit->object < 0 ? NULL : noc_scene_object_name(scene, (size_t)hit->object);
    return name ? name : "";
}

static const char *body_of(noc_class cls) {
    if (buildings >> cls & 1)
        return "a building";
    switch (cls) {
    case NOC_CLASS_LAMP: return "a lamp's pole or head";
    case NOC_CLASS_TREE: return "a tree";
    case NOC_CLASS_VEHICLE: return "a vehicle";
    case NOC_CLASS_FURNITURE: return "furniture of the street";
    default: return "a body";
    }
}

static bool is_building(const noc_hit *hit) { return buildings >> hit->cls & 1; }

/* Do all rays to the sides, and the one up, meet a body from within? Houses in a row may have no wall between them. */
static const noc_hit *find_body(const noc_scene *scene, const noc_hit *hits) {
    const noc_hit *up = &hits[SIDES + 1], *of = is_building(hits) ? up : hits;
    for (int i = 0; i < SIDES; i++) {
        const noc_hit *h = &hits[i];
        bool one = is_building(h) == is_building(of) && h->instance == of->instance &&
                   (is_building(h) || !strcmp(name_of(scene, h), name_of(scene, of)));
        if (!h->hit || h->front || !one || (ask_ground >> h->cls & 1 && h->cls != NOC_CLASS_OTHER))
            return NULL;
    }
    return of->hit && !of->front ? of : NULL;
}

/* m below the ground; 0: it is not. Under a bridge and in a tunnel ground lies below. */
static double depth_of(const noc_scene *scene, const double place[3], const noc_hit *down, const noc_hit *up) {
    double z;
    bool floor = down->hit && down->front, open = !up->hit || up->front;
    bool found = !floor && !open && noc_scene_ground(scene, place[0], place[1], &z);
    return found && z - place[2] > LEAST ? z - place[2] : 0;
}

noc_status noc_view_buried(noc_view *view, const noc_scene *scene, const double place[3], char *text, size_t size) {
    noc_ray rays[RAYS];
    noc_hit hits[RAYS];
    char name[64];
    if (!view || !scene || !place || !text || !size)
        return noc_null(NULL, __func__);
    *text = 0;
    for (int i = 0; i < RAYS; i++) {
        double angle = 0.37 + 2 * M_PI * i / SIDES;
        rays[i] = (noc_ray){ { place[0], place[1], place[2] + LIFT }, { cos(angle), sin(angle), 0 }, INFINITY };
    }
    memcpy(rays[SIDES].direction, (double[3]){ 0, 0, -1 }, sizeof(rays->direction));
    memcpy(rays[SIDES + 1].direction, (double[3]){ 0, 0, 1 }, sizeof(rays->direction));
    noc_status status = noc_view_cast(view, rays, RAYS, hits);
    if (status != NOC_OK)
        return status;
    const noc_hit *body = find_body(scene, hits);
    noc_text_clean(name, sizeof(name), body && body->cls != NOC_CLASS_LAMP ? name_of(scene, body) : "");
    double depth = depth_of(scene, place, &hits[SIDES], &hits[SIDES + 1]);
    if (body)
        noc_snprintf(text, size, "inside %s%s%s", body_of(body->cls), *name ? ", " : "", name);
    else if (depth > 0)
        noc_snprintf(text, size, "below the ground by %.*f m", depth < 0.1 ? 3 : 1, depth);
    return NOC_OK;
}
