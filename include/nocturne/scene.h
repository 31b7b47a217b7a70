/* nocturne/scene.h: what is rendered: meshes, materials by semantic class, lights.
 *
 * Coordinates are metres in the scene's local frame, z up. Where the scene has a CRS, crs = local + origin (doubles).
 * Colours are linear Rec.709; emission is photometric: 0.2126 R + 0.7152 G + 0.0722 B is luminance in cd/m2 (for point
 * luminaires: luminous intensity in cd).
 *
 * A scene is edited in transactions. Until the first noc_scene_commit it is being made: one thread adds to it, and no
 * one looks. From then on any number of threads may render and ask, while one thread at a time calls what adds, sets,
 * moves and removes: that only stages. noc_scene_commit publishes what is staged, all or nothing, between frames. */
#ifndef NOCTURNE_SCENE_H
#define NOCTURNE_SCENE_H

#include <nocturne/image.h>
#include <nocturne/log.h>
#include <nocturne/photometry.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct noc_scene noc_scene;

/* Semantic class of a surface. Every class has a default material (noc_class_material). */
typedef enum noc_class {
    NOC_CLASS_OTHER,
    NOC_CLASS_WALL,
    NOC_CLASS_ROOF,
    NOC_CLASS_GROUND,  /* a building's ground surface */
    NOC_CLASS_CLOSURE, /* virtual surface that closes a volume: read and counted, not rendered, not in bounds */
    NOC_CLASS_WINDOW,
    NOC_CLASS_DOOR,
    NOC_CLASS_INSTALLATION, /* balconies, chimneys, stairs */
    NOC_CLASS_TERRAIN,
    NOC_CLASS_ROAD,
    NOC_CLASS_SIDEWALK,
    NOC_CLASS_GREEN, /* lawns, plant cover, land use */
    NOC_CLASS_TREE,
    NOC_CLASS_WATER,
    NOC_CLASS_BRIDGE,
    NOC_CLASS_FURNITURE,
    NOC_CLASS_LAMP, /* poles and housings */
    NOC_CLASS_VEHICLE,
    NOC_CLASS_COUNT
} noc_class;

NOC_API const char *noc_class_name(noc_class cls); /* "wall", "roof", ... */

/* Surface: Lambert plus one glossy lobe (isotropic GGX, Schlick Fresnel). */
typedef struct noc_material {
    float albedo[3];   /* diffuse reflectance, 0..1 */
    float f0;          /* reflectance of the glossy lobe at normal incidence, 0..1; 0 = purely diffuse */
    float roughness;   /* 0.05..1, GGX alpha = roughness^2 */
    float emission[3]; /* radiance, cd/m2; a mesh with emission becomes triangle lights */
    bool two_sided;    /* emission leaves both sides; reflection always works on both sides */
    noc_class cls;
    /* From noc_scene_add_texture; 0: none. Where a mesh has uv, its albedo is this one times the texture's */
    int texture;
    /* Share of the light that goes straight through, 0..1; the surface reflects what is left of the light times what
     * it reflects by itself, as the alpha of glTF and the dissolve of MTL have it. A surface that emits has 0 */
    float transmittance;
    bool cutout; /* where its texture has holes there is no surface. A surface that emits has none */
} noc_material;

NOC_API noc_material noc_class_material(noc_class cls);
/* A class of road surfaces as drivers see them, from 1 degree above the road, and the material that is fitted to it. R1
 * to R4 are dry (CIE 144:2001; R1 is concrete, R3 what roads are by default), W1 to W4 wet (CIE 47:1979). */
typedef struct noc_road_class {
    const char *name; /* "R1", ... */
    float albedo, f0, roughness;
    double q0; /* average luminance coefficient of the class's standard, cd/m2 a lux */
    double s1; /* its specular factor, r(0, 2) / r(0, 0) */
} noc_road_class;
/* All of them; after the last comes one whose name is NULL. */
NOC_API const noc_road_class *noc_road_classes(void);

/* The same surface after rain: under a film of water it is darker (Angstrom 1925: the water's side of the surface
 * reflects a / (n^2 (1 - a) + a) of what comes, n = 1.333) and reflects as water does, f0 = 0.02. One of the road
 * classes W1 to W4 is wet and stays as it is. For roads, pavements and ground; at run time by
 * noc_scene_set_class_material. NULL is noc_class_material(NOC_CLASS_OTHER), wet. */
NOC_API noc_material noc_material_wet(const noc_material *dry);

/* The same surface as a metal to that share, 0..1: f0 goes from 0.04, that of glass, paint and stone, to the luminance
 * of the albedo, which goes to 0, as glTF has it; one lobe has no colour. NULL is noc_class_material(NOC_CLASS_OTHER).
 */
NOC_API noc_material noc_material_metal(const noc_material *material, float metalness);

/* What is seen beyond the edges of an image. */
typedef enum noc_wrap {
    NOC_WRAP_REPEAT, /* the image again */
    NOC_WRAP_MIRROR, /* the image again, every second time turned over */
    NOC_WRAP_CLAMP   /* its outermost pixels */
} noc_wrap;

#define NOC_TEXTURE_SIDE 16384 /* pixels */
/* Albedos of a texture: what is beyond becomes these. Of building materials fresh snow and whitewash are the brightest,
 * soot and tar the darkest, and a photograph holds shades that are no albedos at all. */
#define NOC_TEXTURE_DARKEST 0.02
#define NOC_TEXTURE_BRIGHTEST 0.9

/* An image that surfaces have their albedo from. It is taken as it is: what light a photograph was made in stays in it.
 */
typedef struct noc_texture {
    int width, height;          /* pixels, 1..NOC_TEXTURE_SIDE */
    const unsigned char *rgb;   /* 3 a pixel, rows from the top; copied */
    const unsigned char *holes; /* 1 a pixel: not 0 is a hole, for noc_material.cutout; copied. NULL: there are none */
    bool linear;                /* 255 is an albedo of 1 and all else in proportion; false: sRGB */
    noc_wrap wrap;
    int leave_out; /* levels of its pyramid, the finest ones: each saves three quarters of the memory; 0..15 */
} noc_texture;

typedef struct noc_mesh {
    size_t vertex_count;
    const double *positions; /* 3 a vertex, local metres */
    size_t triangle_count;
    const uint32_t *indices; /* 3 a triangle, counter-clockwise seen from outside */
    int material;            /* from noc_scene_add_material */
    int model;               /* from noc_scene_add_model: it is in that model's coordinates; 0: in the scene's */
    int group;               /* from noc_scene_add_group, of its triangles as lights; 0: none */
    const char *name;        /* object id, gml:id; may be NULL. Copied */
    /* 2 a vertex: its place in the image of the material's texture, whose lower left corner is (0, 0) and whose upper
     * right one is (1, 1). What is not finite or beyond 1000000 is taken as 0. NULL: the texture is not seen */
    const float *uv;
} noc_mesh;

typedef enum noc_light_kind {
    NOC_LIGHT_SPHERE,        /* position = centre, radius */
    NOC_LIGHT_DISC,          /* position = centre, radius, direction = the way it faces */
    NOC_LIGHT_TRIANGLE,      /* position = corner, edges; faces edge_u x edge_v */
    NOC_LIGHT_PARALLELOGRAM, /* position = corner, edges; faces edge_u x edge_v */
    NOC_LIGHT_POINT,         /* position; isotropic, emission is intensity in cd */
    /* position, direction, inner_deg, outer_deg; emission is the inner cone's intensity in cd */
    NOC_LIGHT_SPOT,
    NOC_LIGHT_KIND_COUNT
} noc_light_kind;

/* One light. Its visible shape is made with it, except for points, spots and lights that move by themselves: those are
 * not seen themselves and cast no shadow, they light. Lights of a model have their shape, and move with its instances.
 * A spot's intensity at an angle t off its direction is that of the inner cone times clamp((cos t - cos outer) / (cos
 * inner - cos outer), 0, 1)^2, as glTF's KHR_lights_punctual has it. */
typedef struct noc_light {
    noc_light_kind kind;
    double position[3];
    double edge_u[3], edge_v[3];
    double direction[3];
    double radius;
    double inner_deg, outer_deg; /* spot: degrees off its direction, 0 <= inner <= outer, outer within 1 to 90 */
    /* cd/m2, or cd for NOC_LIGHT_POINT and NOC_LIGHT_SPOT; one-sided. With a profile lm: the light's flux is its
     * luminance, whatever the flux of the profile */
    float emission[3];
    const char *name; /* may be NULL; copied */
    bool inferred;    /* placed by a rule, not found in data */
    bool moving;      /* noc_scene_move_light may change it; not read of a model's */
    int model;        /* from noc_scene_add_model: it is in that model's coordinates; 0: in the scene's */
    int group;        /* from noc_scene_add_group; 0: none */
    /* From noc_scene_add_profile, of points, spheres and discs; 0: none. Its axis is `direction`, its C 0 is c0, made
     * upright to that; 0,0,0: any. The shape softens shadows: intensity and distance are those of the place on a disc,
     * and of a sphere's centre. Seen itself it is as bright as a Lambertian one of its flux. */
    int profile; /* discs and spheres: what lies within 2.5 radii of the centre, as a housing, casts no shadow of it */
    double c0[3];
} noc_light;

/* A model placed in the scene. */
typedef struct noc_instance {
    int model; /* from noc_scene_add_model */
    /* Rows of the 3x4 matrix that takes the model's coordinates to the scene's: a rotation, one scale, a place in m */
    double transform[12];
} noc_instance;

/* log may be NULL; it must outlive the scene. NULL: no memory, reported */
NOC_API noc_scene *noc_scene_create(noc_log *log);
NOC_API void noc_scene_destroy(noc_scene *scene);

/* These return an index >= 0, or -1 after reporting an error. Non-finite or degenerate geometry is an error here; bad
 * triangles inside a mesh (zero area, index out of range, non-finite) are dropped and counted. What is added after the
 * first commit is there from the next one on, under the index that is returned now. A scene that memory is refused to
 * before its first commit takes nothing more: that is reported once, and NOC_ERR_MEMORY is what its commit returns.
 * noc_scene_add_light returns the light's index, which stays its own until it is removed; of a model's light its number
 * in the model, from 0. */
NOC_API int noc_scene_add_material(noc_scene *scene, const noc_material *material);
NOC_API int noc_scene_add_mesh(noc_scene *scene, const noc_mesh *mesh);
NOC_API int noc_scene_add_light(noc_scene *scene, const noc_light *light);

/* A texture, with its pyramid of halves: some 5.4 bytes a pixel (noc_scene_info.texture_bytes). Returns its index >= 1,
 * for `texture` of noc_material, or -1 after reporting. It stays as long as the scene. Waits for frames, as a commit
 * does. Only what cameras see looks at textures: no light is drawn by them. */
NOC_API int noc_scene_add_texture(noc_scene *scene, const noc_texture *texture);

/* A model: meshes and lights in coordinates of their own (a car with its lamps), which are seen where instances stand.
 * Returns its index >= 1, for `model` of noc_mesh and noc_light, or -1 after reporting. It takes meshes and lights
 * until the commit that publishes it, and is never removed. name may be NULL; copied. */
NOC_API int noc_scene_add_model(noc_scene *scene, const char *name);

/* A group of lights that are switched, dimmed and coloured together. Returns its index >= 1, for `group` of noc_mesh
 * and noc_light, or -1 after reporting. name may be NULL; copied. */
NOC_API int noc_scene_add_group(noc_scene *scene, const char *name);

/* A luminous intensity distribution for lights: a copy of it at even angles, which meet the profile's own where those
 * are whole hundredths of a degree. Returns its index >= 1, for `profile` of noc_light, or -1 after reporting. Waits
 * for frames, as a commit does. */
NOC_API int noc_scene_add_profile(noc_scene *scene, const noc_profile *profile);
/* c0 of a light whose axis is that, so that the profile's street lies in the direction `street`; 0,0,0 where there is
 * none. */
NOC_API void noc_profile_orient(const noc_profile *profile, const double axis[3], const double street[3], double c0[3]);

/* An instance. Returns its index >= 0, its own until it is removed, or -1 after reporting. It is there from the next
 * commit on. Each light of its model becomes a light of the scene, of the kind that moves. */
NOC_API int noc_scene_add_instance(noc_scene *scene, const noc_instance *instance);

/* Publishes what is staged. The first commit freezes what was added until then for rendering, and noc_scene_load
 * commits by itself. Later ones wait for the frames that are being rendered and are done before the next begin: so they
 * must not be called from a frame's progress. Views see it with their next frame. NOC_ERR_MEMORY after
 * reporting it: the scene is as it was, and what is staged stays staged. */
NOC_API noc_status noc_scene_commit(noc_scene *scene);

/* Edits: staged in the order of the calls, and published by noc_scene_commit. They are of things that are there since
 * the last commit (before the first one: that were added). Where the same transaction removes a thing, other edits of
 * it have no effect. All return NOC_ERR_ARGUMENT after reporting an edit that cannot be, and NOC_ERR_MEMORY where
 * memory is refused: that edit is not staged then. */

/* Another material in place of that one, for all that is made of it. Meshes become triangle lights, or none any more,
 * as its emission says. Where a mesh of a model is made of it, `to` must have the same emission, and the same two_sided
 * where it shines: else NOC_ERR_ARGUMENT. Closures (NOC_CLASS_CLOSURE) stay such, and nothing else becomes one. The
 * materials of a transaction are set before its other edits. */
NOC_API noc_status noc_scene_set_material(noc_scene *scene, int material, const noc_material *to);
/* Gives a material a name, by which it is found, in place of the one that it has; copied, NULL: none. Materials may
 * share one: an input makes several of what its file calls one, for each class, and with an image and without. It is
 * there at once. For the thread that edits. */
NOC_API noc_status noc_scene_name_material(noc_scene *scene, int material, const char *name);
/* The first material of that name from index `from` on; -1: there is none. Those of inputs have the names that files
 * give them: X3DMaterial's gml:id in CityGML, "name" in CityJSON and glTF, newmtl in an OBJ. So all of a name are
 *
 *     for (int i = -1; (i = noc_scene_find_material(scene, "brick", i + 1)) >= 0;) */
NOC_API int noc_scene_find_material(const noc_scene *scene, const char *name, int from);
/* A material as it is since the last commit, to be changed and set. *name (may be NULL): its own, which belongs to the
 * scene; NULL where it has none. NOC_ERR_ARGUMENT after reporting that there is none of this index. */
NOC_API noc_status noc_scene_get_material(const noc_scene *scene, int material, noc_material *out, const char **name);
/* Albedo, f0, roughness and texture of all materials of that class, also of those added in the transaction. */
NOC_API noc_status noc_scene_set_class_material(noc_scene *scene, noc_class cls, const noc_material *to);
/* Emission of a light by its index, an instance's too, in the light's unit; 0: out. Its group's scale comes on top. */
NOC_API noc_status noc_scene_set_emission(noc_scene *scene, int light, const float emission[3]);
/* Scales the emission of all lights of a group, channel by channel, from what they were made with: 0 puts them out, 1
 * is as made. 0..1000000. */
NOC_API noc_status noc_scene_set_group(noc_scene *scene, int group, const float scale[3]);
/* Gives all lights of a group that colour, linear Rec.709, each at the luminance it was made with: its flux stays,
 * whatever colours the group is made of. NULL: each its own colour again. The group's scale comes on top. Black is
 * no colour: NOC_ERR_ARGUMENT. */
NOC_API noc_status noc_scene_colour_group(noc_scene *scene, int group, const float rgb[3]);
/* The first group of that name; 0: there is none. */
NOC_API int noc_scene_find_group(const noc_scene *scene, const char *name);
/* Places a light anew that was made with `moving`: position, shape, direction and emission as `to` has them. The kind
 * and the profile stay; name, inferred, model and group are not read. */
NOC_API noc_status noc_scene_move_light(noc_scene *scene, int light, const noc_light *to);
/* Places an instance anew, and its lights with it; transform as in noc_instance. */
NOC_API noc_status noc_scene_set_transform(noc_scene *scene, int instance, const double transform[12]);
/* An instance's index, and the indices of its lights, may be those of others that are added after the commit. */
NOC_API noc_status noc_scene_remove_instance(noc_scene *scene, int instance);
/* A light that was added as one, with its shape: to take that away costs what noc_scene_remove_mesh does. One added
 * after the commit may take its index. Where it was itself added after the first commit, one of its kind takes the
 * memory of its shape, too. Its name's memory stays with the scene. A light of a lamp that noc_scene_load has given a
 * body keeps its index and its shape, which is dark. */
NOC_API noc_status noc_scene_remove_light(noc_scene *scene, int light);
/* A mesh of the scene itself, with the lights that its triangles are. Its index is not used again, and its memory stays
 * with the scene. One that was there at the first commit costs the next frame a new ray tracing structure of all that
 * was, which is seconds in a large city; one that was added later costs milliseconds, as other edits do
 * (docs/measurements.md, "Edits of a scene"). */
NOC_API noc_status noc_scene_remove_mesh(noc_scene *scene, int mesh);

/* What is behind a window. */
typedef enum noc_window_kind {
    NOC_WINDOW_FLAT,
    NOC_WINDOW_OFFICE, /* whole storeys are lit together */
    NOC_WINDOW_SHOP,   /* a front at street level */
    NOC_WINDOW_KIND_COUNT
} noc_window_kind;

/* What a building is for, as its file says. */
typedef enum noc_building_use {
    NOC_USE_UNKNOWN, /* not told: drawn by its size (docs/windows.md) */
    NOC_USE_FLATS,
    NOC_USE_MIXED,   /* flats over shops */
    NOC_USE_OFFICES, /* and what is used like them: schools, authorities */
    NOC_USE_SHOPS,   /* offices over them */
    NOC_USE_DARK,    /* has windows, which are never lit: churches, factories, sports halls */
    NOC_USE_BARE,    /* has none: garages, sheds, barns, works */
    NOC_USE_COUNT
} noc_building_use;

NOC_API const char *noc_building_use_name(noc_building_use use); /* "not told", "flats", ... */

/* What became of a wall of a building that windows were looked for in. */
typedef enum noc_wall_verdict {
    NOC_WALL_UNSEEN, /* no wall, or windows were not asked for */
    NOC_WALL_TAKEN,  /* it has windows */
    NOC_WALL_SMALL,  /* too small, or no cell fits into it */
    NOC_WALL_TILTED,
    NOC_WALL_PARTY, /* another wall stands close before it, or the ground */
    NOC_WALL_BARE,  /* of a building whose use has no windows */
    NOC_WALL_OWN,   /* of a building that comes with windows of its own */
    NOC_WALL_VERDICT_COUNT
} noc_wall_verdict;

NOC_API const char *noc_wall_verdict_name(noc_wall_verdict verdict); /* "with windows", "too small", ... */

/* Windows on the walls of cities that are read. A wall, whatever pieces it comes in, gets a grid of cells of `cell` by
 * `storey_height`, centred on it and beginning at its foot, and a window in each cell that lies wholly in it. Which are
 * lit is decided by a number that a window has for good, from its building's id and its place there: so lit_windows,
 * hour and seed switch windows and move none, and windows that are lit at one share are at a greater one. What a window
 * is like, when it is lit, is its own for good. */
typedef struct noc_window_params {
    double lit_windows; /* share of windows that are lit at 21 h, 0..1 */
    double hour; /* 0..24: of the night or day; 21 takes lit_windows as it is, others scale it (noc_window_share) */
    double width, height; /* m, of a window; those of shops and offices fill their cells */
    double cell;          /* m: width of a window's cell; its height is a storey's */
    double storey_height; /* m */
    double margin;        /* m of wall that must be left around a window */
    double tilt;          /* degrees that a wall may lean */
    double min_area;      /* m2: smaller walls get no windows */
    double kelvin;        /* K: middle colour temperature of flats; shops are 1.2 and offices 1.4 times that */
    double spread;        /* of the colour temperatures, as a share of them: about two standard deviations */
    uint32_t seed;        /* another number, other windows lit */
} noc_window_params;

#define NOC_WINDOW_DEFAULTS(set)                                                                                       \
    set(lit_windows, 0.35) set(hour, 21) set(width, 1.2) set(height, 1.4) set(cell, 2.4) set(storey_height, 3)         \
        set(margin, 0.2) set(tilt, 10) set(min_area, 10) set(kelvin, 2900) set(spread, 0.15) set(seed, 1)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_window_params, noc_window_default_params, NOC_WINDOW_DEFAULTS)
#else
#define noc_window_default_params() ((noc_window_params){ NOC_WINDOW_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Share of the windows of that kind that are lit where lit_windows of all are at 21 h: lit_windows times what the
 * kind's curve has at that hour over 21 h, at most 1. */
NOC_API double noc_window_share(noc_window_kind kind, double lit_windows, double hour);
/* Switches the windows that a load or noc_scene_add_city has made, by lit_windows, hour and seed; the rest of params is
 * not read. They are as a load with these would have made them. It costs what switching their lights does: nothing is
 * built anew. */
NOC_API noc_status noc_scene_set_windows(noc_scene *scene, const noc_window_params *params);

/* Cars of a load (noc_import_params.traffic) where they are at that time, s: of any sign, 0 is where a load puts them
 * unless noc_traffic_params.time says otherwise. A car is a function of the time alone, so frames may be asked for in
 * any order. At the end of its track a car is at once at the track's beginning, or that of its next part: nothing lies
 * between. Costs what noc_scene_set_transform of every car does; without cars nothing happens. */
NOC_API noc_status noc_scene_set_time(noc_scene *scene, double seconds);
/* Takes all cars out of sight, with their light, or shows them again where their time has them; their lights are lit as
 * they were made then. Those that are out of sight stay instances: they are a thousandth of their size, under the
 * ground, and dark. Costs what noc_scene_set_time does. NOC_ERR_ARGUMENT before the first commit, where there are cars.
 */
NOC_API noc_status noc_scene_show_cars(noc_scene *scene, bool shown);

/* Index in the scene of an instance's light: light is its number in the model, where those that noc_scene_add_light
 * returned come first and triangles of meshes that shine follow. -1 after reporting: there is none, or it is not
 * committed yet. */
NOC_API int noc_scene_instance_light(const noc_scene *scene, int instance, int light);

/* A light as the scene has it now, to list and to map: those of noc_scene_add_light, of inputs, and the triangles of
 * meshes that shine, which noc_scene_commit adds. */
typedef struct noc_light_info {
    /* to the precision of floats, in the local frame; direction is set for flat kinds too; name belongs to
     * the scene: a lamp's id, or the name of the mesh */
    noc_light light;
    double centre[3]; /* local metres */
    double lumens;    /* luminous flux that leaves it, from both sides where it is two-sided */
    double area;      /* m2; of a disc, triangle or parallelogram one side, 0 for points and spots */
    bool two_sided;
    bool lamp;    /* neither flat nor moving: a lamp, where the scene is a city */
    bool removed; /* there is no light of this index (now); all else is 0 */
} noc_light_info;

/* A group as it is since the last commit. */
typedef struct noc_group_info {
    const char *name; /* "" where it has none; belongs to the scene */
    size_t lights;    /* those that are out among them */
    double lumens;    /* luminous flux that leaves them */
    float scale[3];   /* noc_scene_set_group */
    float colour[3];  /* noc_scene_colour_group, of luminance 1; 0,0,0: each light has its own */
} noc_group_info;

/* The first `count` of the scene's groups, by their index; groups[0] has the lights of none. Returns how many there
 * are, with that one. For the thread that edits. One look at all lights, however many groups there are. */
NOC_API size_t noc_scene_groups(const noc_scene *scene, noc_group_info *groups, size_t count);

/* index is below noc_scene_info.light_slots, and what NOC_AOV_LIGHT shows; else NOC_ERR_ARGUMENT after reporting. */
NOC_API noc_status noc_scene_get_light(const noc_scene *scene, size_t index, noc_light_info *info);

/* Name of an object that NOC_AOV_OBJECT shows: the id in its file (gml:id), or of a lamp; of an instance the model's.
 * NULL where it has none, and where there is no such object. Belongs to the scene. */
NOC_API const char *noc_scene_object_name(const noc_scene *scene, size_t object);

/* Place of the scene in the world: crs is any definition PROJ reads, NULL for none. To be said before a load, which
 * keeps to it, where things of one's own are added first: noc_scene_load commits the scene, so planned lamps go in
 * before. Their local coordinates are those in crs less origin, which should lie within some kilometres of the city:
 *
 *     noc_scene_set_crs(scene, "EPSG:25832", (double[3]){ 678000, 5403000, 370 });
 *     double at[3] = { 678120.5, 5403410.2, 378 };
 *     noc_scene_to_local(scene, NULL, at);
 *     noc_scene_add_light(scene, &(noc_light){ .kind = NOC_LIGHT_DISC, .position = { at[0], at[1], at[2] }, ... });
 *     noc_scene_load(scene, paths, count, &params, &report);
 *
 * Such a lamp stays where it was put, with whatever name it has; lamps are inferred beside it unless params say
 * otherwise. */
NOC_API noc_status noc_scene_set_crs(noc_scene *scene, const char *crs, const double origin[3]);

/* What is around the scene, to the horizon and beyond: an equirectangular picture, twice as wide as high, which frames
 * show where they see no surface, and which lights where noc_render_params.environment_light says so. Its rows go from
 * the zenith to the nadir, its middle lies in the north (y), what is right of it further east, unless
 * environment_rotation turns it. Numbers times environment_scale are cd/m2. Numbers below 0 and those that are not
 * finite are taken as 0, what is over 1e9 as 1e9, and a warning counts them. The picture is copied; one that is wider
 * than 8192 pixels is averaged down, and what lights has at most 4096 columns. NULL: none, the default. Waits for
 * frames, as a commit does; the next one begins its mean anew, and nothing else is made anew. NOC_ERR_ARGUMENT after
 * reporting a picture that is not twice as wide as high; NOC_ERR_MEMORY: the scene is as it was. */
NOC_API noc_status noc_scene_set_environment(noc_scene *scene, const noc_image *map);

typedef struct noc_scene_info {
    /* of all that was not removed; models count once, whatever their instances */
    size_t triangles, vertices, meshes, materials;
    size_t models, instances;       /* bodies of lamps are instances, too */
    size_t instance_triangles;      /* that instances show: of each those of its model */
    size_t cars;                    /* of the instances those that noc_scene_set_time moves */
    double time;                    /* s, of the cars, as published or staged last */
    size_t textures, texture_bytes; /* with their pyramids */
    size_t windows, windows_lit;
    size_t light_slots; /* indices of lights are below it */
    size_t lights, lights_by_kind[NOC_LIGHT_KIND_COUNT], lights_inferred;
    size_t triangles_by_class[NOC_CLASS_COUNT];
    size_t transparent_triangles; /* whose material has a transmittance or is a cutout */
    size_t triangles_dropped;
    double bounds_min[3], bounds_max[3]; /* local; of all that is rendered but the empty country around a city */
    double origin[3];
    const char *crs; /* name for people, "" if none; owned by the scene: crs = local + origin */
    /* The CRS that the user speaks (the first input's, or noc_import_params.scene_crs), and where the local frame's
     * origin lies in it. That is crs and origin but where lengths in it are not those of the ground, as in Web
     * Mercator: the scene is then computed in a local CRS, and given_crs is reached by noc_scene_to_local, not by
     * adding an origin. */
    const char *given_crs;
    double given_origin[3];
    int environment_width;  /* pixels of the map around it as given; 0: it has none */
    double environment_lux; /* what that lights an open horizontal surface with at scale 1, lx */
    double maintenance;     /* noc_import_params.maintenance of its load: counted in the emission of its lamps */
    size_t memory_bytes;
} noc_scene_info;

NOC_API void noc_scene_get_info(const noc_scene *scene, noc_scene_info *info);

/* A name for all that pictures of a scene depend on but camera and parameters: surfaces, materials and lights, where
 * moving ones and instances are now. It is a hash of the numbers themselves, whichever files they came from, as 32
 * hexadecimal digits and a 0: equal scenes have equal names, others differ. Names of machines of another byte order, or
 * of another version, do not compare. Takes about a second for 15 million triangles. */
#define NOC_CONTENT_KEY 33
NOC_API void noc_scene_content(const noc_scene *scene, char key[NOC_CONTENT_KEY]);

/* Returns the name under which the load of the scene met the file that `path` names, by the same name, a link or any
 * other; NULL where the scene is not made of it. The files of a scene are its inputs, all that these name, whether it
 * was read or not (images, material libraries, buffers, parts of a Shapefile), and those of the parameters of the load.
 * A built city is made of its own file alone. *by, which may be NULL, gets the file that names it, NULL where the
 * caller of the load did. Both are valid as long as the scene. Call it before a file is written: a source that is
 * replaced is lost to its owner. */
NOC_API const char *noc_scene_find_source(const noc_scene *scene, const char *path, const char **by);

/* Height of the highest ground (terrain, road, sidewalk, green, building ground) under or over (x, y), local metres.
 * Instances are no ground.
 * Returns false where there is none, and where there was no memory to look for it, which is reported. */
NOC_API bool noc_scene_ground(const noc_scene *scene, double x, double y, double *z);

/* Pinhole camera. */
typedef struct noc_camera {
    double eye[3], target[3]; /* local metres */
    double up[3];
    double fov_deg; /* vertical field of view: noc_view_render takes 0.01..179, noc_scene_set_camera 1..170 */
} noc_camera;

#define noc_camera_default() ((noc_camera){ .up = { 0, 0, 1 }, .fov_deg = 50 })

/* Where a picture of width x height pixels shows the place xyz (local metres): x to the right, y down, the first
 * pixel's centre at 0.5, 0.5; and its distance from the eye (may be NULL). It may lie outside of the picture, and
 * behind something. false: behind the camera, or the camera looks nowhere. */
NOC_API bool noc_camera_project(const noc_camera *camera, int width, int height, const double xyz[3], double pixel[2],
                                double *distance);
/* The place that is seen at pixel, so far from the eye (NOC_AOV_DEPTH), local metres. NOC_ERR_ARGUMENT: the camera
 * looks nowhere. */
NOC_API noc_status noc_camera_unproject(const noc_camera *camera, int width, int height, const double pixel[2],
                                        double distance, double xyz[3]);

/* A ray in the scene's local frame, to be cast by noc_view_cast. */
typedef struct noc_ray {
    double origin[3];    /* local metres, within 10 000 km */
    double direction[3]; /* of any length but 0 */
    double far;          /* m from the origin: what is further is not hit; INFINITY: nothing is too far */
} noc_ray;

/* The ray through pixel, as noc_camera_project has it, without end. NOC_ERR_ARGUMENT: the camera looks nowhere. */
NOC_API noc_status noc_camera_ray(const noc_camera *camera, int width, int height, const double pixel[2], noc_ray *ray);

/* What a ray meets first. Indices are those of the scene at the time of the cast. */
typedef struct noc_hit {
    bool hit;         /* false: nothing; all else is 0 then, and indices are -1 */
    bool front;       /* it is met on the side from which its corners are seen counter-clockwise, as outside */
    bool shines;      /* the surface itself sends light to where the ray comes from */
    noc_class cls;    /* of the material */
    double distance;  /* m from the ray's origin */
    double place[3];  /* local metres */
    double normal[3]; /* unit, of the triangle, on the side that the ray comes from */
    int material;     /* for noc_scene_get_material */
    int object;       /* for noc_scene_object_name, as NOC_AOV_OBJECT has it */
    int instance;     /* for noc_scene_set_transform; -1: it stands in no instance */
    int light;        /* whose shape or window the surface is, though it be out; -1: of none */
    double texels;    /* a metre, along the surface, of the material's texture as it lies there; 0: none is seen */
    double image[2];  /* place in its image, as noc_mesh.uv says it */
} noc_hit;

/* noc_view_cast, or what does the same, as who lies below the renderer asks for rays; user is the caller's. */
typedef noc_status (*noc_cast_fn)(void *user, const noc_ray *rays, size_t count, noc_hit *hits);

/* A place and where a photograph shows it. */
typedef struct noc_camera_point {
    double xyz[3];   /* local metres */
    double pixel[2]; /* of the photograph, as in noc_camera_project; it may lie outside */
} noc_camera_point;

/* The camera that took a photograph of width x height pixels, from 4 to 10 000 places in it: the one of all eyes,
 * directions and fields of view (2..150 degrees) that shows them nearest to their pixels, in the mean of squares; of
 * several that do so equally, the one held most upright. Its principal point is the photograph's centre, and its pixels
 * are square: neither a crop nor a fisheye. Places that do not lie on a plane, spread over the photograph, are best.
 * start: a camera that is about right, or NULL: none is needed. residual_px (may be NULL): root of the mean squared
 * distance between pixels and where the camera shows the places, pixels.
 * NOC_ERR_ARGUMENT after reporting points from which none follows (too few, on a line), that no camera sees so (a tenth
 * of the diagonal off), or that many do (a plane that is seen squarely); *camera is as it was. */
NOC_API noc_status noc_camera_align(const noc_camera_point *points, size_t count, int width, int height,
                                    const noc_camera *start, noc_camera *camera, double *residual_px, noc_log *log);

typedef enum noc_viewpoint {
    NOC_VIEWPOINT_STREET,
    NOC_VIEWPOINT_AERIAL,
    NOC_VIEWPOINT_OVERVIEW,
    NOC_VIEWPOINT_OWN
} noc_viewpoint;

/* The camera that a scene comes with: built-in scenes and glTF files may set one, and the first one stays. The eye must
 * not be the target, fov_deg is within 1..170. */
NOC_API noc_status noc_scene_set_camera(noc_scene *scene, const noc_camera *camera);

/* A camera derived from the city: street stands at eye height in open ground near lamps and looks along it, aerial
 * flies over the roofs, overview sees all that stands on the land, or the land where nothing does; own is the one that
 * the scene comes with, street where it has none. Meshes that are no city have no street: a room is then seen from
 * inside, anything else as by overview. aspect = width / height of the picture. */
NOC_API noc_status noc_scene_camera(const noc_scene *scene, noc_viewpoint view, double aspect, noc_camera *camera);

/* The built-in procedural night city. The same seed and size give the same city on every machine, with its windows lit
 * as noc_window_default_params() has it until noc_scene_set_windows, or a load, says otherwise. NULL params are the
 * defaults. */
typedef struct noc_city_params {
    uint32_t seed;
    double size; /* edge of the square it covers, metres, 150..5000 */
} noc_city_params;

#define NOC_CITY_DEFAULTS(set) set(seed, 1) set(size, 420)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_city_params, noc_city_default_params, NOC_CITY_DEFAULTS)
#else
#define noc_city_default_params() ((noc_city_params){ NOC_CITY_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

NOC_API noc_status noc_scene_add_city(noc_scene *scene, const noc_city_params *params);

/* Built-in scenes, each with a camera of its own but the city. The last four are of the character of those that
 * Gardishyan (2025, section 5.2) compares light sampling on: cityscape is some streets under strings of coloured
 * lights, mess is small coloured lights on and among many objects, single is one detailed object by one light, atrium a
 * courtyard of many triangles by one light. Equal params give equal scenes on every machine. */
typedef struct noc_builtin_params {
    noc_city_params city; /* of city */
    uint32_t seed;        /* of cityscape and mess */
    int lights;           /* of mess: how many, 1..1000000 */
} noc_builtin_params;

#define NOC_BUILTIN_DEFAULTS(set) set(seed, 1) set(lights, 3000)
#ifdef __cplusplus
#define NOC_BUILTIN_ALL_DEFAULTS(set) set(city, noc_city_default_params()) NOC_BUILTIN_DEFAULTS(set)
NOC_DEFAULT_PARAMS(noc_builtin_params, noc_builtin_default_params, NOC_BUILTIN_ALL_DEFAULTS)
#else
#define noc_builtin_default_params()                                                                                   \
    ((noc_builtin_params){ .city = { NOC_CITY_DEFAULTS(NOC_DEFAULT_IN_C) }, NOC_BUILTIN_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Their names, NULL-ended: "city", "cityscape", "mess", "single", "atrium". */
NOC_API const char *const *noc_builtin_names(void);
/* Adds the scene of that name; params may be NULL for the defaults. An unknown name is NOC_ERR_ARGUMENT. */
NOC_API noc_status noc_scene_add_builtin(noc_scene *scene, const char *name, const noc_builtin_params *params);

#ifdef __cplusplus
}
#endif
#endif
