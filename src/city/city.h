/* city: from the geo model to the scene. */
#ifndef NOC_CITY_H
#define NOC_CITY_H

#include "geo/geo.h"
#include <nocturne/import.h>

/* A street of the built-in city, whose params are within their rows: number i from 0 on, local metres. Its texts and
 * points are the arena's. false: there is none of that number, or (arena->refused) memory was refused. */
bool city_builtin_street(const noc_city_params *params, size_t i, noc_arena *arena, geo_road *street);
/* The same of the road around it: west, south, east, north, 0 to 3. Cars have none of it. */
bool city_builtin_ring(const noc_city_params *params, int side, noc_arena *arena, geo_road *street);

/* noc_scene_add_builtin. windows: those that the scene has are switched; false: they are dark glass. */
noc_status city_add_builtin(noc_scene *scene, const char *name, const noc_builtin_params *params, bool windows);

/* Distributions that a scene's lamps have. file: the user's own for all lamps, NULL: built-in ones. NULL after an
 * error, which *status gets. */
typedef struct city_profiles city_profiles;
city_profiles *city_profiles_create(noc_scene *scene, const char *file, noc_status *status);
void city_profiles_destroy(city_profiles *profiles);
/* One that rules name: a built-in one, or the file at path, which is told as `name`. Their number is for
 * geo_fitting.profile. An error is reported. */
int city_profiles_builtin(const char *name); /* 0: there is none, not reported */
noc_status city_profiles_read(city_profiles *profiles, const char *path, const char *name, int *number);
/* Sets file_lumens, file_watts and file_kelvin to those of the file that a lamp with this fitting has its distribution
 * from, where there is one. */
void city_profiles_file(const city_profiles *profiles, geo_fitting *fitting);
/* "cobra-head 40, post-top 3": which lights have which; NULL: "". */
void city_profiles_tell(const city_profiles *profiles, char *text, size_t size);

/* A body of the user's for lamps, shown by instances: z is up, its front looks along -y. */
typedef struct city_body {
    int model;       /* of the scene */
    bool whole;      /* with its pole: it stands on 0, and shines from `light`; else a head that shines from 0 */
    double light[3]; /* m */
} city_body;

/* ---- body.c: what the user's files of bodies hold, as a scene of their own, becomes a model of another one ---- */

/* That material, of that class, which shines no more: the model's light is its own. -1 after reporting. */
int city_body_material(noc_scene *to, const noc_scene *from, int index, noc_class cls);
/* A corner of a triangle, at indices[i]. */
void city_body_corner(const noc_scene *s, size_t i, double out[3]);
/* move: the three rows of a transform, 4 columns each. */
struct noc_scene_mesh;
noc_status city_body_mesh(noc_scene *to, const noc_scene *from, const struct noc_scene_mesh *mesh, int model,
                          int material, const double move[12]);

/* A light that a lamp was made of. */
typedef struct city_lamp_light {
    int index;           /* in the scene */
    double height;       /* m above the lamp's foot; NaN: there is no ground */
    double direction;    /* degrees clockwise from y, to where it faces */
    bool by_chance;      /* nothing tells that, and the lamp's light depends on it */
    double watts;        /* NaN: not told */
    const char *profile; /* "": none; city_profiles' */
} city_lamp_light;

/* Lamps lower than that are bollards, and have at most that flux where they tell none [m], [lm]. */
#define CITY_BOLLARD_HEIGHT 1.5
#define CITY_BOLLARD_LUMENS 500.0

/* Lamps stand on the ground by a downward ray, on a pole with a head. */
typedef struct city_lamp_params {
    double height, lumens, kelvin; /* of lamps that do not tell theirs */
    bool has_floor;
    double floor;                  /* where a lamp stands that has no ground near: taken before any lamp is stood */
    struct city_lamp_tally *tally; /* counted up; may be NULL */
    const city_body *body;         /* NULL: bodies of our own */
    city_profiles *profiles;       /* NULL: lamps are Lambertian discs, and spheres that shine alike to all sides */
    /* What rules say of a lamp that is placed here (city_infer_lamps); NULL: nothing. Changes the lamp. */
    void (*dress)(void *dresser, geo_lamp *lamp, geo_fitting *fitting);
    void (*told)(void *dresser, const city_lamp_light *light); /* each that is added; NULL: nobody asks */
    void *dresser;
} city_lamp_params;

typedef struct city_lamp_tally {
    size_t by_chance; /* lamps whose direction nothing tells and whose light depends on it */
    size_t moved;     /* lamps put elsewhere than they were given: out of a building, away from another lamp */
    size_t classless; /* lamps that stand on what names no class, for want of a ground */
    size_t raised;    /* of those, the ones that stand 2 m or more above what is around them: on a roof, perhaps */
    /* where the last lamp was whose facing was searched (searched), and what it faces, if it faces anything (faces) */
    bool searched, faces;
    double foot[3], facing[2];
} city_lamp_tally;

/* Lowest height of the scene, lamps aside; 0 if it is empty. */
double city_floor(const noc_scene *scene);

/* Adds pole, head and light for one lamp whose xyz is local metres (z NaN: on the ground). Returns the number of lights
 * added, 0 if it was skipped (reported in issues). */
int city_add_lamp(noc_scene *scene, const geo_lamp *lamp, const city_lamp_params *params, bool inferred,
                  geo_issues *issues);

/* Returns true if the lamp lacks this property, so that the default of params is used. The direction has no default:
 * the result is false, and city_lamp_tally.by_chance counts it. */
bool city_lamp_assumes(const geo_lamp *lamp, noc_lamp_default what);

/* Places lamps by a rule where the data holds none: along roads if there are any, else around the buildings. *lights
 * gets the number of lights added; all are marked as inferred. progress may be NULL; NOC_ERR_CANCELLED where it says
 * so. */
noc_status city_infer_lamps(noc_scene *scene, const city_lamp_params *params, const noc_progress *progress,
                            geo_issues *issues, int *lights);

/* Roads of maps, found by place. The roads (local metres) stay the caller's, as long as it is there. NULL: memory was
 * refused. */
typedef struct city_roads city_roads;
city_roads *city_roads_create(const geo_road *roads, size_t count);
void city_roads_destroy(city_roads *roads); /* NULL is allowed */
/* The nearest road that a lamp there lights, named or not, whose middle is within 25 m: a path counts as 3 m farther
 * away, for lamps of a street stand beside its pavement. NULL: there is none. facing: the unit vector from there to its
 * middle; may be NULL. */
const geo_road *city_roads_beside(const city_roads *roads, const double xy[2], double facing[2]);

/* The same of bridges alone, or of roads that are none. *off: how far the place is off the edge of the carriageway [m],
 * negative on it; INFINITY where there is no such road. */
const geo_road *city_roads_by_bridge(const city_roads *roads, const double xy[2], bool bridge, double *off,
                                     double facing[2]);

/* The nearest road with a name, whose middle is within 25 m; NULL: there is none. */
const geo_road *city_roads_street(const city_roads *roads, const double xy[2]);

/* Makes a surface of areas of maps (local metres, their z is not read), `lift` m over the ground that the scene has, of
 * that class; nothing where there is no ground. Bounded in triangles; *made: how many. progress may be NULL;
 * NOC_ERR_CANCELLED where it says so. */
noc_status city_lay_area(noc_scene *scene, const geo_triangles *triangles, noc_class cls, double lift,
                         const noc_progress *progress, size_t *made);

/* What became of roads that were to be drawn. */
typedef struct city_paved {
    size_t roads;   /* have a surface */
    size_t unpaved; /* railways, and tracks across fields */
    size_t tunnels;
    size_t off_ground; /* lie nowhere over the scene's ground */
    size_t too_many;
    size_t triangles;
} city_paved;

/* Sets the decks of roads that are bridges (local metres), over the ground that the scene has; in the arena. */
noc_status city_level_decks(noc_scene *scene, geo_road *roads, size_t count, noc_arena *arena);

/* Makes surfaces of roads of maps (local metres), on the ground that the scene has: roads where cars drive, pavements
 * where one walks, each as wide as its carriageway and named by its id. Bridges follow their decks. Bounded in
 * triangles and time: what is more is counted. progress may be NULL; NOC_ERR_CANCELLED where it says so. */
noc_status city_pave_roads(noc_scene *scene, const geo_road *roads, size_t count, const noc_progress *progress,
                           city_paved *paved);

/* A place for a lamp beside a road, on the ground. */
typedef struct city_road_lamp {
    const geo_road *road;
    uint32_t number; /* of those that the road could have, along it */
    double xy[2], facing[2];
    double height; /* m */
    double flux;   /* of that of lamps that tell none */
    uint64_t rank; /* less is kept first, where two are too near */
} city_road_lamp;

typedef struct city_road_params {
    double height; /* m, of lamps in streets where people live; others in proportion */
    const double
        *mapped; /* 2 a lamp that is there: within a spacing of it none is placed, within two none of its street */
    size_t mapped_count;
    const noc_scene *water; /* surfaces of water that the scene has not, seen from above; NULL: none */
    bool (*inside)(void *user, const double xy[2]); /* may one stand there at all? NULL: anywhere */
    void *user;
    const noc_progress *progress; /* NULL: none */
} city_road_params;

/* Places for lamps along roads that are lit by their own word, or, where no lamp is
 * mapped and no road tells whether it is lit, by their class: off other carriageways and so the middle of junctions,
 * off railways, water, tunnels and buildings of the scene. *lamps: to be freed, whatever order the roads are in with
 * the same places in the same order; *streets: how many streets they stand along.
 */
noc_status city_road_lamps(noc_scene *scene, const city_roads *roads, const city_road_params *params,
                           city_road_lamp **lamps, size_t *count, size_t *streets);

/* A ground under a city without terrain, a little larger than it, at the height its buildings stand at; skirts from
 * walls that stand over it; its surroundings. points (3 doubles each, local; heights may be NaN) are places it must
 * reach too. */
void city_add_ground(noc_scene *scene, const double *points, size_t point_count);

/* The same in two steps, so that it can be asked whether the points' heights are to be believed. NULL: there is nothing
 * to stand under, or the scene is out of memory. Until it is laid, which frees it, the scene does not change. */
typedef struct city_ground city_ground;
city_ground *city_ground_start(noc_scene *scene, const double *points, size_t count);
/* By what buildings stand at alone, not by streets; NULL, too, where there are none. It is not to be laid. */
city_ground *city_ground_of_buildings(noc_scene *scene);
/* Meshes before that one have a ground of their own: their walls end where they end. */
void city_ground_keep(city_ground *g, size_t first_mesh);
/* At how many points of triangles the ground was looked at: at most 100,000,000 and three a triangle. */
size_t city_ground_points(const city_ground *g);
/* Height by what the city tells, and how far away the nearest of that is, m (INFINITY: it tells nothing). */
double city_ground_height(const city_ground *g, double x, double y, double *distance);
void city_ground_lay(city_ground *g, const double *points, size_t count); /* through those that have a height */
void city_ground_free(city_ground *g);                                    /* one that is not to be laid */

/* Roads, pavements, lawns and water among the meshes first to end that lie level at height 0 (or, many of them, at
 * another one) far from all that stands around them have no height: they are laid on the terrain, or at the feet of the
 * buildings, and split until they follow that. zero: where height 0 of their file is. tell is called for each. */
typedef struct city_laid {
    size_t number;    /* of an outline */
    const char *name; /* NULL: none */
    double z, off;    /* its height, and how much that is above what stands around it, m */
    bool follows;     /* false: its corners alone lie on the ground */
} city_laid;
typedef void (*city_level_fn)(void *user, const city_laid *laid);
noc_status city_lay_level_surfaces(noc_scene *scene, size_t first, size_t end, double zero, city_level_fn tell,
                                   void *user);

/* Meshes of a building that was made of its outline, which follow each other. */
typedef struct city_outline {
    uint32_t first, end;
    size_t input; /* for the caller */
} city_outline;
/* The same for buildings, which move as a whole: their feet to the lowest ground that what else stands there tells.
 * number: of the outline. */
noc_status city_lay_outlines(noc_scene *scene, const city_outline *outlines, size_t count, double zero,
                             city_level_fn tell, void *user);

/* Is the edge from a to b the level lower edge of a piece of wall whose third corner is c? */
bool city_wall_foot(const float *a, const float *b, const float *c);

/* Extends walls down to the terrain they stand over, from that mesh on. */
void city_add_skirts(noc_scene *scene, size_t first_mesh);

/* Country around the city, to the horizon: from a rim (count points, counter-clockwise, around its own middle)
 * outwards. */
void city_add_surroundings(noc_scene *scene, const double *rim, size_t count, int material);

#endif
