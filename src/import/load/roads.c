/* Roads of maps, which are kept until all inputs are read. */
#include "import/load/load.h"
#include "city/city.h"

static bool surfaces_wanted(const noc_import_params *params) {
    return params->map_surfaces == NOC_SWITCH_ON || (params->map_surfaces == NOC_SWITCH_AUTO && params->footprints);
}

bool roads_wanted(const importer *im) {
    const noc_import_params *p = im->params;
    return p->infer_lamps != NOC_SWITCH_OFF || p->traffic == NOC_SWITCH_ON || luminaires_ask_roads(im) ||
           surfaces_wanted(p);
}

static void count_road(noc_report_file *file, const geo_road *road) {
    if (road->cls == GEO_ROAD_RAIL) {
        file->railways++;
        return;
    }
    double length = geo_road_length(road);
    file->roads++;
    file->road_metres += length;
    file->roads_lit += road->lit == GEO_LIT_YES;
    file->road_metres_lit += road->lit == GEO_LIT_YES ? length : 0;
}

/* Extracts that meet hold the same ways. *fresh: none like it was kept. */
static noc_status look_up(importer *im, const input *in, const geo_road *road, bool *fresh) {
    const double *a = road->xyz, *b = road->xyz + 3 * (road->point_count - 1);
    char *key = noc_format("%s %.2f %.2f %.2f %.2f", road->id, a[0], a[1], b[0], b[1]);
    bool kept = key && map_put(&im->road_places, key, 1, fresh);
    free(key);
    return kept ? NOC_OK : noc_no_memory(im->log, in->path);
}

noc_status road_keep(importer *im, input *in, const geo_road *road) {
    bool fresh;
    noc_status status = look_up(im, in, road, &fresh);
    if (!status && !fresh)
        geo_issue(in->issues, GEO_SPARED, "road that is given twice", road->id);
    if (status || !fresh)
        return status;
    count_road(&in->file, road);
    if (im->inspect)
        return NOC_OK;
    geo_road kept = *road;
    size_t bytes = 3 * road->point_count * sizeof(double);
    double *xyz = arena_alloc(&im->names, bytes);
    kept.id = arena_strdup(&im->names, road->id);
    kept.name = arena_strdup(&im->names, road->name);
    kept.xyz = xyz;
    if (!xyz || !kept.id || !kept.name || !array_push(&im->roads, kept))
        return noc_no_memory(im->log, in->path);
    memcpy(xyz, road->xyz, bytes);
    return take_kept(im, in);
}

static bool update(void *user, const char *what, double done) {
    const importer *im = user;
    (void)done; /* of the load it is little */
    return !im->params->progress.update || im->params->progress.update(im->params->progress.user, what, 0.9);
}

static void tell_paved(const importer *im, const city_paved *p) {
    char left[200] = "";
    const struct {
        size_t count;
        const char *what;
    } rows[] = { { p->unpaved, "railways and tracks" },
                 { p->tunnels, "tunnels" },
                 { p->off_ground, "beyond the ground" },
                 { p->too_many, "too many or too long" } };
    for (size_t i = 0, n = 0; i < NOC_COUNT(rows) && n < sizeof(left) - 1; i++)
        if (rows[i].count)
            n += (size_t)noc_snprintf(left + n, sizeof(left) - n, "%s%zu %s", n ? ", " : "; left out: ", rows[i].count,
                                      rows[i].what);
    noc_info(im->log, "%zu roads of maps have surfaces of %zu triangles%s", p->roads, p->triangles, left);
    if (p->too_many)
        noc_warn(im->log, "%zu roads of maps have no surface: they are too many, or too long", p->too_many);
}

geo_triangles *area_kept(importer *im, noc_class cls) {
    if (cls == NOC_CLASS_WATER)
        return &im->water;
    if (!surfaces_wanted(im->params))
        return NULL;
    return cls == NOC_CLASS_GREEN      ? &im->green
           : cls == NOC_CLASS_SIDEWALK ? &im->squares
           : cls == NOC_CLASS_ROAD     ? &im->lots
                                       : NULL;
}

/* One above the other, and roads above all; heights of the ground that they lie on come to that. */
static noc_status lay_areas(importer *im, size_t *made) {
    const struct {
        const geo_triangles *triangles;
        noc_class cls;
        double lift; /* m */
    } rows[] = { { &im->water, NOC_CLASS_WATER, 0.004 },
                 { &im->green, NOC_CLASS_GREEN, 0.004 },
                 { &im->lots, NOC_CLASS_ROAD, 0.004 },
                 { &im->squares, NOC_CLASS_SIDEWALK, 0.004 } };
    noc_status status = NOC_OK;
    *made = 0;
    for (size_t i = 0; i < NOC_COUNT(rows) && !status; i++) {
        size_t count;
        status = city_lay_area(im->scene, rows[i].triangles, rows[i].cls, rows[i].lift, &(noc_progress){ update, im },
                               &count);
        *made += status ? 0 : count;
    }
    return status;
}

noc_status roads_pave(importer *im) {
    city_paved paved;
    bool own = im->has_roads && im->params->map_surfaces != NOC_SWITCH_ON;
    if (!surfaces_wanted(im->params) || own)
        return NOC_OK;
    size_t made;
    noc_status status = lay_areas(im, &made);
    if (status)
        return status;
    if (made)
        noc_info(im->log, "water, lawns, car parks and squares of maps have surfaces of %zu triangles", made);
    if (!im->roads.len)
        return NOC_OK;
    status = city_pave_roads(im->scene, im->roads.data, im->roads.len, &(noc_progress){ update, im }, &paved);
    if (status)
        return status;
    im->report->roads_drawn = paved.roads;
    tell_paved(im, &paved);
    return NOC_OK;
}

/* Named ones stay with the scene. */
noc_status roads_name(importer *im) {
    for (size_t i = 0; i < im->roads.len; i++) {
        const geo_road *r = &im->roads.data[i];
        const noc_scene_street street = { r->name, r->id, (float)geo_road_width(r), 0, 0 };
        if (*r->name && r->cls != GEO_ROAD_RAIL && !noc_scene_add_street(im->scene, &street, r->xyz, r->point_count))
            return NOC_ERR_MEMORY;
    }
    return NOC_OK;
}
