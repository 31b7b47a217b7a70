/* Lamps and the roads of maps: which way lamps face that do not tell it, and lamps along lit roads that have none. */
#include "city/city.h"
#include "import/load/load.h"

#include <math.h>

#define BESIDE 150.0 /* m around the city in which streets get lamps */

typedef struct where {
    importer *im;
    reading reading; /* of no file: for the way to the box */
    noc_status status;
} where;

/* In the box that is taken, and in the city where there is one. */
static bool is_inside(void *user, const double xy[2]) {
    where *w = user;
    const noc_scene *scene = w->im->scene;
    for (int k = 0; k < 2 && scene->indices.len; k++)
        if (xy[k] < scene->bounds_min[k] - BESIDE || xy[k] > scene->bounds_max[k] + BESIDE)
            return false;
    bool inside = true;
    w->status = w->status ? w->status : box_point(&w->reading, (double[]){ xy[0], xy[1], 0 }, &inside);
    return inside && !w->status;
}

static bool update(void *user, const char *what, double done) {
    importer *im = user;
    const noc_progress *progress = &im->params->progress;
    im->cancelled =
        im->cancelled ||
        (progress->update && !progress->update(progress->user, what, import_done(im, DONE_LAMPS, LAMPS_PLACED * done)));
    return !im->cancelled;
}

static bool keep(importer *im, const city_road_lamp *place) {
    char *id = noc_format("inferred/%s/%u", place->road->id, place->number + 1);
    bool on_foot = place->road->cls == GEO_ROAD_PATH || place->road->cls == GEO_ROAD_PEDESTRIAN ||
                   place->road->cls == GEO_ROAD_LIVING;
    pending_lamp p = { .lamp = { .xyz = { place->xy[0], place->xy[1], NAN },
                                 .height = place->height,
                                 .direction = atan2(place->facing[0], place->facing[1]) * 180 / M_PI,
                                 .lumens = im->params->lamp_lumens * place->flux,
                                 .watts = NAN,
                                 .kelvin = NAN,
                                 .rgb = { -1, -1, -1 },
                                 .type = on_foot ? GEO_LAMP_LANTERN : GEO_LAMP_STREET,
                                 .id = id ? arena_strdup(&im->names, id) : NULL,
                                 .ref = "" },
                       .along = place->road };
    free(id);
    return p.lamp.id && array_push(&im->lamps, p);
}

/* Water of the maps as a scene of its own: what asks what lies below a place asks scenes. NULL: memory was refused,
 * and that is said. */
static noc_scene *water_of(const importer *im) {
    noc_scene *scene = noc_scene_create(im->log);
    const noc_material material = noc_class_material(NOC_CLASS_WATER);
    const noc_mesh mesh = { .vertex_count = im->water.xyz.len / 3,
                            .positions = im->water.xyz.data,
                            .triangle_count = im->water.indices.len / 3,
                            .indices = im->water.indices.data };
    bool made = scene && noc_scene_add_material(scene, &material) == 0 &&
                (!mesh.triangle_count || noc_scene_add_mesh(scene, &mesh) >= 0);
    if (made)
        return scene;
    noc_scene_destroy(scene);
    return NULL;
}

static noc_status place_along(importer *im, const city_roads *roads, const double *mapped) {
    where w = { .im = im, .reading = { .im = im, .in = &im->inputs[0], .log = im->log } };
    const noc_progress progress = { update, im };
    noc_scene *water = water_of(im);
    if (!water)
        return NOC_ERR_MEMORY;
    const city_road_params params = { .height = im->params->lamp_height,
                                      .water = water,
                                      .mapped = mapped,
                                      .mapped_count = im->lamps.len,
                                      .inside = is_inside,
                                      .user = &w,
                                      .progress = &progress };
    city_road_lamp *places;
    size_t count;
    noc_status status = city_road_lamps(im->scene, roads, &params, &places, &count, &im->streets_inferred);
    reading_free(&w.reading);
    status = status || !water->no_memory ? status : NOC_ERR_MEMORY;
    noc_scene_destroy(water);
    status = status ? status : w.status;
    for (size_t i = 0; i < count && !status; i++)
        if (!keep(im, &places[i]))
            status = noc_no_memory(im->log, "import");
    free(places);
    return status;
}

noc_status road_lamps_add(importer *im, const city_roads *roads) {
    size_t count = im->lamps.len;
    double *mapped = noc_alloc((count + 1) * 2 * sizeof(*mapped));
    if (!mapped)
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < count; i++)
        memcpy(mapped + 2 * i, im->lamps.data[i].lamp.xyz, 2 * sizeof(*mapped));
    noc_status status = place_along(im, roads, mapped);
    free(mapped);
    return status;
}

void road_lamps_face(importer *im, const city_roads *roads) {
    double facing[2];
    for (size_t i = 0; i < im->lamps.len; i++) {
        geo_lamp *lamp = &im->lamps.data[i].lamp;
        if (!isfinite(lamp->direction) && lamp->mount != GEO_MOUNT_WALL && city_roads_beside(roads, lamp->xyz, facing))
            lamp->direction = atan2(facing[0], facing[1]) * 180 / M_PI;
    }
}

lamp_roads road_lamps_near(const importer *im, const double xy[2]) {
    const city_roads *roads = im->roads_by_place;
    return roads ? (lamp_roads){ city_roads_street(roads, xy), city_roads_beside(roads, xy, NULL) } : (lamp_roads){ 0 };
}

/* ---- bridges ---- */

#define KERB 3.0   /* m beside the carriageway of a bridge that are its pavement */
#define OFF 3.0    /* m between a lamp's elevation and the deck that it stands on */
#define RAISED 1.0 /* m between a deck and the ground that make a difference */

static void put_on_deck(importer *im, const city_roads *roads, pending_lamp *p) {
    geo_lamp *lamp = &p->lamp;
    const geo_road *road = p->along ? p->along : city_roads_beside(roads, lamp->xyz, NULL);
    double off, low;
    if (!road || !road->bridge || lamp->body_heads)
        return;
    double deck = geo_road_deck(road, lamp->xyz, &off);
    bool on = (p->along || off <= geo_road_width(road) / 2 + KERB) &&
              noc_scene_ground(im->scene, lamp->xyz[0], lamp->xyz[1], &low) && deck > low + RAISED;
    if (!on || fabs(lamp->xyz[2] - deck) > OFF)
        return;
    lamp->xyz[2] = deck;
    lamp->on_deck = true;
    if (!p->along)
        geo_issue(im->inputs[p->input].issues, GEO_GUESSED, "lamp on a bridge of a map: put on its deck", lamp->id);
}

noc_status road_lamps_raise(importer *im) {
    city_roads *own = NULL;
    bool bridges = false;
    for (size_t i = 0; i < im->roads.len && !bridges; i++)
        bridges = im->roads.data[i].bridge;
    if (!bridges)
        return NOC_OK;
    noc_status status = city_level_decks(im->scene, im->roads.data, im->roads.len, &im->names);
    if (status || !im->lamps.len)
        return status;
    if (!im->roads_by_place && !(own = city_roads_create(im->roads.data, im->roads.len)))
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < im->lamps.len; i++)
        put_on_deck(im, own ? own : im->roads_by_place, &im->lamps.data[i]);
    city_roads_destroy(own);
    return NOC_OK;
}
