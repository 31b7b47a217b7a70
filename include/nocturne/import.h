/* nocturne/import.h: from files to a scene. Inputs are told apart by content, never by name: CityGML and CityJSON
 * (plain, .gz, .zip); OBJ, PLY, glTF and GLB; terrain as GeoTIFF; OpenStreetMap XML and PBF, Overpass JSON, GeoJSON,
 * GeoJSONSeq, GeoPackage, Shapefile (also zipped), FlatGeobuf, GML, ArcGIS JSON, CSV; tracks of cars as GPX. Several
 * inputs make one scene. */
#ifndef NOCTURNE_IMPORT_H
#define NOCTURNE_IMPORT_H

#include <nocturne/luminaire.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum noc_obj_up { NOC_OBJ_UP_Y, NOC_OBJ_UP_Z } noc_obj_up;

/* Properties of a lamp that are assumed where its file does not have them. The first three are set by the defaults
 * lamp_height, lamp_lumens and lamp_kelvin of noc_import_params, the direction is random. */
typedef enum noc_lamp_default {
    NOC_LAMP_HEIGHT,
    NOC_LAMP_FLUX,
    NOC_LAMP_COLOUR,
    /* The direction is random, and the same for the same place, where the lamp has none and no road or building is near
     * it. Counted for lamps in a scene whose light depends on it: the axis is tilted, the distribution differs between
     * its C planes by more than 5 % of its peak, or the head is more than 0.5 m off the pole's axis. */
    NOC_LAMP_DIRECTION,
    /* lm/W of a lamp that has watts, and neither flux nor source, nor a rule or a profile's file that has one: 80 */
    NOC_LAMP_EFFICACY,
    NOC_LAMP_DEFAULT_COUNT
} noc_lamp_default;

/* false and true are OFF and ON */
typedef enum noc_switch { NOC_SWITCH_OFF, NOC_SWITCH_ON, NOC_SWITCH_AUTO } noc_switch;

/* What a material that inputs name (noc_scene_find_material) is made of. What is negative stays as its file has it. */
typedef struct noc_named_material {
    const char *name;
    float albedo[3]; /* in place of an image, too */
    float f0, roughness;
    float metalness; /* noc_material_metal, of what the others make of it */
} noc_named_material;

#define NOC_TEXTS 32

/* An option that may be given several times. The texts are the caller's, and stay as long as the params are used. */
typedef struct noc_texts {
    const char *text[NOC_TEXTS];
    size_t count;
} noc_texts;

typedef enum noc_driving_side { NOC_DRIVE_RIGHT, NOC_DRIVE_LEFT } noc_driving_side;

/* Cars (docs/traffic.md). */
typedef struct noc_traffic_params {
    double spacing; /* m between cars of a lane on a main road; other roads have fewer, by their class; default 60 */
    double speed;   /* km/h, on roads that tell no limit and on tracks without times; 0, the default: by the road's
                       class, on tracks 40 */
    noc_driving_side side; /* of the road that is driven on; default right */
    double time;           /* s: where on their ways the cars are when the load ends (noc_scene_set_time); default 0 */
    double headlamp;       /* lm, of one headlamp; default 700 */
    double tail_lamp;      /* cd, of one tail lamp straight back; default 8 */
    uint32_t seed;         /* another number, other cars */
    /* The user's own bodies for cars: OBJ, PLY or glTF files, each as often as the others. z is up, the front looks
     * along -y (a glTF's +z), metres; the lowest point stands on the road, the middle of the bounds is on the route.
     * Lamps lie on meshes that are called "headlight" and "taillight" (or -lamp, and front-, rear-), else where they
     * usually are on a car of these bounds. Emission of the files is not seen. Default none: bodies of ours */
    noc_texts bodies;
    double body_length; /* m that such a body is scaled to; 0, the default: it is as long as its file says, 1 to 30 m */
} noc_traffic_params;

#define NOC_TRAFFIC_DEFAULTS(set) set(spacing, 60) set(headlamp, 700) set(tail_lamp, 8) set(seed, 1)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_traffic_params, noc_traffic_default_params, NOC_TRAFFIC_DEFAULTS)
#else
#define noc_traffic_default_params() ((noc_traffic_params){ NOC_TRAFFIC_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

typedef struct noc_import_params {
    /* CRS of inputs that name none (any PROJ definition), NULL: such inputs fail if they need one. It replaces what
     * cities name, with a warning, where their coordinates fit it and no input is there that may name none */
    const char *crs;
    /* "FILE=CRS": CRS of inputs in place of the one that they name. FILE is an input, the end of its path, or a pattern
     * of either; an error if no input is called so. Of several for one input the last counts */
    noc_texts file_crs;
    /* "FILE=UNIT", or "UNIT" of all: unit of the heights (z) of city models, terrain and lamps' feet, and of heights of
     * buildings in maps that name none: "m", "ft", "us-ft", "dm", "cm", "mm". FILE as in file_crs. Of several for one
     * input the last counts. Default: what the file or its CRS names, else the unit of x and y, metres of degrees */
    noc_texts height_unit;
    /* CRS of the scene; NULL: the first input's if projected in metres, else UTM of its centre. Where its
     * lengths are not those of the ground, the scene is computed in UTM: noc_scene_info.given_crs */
    const char *scene_crs;
    /* "X0,Y0,X1,Y1" or "X0,Y0,X1,Y1,CRS": the part that is taken of city models and lamps, in that CRS, else in the
     * scene's: objects whose box meets it, terrain by whole triangles. Meshes and built-in scenes are whole. NULL: all
     */
    const char *bbox;
    /* highest level of detail of CityGML and CityJSON taken, 0..4; default 3. The best one at or under it wins */
    int lod;
    double terrain_error;  /* m that triangles may lie off the heights of a GeoTIFF; default 0.25 */
    int terrain_triangles; /* that one may become, with a larger error where that takes one; default 500000 */
    bool footprints;       /* outlines of buildings in maps become blocks, where no city model has a building; default
                              false */
    /* Surfaces of the roads and paths of maps, on the ground? AUTO, the default: with footprints, where no city model
     * has roads of its own. ON: always. */
    noc_switch map_surfaces;
    double building_height; /* m, of those that tell neither height nor storeys; default 9 */
    /* Place lamps by a rule? AUTO, the default: along lit streets of maps that have none, whatever other streets have,
     * unless the inputs hold lights of another kind; where nothing shines then, along streets or buildings; inputs
     * whose lamps are all of no use are an error. ON: the same beside other lights, and where no lamp of the inputs is
     * of use. OFF: nowhere. */
    noc_switch infer_lamps;
    bool strict; /* an input of which anything is left out or guessed at is an error, and so are lamps placed by a
                    rule that infer_lamps does not ask for by ON; default false */
    double lamp_height; /* m, where not tagged; default 6 */
    double lamp_lumens; /* lm, where neither flux nor wattage is known; default 5000 */
    double lamp_kelvin; /* K, where not known; default 3000 */
    /* Maintenance factor: what lamps of files, by rules and of builtin:city give of their flux, not windows and cars;
     * 1, the default, as lamps are measured or sold */
    double maintenance;
    bool profiles;            /* lamps have luminous intensity distributions, built-in ones by their kind; default true.
                                 false: Lambertian discs, spheres that shine alike to all sides */
    const char *lamp_profile; /* a luminaire's file (IES, EULUMDAT) of all lamps that no rule gives another; NULL, the
                                 default: built-in ones */
    /* The user's own body for lamps that stand on poles or hang on walls: an OBJ, a PLY or a glTF, shown by instances.
     * z is up, its front looks along -y (a glTF's +z), metres. A mesh that is called "light" (not shown), or a glTF's
     * light, is where it shines: then it is a whole lamp, which stands on 0 and is scaled to the lamp's height. Else it
     * is a head, which shines from 0 downwards, on poles of ours. NULL, the default: bodies of ours */
    const char *lamp_body;
    unsigned lamp_chosen; /* those of these three that are the caller's own word, so that strict lets them stand in for
                             what lamps do not tell: 1 << NOC_LAMP_HEIGHT and so on; 1 << NOC_LAMP_DIRECTION lets chance
                             pass; default 0 */
    /* Windows on the walls of buildings? AUTO, the default, and ON: on those of every city model. OFF: nowhere. */
    noc_switch windows;
    noc_window_params window;
    noc_texts lamps; /* files that hold lamps whatever their words say: each of their points is one, unless its status
                        says that it is gone. Read with the others; one that is among them is read once */
    noc_texts lamp_columns; /* "field=column", several separated by commas: what a table's column, an attribute or a tag
                               is read as. height_ft=H says a unit. Fields: height, lumens, watts, kelvin, colour,
                               source, direction, count, mount, status, id, ele, lon, lat, x, y, wkt, latlon */
    /* Cars? AUTO, the default: one along each track that inputs hold. ON: also along the roads of maps. OFF: none. */
    noc_switch traffic;
    noc_traffic_params cars;
    noc_texts tracks; /* files whose lines are tracks of cars. Read with the others; one that is among them is read
                         once */
    /* axis of OBJ files that points up (they do not say it); default y, as most programs write */
    noc_obj_up obj_up;
    bool allow_outside; /* files that an input names (mtllib, glTF buffers, parts of a Shapefile) may lie anywhere;
                           default: below the input's folder alone, links followed. Nothing is ever fetched from a
                           network */
    bool isolate; /* OBJ and map files are read by the program nocturne-reader, which is started for each of them, may
                     read that file and its parts alone, and is ended when the call is cancelled; default true. It is
                     looked for beside the library, in a folder nocturne there, and where the environment's
                     NOCTURNE_READER says. false: in this process, where nothing stops the libraries that read */
    /* Limits on what one input may cost. Messages name them; what would be larger is NOC_ERR_MEMORY. */
    double reader_time;   /* s that a file may take which nocturne-reader reads; default 600 */
    double max_memory;    /* GB (1e9 bytes) that reading an input may take, in nocturne-reader, too; 0, the default:
                             three quarters of the machine's */
    double max_expansion; /* times its stored size that it may grow to, where that is over 1 GiB; 0: any; default
                             200 */
    double max_instances; /* points that instances of templates (CityGML, CityJSON) may place, a byte of its stored
                             size, where they are over 10 million; 0: any; default 5 */
    /* an equirectangular picture (EXR, Radiance HDR) for noc_scene_set_environment; NULL, the default: none */
    const char *environment;
    bool textures; /* surfaces look as city models say: images and colours of their appearances; default true */
    /* MB (1e6 bytes) that their images take in the scene, with their pyramids: they are reduced by halves, the largest
     * first, until they fit; default 512 */
    double texture_memory;
    bool wet; /* after rain: roads, pavements, terrain and ground are noc_material_wet; default false */
    /* What surfaces of these classes are made of, one a class, in place of noc_class_material and of the colours that
     * walls and roofs of real cities vary between; not owned; default none. Emission is not read */
    const noc_material *materials;
    size_t material_count;
    /* The same of those that inputs name, after the former; one that no input names is warned of, with those that there
     * are. Not owned; default none */
    const noc_named_material *named_materials;
    size_t named_material_count;
    /* Rules for lamps, and groups of lights, in their order; not owned; default none */
    const noc_luminaire_rule *luminaires;
    size_t luminaire_count;
    const noc_group_rule *groups;
    size_t group_count;
    noc_texts group_states; /* "NAME=STATE", as noc_scene_say_group has it: of groups once all is there; default none */
    bool each_lamp;         /* the report tells of each lamp's lights: noc_report_get_lamp; default false */
    const noc_builtin_params *builtin; /* of built-in scenes among the inputs, not owned; NULL, the default: theirs */
    int threads; /* that read files of cities at once, read an OBJ, and make windows; 0, the default: one a core. The
                  * scene is the same for any number */
    noc_progress progress;
} noc_import_params;

#define NOC_IMPORT_DEFAULTS(set)                                                                                       \
    set(lod, 3) set(building_height, 9) set(terrain_error, 0.25) set(terrain_triangles, 500000)                        \
        set(infer_lamps, NOC_SWITCH_AUTO) set(map_surfaces, NOC_SWITCH_AUTO) set(lamp_height, 6)                       \
            set(lamp_lumens, 5000) set(lamp_kelvin, 3000) set(maintenance, 1) set(profiles, true) set(textures, true)  \
                set(texture_memory, 512) set(windows, NOC_SWITCH_AUTO) set(traffic, NOC_SWITCH_AUTO)                   \
                    set(isolate, true) set(reader_time, 600) set(max_expansion, 200) set(max_instances, 5)
#ifdef __cplusplus
#define NOC_IMPORT_ALL_DEFAULTS(set)                                                                                   \
    set(window, noc_window_default_params()) set(cars, noc_traffic_default_params()) NOC_IMPORT_DEFAULTS(set)
NOC_DEFAULT_PARAMS(noc_import_params, noc_import_default_params, NOC_IMPORT_ALL_DEFAULTS)
#else
#define noc_import_default_params()                                                                                    \
    ((noc_import_params){ .window = { NOC_WINDOW_DEFAULTS(NOC_DEFAULT_IN_C) },                                         \
                          .cars = { NOC_TRAFFIC_DEFAULTS(NOC_DEFAULT_IN_C) },                                          \
                          NOC_IMPORT_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* What holds the process that reads other people's formats (noc_import_params.isolate) here: "files by Landlock, system
 * calls by seccomp", or which of them the build or the system lacks. */
NOC_API const char *noc_isolation(void);

/* Why a feature was skipped or repaired: a short reason, how often, and the ids of the first few. */
typedef struct noc_report_line {
    const char *reason; /* "self-intersecting ring", "unresolved xlink", ... */
    bool repaired;      /* true: used after repair, or where it is not lossless by a guess; false: skipped */
    size_t count;
    const char *examples; /* up to 5 ids, comma separated */
    bool lossless;        /* nothing is lost or guessed by it, so noc_import_params.strict lets it pass */
} noc_report_line;

NOC_API const char *noc_lamp_source_name(noc_lamp_source source); /* "unknown", "LED", "sodium", ... */

/* A column of a table, an attribute or a tag, and what it was read as. */
typedef struct noc_report_column {
    const char *name;    /* as in the file */
    const char *field;   /* "height", "watts", ...: a name of noc_import_params.lamp_columns; "kind" where its values
                            say what is a lamp, "description" where they say what lamp it is; "" where it is not used */
    const char *unit;    /* of values that name none: "m", "ft", "W", ...; "" where there is none */
    const char *example; /* the first value, cut short; "" where all are blank */
    size_t values;       /* that are not blank */
    bool mapped;         /* by noc_import_params.lamp_columns */
} noc_report_column;

/* Windows of a city's buildings, and their walls by what became of them. */
typedef struct noc_window_counts {
    size_t windows;
    size_t own;                      /* of them: of the models, not made */
    size_t lit;                      /* of them, by lit_windows and hour of the load */
    size_t buildings[NOC_USE_COUNT]; /* whose walls were looked at */
    size_t walls[NOC_WALL_VERDICT_COUNT];
    double area[NOC_WALL_VERDICT_COUNT]; /* of those walls, m2 */
} noc_window_counts;

typedef struct noc_report_file {
    const char *path, *format;  /* "CityGML 2.0", "GeoJSON", ... */
    const char *crs;            /* as understood: "EPSG:25832 (ETRS89 / UTM zone 32N)", "" if none */
    const char *crs_given;      /* as spelled in the file, "" if none */
    bool crs_taken;             /* the file names none: it is its format's, or what its numbers tell */
    bool crs_overridden;        /* crs is noc_import_params.file_crs's or crs's, whatever the file names */
    double height_unit;         /* of its heights [m]; 0: no coordinates were read, or a mesh's */
    const char *height_unit_by; /* what the unit follows from: "by its CRS", ...; "" where height_unit is 0 */
    uint64_t bytes;             /* as stored */
    uint64_t bytes_read;        /* after decompression */
    double seconds;             /* that reading took; 0: of a built city, which does not keep it */
    bool has_extent;
    bool degrees;                        /* the extent's x and y are longitude and latitude */
    double extent_min[3], extent_max[3]; /* in the file's CRS, easting northing height (x y z) order */
    size_t objects;                      /* top-level features */
    size_t buildings;
    size_t polygons; /* used */
    size_t polygons_by_class[NOC_CLASS_COUNT];
    size_t lod_used[5]; /* buildings by the level of detail that was taken */
    size_t triangles, lamps, lights;
    noc_window_counts windows;
    size_t images;       /* that surfaces of it have their colours from; of several files the first's */
    size_t points;       /* of a table or map: lamps or not */
    size_t column_count; /* of a table or map, in its order; of maps with tags, those of its lamps */
    const noc_report_column *columns;
    size_t lamp_heads; /* of all lamps: each makes a light; a lamp that does not tell has one */
    size_t lamps_with_height, lamps_with_lumens, lamps_with_watts, lamps_with_colour, lamps_with_direction; /* tagged */
    size_t lamps_with_kelvin;                /* of those with a colour */
    double lamp_height_min, lamp_height_max; /* of those tagged, m */
    /* the same */
    double lamp_lumens_min, lamp_lumens_max, lamp_watts_min, lamp_watts_max, lamp_kelvin_min, lamp_kelvin_max;
    char decimal_sign; /* of a CSV: '.' or ','; '?' where its numbers do not tell; 0: no CSV */
    size_t lamps_by_source[NOC_SOURCE_COUNT];
    /* Lamps that do not tell it themselves, so that a default is taken: of those mapped, and of all where no scene was
     * loaded. Watts tell the flux, and most sources the colour. By noc_lamp_default; directions of mapped lamps alone.
     */
    size_t lamps_assumed[NOC_LAMP_DEFAULT_COUNT];
    /* Where a scene was loaded, lamps by what became of them; those in use are mapped. */
    size_t lamps_mapped;     /* stand in the scene */
    size_t lamps_moved;      /* of them: out of a building, or away from another lamp */
    size_t lamps_dropped;    /* of no use: outside the city, in a building, without a place (alone where none was) */
    size_t lamps_repeated;   /* that another file holds, too, or the file twice: taken once, and counted there */
    size_t objects_repeated; /* the same of objects; of a file's own, too */
    size_t tracks;           /* of cars, that can be driven */
    size_t cars;             /* along them */
    /* Of a map: its features by their geometry, whether they are read or not; of OpenStreetMap only points are in
     * these. */
    size_t map_points, map_lines, map_areas;
    size_t buildings_unread, streets_unread; /* of OpenStreetMap, by the tags of ways and relations */
    /* Roads of a map, read unless noc_import_params.infer_lamps is OFF, and those of them that are tagged as lit */
    size_t roads, roads_lit, railways;
    double road_metres, road_metres_lit;
    size_t line_count;
    const noc_report_line *lines;
} noc_report_file;

/* What became of a rule of noc_import_params.luminaires. */
typedef struct noc_report_rule {
    const char *place; /* noc_luminaire_rule.place, or "rule 1", ... */
    size_t lamps;      /* that it matched: in the scene, and of all where none was loaded */
} noc_report_rule;

/* A light of a lamp, and what it was made of: noc_import_params.each_lamp. Texts are the report's, "" where there is
 * none. */
typedef struct noc_report_lamp {
    size_t light;       /* its index in the scene, for noc_scene_get_light, which tells the rest */
    const char *file;   /* path of the input that holds it; "": it was placed by a rule */
    const char *street; /* name of the nearest road that has one, within 25 m; "" where no roads were read, as lamps are
                         * those of a load that asks for no report */
    const char *road;   /* what the nearest road is there: a value of OpenStreetMap's highway */
    const char *rules;  /* places of those of noc_import_params.luminaires that matched: "a.yaml:4; a.yaml:7" */
    const char *profile; /* name of a built-in one, or of the file that a rule or lamp_profile says */
    /* its tags, attributes or columns as its file has them, "key=value" a line; whole ones, as many as fit into 2 kB */
    const char *tags;
    double height;    /* m, of the light above its lamp's foot; NaN: there is no ground there */
    double direction; /* degrees clockwise from the scene's y axis, to where the lamp faces */
    double watts;     /* NaN: neither its file nor a rule tells them */
    /* which of its properties are defaults, or the program's choice where it placed the lamp: 1 << NOC_LAMP_HEIGHT and
     * so on */
    unsigned assumed;
} noc_report_lamp;

/* Sums over the files of a report. */
typedef struct noc_report_totals {
    size_t objects, buildings;
    uint64_t bytes_read;                             /* after decompression */
    size_t lamps_mapped, lamps_moved, lamps_dropped; /* as in noc_report_file */
    size_t lamps_repeated, objects_repeated;
    size_t lamps_inferred;                        /* placed by a rule */
    size_t roads_drawn;                           /* roads of maps that surfaces were made of */
    char profiles[160];                           /* of lamps: "cobra-head 40, post-top 3"; "": none have any */
    size_t lamps_assumed[NOC_LAMP_DEFAULT_COUNT]; /* as in noc_report_file */
    noc_window_counts windows;
    size_t tracks;                     /* as in noc_report_file */
    size_t cars, road_cars;            /* along tracks and along roads of maps, and the latter */
    size_t images, images_reduced;     /* of all; of them: by halves, to fit into noc_import_params.texture_memory */
    size_t skipped, repaired, guessed; /* features: counts of the files' lines; guessed are those of repaired that are
                                        not lossless */
} noc_report_totals;

typedef struct noc_report noc_report; /* owned by the caller */

NOC_API size_t noc_report_file_count(const noc_report *report);
NOC_API const noc_report_file *noc_report_get_file(const noc_report *report, size_t index);
/* all 0 where report is NULL */
NOC_API void noc_report_get_totals(const noc_report *report, noc_report_totals *totals);
/* Groups of the scene that was loaded, by their index there, as noc_scene_groups has them: the first has the lights of
 * none. NULL beyond the last. */
NOC_API const noc_group_info *noc_report_get_group(const noc_report *report, size_t index);
/* The rules in their order; NULL beyond the last. */
NOC_API const noc_report_rule *noc_report_get_rule(const noc_report *report, size_t index);
/* Lights of lamps, as noc_import_params.each_lamp asks for, by their index in the scene; NULL beyond the last. A built
 * city keeps none. */
NOC_API const noc_report_lamp *noc_report_get_lamp(const noc_report *report, size_t index);
/* That of a light of the scene; NULL: it tells nothing of it. */
NOC_API const noc_report_lamp *noc_report_find_lamp(const noc_report *report, size_t light);
/* Counts lit windows and groups of lights anew, as the scene that was loaded has them since edits were committed.
 * NOC_ERR_ARGUMENT: one of them is NULL; NOC_ERR_MEMORY. */
NOC_API noc_status noc_report_follow(noc_report *report, const noc_scene *scene);
NOC_API void noc_report_destroy(noc_report *report);

/* A path may be a folder (all files in it and below, by name; what is in no format that is read is left out, and told),
 * a pattern of the shell's (where no file is called so), or "@LIST": a file with an input a line, from its own folder
 * on. Loads all paths, and the files of lamps in params, into the scene as one, stands the lamps on the ground, and
 * commits. "builtin:NAME" is the built-in scene of that name; such scenes come before all files. Built
 * cities (nocturne/built.h) are inputs by themselves, one or several, into an empty scene. A scene that is committed
 * takes no load: that is NOC_ERR_ARGUMENT, and the scene stays as it is. After any other failure the scene must be
 * destroyed. *report may be NULL; where given it is set even on failure (possibly NULL). */
NOC_API noc_status noc_scene_load(noc_scene *scene, const char *const *paths, size_t path_count,
                                  const noc_import_params *params, noc_report **report);

/* Reads one file (or what a folder, a pattern or a list stands for, as one) into a throwaway scene and reports what it
 * holds; used by `nocturne info`. A file without a CRS is fine, and so is a table of which nothing tells that its
 * points are lamps. Files of lamps in params are not read: only whether the path is one of them counts. */
NOC_API noc_status noc_inspect(noc_log *log, const char *path, const noc_import_params *params, noc_report **report);

/* All that the program nocturne-reader does: its main. Not for others to call. Returns its exit status, or does not
 * return. */
NOC_API int noc_reader_main(void);

/* Converts between the scene's local frame and any CRS (NULL: the scene's own, noc_scene_info.given_crs). xyz in place,
 * easting northing height (or longitude latitude height in degrees) order. */
NOC_API noc_status noc_scene_to_local(const noc_scene *scene, const char *crs, double xyz[3]);
NOC_API noc_status noc_scene_from_local(const noc_scene *scene, const char *crs, double xyz[3]);
/* The same of many points, 3 numbers each; those that have no place in the other become NaN, and are no error. */
NOC_API noc_status noc_scene_to_local_all(const noc_scene *scene, const char *crs, double *xyz, size_t count);
NOC_API noc_status noc_scene_from_local_all(const noc_scene *scene, const char *crs, double *xyz, size_t count);

/* A CRS (NULL: the scene's own) as WKT 2 without its heights, as GDAL and QGIS read it; free() it. NULL: the scene has
 * no CRS, or after reporting one that is not understood. */
NOC_API char *noc_scene_crs_wkt(const noc_scene *scene, const char *crs);

/* Where a camera stands, as people say it: noc_camera_options. The texts are the caller's. */
typedef struct noc_camera_params {
    noc_viewpoint viewpoint;  /* a camera derived from the scene, where eye is NULL; default own */
    const char *eye, *target; /* "X,Y,Z", both or none: local metres, or in crs */
    const char *crs; /* of eye and target: any that PROJ reads, or "scene" for the scene's; NULL: local metres */
    double fov;      /* vertical field of view, degrees; 0, the default: that of the view, with eye 50 */
    const char *photo_points; /* file of a photograph's points, in place of eye: noc_scene_photo_camera; NULL: none */
} noc_camera_params;

#define NOC_CAMERA_DEFAULTS(set) set(viewpoint, NOC_VIEWPOINT_OWN)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_camera_params, noc_camera_default_params, NOC_CAMERA_DEFAULTS)
#else
#define noc_camera_default_params() ((noc_camera_params){ NOC_CAMERA_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* The camera that params say, of a committed scene; aspect = width / height of the picture. NOC_ERR_ARGUMENT after
 * reporting it: texts that say no place, and an eye from which nothing of the scene can be seen, more than 100 km and
 * 100 times the scene's extent away. One more than 20 extents away is warned of, and *far_away, which may be NULL, says
 * so. */
NOC_API noc_status noc_scene_place_camera(const noc_scene *scene, const noc_camera_params *params, double aspect,
                                          noc_camera *camera, bool *far_away);

typedef struct noc_photo_info {
    int width, height; /* of the photograph, pixels */
    size_t points;
    double residual; /* pixels of the photograph: noc_camera_align */
} noc_photo_info;

/* The camera of a photograph by noc_camera_align, from a table (CSV) of its points. Its first row is the photograph's
 * width and height, each other one a pixel and the place that it shows: px,py,x,y,z, the place in crs, as in
 * noc_camera_params, where NULL is the scene's CRS, or local metres where it has none. Empty rows, and those that begin
 * with a letter or #, are passed over. info may be NULL. NOC_ERR_IO, NOC_ERR_FORMAT with the line, or what
 * noc_camera_align returns, after reporting it. */
NOC_API noc_status noc_scene_photo_camera(const noc_scene *scene, const char *path, const char *crs, noc_camera *camera,
                                          noc_photo_info *info);

#ifdef __cplusplus
}
#endif
#endif
