/* nocturne/influence.h: who lights this? The lights that reach a point or a region, ranked by what they bring.
 *
 * A *region* is what is asked about: points and triangles with normals (noc_region). A *ranking* estimates what each
 * emitter brings to it, by samples of its own and apart from any picture: docs/estimator.md, "Who lights this". Each
 * number is unbiased and comes with its standard error, and more samples may be added as long as one likes.
 *
 * An *emitter* is what people call one light (noc_emitter). */
#ifndef NOCTURNE_INFLUENCE_H
#define NOCTURNE_INFLUENCE_H

#include <nocturne/import.h>
#include <nocturne/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- emitters ---- */

typedef enum noc_emitter_kind {
    NOC_EMITTER_LAMP,    /* of inputs, or placed by a rule: its lights follow one another, share its id, and lie within
                            5 m of the first one */
    NOC_EMITTER_WINDOW,  /* one pane, with all its triangles */
    NOC_EMITTER_VEHICLE, /* lights of one instance that share a name: a car's headlamps */
    NOC_EMITTER_SURFACE, /* a mesh that shines, with all its triangles; lone flat lights */
    NOC_EMITTER_OTHER,   /* lights that move by themselves */
    NOC_EMITTER_KIND_COUNT
} noc_emitter_kind;

NOC_API const char *noc_emitter_kind_name(noc_emitter_kind kind); /* "lamp", "window", ... */

/* One emitter as the scene has it since its last commit. */
typedef struct noc_emitter {
    noc_emitter_kind kind;
    const char *name;   /* a lamp's id, an object's, "headlamp"; "" where it has none. Belongs to the scene */
    const char *of;     /* vehicles: the instance's model; else "" */
    size_t light;       /* its first light, for noc_scene_get_light */
    size_t light_count; /* of it */
    int instance;       /* vehicles: whose it is; else -1 */
    double centre[3];   /* of the first light, local metres */
    double lumens;      /* of all its lights */
    double kelvin;      /* of its first light, by noc_rgb_kelvin; NaN: no black body's colour, or dark */
    bool inferred;      /* a lamp that a rule has placed */
} noc_emitter;

/* The emitter that a light is of, by an index below noc_scene_info.light_slots. NOC_ERR_ARGUMENT after reporting that
 * there is none; NOC_ERR_MEMORY. One look at all lights. */
NOC_API noc_status noc_scene_get_emitter(const noc_scene *scene, size_t light, noc_emitter *out);

/* What an emitter lights: docs/estimator.md, "What a lamp lights". */
typedef struct noc_reach_params {
    int rays;        /* of each light; default 65536 */
    double area_lux; /* lx: surfaces that get so much are counted; default 1 */
    double far_lux;  /* lx: of the farthest place; default 0.1 */
} noc_reach_params;

#define NOC_REACH_DEFAULTS(set) set(rays, 65536) set(area_lux, 1) set(far_lux, 0.1)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_reach_params, noc_reach_default_params, NOC_REACH_DEFAULTS)
#else
#define noc_reach_default_params() ((noc_reach_params){ NOC_REACH_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Its illuminance is that of its light alone; its own body and others of lamps are left out. Places are local metres.
 */
typedef struct noc_reach {
    noc_emitter emitter;
    double met;                 /* lm of it that meet surfaces; the rest goes to the sky and into lamps' bodies */
    double area;                /* m2 of surfaces that get area_lux or more of it */
    double far, far_place[3];   /* m to the farthest place that gets far_lux of it; 0: none does */
    double most, most_place[3]; /* lx where it is brightest */
    size_t objects;             /* that get any of it */
} noc_reach;

typedef struct noc_reach_object {
    const char *name; /* belongs to the scene; "" where it has none */
    noc_class cls;    /* of a surface of it */
    size_t object;    /* for noc_scene_object_name */
    double lumens;    /* that it gets */
} noc_reach_object;

/* What the emitter that the light is of lights, and the first `count` objects by what they get of it, the strongest
 * first (objects may be NULL with a count of 0); *found, which may be NULL, gets how many were filled. params may be
 * NULL. The view's thread asks. The result is the same for any number of threads. NOC_ERR_ARGUMENT after reporting a
 * light that there is not, or params that make no sense; NOC_ERR_MEMORY. */
NOC_API noc_status noc_view_reach(noc_view *view, size_t light, const noc_reach_params *params, noc_reach *out,
                                  noc_reach_object *objects, size_t count, size_t *found);

/* ---- regions ---- */

/* A part of a region: a triangle, or where both edges are 0 a point. */
typedef struct noc_patch {
    float p[3], u[3], v[3]; /* corner and edges, local metres */
    float n[3];             /* unit normal, on the side whose light is asked for */
    float weight;           /* of its mean in the region's: m2; of points any unit */
    uint32_t material;      /* of the scene, for luminance and its class; NOC_NO_MATERIAL: none */
    bool textured;          /* luminance is that of the material's texture, too, in whose image it lies at: */
    float image[2], image_u[2], image_v[2]; /* corner and edges, as noc_mesh.uv says places */
    float level; /* that the image is seen in: 0 as fine as it is, 1 with texels of twice the width, ... */
} noc_patch;
#define NOC_NO_MATERIAL UINT32_MAX

/* The point that a ray has hit. ray and next: that one and the one through the pixel below, and the texture is seen as
 * coarse as such a pixel; NULL: as fine as it is. */
NOC_API noc_patch noc_hit_patch(const noc_hit *hit, double weight, const noc_ray *ray, const noc_ray *next);

typedef struct noc_region noc_region;

/* An empty region. NULL: no memory, reported. */
NOC_API noc_region *noc_region_create(noc_log *log);
NOC_API void noc_region_destroy(noc_region *region); /* NULL is allowed */
/* Adds parts, which are copied. NOC_ERR_ARGUMENT after reporting one that is not finite, whose normal is no unit
 * vector or whose weight is not above 0; then none of them is added. */
NOC_API noc_status noc_region_add(noc_region *region, const noc_patch *patches, size_t count);
/* Counts places that are no part of the region because something stands on the ground there. NULL: nothing is done. */
NOC_API void noc_region_leave_out(noc_region *region, size_t count);

/* Adds all triangles of the object of that id that are of these classes (1u << noc_class each; 0: all but closures and
 * ground surfaces), as they face outwards, by their area. What lies on the ground faces up. Panes up to 0.6 m in front
 * of a wall do not shadow it: the wall behind a pane is sampled at the pane's face. If windows are among the classes,
 * the pane is added instead of that part of the wall. NOC_ERR_ARGUMENT is returned without a message if there is no
 * such object, and after reporting it if the object has no such surface or is cut into more than 4,000,000 pieces. */
NOC_API noc_status noc_region_add_object(noc_region *region, const noc_scene *scene, const char *id, uint32_t classes);
/* Objects that noc_scene_object_name knows have numbers below this. */
NOC_API size_t noc_scene_object_slots(const noc_scene *scene);

/* A road of a map that has a name, or a street of the built-in city. Belongs to the scene. */
typedef struct noc_street {
    const char *name, *id;
    double width; /* m, of its carriageway */
    size_t point_count;
    const float *points; /* 2 each, local metres: its middle */
} noc_street;
/* How many there are, in the order of the inputs; several make a street, mostly. */
NOC_API size_t noc_scene_streets(const noc_scene *scene);
NOC_API bool noc_scene_get_street(const noc_scene *scene, size_t index, noc_street *street); /* false: there is none */

/* Rings of polygons, one after the other: a place is inside where it is in an odd number of them. */
#define NOC_RINGS_CRS 80
typedef struct noc_rings {
    size_t count, *size;     /* points of each */
    double *xy;              /* 2 each */
    char crs[NOC_RINGS_CRS]; /* that the file is in: any that PROJ reads; "": it does not say */
} noc_rings;
/* The polygons of a file: GeoJSON, or WKT. Free them by noc_rings_free. An error is reported. */
NOC_API noc_status noc_rings_read(const char *path, noc_rings *rings, noc_log *log);
/* The same of WKT, POLYGON or MULTIPOLYGON. */
NOC_API noc_status noc_rings_parse(const char *wkt, noc_rings *rings, noc_log *log);
NOC_API void noc_rings_free(noc_rings *rings);

typedef struct noc_region_info {
    size_t patches;
    double weight;    /* sum: m2 of a surface */
    double centre[3]; /* weighted mean, local metres */
    bool point;       /* it is a single point */
    size_t left_out;  /* places that noc_region_leave_out counted: something stands on the ground there */
} noc_region_info;
NOC_API void noc_region_get_info(const noc_region *region, noc_region_info *info);
/* Its part of that index, below noc_region_info.patches; false: there is none. */
NOC_API bool noc_region_get_patch(const noc_region *region, size_t index, noc_patch *patch);
/* Corners of a convex outline as it is seen from above, counter-clockwise, at its lowest height; local metres. The
 * region's outermost places in `most` directions: as many corners at most. Their count. */
NOC_API size_t noc_region_outline(const noc_region *region, double (*corners)[3], size_t most);

/* What the text of a region is read with. */
typedef struct noc_region_params {
    const noc_camera *camera; /* of pixel and rect; NULL: there is none */
    int width, height;        /* of its picture */
    const char *crs;  /* of coordinates: any that PROJ reads; NULL: the scene's, local metres where it has none */
    uint32_t classes; /* of object: as in noc_region_add_object */
    bool files;       /* polygon may name a file */
} noc_region_params;

/* The region that a text says, as --region of nocturne influence does:
 *
 *   point:X,Y                 the ground there, else the highest surface
 *   point:X,Y,Z               that place, as a luxmeter that is held level
 *   point:X,Y,Z,NX,NY,NZ      the same, facing that way
 *   point:X,Y,CRS             each of them with X, Y, Z in a CRS that PROJ reads; the normal is in the scene's axes
 *   pixel:X,Y                 the surface that the camera sees at that place of its picture, whose first pixel is 0,0
 *   rect:X0,Y0,X1,Y1          surfaces that its pixels from the first to the second see, each pixel as much as another
 *   object:ID                 all outer surfaces of an object
 *   street:NAME               the roads and pavements of a street that a map names, as one sees them from above
 *   polygon:FILE or WKT       the ground in polygons, as one sees it from above
 *
 * The view's thread asks (noc_view_cast). NULL after reporting what is wrong with the text, or with the place. */
NOC_API noc_region *noc_region_find(noc_view *view, const noc_scene *scene, const char *text,
                                    const noc_region_params *params, noc_log *log);

/* Why a luxmeter at that place, local metres, is dark: text gets "inside a lamp's pole or head", "inside a building,
 * ID", "below the ground by 0.3 m", ..., or "" where it lies in the open. Bodies whose faces do not look outwards are
 * not known. A few rays, by the view's thread (noc_view_cast). */
NOC_API noc_status noc_view_buried(noc_view *view, const noc_scene *scene, const double place[3], char *text,
                                   size_t size);

/* ---- rankings ---- */

typedef struct noc_estimate {
    double value, error; /* and its standard error */
} noc_estimate;

/* What an emitter brings to the region: one row of a ranking. */
typedef struct noc_influence_row {
    noc_emitter emitter;
    noc_estimate lux;   /* illuminance at the point, or mean over the region */
    noc_estimate share; /* of all, the sky's too: 0..1; NaN: of no light */
    double distance;    /* m, from the region's centre to the emitter's */
} noc_influence_row;

/* What all emitters of one kind bring: that much is of windows. */
typedef struct noc_influence_kind {
    noc_estimate lux, share;
    size_t emitters; /* of it, that were found to bring anything */
} noc_influence_kind;

/* All that counts: lights of every kind and the sky, but windows only where params count them. */
typedef struct noc_influence_sum {
    noc_estimate lux;
    bool windows_counted; /* noc_ranking_params.count_windows */
    noc_estimate sky, sky_share;
    /* By noc_emitter_kind: lamps are kinds[NOC_EMITTER_LAMP]. Those that count and the sky are all. Windows are
     * estimated in any case; where they do not count, their share is NaN. */
    noc_influence_kind kinds[NOC_EMITTER_KIND_COUNT];
    noc_estimate rest, rest_share; /* of emitters beyond the rows that were asked for */
    size_t emitters;               /* that count and were found to bring anything */
    /* where params have an eye: mean luminance towards it of what the region reflects of light that counts, cd/m2; else
     * 0 */
    noc_estimate luminance;
    uint64_t samples, rays; /* points that were looked at, shadow rays that were traced */
    double seconds;         /* that it took, wall clock */
    uint64_t restarts;      /* times that it began anew, for the scene was edited */
} noc_influence_sum;

/* What surfaces of one class of the region get: a building's walls. */
typedef struct noc_influence_class {
    noc_class cls;               /* NOC_CLASS_OTHER of parts without a material */
    double weight;               /* of its parts: m2 of a surface */
    noc_estimate lux;            /* mean illuminance over them by all that counts; NaN: no sample fell on it yet */
    noc_estimate lamps, windows; /* the same by lamps alone, by windows alone */
} noc_influence_class;

typedef struct noc_ranking noc_ranking;

typedef struct noc_ranking_params {
    /* what lights beside the lamps: sky, environment_*; and isa and seed; NULL: the defaults */
    const noc_render_params *render;
    const double *eye; /* local metres: whose luminance is asked for; NULL, the default: nobody's */
    /* Windows count in the sums, the shares and the rows. false, the default: their illuminance stands beside the sums,
     * because a plan of street lighting may not rely on windows. */
    bool count_windows;
} noc_ranking_params;

/* When refining may stop: at the first of those that are above 0, and never before the standard errors mean
 * something. */
typedef struct noc_ranking_target {
    double seconds; /* wall clock, of this call */
    double error;   /* relative standard error of the lux, and of the greatest share of an emitter that counts */
    uint64_t rays;  /* of all calls */
} noc_ranking_target;

/* Asks who lights the region, which is copied. The view's scene and device are used, and one thread at a time may use
 * the view: a program that renders meanwhile makes another view of the scene. The view must outlive the ranking. params
 * may be NULL. NULL after reporting an error: an empty region, or memory was refused. */
NOC_API noc_ranking *noc_ranking_create(noc_view *view, const noc_region *region, const noc_ranking_params *params);
NOC_API void noc_ranking_destroy(noc_ranking *ranking); /* NULL is allowed */

/* Adds samples until the target is met; a NULL target, or one of zeros: one round. Where edits of the scene were
 * committed since the last round it begins anew. progress may be NULL; where it cancels, NOC_ERR_CANCELLED is returned
 * and all rounds that were completed stay. NOC_ERR_MEMORY after reporting it: the next call begins anew. The result is
 * the same for any number of threads, but for a target in seconds. A commit waits for one round at most. */
NOC_API noc_status noc_ranking_refine(noc_ranking *ranking, const noc_ranking_target *target,
                                      const noc_progress *progress);

/* The first `count` emitters that count by what they bring, the strongest first, into rows (NULL with a count of 0),
 * and what all bring into sum (may be NULL). *found gets how many rows were filled; fewer where fewer emitters bring
 * anything. Where lights were added or removed since the last round, emitters have no names and no places, and
 * distances are NaN. NOC_ERR_ARGUMENT: nothing was estimated yet; NOC_ERR_MEMORY. */
NOC_API noc_status noc_ranking_get(noc_ranking *ranking, noc_influence_row *rows, size_t count, size_t *found,
                                   noc_influence_sum *sum);

/* The illuminance of the first `count` classes that the region has, the one with the greatest weight first; *found gets
 * how many were filled. Each class gets at least a 32nd of the samples, so that small ones are known, too.
 * NOC_ERR_ARGUMENT: nothing was estimated yet. */
NOC_API noc_status noc_ranking_get_classes(noc_ranking *ranking, noc_influence_class *classes, size_t count,
                                           size_t *found);

/* These rows, then what the kinds of emitters bring (lamps first, then windows), the sky, the sum and what classes of
 * surfaces get (if there are any: m2 of them and of all, too), as CSV with a head of names: what nocturne influence
 * --csv writes, with the region's text in the column region (NULL: ""). Places are in the scene's CRS, which the column
 * crs names, local metres where it has none; the report, which may be NULL, tells of lamps. free() it. NULL: no memory,
 * or a pointer that should not be NULL, which is reported. */
NOC_API char *noc_influence_csv(const noc_scene *scene, const noc_report *report, const noc_influence_row *rows,
                                size_t count, const noc_influence_sum *sum, const noc_influence_class *classes,
                                size_t class_count, const char *region);

#ifdef __cplusplus
}
#endif
#endif
