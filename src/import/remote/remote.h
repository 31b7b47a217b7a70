/* remote: reading by other people's libraries (GDAL, Assimp) in a process of its own, which can be stopped.
 *
 * The library starts the helper program nocturne-reader, tells it over a socket what to read, and takes what comes
 * back: the calls of a geo_sink, or materials and meshes. The helper limits itself (confine.c) and is killed
 * when the work is cancelled, takes too long or sends too much. It is the same library, so the records are the structs
 * as they lie in memory; but what comes back is not trusted: the helper may have been taken over by the file it read.
 * A second process of it keeps the one that reads (keep.c), and leaves nothing of it.
 */
#ifndef NOC_IMPORT_REMOTE_H
#define NOC_IMPORT_REMOTE_H

#include "import/import.h"

#include <sys/types.h>

#define REMOTE_FD 3        /* the helper's end of the socket */
#define REMOTE_NO_MEMORY 3 /* the helper's exit status where it has none for its answer */

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define REMOTE_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define REMOTE_SANITIZED
#endif

/* What a record is: first those of the request, then those that come back. */
enum {
    REMOTE_READER = 1, /* text: name of the reader */
    REMOTE_PATH,       /* text */
    REMOTE_OPTION,     /* texts: name and value of one import option */
    REMOTE_SINK,       /* remote_asked */
    REMOTE_CONDITION,  /* texts: key and test of one that rules or groups ask, in their order */
    REMOTE_GO,
    REMOTE_LOG = 32, /* level, text */
    REMOTE_CRS,      /* texts: srsName, place */
    REMOTE_LAMP,     /* geo_lamp, texts: id, ref, tags */
    REMOTE_MATERIAL, /* noc_material, text: its name, remote_image, text: its name */
    REMOTE_MESH,     /* remote_mesh, text: name, positions, indices, places in an image */
    REMOTE_ISSUE,    /* kind, count, texts: reason, examples */
    REMOTE_PROGRESS, /* double */
    REMOTE_COLUMNS,  /* points, count, and of each column values, mapped, texts: name, field, unit, example */
    REMOTE_FEATURES, /* geo_features */
    REMOTE_END,      /* remote_end, text: format */
    REMOTE_OBJECT,   /* remote_object, text: id */
    REMOTE_POLYGON,  /* class, count of rings, text: id, points of each ring, their coordinates */
    REMOTE_OBJECT_END,
    REMOTE_FOOTPRINT, /* remote_footprint, text: id, points of each ring, their coordinates */
    REMOTE_ROAD,      /* geo_road, texts: id, name, coordinates */
    REMOTE_AREA,      /* count of rings, class, text: id, points of each ring, their coordinates */
    REMOTE_TRACK,     /* count of parts, timed?, text: id, points of each part, their coordinates, their times */
    REMOTE_HEIGHTS,   /* double: metres of a unit of the heights that follow */
    REMOTE_NAMED,     /* text: path of a file that the input names */
};

typedef struct remote_head {
    uint32_t kind, size_high, size_low;
} remote_head;
typedef struct remote_asked {
    int32_t parent;
    uint32_t threads; /* that the helper may have */
    bool named_lamps, inspect, footprints, roads, named_tracks, each_lamp, given_metres, given_degrees;
} remote_asked;
typedef struct remote_object {
    int32_t kind, lod;
} remote_object;
typedef struct remote_footprint {
    uint64_t rings;
    double height, min_height, levels, min_level, roof_height;
    uint64_t use, bare;
} remote_footprint;
typedef struct remote_image {
    uint32_t there, wrap, cutoff;
    float albedo[3];
} remote_image;
typedef struct remote_mesh {
    uint64_t vertices, triangles;
    int32_t material;
    uint32_t places; /* 1: there are */
} remote_mesh;
typedef struct remote_end {
    int32_t status;
    bool trailing;
    uint64_t bytes_read, lamps_lost;
} remote_end;

/* ---- records (wire.c) ---- */

/* One that is written, or the bytes of one that is taken apart. */
typedef struct remote_record {
    NOC_ARRAY(char) bytes;
    size_t pos;
    bool bad;     /* taken apart: it is not what it should be */
    bool refused; /* written: memory was, so that it is not whole; stays set */
} remote_record;

void remote_put(remote_record *r, const void *data, size_t size);
void remote_put_text(remote_record *r, const char *text); /* NULL is "" */
bool remote_get(remote_record *r, void *data, size_t size);
const char *remote_get_text(remote_record *r);                               /* in the record; "" where it is bad */
const void *remote_get_array(remote_record *r, uint64_t count, size_t item); /* not aligned; NULL where it is bad */
/* Sends (out) or receives so many bytes; false where the other end is gone. */
bool remote_pass(int fd, void *data, size_t size, bool out);
/* Puts the record behind others, as what it is, and empties it. */
void remote_add(remote_record *batch, uint32_t kind, remote_record *r);
/* Sends all that was added, and empties it. false where nobody listens. */
bool remote_send(int fd, remote_record *batch);

/* ---- the request (request.c) ---- */

#define REMOTE_REQUEST_MOST (1 << 24) /* bytes of one of its records */

/* Its records, by the library. */
void remote_ask(remote_record *batch, const noc_reader *reader, const char *path, const noc_import_params *params,
                const geo_sink *sink);

typedef struct remote_request {
    const noc_reader *reader;
    const char *path;
    noc_import_params params;
    remote_asked sink;
    NOC_ARRAY(noc_condition) conditions; /* what `rule` asks, */
    noc_luminaire_rule rule;             /* params' only one */
    noc_arena texts;
} remote_request;

/* Takes it from the socket; false where it is none, or (texts.refused) memory was refused. */
bool remote_receive(int fd, remote_request *request);
void remote_request_free(remote_request *request); /* in any case */

/* ---- the library's side (remote.c, take.c) ---- */

typedef struct remote_result {
    char format[200];
    bool trailing;
    uint64_t bytes_read;
} remote_result;

/* Reads path by the reader in the helper. What it emits goes to the sink (its issues and its log, too), and to parts
 * where the reader reads meshes, paths of named files to the listener. sink->progress is asked twenty times a second.
 */
noc_status remote_read(const noc_reader *reader, const char *path, const noc_import_params *params, geo_sink *sink,
                       const mesh_parts *parts, const import_listener *listener, remote_result *result);

/* What comes back, and where it goes: all zero but for the first five. */
typedef struct remote_taker {
    const char *path;
    geo_sink *sink;
    const mesh_parts *parts;         /* NULL: of a map */
    const import_listener *listener; /* NULL: none */
    remote_result *result;
    NOC_ARRAY(char) bytes; /* that came and are not taken apart yet, from pos on */
    size_t pos;
    double done;
    bool ended;
    char *error;              /* that the helper told, until it ends: one is reported, with the status */
    NOC_ARRAY(int) materials; /* as the scene numbers them */
    bool placed, in_object;   /* a CRS was told; an object began and has not ended */
    NOC_ARRAY(size_t) rings;  /* of a polygon */
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(double) seconds; /* of a track */
} remote_taker;

/* Where `size` bytes more may be put, before bytes.len grows by what came. NULL after reporting. */
char *remote_room(remote_taker *t, size_t size);
/* Takes apart one record; false where none is there whole. *status: one error is reported where it is not NOC_OK. */
bool remote_take(remote_taker *t, noc_status *status);
void remote_taker_free(remote_taker *t);

/* ---- the helper's side (keep.c, serve.c, confine.c) ---- */

/* Makes this process the keeper of another one, which returns: true, and *parent: who started the keeper. The keeper
 * ends when that one has, in its way, after all that it has started. false: there can be none. */
bool remote_keep(pid_t *parent);
/* Limits this process: memory, processor time, no core file, no process more, and where the system can: no system calls
 * but those of reading, and of files those to be read by name, the folder's where `whole` (or all of them: anywhere),
 * the system's own, and the temporary folder where the file's format needs one. */
void remote_confine(const char *path, bool whole, const noc_import_params *params);
/* What may happen for want of Landlock, as a warning's text; NULL where it is there. */
const char *remote_short_of_fences(void);
/* Did this process take more than half of the memory that it may? Then a library may have failed because it wanted
 * more: lists that grow are doubled, and libraries seldom say that memory was refused. */
bool remote_short_of_memory(void);

#endif
