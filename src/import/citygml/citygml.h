/* citygml: one top-level city object at a time.
 *
 * The parser (parse.c) collects an object with everything below it in an arena: features, geometries, surfaces.
 * At its end select.c resolves references, chooses a level of detail and says which surfaces are shown, and
 * emit.c hands those to the sink. References into other objects are settled by further passes over the file
 * (citygml.c), so that memory is bounded by the largest object and by what is referenced across objects. */
#ifndef NOC_CITYGML_H
#define NOC_CITYGML_H

#include "import/import.h"
#include "import/xml.h"

#include <stdatomic.h>

#define CG_MAX_DEPTH 200 /* elements in elements */
#define CG_MAX_CRS 64    /* different srsNames in one file */
#define CG_MAX_KINDS 64  /* of objects that are left out, told apart */
#define CG_NONE UINT32_MAX
#define CG_EMITTED UINT32_MAX

/* ---- names (names.c) ---- */

typedef enum cg_code {
    CG_FOREIGN, /* not CityGML or GML, or of no use here: skipped with all in it */
    CG_PLAIN,   /* a property or wrapper without meaning of its own: looked into */
    CG_MODEL,
    CG_MEMBER,
    CG_FEATURE,           /* value: index into cg_feature_types */
    CG_GEOMETRY_PROPERTY, /* value: lod * 16 + role */
    CG_FUNCTION,          /* function, usage, class: tells roads from pavements */
    CG_LABEL,             /* name of an object, or the date of its end */
    CG_ATTRIBUTE,         /* generic attribute: with its name in XML (1.0, 2.0), or as an element (3.0) */
    CG_ATTRIBUTE_NAME,
    CG_ATTRIBUTE_VALUE, /* or that of a height */
    CG_HEIGHT,          /* of 3.0: measuredHeight before */
    CG_IMPLICIT,
    CG_MATRIX,
    CG_REFERENCE_POINT,
    CG_RELATIVE_GEOMETRY,
    CG_BOUNDED_BY,
    CG_ENVELOPE,
    CG_AGGREGATE,        /* MultiSurface, Solid, Surface, TriangulatedSurface, ... */
    CG_SURFACE_PROPERTY, /* surfaceMember, baseSurface, ...: may be an xlink */
    CG_ORIENTABLE,
    CG_POLYGON,
    CG_POINT,
    CG_EXTERIOR,
    CG_INTERIOR,
    CG_RING,
    CG_ARC,
    CG_POS_LIST,
    CG_POS,
    CG_COORDINATES,
} cg_code;

/* GML 3.3's compact ones: the coordinates of their only ring stand in the polygon, which closes by itself. */
enum { CG_SIMPLE = 1 };

typedef struct cg_name {
    uint8_t code;
    uint8_t value;   /* of CG_POLYGON: is it CG_SIMPLE? */
    uint8_t version; /* major CityGML version of the namespace, 0 where it is not CityGML's */
} cg_name;

/* What a geometry property says about its content. */
typedef enum cg_role { CG_ROLE_SURFACES, CG_ROLE_SOLID, CG_ROLE_FOOTPRINT, CG_ROLE_ROOF_EDGE } cg_role;

typedef enum cg_part {
    CG_PART_BODY,         /* an object or a part of it: chooses its level of detail */
    CG_PART_INSTALLATION, /* follows the body, but may stay at a lower level */
    CG_PART_SPACE,        /* groups others; its own geometry is empty space (3.0) */
    CG_PART_BOUNDARY,     /* a surface with a meaning: wall, traffic area, water surface */
    CG_PART_OPENING,
    CG_PART_GROUP,    /* CityObjectGroup: members written inside it are objects of their own */
    CG_PART_INTERIOR, /* counted, and skipped: a night view from outside needs no rooms */
    CG_PART_UNREAD,   /* skipped and counted */
} cg_part;

typedef struct cg_feature_type {
    const char *name;
    uint8_t part;
    uint8_t kind; /* geo_kind */
    uint8_t cls;  /* noc_class; OTHER in buildings: by the polygon's normal */
} cg_feature_type;

extern const cg_feature_type cg_feature_types[];
const cg_feature_type *cg_feature_type_of(const char *name); /* NULL: none is called so */

typedef struct cg_names {
    struct cg_name_slot *slots;
    size_t len;
    noc_arena arena;
} cg_names;
/* name as expat gives it: namespace, '\n', local name. */
cg_name cg_names_get(cg_names *names, const char *name);
void cg_names_free(cg_names *names);
const char *cg_local_name(const char *name);

/* ---- coordinates as text (text.c) ---- */

/* Collects numbers from character data that comes in pieces. */
/* In one polygon, and bytes of text in an appearance: 1 << 25; more is taken for an attack. Tests lower it. */
extern size_t cg_most_numbers;

typedef struct cg_numbers {
    NOC_ARRAY(double) values;
    bool many;      /* more than cg_most_numbers: the rest is not kept */
    char token[64]; /* a number cut by the end of a piece */
    uint32_t token_len;
    bool bad;             /* something that is no number */
    bool refused;         /* memory, to one of them; stays set */
    char cs, ts, decimal; /* gml:coordinates; 0, 0, '.' for lists separated by blanks */
    uint32_t tuple;       /* gml:coordinates: numbers a tuple, 0 before the first ended */
    uint32_t in_tuple;
    bool after_cs; /* nothing but blanks since the last separator of numbers */
} cg_numbers;

void cg_numbers_begin(cg_numbers *n, char decimal, char cs, char ts);
void cg_numbers_add(cg_numbers *n, const char *text, size_t size);
void cg_numbers_end(cg_numbers *n);

/* ---- one top-level object ---- */

typedef struct cg_polygon {
    const char *id; /* NULL if none */
    uint32_t srs;   /* index into parser.srs, CG_NONE if none applies */
    uint32_t ring_count;
    bool flat;      /* without heights: they are 0 until cg_fill_heights */
    uint32_t shown; /* selection it was last chosen in; 0: none; CG_EMITTED: stored, and given to the sink */
    const size_t *ring_size;
    double *xyz;                /* 3 a point, in the file's tuple order */
    const float *uv;            /* 2 a point, in the image of its texture; NULL where it has none */
    uint32_t texture, material; /* looks that the file gives it: cg_looks; 0: none */
    struct cg_polygon *copy;    /* in the store, NULL if none: one, however many ids lead to it */
} cg_polygon;

typedef struct cg_surface {
    cg_polygon *polygon; /* or NULL: a reference */
    const char *href;    /* id without '#'; NULL also where the reference leads out of the file */
    uint32_t geometry;
    bool flip;
} cg_surface;

typedef struct cg_implicit {
    double matrix[16]; /* row by row */
    double point[3];
    uint32_t srs;
    bool has_point;
} cg_implicit;

typedef struct cg_geometry {
    uint8_t lod, role;
    uint32_t feature;
    cg_implicit *implicit; /* NULL for coordinates in the CRS */
} cg_geometry;

typedef struct cg_feature {
    const cg_feature_type *type;
    const char *id; /* "" if none */
    uint32_t parent;
    int function;                            /* noc_class told by function, usage or class, -1 if none */
    uint32_t first_attribute, end_attribute; /* among these are its own, and those of its parts */
    uint32_t attributes;
    uint32_t first_geometry, end_geometry; /* its own, and those of its parts */
    double height;                         /* m, measuredHeight of a building or a part of one; 0: it does not say */
} cg_feature;

/* Where an id leads: a run of surfaces in document order. */
typedef struct cg_target {
    const char *id;
    uint32_t first, count;
    bool flip; /* orientation in force outside the element with this id */
} cg_target;

/* What an object, or a part of it that may be a lamp, says of itself, in its order: "class", "function", "usage",
 * "name", "terminationDate" (2.0), "validTo" (3.0), and generic attributes. */
typedef struct cg_attribute {
    const char *key, *value;
    uint32_t feature;
    bool generic;
} cg_attribute;

typedef struct cg_object {
    noc_arena arena;
    NOC_ARRAY(cg_attribute) attributes;
    bool has_point;  /* a geometry that is a point: the first */
    double point[3]; /* in the file's tuple order; height NaN in two dimensions */
    uint32_t point_srs;
    noc_building_use use; /* of a building, by what tells it best: use_rank, 0 where nothing does */
    int use_rank;
    double storeys;                 /* of a building, above the ground; 0: it does not say */
    bool other_function;            /* a code of the standard's list says that it is something other than a lamp */
    NOC_ARRAY(cg_feature) features; /* the first is the object itself */
    NOC_ARRAY(cg_geometry) geometries;
    NOC_ARRAY(cg_surface) surfaces;
    NOC_ARRAY(cg_target) targets;
    noc_map ids;  /* of targets, once a reference asks */
    size_t steps; /* references followed so far */
} cg_object;

/* A surface with references followed. */
typedef struct cg_item {
    cg_polygon *polygon; /* NULL: nothing here (yet) */
    uint32_t geometry;
    bool flip, shown;
    bool twin;      /* not shown, for the same shape is already */
    bool local;     /* written as part of an implicit geometry: its coordinates are no places */
    bool stored;    /* a copy of another object's surface */
    bool elsewhere; /* that other object shows it */
} cg_item;

/* A body's choice; unused for features that belong to another body. */
typedef struct cg_body {
    uint32_t owner;          /* the body of this feature */
    uint8_t levels, waiting; /* bit i: has geometry of level i; has references of level i that lead nowhere yet */
    int8_t lod;              /* chosen, -1 if none */
    bool boundaries;         /* at that level there are surfaces with a meaning */
} cg_body;

typedef struct cg_selection {
    NOC_ARRAY(cg_item) items;
    NOC_ARRAY(const char *) missing; /* ids that no surface of this object and no stored one has */
    NOC_ARRAY(uint64_t) shapes;      /* hash set of the shapes already shown; 0: free slot */
    NOC_ARRAY(cg_body) bodies;       /* parallel to the object's features */
    int lod;                         /* of the object; -1: nothing to show */
    bool tangled;                    /* some references led in circles or multiplied each other, and were given up */
    bool above;                      /* there is geometry, but only over the highest level asked for */
    size_t shown, duplicates;
} cg_selection;

/* ---- references between objects ---- */

/* What other objects refer to: copies that live as long as the import. */
typedef struct cg_stored {
    NOC_ARRAY(cg_item) items; /* elsewhere: its own object shows it */
    bool found;
} cg_stored;

typedef struct cg_store {
    noc_arena arena;
    noc_map wanted; /* id -> index into entries */
    NOC_ARRAY(cg_stored) entries;
    size_t item_bytes; /* of all their lists */
} cg_store;

/* ---- what surfaces look like (look.c) ---- */

/* A texture or a material of an appearance. */
typedef struct cg_look {
    bool material;
    geo_appearance as;
    double diffuse[3], specular[3], emissive[3], shininess, transparency; /* of a material, as written */
} cg_look;

/* Where a ring's points are in an image. */
typedef struct cg_ring_image {
    uint32_t look;       /* from 1 */
    size_t first, count; /* numbers in uv, points */
} cg_ring_image;

typedef struct cg_looks {
    NOC_ARRAY(cg_look) all; /* look n is at n - 1 */
    NOC_ARRAY(cg_ring_image) rings;
    NOC_ARRAY(float) uv;
    noc_map by_ring;   /* id -> index into rings */
    noc_map by_target; /* id -> material */
    noc_map pairs;     /* material and texture -> number that the sink gave */
    /* of the one being read */
    bool inside, front;
    cg_ring_image given; /* of the ring at hand, where no id leads to it: of CityJSON; its look 0: none */
    NOC_ARRAY(char) text;
    NOC_ARRAY(uint32_t) lists; /* rings of the list of coordinates at hand */
    size_t named;              /* of them, by elements that follow */
    char *reference;           /* an attribute that says what is meant, or NULL */
    char *target;              /* of the texture coordinates that are read */
} cg_looks;

/* ---- the parser ---- */

typedef struct cg_frame {
    cg_name name;
    bool flip;
    bool in_reference_point, in_point, in_attribute;
    uint32_t feature, geometry, srs;
    uint32_t dimension;     /* srsDimension, 0 where not given */
    uint32_t first_surface; /* of an element with an id */
    size_t first_polygon;   /* of cg_parser.polygons */
    bool of_points;         /* a Tin's control points are in it */
    const char *id;
} cg_frame;

typedef struct cg_parser {
    XML_Parser xml;    /* NULL: objects come from JSON (import/cityjson/) */
    const char *place; /* of what is read, for errors, where no XML says it */
    bool ahead;        /* it reads members before their turn (members.c), and must not say anything */
    size_t lines;      /* of members before, that others have read */
    const noc_import_params *params;
    noc_stream *stream;
    geo_sink *sink;
    int max_lod;
    const char **format;
    noc_status status;
    int pass;    /* 0: appearances; 1, 2, 3 */
    int version; /* major, 0 until seen */

    cg_names names;
    cg_frame frames[CG_MAX_DEPTH];
    uint32_t depth;
    uint32_t skip; /* elements open inside a skipped one, itself included */

    cg_object object;
    cg_selection selection;
    size_t ordinal;                      /* of the top-level object, from 1 */
    NOC_ARRAY(size_t) deferred;          /* ordinals that wait for surfaces of other objects, ascending */
    size_t deferred_next, deferred_kept; /* position in it; of those seen in the second pass, how many wait on */
    cg_store store;
    cg_looks looks;
    uint32_t selections; /* marks polygons as shown in the present selection */

    /* polygon being read */
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(size_t) rings;
    const char *polygon_id;
    NOC_ARRAY(char) terrain_id; /* ids of triangles must not pile up in the arena */
    bool in_polygon, in_ring, ring_exterior, has_exterior;
    size_t polygons;           /* begun so far */
    bool polygon_flat;         /* its rings have no heights */
    bool ring_flat, ring_high; /* points of the ring without heights, and with them */
    bool polygon_counted;      /* a fault of one of its rings has been reported */
    NOC_ARRAY(char) ring_id;   /* of the ring, "" if none */
    NOC_ARRAY(float) ring_uv;  /* of the polygon's rings, as far as they have any */
    uint32_t polygon_texture;  /* of its rings; 0: none */
    uint32_t polygon_material; /* that is told with it; 0: none, or by its id */
    bool polygon_unplaced;     /* a ring of it is in no image, or in another one */
    const char *ring_fault;    /* why the ring cannot be used, NULL if it can */
    bool ring_curved;
    size_t ring_first; /* index into xyz of the ring's first number */
    cg_numbers numbers;
    enum { CG_TEXT_NONE, CG_TEXT_NUMBERS, CG_TEXT_WORD } text;
    char word[128];
    uint32_t word_len;
    bool plateau_code;      /* the code list named beside the word is one of Project PLATEAU */
    bool foreign_code;      /* it is neither that nor the standard's */
    char attribute[128];    /* name of the generic attribute being read */
    char uom[32];           /* unit of its value, "" if none is said */
    struct lamp_keys *keys; /* what attributes of lamps mean */

    /* CRSs in the order met; names live in the arena */
    noc_arena persistent;
    struct {
        const char *name;
        const char *place; /* where the file says so: "city.gml:12" */
    } srs[CG_MAX_CRS];
    uint32_t srs_count;
    uint32_t sink_srs; /* the one the sink was told last; CG_UNTOLD before the first */
    bool lat_first;

    /* scratch of the emitter */
    NOC_ARRAY(double) out;
    NOC_ARRAY(size_t) out_rings;
    NOC_ARRAY(float) out_uv;
    bool object_open;               /* begin_object was called and end_object not yet */
    size_t emitted, dropped, twins; /* polygons: used; there already; of these with the shape of another one */
    double instanced;               /* points that instances of templates have placed */
    size_t looked;                  /* features and surfaces looked at for installed lamps, since progress was asked */
} cg_parser;

#define CG_UNTOLD (UINT32_MAX - 1)

/* citygml.c: a parser that has read nothing yet. NULL after reporting. */
cg_parser *cg_parser_create(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format);
void cg_parser_destroy(cg_parser *p);
/* What is told of a file that has been read; nothing is freed. */
noc_status cg_parser_end(cg_parser *p);

/* look.c: gathers what the file's appearances say, where they are asked for, and rewinds it. */
noc_status cg_read_looks(cg_parser *p);
void cg_looks_free(cg_looks *looks);
/* Counts what is left out of a material. */
void cg_material_left_out(cg_parser *p, const cg_look *look);
noc_wrap cg_wrap_of(const char *mode);
/* Of a ring of so many points that is good: its place in an image, into p->ring_uv. report_id: for what is wrong. */
void cg_ring_look(cg_parser *p, const char *id, size_t points, const char *report_id);
uint32_t cg_material_of(const cg_parser *p, const char *id); /* 0: none */
/* Gives the object's surfaces the materials of what they are in. */
void cg_spread_materials(cg_parser *p);
/* The sink's number for a material and a texture, either may be 0. */
uint32_t cg_appearance_of(cg_parser *p, uint32_t material, uint32_t texture);
/* citygml.c: one pass over the file by these handlers. */
typedef struct cg_handlers {
    XML_StartElementHandler start;
    XML_EndElementHandler end;
    XML_CharacterDataHandler text;
} cg_handlers;
noc_status cg_parse(cg_parser *p, int pass, const cg_handlers *handlers);

/* p->xml, ready to read a text from its beginning. False: memory was refused. */
bool cg_open(cg_parser *p, const cg_handlers *handlers);
noc_status cg_ask(void *parser); /* whether to go on */
/* What comes of a text that expat was given. */
noc_status cg_after(cg_parser *p, noc_status status, xml_fault fault);

/* members.c: reads the stream by p->xml, members by several threads where the sink has sides. The same comes of it for
 * any number of them. */
noc_status cg_read_members(cg_parser *p, const cg_handlers *handlers);
extern size_t cg_members_at_once;      /* bytes of a piece that a thread reads; tests and fuzzers set it */
extern atomic_size_t cg_members_ahead; /* pieces that were of use before their turn: for tests */

/* parse.c: expat handlers; user data is the parser. */
void cg_start_element(void *user, const XML_Char *name, const XML_Char **attributes);
void cg_end_element(void *user, const XML_Char *name);
void cg_characters(void *user, const XML_Char *text, int size);
/* Reports "file:line: cause", stops the parser, and returns the status. Handlers do nothing from then on: where memory
 * is refused (cg_no_memory) what was half built is freed with the parser. */
noc_status cg_fail(cg_parser *p, noc_status status, const char *fmt, ...) NOC_PRINTF(3, 4);
noc_status cg_no_memory(cg_parser *p);
/* Counts a defect of the file; once, though the file may be read several times. */
void cg_issue(cg_parser *p, geo_issue_kind kind, const char *reason, const char *id);
/* Stops the parser where what an object or the store takes is over the input's limits. */
void cg_affords(cg_parser *p, size_t bytes, const char *what);
/* Whether the object may still grow; false after an error. */
bool cg_object_room(cg_parser *p);
/* Index of a CRS that the file names at `place`; new ones are kept for the whole import. */
uint32_t cg_srs(cg_parser *p, const char *name, const char *place);
/* A new object (parent CG_NONE) or a part of one. CG_NONE where nothing of it is read, which is counted. */
uint32_t cg_feature_add(cg_parser *p, const cg_feature_type *type, const char *id, uint32_t parent);
/* A word that the feature says of itself: `key` is function, usage, class, name, terminationDate or validTo. */
void cg_word_add(cg_parser *p, uint32_t feature, const char *key, const char *word);

/* False where the parser reads ahead: it stops, for this must be done in its turn. */
bool cg_in_turn(cg_parser *p);
double cg_progress(const cg_parser *p); /* share of the file that is read */

void cg_object_clear(cg_object *object);
void cg_object_free(cg_object *object);

/* attribute.c: what objects say of themselves. */
bool cg_attribute_start(cg_parser *p, cg_frame *frame, const char *name); /* false: of no use */
void cg_note_building(cg_parser *p, uint32_t feature, const char *key, const char *word);
void cg_attribute_add(cg_parser *p, uint32_t feature, const char *key, const char *value, bool generic);
void cg_attribute_end(cg_parser *p, const cg_frame *frame); /* of a name or a value */
/* Not a generic one; NULL if there is none. */
const char *cg_attribute_get(const cg_object *object, uint32_t feature, const char *key);
/* May an object of this type be a lamp? */
bool cg_may_be_lamp(const cg_feature_type *type);

/* lamp.c: objects that are lamps. True where the object is one, and has been dealt with. */
bool cg_emit_lamp(cg_parser *p);
/* The installations of an object that are lamps. Their surfaces stay with it, but for blocks around a light, which give
 * way to it. */
void cg_emit_installed_lamps(cg_parser *p);

/* ring.c: rings and polygons from coordinates. */
void cg_polygon_begin(cg_parser *p, const char *id, bool simple);
void cg_polygon_end(cg_parser *p, const cg_frame *frame);
void cg_ring_begin(cg_parser *p, bool exterior, const char *id);
void cg_ring_end(cg_parser *p, const cg_frame *frame);
/* The numbers collected are tuples of the ring: dimension 2 or 3, 0: as many as a position has. */
void cg_ring_add(cg_parser *p, cg_code code, uint32_t dimension);
/* id for reports: the polygon's, else the nearest feature's that has one, else what the object is. Never NULL. */
const char *cg_report_id(const cg_parser *p, const char *polygon_id, uint32_t feature);

/* select.c */
void cg_resolve(cg_parser *p); /* surfaces and stored ones -> selection.items, .missing */
/* Appends what an id leads to, for a surface of that geometry. */
void cg_follow(cg_parser *p, const char *id, uint32_t geometry, bool flip);
void cg_select(cg_parser *p);                                                       /* level of detail, what is shown */
int cg_function_class(const cg_feature_type *type, const char *word, bool plateau); /* noc_class or -1 */
bool cg_standard_function(const char *word); /* a code of the standard's list for city furniture */

/* unread.c */
/* Counts an element that is not read, where it is an object or of a geometry. parent may be NULL. */
void cg_unread(cg_parser *p, const cg_frame *frame, cg_frame *parent, const char *name);
/* An aggregate has ended: counts a Tin of points alone. */
void cg_tin_end(cg_parser *p, const cg_frame *frame);
/* Gives surfaces without heights the lowest one of those of the object that have some, and counts them. */
void cg_fill_heights(cg_parser *p);

/* emit.c */
void cg_object_end(cg_parser *p); /* a top-level object is complete */
void cg_emit_polygon(cg_parser *p, const cg_polygon *polygon, uint32_t geometry, bool flip);
void cg_tell_crs(cg_parser *p, uint32_t srs); /* to the sink, of what comes next */
/* A polygon's points into p->out, p->out_rings: easting northing height, placed and turned over where asked. */
void cg_transform(cg_parser *p, const cg_polygon *polygon, const cg_implicit *implicit, bool flip);
void cg_place_point(const cg_parser *p, const cg_implicit *implicit, double *point); /* of a prototype */
/* Metres a unit of x and y about a point: 1, but for degrees. */
void cg_metres(const cg_parser *p, const double *point, double *east, double *north);
void cg_emit_begin(cg_parser *p); /* the object, where it has not begun */
/* block.c: an object of flat outlines with heights, as blocks. false: it is none, and nothing was done. */
bool cg_emit_blocks(cg_parser *p);
void cg_emit_shown(cg_parser *p);              /* the selected surfaces, as an object */
size_t cg_kinds_told(const cg_parser *p);      /* of objects that were left out */
void cg_stop(cg_parser *p, noc_status status); /* of the sink, which has reported it */
void cg_emit_end(cg_parser *p);                /* closes the sink's object if one is open */
void cg_store_free(cg_store *store);

#endif
