/* load: from files to a scene. load.c runs the inputs, sink.c hears what city readers emit, place.c settles where the
 * scene is, take.c puts what comes of it into the scene, lamps.c stands the lamps.
 *
 * Who writes what: of a file that is read its reading and its input, of the scene and of all files the importer. Where
 * one becomes the other, parts are handed over (load_part). */
#ifndef NOC_IMPORT_LOAD_H
#define NOC_IMPORT_LOAD_H

#include "city/city.h"
#include "import/import.h"
#include "import/load/place.h"
#include "scene/scene.h"

#include <pthread.h>
#include <stdatomic.h>

#define PALETTE 8 /* materials of a class that varies from building to building */

/* expand.c: the files that inputs stand for: folders, patterns, lists. */
typedef struct expanded_file {
    const char *path, *folder; /* folder: the input in which it was found; NULL: it is named */
} expanded_file;
typedef struct expanded {
    NOC_ARRAY(expanded_file) files;
    noc_arena arena;
} expanded;
noc_status expand_inputs(const char *const *paths, size_t count, noc_log *log, expanded *out);
void expanded_free(expanded *e);
extern size_t expand_most_files; /* inputs, and names in one folder: a million. Tests lower it */

/* A building, as far as it tells units [m]. */
typedef struct building_size {
    float height, width; /* width: 0: unset */
    float storey;        /* 0: unset */
} building_size;

/* Faces of the building that is being taken: their vector area and area, both doubled, volume and bounds, m from the
 * first corner (faces.c). */
typedef struct building_faces {
    bool any;
    double origin[3], sum[3], area, volume, lo[3], hi[3];
} building_faces;

/* A lamp of a file that is looked at and not drawn. */
typedef struct seen_lamp {
    double xy[2]; /* local metres */
    given_place given;
} seen_lamp;

typedef struct input {
    const char *path;
    const char *folder; /* the input that is a folder, in which it was found; NULL: it is named */
    bool left_out;      /* found in a folder, and of no kind that is read */
    const char *crs;    /* that the user gives it in place of what it names; NULL: none */
    bool crs_degrees;   /* which is geographic */
    bool one_order;     /* of axes: its format names latitude and longitude (meeting.c) */
    double unit;        /* of heights [m], that the user gives; 0: none */
    bool is_file;       /* with the next three, which tell whether two are the same */
    uint64_t device, inode, size;
    const noc_reader *reader; /* NULL: built-in */
    uint64_t bytes;
    geo_issues *issues;
    noc_report_file file; /* texts in the report's arena */
    bool remote;          /* read by the helper */
    bool without_crs;     /* it may be: a mesh, a table, a Shapefile */
    bool started, repeated;
    size_t first_mesh, end_mesh; /* of the scene, that were read from it */
    size_t lamps_lost;           /* that the reader or the sink found to have no place */
    NOC_ARRAY(building_size) sizes;
    NOC_ARRAY(float) feet;            /* x, y, z of the lowest corners of some buildings, local metres */
    NOC_ARRAY(float) lamp_heights;    /* of those that name no unit, as they are written */
    NOC_ARRAY(float) lantern_heights; /* of these, of lanterns */
    given_place lamp_given;           /* of the first of them */
    NOC_ARRAY(seen_lamp) lamps_seen;
    bool named_lamps;  /* by noc_import_params.lamps */
    bool named_tracks; /* by noc_import_params.tracks */
    int strange_crs;   /* that were not understood and not replaced by --crs */
    NOC_ARRAY(source_crs *) sources;
    /* the scene's side: what is found as parts are taken, and the object that is being taken */
    geo_issues *found;
    bool object_begun, object_decided, object_repeated;
    building_faces faces;
    size_t outwards, inwards; /* buildings whose faces close a space and look so */
} input;

typedef struct pending_lamp {
    geo_lamp lamp; /* local metres; id in importer.names */
    given_place given;
    size_t input;
    const geo_road *along; /* a lamp that is placed along this one; NULL: it is the input's */
    bool faced;            /* its direction is the way to the nearest road */
    bool on_bridge;        /* of a map: its elevation may be the deck's, and tells nothing of the ground */
} pending_lamp;

/* How surfaces of a file look: a geo_appearance that is of use. */
typedef struct surface_look {
    const char *image; /* path; NULL: none */
    geo_appearance as; /* its image is not read */
} surface_look;

/* Surfaces of an object that look like one, of a class. */
typedef struct look_group {
    uint32_t look; /* from 1 */
    noc_class cls;
    uint32_t next; /* + 1, of that look; 0: no more */
    geo_triangles triangles;
} look_group;

/* An image that surfaces of the scene look like. */
typedef struct scene_image {
    const char *path; /* in importer.names */
    uint8_t *data;    /* of one that lies in the input itself, or is kept; NULL: it is a file */
    noc_wrap wrap;
    uint8_t cutoff;      /* where its alpha is smaller it has holes */
    size_t input;        /* the first that names it */
    uint64_t sum, bytes; /* of its file */
    int width, height, leave_out;
    uint32_t like;      /* + 1: an image before it, whose file holds the same; 0: none */
    const char *reason; /* why it is of no use or damaged; NULL: it is neither */
    int texture;        /* the scene's; 0: it was of no use */
} scene_image;

typedef struct image_use {
    int material;
    uint32_t image;
    float albedo[3]; /* that it is times */
} image_use;

/* The object that is being read, as far as it tells it from others (repeat.c). */
typedef struct object_now {
    geo_kind kind;
    bool any;
    bool given;     /* a part of it was handed over, by which it is told from others */
    uint64_t shape; /* of its corners and their classes, in any order */
    double lo[3], hi[3];
    size_t polygons, by_class[NOC_CLASS_COUNT]; /* that wait to be counted */
    noc_building_use use;
    double storeys;
    bool outline;
} object_now;

typedef struct object_record {
    uint64_t place, shape; /* hashes: of id, kind and the cell of its middle; of its corners */
    float lo[3], hi[3];
    uint32_t input, kind, next[2];
} object_record;

typedef struct object_records {
    NOC_ARRAY(object_record) list;
    uint32_t *first[2]; /* chains by place and by shape: index + 1 */
    size_t size;        /* of both: a power of two */
} object_records;

/* The part of the inputs that is taken (box.c). */
typedef struct load_box {
    bool on;
    double lo[2], hi[2];
    geo_crs *crs; /* that they are in; NULL: the scene's, as it is given */
} load_box;

/* A building of a map that waits for the ground. */
typedef struct pending_footprint {
    geo_footprint footprint; /* local metres; texts and arrays in importer.names */
    size_t input;
} pending_footprint;

/* A track of a car that waits for the ground. */
typedef struct pending_track {
    geo_track track; /* local metres; texts and arrays in importer.names */
    size_t input;
} pending_track;

/* Meshes of the scene that a building came in. */
typedef struct taken_building {
    uint32_t first, end;
    size_t input;
    noc_building_use use;
} taken_building;

typedef struct importer {
    noc_log *log;
    noc_scene *scene;
    const noc_import_params *params;
    double memory; /* bytes that the scene may take */
    noc_report *report;
    struct luminaires *luminaires;
    struct city_profiles *profiles; /* NULL: lamps have none */
    load_box box;
    bool inspect;
    input *inputs;
    size_t input_count;
    expanded files; /* holds their paths' texts, until the report does */
    /* place of the scene (place.c) */
    bool placed;
    geo_crs *scene_crs; /* belongs to the scene; NULL: local metres */
    double origin[3];
    const char *placed_by; /* path of the input that settled it */
    bool far_said;         /* that an input lies far from the others */
    meeting_place meeting; /* under the lock */
    /* what was taken (take.c) */
    object_records records;
    int material[NOC_CLASS_COUNT][PALETTE]; /* index + 1 in the scene, 0 if not made yet */
    noc_map looks;                          /* what else surfaces look like (look.c) -> material */
    noc_map image_numbers;                  /* path and wrap -> place in images */
    NOC_ARRAY(scene_image) images;
    NOC_ARRAY(image_use) image_uses;
    size_t image_bytes;                  /* of those that lie in inputs */
    _Atomic size_t images_kept;          /* bytes of others */
    NOC_ARRAY(taken_building) buildings; /* where windows are asked for */
    NOC_ARRAY(city_outline) outlines;    /* buildings that were made of their outlines */
    size_t object_mesh;                  /* first mesh of the object that is being taken */
    bool has_roads;
    size_t first_mesh; /* of those that inputs are read into: what was there before, and built-in scenes, is whole */
    double open_area;  /* m2 of terrain, roads, pavements, lawns and water, seen from above */
    NOC_ARRAY(pending_footprint) footprints;
    NOC_ARRAY(geo_road) roads;         /* local metres; texts and coordinates in importer.names */
    noc_map road_places;               /* of those, by which a second one is told */
    struct city_roads *roads_by_place; /* of those, while lamps are stood whose road is asked for; NULL: it is not */
    NOC_ARRAY(pending_track) tracks;
    geo_triangles green, squares, lots; /* areas of maps that are drawn: lawns, pavements, roads; as water */
    geo_triangles water;                /* of maps that are read for their roads; local metres, z of no use */
    NOC_ARRAY(pending_lamp) lamps;
    size_t lamps_stray;          /* that strays_drop left out, and warned of */
    size_t streets_inferred;     /* along which lamps are placed by a rule */
    size_t lamp_looks;           /* lamps that repeat_lamps compared: for tests */
    noc_report_lamp lamp_now;    /* that is being stood (each_lamp.c) */
    NOC_ARRAY(given_place) lost; /* lamps that have no place in the scene's CRS */
    noc_arena names;
    size_t names_asked; /* bytes of it when take_kept asked last */
    /* progress */
    double bytes_total, bytes_before; /* of all inputs; of those that were taken */
    size_t scene_before;              /* bytes of the scene before the present input */
    bool cancelled;
    /* of the report's arena, of scene_crs, where readings make their ways to it, and of counts of rules */
    pthread_mutex_t lock;
} importer;

/* What a reading hands over. Texts and arrays are valid during the call. */
typedef struct part_surface {
    noc_class cls;
    size_t vertex_count, triangle_count;
    const double *xyz; /* local metres */
    const uint32_t *indices;
    const float *uv;          /* NULL: none */
    const surface_look *look; /* NULL: as surfaces of the class do */
} part_surface;

/* One file while it is read. */
typedef struct load_queue load_queue;
typedef struct load_side load_side;
typedef struct reading {
    importer *im;
    input *in;
    size_t index;
    noc_log *log;
    load_queue *queue; /* where all waits for the file's turn; NULL: it has it */
    load_side *side;   /* where all waits for its turn in the file; NULL: it has it */
    geo_sides sides;   /* its sink's */
    bool stopped;
    source_crs *source;      /* of the coordinates that come next */
    NOC_ARRAY(double) given; /* the points that are placed, as they were given */
    bool mesh_from_origin;   /* a mesh in metres from the scene's origin */
    /* the object that is being read (sink.c) */
    char *object_id;
    object_now now;
    int object_lod;
    geo_transform *to_box; /* NULL: none is needed */
    bool to_box_made;
    NOC_ARRAY(double) in_box; /* points, where the box is */
    NOC_ARRAY(double) scratch;
    geo_triangles surfaces[NOC_CLASS_COUNT];
    NOC_ARRAY(surface_look) looks;   /* of the file; appearance n is at n - 1 */
    NOC_ARRAY(uint32_t) first_group; /* of each look: + 1, 0: none */
    NOC_ARRAY(look_group) groups;    /* of the object; the first group_count are in use */
    size_t group_count;
    noc_arena look_texts;
    NOC_ARRAY(part_surface) parts; /* that are handed over */
} reading;

typedef struct load_part {
    enum {
        PART_OBJECT, /* surfaces of an object, or outside of any; `last` where it ends with them */
        PART_LAMP,
        PART_LOST,    /* a lamp without a place */
        PART_MESSAGE, /* of a file that is read before its turn */
        PART_QUIET    /* an error is told: none that follows is */
    } kind;
    union {
        struct {
            const char *id; /* NULL: outside of any */
            object_now now;
            bool last;
            size_t surface_count;
            const part_surface *surfaces;
        } object;
        pending_lamp lamp;
        given_place lost;
        struct {
            noc_log_level level;
            const char *text;
        } message;
    } u;
} load_part;

/* luminaires.c: rules for lamps, and groups of lights. */
typedef struct luminaires luminaires;
struct lamp_subject;
noc_status luminaires_start(importer *im); /* what is wrong with them is told before anything is read */
void luminaires_free(luminaires *l);
bool luminaires_ask_roads(const importer *im); /* which a lamp stands beside */
/* Roads that a lamp stands beside; NULL: none is known. */
typedef struct lamp_roads {
    const geo_road *street; /* the nearest that has a name */
    const geo_road *beside; /* the nearest, named or not */
} lamp_roads;
/* A lamp as the rules have it. Its fitting is the one given, for as long as that lives. in: its input; NULL: it is
 * placed by a rule. */
void luminaires_dress(importer *im, const input *in, lamp_roads roads, geo_lamp *lamp, geo_fitting *fitting);
void luminaires_dress_inferred(void *importer, geo_lamp *lamp, geo_fitting *fitting); /* city_lamp_params.dress */
/* Of one that is looked at and not stood: counts what the rules leave untold. */
void luminaires_see(importer *im, input *in, geo_lamp *lamp);
/* The group of the scene that a light is of; 0: none. */
int luminaires_group(importer *im, const struct lamp_subject *of);
/* Lights and meshes from those on are an input's that is no city. */
void luminaires_take(importer *im, const input *in, size_t first_light, size_t first_mesh);
noc_status luminaires_finish(importer *im); /* groups begin as they are said to; idle rules are told */
noc_status luminaires_say(importer *im);    /* what params say of groups at the end; all of a built city */

/* Windows of the scene that follow each other there: whose file they are of, and whether each counts as a window, or is
 * a further pane of one that does. */
typedef struct report_panes {
    uint32_t file, counts, panes;
} report_panes;

/* What a tile needs to know of a scene: meshes of a file, which are chosen as a whole by
 * where those from `from` to `to` lie, and lights of a lamp. */
typedef struct report_part {
    uint32_t first, end, file;
    bool whole;
    uint32_t from, to;
} report_part;
typedef struct report_lamp {
    uint32_t first, end, file;
} report_lamp;

/* each_lamp.c: what the report tells of each lamp, where params ask for it. */
/* A lamp is stood next, as the rules have it. matched: places of the rules. in NULL: it is placed by a rule, and what
 * no rule says of it (said: 1 << NOC_LAMP_HEIGHT ...) is assumed. */
void each_lamp_begin(importer *im, const input *in, lamp_roads roads, const geo_lamp *lamp, const char *matched,
                     unsigned said);
struct city_lamp_light;
void each_lamp_light(void *importer, const struct city_lamp_light *light); /* city_lamp_params.told */

struct noc_report {
    NOC_ARRAY(noc_report_lamp) lamps;
    const noc_report_rule *rules;
    size_t rule_count;
    const noc_group_info *groups;
    size_t group_count;
    noc_arena arena;
    NOC_ARRAY(noc_report_file) files;
    NOC_ARRAY(report_panes) panes; /* files are numbers of inputs until all are reported; */
    NOC_ARRAY(report_part) parts;  /* so are these, of which later ones win, */
    NOC_ARRAY(report_lamp) mapped; /* and these */
    size_t lamps_inferred;
    size_t road_cars; /* along roads of maps */
    size_t roads_drawn;
    size_t images_reduced;
    char profiles[160];
};

/* report.c */
noc_report *report_create(void); /* NULL: memory was refused */
/* Adds the file with the issues' lines; false, and the file is not in it, where memory is refused to it or was to the
 * issues. */
bool report_add(noc_report *report, const noc_report_file *file, const geo_issues *issues) NOC_MUST_USE;
/* One more window of the scene, of that file; false: memory was refused. */
bool report_pane(noc_report *report, size_t file, bool counts) NOC_MUST_USE;
/* Groups of lights, as the scene has them. */
noc_status report_groups(noc_report *report, const noc_scene *scene);
/* Counts what the lamp does not tell, but its direction. */
void report_assumed(noc_report_file *file, const geo_lamp *lamp);
/* The error that --strict makes of what was left out or guessed at; NOC_OK where nothing was. */
noc_status report_strict(const noc_report *report, const noc_import_params *params, noc_log *log);

/* readers.c: first reader in a NULL-ended list whose probe takes the head; NULL if none. */
extern const noc_reader *const noc_readers[];
const noc_reader *find_reader(const noc_reader *const *readers, const char *head, size_t size);

/* stranger.c: what to say of a file whose format is known, though it is not read; NULL where it is not known. */
const char *stranger_told(const char *head);

/* recognise.c */
#define BUILTIN "builtin:" /* and the name of a scene */
noc_status recognise_input(importer *im, input *in, const noc_reader *const *readers);
/* Of each folder what was left out is counted, and it is an error where that is all. */
noc_status recognise_told(const importer *im);

/* ahead.c: puts itself before a sink until the place is settled. */
struct look_ahead *ahead_create(reading *r, geo_sink *sink); /* NULL: memory was refused */
noc_status ahead_release(struct look_ahead *a); /* settles the place with what there is, and passes everything on */
void ahead_destroy(struct look_ahead *a);       /* NULL is allowed */

/* sink.c */
/* Of the object that is being read: those of each class, then those that look otherwise. */
static inline geo_triangles *triangles_of(reading *r, size_t i) {
    return i < NOC_CLASS_COUNT ? &r->surfaces[i] : &r->groups.data[i - NOC_CLASS_COUNT].triangles;
}
static inline void triangles_clear(geo_triangles *t) { t->xyz.len = t->uv.len = t->indices.len = 0; }
geo_sink sink_create(reading *r);
noc_status sink_flush(reading *r);
noc_status sink_hand_over(reading *r, const load_part *part); /* to the scene, or to where it waits */
/* What progress tells: of the whole load, where so much of that part of it is done. It never falls. */
typedef enum load_part_done { DONE_READING, DONE_LAMPS, DONE_WINDOWS } load_part_done;
#define LAMPS_PLACED 0.2 /* share of DONE_LAMPS that those along roads take */
double import_done(const importer *im, load_part_done part, double share);
/* Asks whether to go on; bytes: of all inputs, that were read. */
bool import_progress(importer *im, const input *in, double bytes);
void reading_free(reading *r);

/* footprints.c: of maps, which are read after all city models. */
noc_status footprint_keep(importer *im, input *in, size_t index, const geo_footprint *f);
/* Those that no city model has become blocks on the ground. */
noc_status footprints_stand(importer *im);

/* roads.c: of maps. */
bool roads_wanted(const importer *im);
noc_status road_keep(importer *im, input *in, const geo_road *road);
/* Where areas of a class are kept; NULL: they are of no use. */
geo_triangles *area_kept(importer *im, noc_class cls);
/* Surfaces of roads and areas, once the ground is there, where params want those. */
noc_status roads_pave(importer *im);
noc_status roads_name(importer *im); /* streets of the scene */

/* body.c: the user's own bodies. */
/* What the file of that option holds, as a scene of its own, z up; what and done: of progress. NULL: *status says why
 * not. */
noc_scene *body_read(importer *im, const char *path, const char *option, const char *what, double done,
                     noc_status *status);
/* That for lamps becomes a model of the scene. */
struct city_body;
noc_status body_load(importer *im, const char *path, struct city_body *body);

/* road_lamps.c: lamps along lit roads are added to those of the inputs. */
struct city_roads;
noc_status road_lamps_add(importer *im, const struct city_roads *roads);
/* Lamps that do not say which way they face look across the nearest road. */
void road_lamps_face(importer *im, const struct city_roads *roads);
/* Roads that a lamp at a place stands beside, where that is asked for. */
lamp_roads road_lamps_near(const importer *im, const double xy[2]);
/* Tells lamps with an elevation that stand on or beside the carriageways of bridges of maps, where others, too, tell
 * where the ground is. */
noc_status road_lamps_on_bridges(importer *im);
/* Levels the decks of bridges of maps over the ground, which must be there, and no roads on it; lamps on them stand
 * there.
 */
noc_status road_lamps_raise(importer *im);

/* cars.c: tracks of cars, and what cars look like. */
noc_status track_keep(importer *im, input *in, size_t index, const geo_track *track);
noc_status traffic_add(importer *im); /* cars along them */

/* height_unit.c: the unit of heights. */
noc_status height_unit_check(const noc_import_params *p, noc_log *log); /* of noc_import_params.height_unit */
noc_status height_unit_take(importer *im);                              /* gives inputs theirs */
/* Sets the unit of a CRS that the input names. */
void height_unit_settle(const input *in, source_crs *s);
/* sink_create's: the file has a unit of its own. */
noc_status height_unit_heights(void *reading, double metres);
double height_unit_now(void *reading);
const char *height_unit_name(double metres); /* "feet"; NULL: it has no name */
const char *height_unit_word(double metres); /* that --height-unit takes; NULL: none */

/* building_units.c: warns, and counts as guessed at, where heights of buildings or of their storeys are hardly in the
 * unit that they were read in, or where terrain lies a foot for each metre of theirs. */
bool units_see_building(importer *im, input *in, const object_now *now) NOC_MUST_USE; /* false: out of memory */
noc_status units_check_buildings(importer *im);
noc_status units_check_terrain(importer *im); /* once all surfaces are in */
/* Returns true if the input names a CRS in feet, or lies in the United States or Canada. */
bool units_of_feet(const source_crs *source, const double xy[2]);

/* faces.c: warns, and counts as guessed at, where the faces of nearly all closed buildings of a file look inwards. */
void faces_add(building_faces *f, const part_surface *surface);
void faces_end(input *in); /* of a building */
noc_status faces_check(importer *im);

/* units.c: warns where lamps hang higher than they do in their part of the world, and counts them as guessed at; then
 * of buildings. */
noc_status units_check(importer *im);
bool units_see_lamp(input *in, const pending_lamp *p) NOC_MUST_USE; /* false: memory was refused */
void units_forget(input *in);

/* box.c */
noc_status box_read(const noc_import_params *params, noc_log *log, load_box *box);
void box_free(load_box *box);
noc_status box_point(reading *r, const double *xyz, bool *inside); /* local metres */
noc_status box_line(reading *r, const double *xyz, size_t count, bool *inside);
/* Drops the surfaces of the object that is being read, where they are outside, or those triangles of a terrain. */
noc_status box_object(reading *r, bool *inside);

/* take.c: parts into the scene, in the order of the files. */
typedef struct taking {
    importer *im;
    input *in;
    noc_log *log, *of_scene;
} taking;
taking take_start(importer *im, input *in);
noc_status take_part(importer *im, input *in, const load_part *part);
/* Ends what take_start began, with the status that the file is read and taken with. */
noc_status take_finish(const taking *t, noc_status status);
/* Is what waits and what the scene holds, and will hold with so many bytes more, within the limits? Else reported. */
noc_status take_affords(importer *im, const input *in, size_t more);
/* The same, each time that so much more waits for the end of the load that it is worth asking. */
noc_status take_kept(importer *im, const input *in);
void take_destroy(importer *im);
int take_material(importer *im, noc_class cls, const char *id); /* of an object's surfaces; < 0: refused, and said */

/* look.c: what surfaces look like where files say it. */
noc_status look_number(reading *r, const geo_appearance *appearance, uint32_t *number); /* geo_sink.appearance */
/* Where triangles of that look and class go; NULL: memory was refused. */
geo_triangles *look_triangles(reading *r, uint32_t look, noc_class cls);
void look_end_object(reading *r);
void look_free(reading *r);
/* The material of such surfaces of the scene. */
noc_status look_material(importer *im, const input *in, noc_class cls, const surface_look *look, int *material);
/* mesh_place.image */
noc_status look_mesh_image(void *reading, int material, const mesh_image *image);
extern double look_least_pixels; /* that images of a load may have, beside some a byte; changed by tests alone */
void look_images_free(importer *im);
/* Reads the images, when all surfaces are there, and gives them to their materials. */
noc_status look_read_images(importer *im);

/* windows.c: windows on the walls of the buildings that were taken. */
noc_status windows_check(const noc_import_params *params, noc_log *log);
noc_status windows_add(importer *im);
/* Lights and counts those that a built-in scene came with, whose first in the scene has that number. */
noc_status windows_of_builtin(importer *im, input *in, size_t first);

/* repeat.c: what is given twice is taken once. */
bool same_file(const char *a, const char *b); /* whatever they are called: "a.csv", "./a.csv", a link */
bool repeat_file(importer *im, size_t index); /* is it one of those before it? Said and reported */
void repeat_polygon(object_now *now, noc_class cls, const double *xyz, size_t count); /* local metres */
/* Is it one that was taken? Decided once an object: in->object_decided and
 * in->object_repeated. Reported. */
noc_status repeat_object(importer *im, input *in, const object_now *now, const char *id);
noc_status repeat_lamps(importer *im); /* drops lamps that an earlier file holds */
void repeat_free(object_records *records);

/* strays.c: lamps that lie more than 20 km from all others are left out, reported and warned of; groups of them that
 * are no slips are warned of alone. */
noc_status strays_drop(importer *im);

/* doubles.c: a warning where most lamps of a file seem to be another file's. */
noc_status warn_of_doubles(const importer *im);

/* heights.c */
struct city_ground;
/* Lays surfaces whose heights are none on what stands around them, and says so. */
noc_status heights_of_surfaces(importer *im);
/* Forgets the lamps' heights of an input that are not of this city's system, with a warning. ground: NULL where the
 * scene's own is there. */
noc_status heights_check(importer *im, const struct city_ground *ground);
/* Lays the ground through those of the points (3 doubles each, changed) whose heights can be believed. */
void heights_lay(importer *im, struct city_ground *ground, double *points, size_t count);

/* lamps.c: ground where there is none, then lamps. */
noc_status finish_city(importer *im);

/* sources.c: files that no output may replace (noc_scene_add_source). */
/* Notes lists of inputs, files of the parameters, and the built city among the inputs (NULL: none). */
void sources_note_given(const importer *im, const char *const *paths, size_t count, const char *built);
/* Returns what notes the files that the reading's input names; valid as long as the reading. */
import_listener sources_listener(reading *r);

/* finish.c */
noc_status finish_environment(noc_scene *scene, const char *path); /* the map around the scene, by its file */
/* Of classes, once all is there that is of them, or a built city. */
noc_status finish_materials(noc_scene *scene, const noc_import_params *params);

/* at_once.c: reads the inputs, by their indices, on the threads of the pool but the caller's. There must be others. */
noc_status read_at_once(importer *im, const size_t *inputs, size_t count, noc_pool *pool);
/* Of a reading before its turn. NOC_ERR_MEMORY is told later. */
noc_status queue_put(load_queue *q, const importer *im, const load_part *part);
bool queue_progress(load_queue *q, double share); /* false: all is stopped */
void queue_claim(void *queue, double bytes);      /* import_budget.claim */

load_part part_copied(noc_arena *arena, load_part p); /* with texts and arrays of the arena's own */

/* side.c: readings of parts of a file before their turn. */
geo_sides sides_of(int threads); /* its sink's, where so many threads may read one file */
noc_status side_put(load_side *side, const load_part *part);

/* load.c: reads a file that is not built in. */
noc_status read_file(reading *r);

/* load.c: noc_scene_load and noc_inspect with a table of readers of one's own (tests bring theirs). */
noc_status load_inputs(noc_scene *scene, const noc_reader *const *readers, const char *const *paths, size_t path_count,
                       const noc_import_params *params, bool inspect, noc_report **report);

#endif
