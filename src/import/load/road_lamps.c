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
        if (isfinite(lamp->direction) || lamp->mount == GEO_MOUNT_WALL || !city_roads_beside(roads, lamp->xyz, facing))
            continue;
        lamp->direction = atan2(facing[0], facing[1]) * 180 / M_PI;
        im->lamps.data[i].faced = true;
    }
}

lamp_roads road_lamps_near(const importer *im, const double xy[2]) {
    const city_roads *roads = im->roads_by_place;
    return roads ? (lamp_roads){ city_roads_street(roads, xy), city_roads_beside(roads, xy, NULL) } : (lamp_roads){ 0 };
}

/* ---- bridges ---- */

#define KERB 3.0   /* m beside the carriageway of a bridge that are its pavement */
#define EDGE 6.0   /* m beside that of one for cars within which lamps stand: pavement, cycle track, pole */
#define DOUBT 4.0  /* m beyond, in which a lamp may be of the bridge */
#define OFF 3.0    /* m between a lamp's elevation and the deck that it stands on */
#define RAISED 1.0 /* m between a deck and the ground that make a difference */

/* Bridge and road below, near a lamp; distances are from the edge of a carriageway [m], negative on it. */
typedef struct crossing {
    const geo_road *bridge;
    double off, off_below; /* INFINITY: no road */
    double deck, low;      /* heights */
} crossing;

/* Returns true if a raised bridge is near the lamp. */
static bool find_crossing(const importer *im, const city_roads *roads, const pending_lamp *p, crossing *c) {
    const double *xy = p->lamp.xyz;
    double off;
    c->bridge = p->along ? p->along : city_roads_by_bridge(roads, xy, true, &c->off, NULL);
    if (!c->bridge || !c->bridge->bridge)
        return false;
    city_roads_by_bridge(roads, xy, false, &c->off_below, NULL);
    c->deck = geo_road_deck(c->bridge, xy, &off);
    return noc_scene_ground(im->scene, xy[0], xy[1], &c->low) && c->deck > c->low + RAISED;
}

/* Returns true if the lamp stands on the deck. *reason: what makes that doubtful, or that it does not; NULL: nothing.
 * Over the bridge's carriageway, and over that of a road below it, no pole stands on the ground; else it is of the
 * nearer road. */
static bool is_on_deck(const crossing *c, const geo_lamp *lamp, const char **reason) {
    static const char on[] = "lamp on a bridge of a map: put on its deck",
                      at_edge[] = "lamp beside the carriageway of a bridge of a map: put on its deck",
                      beside[] = "lamp beside a bridge of a map: left on the ground",
                      over[] = "lamp at a bridge of a map and a road below it: put on the deck",
                      below[] = "lamp at a bridge of a map and a road below it: left on the ground";
    double path = c->bridge->cls == GEO_ROAD_PATH ? KERB : 0, edge = path > 0 ? KERB : EDGE;
    *reason = NULL;
    if (isfinite(lamp->xyz[2])) {
        bool told = c->off <= edge && fabs(lamp->xyz[2] - c->deck) <= OFF &&
                    fabs(lamp->xyz[2] - c->deck) <= fabs(lamp->xyz[2] - c->low);
        *reason = told ? on : NULL;
        return told;
    }
    bool nearer = c->off + path <= c->off_below, road_below = c->off_below <= KERB;
    if (c->off > edge) {
        *reason = nearer && c->off <= edge + DOUBT ? beside : NULL;
        return false;
    }
    bool stands = nearer || c->off <= 0 || c->off_below < 0;
    if (road_below)
        *reason = stands ? over : below;
    else if (stands)
        *reason = c->off <= KERB ? on : at_edge;
    return stands;
}

static void put_on_deck(importer *im, const city_roads *roads, pending_lamp *p) {
    geo_lamp *lamp = &p->lamp;
    const char *reason = NULL;
    double facing[2];
    crossing c;
    if (lamp->body_heads || !find_crossing(im, roads, p, &c))
        return;
    bool on = p->along || is_on_deck(&c, lamp, &reason);
    if (reason)
        geo_issue(im->inputs[p->input].issues, GEO_GUESSED, reason, lamp->id);
    lamp->off_deck = !on && reason;
    if (!on)
        return;
    lamp->xyz[2] = c.deck;
    lamp->on_deck = true;
    if (p->faced && city_roads_by_bridge(roads, lamp->xyz, true, &c.off, facing))
        lamp->direction = atan2(facing[0], facing[1]) * 180 / M_PI;
}

noc_status road_lamps_on_bridges(importer *im) {
    bool bridges = false;
    size_t others = 0;
    for (size_t i = 0; i < im->roads.len && !bridges; i++)
        bridges = im->roads.data[i].bridge;
    city_roads *roads = bridges ? city_roads_create(im->roads.data, im->roads.len) : NULL;
    if (bridges && !roads)
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < im->lamps.len && bridges; i++) {
        pending_lamp *p = &im->lamps.data[i];
        double off, off_other;
        if (!isfinite(p->lamp.xyz[2]))
            continue;
        const geo_road *bridge = city_roads_by_bridge(roads, p->lamp.xyz, true, &off, NULL);
        city_roads_by_bridge(roads, p->lamp.xyz, false, &off_other, NULL);
        p->on_bridge = bridge && off < off_other && off <= (bridge->cls == GEO_ROAD_PATH ? KERB : EDGE);
        others += !p->on_bridge;
    }
    for (size_t i = 0; i < im->lamps.len && !others; i++)
        im->lamps.data[i].on_bridge = false;
    city_roads_destroy(roads);
    return NOC_OK;
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
