/* nocturne/luminaire.h: what lamps and lights are told by rules: which luminaire stands behind a tag, a column of an
 * inventory or a street, and which lights are switched, dimmed and coloured together. Recipes hold both as `luminaires`
 * and `groups` (docs/luminaires.md).
 *
 * Rules hold for every lamp that is read or placed, in their order: all that match apply, and where two of them set the
 * same, the later one's word counts. So general rules come first. What a rule says beats what a lamp's file says. A
 * light is of one group: the first one that matches it. */
#ifndef NOCTURNE_LUMINAIRE_H
#define NOCTURNE_LUMINAIRE_H

#include <nocturne/scene.h>

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What something must be. Texts are the caller's.
 *
 * key: what the readers understood of a lamp, whatever its file calls it (height, watts, lumens, kelvin, source, mount,
 * heads, id); file, street, road (the value of highway that the nearest road has), class (lamp, window, other) or
 * inferred (yes, no); else the name of a tag, a column or an attribute, where case, accents, blanks and signs do not
 * count. "tag:NAME" is always that.
 *
 * test: a pattern of the whole value, where case does not count: "*" any text, "?" a character, "[a-f]" one of these,
 * "|" between patterns; "!" before them: none of them. "absent": no value, or a blank one; so "*" is any value. "< 70",
 * "<= 70", "> 70", ">= 70", "= 70" or "70..150", both ends among them: a number, with or without a unit, compared in
 * the unit that the key's values are in. */
typedef struct noc_condition {
    const char *key, *test;
} noc_condition;

/* NOC_ERR_ARGUMENT after reporting what is wrong with it. */
NOC_API noc_status noc_condition_check(const noc_condition *condition, noc_log *log);

/* What shines. FITTING: what the lamp's kind says, discs under heads on arms and spheres in lanterns. */
typedef enum noc_lamp_shape {
    NOC_LAMP_FITTING,
    NOC_LAMP_POINT,
    NOC_LAMP_SPHERE,
    NOC_LAMP_DISC,
    NOC_LAMP_SHAPE_COUNT
} noc_lamp_shape;

typedef enum noc_lamp_type {
    NOC_LAMP_ANY_TYPE,
    NOC_LAMP_STREET,  /* a head on an arm */
    NOC_LAMP_LANTERN, /* on top of a post */
    NOC_LAMP_FLOOD,
    NOC_LAMP_TYPE_COUNT
} noc_lamp_type;

typedef enum noc_lamp_mount {
    NOC_LAMP_ANY_MOUNT,
    NOC_LAMP_POLE,
    NOC_LAMP_WALL,
    NOC_LAMP_SUSPENDED,
    NOC_LAMP_MOUNT_COUNT
} noc_lamp_mount;

/* What makes a lamp's light. */
typedef enum noc_lamp_source {
    NOC_SOURCE_UNKNOWN,
    NOC_SOURCE_LED,
    NOC_SOURCE_SODIUM, /* high pressure, or not told which */
    NOC_SOURCE_MERCURY,
    NOC_SOURCE_METAL_HALIDE,
    NOC_SOURCE_FLUORESCENT,
    NOC_SOURCE_INCANDESCENT,
    NOC_SOURCE_GAS,
    NOC_SOURCE_LOW_SODIUM, /* low pressure: one orange line */
    NOC_SOURCE_COUNT
} noc_lamp_source;

/* Whose flux a lamp has that has a file's profile: what the lamp's file says, where it says nothing the profile's; or
 * the one of them alone. */
typedef enum noc_lamp_flux { NOC_FLUX_ANY, NOC_FLUX_FILE, NOC_FLUX_LAMP } noc_lamp_flux;

/* A rule: lamps that all of its conditions hold for are what it says. Rows of noc_luminaire_options name the fields;
 * one that is 0, NULL or (a number with a point) NaN says nothing. */
typedef struct noc_luminaire_rule {
    const char *place; /* for messages, where it is written: "city.yaml:12"; NULL: "rule 1", ... */
    const noc_condition *conditions;
    size_t condition_count; /* 0: every lamp */
    noc_lamp_source source; /* what its watts give, and its colour, where nothing else says them */
    noc_lamp_type type;     /* of fitting */
    noc_lamp_mount mount;
    double watts, lumens; /* of a head. Watts put aside the lumens that the file has, and those of earlier rules */
    noc_lamp_flux flux;   /* puts aside lumens and watts of earlier rules, as these put it aside */
    double efficacy;      /* lm/W of the luminaire, for its watts */
    double kelvin;        /* puts aside colours said before */
    const char *colour;   /* "#rrggbb", sRGB; beats kelvin in the same rule */
    double height;        /* m, of the light above the ground */
    int heads;            /* on a pole */
    noc_lamp_shape shape;
    double radius;       /* m, of a sphere or disc */
    double tilt;         /* degrees that the axis is turned from straight down, to where the lamp faces */
    double arm;          /* m, of heads on a pole, from its axis; never so little that its light were in the pole */
    double turn;         /* degrees that the profile is turned about its axis, from where its C angle of the street
                            (noc_profile_info.street) faces the street, counter-clockwise as seen from above */
    const char *profile; /* built-in (noc_profile_builtin_name), an IES or EULUMDAT file, or "none" */
    const char *profile_base; /* folder, with a slash at its end or "", that such a file's name begins at, and that it
                                 must lie below unless noc_import_params.allow_outside; NULL: it lies anywhere */
} noc_luminaire_rule;

#define NOC_LUMINAIRE_DEFAULTS(set)                                                                                    \
    set(watts, (double)NAN) set(lumens, (double)NAN) set(efficacy, (double)NAN) set(kelvin, (double)NAN)               \
        set(height, (double)NAN) set(radius, (double)NAN) set(tilt, (double)NAN) set(arm, (double)NAN)                 \
            set(turn, (double)NAN)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_luminaire_rule, noc_luminaire_default_rule, NOC_LUMINAIRE_DEFAULTS)
#else
#define noc_luminaire_default_rule() ((noc_luminaire_rule){ NOC_LUMINAIRE_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* A group of lights. It is there under its name (noc_scene_find_group) whether or not anything matches. Lights that no
 * group takes are of lamps, windows, cars or, with a class of their own, none. One that is called so and has no
 * conditions says how that one begins. */
typedef struct noc_group_rule {
    const char *name;
    const char *place; /* as in noc_luminaire_rule */
    const noc_condition *conditions;
    size_t condition_count;
    bool on;            /* how it begins; default true */
    double scale;       /* of what its lights emit; default 1 */
    double kelvin;      /* colour of all its lights, each at its own luminance; NaN, the default: their own */
    const char *colour; /* "#rrggbb", sRGB, in its place; NULL: none */
} noc_group_rule;

#define NOC_GROUP_DEFAULTS(set) set(on, true) set(scale, 1) set(kelvin, (double)NAN)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_group_rule, noc_group_default_rule, NOC_GROUP_DEFAULTS)
#else
#define noc_group_default_rule() ((noc_group_rule){ NOC_GROUP_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Stages what a text says of a group of the scene: "off", "on", "0.3" (noc_scene_set_group), "2200K", "#ffb060" or
 * "own" (noc_scene_colour_group); several with commas between them. NOC_ERR_ARGUMENT after reporting, and nothing is
 * staged. */
NOC_API noc_status noc_scene_say_group(noc_scene *scene, int group, const char *text);

/* Whether that would take the text, for any group: NOC_ERR_ARGUMENT after reporting. */
NOC_API noc_status noc_group_state_check(const char *text, noc_log *log);

/* Linear Rec.709 of luminance 1: a black body's or daylight's at that colour temperature, K. */
NOC_API void noc_kelvin_rgb(double kelvin, float rgb[3]);

/* The colour temperature of that colour, K, however bright it is: 1000 to 15000. NaN: it is none of these colours, or
 * black, or rgb is NULL. */
NOC_API double noc_rgb_kelvin(const float rgb[3]);

#ifdef __cplusplus
}
#endif
#endif
