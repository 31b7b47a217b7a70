/* scene: the flat arrays that backends render. Filled through the public functions of nocturne/scene.h. */
#ifndef NOC_SCENE_H
#define NOC_SCENE_H

#include "base/base.h"
#include "core/records.h"
#include "scene/body.h"
#include <nocturne/scene.h>

#include <pthread.h>

#define NOC_NO_LIGHT NO_LIGHT

/* Labels of surfaces: classes by their numbers, then walls by what became of them (noc_wall_verdict less 1). */
#define NOC_LABEL_COUNT (NOC_CLASS_COUNT + NOC_WALL_VERDICT_COUNT - 1)
extern const char *const noc_label_names[NOC_LABEL_COUNT];

/* The same records for C and shaders (core/records.h). */
typedef light_record noc_light_record;
typedef material_record noc_material_record;
typedef facade_record noc_facade_record;
_Static_assert((int)LIGHT_SPHERE == NOC_LIGHT_SPHERE && (int)LIGHT_DISC == NOC_LIGHT_DISC &&
                   (int)LIGHT_TRIANGLE == NOC_LIGHT_TRIANGLE && (int)LIGHT_PARALLELOGRAM == NOC_LIGHT_PARALLELOGRAM &&
                   (int)LIGHT_POINT == NOC_LIGHT_POINT && (int)LIGHT_SPOT == NOC_LIGHT_SPOT,
               "a record's kind is a noc_light_kind");
_Static_assert((int)WRAP_REPEAT == NOC_WRAP_REPEAT && (int)WRAP_MIRROR == NOC_WRAP_MIRROR &&
                   (int)WRAP_CLAMP == NOC_WRAP_CLAMP && NOC_TEXTURE_SIDE < 1 << 15,
               "a texture's head has its wrap and all its levels");
/* Flags of a light; from bit NOC_LIGHT_GROUP on its group. */
#define NOC_LIGHT_TWO_SIDED LIGHT_TWO_SIDED
#define NOC_LIGHT_INFERRED LIGHT_INFERRED
#define NOC_LIGHT_MOVES LIGHT_MOVES /* of the moving half, else of the static one */
#define NOC_LIGHT_FREE 8u           /* a slot without a light: no emission, never drawn */
#define NOC_LIGHT_OWNED 16u         /* comes and goes with a mesh or an instance */
#define NOC_LIGHT_LATER 32u /* stands, and is of the moving half: it was added since what stands was last settled */
#define NOC_LIGHT_GROUP LIGHT_GROUP /* before it the profile's number: LIGHT_PROFILE */
static inline bool noc_light_has_profile(const noc_light_record *r) { return r->flags & LIGHT_PROFILE_BITS; }
static inline uint32_t noc_light_group(const noc_light_record *r) { return r->flags >> NOC_LIGHT_GROUP; }
/* What is taken for a lamp: windows and emissive surfaces are flat, headlamps move. */
static inline bool noc_light_is_lamp(const noc_light_record *r) {
    return r->kind != LIGHT_TRIANGLE && r->kind != LIGHT_PARALLELOGRAM && !(r->flags & NOC_LIGHT_MOVES);
}
/* Is a light of these flags in the half that stands? */
static inline bool noc_light_stands(uint32_t flags) { return !(flags & (NOC_LIGHT_MOVES | NOC_LIGHT_LATER)); }

/* Meshes lie one after the other in the arrays. One of a model is in the model's coordinates, and what it shows in
 * triangle_light are lights of the model. */
typedef struct noc_scene_mesh {
    uint32_t first_triangle, triangle_count, first_vertex; /* its vertices end where the next mesh's begin */
    int material;
    uint16_t model; /* 0: the world */
    uint16_t group;
    bool removed;     /* its ranges are dead */
    float aloft;      /* until the commit: m above the ground, where it begins, so that it tells nothing of it; or 0 */
    bool land;        /* until the commit: ground that is no building's */
    bool panes;       /* triangles of it show windows: what it is made of does not shine */
    uint32_t uv;      /* place + 1 of its first vertex in `uv`; 0: it has none */
    uint32_t made;    /* versions.geometry of the commit that filled it */
    const char *name; /* the scene's */
} noc_scene_mesh;

enum { NOC_WINDOW_OFTEN = 4096 };
/* A window: a light that comes and goes with its mesh. */
typedef struct noc_scene_window {
    uint32_t light;
    float emission[3];   /* where it is lit */
    float level;         /* lit where the share of its kind is above it */
    uint8_t kind;        /* noc_window_kind */
    uint8_t removed : 1; /* with its mesh: the light may be another one now */
    uint8_t part : 1;    /* a further part of the pane that the window before it is of */
    uint8_t none : 6;    /* 0 */
    uint16_t often;      /* the share of its kind is times this over NOC_WINDOW_OFTEN here, at most 1 */
    uint32_t facade;     /* number + 1 of the facade that it is in; 0: triangles of its mesh show it */
} noc_scene_window;
_Static_assert(sizeof(noc_scene_window) == 28, "it has no gaps: built cities hold it as it is");

/* Meshes and lights in coordinates of their own. Published by a commit it does not change any more. */
typedef struct noc_scene_model {
    const char *name;
    double bounds_min[3], bounds_max[3]; /* of its triangles; min > max where it has none */
    NOC_ARRAY(noc_light_record) lights;
    NOC_ARRAY(const char *) light_names; /* parallel to lights */
    size_t shining;                      /* triangles that the commit at work makes lights of */
    uint32_t instances;                  /* that show it, and bodies */
    uint32_t first_mesh, end_mesh;       /* its meshes lie between these; 0, 0: anywhere */
    uint32_t shown;                      /* lights that bodies of it show: those of its triangles' numbers */
} noc_scene_model;

/* A model placed in the world. */
typedef struct noc_scene_instance {
    uint32_t model;      /* 0: a free slot */
    float transform[12]; /* model to world, rows of 3x4: rigid and one scale */
    uint32_t *lights;    /* [lights of the model] each one's slot; owned */
} noc_scene_instance;

/* Where an instance is; model 0: there is none in the slot. */
typedef struct noc_scene_place {
    uint32_t model;
    float transform[12];
} noc_scene_place;

/* A place on a route. Legs lie one behind the other; the first stop of a leg is 0 m along it, and is reached in the
 * second in which the leg before ends. */
typedef struct noc_scene_stop {
    double seconds; /* from the route's beginning; never less than the stop's before it */
    float p[3];
    float along; /* m from the leg's beginning */
} noc_scene_stop;

typedef struct noc_scene_route {
    size_t first, count; /* of the scene's stops: two or more, and the last one is reached in more than 0 s */
} noc_scene_route;

/* An instance that takes a route, again and again. */
typedef struct noc_scene_car {
    uint32_t instance, route;
    double start; /* s from the route's beginning, at time 0 */
    double axles; /* m between its axles, both of which are on the route */
} noc_scene_car;

/* A road of a map, by its name: the middle of its carriageway. */
typedef struct noc_scene_street {
    const char *name, *id;
    float width;           /* m */
    uint32_t first, count; /* points */
} noc_scene_street;

typedef struct noc_scene_group {
    const char *name;
    float scale[3];
    float colour[3];       /* of luminance 1, of all its lights; 0,0,0: each has its own */
    bool scaled, coloured; /* told so by the commit at work, */
    bool edited;           /* and otherwise than before */
} noc_scene_group;

/* What lights with that profile need to know of it. */
typedef struct noc_scene_profile {
    const char *name;
    float peak;     /* greatest intensity, cd a lumen */
    float strength; /* peak of the light that falls off with the cosine, or of the even one where it shines upward, too,
                     * whose intensity has the same mean square over all directions, cd a lumen */
    bool upward;    /* sends something beyond 90 degrees of its axis: such lights are two-sided, others never are */
} noc_scene_profile;

/* Where a texture begins in texels, and a hash of what it holds. */
typedef struct noc_scene_texture {
    uint32_t place;
    uint64_t content[2];
} noc_scene_texture;

/* Of the triangles between first and end none are the city's: the backdrop, models, removed meshes. before: so many
 * triangles of earlier gaps. */
typedef struct noc_scene_gap {
    size_t first, end, before;
} noc_scene_gap;

enum { NOC_SHAPE_KINDS = NOC_LIGHT_PARALLELOGRAM + 1 }; /* kinds of lights that are seen */
_Static_assert(NOC_LIGHT_SPHERE == 0 && NOC_SHAPE_KINDS == 4, "points and spots come last");
#define NOC_NOT_OF_LIGHTS UINT32_MAX /* a material that noc_scene_add_material made for the program */

/* Which places of an array are free. Who stages an addition gets the place that commit will give it. */
typedef struct noc_slots {
    NOC_ARRAY(uint32_t) free, released; /* released: by the commit at work, free for the next transaction */
    uint32_t taken, fresh;              /* of the free ones, from the end on; and beyond the array's end */
} noc_slots;

typedef enum noc_edit_kind {
    NOC_EDIT_MATERIAL,
    NOC_EDIT_CLASS,
    NOC_EDIT_GROUP,
    NOC_EDIT_GROUP_COLOUR,
    NOC_EDIT_EMISSION,
    NOC_EDIT_ADD_LIGHT,
    NOC_EDIT_MOVE_LIGHT,
    NOC_EDIT_REMOVE_LIGHT,
    NOC_EDIT_REMOVE_MESH,
    NOC_EDIT_ADD_INSTANCE,
    NOC_EDIT_TRANSFORM,
    NOC_EDIT_REMOVE_INSTANCE,
    NOC_EDIT_WINDOWS,
} noc_edit_kind;

/* Which windows are lit: fields of noc_window_params. */
typedef struct noc_window_switch {
    double lit, hour;
    uint32_t seed;
} noc_window_switch;

/* One staged edit. */
typedef struct noc_edit {
    noc_edit_kind kind;
    uint32_t index;   /* of what is edited */
    uint32_t model;   /* instances: that one's */
    uint32_t *lights; /* of an added instance; made by the commit at work, else NULL */
    const char *name;
    union {
        noc_material material;
        float rgb[3];
        float transform[12];
        noc_window_switch windows;
        noc_light_record light;
    };
} noc_edit;

/* What is around the scene, as core/environment.h has it: linear Rec.709 as in the file, never negative. */
typedef struct noc_environment {
    int given;                     /* columns of the picture that was given */
    int width, height;             /* of what is seen */
    int light_width, light_height; /* of what lights */
    float *texels, *light;         /* 3 a texel; light may be texels */
    double power;                  /* of what lights: luminance summed over solid angles, cd/m2 sr */
    double lux;                    /* of what lights, on an open horizontal surface */
    size_t bytes;
} noc_environment;
enum { NOC_ENVIRONMENT_SEEN = 8192, NOC_ENVIRONMENT_LIGHTS = 2048 }; /* columns at most, where they can be halved */
enum { NOC_ENVIRONMENT_TEXELS = 1 << 23 };                           /* that light: fewer than these */

/* How often commits have changed what. A follower compares with what it has seen. */
/* What vertical rays have done before the first commit. Atomic: several threads may ask. */
typedef struct noc_ground_work {
    size_t rays, looks; /* looks: at triangles */
    size_t cut;         /* rays that have ended early, as too many triangles lie over one another */
} noc_ground_work;

typedef struct noc_scene_versions {
    uint64_t commits;     /* that changed anything */
    uint64_t geometry;    /* meshes added or removed, of the world or in new models */
    uint64_t instances;   /* added, removed, moved */
    uint64_t materials;   /* added or changed */
    uint64_t lights;      /* added or removed: a slot holds another light than before */
    uint64_t moved;       /* places, directions and shapes of lights of the moving half */
    uint64_t emission;    /* what a light emits in all */
    uint64_t standing;    /* of lights and emission those commits that changed the static half */
    uint64_t settled;     /* the static half is to be made anew; where it is not, its lights only went dark */
    uint64_t environment; /* another map */
} noc_scene_versions;

/* A number that is the same while rays meet the same. */
static inline uint64_t noc_scene_shape(const noc_scene_versions *v) { return v->geometry + v->instances; }

typedef struct noc_range {
    size_t first, end; /* first >= end: nothing */
} noc_range;

typedef struct noc_rgb {
    float v[3];
} noc_rgb;

/* sources.c: the files that a scene is made of. Added by threads that read. */
typedef struct noc_scene_source {
    const char *path, *by; /* by: the file that names it; NULL: the caller of the load does */
} noc_scene_source;
typedef struct noc_scene_sources {
    pthread_mutex_t lock;
    noc_map of; /* device and number of a file -> place in list */
    NOC_ARRAY(noc_scene_source) list;
    noc_arena texts;
    bool refused; /* memory was, to one of them, which is missing; stays set */
} noc_scene_sources;
void noc_scene_sources_free(noc_scene_sources *s);
/* Notes that the scene is made of this file, or that the file `by` names it. Ignores what is no regular file, or is
 * noted already. Thread-safe. Sets scene->sources.refused where memory is refused. by: NULL: nobody else names it. */
void noc_scene_add_source(noc_scene *scene, const char *path, const char *by);

struct noc_scene {
    noc_log *log;
    double origin[3];
    char *crs_name;      /* for people */
    struct geo_crs *crs; /* set by the importer; owned; NULL if none */
    /* The CRS that the user speaks, where the scene is computed in another one: crs is then a local CRS. */
    struct geo_crs *given_crs; /* set by the importer; owned; NULL where crs is it */
    char *given_crs_name;
    double given_origin[3]; /* where the local frame's origin lies in it */
    void (*crs_free)(struct geo_crs *);
    /* Of a built city, which makes them when they are asked for: what they are made from, in its pages. NULL: none. */
    const char *crs_kept, *given_crs_kept;
    bool lit_elsewhere; /* no lamp stands in the city: views look at its buildings */
    char *without_crs;  /* the input that settled the place and names no CRS; NULL where there is none */

    /* Triangle soup: vertices are 3 floats (Embree needs 4 bytes of padding after the last: reserve one more). */
    NOC_ARRAY(float) positions;            /* 3 a vertex */
    NOC_ARRAY(uint32_t) indices;           /* 3 a triangle */
    NOC_ARRAY(uint32_t) triangle_material; /* index into material_records */
    NOC_ARRAY(uint32_t) triangle_light;    /* light that this triangle shows, or NOC_NO_LIGHT */
    NOC_ARRAY(noc_scene_mesh) meshes;
    NOC_ARRAY(float) uv; /* 2 a vertex of the meshes that have a place in an image */
    NOC_ARRAY(noc_material) materials;
    NOC_ARRAY(noc_material_record) material_records; /* parallel to materials */
    NOC_ARRAY(const char *) material_names;          /* of the first of them; only who edits looks at it */
    NOC_ARRAY(uint32_t) material_uses;               /* parallel: published meshes of it, or NOC_NOT_OF_LIGHTS */
    NOC_ARRAY(noc_light_record) lights;              /* data is 64-byte aligned after commit */
    NOC_ARRAY(const char *) light_names;             /* parallel to lights, entries may be NULL */
    NOC_ARRAY(noc_rgb) light_made;                   /* emission before the group's scale; filled where `scaled` */
    NOC_ARRAY(uint32_t) moving;                      /* lights of the moving half, ascending */
    NOC_ARRAY(noc_scene_window) windows;             /* ascending by their lights */
    NOC_ARRAY(uint8_t) walls;                        /* noc_wall_verdict of triangles; of those behind its end UNSEEN */
    NOC_ARRAY(uint32_t) triangle_facade;             /* number + 1 of a wall's facade, 0: none; and so behind its end */
    NOC_ARRAY(noc_facade_record) facades;
    NOC_ARRAY(uint32_t) facade_cells;  /* the window's light of each cell, or NOC_NO_LIGHT */
    uint64_t facades_changed;          /* versions.geometry of the last commit that took windows out of a facade */
    NOC_ARRAY(noc_scene_model) models; /* model m is at m - 1 */
    NOC_ARRAY(noc_scene_instance) instances;
    NOC_ARRAY(noc_scene_body) bodies;     /* ascending by their lights; none comes or goes after the first commit */
    NOC_ARRAY(noc_body_link) body_links;  /* bodies by cells of the ground, for vertical rays */
    NOC_ARRAY(uint32_t) body_cells;       /* of each bucket the first link's place + 1; a power of two of them */
    NOC_ARRAY(noc_scene_kind) body_kinds; /* a hash table, a power of two of slots */
    size_t body_kinds_taken;
    NOC_ARRAY(noc_scene_stop) stops;
    NOC_ARRAY(noc_scene_route) routes;
    NOC_ARRAY(noc_scene_car) cars; /* ascending by their instances */
    double time;                   /* s, of the cars */
    bool cars_hidden;              /* noc_scene_show_cars */
    NOC_ARRAY(noc_scene_street) streets;
    NOC_ARRAY(float) street_points;        /* 2 each */
    NOC_ARRAY(noc_scene_group) groups;     /* group g is at g - 1; only who edits looks at them */
    NOC_ARRAY(noc_scene_profile) profiles; /* profile p is at p - 1 */
    NOC_ARRAY(float) profile_cells;        /* core/profile.h; data is 16-byte aligned */
    NOC_ARRAY(uint32_t) texels;            /* core/texture.h */
    NOC_ARRAY(noc_scene_texture) textures; /* texture t is at t - 1 */
    NOC_ARRAY(noc_scene_gap) gaps;         /* ascending, none touches the next */
    noc_environment *environment;          /* NULL: none */
    noc_arena names;
    noc_scene_sources sources;
    size_t triangles_dropped, triangles_flat /* of these, for they have no area */, lights_inferred;
    double bounds_min[3], bounds_max[3];
    uint32_t backdrop_first, backdrop_count; /* triangles around the city: drawn, but no part of it */
    noc_camera own_camera;                   /* fov_deg 0: none */
    bool scaled;                             /* a group's scale has been another than 1 */
    bool wet;                                /* its load has made roads and ground wet */
    double maintenance;                      /* what its load gives lamps of their flux, 0 to 1 */
    uint32_t class_said;                     /* bits of classes that were set as a whole: */
    noc_material class_looks[NOC_CLASS_COUNT];
    bool committed;
    bool lets_through; /* a material does; once it is true it stays */
    noc_scene_versions versions;
    noc_range dirty_lights, dirty_materials; /* records that the last commit that changed anything wrote or added */
    /* What is staged: the editing thread's alone. Before the first commit meshes, materials and lights go straight
     * into the arrays above. */
    NOC_ARRAY(noc_edit) edits;
    noc_scene *added;             /* arrays that commit appends; its lights are empty. NULL: never needed */
    noc_scene *reshaped;          /* shapes that come in place of removed ones; NULL: none */
    NOC_ARRAY(uint32_t) reshapes; /* of those arrays, parallel to meshes: each one's place in the scene */
    noc_slots light_slots, instance_slots;
    noc_slots shapes[NOC_SHAPE_KINDS], light_materials; /* meshes and materials of lights that went */
    size_t first_later;                                 /* meshes of the first commit */
    NOC_ARRAY(uint32_t) dark_slots; /* of lights that stood: no other light comes there before what stands is settled */
    size_t later;                   /* lights with NOC_LIGHT_LATER */
    noc_arena later_names;          /* of all that is named after the first commit */
    size_t later_bytes;             /* of them, at the last commit */
    struct noc_scene_lock *lock;
    void *pages; /* of a built city, which arrays and names lie in (keep.h); noc_free_pages */
    size_t page_bytes;
    bool no_memory;            /* was refused and reported: nothing more is added, and it cannot be committed */
    struct noc_ground *ground; /* built on first use of noc_scene_ground; freed with the scene */
    noc_ground_work ground_work;
};

/* Adds what lies around the city, to the horizon. It is rendered and that is all: bounds, cameras and vertical rays do
 * not know it. A scene has one; false, and nothing happens, if it has one already or the mesh was refused. */
bool noc_scene_add_backdrop(noc_scene *scene, const noc_mesh *mesh);

/* Triangles of the city itself, without the backdrop, models, and what was removed: their number, and the i-th. */
static inline size_t noc_scene_city_triangles(const noc_scene *s) {
    const noc_scene_gap *last = s->gaps.len ? &s->gaps.data[s->gaps.len - 1] : NULL;
    return s->triangle_light.len - (last ? last->before + (last->end - last->first) : 0);
}
size_t noc_scene_city_triangle(const noc_scene *s, size_t i);
/* Is the mesh of the city itself? */
static inline bool noc_mesh_in_city(const noc_scene *s, const noc_scene_mesh *m) {
    return !m->removed && !m->model && !(s->backdrop_count && m->first_triangle == s->backdrop_first);
}
/* Is there something behind its surface to be seen? It stays so. */
static inline bool noc_material_lets_through(const noc_material *m) { return m->transmittance > 0 || m->cutout; }
/* Is it of closures, which are counted and that is all? A material stays a closure, and others never become one. */
static inline bool noc_mesh_closes(const noc_scene *s, const noc_scene_mesh *m) {
    return s->materials.data[m->material].cls == NOC_CLASS_CLOSURE;
}
/* Is it of panes, which rays pass in part? */
static inline bool noc_mesh_lets_through(const noc_scene *s, const noc_scene_mesh *m) {
    return noc_material_lets_through(&s->materials.data[m->material]);
}
/* Triangles behind all gaps that are no city's; room for one gap was reserved. */
void noc_scene_add_gap(noc_scene *s, size_t first, size_t count);
/* Index of the mesh that a triangle is of. */
size_t noc_scene_mesh_of(const noc_scene *s, size_t triangle);
static inline size_t noc_mesh_end_vertex(const noc_scene *s, size_t mesh) {
    return mesh + 1 < s->meshes.len ? s->meshes.data[mesh + 1].first_vertex : s->positions.len / 3;
}

/* lock.c: who reads a scene and who publishes edits. A frame holds it for reading from its first look at the scene to
 * its last. It lets a commit that waits go first, so that frames one after the other cannot keep it out; a thread must
 * not hold two. Other readers only wait for a commit at work, and may ask while their thread holds a frame. */
struct noc_scene_lock *noc_scene_lock_create(void) NOC_MUST_USE; /* NULL: no memory */
void noc_scene_lock_destroy(struct noc_scene_lock *lock);
void noc_scene_lock_frame(const noc_scene *s);
void noc_scene_unlock_frame(const noc_scene *s);
void noc_scene_lock_read(const noc_scene *s);
void noc_scene_unlock_read(const noc_scene *s);
void noc_scene_lock_commit(noc_scene *s);
void noc_scene_unlock_commit(noc_scene *s);

/* Where a mesh, a material or a model goes: the scene, or what its next commit appends; NULL after reporting that there
 * is no memory. */
noc_scene *noc_scene_adding(noc_scene *s);
/* A copy in the scene's names, of NULL too. false: no memory, reported. */
bool noc_scene_keep_name(noc_scene *s, const char *name, const char **kept);
/* model.c: a rotation and one scale to a part in ten thousand, no mirror, within the world. slack: 1, and more where
 * it was rounded since. */
bool noc_transform_fits(const double transform[12], double slack);
/* The model of this number, published or staged; NULL where there is none. */
noc_scene_model *noc_scene_model_of(const noc_scene *s, int model);
/* The group of that name, which is added where there is none. 0: memory was refused, or there are too many groups. */
int noc_scene_group_named(noc_scene *s, const char *name);
/* Can a mesh or light of that group be added to that model? Else `wrong` says why not, naming the number. */
enum { NOC_FAULT = 80 };
bool noc_scene_takes(const noc_scene *s, int group, int model, char wrong[NOC_FAULT]);
/* Published and staged. */
static inline size_t noc_scene_material_count(const noc_scene *s) {
    return s->materials.len + (s->added ? s->added->materials.len : 0);
}
/* Of an index that is below that. */
static inline const noc_material *noc_scene_material_at(const noc_scene *s, int material) {
    size_t i = (size_t)material, have = s->materials.len;
    return i < have ? &s->materials.data[i] : &s->added->materials.data[i - have];
}
/* Places in arrays: see noc_slots. have: the array's length. */
uint32_t noc_slot_next(const noc_slots *slots, size_t have);
void noc_slot_take(noc_slots *slots);

/* scene.c: parts of noc_scene_add_mesh. Arrays without anything in them; room for a mesh; its triangles that are any
 * good, behind those that `to` has. */
noc_scene *noc_scene_create_arrays(void) NOC_MUST_USE;
bool noc_scene_reserve_mesh(noc_scene *to, const noc_mesh *mesh);
void noc_scene_push_triangles(noc_scene *to, const noc_mesh *mesh, double lo[3], double hi[3]);

/* material.c: adds one that only lights show. Its index, or -1 after reporting. */
int noc_scene_add_light_material(noc_scene *scene, const noc_material *m);

/* What is wrong with a material, NULL if nothing. */
const char *noc_material_fault(const noc_scene *scene, const noc_material *m);
noc_material_record noc_material_record_of(const noc_material *m);
static inline bool noc_material_shines(const noc_material *m) { /* closures are not rendered, so they do not either */
    return (m->emission[0] > 0 || m->emission[1] > 0 || m->emission[2] > 0) && m->cls != NOC_CLASS_CLOSURE;
}
/* texture.c: words of the scene's texels that an image of that size takes */
size_t noc_texture_words(int width, int height);
/* Where a triangle's corners lie in the image of its material's texture; false: it shows none. */
bool noc_scene_image_corners(const noc_scene *scene, size_t triangle, float at[3][2]);
/* Does it show a light that was added as one? It emits as that does, and reflects nothing. */
bool noc_material_of_light(const noc_material *m);

/* light.c */
const char *noc_light_fault(const noc_light *l); /* what is wrong with it, NULL if nothing */
noc_light_record noc_light_record_of(const noc_scene *scene, const noc_light *l);

/* profile.c: what is wrong with a light's profile, NULL if nothing; and the profile in its record: the frame, the
 * number, the greatest intensity. */
const char *noc_light_profile_fault(const noc_scene *scene, const noc_light *l);
void noc_light_set_profile(const noc_scene *scene, const noc_light *l, noc_light_record *r);

/* The light that a triangle of these corners is. */
noc_light_record noc_triangle_light(const float *a, const float *b, const float *c, const noc_material *material);
double noc_double_area(const float *a, const float *b, const float *c); /* twice a triangle's area */

typedef struct noc_changes noc_changes;
/* reuse.c: stages the shape of a light where one of a removed light was, if there is such a place. */
noc_status noc_shape_stage(noc_scene *s, const noc_mesh *shape, uint32_t light, const char *name, bool *staged);
/* Commit: puts those there. None of these fails. */
void noc_shapes_put(noc_scene *s, noc_changes *c);
void noc_shape_release(noc_scene *s, size_t mesh); /* of a light that went */
/* Meshes of a light's material that come and go. */
void noc_material_use(noc_scene *s, const noc_scene_mesh *m);
void noc_material_drop(noc_scene *s, const noc_scene_mesh *m);

/* relight.c: slots of lights, and what commits put into them. None of these fails: commit has reserved. */
struct noc_changes {
    bool geometry, instances, materials, lights, moved, emission, standing, settled;
    bool moving_came;            /* to the moving half */
    bool shape_left;             /* a light with a shape was removed */
    bool mesh_left, ground_left; /* gaps are others; the ground's grids are stale */
};
uint32_t noc_light_add_slot(noc_scene *s);  /* behind all others */
uint32_t noc_light_take_slot(noc_scene *s); /* a free one, or that */
void noc_light_put(noc_scene *s, uint32_t slot, const noc_light_record *made, const char *name, noc_changes *c);
void noc_light_release(noc_scene *s, uint32_t slot, noc_changes *c);
/* Its record as made, which keeps its flags and is scaled by its group. */
void noc_light_change(noc_scene *s, uint32_t slot, const noc_light_record *made, noc_changes *c);
noc_light_record noc_light_made(const noc_scene *s, uint32_t slot); /* its record before the group's scale */
/* By the last scales that are staged for groups: one look at all lights, however many there are. */
void noc_lights_scale(noc_scene *s, noc_changes *c);
/* After all edits: the list of those of the moving half; and, where it is time, what stands is settled. */
void noc_lights_settle(noc_scene *s, noc_changes *c);
/* Makes the triangles of a mesh into lights, or anew, or puts them out, as its material says. */
void noc_mesh_relight(noc_scene *s, const noc_scene_mesh *mesh, noc_changes *c);
/* The same for a mesh of a model that has no instance yet: its triangles become lights of the model. */
void noc_model_relight(noc_scene *s, const noc_scene_mesh *mesh);
static inline void noc_range_add(noc_range *r, size_t i) {
    *r = r->first < r->end ? (noc_range){ NOC_MIN(r->first, i), NOC_MAX(r->end, i + 1) } : (noc_range){ i, i + 1 };
}

/* environment.c: sine of the elevation of a row's upper edge, of so many rows. */
double noc_environment_sine(int row, int rows);
void noc_environment_free(noc_environment *e); /* NULL is allowed */
/* noc_scene_set_environment, whose messages call the picture that. */
noc_status noc_scene_name_environment(noc_scene *scene, const noc_image *map, const char *name);
/* Of a picture that is twice as wide as high, and fits: can be taken down to as few texels as are drawn from. bad:
 * pixels that are not light. NULL: no memory. */
noc_environment *noc_environment_make(const noc_image *map, size_t *bad);
bool noc_environment_fits(int width, int height);

/* window.c */
static inline noc_wall_verdict noc_scene_wall(const noc_scene *s, size_t triangle) {
    return triangle < s->walls.len ? (noc_wall_verdict)s->walls.data[triangle] : NOC_WALL_UNSEEN;
}
/* Before the first commit: room for verdicts on all triangles that are there, and for their facades, which may be
 * written then. false: no memory, reported. */
bool noc_scene_reserve_walls(noc_scene *s);
typedef struct noc_pane {
    const uint32_t *triangles; /* that show it, as numbers in the mesh; NULL: it is in window.facade */
    size_t triangle_count;
    noc_light shape;         /* its emission is not read */
    noc_scene_window window; /* its light is set */
} noc_pane;
/* Before the first commit: makes triangles of a mesh, or cells of a facade that noc_scene_facade_takes, the window that
 * the pane says; dark. false: no memory, reported. */
bool noc_scene_add_window(noc_scene *s, int mesh, const noc_pane *pane);

/* Before the first commit: lit or dark, as params say. */
void noc_scene_light_windows(noc_scene *s, const noc_window_params *params);
void noc_windows_switch(noc_scene *s, const noc_window_switch *to, noc_changes *c);
/* The number under which the share must be for a window to be dark: that which it was made with, where the seed is the
 * default, else one that this and the seed decide. Windows that were made with one number share that of any seed; 1
 * stays 1. */
double noc_window_level(float level, uint32_t seed);
enum { NOC_WINDOW_SEED = 1 };                                        /* the default, which windows are made with */
noc_scene_window *noc_window_of(const noc_scene *s, uint32_t light); /* NULL: the light is no window's, and never was */
void noc_window_first(const noc_scene_window *w, float e[3]);        /* its emission by the default noc_window_params */
void noc_window_forget(noc_scene *s, uint32_t light);                /* a light that goes; it need not be a window's */
const char *noc_window_fault(const noc_window_params *p); /* what is wrong with lit_windows or hour, NULL if nothing */

/* model.c */
/* A model's light where the transform puts it. */
noc_light_record noc_light_placed(const noc_light_record *light, const float transform[12]);
/* Bounds of a model where it stands, joined to lo..hi. */
void noc_join_instance_bounds(const noc_scene *s, const noc_scene_instance *instance, double lo[3], double hi[3]);

/* traffic.c */
/* Before the first commit: a route, whose stops are copied. Its number, or -1 after reporting: no memory. */
int noc_scene_add_route(noc_scene *s, const noc_scene_stop *stops, size_t count);
/* An instance of the model that takes it, where it is at the scene's time. false after reporting. */
bool noc_scene_add_car(noc_scene *s, int model, int route, double start, double axles);
/* A car's transform at a time: its x is forward, y left and z up, and its origin lies on the ground between its axles.
 */
void noc_car_pose(const noc_scene *s, const noc_scene_car *car, double time, double m[12]);
void noc_car_forget(noc_scene *s, uint32_t instance); /* one that goes; it need not be a car's */

/* street.c: before the first commit, a street of those points, 3 numbers each, which are copied. false after reporting
 * that there is no memory. */
bool noc_scene_add_street(noc_scene *s, const noc_scene_street *street, const double *xyz, size_t count);

/* Bytes that it takes, about. */
size_t noc_scene_bytes(const noc_scene *s);

/* query.c: index of the object that a triangle is of, for noc_scene_object_name. Instances show their model's; bodies
 * come behind the meshes. */
size_t noc_scene_object_of(const noc_scene *scene, uint32_t triangle, uint32_t instance);

/* Luminous flux of a light over all directions that it emits to, lm. */
double noc_light_flux(const noc_light_record *light);

/* The longest way between two corners of a triangle or parallelogram, m. */
float noc_flat_size(const noc_light_record *light);

/* Reports once that there is no memory for more of a scene, which takes nothing more then and is not committed.
 * NOC_ERR_MEMORY. */
noc_status noc_scene_out_of_memory(noc_scene *scene);

/* ground.c: grid over the triangles for vertical rays. Made at the first query, and kept up to date by the next ones:
 * asking and adding meshes in turn is cheap. Thread-safe while the scene is not being changed. Where memory is refused,
 * rays hit nothing; that is reported, and a scene in the making is out of memory then. */
void noc_ground_free(struct noc_ground *ground);
/* Makes it now: NOC_ERR_MEMORY, or rays of a scene that is not changed any more will not ask for memory. */
noc_status noc_ground_ready(const noc_scene *scene);
/* What vertical rays have cost so far, until the first commit: triangles that were looked at, and 8 a ray. Together
 * they may look at noc_ground_most_looks, 200 a triangle of the scene, and 32 a ray; those beyond that end with what
 * they have after 32, and are counted as cut. */
size_t noc_ground_looked(const noc_scene *scene);
extern size_t noc_ground_most_looks; /* changed by tests alone */
/* Highest surface of any class but closures and what shines of lamps at (x, y), for placing cameras. */
bool noc_scene_top(const noc_scene *scene, double x, double y, double *z);
/* The same among some classes: classes has bit 1u << noc_class set for each. */
bool noc_scene_highest(const noc_scene *scene, uint32_t classes, double x, double y, double *z);
/* The same among what lies lower than `below`, without bodies of lamps. */
bool noc_scene_highest_below(const noc_scene *scene, uint32_t classes, double x, double y, double below, double *z);
/* Returns true if vertical rays can meet something of these classes anywhere. */
bool noc_scene_has_classes(const noc_scene *scene, uint32_t classes);
/* How many triangles a ray at (x, y) looks at: what a query costs. */
size_t noc_ground_load(const noc_scene *scene, double x, double y);

#endif
