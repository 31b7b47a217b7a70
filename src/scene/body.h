/* body.h: bodies of lamps, which stand for good: what the scene keeps of them, and body.c's functions. */
#ifndef NOC_SCENE_BODY_H
#define NOC_SCENE_BODY_H

#include "base/base.h"
#include "core/records.h"
#include <nocturne/scene.h>

struct noc_scene_model;

/* A lamp's body: a model that stands upright for good, and shows static lights of the scene. */
typedef struct noc_scene_body {
    uint32_t model;
    uint32_t light;  /* the first of the lights that it shows, which follow one another */
    float p[3];      /* where the model's origin is */
    float facing[2]; /* unit vector, where the model's x goes */
} noc_scene_body;
_Static_assert(sizeof(noc_scene_body) <= 28, "a lamp costs a few dozen bytes beside its light");

/* Numbers of what shows a hit triangle: instances, bodies from NOC_BODIES on, NO_INSTANCE for the world. */
#define NOC_BODIES 0x80000000u
static inline bool noc_is_body(uint32_t instance) { return instance >= NOC_BODIES && instance != NO_INSTANCE; }

typedef struct noc_body_link {
    uint32_t body, next; /* next: its place in the links + 1, 0: the last one of its bucket */
} noc_body_link;

/* What a model of bodies was made of: bytes of its maker. model 0: an empty slot. */
typedef struct noc_scene_kind {
    uint64_t hash;
    const void *key; /* the scene's */
    size_t size;
    int model;
} noc_scene_kind;

/* body.c: a body's lights are dark, and stay its own, once they are removed. */
/* Before the first commit: a model of the triangles of `mesh` (whose model and material are not read; NULL: none) and
 * of the shapes of lights, which bodies of it show. Its number, or -1 after reporting. */
int noc_scene_add_body_model(noc_scene *s, const noc_mesh *mesh, const noc_light *lights, size_t count);
/* The model that was noted for a kind of body, 0 where there is none yet. kinds: how many were noted. */
int noc_body_kind(const noc_scene *s, const void *key, size_t size, size_t *kinds);
/* Notes it: the key is copied. false after reporting. */
bool noc_body_kind_add(noc_scene *s, const void *key, size_t size, int model);
/* Before the first commit: stands one there, whose lights were added last (noc_scene_add_body_light). false after
 * reporting. */
bool noc_scene_add_body(noc_scene *s, const noc_scene_body *body);
/* Files bodies from `first` on by cells of the ground. false: memory was refused. */
bool noc_bodies_file(noc_scene *s, size_t first);
/* Joins bounds of all bodies to lo..hi. */
void noc_join_body_bounds(const noc_scene *s, double lo[3], double hi[3]);
/* Vertices of a body's model: the end of their numbers, from *first on; and where one is in the scene. */
size_t noc_body_vertices(const noc_scene *s, const noc_scene_body *body, size_t *first);
void noc_body_vertex(const noc_scene *s, const noc_scene_body *body, size_t vertex, float p[3]);
/* Joins a box around a body. */
void noc_join_body_box(const noc_scene_body *body, const struct noc_scene_model *model, double lo[3], double hi[3]);
void noc_body_transform(const noc_scene_body *body, float m[12]);
/* Transform of an instance or a body by its number. */
void noc_placed_transform(const noc_scene *s, uint32_t instance, float m[12]);
/* The scene's light that stands behind a light's number of the model that the instance or body shows. */
uint32_t noc_placed_light(const noc_scene *s, uint32_t instance, uint32_t light);
/* Raises *z to the highest point of bodies' surfaces, lights' shapes aside, on the vertical line at (x, y); false:
 * there is none above *z. */
bool noc_bodies_highest(const noc_scene *s, double x, double y, double *z);
/* The body that shows a light; NULL: none does. */
const noc_scene_body *noc_body_of(const noc_scene *s, uint32_t light);
/* light.c: adds a light without a shape of its own, which a body shows. Its index, or -1 after reporting. */
int noc_scene_add_body_light(noc_scene *s, const noc_light *light);
/* light.c: adds the shape of a light to its model, as triangles that show the light of that number. false after
 * reporting. */
bool noc_scene_add_shape(noc_scene *s, const noc_light *light, uint32_t number);

#endif
