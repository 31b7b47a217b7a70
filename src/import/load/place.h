/* place: from the coordinates of a file to the scene's: the CRS that they are in, the order of their axes, the way into
 * the scene's CRS. */
#ifndef NOC_IMPORT_PLACE_H
#define NOC_IMPORT_PLACE_H

#include "geo/geo.h"
#include "import/import.h"

typedef struct importer importer;
typedef struct input input;
typedef struct reading reading;

/* One CRS as one file spells it; axis decisions hold for that file. */
typedef struct source_crs {
    char *spelling;          /* "" where the file names none */
    bool taken;              /* the file does not hold it: GEO_CRS_TAKEN */
    geo_crs *crs;            /* NULL: local metres */
    geo_crs *named;          /* that the file names and --crs replaces, until the way is made; NULL: none */
    bool fits, replaced;     /* the coordinates fit --crs; it has replaced what the file names */
    bool lat_first, turned;  /* order of the tuples as readers have it; it is not that of crs */
    geo_transform *to_scene; /* NULL until the first coordinate, and for local metres */
    bool ready;              /* to_scene is made, if one is needed */
    bool further;            /* the file had another before, in which the report has its extent */
    bool axes_decided, swap;
    int tries;
    double outside;  /* degrees outside the CRS's area of use, of the last try */
    bool opposite;   /* its numbers would fit with the other sign */
    double shift_x;  /* zone number before the easting */
    double unit;     /* of heights [m] */
    bool unit_named; /* by the file, its CRS or the user; else it is assumed */
    const char *unit_by;
} source_crs;

/* Where a lamp was given: what would be if its axes were exchanged is asked of lamps that are of no use. */
typedef struct given_place {
    double xy[2];
    source_crs *source;
} given_place;

/* ---- place.c ---- */

typedef struct place_sample {
    source_crs *source;
    double xyz[3];
    const char *id;
} place_sample;
/* Centre of the finite ones of some points; false if there are none. */
bool place_centre(const double *xyz, size_t count, double centre[3]);
/* Settles the scene's CRS and origin by where a file's first objects lie: by the first one, unless it lies far from the
 * middle of them. Nothing happens without samples. */
noc_status place_settle(reading *r, const place_sample *samples, size_t count);
noc_status place_crs(reading *r, const char *srs_name, const char *place, bool *lat_first);
/* Coordinates as emitted (the extent is taken of them) to local metres, in place. *usable is false if they cannot be
 * transformed. The first ones settle the scene's CRS and origin. */
noc_status place_points(reading *r, double *xyz, size_t count, const char *id, bool *usable);
/* Meshes name no CRS. With --crs they are in it; without, they are metres from the scene's origin where the scene has a
 * CRS, else in the same local metres as all the rest. */
noc_status place_mesh(reading *r);
noc_status place_mesh_points(void *reading, double *xyz, size_t count);
/* PROJ searches its whole database for a name that it does not know: a tenth of a second each. If --crs replaces such
 * names, there may be as many as a reader takes of one file. */
enum { MOST_STRANGE = 8 };
/* given_crs.c: the CRSs that the user gives. */
noc_status given_status(noc_status status); /* Returns the status of a CRS of the user's that was not read */
/* --crs and --scene-crs must be understood even if no input needs them. */
noc_status given_crs_check(const noc_import_params *params, noc_log *log);
noc_status given_crs_take(importer *im); /* gives inputs those of noc_import_params.file_crs */
/* Returns true if `name` is the input's path, its end, a pattern of either, or another name of the same file. */
bool given_is_called(const char *path, const char *name);
/* Returns the input's own, else that of inputs that name none; NULL: none. */
const char *given_crs_of(const importer *im, const input *in);
/* Sets *crs to the input's own in place of `spelling`, and warns if that is another one. */
noc_status given_crs_override(reading *r, const char *spelling, bool taken, const char *place, geo_crs **crs);
/* Returns true if --crs counts in place of what the input names: of a city, where no input is there that may name none.
 */
bool given_crs_replaces(const importer *im, const input *in);
/* Does so: *named is what --crs replaces, NULL: nothing. Destroys *crs on failure. */
noc_status given_crs_replace(reading *r, geo_crs **crs, geo_crs **named);
/* Gives a CRS that --crs replaces back to the file whose coordinates fit it, and not --crs. */
void given_crs_fit(reading *r, source_crs *s, double x, double y);
void given_crs_replaced(reading *r, source_crs *s, const double xy[2]); /* warns, as the way is made by that point */
void given_crs_warn(importer *im); /* of inputs that name another than --crs, once all are read */

/* ---- axes.c ---- */

/* Puts coordinates as emitted into easting northing order, in place. Decides about the order by the first of the CRS.
 */
noc_status axes_fix(reading *r, source_crs *s, double *xyz, size_t count, const char *id);
bool axes_doubtful(const source_crs *s); /* no coordinate lay in the CRS's area of use */

/* ---- meeting.c ---- */

double place_distance_km(const double a[2], const double b[2]); /* of longitudes and latitudes */

/* Where the inputs meet, longitude and latitude. */
typedef struct meeting_place {
    bool asked, known;
    double lonlat[2];
} meeting_place;
/* Sets *exchange if the input, of which that is a point in the order that its CRS or its format has, lies where the
 * others do only with latitude and longitude exchanged, and that reading is the plausible one. The first call that must
 * know looks into all inputs. */
noc_status meeting_exchanges(reading *r, geo_crs *crs, double x, double y, bool *exchange);

/* ---- the rest of place.c ---- */

/* The point with its axes exchanged, in the scene; false where it then has no place. */
bool place_exchanged(importer *im, const given_place *given, double xy[2]);
void place_finish_file(reading *r, bool read);
void place_forget(input *in); /* its CRSs: lamps are asked for them until the end */

#endif
