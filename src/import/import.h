/* import: one reader a format, in one table; told apart by content. Readers emit into a geo_sink, or, for meshes that
 * are already triangles with materials, into a scene. What several families of formats need lies here; each family has
 * a folder of its own. */
#ifndef NOC_IMPORT_H
#define NOC_IMPORT_H

#include "geo/geo.h"
#include <nocturne/import.h>
#include <jansson.h>
#include <stdio.h>

/* budget.c: what reading one input may cost. */
typedef struct import_budget {
    double memory;    /* bytes */
    double expansion; /* times `stored`; 0: any */
    double stored;    /* bytes of the input and the files it names */
    double instances; /* points that instances of templates may place, a byte of `stored`; 0: any */
    /* Told of bytes that are much before they are taken, where several inputs are read at once; may wait. NULL: none.
     */
    void (*claim)(void *claimant, double bytes);
    void *claimant;
} import_budget;
import_budget import_budget_of(const noc_import_params *params);
/* How many threads work on so many items. params: NULL: one. */
size_t import_threads(const noc_import_params *params, size_t items);
/* NOC_ERR_MEMORY after reporting where `what` of the input would take more bytes than it may. */
noc_status import_affords(const import_budget *b, double bytes, const char *name, const char *what, noc_log *log);
/* NOC_ERR_MEMORY after reporting where instances of templates would place more points than they may. */
noc_status import_affords_instances(const import_budget *b, double points, const char *name, noc_log *log);
/* As import_affords, without a word. */
bool import_fits(const import_budget *b, double bytes);
/* Bytes that parsing it takes, at most and roughly; adds up over pieces. */
double import_json_cost(const char *text, size_t size);

/* map/package.c: writes a GeoPackage of a GeoJSON's features. Where GDAL is not there it is none, which is no error. */
noc_status map_write_package(const char *geojson, const char *path, noc_log *log);

/* json.c: json_load_callback, whose allocations may be refused. */
json_t *import_json_load(size_t (*from)(void *buffer, size_t size, void *user), void *user, size_t flags,
                         json_error_t *error);
/* Reports why it gave NULL, and returns the status. */
noc_status import_json_error(const json_error_t *error, const char *name, noc_log *log);

/* Sequential bytes of a plain, gzip or zip file (one member of a zip: the first whose name tells a model or map best).
 */
typedef struct noc_stream noc_stream;
/* NULL after reporting an error, which *status (may be NULL) gets; directories are an error. */
noc_stream *noc_stream_open(const char *path, noc_log *log, noc_status *status);
void noc_stream_close(noc_stream *s);
/* Up to size bytes; *got = 0 at the end. A truncated or damaged archive is NOC_ERR_FORMAT, reported. */
noc_status noc_stream_read(noc_stream *s, void *data, size_t size, size_t *got);
/* The whole content, with a 0 behind it; *data is NULL after an error, free() it otherwise. */
noc_status noc_stream_read_all(noc_stream *s, noc_log *log, char **data, size_t *size);
noc_status noc_stream_rewind(noc_stream *s);
const char *noc_stream_name(const noc_stream *s);    /* path, or path!member */
uint64_t noc_stream_size(const noc_stream *s);       /* bytes as stored */
uint64_t noc_stream_read_bytes(const noc_stream *s); /* how far it was read, whatever was read twice */
size_t noc_stream_unread(const noc_stream *s);       /* other members of a zip that look like models, too */
/* bytes followed the gzip data, and were ignored; known at the end */
bool noc_stream_trailing(const noc_stream *s);
void noc_stream_limit(noc_stream *s, const noc_import_params *params); /* the defaults' hold until it is called */
import_budget *noc_stream_budget(noc_stream *s);                       /* what compressed data grows to is held to it */
/* Receives the path of each regular file that the stream's file names, whether it is read or not, so that no output
 * replaces it. on_named is called by the reading thread; NULL: none. */
typedef struct import_listener {
    void (*on_named)(void *user, const char *path);
    void *user;
} import_listener;
void noc_stream_listen(noc_stream *s, import_listener listener);
const import_listener *noc_stream_listener(const noc_stream *s); /* valid as long as the stream */
/* Passes a file that the stream's file names, from its folder on, to the listener. Returns false if memory is refused.
 */
bool noc_stream_note_named(const noc_stream *s, const char *name) NOC_MUST_USE;
double noc_stream_progress(const noc_stream *s); /* share of the stored bytes consumed, 0..1 */

/* x3d.c: a diffuse colour, which is a display's as other programs take it; a specular colour and shininess, 0..1. */
void import_x3d_colour(geo_appearance *a, const double rgb[3]);
void import_x3d_gloss(geo_appearance *a, const double specular[3], double shininess);
void import_x3d_transparency(geo_appearance *a, double transparency, geo_issues *issues); /* NaN: not understood */

/* Files that another file names (beside.c). `folder` is that file's, with a slash at its end, or "" for the working
 * one. */
/* What keeps the file at path (as it is to be opened) from being read: it is not there, no regular file, or, unless
 * `anywhere`, lies outside the folder once links are followed. NULL if nothing does; else valid until the next call. */
const char *import_named_trouble(const char *folder, const char *path, bool anywhere);
/* Opens one for reading and tells its size. NULL with *why where there is trouble, and with a *why of NULL where memory
 * is refused. Never waits for a pipe. */
FILE *import_open_named(const char *folder, const char *name, bool anywhere, size_t *size, const char **why);
/* Passes the file of that name to the listener, which may be NULL. Returns false if memory is refused. */
bool import_note_named(const import_listener *listener, const char *folder, const char *name) NOC_MUST_USE;
/* All of it, with IMPORT_TAIL zeros behind; free() it. The listener gets its path. NULL as there, and where it has more
 * bytes than most (IMPORT_NAMED, or SIZE_MAX) or not all of it can be read. */
#define IMPORT_NAMED ((size_t)256 << 20)
#define IMPORT_TAIL 32
void *import_read_named(const char *folder, const char *name, bool anywhere, size_t most,
                        const import_listener *listener, size_t *size, const char **why);

#define MESH_COLOURED_GLASS "coloured glass, which lets light of every colour through alike"

/* An image that a material of a mesh looks like. */
typedef struct mesh_image {
    const char *name; /* of its file, as the file that is read has it; of one that lies in that, for messages */
    noc_wrap wrap;
    uint8_t cutoff;            /* where its alpha is smaller the surface has holes */
    float albedo[3];           /* that it is times */
    const unsigned char *data; /* size bytes that lie in the file that is read, copied; NULL: it is a file beside it */
    size_t size;
} mesh_image;

/* Takes a mesh's coordinates (x east, y north, z up, as the file has them) to the scene's frame, in place, and hears
 * which images materials of the scene look like. */
typedef struct mesh_place {
    void *ctx;
    noc_status (*points)(void *ctx, double *xyz, size_t count);
    noc_status (*image)(void *ctx, int material, const mesh_image *image); /* NULL: they are of no use */
} mesh_place;

/* noc_scene_add_mesh, with the triangles that it drops counted. false after reporting. */
bool import_triangles(noc_scene *scene, const noc_mesh *mesh, geo_issues *issues);

/* Where a reader of meshes puts materials and meshes, one by one. */
typedef struct mesh_parts {
    void *ctx;
    noc_log *log;
    geo_issues *issues;
    /* name: NULL: none. image: that it looks like where a mesh has places in it; NULL: none */
    noc_status (*material)(void *ctx, const noc_material *material, const char *name, const mesh_image *image,
                           int *index);
    /* the mesh's, as the file has them: may be moved */
    noc_status (*mesh)(void *ctx, noc_mesh *mesh, double *positions);
} mesh_parts;

/* Parts that go into a scene. */
typedef struct mesh_scene {
    noc_scene *scene;
    const mesh_place *place;
    geo_issues *issues;
} mesh_scene;
mesh_parts mesh_scene_parts(mesh_scene *to);

/* Threads that read one OBJ at most. */
#define OBJ_THREADS 16

typedef struct noc_reader {
    const char *name; /* "CityGML" */
    enum { NOC_READS_CITY, NOC_READS_MESH, NOC_READS_LAMPS, NOC_READS_TRACKS } reads;
    /* Does the beginning of the (decompressed) content look like this format? head is size bytes and then a 0. */
    bool (*probe)(const char *head, size_t size);
    /* The same of a file that the user names as lamps, asked where no probe knows it; may be NULL. */
    bool (*probe_named)(const char *head, size_t size);
    /* Reads everything. *format gets a static or interned description ("CityGML 2.0"). Exactly one of these is set. */
    noc_status (*read)(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format);
    noc_status (*read_mesh)(const char *path, noc_stream *stream, const noc_import_params *params, noc_scene *scene,
                            const mesh_place *place, geo_issues *issues, const char **format);
    /* Meshes that come as parts alone: read_mesh is then the same into a scene. */
    noc_status (*read_parts)(const char *path, noc_stream *stream, const noc_import_params *params,
                             const mesh_parts *parts, const char **format);
    /* Is this content read by a library that nothing stops (GDAL, Assimp)? Then remote/remote.c reads it. NULL: never.
     */
    bool (*foreign)(const char *head, size_t size);
    /* Returns true if files of that kind may name no CRS and have none by their format. NULL: they never do, or all. */
    bool (*without_crs)(const char *head, size_t size);
    /* Loads the library that this reader calls, where that is not there from the start; why not, or NULL. Readers call
     * it themselves: it is for who must have it before. NULL: nothing to load. */
    const char *(*load)(void);
    const char *missing; /* not NULL: this build lacks the part; the text says which */
} noc_reader;

/* The table, ended by a NULL name. */
extern const noc_reader noc_reader_citygml, noc_reader_cityjson, noc_reader_terrain, noc_reader_mesh, noc_reader_ply,
    noc_reader_gltf, noc_reader_overpass, noc_reader_tracks, noc_reader_vector;

#endif
