/* scene: the flat arrays that backends render. Filled through the public functions of nocturne/scene.h. */
#ifndef NOC_SCENE_H
#define NOC_SCENE_H

#include "base/base.h"
#include <nocturne/scene.h>

#define NOC_NO_LIGHT UINT32_MAX

extern const char *const noc_class_names[NOC_CLASS_COUNT];

/* 64 bytes, 4-byte scalars only: the same record for C and shaders (core/light.h says what each kind keeps where). */
typedef struct noc_light_record {
    float p[3];    /* centre or corner */
    uint32_t kind; /* noc_light_kind */
    float a[3];    /* edge u; disc: first radius vector; spot: its axis, times the scale of its falloff */
    float radius;  /* triangle, parallelogram: noc_flat_size; 0 for points and spots */
    /* edge v; disc: second radius vector; the light faces a x b. Spot: offset of its falloff, inner and
     * outer angle in radians */
    float b[3];
    uint32_t flags; /* bit 0: two-sided; bit 1: inferred; bit 2: NOC_LIGHT_MOVES */
    float e[3];     /* cd/m2; point, spot: cd */
    float area;     /* m2; 0 for points and spots */
} noc_light_record;
#define NOC_LIGHT_MOVES 4u
_Static_assert(sizeof(noc_light_record) == 64, "light records are one cache line");

/* 32 bytes. */
typedef struct noc_material_record {
    float albedo[3];
    float f0;
    float emission[3];
    float alpha; /* roughness^2 */
} noc_material_record;
_Static_assert(sizeof(noc_material_record) == 32, "material records are half a cache line");

typedef struct noc_scene_mesh {
    uint32_t first_triangle, triangle_count;
    int material;
    const char *name; /* in scene->names */
} noc_scene_mesh;

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
    bool lit_elsewhere; /* no lamp stands in the city: views look at its buildings */
    char *without_crs;  /* the input that settled the place and names no CRS; NULL where there is none */

    /* Triangle soup: vertices are 3 floats (Embree needs 4 bytes of padding after the last: reserve one more). */
    NOC_ARRAY(float) positions;            /* 3 a vertex */
    NOC_ARRAY(uint32_t) indices;           /* 3 a triangle */
    NOC_ARRAY(uint32_t) triangle_material; /* index into material_records */
    NOC_ARRAY(uint32_t) triangle_light;    /* light that this triangle shows, or NOC_NO_LIGHT */
    NOC_ARRAY(noc_scene_mesh) meshes;
    NOC_ARRAY(noc_material) materials;
    NOC_ARRAY(noc_material_record) material_records; /* parallel to materials */
    NOC_ARRAY(noc_light_record) lights;              /* data is 64-byte aligned after commit */
    NOC_ARRAY(const char *) light_names;             /* parallel to lights, entries may be NULL */
    NOC_ARRAY(uint32_t) moving;                      /* lights with NOC_LIGHT_MOVES */
    /* calls that moved a light; those of them that changed what it emits in all */
    uint64_t moves, power_changes;
    noc_arena names;
    size_t triangles_dropped, triangles_flat /* of these, for they have no area */, lights_inferred;
    double bounds_min[3], bounds_max[3];
    uint32_t backdrop_first, backdrop_count; /* triangles around the city: drawn, but no part of it */
    noc_camera own_camera;                   /* fov_deg 0: none */
    bool committed;
    bool no_memory;            /* was refused and reported: nothing more is added, and it cannot be committed */
    struct noc_ground *ground; /* built on first use of noc_scene_ground; freed with the scene */
};

/* Adds what lies around the city, to the horizon. It is rendered and that is all: bounds, cameras and vertical rays do
 * not know it. A scene has one; false, and nothing happens, if it has one already or the mesh was refused. */
bool noc_scene_add_backdrop(noc_scene *scene, const noc_mesh *mesh);

/* Triangles of the city itself: their number, and the i-th. */
static inline size_t noc_scene_city_triangles(const noc_scene *s) { return s->triangle_light.len - s->backdrop_count; }
static inline size_t noc_scene_city_triangle(const noc_scene *s, size_t i) {
    return i < s->backdrop_first ? i : i + s->backdrop_count;
}

/* Bytes that it takes, about. */
size_t noc_scene_bytes(const noc_scene *s);

/* query.c: index of the object that a triangle is of, for noc_scene_object_name. */
size_t noc_scene_object_of(const noc_scene *scene, uint32_t triangle);

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
/* Highest surface of any class but closures and what shines of lamps at (x, y), for placing cameras. */
bool noc_scene_top(const noc_scene *scene, double x, double y, double *z);
/* The same among some classes: classes has bit 1u << noc_class set for each. */
bool noc_scene_highest(const noc_scene *scene, uint32_t classes, double x, double y, double *z);
/* How many triangles a ray at (x, y) looks at: what a query costs. */
size_t noc_ground_load(const noc_scene *scene, double x, double y);

#endif
