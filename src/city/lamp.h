/* lamp: where a lamp stands (site.c), what it looks like (lamp_shape.c), how it shines (lamp.c). */
#ifndef NOC_CITY_LAMP_H
#define NOC_CITY_LAMP_H

#include "city/city.h"
#include "scene/scene.h"

/* ---- sites (site.c); local metres ---- */

/* Height of the ground at (x, y), or of the nearest within a few metres. */
bool site_ground(const noc_scene *scene, double x, double y, double *z);
/* Height of the nearest ground within a few hundred metres. */
bool site_ground_far(const noc_scene *scene, double x, double y, double *z);
/* Does something within some 12 m of (x, y) lie 2 m or more lower than z? */
bool site_raised(const noc_scene *scene, double x, double y, double z);
/* Is (x, y), with ground at z, under a roof or in a wall? */
bool site_covered(const noc_scene *scene, double x, double y, double z);
/* Is what lies over (x, y), with ground at z, a canopy, whose bottom is there, and is higher than `head`? */
bool site_under(const noc_scene *scene, double x, double y, double z, double head);
/* Nearest spot within `reach` that no building covers; away[2] is the unit vector that leads there. */
bool site_free_spot(const noc_scene *scene, double *x, double *y, double z, double reach, double away[2]);
/* Unit vector from (x, y) to what a lamp there should light: the nearest road, else away from the nearest building. */
bool site_facing(const noc_scene *scene, double x, double y, double z, double facing[2]);
/* Does a lamp stand there already? */
bool site_taken(const noc_scene *scene, double x, double y, double z);

/* ---- what it is and where it stands (lamp.c) ---- */

typedef struct lamp_fitting {
    enum { FITTING_DISC, FITTING_SPHERE, FITTING_FLOOD } kind;
    noc_light_kind light;
    double height, radius, lumens, watts;
    double tilt; /* of its axis from straight down, radians */
    int heads;
    bool profiled;
    geo_fitting ruled; /* what rules say of it */
    float emission[3]; /* of a profile where it has one, else of the shape */
} lamp_fitting;

typedef struct lamp_placing {
    double foot[3];
    double facing[2]; /* unit vector the heads look along */
    bool by_chance;   /* nothing tells it */
    bool on_wall;
    double wall[2]; /* the wall it hangs on */
    bool crowded;   /* others stand wherever it could */
} lamp_placing;

/* ---- making it (lamp_make.c) ---- */

typedef struct lamp_making {
    noc_scene *scene;
    const geo_lamp *lamp;
    const lamp_fitting *fitting;
    const lamp_placing *placing;
    const city_lamp_params *params;
    bool inferred;
} lamp_making;

/* Adds its lights and its body. Returns how many lights there are, 0 if the scene refused it, which is told. */
int lamp_make(const lamp_making *m, geo_issues *issues);

/* ---- distributions (lamp_profiles.c) ---- */

/* In the order of noc_profile_builtin_name. */
typedef enum city_profile_kind {
    CITY_PROFILE_COBRA_HEAD,
    CITY_PROFILE_POST_TOP,
    CITY_PROFILE_WALL,
    CITY_PROFILE_FLOOD,
    CITY_PROFILE_BOLLARD,
    CITY_PROFILE_OWN,
    CITY_PROFILES
} city_profile_kind;

/* Gives a light that profile, or the one that rules say, with the way to the street, turned as rules say; false after
 * reporting. */
bool city_profile_give(city_profiles *p, city_profile_kind kind, const geo_fitting *ruled, const double street[3],
                       noc_light *light);

/* Returns true if the distribution that a light was given (city_profile_give) is alike all around its axis. */
bool city_profile_is_round(const city_profiles *p, city_profile_kind kind, int ruled);

/* Its name; of files, the file's. "" where profiles is NULL. */
const char *city_profile_name(const city_profiles *p, city_profile_kind kind, int ruled);

/* ---- the user's bodies (lamp_body.c) ---- */

/* A head above its light, which shines along axis; street: the unit vector to the street, level. false after reporting.
 */
bool body_show_head(noc_scene *scene, const city_body *body, const double light[3], const double axis[3],
                    const double street[2]);
/* A lamp from its foot on, scaled to be as high as its light is to hang: light[3] gets where. false after reporting. */
bool body_show_whole(noc_scene *scene, const city_body *body, const double foot[3], double height,
                     const double street[2], double light[3]);

/* ---- shapes (lamp_shape.c) ---- */

typedef struct lamp_shape {
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices;
    bool no_memory; /* who adds it says so */
} lamp_shape;

/* Tapered hexagonal pole with a cap: 16 triangles. */
void shape_pole(lamp_shape *s, const double foot[3], double top_z, double foot_radius, double top_radius);
/* Square bar between two points: 8 triangles. */
void shape_bar(lamp_shape *s, const double from[3], const double to[3], double half_width);
/* Closed housing behind a face: centre of the face, the unit vector it looks along, a unit vector along its length.
 * 12 triangles. */
void shape_housing(lamp_shape *s, const double centre[3], const double look[3], const double along[3],
                   double half_length, double half_width, double depth);
/* The LAMP material without emission: one a scene. -1 after reporting. */
int shape_material(noc_scene *scene);
/* Adds it as one mesh of class LAMP: stood at `foot`, its x turned to `facing`. false after an error that was reported.
 */
bool shape_add(lamp_shape *s, noc_scene *scene, const double foot[3], const double facing[2], const char *name);
void shape_free(lamp_shape *s);

#endif
