/* What tags and table columns say about a lamp: shared by every reader of lamps.
 *
 * Keys are compared after folding: accents dropped, lower case, letters and digits only, so that `light:count`,
 * `LIGHT_COUNT` and `Light count` are one key. OSM tags and the columns of municipal inventories use the same table
 * (columns.c), in several languages. */
#ifndef NOC_LAMP_TAGS_H
#define NOC_LAMP_TAGS_H

#include "import/import.h"

typedef struct lamp_tag {
    const char *key, *value; /* value NULL or "": not given */
    unsigned known;          /* lamp_keys_know of the key, where a reader asked once for many tags; 0: not asked */
} lamp_tag;

/* ---- what keys mean (keys.c, verdict.c) ---- */

typedef enum lamp_unit { LAMP_METRES, LAMP_WATTS, LAMP_LUMENS, LAMP_KELVIN, LAMP_PLAIN } lamp_unit;

typedef enum lamp_field {
    LAMP_FIELD_NONE,
    LAMP_FIELD_HEIGHT,
    LAMP_FIELD_DIRECTION,
    LAMP_FIELD_COUNT,
    LAMP_FIELD_LUMENS,
    LAMP_FIELD_WATTS,
    LAMP_FIELD_KELVIN,
    LAMP_FIELD_COLOUR,
    LAMP_FIELD_TYPE,
    LAMP_FIELD_MOUNT,
    LAMP_FIELD_STATUS,
    LAMP_FIELD_ID,
    LAMP_FIELD_ELEVATION,
    LAMP_FIELD_LON,
    LAMP_FIELD_LAT,
    LAMP_FIELD_X,
    LAMP_FIELD_Y,
    LAMP_FIELD_WKT,
    LAMP_FIELD_LAT_LON,
    LAMP_FIELD_TOTAL
} lamp_field;

/* What a key tells of whether a lamp shines on a street. */
typedef enum lamp_role {
    LAMP_ROLE_NONE,
    LAMP_ROLE_GONE,
    LAMP_ROLE_INDOORS,
    LAMP_ROLE_LOCATION,
    LAMP_ROLE_WHY_NOT,
    LAMP_ROLE_WORKS,
    LAMP_ROLE_WORKS_NOT
} lamp_role;

/* What a key's yes and no say. */
typedef enum lamp_asks {
    LAMP_ASKS_NOT,
    LAMP_ASKS_WORDS, /* "no" in a column of lamps: there is none (lamp, light) */
    LAMP_ASKS,       /* is there a lamp? (has_light) */
    LAMP_ASKS_ALONE  /* the same, and a table's points that are told to have one are lamps (is_streetlight) */
} lamp_asks;

/* What a key means. */
typedef struct lamp_meaning {
    lamp_field field;
    int rank;         /* 0 is believed first where several columns speak of the same; -1: mapped by the user */
    int strength;     /* towards lamp_columns_tell, which asks for 2 */
    double scale;     /* of values without a unit: .3048 where the key says feet */
    const char *unit; /* "ft", "W", ...; "" where the field has none */
    bool unit_named;  /* by the key or by the user: the unit is no default */
    lamp_role role;
    lamp_asks asks;
    bool makes;     /* a key of tags that make a lamp (highway, man_made, ...) */
    bool unnamed;   /* a column of a table without a header, which is not mapped: its values alone tell of it */
    bool flags;     /* of a column of status: all its values are yes and no, or 0 and 1, and it has both */
    bool dims;      /* tells how far a lamp is dimmed */
    bool free_text; /* says nothing of lamps by its name, and its values may: lamp_model_stands_alone */
    unsigned after; /* such a key begins there, after a lifecycle prefix ("disused:"); 0: none */
} lamp_meaning;

/* role, asks, makes and after of a key. */
void lamp_roles_of(const char *key, lamp_meaning *meaning);

/* In which unit the values of a field are; LAMP_PLAIN: in none. */
lamp_unit lamp_field_unit(lamp_field field);

/* By the words alone. Field NONE where they do not know it. */
lamp_meaning lamp_meaning_of(const char *key);

/* ---- quantities (quantity.c) ---- */

/* Which number of several was taken, where a text names several of one thing. All but LAMP_ONE are guesses. */
typedef enum lamp_choice {
    LAMP_ONE,       /* there was one, or a plain sum or product */
    LAMP_FIRST,     /* "70/100", "6;8", "70 W, 100 W": the first */
    LAMP_MIDDLE,    /* "100-150", "6 to 8 m": the middle of the range */
    LAMP_HEADS_EACH /* "2 - 150": sooner two of 150 W than a range from 2 to 150 */
} lamp_choice;

typedef struct lamp_number {
    double value; /* of a head, in the unit asked for */
    int times;    /* the factor of "2x70 W", "2@70", "70 W x 2"; else 1. More than GEO_MAX_HEADS are in the value */
    int terms;    /* of the sum of "70 W + 18 W", which is the value; else 1 */
    lamp_choice choice;
    bool unit;       /* it names one */
    const char *end; /* behind it in the text */
} lamp_number;

/* ---- what was and what is (present.c) ---- */

enum { LAMP_PRESENT = 256 };
/* What text says of the lamp that is there, the rest blanked: of "HPS 70W replaced by LED 30W" the LED. False where it
 * speaks of no other one, or is longer than LAMP_PRESENT: present is not to be read. */
bool lamp_present(const char *text, char present[LAMP_PRESENT]);

/* ---- free text (model.c) ---- */

/* What a description of a lamp says ("HPS 250W AERO", "2x36W PL-L/830"). */
typedef struct lamp_model {
    int source;                   /* geo_lamp.source */
    double watts, lumens, kelvin; /* of a head; NaN: not said */
    int heads, terms;             /* 0: not said; of the sum that the watts are */
    lamp_choice choice, lumens_choice, kelvin_choice;
    bool unit, clear_unit; /* the watts name theirs; by a word that means nothing else where it stands */
    int clear;             /* how much a name of its source means that: 0 to 2 */
    bool unclear;          /* LAMP_SOURCES_DIFFER */
    bool strange;          /* it names no source, and has words that are not understood: "BF 125W" */
    bool bare;             /* the watts are a number beside LED, which may count its LEDs: "48 LED" */
    bool diodes;           /* its LEDs by number and current, no watts: "48 LED 350mA" */
    bool dimmed, share;    /* it says that the lamp is dimmed; it has a number of % */
    bool plain;            /* it is the name of a source, with watts or without, and nothing else */
} lamp_model;
/* watts_column: a number without a unit is watts, wherever it stands. decimal: as in lamp_quantity. */
lamp_model lamp_model_of(const char *text, bool watts_column, char decimal);
/* May it be believed in a column whose name says nothing of lamps? Watts with their unit may, and a source that is all
 * that the text says, or that has its watts behind it. */
bool lamp_model_stands_alone(const lamp_model *model);

/* ---- keys of a file (keys.c) ---- */

/* The keys of one file: what they mean, by words and by --lamp-columns, and which values they had. */
typedef struct lamp_keys lamp_keys;
lamp_keys *lamp_keys_create(const noc_import_params *params); /* params may be NULL. NULL: memory was refused */
void lamp_keys_destroy(lamp_keys *keys);
lamp_meaning lamp_keys_meaning(lamp_keys *keys, const char *name); /* keys may be NULL: by the words alone */
/* A number for the key, which makes asking about its tags fast; 0 where there are too many keys. */
unsigned lamp_keys_know(lamp_keys *keys, const char *name);
lamp_meaning lamp_tag_meaning(lamp_keys *keys, const lamp_tag *tag); /* keys may be NULL */
/* The file's decimal sign, by the numbers in its columns of places and quantities: '.' or ','; 0 where they disagree or
 * do not tell. */
void lamp_keys_weigh(lamp_keys *keys, const lamp_tag *tag);
/* Looks at a value of a column of status, before any is read: lamp_meaning.flags. keys may be NULL. */
void lamp_keys_flag(lamp_keys *keys, const lamp_tag *tag);
char lamp_keys_decimal(const lamp_keys *keys); /* keys may be NULL */
/* Asks what params' rules and groups want to know of the tags of a lamp (geo_lamp.holds, tells_street), and keeps the
 * tags themselves until the next lamp where params ask for them (geo_lamp.tags); keys may be NULL: none. */
void lamp_keys_ask(lamp_keys *keys, const lamp_tag *tags, size_t count, geo_lamp *lamp);
/* Counts values that are not understood one by one, until lamp_keys_report tells of them; false: memory was refused. */
bool lamp_keys_count_unread(lamp_keys *keys) NOC_MUST_USE;
/* A value that is not understood; keys may be NULL, and issues. */
void lamp_keys_unread(lamp_keys *keys, const char *reason, const char *text, const lamp_tag *column, const char *id,
                      geo_issues *issues);
/* lamp_model_of, remembered. keys may be NULL. */
lamp_model lamp_keys_model(lamp_keys *keys, const char *text, bool watts_column);
/* Notes a tag's value for the table of columns; blank ones count as none. */
void lamp_keys_note(lamp_keys *keys, const lamp_tag *tag);
/* The values of this key say what is a lamp: its field is "kind". */
void lamp_keys_tell(lamp_keys *keys, const char *name);
/* Columns of places are read as such only where this is said of them: a place was read from it. */
void lamp_keys_placed(lamp_keys *keys, const char *name);
/* A description was read from a column that is called otherwise; keys may be NULL. */
void lamp_keys_described(lamp_keys *keys, const lamp_tag *tag);
/* A value of a column of sources was understood: where none is, it is not one. keys may be NULL. */
void lamp_keys_understood(lamp_keys *keys, const lamp_tag *tag);
/* Does the user name a column by that number, from 1 on ("#2")? */
bool lamp_keys_number(const lamp_keys *keys, size_t number);
/* The table has no header: what its columns are called by are values, which mean nothing unless they are mapped. */
void lamp_keys_headless(lamp_keys *keys);
/* Does the user name a column of that field? */
bool lamp_keys_maps(const lamp_keys *keys, lamp_field field);
/* Hands the columns noted so far, in the order met, to the sink. */
noc_status lamp_keys_report(lamp_keys *keys, geo_sink *sink, const char *place, size_t points) NOC_MUST_USE;

/* --lamp-columns must be understood even where no input needs it: reported, NOC_ERR_ARGUMENT. */
noc_status lamp_mapping_check(const noc_import_params *params, noc_log *log);
/* *missing: the first column that --lamp-columns names and `found` does not know, to be freed; NULL where it knows all.
 * An error is reported. */
noc_status lamp_mapping_missing(const noc_import_params *params, bool (*found)(void *ctx, const char *name), void *ctx,
                                noc_log *log, char **missing) NOC_MUST_USE;
/* Are these two names of one column? Case, accents, blanks and signs do not count. */
bool lamp_same_key(const char *a, const char *b);

typedef enum lamp_verdict {
    LAMP_NONE, /* not a lamp */
    LAMP_ACTIVE,
    LAMP_INACTIVE, /* a lamp that is gone, switched off for good or not built yet */
    LAMP_INDOORS,  /* a lamp in a building, a tunnel or under ground */
    LAMP_ABSENT,   /* a point that says that it has no lamp: a pole of wires */
} lamp_verdict;

/* By OSM tags: highway=street_lamp and its kin, with lifecycle prefixes. In an inventory every row is a lamp, and only
 * its status columns decide. */
lamp_verdict lamp_verdict_of(lamp_keys *keys, const lamp_tag *tags, size_t count, bool inventory);

/* Is one of these the key of a tag that makes a lamp (highway, man_made, ...)? */
bool lamp_key_tells(const char *key);
/* Do these columns, together, belong to an inventory of lamps? One column that only lamps have is enough (LampType,
 * lumens), or two that lamps usually have (mast number, mast length, wattage). */
bool lamp_columns_tell(lamp_keys *keys, const char *const *names, size_t count);
/* Does one of them say by yes and no whether a point is a street lamp (IS_STREETLIGHT)? */
bool lamp_columns_ask(lamp_keys *keys, const char *const *names, size_t count);
/* 1: yes, -1: no, in many languages, 0: neither. A number is how many. */
int lamp_yes_or_no(const char *value);
/* Does an unnamed column say, by nothing but such words, that the lamp is not in use ("abgebaut"), where none is mapped
 * as status? */
bool lamp_unnamed_status(lamp_keys *keys, const lamp_tag *tags, size_t count);
/* Do those columns of this row say yes, or name something other than no? */
bool lamp_is_told(lamp_keys *keys, const lamp_tag *tags, size_t count);

/* Fills everything but xyz, which is left as it is except for a missing height taken from an elevation column. Values
 * that cannot be understood are counted in issues (which may be NULL) and left unknown. lamp->id and ref point into
 * tags: the identity that is believed first, and the next one; where they hold none id stays what it was, or "". False:
 * memory was refused. */
bool lamp_read(lamp_keys *keys, const lamp_tag *tags, size_t count, geo_lamp *lamp, geo_issues *issues) NOC_MUST_USE;

/* Counts what the verdict says about a skipped feature; true if it is a lamp to be read. */
bool lamp_accept(lamp_verdict verdict, const char *id, geo_issues *issues);

/* ---- tables whose values tell what their rows are (kinds.c) ---- */

/* 2: text names a street lamp beyond doubt ("Lichtmast mit Auslegerleuchte"); 1: a lamp of some kind ("Leuchte"); 0:
 * no. */
int lamp_object_word(const char *text);

/* Counts over all rows of a table which of its columns hold such words. */
typedef struct lamp_kinds {
    NOC_ARRAY(struct lamp_kind) columns;
    size_t rows;
    bool any;    /* after lamp_kinds_decide: some column tells what the rows are */
    bool models; /* a column describes lamps: all rows are */
} lamp_kinds;
/* false: memory was refused */
bool lamp_kinds_count(lamp_kinds *kinds, const lamp_tag *tags, size_t count) NOC_MUST_USE;
void lamp_kinds_decide(lamp_kinds *kinds);
bool lamp_kinds_tell(const lamp_kinds *kinds, const lamp_tag *tags, size_t count); /* is this row a lamp? */
void lamp_kinds_note(const lamp_kinds *kinds, lamp_keys *keys);                    /* for the table of columns */
void lamp_kinds_free(lamp_kinds *kinds);

/* ---- values that are not understood (unread.c) ---- */

/* Counts them by value. */
typedef struct lamp_unread lamp_unread;
lamp_unread *lamp_unread_create(void); /* NULL: memory was refused */
void lamp_unread_destroy(lamp_unread *u);
/* reason and column ("": any) must stay. id: of the lamp that has it. false: memory was refused */
bool lamp_unread_add(lamp_unread *u, const char *reason, const char *column, const char *text,
                     const char *id) NOC_MUST_USE;
/* Drops the values of a column in which nothing is understood if they are ids: nearly each occurs once. */
void lamp_unread_drop_ids(lamp_unread *u, const char *column);
/* Of each reason the five most frequent values, a line each, and the others in one. */
void lamp_unread_tell(lamp_unread *u, geo_issues *issues);

/* ---- on their way to the sink (emit.c) ---- */

#define LAMP_WGS84 "=OGC:CRS84" /* with GEO_CRS_TAKEN: of files that name none */

typedef struct lamp_writer {
    geo_sink *sink;
    const char *place;      /* file, for messages */
    bool geographic;        /* x and y are degrees: checked to be on Earth */
    const char *broken;     /* what the next feature has in place of coordinates; NULL: not known */
    bool no_crs;            /* the next feature names no CRS, in a file of several */
    size_t features, lamps; /* looked at; emitted */
    size_t lost;            /* lamps in use without a place */
    size_t off_earth;       /* of them those whose degrees are no longitude and latitude */
    size_t exchangeable;    /* of those the ones that are with the two exchanged */
    lamp_keys *keys;
    lamp_kinds kinds; /* where any of them tells: only rows that are lamps by it */
    bool inventory;   /* every point is a lamp, unless its status says otherwise */
    bool asked;       /* of an inventory: only those that a column says to be (lamp_is_told) */
    bool strange;     /* nothing tells what the points are: they are noted and counted */
    size_t points, strange_points;
    geo_features seen;
    size_t footprints;     /* buildings that were handed on */
    size_t streets, rails; /* roads that were, and railways */
} lamp_writer;

noc_status lamp_writer_start(lamp_writer *w, geo_sink *sink, const char *place,
                             const noc_import_params *params) NOC_MUST_USE;
void lamp_writer_free(lamp_writer *w);

/* Tells the sink the CRS, which may begin with GEO_CRS_TAKEN. NULL: the file names none; the sink knows whether --crs
 * says it. */
noc_status lamp_writer_crs(lamp_writer *w, const char *crs);
/* A feature that is no single point, nor a lamp: counted by its geometry. box: min x, max x, min y, max y; NULL: not
 * known. */
void lamp_writer_unread(lamp_writer *w, int dimension, const char *id, const double box[4]);
/* One point feature: judged, read and handed on, or skipped and counted. id: for want of a better one. z may be NaN. */
noc_status lamp_writer_point(lamp_writer *w, const lamp_tag *tags, size_t count, const char *id, const double xyz[3]);
/* At the end: an error where nothing tells that the points are lamps, or where degrees were expected and nearly all
 * lamps lie outside the Earth; a warning without lamps. */
noc_status lamp_writer_end(lamp_writer *w);

/* CSV with a header, without GDAL (csv.c). */
bool lamp_csv_probe(const char *head, size_t size);
bool lamp_csv_probe_table(const char *head, size_t size); /* any table, whatever its columns are called */
noc_status lamp_csv_read(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format);

/* ---- folding, and names of columns (columns.c) ---- */

/* Folds text into out (always terminated): ASCII lower case letters and digits; UTF-8 or Latin-1 accents dropped. With
 * blanks, every run of anything else becomes one blank. Returns the length. */
size_t lamp_fold(const char *text, bool blanks, char *out, size_t size);

typedef struct lamp_column {
    const char *key; /* folded */
    lamp_field field;
    int rank, strength; /* those of lamp_meaning */
} lamp_column;

/* NULL if the folded key means nothing to us. "wattage1", "poleheightdesc", "mountht" are found as "wattage",
 * "poleheight", "mountheight". */
const lamp_column *lamp_column_find(const char *folded);

/* ---- words in values (words.c) ---- */

/* Folded text (with blanks), and which characters are in it, anywhere and at the beginning of words: that rules out
 * most words. */
typedef struct lamp_text {
    const char *folded;
    uint64_t any, first;
} lamp_text;
lamp_text lamp_text_of(const char *folded);
static inline uint64_t lamp_bit(char c) { return 1ull << (c & 63); }

/* Is `wanted` in the text as whole words? A '*' at its end or beginning stands for the rest of a word. */
bool lamp_find_word(const lamp_text *text, const char *wanted);
static inline bool lamp_has_word(const lamp_text *text, const char *wanted) {
    bool may = *wanted == '*' ? text->any & lamp_bit(wanted[1]) : text->first & lamp_bit(*wanted);
    return may && lamp_find_word(text, wanted);
}

/* Words in folded text (with blanks). Return -1 where none is found. */
enum { LAMP_SOURCES_DIFFER = -2 };
/* geo_lamp.source; LAMP_SOURCES_DIFFER: of several, one that there is not ("not LED"), or one that is planned. */
int lamp_source_word(const char *folded);
int lamp_type_word(const char *folded);  /* geo_lamp.type */
int lamp_mount_word(const char *folded); /* geo_lamp.mount */
bool lamp_inactive_word(const char *folded);
typedef enum lamp_status { LAMP_STATUS_UNTOLD, LAMP_STATUS_IN_USE, LAMP_STATUS_NOT } lamp_status;
/* What a value of a column of status says (status.c). */
lamp_status lamp_status_of(const lamp_meaning *meaning, const char *value);
bool lamp_is_flag(const char *value);      /* yes or no in any language, 0 or 1 */
bool lamp_absent_word(const char *folded); /* "no light", "pole only" */
/* Kelvin for words of white and of sodium light, linear Rec.709 for others. */
bool lamp_colour_word(const char *folded, double *kelvin, float rgb[3]);

/* ---- values (value.c) ---- */

/* The most that is believed of a lamp. */
enum { LAMP_MOST_METRES = 60, LAMP_MOST_LUMENS = 500000, LAMP_MOST_WATTS = 5000 };

/* The numbers at p, joined by signs or words (+ & / ; | - .. to or). False where none begins there: none of this unit
 * (240 V), or a malformed one ("1000.5.2"). scale is for values that name no unit. decimal: the file's decimal sign,
 * '.' or ','; 0: not known. (quantity.c) */
bool lamp_scan_quantity(const char *p, lamp_unit unit, double scale, char decimal, lamp_number *n);
/* A whole text: "16 ft", "5,5 m", "16'6\"", "2x70 W", "3,000 K", "8.5;6", "8 m (26 ft)". Not understood are words in
 * place of a unit, and "equivalent". */
bool lamp_read_quantity(const char *text, lamp_unit unit, double scale, char decimal, lamp_number *n);
/* The same for who asks only for the value and the heads. */
bool lamp_quantity(const char *text, lamp_unit unit, double scale, char decimal, double *value, int *times);
/* Is it the colour of a fluorescent tube: 830, a colour rendering over 80 and 3000 K? Kelvin; 0: no. */
double lamp_colour_code(double value);
/* An unsigned decimal at s. decimal: the file's sign, '.' or ','; the other one, before three digits and no more, parts
 * thousands. 0: both are decimal signs, but for a comma before three digits in a quantity that runs to thousands.
 * Returns the position after it, NULL if there is none. */
const char *lamp_scan_number(const char *s, bool thousands, char decimal, double *out);
/* The sign in a number that can be nothing but a decimal sign ("8,5", "11.4231"): not before three digits, which may be
 * thousands. 0: there is none. */
char lamp_decimal_sign(const char *text);
/* A unit at the end of a folded key ("heightft"): its length, 0 if there is none. LAMP_PLAIN: of any kind. */
size_t lamp_unit_tail(const char *folded, lamp_unit unit, double *scale, const char **name);
/* Is this folded word one of the unit's names ("feet")? */
bool lamp_unit_word(const char *word, lamp_unit unit, double *scale, const char **name);
/* Degrees clockwise from north: "135", "135 deg", "NNE", "south-west". */
bool lamp_direction(const char *text, double *degrees);
/* A list of them ("45;225", "N/S"): how many there are, GEO_HEADINGS at most; 0: it is not understood. */
int lamp_directions(const char *text, char decimal, float degrees[GEO_HEADINGS]);
/* A coordinate: degrees or metres, decimal comma allowed; "52.5 N", "13.4 W", "7 26.34 E", degrees, minutes and
 * seconds with their signs (coordinate.c). */
bool lamp_coordinate(const char *text, double *value);
/* Two of them that have degree signs, minutes or hemispheres, latitude first unless they say otherwise. */
bool lamp_coordinates(const char *text, double *lat, double *lon);
bool lamp_blank(const char *text); /* NULL, "", "N/A", "-", "null", "none", "unknown" */
/* sRGB "#rrggbb" or "#rgb" as linear Rec.709. */
bool lamp_hex_colour(const char *text, float rgb[3]);

#endif
