/* Once all surfaces are in: ground where there is none, and the lamps on it. */
#include "city/city.h"
#include "import/load/load.h"

#include <math.h>
#include <stdio.h>

#define COARSE_DISTANCE 100e3 /* m */
#define OUTSIDE 2000.0        /* m; lamps farther than this from the city do not light it */
#define BESIDE 150.0          /* m; lamps this near stand along streets of the city whose surfaces are not in it */
#define GROUND_SHARE 0.2      /* of the extent that streets, lawns and water cover when they are the ground */

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

/* What comes without terrain stands on a ground of ours, unless its streets and lawns are there; so do lamps alone.
 * Scenes that are no cities (meshes) are left as they are. */
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

/* The lamps that belong to the city. Returns how many. */
static size_t places_of_lamps(const importer *im, const extent *e, double *points) {
    size_t count = 0;
    for (size_t i = 0; i < im->lamps.len; i++) {
        const double *p = im->lamps.data[i].lamp.xyz;
        if (!isfinite(p[0]) || !isfinite(p[1]) || (e->any && distance_outside(e, p) > OUTSIDE))
            continue;
        memcpy(points + 3 * count++, p, 3 * sizeof(*points));
        if (im->lamps.data[i].on_bridge)
            points[3 * count - 1] = NAN;
    }
    return count;
}

/* Under the city and the lamps that belong to it, through the heights of those that tell them. */
static noc_status lay_ground(importer *im, const extent *e) {
    double *points = noc_alloc((im->lamps.len + 1) * 3 * sizeof(*points));
    noc_status marked = points ? road_lamps_on_bridges(im) : noc_no_memory(im->log, "import");
    if (marked) {
        free(points);
        return marked;
    }
    city_ground *ground = city_ground_start(im->scene, points, places_of_lamps(im, e, points));
    noc_status status = ground && e->any ? heights_check(im, ground) : NOC_OK;
    if (ground)
        city_ground_keep(ground, im->first_mesh);
    if (ground && status)
        city_ground_free(ground);
    else if (ground) /* heights that are not of this city are gone now */
        heights_lay(im, ground, points, places_of_lamps(im, e, points));
    free(points);
    if (!ground || status)
        return status;
    noc_info(im->log, e->any ? "no terrain in the inputs: a ground is laid under the city"
                             : "no surfaces in the inputs: a ground is laid under the lamps");
    return NOC_OK;
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
        noc_warn(im->log,
                 "%zu of %zu vertices lie more than %.0f km from the scene's origin, the farthest %.0f km: positions "
                 "there are rounded to about %.2g m",
                 far, vertices, COARSE_DISTANCE / 1e3, farthest / 1e3, ldexp(1, ilogb(farthest) - 24));
}

static bool go_on(importer *im, double done) {
    const noc_progress *progress = &im->params->progress;
    if (progress->update && !progress->update(progress->user, "lamps", import_done(im, DONE_LAMPS, done)))
        im->cancelled = true;
    return !im->cancelled;
}

static bool infer_update(void *user, const char *what, double done) {
    (void)what;
    return go_on(user, LAMPS_PLACED + (1 - LAMPS_PLACED) * done);
}

/* What became of the lamps of the inputs. */
typedef struct lamp_fate {
    size_t given, mapped, outside, lost; /* lost: without a place */
    size_t strays;                       /* of those lost: strays.c has warned of them */
    double nearest;                      /* of those outside, m */
    double closest;                      /* of those mapped, m; 0 within the city */
    size_t others;                       /* lights of the scene that are no lamps of these */
    /* of those outside or lost lie within the city if their axes are exchanged; counted where it is told */
    size_t exchanged;
} lamp_fate;

/* One that was placed along a road, whose lights are of no input. */
static void stand_inferred(importer *im, pending_lamp *p, const city_lamp_params *params) {
    city_lamp_params untold = *params;
    untold.tally = NULL; /* of surveyed lamps alone, as are the report's issues */
    geo_lamp lamp = p->lamp;
    geo_fitting fitting;
    luminaires_dress(im, NULL, (lamp_roads){ p->along, p->along }, &lamp, &fitting);
    int lights = city_add_lamp(im->scene, &lamp, &untold, true, NULL);
    im->report->lamps_inferred += lights > 0 ? (size_t)lights : 0;
}

/* Stands the lamps that were read, and those along roads. */
static noc_status stand_lamps(importer *im, const extent *e, const city_lamp_params *params, lamp_fate *fate) {
    noc_status status = NOC_OK;
    *fate = (lamp_fate){
        .nearest = INFINITY, .closest = INFINITY, .others = im->scene->lights.len, .strays = im->lamps_stray
    };
    for (size_t i = 0; i < im->lamps.len; i++)
        fate->given += !im->lamps.data[i].along;
    for (size_t i = 0; i < im->input_count; i++) {
        fate->lost += im->inputs[i].lamps_lost;
        im->inputs[i].file.lamps_dropped = im->inputs[i].lamps_lost;
    }
    fate->given += fate->lost;
    for (size_t i = 0; i < im->lamps.len; i++) {
        pending_lamp *p = &im->lamps.data[i];
        input *in = &im->inputs[p->input];
        if (i % 256 == 0 && !go_on(im, LAMPS_PLACED + (1 - LAMPS_PLACED) * (double)i / (double)im->lamps.len))
            break;
        if (i % 256 == 0 && (status = take_affords(im, in, 0)))
            break;
        if (p->along) {
            stand_inferred(im, p, params);
            continue;
        }
        double d = e->any ? distance_outside(e, p->lamp.xyz) : 0;
        if (d > OUTSIDE) {
            geo_issue(in->issues, GEO_SKIPPED, "lamp more than 2 km outside the city", p->lamp.id);
            fate->nearest = NOC_MIN(fate->nearest, d);
            fate->outside++;
            in->file.lamps_dropped++;
            continue;
        }
        size_t moved = params->tally->moved, by_chance = params->tally->by_chance;
        geo_lamp lamp = p->lamp;
        geo_fitting fitting;
        luminaires_dress(im, in, road_lamps_near(im, lamp.xyz), &lamp, &fitting);
        size_t first = im->scene->lights.len;
        int lights = city_add_lamp(im->scene, &lamp, params, false, in->issues);
        report_lamp mapped = { (uint32_t)first, (uint32_t)im->scene->lights.len, (uint32_t)p->input };
        if (lights > 0 && !array_push(&im->report->mapped, mapped))
            return noc_no_memory(im->log, in->path);
        in->file.lights += lights > 0 ? (size_t)lights : 0;
        in->file.lamps_moved += lights > 0 ? params->tally->moved - moved : 0;
        *(lights > 0 ? &in->file.lamps_mapped : &in->file.lamps_dropped) += 1;
        if (lights > 0)
            report_assumed(&in->file, &lamp);
        in->file.lamps_assumed[NOC_LAMP_DIRECTION] += params->tally->by_chance - by_chance;
        fate->mapped += lights > 0;
        fate->closest = lights > 0 ? NOC_MIN(fate->closest, d) : fate->closest;
    }
    return status;
}

/* Of those that are left out. */
static void count_exchanged(importer *im, const extent *e, lamp_fate *fate) {
    double xy[2];
    for (size_t i = 0; i < im->lamps.len && e->any; i++) {
        const pending_lamp *p = &im->lamps.data[i];
        fate->exchanged += !p->along && distance_outside(e, p->lamp.xyz) > OUTSIDE &&
                           place_exchanged(im, &p->given, xy) && distance_outside(e, xy) <= OUTSIDE;
    }
    for (size_t i = 0; i < im->lost.len && e->any; i++)
        fate->exchanged += place_exchanged(im, &im->lost.data[i], xy) && distance_outside(e, xy) <= OUTSIDE;
}

/* The files whose lamps are left out: "a.csv and 2 more". Returns whether all of them are in degrees. */
static bool name_files(const importer *im, char *text, size_t size) {
    const input *first = NULL;
    size_t files = 0;
    bool degrees = true;
    for (size_t i = 0; i < im->input_count; i++)
        if (im->inputs[i].file.lamps_dropped) {
            first = first ? first : &im->inputs[i];
            degrees = degrees && im->inputs[i].file.degrees;
            files++;
        }
    char more[40] = "";
    if (files > 1)
        snprintf(more, sizeof(more), " and %zu more", files - 1);
    noc_snprintf(text, size, "%.500s%s", first ? first->path : "", more);
    return degrees;
}

/* ", 40 outside the city, the nearest 3.4 km away, 2 inside buildings or refused": why lamps are left out, but for
 * those that are told elsewhere. */
static void tell_reasons(const lamp_fate *fate, char *text, size_t size) {
    char outside[80] = "", lost[60] = "", rest[60] = "";
    size_t without = fate->lost - fate->strays, others = fate->given - fate->mapped - fate->outside - fate->lost;
    if (fate->outside)
        snprintf(outside, sizeof(outside), ", %zu outside the city, the nearest %.1f km away", fate->outside,
                 fate->nearest / 1000);
    if (without)
        snprintf(lost, sizeof(lost), ", %zu without a place in it", without);
    if (others)
        snprintf(rest, sizeof(rest), ", %zu inside buildings or refused", others);
    noc_snprintf(text, size, "%s%s%s", outside, lost, rest);
}

/* "a.csv: none of its 40 lamps is of use: 40 outside the city, ...", with the likely cause. */
static void tell_useless(const importer *im, const lamp_fate *fate, char *text, size_t size) {
    char files[560], reasons[200], cause[160];
    bool degrees = name_files(im, files, sizeof(files));
    tell_reasons(fate, reasons, sizeof(reasons));
    if (2 * fate->exchanged > fate->given)
        snprintf(cause, sizeof(cause),
                 "with %s exchanged %s%zu of them fall within the city, so exchange them in the file",
                 degrees ? "longitude and latitude" : "the two coordinates",
                 fate->exchanged == fate->given ? "all " : "", fate->exchanged);
    else
        snprintf(cause, sizeof(cause), "%s",
                 fate->outside ? "is one of the CRSs wrong, or are they another town's?" : "nocturne info tells more");
    noc_snprintf(text, size, "%s: none of %zu lamp%s is of use%s: %s", files, fate->given, fate->given == 1 ? "" : "s",
                 reasons, cause);
}

/* Light that is missing for what may be a fault of the input. */
static void warn_of_left_out(importer *im, const extent *e, lamp_fate *fate) {
    size_t left = fate->given - fate->mapped - fate->strays;
    if (!left)
        return;
    count_exchanged(im, e, fate);
    char files[560], reasons[200], cause[120] = "";
    bool degrees = name_files(im, files, sizeof(files));
    tell_reasons(fate, reasons, sizeof(reasons));
    if (fate->exchanged)
        snprintf(cause, sizeof(cause), "; the coordinates of %zu seem exchanged%s", fate->exchanged,
                 degrees ? ", longitude and latitude" : "");
    noc_warn(im->log, "%s: %zu of %zu lamps %s left out: %s%s", files, left, fate->given, left == 1 ? "is" : "are",
             reasons + strlen(", "), cause);
}

/* A picture by lamps of our own must not pass for one by the lamps that were given. */
static noc_status refuse_useless(importer *im, const extent *e, lamp_fate *fate) {
    if (!fate->given || fate->mapped)
        return NOC_OK;
    count_exchanged(im, e, fate);
    char text[900];
    tell_useless(im, fate, text, sizeof(text));
    noc_status status = NOC_OK;
    if (im->params->infer_lamps == NOC_SWITCH_ON)
        noc_warn(im->log, "%s", text);
    else
        status = noc_error(im->log, NOC_ERR_FORMAT, "%s (--infer-lamps places some by a rule instead)", text);
    return status;
}

/* They are drawn all the same: a lone building whose street is 200 m away is no mistake, and an error would leave no
 * way to draw it. */
static void warn_of_distance(importer *im, const lamp_fate *fate) {
    bool apart = fate->mapped && fate->closest > BESIDE;
    im->scene->lit_elsewhere = apart && !fate->others;
    if (apart)
        noc_warn(im->log,
                 "none of the lamps stands in the city: the nearest is %.*f %s from it. Is one of the CRSs wrong, "
                 "or are they another town's?",
                 fate->closest < 1000 ? 0 : 1, fate->closest / (fate->closest < 1000 ? 1 : 1000),
                 fate->closest < 1000 ? "m" : "km");
}

static void warn_of_roofs(const importer *im, const city_lamp_tally *tally) {
    if (tally->raised)
        noc_warn(
            im->log,
            "%zu of %zu lamps that stand on surfaces without a class stand 2 m or more above what is around them, "
            "on roofs perhaps: an elevation (ele, z) says where a lamp's foot is, a model with classes (CityGML) where "
            "the ground is",
            tally->raised, tally->classless);
}

/* Lamps by a rule, or a word on why the scene stays dark. */
static noc_status infer(importer *im, const extent *e, city_lamp_params *params, const lamp_fate *fate) {
    bool wanted = im->params->infer_lamps != NOC_SWITCH_OFF;
    size_t buildings = 0;
    for (size_t i = 0; i < im->input_count; i++)
        buildings += im->inputs[i].file.buildings;
    if (!wanted || !(buildings > 0 || im->has_roads)) {
        if ((e->any || fate->given) && !im->scene->environment)
            noc_warn(
                im->log, "nothing in the scene shines: %s",
                wanted ? "the inputs hold no lamps that could be used, and no streets or buildings to place some along"
                       : "the inputs hold no lamps that could be used, and none are to be placed");
        return NOC_OK;
    }
    int lights;
    params->tally = NULL; /* of surveyed lamps alone, as are the report's issues */
    noc_status status = city_infer_lamps(im->scene, params, &(noc_progress){ infer_update, im }, NULL, &lights);
    if (status)
        return status;
    im->report->lamps_inferred = lights > 0 ? (size_t)lights : 0; /* each has one head */
    const char *usable = fate->given ? " that could be used" : "";
    if (lights > 0)
        noc_warn(im->log, "no lamps in the inputs%s: %d placed by a rule (inferred, not surveyed)", usable, lights);
    else
        noc_warn(im->log, "no lamps in the inputs%s, and no place for any was found%s", usable,
                 im->scene->environment ? "" : ": nothing in the scene shines");
    return NOC_OK;
}

static void tell_along_roads(const importer *im, const lamp_fate *fate) {
    size_t count = im->report->lamps_inferred, streets = im->streets_inferred;
    const char *many = streets == 1 ? "" : "s";
    if (count && !fate->given)
        noc_warn(im->log, "no lamps in the inputs: %zu placed along %zu street%s of the map (inferred, not surveyed)",
                 count, streets, many);
    else if (count)
        noc_warn(im->log,
                 "%zu lamps placed along %zu lit street%s of the map that ha%s none of %s own there (inferred, not "
                 "surveyed)",
                 count, streets, many, streets == 1 ? "s" : "ve", streets == 1 ? "its" : "their");
}

/* Lamps, of the inputs or by a rule. */
static noc_status light_city(importer *im, const extent *e) {
    noc_scene *scene = im->scene;
    city_lamp_tally tally = { 0 };
    city_lamp_params params = { .height = im->params->lamp_height,
                                .lumens = im->params->lamp_lumens,
                                .kelvin = im->params->lamp_kelvin,
                                .has_floor = true,
                                .floor = city_floor(scene),
                                .tally = &tally,
                                .profiles = im->profiles,
                                .dress = luminaires_dress_inferred,
                                .told = im->params->each_lamp ? each_lamp_light : NULL,
                                .dresser = im };
    city_body body;
    if (scene->no_memory) /* for the ground, and said so: the body's scene would say it again */
        return NOC_ERR_MEMORY;
    noc_status status = im->params->lamp_body ? body_load(im, im->params->lamp_body, &body) : NOC_OK;
    if (status)
        return status;
    params.body = im->params->lamp_body ? &body : NULL;
    lamp_fate fate;
    status = stand_lamps(im, e, &params, &fate);
    if (im->cancelled)
        return NOC_ERR_CANCELLED;
    if (scene->no_memory)
        return NOC_ERR_MEMORY; /* said by the scene; what it means for the lamps is not */
    status = status ? status : refuse_useless(im, e, &fate);
    if (status)
        return status;
    if (fate.mapped)
        warn_of_left_out(im, e, &fate);
    warn_of_distance(im, &fate);
    warn_of_roofs(im, &tally);
    tell_along_roads(im, &fate);
    return shines(scene) ? NOC_OK : infer(im, e, &params, &fate);
}

/* What the roads of maps tell of lamps, before the ground is laid that those need. */
static noc_status ask_roads(importer *im) {
    bool wanted =
        im->params->infer_lamps == NOC_SWITCH_ON || (im->params->infer_lamps == NOC_SWITCH_AUTO && !shines(im->scene));
    if (!im->roads.len)
        return NOC_OK;
    city_roads *roads = city_roads_create(im->roads.data, im->roads.len);
    if (!roads)
        return noc_no_memory(im->log, "import");
    if (!im->has_roads) /* surfaces are nearer to the truth */
        road_lamps_face(im, roads);
    noc_status status = NOC_OK;
    if (wanted)
        status = road_lamps_add(im, roads);
    if (luminaires_ask_roads(im) || im->params->each_lamp)
        im->roads_by_place = roads;
    else
        city_roads_destroy(roads);
    return status;
}

/* A file of which nothing is drawn because its coordinates are too coarse for what they outline. */
static void warn_of_collapsed(const importer *im) {
    for (size_t i = 0; i < im->input_count; i++) {
        const input *in = &im->inputs[i];
        for (size_t k = 0; k < geo_issues_count(in->issues) && !in->file.triangles; k++) {
            const char *reason, *examples;
            bool repaired;
            size_t count;
            if (geo_issues_get(in->issues, k, &reason, &repaired, &count, &examples) &&
                !strcmp(reason, "collapsed ring"))
                noc_warn(im->log,
                         "%s: nothing of it is drawn: %zu of its surfaces collapse to a line or a point. Are its "
                         "coordinates rounded? In degrees, five digits behind the point are 1 m",
                         in->path, count);
        }
    }
}

static noc_status finish_lamps(importer *im) {
    noc_scene *scene = im->scene;
    noc_status stood = units_check_terrain(im); /* before surfaces are laid on it */
    stood = stood ? stood : heights_of_surfaces(im);
    stood = stood ? stood : footprints_stand(im);
    if (stood)
        return stood;
    extent e = city_extent(scene);
    if (!e.any && !im->lamps.len && !scene->lights.len)
        noc_warn(im->log, "the inputs hold nothing that can be seen: no surfaces and no lamps");
    if (!go_on(im, 0))
        return NOC_ERR_CANCELLED;
    warn_if_coarse(im);
    warn_of_collapsed(im);
    noc_status status = e.any ? NOC_OK : strays_drop(im); /* where there is a city they are asked of it */
    if (!status)
        status = repeat_lamps(im);
    if (!status)
        status = warn_of_doubles(im);
    if (!status)
        status = ask_roads(im);
    if (!status)
        status = needs_ground(im, &e) ? lay_ground(im, &e) : heights_check(im, NULL);
    if (!status && scene->no_memory) /* for the ground, and said so */
        status = NOC_ERR_MEMORY;
    if (!status)
        status = road_lamps_raise(im);
    if (!status)
        status = roads_pave(im); /* lamps stand on them */
    if (!status && scene->no_memory)
        status = NOC_ERR_MEMORY;
    if (!status)
        status = roads_name(im);
    if (status)
        return status;
    status = light_city(im, &e);
    city_profiles_tell(im->profiles, im->report->profiles, sizeof(im->report->profiles));
    return status;
}

noc_status finish_city(importer *im) {
    noc_status status = finish_lamps(im);
    status = status ? status : windows_add(im); /* behind lamps, so that those are placed where nothing else shines */
    return status ? status : traffic_add(im);
}
