/* geo: a city as surveyors keep it. Double coordinates in the file's own CRS, semantics, and the sink that readers
 * feed. */
#ifndef NOC_GEO_H
#define NOC_GEO_H

#include "base/base.h"
#include <nocturne/luminaire.h>
#include <nocturne/scene.h> /* noc_class */

/* ---- coordinate reference systems (crs.c, crs_files.c: the only PROJ calls of the library) ---- */

typedef struct geo_crs geo_crs;

/* From any spelling: EPSG:n, URNs and URLs of OGC (compound ones too), urn:adv, "CH1903", WKT, PROJ strings. NULL after
 * reporting what was not understood (and where: `place` is put before the message, e.g. "city.gml:12"); *status, which
 * may be NULL, tells that from memory that was refused. */
geo_crs *geo_crs_create(const char *definition, const char *place, noc_log *log, noc_status *status);
/* The same of a definition that a file holds: one that makes PROJ open any file (grids, +init, pipelines) is refused.
 */
geo_crs *geo_crs_create_plain(const char *definition, const char *place, noc_log *log, noc_status *status);
geo_crs *geo_crs_utm(double lon, double lat); /* WGS 84 UTM zone of a place; NULL: memory was refused */
geo_crs *geo_crs_clone(const geo_crs *crs);   /* NULL: memory was refused, or crs is NULL */
void geo_crs_destroy(geo_crs *crs);
const char *geo_crs_name(const geo_crs *crs);       /* "EPSG:25832 (ETRS89 / UTM zone 32N)" */
const char *geo_crs_definition(const geo_crs *crs); /* what it was made from */
/* Its horizontal part as WKT 2, 2019; free() it. NULL: it cannot be written so, or memory was refused. */
char *geo_crs_wkt(const geo_crs *crs);
bool geo_crs_is_geographic(const geo_crs *crs);
bool geo_crs_is_metric(const geo_crs *crs); /* projected, axes in metres */
bool geo_crs_lat_first(const geo_crs *crs); /* the authority's order is northing/latitude first */
/* Returns the unit of heights [m]. *named: it is that of a vertical part or of a third axis; else it is assumed: the
 * unit of x and y of a projected CRS, metres of a geographic one. */
double geo_crs_height_unit(const geo_crs *crs, bool *named);
/* Sets the unit of heights [m], for transforms that are made later. Requires metres > 0. */
void geo_crs_set_height_unit(geo_crs *crs, double metres);
/* The first thing in a text that makes a library which takes it for a CRS open a file: a grid, a file of definitions;
 * copied to what. False if there is none. */
bool geo_crs_text_names_file(const char *text, char what[40]);
/* Is PROJ there, and finds it its database, without which no CRS can be read? NOC_ERR_UNSUPPORTED, not reported: it is
 * not, and why_not says which. NOC_ERR_MEMORY: it could not be asked. */
noc_status geo_crs_database(const char **why_not);
bool geo_crs_equal(const geo_crs *a, const geo_crs *b); /* same horizontal CRS */
/* Longitude and latitude (degrees, WGS 84) of a point given easting northing; false if it has none. Not thread-safe. */
bool geo_crs_lonlat(geo_crs *crs, double x, double y, double lonlat[2]);
/* The same to a few hundred metres, in a fraction of the time. */
bool geo_crs_lonlat_near(geo_crs *crs, double x, double y, double lonlat[2]);
/* How far a point (easting northing) lies outside the area the CRS is meant for: degrees, 0 inside, INFINITY where it
 * has no place on Earth. What tells exchanged axes and wrong CRSs. Not thread-safe. */
double geo_crs_outside(geo_crs *crs, double x, double y);
/* How long a metre of the ground at a point (easting northing) is in a projected CRS: its point scale, of the
 * meridian's and the parallel's the one that is farther from 1. NaN where it is not known. Not thread-safe. */
double geo_crs_scale(geo_crs *crs, double x, double y);

/* Transform between two CRSs; not thread-safe, one a thread. Points are easting northing height (lon lat height,
 * degrees): axis order is normalised. Height passes through unchanged, but for its unit (feet to metres). */
typedef struct geo_transform geo_transform;
/* as geo_crs_create */
geo_transform *geo_transform_create(const geo_crs *from, const geo_crs *to, noc_log *log, noc_status *status);
void geo_transform_destroy(geo_transform *t);
/* In place; points that cannot be transformed become NaN. Returns how many failed. */
size_t geo_transform_points(geo_transform *t, double *xyz, size_t count);

/* ---- what readers emit ---- */

typedef enum geo_kind {
    GEO_BUILDING,
    GEO_TERRAIN,
    GEO_TRANSPORT,
    GEO_VEGETATION,
    GEO_WATER,
    GEO_FURNITURE,
    GEO_BRIDGE,
    GEO_LANDUSE,
    GEO_OTHER,
    GEO_KIND_COUNT
} geo_kind;

typedef struct geo_object {
    geo_kind kind;
    const char *id; /* gml:id, "" if none; valid during the call */
    int lod;        /* taken, -1 if not applicable */
    noc_building_use use;
    double storeys; /* of a building, above the ground; 0: not told */
    bool outline;   /* of a building: made of its outline, whose height above the sea may be none */
} geo_object;

/* Rings without the repeated last point. Coordinates in the file's CRS, easting northing height order. */
typedef struct geo_polygon {
    noc_class cls;
    const char *id;          /* polygon's gml:id, else its object's; never NULL */
    size_t ring_count;       /* first one exterior */
    const size_t *ring_size; /* points a ring */
    const double *xyz;       /* 3 a point, rings one after the other */
    uint32_t appearance;     /* as geo_sink.appearance has numbered it; 0: none */
    const float *uv;         /* 2 a point: where it is in the appearance's image, as noc_mesh has it; NULL: nowhere */
} geo_polygon;

/* What a file says of how surfaces look. */
typedef struct geo_appearance {
    const char *name;  /* that the file gives its material; NULL: none */
    const char *image; /* file's name, as the file that is read has it; NULL: none */
    noc_wrap wrap;
    bool coloured; /* albedo is told */
    float albedo[3];
    float f0, roughness; /* negative: not told */
    float transmittance;
} geo_appearance;

#define GEO_MAX_HEADS 24 /* on one pole */
#define GEO_HEADINGS 8   /* that are told of one pole's heads */
#define GEO_BODY_HEADS 4 /* of a lamp that is modelled */

enum { GEO_CONDITIONS = 256 }; /* of rules and groups, on tags */

/* What rules say of a lamp besides what its tags may. */
typedef struct geo_fitting {
    noc_lamp_shape shape;
    double efficacy, radius, tilt, arm; /* lm/W, m, degrees, m; NaN: nothing */
    double turn;                        /* degrees that a profile is turned about its axis; NaN: nothing */
    int profile;                        /* of city_profiles; 0: by its kind; GEO_NO_PROFILE: none */
    int group;                          /* of the scene; 0: none */
    noc_lamp_flux flux;
    double file_lumens, file_watts, file_kelvin; /* of the file of its profile; NaN: it has none, or tells none */
} geo_fitting;
#define GEO_NO_PROFILE (-1)
#define geo_no_fitting()                                                                                               \
    ((geo_fitting){ .efficacy = NAN,                                                                                   \
                    .radius = NAN,                                                                                     \
                    .tilt = NAN,                                                                                       \
                    .arm = NAN,                                                                                        \
                    .turn = NAN,                                                                                       \
                    .file_lumens = NAN,                                                                                \
                    .file_watts = NAN,                                                                                 \
                    .file_kelvin = NAN })

enum { GEO_LAMP_TAGS = 2048 }; /* bytes of geo_lamp.tags at most, with the 0 */

/* A lamp as tagged. NaN / 0 / NULL where unknown. */
typedef struct geo_lamp {
    double xyz[3];      /* file CRS; xyz[2] NaN: stands on the ground */
    bool metres;        /* xyz[2] is in metres, whatever the CRS's unit of heights */
    double height;      /* of the light above the ground, m */
    double bare_height; /* the number written for it without a unit, plausible or not; 0: none */
    double direction;   /* degrees clockwise from north the head faces, NaN: none */
    /* that its heads face where it tells more than one, degrees like the former; heading_count 0: it does not */
    float heading[GEO_HEADINGS];
    int heading_count;
    int count; /* heads on the pole; 0 = unknown */
    double lumens, watts, kelvin;
    float rgb[3]; /* colour tag; negative if none */
    enum { GEO_LAMP_STREET, GEO_LAMP_LANTERN, GEO_LAMP_FLOOD } type;
    enum {
        GEO_SOURCE_UNKNOWN,
        GEO_SOURCE_LED,
        GEO_SOURCE_SODIUM,
        GEO_SOURCE_MERCURY,
        GEO_SOURCE_METAL_HALIDE,
        GEO_SOURCE_FLUORESCENT,
        GEO_SOURCE_INCANDESCENT,
        GEO_SOURCE_GAS,
        GEO_SOURCE_LOW_SODIUM
    } source;
    enum { GEO_MOUNT_UNKNOWN, GEO_MOUNT_POLE, GEO_MOUNT_WALL, GEO_MOUNT_SUSPENDED } mount;
    /* Bits: which conditions of rules and groups on tags hold, by their numbers (import/lamps/conditions.h), and
     * whether its tags tell its street. */
    uint64_t holds[GEO_CONDITIONS / 64];
    bool tells_street;
    bool on_deck;               /* xyz[2] is that of a bridge's deck, over the ground; never of a reader's */
    bool off_deck;              /* it stands below or beside a bridge of a map; never of a reader's */
    const geo_fitting *fitting; /* NULL: no rule says anything; never of a reader's */
    const char *id, *ref;       /* what else it is called, for other files may call it so; ref may be NULL */
    const char *tags;           /* as the file has them, "key=value" a line; NULL where nobody asks (each_lamp) */
    /* A lamp whose body is among the surfaces shines from here, and gets neither a pole nor another place. body_heads
     * 0: none. */
    int body_heads;
    double head[GEO_BODY_HEADS][3]; /* centres of the lights, file CRS */
    double head_radius;             /* m */
    bool head_globe;                /* spheres around the body's head; else discs under it, facing down */
} geo_lamp;

/* A building of a map: its outline, first the outer ring, z is of no use. What it tells of its height, NaN where it
 * does not: m above the ground, with the roof, and storeys. */
typedef struct geo_footprint {
    const char *id;
    size_t ring_count;
    const size_t *ring_size;
    const double *xyz;
    double height, min_height, levels, min_level, roof_height;
    bool bare; /* height is written without a unit, in a file whose format has none */
    noc_building_use use;
} geo_footprint;

/* What a line of a map is to those who drive and walk there. Links are of the class that they lead to. */
typedef enum geo_road_class {
    GEO_ROAD_MOTORWAY,
    GEO_ROAD_TRUNK,
    GEO_ROAD_PRIMARY,
    GEO_ROAD_SECONDARY,
    GEO_ROAD_TERTIARY,
    GEO_ROAD_MINOR, /* residential, unclassified, road */
    GEO_ROAD_LIVING,
    GEO_ROAD_SERVICE,
    GEO_ROAD_PEDESTRIAN,
    GEO_ROAD_PATH, /* footway, cycleway, path, steps, bridleway */
    GEO_ROAD_TRACK,
    GEO_ROAD_RAIL, /* railway and tram, where no road runs on it */
    GEO_ROAD_CLASSES
} geo_road_class;

/* A value of OpenStreetMap's highway that is a road. */
typedef struct geo_highway {
    const char *word;
    geo_road_class cls;
    bool motor, link;
} geo_highway;
/* By its number, from 1 on; NULL beyond the last, and for 0. */
const geo_highway *geo_highway_get(int number);
int geo_highway_find(const char *word); /* 0: there is none */

#define GEO_ROAD_MOST_LANES 32
#define GEO_ROAD_MOST_LAYER 100

/* A road or railway of a map: its centre line, in the direction in which it is drawn. NaN, 0 and "" where the map does
 * not tell. */
typedef struct geo_road {
    const char *id, *name; /* "way/12"; neither is NULL */
    geo_road_class cls;
    int highway; /* its word: geo_highway_get */
    bool link, roundabout, bridge;
    bool tunnel; /* or covered */
    bool motor;  /* cars may drive on it, by its class and its access */
    int lanes, lanes_forward, lanes_backward;
    int oneway; /* 1: as it is drawn, -1: against that, 0: both ways */
    int layer;
    enum { GEO_LIT_UNKNOWN, GEO_LIT_NO, GEO_LIT_YES } lit;
    double width, speed; /* m, of the carriageway; km/h, the limit */
    size_t point_count;  /* 2 or more */
    const double *xyz;   /* file CRS; z NaN where it stands on the ground */
    const double *deck;  /* heights of a bridge's deck at its points; NaN: unknown; NULL: none; never of a reader's */
} geo_road;

/* Of the carriageway, m: as it is told, else by its lanes, else as wide as its class usually is. */
double geo_road_width(const geo_road *road);
/* Returns the height of the deck at the point of the road that is nearest to xy; NaN: unset. *off: its distance [m]. */
double geo_road_deck(const geo_road *road, const double xy[2], double *off);
double geo_road_length(const geo_road *road); /* seen from above, in the unit of its coordinates */

/* A car's track, in parts between which nothing is driven; z is of no use. seconds: when it is at each point, from any
 * beginning on; NULL: that is not told. */
typedef struct geo_track {
    const char *id;
    size_t part_count;
    const size_t *part_size; /* points */
    const double *xyz;
    const double *seconds;
} geo_track;

/* A column of a table, an attribute or a tag, and what a reader of lamps took it for. Texts are valid during the call.
 */
typedef struct geo_column {
    const char *name, *field, *unit, *example; /* field: "" where it is not used */
    size_t values;                             /* that are not blank */
    bool mapped;                               /* by the user */
} geo_column;

/* What a map holds, of whatever kind. */
enum { GEO_POINTS, GEO_LINES, GEO_AREAS, GEO_DIMENSIONS };
typedef struct geo_features {
    uint64_t total[GEO_DIMENSIONS];  /* by geometry; of OpenStreetMap points alone */
    uint64_t unread[GEO_DIMENSIONS]; /* of them: sets of points, lines and areas that are no lamps */
    uint64_t buildings, streets;     /* ways and relations of OpenStreetMap that are not read */
    uint64_t parts;                  /* of these buildings: parts, which lie in the outline of another */
    bool any;                        /* the box is that of the unread ones, where the file holds no lamps */
    double lo[2], hi[2];
} geo_features;

/* Counted reasons: kept by the importer, a line a reason in the report. */
typedef struct geo_issues geo_issues;
/* What became of a feature. */
typedef enum geo_issue_kind {
    GEO_SKIPPED,  /* left out */
    GEO_REPAIRED, /* used after a repair that loses nothing */
    GEO_GUESSED,  /* used, and something of it is a guess or missing */
    /* left out, and nothing is lost by it: it has no area, is given twice, is gone or inside by its own word */
    GEO_SPARED,
    GEO_ISSUE_KINDS
} geo_issue_kind;
void geo_issue(geo_issues *issues, geo_issue_kind kind, const char *reason, const char *id); /* texts are copied */
/* whether memory was refused to any, which is not counted then; looked at once, at the end */
bool geo_issues_refused(const geo_issues *issues);

/* Before a srsName that the file does not hold: it is the format's, or the one that its numbers tell. */
#define GEO_CRS_TAKEN '='

/* Sinks for threads that read objects of the file before their turn. What one is given is as the sink that it is of
 * would have it now, and waits; what must come in its turn (lamps, a CRS that is new, what is to be said) it refuses
 * without a word. */
struct geo_sink;
typedef struct geo_sides {
    int threads; /* that may read at once */
    /* One, for one thread at a time; NULL: not now, or memory was refused. */
    struct geo_sink *(*create)(void *ctx);
    /* In its turn: all that it was given goes where the sink's own would. */
    noc_status (*take)(void *ctx, struct geo_sink *side);
    void (*forget)(struct geo_sink *side); /* what it was given */
    void (*destroy)(struct geo_sink *side);
} geo_sides;

/* The importer's side. Readers call these; any status but NOC_OK makes the reader stop and return it. */
typedef struct geo_sink {
    void *ctx;
    noc_log *log;
    geo_issues *issues;
    char *decimal_sign; /* where readers of tables tell which one they take: noc_report_file's; may be NULL */
    size_t *lamps_lost; /* where readers count lamps in use whose place is none: they are not emitted; may be NULL */
    /* srsName as spelled, or behind GEO_CRS_TAKEN; called before the first coordinate it applies to, again when it
     * changes. Returns in *lat_first whether the file's tuples are in latitude/northing first order; the reader swaps
     * them before emitting. */
    noc_status (*crs)(void *ctx, const char *srs_name, const char *place, bool *lat_first);
    /* Sets the unit of the heights that follow [m], where the file specifies it apart from its CRS; called after crs.
     * Requires metres > 0. May be NULL. */
    noc_status (*heights)(void *ctx, double metres);
    /* Returns the unit of heights [m] in the CRS of the last call of crs. NULL: they are metres. */
    double (*height_unit)(void *ctx);
    /* Numbers an appearance for polygons that follow; *number 0: nothing of it is of use. NULL: none is wanted. */
    noc_status (*appearance)(void *ctx, const geo_appearance *appearance, uint32_t *number);
    noc_status (*begin_object)(void *ctx, const geo_object *object);
    noc_status (*polygon)(void *ctx, const geo_polygon *polygon);
    noc_status (*end_object)(void *ctx);
    noc_status (*lamp)(void *ctx, const geo_lamp *lamp);
    noc_status (*footprint)(void *ctx, const geo_footprint *footprint); /* NULL: none is wanted */
    noc_status (*road)(void *ctx, const geo_road *road);                /* the same; those of a map come last */
    noc_status (*track)(void *ctx, const geo_track *track);
    /* of a map: water, lawns, squares by their class; with the roads: NULL where those are; z is of no use */
    noc_status (*area)(void *ctx, const geo_polygon *area);
    /* Of a file of points, at its end: how many there are, lamps or not, and its columns. May be NULL. */
    noc_status (*columns)(void *ctx, size_t points, const geo_column *columns, size_t count);
    /* Of a map, at its end. May be NULL. */
    noc_status (*features)(void *ctx, const geo_features *features);
    /* fraction of the file read; false: cancelled */
    bool (*progress)(void *ctx, double done);
    const geo_sides *sides; /* NULL: all comes in its turn */
    bool named_lamps;       /* the user says that the file's points are lamps */
    bool named_tracks;      /* that its lines are tracks: those of maps come as roads, whatever they are */
    bool given_metres;      /* the user gives the file's CRS, whatever it names, and it is projected, */
    bool given_degrees;     /* or geographic */
    bool inspect;           /* a file of no use is told about, and no error */
} geo_sink;

/* ---- heights (height.c) ---- */

/* Returns true if a file's height is a number that stands for none, such as -9999. */
bool geo_height_stands_for_none(double z);
/* The same, or no place on Earth is so high or low, in metres or in feet. */
bool geo_height_is_none(double z);

/* ---- points by place (cells.c) ---- */

/* Finds points by where they are, whatever the extent: chains of those whose cell has one hash. */
typedef struct geo_cells {
    uint32_t *first, *next; /* index + 1 in the order of its user; 0: no more */
    size_t size;            /* of first: a power of two */
    double edge;            /* m */
} geo_cells;
bool geo_cells_create(geo_cells *cells, size_t points, double edge) NOC_MUST_USE;
/* 0..8: the cells around; 4: the point's own */
uint32_t *geo_cells_at(const geo_cells *cells, const double xy[2], int neighbour);
void geo_cells_add(geo_cells *cells, const double xy[2], size_t index);
void geo_cells_free(geo_cells *cells);

/* ---- polygons (polygon.c) ---- */

/* Cleans (repeated points, spikes, non-finite values) and triangulates a polygon with holes, keeping the exterior
 * ring's orientation. Non-planar ones are triangulated in their best plane, keeping their vertices. What was repaired
 * or is beyond repair goes to `issues`. Returns triangles as index triples into the cleaned points. */
typedef struct geo_triangles {
    NOC_ARRAY(double) xyz;       /* 3 a vertex */
    NOC_ARRAY(float) uv;         /* 2 a vertex, where all polygons have uv; else empty */
    NOC_ARRAY(uint32_t) indices; /* 3 a triangle */
    bool no_memory;              /* a polygon was left out as memory was refused; stays set */
} geo_triangles;

/* A block: an outline, first the outer ring, whose z is of no use, from a height to another. */
typedef struct geo_block {
    size_t ring_count;
    const size_t *ring_size;
    const double *xyz;
    double low, high;
    double least; /* walls are longer than this */
    int floor;    /* noc_class of what it is seen by from below; -1: it has none */
} geo_block;
/* Takes a polygon; false ends the block. */
typedef bool (*geo_block_add)(void *ctx, noc_class cls, size_t rings, const size_t *sizes, const double *xyz);
/* Hands on its walls, roof and floor, which face outwards. false: add did not take one, or memory was refused. */
bool geo_block_make(const geo_block *b, geo_block_add add, void *ctx);

/* Points in metres. Appends to out, whose polygons have uv either all or none; returns false if the polygon was
 * skipped. */
bool geo_triangulate(const geo_polygon *polygon, geo_triangles *out, geo_issues *issues);
void geo_triangles_free(geo_triangles *t);
extern size_t geo_most_points; /* of a polygon; one of more is skipped. Tests lower it */

void geo_issues_clear(geo_issues *issues); /* as if nothing had been counted */

/* How many reasons hold that text. */
size_t geo_issues_like(const geo_issues *issues, const char *text);

/* The same as often as another list counted it: reason is copied, examples are ids as that list joined them. */
void geo_issues_add(geo_issues *issues, geo_issue_kind kind, const char *reason, size_t count, const char *examples);

/* All that another list counted, after this one's own, as if it had been counted here. */
void geo_issues_merge(geo_issues *issues, const geo_issues *others);

/* Issues storage, used by the importer. */
geo_issues *geo_issues_create(void) NOC_MUST_USE; /* NULL: memory was refused */
void geo_issues_destroy(geo_issues *issues);
size_t geo_issues_count(const geo_issues *issues);
geo_issue_kind geo_issues_kind(const geo_issues *issues, size_t i);
bool geo_issues_get(const geo_issues *issues, size_t i, const char **reason, bool *repaired, size_t *count,
                    const char **examples) NOC_MUST_USE; /* false: memory was refused */

#endif
