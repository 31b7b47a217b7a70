/* scene_kit: what the built-in scenes that are no city are made of: parametric patches, boxes, coloured lights. As in
 * town.h, only +, -, *, / and sqrt decide where things are, so that every machine makes the same scene. */
#ifndef NOC_SCENE_KIT_H
#define NOC_SCENE_KIT_H

#include "city/builtin/town.h" /* its random numbers and sines */

typedef struct vec3 {
    double x, y, z;
} vec3;

static inline vec3 v3(double x, double y, double z) { return (vec3){ x, y, z }; }
static inline vec3 add(vec3 a, vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline vec3 scale(vec3 a, double s) { return v3(a.x * s, a.y * s, a.z * s); }
static inline vec3 sub(vec3 a, vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline double dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec3 cross(vec3 a, vec3 b) {
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
vec3 unit(vec3 a); /* a itself where it has no length */

typedef struct kit {
    noc_scene *scene;
    vec3 origin, axis[3]; /* where points that are added go: origin + x axis[0] + ... */
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices;
    bool failed; /* the scene refused something (and reported it) */
} kit;

kit kit_start(noc_scene *scene);
noc_status kit_finish(kit *k);

int kit_material(kit *k, float r, float g, float b, float f0, float roughness);
/* Points that follow are turned about z, made larger, and moved to `at`. */
void kit_place(kit *k, vec3 at, double turns, double size);
/* Makes a mesh of all that was added since the last one. */
void kit_flush(kit *k, int material, const char *name);

/* nu x nv quads over u, v in 0..1; they face du x dv. */
typedef vec3 (*kit_surface)(const void *shape, double u, double v);
void kit_patch(kit *k, int nu, int nv, kit_surface surface, const void *shape);
void kit_quad(kit *k, vec3 a, vec3 b, vec3 c, vec3 d); /* counter-clockwise seen from its front */
void kit_box(kit *k, vec3 lo, vec3 hi);

/* A turned shape: profile[i] = { radius, height }, from bottom to top, smoothed by Catmull and Rom's spline where
 * `smooth`; `flutes` grooves of a depth in shares of the radius. Ends of radius 0 close it. */
typedef struct kit_lathe {
    const double (*profile)[2];
    int count;
    bool smooth;
    int flutes;
    double depth;
} kit_lathe;
void kit_turned(kit *k, int sides, int rings, const kit_lathe *lathe);
void kit_sphere(kit *k, int sides, int rings);       /* of radius 1 about 0 */
void kit_torus(kit *k, int nu, int nv, double tube); /* about z, of radius 1 */

/* A closed tube along a torus knot that winds p times about the z axis and q times about the torus of radii 1 and
 * `ring`. Its section has `lobes` that turn `twist` times on the way around, and `ribs` across. */
typedef struct kit_knot {
    int p, q, lobes, twist, ribs;
    double ring, tube;
} kit_knot;
void kit_knotted(kit *k, int nu, int nv, const kit_knot *knot);

void kit_light(kit *k, const noc_light *light);
void kit_camera(kit *k, vec3 eye, vec3 target, double fov_deg);

/* The scenes, by name; windows: those that they have are switched, else they are dark glass. */
noc_status scene_cityscape(noc_scene *scene, const noc_builtin_params *params, bool windows); /* cityscape.c */
noc_status scene_mess(noc_scene *scene, const noc_builtin_params *params, bool windows);
noc_status scene_single(noc_scene *scene, const noc_builtin_params *params, bool windows);
noc_status scene_atrium(noc_scene *scene, const noc_builtin_params *params, bool windows);

#endif
