/* Lamps: where one stands, which light its tags mean, and its emission from lumens and colour temperature.
 *
 * Emission. A disc facing down radiates like a Lambertian surface on one side: flux = pi L A = pi^2 r^2 L. A sphere
 * radiates L from every point: flux = pi L 4 pi r^2 = 4 pi^2 r^2 L. The radius is a choice of ours; the flux is the
 * lamp's. With a profile the emission is the flux itself. */
#include "city/lamp.h"

#include <math.h>

#define OFF_GROUND 3.0 /* m between a lamp's elevation and the ground that are told of */
#define FARTHEST 9e6   /* m; a scene ends at 1e7 */

/* What a source means where its lumens and its colour are not tagged.
 *
 * lumens_per_watt: of the luminaire. For discharge and thermal lamps, the middle of the lamp's range in the IES
 * Lighting Handbook (10th ed., ch. 7: high pressure sodium 70..140, low pressure sodium 100..180, metal halide 65..115,
 * mercury 35..60, fluorescent 50..100, incandescent and halogen 10..20 lm/W) times 0.75, the usual light output ratio
 * of a street luminaire. LEDs are rated as luminaires: 110 lm/W is typical of those installed in the 2010s and 2020s.
 * Gas mantles give 1 to 2 lumens a watt of gas. kelvin: correlated colour temperatures of the same handbook. Sodium is
 * no black body; a Planckian of 2050 K has nearly its chromaticity at high pressure; at low pressure it is the line at
 * 589 nm, whose xy (0.5693, 0.4300) lies outside Rec.709 and whose negative blue is cut. */
static const struct {
    double lumens_per_watt, kelvin, lumens; /* 0: the parameter's */
    float rgb[3];                           /* of one line, whatever the temperature; 0: by temperature */
} sources[] = {
    [GEO_SOURCE_UNKNOWN] = { 80, 0, 0, { 0 } },        [GEO_SOURCE_LED] = { 110, 0, 0, { 0 } },
    [GEO_SOURCE_SODIUM] = { 78, 2050, 0, { 0 } },      [GEO_SOURCE_LOW_SODIUM] = { 105, 0, 0, { 2.73f, .588f, 0 } },
    [GEO_SOURCE_MERCURY] = { 36, 4100, 0, { 0 } },     [GEO_SOURCE_METAL_HALIDE] = { 68, 4000, 0, { 0 } },
    [GEO_SOURCE_FLUORESCENT] = { 56, 4000, 0, { 0 } }, [GEO_SOURCE_INCANDESCENT] = { 11, 2700, 0, { 0 } },
    [GEO_SOURCE_GAS] = { 1.5, 2700, 600, { 0 } }, /* a lantern of four mantles, not a 5000 lm luminaire */
};

/* ---- what the tags mean ---- */

static double known(double tagged, double otherwise) { return isfinite(tagged) && tagged > 0 ? tagged : otherwise; }

/* A colour made of luminance 1; false if it is none. */
static bool unit_luminance(const float colour[3], float rgb[3]) {
    double luminance = 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
    if (!(colour[0] >= 0 && colour[1] >= 0 && colour[2] >= 0 && luminance > 0 && isfinite(luminance)))
        return false;
    for (int i = 0; i < 3; i++)
        rgb[i] = (float)(colour[i] / luminance);
    return true;
}

/* False if neither the lamp nor its source nor the file of its profile tells one. */
static bool told_colour(const geo_lamp *lamp, float rgb[3]) {
    if (unit_luminance(lamp->rgb, rgb) || unit_luminance(sources[lamp->source].rgb, rgb))
        return true;
    double kelvin = known(lamp->kelvin, sources[lamp->source].kelvin);
    kelvin = known(kelvin, lamp->fitting ? known(lamp->fitting->file_kelvin, 0) : 0);
    if (kelvin > 0)
        noc_kelvin_rgb(kelvin, rgb);
    return kelvin > 0;
}

/* lm/W of the lamp's watts that a rule says, else the file of its profile where the lamp has no source; 0: neither. */
static double ruled_efficacy(const geo_lamp *lamp, double file_lumens) {
    const geo_fitting *f = lamp->fitting;
    double of_file = f && lamp->source == GEO_SOURCE_UNKNOWN ? file_lumens / known(f->file_watts, NAN) : NAN;
    return known(f ? f->efficacy : NAN, known(of_file, 0));
}

/* The same, else of its source. */
static double told_efficacy(const geo_lamp *lamp, double file_lumens) {
    return known(ruled_efficacy(lamp, file_lumens), sources[lamp->source].lumens_per_watt);
}

/* lm of the file of its profile, where that may count. */
static double lumens_of_file(const geo_lamp *lamp) {
    noc_lamp_flux flux = lamp->fitting ? lamp->fitting->flux : NOC_FLUX_ANY;
    return lamp->fitting && flux != NOC_FLUX_LAMP ? known(lamp->fitting->file_lumens, 0) : 0;
}

/* Returns true if its flux follows from its watts by an efficacy that nothing tells. */
static bool assumes_efficacy(const geo_lamp *lamp) {
    double file = lumens_of_file(lamp);
    bool by_file = lamp->fitting && lamp->fitting->flux == NOC_FLUX_FILE && file > 0;
    return lamp->source == GEO_SOURCE_UNKNOWN && known(lamp->watts, 0) > 0 && !(known(lamp->lumens, 0) > 0) &&
           !by_file && !(ruled_efficacy(lamp, file) > 0);
}

/* Of one head; 0 if neither the lamp nor its source nor the file of its profile tells it. */
static double told_lumens(const geo_lamp *lamp) {
    double file = lumens_of_file(lamp);
    if (lamp->fitting && lamp->fitting->flux == NOC_FLUX_FILE && file > 0)
        return file;
    double watts = known(lamp->watts, 0) * told_efficacy(lamp, file);
    return known(lamp->lumens, watts > 0 ? watts : known(file, sources[lamp->source].lumens));
}

bool city_lamp_assumes(const geo_lamp *lamp, noc_lamp_default what) {
    float rgb[3];
    switch (what) {
    case NOC_LAMP_HEIGHT: return !lamp->body_heads && !(known(lamp->height, 0) > 0);
    case NOC_LAMP_FLUX: return !(told_lumens(lamp) > 0);
    case NOC_LAMP_COLOUR: return !told_colour(lamp, rgb);
    case NOC_LAMP_EFFICACY: return assumes_efficacy(lamp);
    case NOC_LAMP_DIRECTION:
    case NOC_LAMP_DEFAULT_COUNT: break;
    }
    return false;
}

#define FLOOD_TILT 50.0 /* degrees */

/* Lambertian radiance of a flux of 1 lm; of a point, which shines alike to all sides, its intensity. */
static double of_a_lumen(const lamp_fitting *f) {
    double r2 = f->radius * f->radius;
    switch (f->light) {
    case NOC_LIGHT_POINT: return 1 / (4 * M_PI);
    case NOC_LIGHT_SPHERE: return 1 / (M_PI * M_PI * r2 * 4);
    default: return 1 / (M_PI * M_PI * r2);
    }
}

/* What shines, and whether by a profile. */
static void choose_light(lamp_fitting *f, const city_lamp_params *params) {
    static const noc_light_kind kinds[NOC_LAMP_SHAPE_COUNT] = {
        [NOC_LAMP_POINT] = NOC_LIGHT_POINT, [NOC_LAMP_SPHERE] = NOC_LIGHT_SPHERE, [NOC_LAMP_DISC] = NOC_LIGHT_DISC
    };
    f->light = f->ruled.shape ? kinds[f->ruled.shape] : f->kind == FITTING_SPHERE ? NOC_LIGHT_SPHERE : NOC_LIGHT_DISC;
    f->radius = known(f->ruled.radius, f->radius);
    f->tilt = (isfinite(f->ruled.tilt) ? f->ruled.tilt : f->kind == FITTING_FLOOD ? FLOOD_TILT : 0) * M_PI / 180;
    f->profiled = params->profiles && f->ruled.profile != GEO_NO_PROFILE;
}

/* Of one head of a lamp that tells none. What shines upward or is hung up may be low, and as bright as any. */
static double assumed_lumens(const geo_lamp *lamp, const city_lamp_params *params) {
    bool bollard = known(lamp->height, 0) > 0 && lamp->height < CITY_BOLLARD_HEIGHT && lamp->type != GEO_LAMP_FLOOD &&
                   lamp->mount != GEO_MOUNT_SUSPENDED && !lamp->body_heads;
    return bollard ? fmin(params->lumens, CITY_BOLLARD_LUMENS) : params->lumens;
}

static lamp_fitting choose_fitting(const geo_lamp *lamp, const city_lamp_params *params) {
    lamp_fitting f = { .height = known(lamp->height, params->height),
                       .ruled = lamp->fitting ? *lamp->fitting : geo_no_fitting() };
    f.heads = NOC_CLAMP(lamp->count, 1, GEO_MAX_HEADS);
    f.lumens = known(told_lumens(lamp), assumed_lumens(lamp, params));
    f.watts = known(lamp->watts, known(f.ruled.file_watts, NAN));
    if (lamp->type == GEO_LAMP_FLOOD)
        f.kind = FITTING_FLOOD;
    else if (lamp->type == GEO_LAMP_LANTERN || (f.height < 3.5 && lamp->mount != GEO_MOUNT_SUSPENDED))
        f.kind = FITTING_SPHERE; /* low lamps are lanterns and bollards: an arm would be in the way */
    else
        f.kind = FITTING_DISC;
    /* bollards and ground lights have small heads */
    f.radius = f.kind == FITTING_SPHERE ? NOC_CLAMP(.06 * f.height, .05, .18) : .15;
    if (lamp->body_heads) { /* all heads' flux, from as many as the body shows */
        f.kind = lamp->head_globe ? FITTING_SPHERE : FITTING_DISC;
        f.radius = lamp->head_radius;
        double share = lamp->count > 0 ? (double)f.heads / lamp->body_heads : 1;
        f.lumens *= share;
        f.watts *= share;
    }
    choose_light(&f, params);
    double luminance = f.lumens * (f.profiled ? 1 : of_a_lumen(&f));
    float rgb[3];
    if (!told_colour(lamp, rgb))
        noc_kelvin_rgb(params->kelvin, rgb);
    for (int i = 0; i < 3; i++)
        f.emission[i] = (float)(luminance * rgb[i]);
    return f;
}

/* ---- where it stands ---- */

/* Which way a lamp faces that says nothing and has nothing near: any, but always the same for the same place. */
static void arbitrary_facing(const double p[3], double facing[2]) {
    uint32_t h = (uint32_t)(int64_t)floor(p[0] * 4) * 0x9e3779b1u ^ (uint32_t)(int64_t)floor(p[1] * 4) * 0x85ebca77u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    double a = 2 * M_PI * (h >> 8) / 16777216.0;
    facing[0] = sin(a);
    facing[1] = cos(a);
}

double city_floor(const noc_scene *scene) {
    double floor = INFINITY;
    for (size_t t = 0; t < scene->triangle_material.len; t++) {
        noc_class cls = scene->materials.data[scene->triangle_material.data[t]].cls;
        for (int i = 0; i < 3 && cls != NOC_CLASS_LAMP && cls != NOC_CLASS_CLOSURE; i++)
            floor = NOC_MIN(floor, scene->positions.data[3 * (size_t)scene->indices.data[3 * t + (size_t)i] + 2]);
    }
    return isfinite(floor) ? floor : 0;
}

#define DECK_OFF 3.0    /* m between a lamp's elevation and the deck that it stands on, as on bridges of maps */
#define DECK_RAISED 1.0 /* m between a deck and the ground that make a difference */
#define DECK_STEP 1.5   /* m aside, where a deck goes on */
#define DECK_LEVEL 0.5

/* Returns true if the top of the bridge at foot is a deck: it continues at that height in two directions at a right
 * angle. Beams and cables do not. */
static bool is_deck(const noc_scene *scene, const double foot[2], double top) {
    bool on[2] = { false };
    for (int k = 0; k < 2; k++)
        for (int side = -1; side < 2; side += 2) {
            double at[2] = { foot[0], foot[1] }, z;
            at[k] += side * DECK_STEP;
            on[k] = on[k] ||
                    (noc_scene_highest(scene, 1u << NOC_CLASS_BRIDGE, at[0], at[1], &z) && fabs(z - top) <= DECK_LEVEL);
        }
    return on[0] && on[1];
}

/* On a bridge of a model, a raised one where the lamp tells no elevation: counted. */
static bool on_bridge(const noc_scene *scene, const geo_lamp *lamp, const double foot[2], double *deck,
                      geo_issues *issues) {
    double low, z = lamp->xyz[2];
    if (lamp->off_deck || !noc_scene_highest(scene, 1u << NOC_CLASS_BRIDGE, foot[0], foot[1], deck))
        return false;
    if (isfinite(z) && fabs(*deck - z) < 1)
        return true;
    bool ground = site_ground(scene, foot[0], foot[1], &low),
         stands = lamp->mount != GEO_MOUNT_WALL && lamp->mount != GEO_MOUNT_SUSPENDED && !lamp->body_heads;
    if (!ground || !stands || *deck <= low + DECK_RAISED ||
        (isfinite(z) && (fabs(*deck - z) > DECK_OFF || fabs(*deck - z) > fabs(low - z))))
        return false;
    bool is = is_deck(scene, foot, *deck);
    geo_issue(issues, GEO_GUESSED,
              is ? "lamp on a bridge of a model: put on its deck"
                 : "lamp under a part of a bridge of a model: left on the ground",
              lamp->id);
    return is;
}

/* Height of the foot. */
static void stand(const noc_scene *scene, const geo_lamp *lamp, const city_lamp_params *params, double foot[3],
                  geo_issues *issues) {
    double deck = lamp->xyz[2];
    if (lamp->on_deck ||
        on_bridge(scene, lamp, foot, &deck, issues)) { /* which is no ground where it is not given as a road */
        foot[2] = deck;
        return;
    }
    if (site_ground(scene, foot[0], foot[1], &foot[2])) {
        if (fabs(foot[2] - lamp->xyz[2]) > OFF_GROUND)
            geo_issue(issues, GEO_GUESSED, "lamp whose elevation is more than 3 m off the ground: stood on the ground",
                      lamp->id);
        return;
    }
    foot[2] = lamp->xyz[2];
    if (isfinite(foot[2]))
        return;
    /* a scene without classes: whatever is there, but the lamps that stand already */
    if (noc_scene_highest(scene, ~(1u << NOC_CLASS_LAMP), foot[0], foot[1], &foot[2])) {
        double other;
        if (params->tally && noc_scene_highest(scene, 1u << NOC_CLASS_OTHER, foot[0], foot[1], &other) &&
            other == foot[2]) {
            params->tally->classless++;
            params->tally->raised += site_raised(scene, foot[0], foot[1], foot[2]);
        }
        return;
    }
    if (site_ground_far(scene, foot[0], foot[1], &foot[2])) {
        geo_issue(issues, GEO_GUESSED, "lamp outside of the ground: put at the height of the nearest", lamp->id);
        return;
    }
    foot[2] = params->has_floor ? params->floor : city_floor(scene);
    geo_issue(issues, GEO_GUESSED, "lamp outside of the ground: put at the lowest height of the scene", lamp->id);
}

/* As site_facing, which is not called again for the next lamp at the same place. */
static bool face(const noc_scene *scene, city_lamp_tally *tally, lamp_placing *p) {
    bool known = tally && tally->searched && memcmp(tally->foot, p->foot, sizeof(p->foot)) == 0;
    bool faces = known ? tally->faces : site_facing(scene, p->foot[0], p->foot[1], p->foot[2], p->facing);
    if (known)
        memcpy(p->facing, tally->facing, sizeof(p->facing));
    if (!tally)
        return faces;
    tally->searched = true;
    tally->faces = faces;
    memcpy(tally->foot, p->foot, sizeof(p->foot));
    memcpy(tally->facing, p->facing, sizeof(p->facing));
    return faces;
}

/* False if the lamp cannot be placed: counted. */
static bool place(const noc_scene *scene, const geo_lamp *lamp, const city_lamp_params *params, lamp_placing *p,
                  geo_issues *issues) {
    memcpy(p->foot, lamp->xyz, sizeof(p->foot));
    stand(scene, lamp, params, p->foot, issues);
    bool faces = isfinite(lamp->direction);
    if (faces) {
        p->facing[0] = sin(lamp->direction * M_PI / 180);
        p->facing[1] = cos(lamp->direction * M_PI / 180);
    }
    double head = p->foot[2] + (isfinite(lamp->height) ? lamp->height : params->height);
    if (site_covered(scene, p->foot[0], p->foot[1], p->foot[2]) &&
        !site_under(scene, p->foot[0], p->foot[1], p->foot[2], head)) {
        double away[2], was[2] = { p->foot[0], p->foot[1] }, z;
        if (!site_free_spot(scene, &p->foot[0], &p->foot[1], p->foot[2], 3, away)) {
            geo_issue(issues, GEO_SKIPPED, "lamp inside a building, further than 3 m from its outside", lamp->id);
            return false;
        }
        geo_issue(issues, GEO_GUESSED, "lamp inside a building: moved out of it", lamp->id);
        if (site_ground(scene, p->foot[0], p->foot[1], &z))
            p->foot[2] = z;
        p->on_wall = lamp->mount == GEO_MOUNT_WALL;
        memcpy(p->wall, was, sizeof(was));
        if (!faces || p->on_wall)
            memcpy(p->facing, away, sizeof(away));
        faces = true;
    }
    if (site_taken(scene, p->foot[0], p->foot[1], p->foot[2])) {
        double side[2];
        arbitrary_facing(p->foot, side);
        for (double r = .7; r < 3 && site_taken(scene, p->foot[0], p->foot[1], p->foot[2]); r += .7)
            for (int k = 0; k < 2; k++)
                p->foot[k] += .7 * side[k];
        p->crowded = site_taken(scene, p->foot[0], p->foot[1], p->foot[2]);
        if (p->crowded)
            geo_issue(issues, GEO_GUESSED,
                      "lamp where others leave no room: its light in the same place as theirs, without a pole",
                      lamp->id);
        else
            geo_issue(issues, GEO_REPAIRED, "two lamps at one place: moved apart", lamp->id);
    }
    if (params->tally)
        params->tally->moved += p->foot[0] != lamp->xyz[0] || p->foot[1] != lamp->xyz[1];
    p->by_chance = !faces && !face(scene, params->tally, p);
    if (p->by_chance)
        arbitrary_facing(p->foot, p->facing);
    if (lamp->mount == GEO_MOUNT_WALL && !p->on_wall) { /* beside its wall: the bracket reaches back to it */
        p->on_wall = true;
        for (int k = 0; k < 2; k++)
            p->wall[k] = p->foot[k] - .6 * p->facing[k];
    }
    return true;
}

/* The street of a lamp whose body is modelled: where its first head hangs, else as of a lamp without one. */
static void face_body(const noc_scene *scene, const geo_lamp *lamp, lamp_placing *p) {
    double *facing = p->facing;
    double dx = lamp->head[0][0] - lamp->xyz[0], dy = lamp->head[0][1] - lamp->xyz[1], off = hypot(dx, dy), z;
    if (off > .2) {
        facing[0] = dx / off;
        facing[1] = dy / off;
    } else if (isfinite(lamp->direction)) {
        facing[0] = sin(lamp->direction * M_PI / 180);
        facing[1] = cos(lamp->direction * M_PI / 180);
    } else if (!site_ground(scene, lamp->xyz[0], lamp->xyz[1], &z) ||
               !site_facing(scene, lamp->xyz[0], lamp->xyz[1], z, facing)) {
        p->by_chance = true;
        arbitrary_facing(lamp->xyz, facing);
    }
}

int city_add_lamp(noc_scene *scene, const geo_lamp *lamp, const city_lamp_params *params, bool inferred,
                  geo_issues *issues) {
    if (!isfinite(lamp->xyz[0]) || !isfinite(lamp->xyz[1])) {
        geo_issue(issues, GEO_SKIPPED, "lamp without a place", lamp->id);
        return 0;
    }
    if (fabs(lamp->xyz[0]) > FARTHEST || fabs(lamp->xyz[1]) > FARTHEST) {
        geo_issue(issues, GEO_SKIPPED, "lamp more than 9000 km from the scene's origin", lamp->id);
        return 0;
    }
    lamp_placing p = { 0 };
    if (!lamp->body_heads && !place(scene, lamp, params, &p, issues))
        return 0;
    if (lamp->body_heads && (params->profiles || lamp->fitting))
        face_body(scene, lamp, &p);
    lamp_fitting f = choose_fitting(lamp, params);
    for (int k = 0; k < 3; k++)
        f.emission[k] *= (float)scene->maintenance;
    return lamp_make(
        &(lamp_making){
            .scene = scene, .lamp = lamp, .fitting = &f, .placing = &p, .params = params, .inferred = inferred },
        issues);
}
