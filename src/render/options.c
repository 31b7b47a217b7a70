/* The tables behind the command line, its help, its errors and docs/options.md. Each row names a field of a params
 * struct; what a row does not say (the default) is in that struct's default macro, so it cannot be stated twice. */
#include "base/base.h"

#include <math.h>
#include <nocturne/option.h>
#include <stdio.h>

#define BOOL(st, f, n, g, ...)                                                                                         \
    { n, g, NOC_OPTION_BOOL, offsetof(st, f), 0, 1, NULL, "", __VA_ARGS__ }
#define SWITCH(st, f, n, g, h)                                                                                         \
    { n, g, NOC_OPTION_SWITCH, offsetof(st, f), 0, 2, NULL, "", h }
#define INT(st, f, n, g, lo, hi, u, ...)                                                                               \
    { n, g, NOC_OPTION_INT, offsetof(st, f), lo, hi, NULL, u, __VA_ARGS__ }
#define UINT(st, f, n, g, ...)                                                                                         \
    { n, g, NOC_OPTION_UINT, offsetof(st, f), 0, UINT32_MAX, NULL, "", __VA_ARGS__ }
#define REAL(st, f, n, g, lo, hi, u, ...)                                                                              \
    { n, g, NOC_OPTION_REAL, offsetof(st, f), lo, hi, NULL, u, __VA_ARGS__ }
#define CHOICE(st, f, n, g, c, ...)                                                                                    \
    { n, g, NOC_OPTION_CHOICE, offsetof(st, f), 0, 0, c, "", __VA_ARGS__ }
#define TEXT(st, f, n, g, u, h)                                                                                        \
    { n, g, NOC_OPTION_TEXT, offsetof(st, f), 0, 0, NULL, u, h }
#define TEXTS(st, f, n, g, u, h)                                                                                       \
    { n, g, NOC_OPTION_TEXTS, offsetof(st, f), 0, 0, NULL, u, h }
#define END                                                                                                            \
    { NULL, NULL, NOC_OPTION_BOOL, 0, 0, 0, NULL, NULL, NULL }

/* Ends of rows: what the option needs (noc_option.needs). tests/render/test_needs.c holds them to pictures. */
#define CANDIDATES "method=ris|restir"
#define DRAWN CANDIDATES ",candidates=uniform|power|influence|light-bvh"
#define LISTS CANDIDATES ",candidates=lists"
#define INFLUENCE CANDIDATES ",candidates=influence"
#define RESTIR "method=restir"
#define LIT "method=reference|is|ris|restir"
#define SPATIAL RESTIR ",spatial=true"

/* What a change of it makes a view forget (noc_option.resets); tests/render/test_resets.c holds rows to pictures. */
#define MEAN .resets = NOC_RESETS_MEAN
#define SAMPLES .resets = NOC_RESETS_MEAN | NOC_RESETS_RESERVOIRS
#define ALL .resets = NOC_RESETS_ALL

#define P noc_render_params
/* clang-format off */
static const noc_option render_options[] = {
    INT(P, width, "width", "Picture", 1, NOC_IMAGE_MAX_SIDE, "px", "width of the picture", SAMPLES),
    INT(P, height, "height", "Picture", 1, NOC_IMAGE_MAX_SIDE, "px", "height of the picture", SAMPLES),
    UINT(P, seed, "seed", "Picture", "start of the random numbers; equal seeds give equal pictures", ALL),
    BOOL(P, jitter, "jitter", "Picture", "move sub-pixel positions from frame to frame (antialiasing)", MEAN),
    BOOL(P, accumulate, "accumulate", "Picture", "mean of all frames; off: the last frame alone", MEAN),
    REAL(P, sky, "sky", "Picture", 0, 1e6, "cd/m2",
         "zenith: luminance, sqm:18.8 (mag/arcsec2) or bortle:5 (1 to 9); 0 = off", .read = noc_sky_read, MEAN),
    BOOL(P, emitters, "emitters", "Picture", "show light sources that are seen directly", MEAN),
    BOOL(P, gloss, "gloss", "Picture", "surfaces mirror, too; off, as with --show illuminance: diffusely alone",
         SAMPLES),
    REAL(P, environment_scale, "environment-scale", "Picture", 0, 1e9, "cd/m2",
         "luminance that 1 in the map stands for", MEAN),
    REAL(P, environment_lux, "environment-lux", "Picture", 0, 1e6, "lx",
         "light of the map on open ground, then times the scale; 0 = as in its file", MEAN),
    REAL(P, environment_rotation, "environment-rotation", "Picture", -360, 360, "degrees",
         "bearing of the map's middle, clockwise from north", MEAN),
    BOOL(P, environment_light, "environment-light", "Picture", "the map lights the city, in place of the sky", MEAN),

    CHOICE(P, method, "method", "Estimator", "reference|is|ris|restir|headlight",
           "how direct light is estimated", SAMPLES),
    CHOICE(P, candidates, "candidates", "Estimator", "uniform|lists|power|influence|light-bvh",
         "ris, restir: where light candidates come from", CANDIDATES, .aliases = "bvh=influence|tree=light-bvh", MEAN),
    INT(P, draws, "draws", "Estimator", 1, 1024, "", "light candidates a pixel and frame (M)", DRAWN, MEAN),
    INT(P, list, "list", "Estimator", 0, 128, "",
        "lists: strongest lights of a tile, for all its pixels", LISTS, MEAN),
    INT(P, tail, "tail", "Estimator", 1, 128, "", "lists: draws a tile from all other lights", LISTS, MEAN),
    INT(P, shadow_rays, "shadow-rays", "Estimator", 1, 8, "",
        "lists: shadow rays a pixel, a target: 1 to twice as many are sent", LISTS),
    BOOL(P, learn, "learn", "Estimator",
         "lists: earlier frames' rays say where to send new ones", LISTS ",final-ray=true", MEAN),
    REAL(P, influence, "influence", "Estimator", 0, 1e6, "m",
         "influence: reach of a light of 1 cd; 0 = found for the scene", INFLUENCE, MEAN),
    CHOICE(P, influence_boxes, "influence-boxes", "Estimator", "sphere|visible",
         "influence: lights reach as far as they shine, or see", INFLUENCE, MEAN),
    INT(P, influence_cluster, "influence-cluster", "Estimator", 1, 64, "",
         "influence: so many near lights share a volume", INFLUENCE, MEAN),
    INT(P, uniform_every, "uniform-every", "Estimator", 1, 1024, "",
         "influence: of so many draws one is from all lights", INFLUENCE, MEAN),
    INT(P, rays, "rays", "Estimator", 1, 1024, "", "reference: shadow rays a pixel and frame", "method=reference"),
    BOOL(P, final_ray, "final-ray", "Estimator", "shadow ray to the chosen light; off: light passes through walls",
         LIT, SAMPLES),
    CHOICE(P, isa, "isa", "Estimator", "auto|scalar|baseline|avx2|avx512",
         "instruction set; auto: NOCTURNE_ISA's, else the widest; the picture is the same"),

    BOOL(P, temporal, "temporal", "Reuse (restir)",
         "reuse samples of the previous frame (a still is cleaner without)", RESTIR, MEAN),
    BOOL(P, spatial, "spatial", "Reuse (restir)", "reuse samples of neighbouring pixels", RESTIR, MEAN),
    INT(P, neighbours, "neighbours", "Reuse (restir)", 0, 20, "", "neighbours a pixel and pass (k)", SPATIAL, MEAN),
    REAL(P, radius, "radius", "Reuse (restir)", 1, 64, "px", "radius that neighbours are drawn from", SPATIAL, MEAN),
    INT(P, passes, "passes", "Reuse (restir)", 1, 4, "", "spatial passes", SPATIAL, MEAN),
    REAL(P, history, "history", "Reuse (restir)", 0, 1000, "",
         "cap of the history, in frames' worth of candidates", RESTIR ",temporal=true", MEAN),
    CHOICE(P, bias, "bias", "Reuse (restir)", "biased|mis|pairwise|counted", "weights of the combination", RESTIR,
           SAMPLES),
    BOOL(P, bias_rays, "bias-rays", "Reuse (restir)",
         "visibility in those weights: no bias, more rays",
         RESTIR ",bias=mis|pairwise|counted,visibility-reuse=true,final-ray=true", SAMPLES),
    BOOL(P, visibility_reuse, "visibility-reuse", "Reuse (restir)",
         "one shadow ray after the candidates", RESTIR ",final-ray=true", SAMPLES),
    REAL(P, reject_depth, "reject-depth", "Reuse (restir)", 0, 10, "",
         "distance to a neighbour's plane that rejects it, share of depth", RESTIR, MEAN),
    REAL(P, reject_normal, "reject-normal", "Reuse (restir)", -1, 1, "",
         "cosine between normals under which one is rejected", RESTIR, MEAN),
    END,
};
/* clang-format on */
#undef P

#define P noc_display_params
/* clang-format off */
static const noc_option display_options[] = {
    BOOL(P, auto_exposure, "auto-exposure", "Display", "measure the picture; off: ev100 decides"),
    REAL(P, ev100, "ev100", "Display", -30, 30, "EV", "exposure when auto-exposure is off, or f/2.8,1/30,iso1600",
         .read = noc_exposure_read),
    REAL(P, compensation, "compensation", "Display", -20, 20, "stops",
         "added to the automatic exposure; more is brighter", "auto-exposure=true"),
    CHOICE(P, tonemap, "tonemap", "Display", "filmic|reinhard|linear", "curve from luminance to the screen"),
    REAL(P, white_kelvin, "white-balance", "Display", 2500, 15000, "K",
         "colour temperature that is shown as white, as a camera is set; not for EXR"),
    END,
};
/* clang-format on */
#undef P

#define P noc_import_params
/* clang-format off */
static const noc_option import_options[] = {
    TEXT(P, crs, "crs", "City", "CRS", "CRS of cities and of inputs that name none (EPSG:n, WKT)"),
    TEXTS(P, file_crs, "file-crs", "City", "FILE=CRS", "in place of the CRS an input names; repeatable"),
    TEXTS(P, height_unit, "height-unit", "City", "UNIT", "of heights: m, ft, us-ft, ..., FILE=UNIT"),
    TEXT(P, scene_crs, "scene-crs", "City", "CRS", "CRS of the scene; else the first input's, or UTM"),
    TEXT(P, bbox, "bbox", "City", "X0,Y0,X1,Y1[,CRS]", "part of city models and lamps that is taken"),
    INT(P, lod, "lod", "City", 0, 4, "",
        "highest level of detail to take, building by building"),
    REAL(P, terrain_error, "terrain-error", "City", 0, 1000, "m", "what triangles of a GeoTIFF may be off its heights"),
    INT(P, terrain_triangles, "terrain-triangles", "City", 100, 20000000, "", "that a GeoTIFF may become"),
    BOOL(P, footprints, "footprints", "City", "outlines of buildings in maps become blocks where no model has one"),
    SWITCH(P, map_surfaces, "map-surfaces", "City",
           "surfaces of roads and areas of maps; auto: with footprints, no roads of models"),
    REAL(P, building_height, "building-height", "City", 1, 500, "m", "height of such a block that tells none"),
    SWITCH(P, infer_lamps, "infer-lamps", "City",
           "place lamps by a rule on lit streets that have none; on: even if none is of use"),
    TEXT(P, environment, "environment", "City", "FILE",
         "equirectangular EXR or HDR picture around the city: its background, and light"),
    BOOL(P, textures, "textures", "City", "images and colours that city models give to surfaces"),
    REAL(P, texture_memory, "texture-memory", "City", 0.1, 8000, "MB", "for those images; larger ones are reduced",
         "textures=true"),
    BOOL(P, wet, "wet", "City", "after rain: roads, pavements and ground are dark and reflect"),
    BOOL(P, strict, "strict", "City", "what is left out of an input, guessed at or made up is an error"),
    TEXTS(P, lamps, "lamps", "City", "FILE", "a file whose points are lamps whatever it says; repeatable"),
    TEXTS(P, lamp_columns, "lamp-columns", "City", "MAP", "columns, tags: height=A,watts=B (height_ft=A); repeatable"),
    REAL(P, lamp_height, "lamp-height", "City", 0.5, 60, "m", "height of lamps that are not tagged"),
    REAL(P, lamp_lumens, "lamp-lumens", "City", 0, 1e7, "lm", "flux of lamps with neither flux nor wattage"),
    REAL(P, lamp_kelvin, "lamp-kelvin", "City", 1000, 25000, "K", "colour temperature of lamps that tell none"),
    REAL(P, maintenance, "maintenance", "City", 0.01, 1, "", "maintenance factor of lamps: share of their flux"),
    BOOL(P, profiles, "profiles", "City", "lamps shine as street lights do: light distributions by their kind"),
    TEXT(P, lamp_body, "lamp-body", "City", "FILE", "OBJ, PLY or glTF that lamps look like, a head or a whole one"),
    TEXT(P, lamp_profile, "lamp-profile", "City", "FILE", "IES or EULUMDAT file of all lamps, and of flux untold"),
    TEXTS(P, group_states, "group", "City", "NAME=STATE", "lights of a group: off, 0.3, 2200K, #ffb060; repeatable"),
    CHOICE(P, obj_up, "obj-up", "City", "y|z", "axis of OBJ files that points up"),
    SWITCH(P, windows, "windows", "Windows", "windows on the walls of cities, and those of builtin:city; auto: on"),
    REAL(P, window.lit_windows, "window-lit", "Windows", 0, 1, "",
         "share of windows lit at 21 h, of shops of builtin:city 3 times that"),
    REAL(P, window.hour, "hour", "Windows", 0, 24, "h",
         "time of day: scales that share, by the use"),
    REAL(P, window.width, "window-width", "Windows", 0.1, 50, "m", "width of a window, of flats"),
    REAL(P, window.height, "window-height", "Windows", 0.1, 50, "m", "height of a window"),
    REAL(P, window.cell, "window-cell", "Windows", 0.2, 100, "m", "width of the cell that a window stands in"),
    REAL(P, window.storey_height, "storey-height", "Windows", 1, 50, "m", "height of a storey, and of those cells"),
    REAL(P, window.margin, "window-margin", "Windows", 0, 10, "m", "wall that must be left around a window"),
    REAL(P, window.tilt, "window-tilt", "Windows", 0, 45, "degrees", "how far a wall with windows may lean"),
    REAL(P, window.min_area, "window-min-area", "Windows", 0, 1e6, "m2", "smaller walls get no windows"),
    REAL(P, window.kelvin, "window-kelvin", "Windows", 1000, 10000, "K", "middle colour temperature of flats"),
    REAL(P, window.spread, "window-spread", "Windows", 0, 1, "", "share that those spread over"),
    UINT(P, window.seed, "window-seed", "Windows", "another number, other windows lit"),
    SWITCH(P, traffic, "traffic", "Traffic", "cars: along tracks of inputs; on: also along the roads of maps"),
    TEXTS(P, tracks, "tracks", "Traffic", "FILE", "a file whose lines are tracks of cars; repeatable"),
    REAL(P, cars.spacing, "traffic-spacing", "Traffic", 5, 1e5, "m", "between cars in a lane of a main road"),
    REAL(P, cars.speed, "traffic-speed", "Traffic", 0, 300, "km/h", "where no limit or time is told; 0 = by class"),
    CHOICE(P, cars.side, "traffic-side", "Traffic", "right|left", "side of the road that is driven on"),
    REAL(P, cars.time, "traffic-time", "Traffic", -1e9, 1e9, "s", "where on their ways the cars are"),
    REAL(P, cars.headlamp, "traffic-headlamp", "Traffic", 0, 1e5, "lm", "flux of one headlamp"),
    REAL(P, cars.tail_lamp, "traffic-tail-lamp", "Traffic", 0, 1e4, "cd", "intensity of one tail lamp"),
    UINT(P, cars.seed, "traffic-seed", "Traffic", "another number, other cars"),
    TEXTS(P, cars.bodies, "car-body", "Traffic", "FILE", "OBJ, PLY or glTF that cars look like; repeatable"),
    REAL(P, cars.body_length, "car-length", "Traffic", 0, 30, "m", "that it is scaled to; 0 = as its file says"),
    BOOL(P, isolate, "isolate", "Reading", "OBJ and map files are read in a process of its own, which can be stopped"),
    REAL(P, reader_time, "reader-time", "Reading", 0.1, 1e6, "s", "time such a file may take"),
    REAL(P, max_memory, "max-memory", "Reading", 0, 1e6, "GB", "memory to read an input; 0 = 3/4 of all"),
    REAL(P, max_expansion, "max-expansion", "Reading", 0, 1e9, "", "times its size that an input may grow; 0 = any"),
    REAL(P, max_instances, "max-instances", "Reading", 0, 1e9, "", "points a byte that instances may place; 0 = any"),
    BOOL(P, allow_outside, "allow-outside", "Reading", "files that inputs name may lie anywhere"),
    END,
};
/* clang-format on */
#undef P

#define P noc_luminaire_rule
/* Of recipes alone. */
static const noc_option luminaire_options[] = {
    CHOICE(P, source, "source", "Luminaires",
           "unknown|LED|sodium|mercury|metal-halide|fluorescent|incandescent|gas|low-sodium", "what makes the light"),
    CHOICE(P, type, "type", "Luminaires", "any|street|lantern|flood", "the fitting"),
    CHOICE(P, mount, "mount", "Luminaires", "any|pole|wall|suspended", "what it hangs on"),
    REAL(P, watts, "watts", "Luminaires", 0.5, 5000, "W", "of a head"),
    /* two rows of one name: a word, or a number */
    CHOICE(P, flux, "lumens", "Luminaires", "any|file|lamp", "of a head: those of its profile's file, or its own"),
    REAL(P, lumens, "lumens", "Luminaires", 1, 500000, "lm", "of a head"),
    REAL(P, efficacy, "efficacy", "Luminaires", 0.1, 400, "lm/W", "of the luminaire, for its watts"),
    REAL(P, kelvin, "kelvin", "Luminaires", 1000, 25000, "K", "colour temperature"),
    TEXT(P, colour, "colour", "Luminaires", "#RRGGBB", "colour, sRGB"),
    REAL(P, height, "height", "Luminaires", 0.2, 60, "m", "of the light above the ground"),
    INT(P, heads, "heads", "Luminaires", 1, 24, "", "on a pole"),
    CHOICE(P, shape, "shape", "Luminaires", "fitting|point|sphere|disc", "what shines"),
    REAL(P, radius, "radius", "Luminaires", 0.005, 2, "m", "of a sphere or disc"),
    REAL(P, tilt, "tilt", "Luminaires", 0, 120, "degrees", "of its axis from straight down, to where it faces"),
    REAL(P, arm, "arm", "Luminaires", 0, 10, "m", "of heads, from the pole's axis"),
    REAL(P, turn, "turn", "Luminaires", -360, 360, "degrees",
         "of its profile, counter-clockwise, from facing the street"),
    TEXT(P, profile, "profile", "Luminaires", "PROFILE", "built-in one, IES or EULUMDAT file, or none"),
    END,
};
#undef P

#define P noc_group_rule
static const noc_option group_options[] = {
    BOOL(P, on, "on", "Groups", "whether its lights shine"),
    REAL(P, scale, "scale", "Groups", 0, 1e6, "", "of what its lights emit"),
    REAL(P, kelvin, "kelvin", "Groups", 1000, 25000, "K", "colour temperature of all its lights"),
    TEXT(P, colour, "colour", "Groups", "#RRGGBB", "colour of all its lights, sRGB"),
    END,
};
#undef P

#define P noc_city_params
static const noc_option city_options[] = {
    UINT(P, seed, "city-seed", "Built-in city", "another number, another city, with other windows lit"),
    REAL(P, size, "city-size", "Built-in city", 150, 5000, "m", "edge of the square it covers"),
    END,
};
#undef P

#define P noc_builtin_params
static const noc_option builtin_options[] = {
    UINT(P, seed, "scene-seed", "Built-in scenes", "cityscape, mess: another number, another scene"),
    INT(P, lights, "lights", "Built-in scenes", 1, 1000000, "", "mess: how many lights it has"),
    END,
};
#undef P

#define P noc_camera_params
static const noc_option camera_options[] = {
    CHOICE(P, viewpoint, "view", "Camera", "street|aerial|overview|own",
           "camera derived from the city; own: the scene's, else street"),
    TEXT(P, eye, "eye", "Camera", "X,Y,Z", "place of the camera, metres in the scene's local frame, z up"),
    TEXT(P, target, "target", "Camera", "X,Y,Z", "what it looks at"),
    TEXT(P, crs, "camera-crs", "Camera", "CRS",
         "eye and target are easting,northing,height in this CRS; \"scene\": the scene's"),
    TEXT(P, photo_points, "photo-points", "Camera", "FILE", "camera of a photograph, by its points (CSV)"),
    REAL(P, fov, "fov", "Camera", 1, 170, "degrees", "vertical field of view; else that of the view, with --eye 50"),
    END,
};
#undef P

#define P noc_device_params
static const noc_option device_options[] = {
    INT(P, threads, "threads", "Device", 0, 1024, "", "threads of the processor; 0 = one a core"),
    CHOICE(P, backend, "backend", "Device", "embree|vulkan|auto",
           "what renders: processor or GPU; auto: a GPU with ray tracing, if any", .aliases = "cpu=embree"),
    TEXT(P, device, "device", "Device", "GPU", "vulkan: part of a GPU's name, or its number (nocturne devices)"),
    END,
};
#undef P

const noc_option *noc_render_options(void) { return render_options; }
const noc_option *noc_display_options(void) { return display_options; }
const noc_option *noc_import_options(void) { return import_options; }
const noc_option *noc_luminaire_options(void) { return luminaire_options; }
const noc_option *noc_group_options(void) { return group_options; }
const noc_option *noc_city_options(void) { return city_options; }
const noc_option *noc_builtin_options(void) { return builtin_options; }
const noc_option *noc_camera_options(void) { return camera_options; }
const noc_option *noc_device_options(void) { return device_options; }

static bool has_input(const char *const *inputs, size_t count, const char *input) {
    for (size_t i = 0; i < count; i++)
        if (inputs[i] && !strcmp(inputs[i], input))
            return true;
    return false;
}

const char *noc_option_needs_input(const noc_option *option, const char *const *inputs, size_t count) {
    count = inputs ? count : 0;
    for (const noc_option *o = city_options; o->name; o++)
        if (o == option)
            return has_input(inputs, count, "builtin:city") ? NULL : "builtin:city";
    for (const noc_option *o = builtin_options; o->name; o++)
        if (o == option && !has_input(inputs, count, "builtin:mess"))
            return !strcmp(o->name, "lights")                      ? "builtin:mess"
                   : has_input(inputs, count, "builtin:cityscape") ? NULL
                                                                   : "builtin:cityscape or builtin:mess";
    return NULL;
}

/* Messages quote what was given; a quote of pages helps nobody. */
#define QUOTE "\"%.60s%s\""
#define QUOTED(s) (s), strlen(s) > 60 ? "..." : ""

static int format_real(char *text, size_t size, double v) {
    char shortest[40];
    if (v == (double)(long long)NOC_CLAMP(v, -1e15, 1e15))
        return snprintf(text, size, "%lld", (long long)v);
    for (int digits = 6; digits <= 17; digits++) {
        double back;
        noc_snprintf(shortest, sizeof(shortest), "%.*g", digits, v);
        if (noc_parse_double(shortest, &back) && back == v)
            break;
    }
    return snprintf(text, size, "%s", shortest);
}

static noc_status set_bool(const noc_option *o, bool *field, const char *value, noc_log *log) {
    static const char *const yes[] = { "true", "on", "yes", "1" }, *const no[] = { "false", "off", "no", "0" };
    if (!value) {
        *field = true;
        return NOC_OK;
    }
    for (size_t i = 0; i < NOC_COUNT(yes); i++) {
        if (noc_ieq(value, yes[i]) || noc_ieq(value, no[i])) {
            *field = noc_ieq(value, yes[i]);
            return NOC_OK;
        }
    }
    return noc_error(log, NOC_ERR_ARGUMENT, "%s: " QUOTE " is neither true nor false", o->name, QUOTED(value));
}

static noc_status set_switch(const noc_option *o, void *field, const char *value, noc_log *log) {
    bool on = false;
    int state = NOC_SWITCH_AUTO;
    noc_status status = value && noc_ieq(value, "auto") ? NOC_OK : set_bool(o, &on, value, log);
    if (!value || !noc_ieq(value, "auto"))
        state = on ? NOC_SWITCH_ON : NOC_SWITCH_OFF;
    if (!status)
        memcpy(field, &state, sizeof(state));
    return status;
}

/* The index of the choice of this name, or -1. */
static int choice_index(const noc_option *o, const char *name, size_t length) {
    int index = 0;
    for (const char *c = o->choices; *c; index++) {
        size_t n = strcspn(c, "|");
        if (n == length && !strncmp(c, name, n))
            return index;
        c += n + (c[n] == '|');
    }
    return -1;
}

/* The index of the choice that has this alias, or -1. */
static int alias_index(const noc_option *o, const char *name) {
    for (const char *a = o->aliases; a && *a;) {
        size_t alias = strcspn(a, "="), n = strcspn(a + alias + 1, "|");
        if (strlen(name) == alias && !strncmp(a, name, alias))
            return choice_index(o, a + alias + 1, n);
        a += alias + 1 + n;
        a += *a == '|';
    }
    return -1;
}

static noc_status set_choice(const noc_option *o, void *field, const char *value, noc_log *log) {
    int index = choice_index(o, value, strlen(value));
    index = index < 0 ? alias_index(o, value) : index;
    if (index < 0)
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: " QUOTE " is none of %s", o->name, QUOTED(value), o->choices);
    memcpy(field, &index, sizeof(index));
    return NOC_OK;
}

/* wrong: "outside", and the range follows. */
static noc_status range_error(const noc_option *o, const char *value, const char *wrong, noc_log *log) {
    char lo[40], hi[40];
    format_real(lo, sizeof(lo), o->min);
    format_real(hi, sizeof(hi), o->max);
    return noc_error(log, NOC_ERR_ARGUMENT, "%s: " QUOTE " is %s %s to %s%s%s", o->name, QUOTED(value), wrong, lo, hi,
                     *o->unit ? " " : "", o->unit);
}

static noc_status set_number(const noc_option *o, void *field, const char *value, noc_log *log) {
    double real;
    bool number = noc_parse_double(value, &real);
    const char *wrong = number || !o->read ? NULL : o->read(value, &real);
    if (wrong)
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: " QUOTE " %s", o->name, QUOTED(value), wrong);
    if (!number && !o->read)
        return range_error(o, value, "not a number from", log);
    if (!(real >= o->min && real <= o->max))
        return range_error(o, value, "outside", log);
    if (o->kind == NOC_OPTION_REAL) {
        memcpy(field, &real, sizeof(real));
        return NOC_OK;
    }
    if (real != (double)(long long)real)
        return range_error(o, value, "not a whole number from", log);
    if (o->kind == NOC_OPTION_INT) {
        int i = (int)real;
        memcpy(field, &i, sizeof(i));
    } else {
        uint32_t u = (uint32_t)real;
        memcpy(field, &u, sizeof(u));
    }
    return NOC_OK;
}

static noc_status add_text(const noc_option *o, noc_texts *texts, const char *value, noc_log *log) {
    if (texts->count == NOC_TEXTS)
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: given more than %d times", o->name, NOC_TEXTS);
    texts->text[texts->count++] = value;
    return NOC_OK;
}

/* Like snprintf: the length that all of them would take, separated by commas. */
static int join_texts(const noc_texts *texts, char *text, size_t size) {
    size_t length = 0;
    if (size)
        *text = 0;
    for (size_t i = 0; i < texts->count; i++) {
        size_t at = NOC_MIN(length, size);
        length += (size_t)snprintf(size ? text + at : NULL, size - at, "%s%s", i ? "," : "", texts->text[i]);
    }
    return (int)length;
}

noc_status noc_option_set(const noc_option *option, void *params, const char *value, noc_log *log) {
    if (!option || !params)
        return noc_null(log, __func__);
    void *field = (char *)params + option->offset;
    if (option->kind == NOC_OPTION_BOOL)
        return set_bool(option, field, value, log);
    if (option->kind == NOC_OPTION_SWITCH)
        return set_switch(option, field, value, log);
    if (!value || !*value)
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: needs a value", option->name);
    switch (option->kind) {
    case NOC_OPTION_CHOICE: return set_choice(option, field, value, log);
    case NOC_OPTION_TEXT: memcpy(field, &value, sizeof(value)); return NOC_OK;
    case NOC_OPTION_TEXTS: return add_text(option, field, value, log);
    default: return set_number(option, field, value, log);
    }
}

static int get_choice(const noc_option *o, int index, char *text, size_t size) {
    const char *c = o->choices;
    for (; index > 0 && *c; index--) {
        c += strcspn(c, "|");
        c += *c == '|';
    }
    return snprintf(text, size, "%.*s", index ? 0 : (int)strcspn(c, "|"), c);
}

size_t noc_option_size(const noc_option *option) {
    if (!option)
        return 0;
    switch (option->kind) {
    case NOC_OPTION_BOOL: return sizeof(bool);
    case NOC_OPTION_REAL: return sizeof(double);
    case NOC_OPTION_TEXT: return sizeof(char *);
    case NOC_OPTION_TEXTS: return sizeof(noc_texts);
    default: return sizeof(int);
    }
}

int noc_option_get(const noc_option *option, const void *params, char *text, size_t size) {
    if (!option || !params)
        return 0;
    union {
        bool b;
        int i;
        uint32_t u;
        double d;
        const char *s;
    } v;
    const char *field = (const char *)params + option->offset;
    switch (option->kind) {
    case NOC_OPTION_BOOL: memcpy(&v.b, field, sizeof(v.b)); return snprintf(text, size, "%s", v.b ? "true" : "false");
    case NOC_OPTION_SWITCH:
        memcpy(&v.i, field, sizeof(v.i));
        return snprintf(text, size, "%s", v.i == NOC_SWITCH_AUTO ? "auto" : v.i ? "true" : "false");
    case NOC_OPTION_INT: memcpy(&v.i, field, sizeof(v.i)); return snprintf(text, size, "%d", v.i);
    case NOC_OPTION_UINT: memcpy(&v.u, field, sizeof(v.u)); return snprintf(text, size, "%u", v.u);
    case NOC_OPTION_REAL: memcpy(&v.d, field, sizeof(v.d)); return format_real(text, size, v.d);
    case NOC_OPTION_CHOICE: memcpy(&v.i, field, sizeof(v.i)); return get_choice(option, v.i, text, size);
    case NOC_OPTION_TEXT: memcpy(&v.s, field, sizeof(v.s)); return snprintf(text, size, "%s", v.s ? v.s : "");
    case NOC_OPTION_TEXTS: return join_texts((const noc_texts *)(const void *)field, text, size);
    }
    return snprintf(text, size, "%s", "");
}

/* The field as a number, and the range of its row: of texts their count, of choices the index. false: any value is
 * good. */
static bool number_of(const noc_option *o, const void *params, double *value, double *min, double *max) {
    union {
        int i;
        noc_texts texts;
    } v;
    const char *field = (const char *)params + o->offset;
    *min = o->min;
    *max = o->max;
    switch (o->kind) {
    case NOC_OPTION_REAL: memcpy(value, field, sizeof(*value)); return true;
    case NOC_OPTION_CHOICE:
        *max = 0;
        for (const char *c = o->choices; *c; c++)
            *max += *c == '|';
        break;
    case NOC_OPTION_INT:
    case NOC_OPTION_SWITCH: break;
    case NOC_OPTION_TEXTS:
        memcpy(&v.texts, field, sizeof(v.texts));
        *value = (double)v.texts.count;
        *max = NOC_TEXTS;
        return true;
    default: return false;
    }
    memcpy(&v.i, field, sizeof(v.i));
    *value = v.i;
    return true;
}

noc_status noc_option_check(const noc_option *table, const void *params, const char *of, noc_log *log) {
    if (!table || !params || !of)
        return noc_null(log, __func__);
    for (const noc_option *o = table; o->name; o++) {
        double value, min, max;
        if (!number_of(o, params, &value, &min, &max) || (value >= min && value <= max)) /* neither for NaN */
            continue;
        bool choice = o->kind == NOC_OPTION_CHOICE, texts = o->kind == NOC_OPTION_TEXTS;
        const char *more = choice ? o->choices : texts ? "" : o->unit; /* of texts the unit is one of them */
        char field[64], is[40], lo[40], hi[40];
        noc_snprintf(field, sizeof(field), "%s", o->name);
        for (char *c = field; *c; c++)
            *c = *c == '-' ? '_' : *c;
        noc_snprintf(is, sizeof(is), "%g", value);
        if (isfinite(value))
            format_real(is, sizeof(is), value);
        format_real(lo, sizeof(lo), min);
        format_real(hi, sizeof(hi), max);
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: %s%s is %s, must be in %s..%s%s%s%s", of, field,
                         texts ? ".count" : "", is, lo, hi, choice ? ", of" : "", *more ? " " : "", more);
    }
    return NOC_OK;
}

static bool among(const char *values, size_t length, const char *value) {
    size_t n = strlen(value);
    for (const char *v = values; v < values + length; v += strcspn(v, "|,") + 1)
        if (strcspn(v, "|,") == n && !strncmp(v, value, n))
            return true;
    return false;
}

bool noc_option_idle(const noc_option *option, const noc_option *table, const void *params, char *why, size_t size) {
    if (!option || !table || !params)
        return false;
    for (const char *need = option->needs; need && *need;) {
        size_t name = strcspn(need, "="), length = strcspn(need + name + 1, ",");
        const char *values = need + name + 1;
        const noc_option *other = table;
        while (other->name && (strlen(other->name) != name || strncmp(other->name, need, name)))
            other++;
        char value[40] = "";
        if (other->name)
            noc_option_get(other, params, value, sizeof(value));
        if (!among(values, length, value)) {
            snprintf(why, size, "it needs %.*s %.*s, not %s", (int)name, need, (int)length, values, value);
            return true;
        }
        need = values + length + (values[length] == ',');
    }
    return false;
}
