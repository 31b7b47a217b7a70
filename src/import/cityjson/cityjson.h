/* cityjson: CityJSON is CityGML's model in JSON, so its objects become those of citygml.h, one top-level object with
 * its parts at a time, and select.c, emit.c and lamp.c go on from there.
 *
 * A file is one JSON value (CityJSON), or many, one after the other (CityJSONSeq: a head, then a value a feature).
 * values.c reads them one by one, document.c what holds for all of a value's objects, object.c the objects, geometry.c
 * their surfaces, look.c what those look like. Memory is bounded by the largest value. */
#ifndef NOC_CITYJSON_H
#define NOC_CITYJSON_H

#include "import/citygml/citygml.h"

/* ---- the JSON values of a stream (values.c) ---- */

typedef struct cj_values {
    noc_stream *stream;
    geo_sink *sink;
    noc_status status; /* of the stream, of memory: already reported */
    char *data;        /* a piece of the stream */
    size_t at, len;
    unsigned long line;       /* of the next byte, from 1 */
    unsigned long first_line; /* of the value */
    /* of the value: how far it has been handed out */
    bool begun, ended, in_text, escaped;
    uint32_t depth;
    double cost, claimed; /* bytes that jansson takes for it */
    char key[16];         /* the last text of its own members */
    uint32_t key_len;
    bool in_objects;
    size_t objects; /* members of CityObjects as they are written: of equal ones JSON keeps the last */
} cj_values;

/* The next value; NULL at the end, and after an error, which v->status tells. json_decref() it. */
json_t *cj_values_next(cj_values *v);
void cj_values_free(cj_values *v);

/* ---- what holds for the objects of a value (document.c) ---- */

typedef struct cj_points {
    double *xyz; /* 3 a point; NaN for what is no point */
    size_t count;
} cj_points;

enum { CJ_MATERIAL, CJ_TEXTURE, CJ_LOOKS };
#define CJ_MOST_THEMES 32 /* of a geometry that are looked at */

/* An "appearance". */
typedef struct cj_looks {
    bool there;
    uint32_t *number[CJ_LOOKS]; /* of each material and texture: the parser's look; 0: of no use */
    size_t count[CJ_LOOKS];
    char *theme[CJ_LOOKS]; /* the default one; "": none */
    float *uv;             /* 2 a place */
    size_t uv_count;
} cj_looks;

typedef struct cj_reading {
    cg_parser *parser;
    cj_values values;
    uint32_t srs; /* of the parser's, CG_NONE */
    double scale[3], translate[3];
    bool transformed; /* the head says how */
    int version;      /* 1: 1.0, whose vertices need no transform; 2: 1.1; 3: 2.0; 0: not known */
    cj_points vertices, template_vertices;
    json_t *templates;              /* a list; NULL: none */
    cj_looks head_looks, own_looks; /* of the head, and of a feature that brings its own */
    noc_map known_looks;            /* what they say -> the parser's look */
    bool seen_head, sequence;
    char place[256];
} cj_reading;

/* "CityJSON", "CityJSONFeature" or what else it says it is; "" if nothing. */
const char *cj_text(const json_t *object, const char *key);

/* ---- objects (object.c) ---- */

/* Emits the members of "CityObjects". */
void cj_objects(cj_reading *r, json_t *objects);

/* ---- geometry (geometry.c) ---- */

/* Adds the surfaces of an object's geometries to its feature. */
void cj_geometries(cj_reading *r, uint32_t feature, const json_t *list);

/* ---- what surfaces look like (look.c) ---- */

/* The "appearance" of a value, which is let go, in place of what was there. */
void cj_looks_read(cj_reading *r, json_t *root, cj_looks *out);
void cj_looks_free(cj_looks *looks);

/* What a geometry's themes say of its surfaces. */
typedef struct cj_themes {
    const cj_looks *looks;
    const json_t *theme[CJ_LOOKS][CJ_MOST_THEMES];
    size_t count[CJ_LOOKS];
    bool missing; /* one of them names something that is not there */
} cj_themes;
cj_themes cj_themes_of(const cj_looks *looks, const json_t *geometry);
/* Of the surface at that place in lists so deep: the look that is its material, 0: none; its texture, a list for each
 * of its rings, NULL: none. */
uint32_t cj_material_at(cj_themes *t, const size_t *path, int depth);
const json_t *cj_texture_at(const cj_themes *t, const size_t *path, int depth);
/* Tells the parser where the ring that is read lies in an image. NULL: in none. */
void cj_ring_texture(cj_reading *r, cj_themes *t, const json_t *list);

#endif
