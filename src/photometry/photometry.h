/* photometry: luminous intensity distributions. Readers fill a measured grid; profile.c makes it whole around the axis
 * and checks it against its own lumens; table.c makes the regular table that core looks up. */
#ifndef NOC_PHOTOMETRY_ROOM_H
#define NOC_PHOTOMETRY_ROOM_H

#include "base/base.h"
#include <nocturne/photometry.h>

enum { PHOTOMETRY_MOST_ANGLES = 4096, PHOTOMETRY_MOST_VALUES = 1 << 22 };

/* What a file holds before it is made whole. type: 'C', 'A' or 'B'; of A and B, c is horizontal and gamma vertical. */
typedef struct photometry_grid {
    NOC_ARRAY(double) c;
    NOC_ARRAY(double) gamma;
    NOC_ARRAY(double) cd;
    char type;
} photometry_grid;
void photometry_grid_free(photometry_grid *g);

struct noc_profile {
    NOC_ARRAY(double) c;     /* ascending, in [0, 360): all around */
    NOC_ARRAY(double) gamma; /* ascending, in [0, 180] */
    NOC_ARRAY(double) cd;    /* plane after plane; of types A and B resampled from `own` */
    photometry_grid own;     /* of types A and B, as measured: intensities are read from it; of type C empty */
    noc_profile_info info;   /* without zones and pointers, which noc_profile_get_info makes */
    noc_arena texts;
};

/* cd, lm: what is less is no light. Sums of it would lose their digits, as numbers end at 5e-324. */
#define PHOTOMETRY_LEAST 1e-30

/* profile.c. Both report. */
noc_profile *photometry_new(noc_log *log, const char *name, const char *format);
/* Takes the grid into the profile: its symmetry by its angles (noc_profile_create), its flux, peak and the rest of
 * info. A grid of type A or B is moved there: `g` is then empty. line: of the file where the angles stand, 0: none. */
noc_status photometry_fill(noc_profile *p, photometry_grid *g, noc_log *log, const char *name, int line);
/* Multiplies the intensities of a profile of type C, and what info has of them, by a positive factor. */
void photometry_scale(noc_profile *p, double factor);
/* Sets info's street to C 0, 90, 180 or 270 by the light itself, so that it is the same whatever the file's kind says
 * of C 0: of the two ends that more and less light goes to below the horizon, the brighter one; where opposite ends are
 * alike, across from where light reaches farther. usual: 0 or 90, the kind's own, where nothing tells them apart. */
void photometry_face_street(noc_profile *p, double c);
/* flux_error and what is to be said of it; info's lumens, lamp_lumens and lor are set. */
void photometry_judge(noc_profile *p, noc_log *log, const char *name);

/* integral.c: over the sphere, of what is linear in both angles between those of the grid: exact. */
/* Of a + (b - a) (t - t0) / (t1 - t0), times sin t, over [from, to] within [t0, t1]; degrees. */
double photometry_sine_integral(double t0, double t1, double a, double b, double from, double to);
double photometry_grid_flux(const photometry_grid *g); /* of types A and B, mirrored where the angles begin at 0 */

/* colour.c: colour temperatures in words. Returns the one that a text names with its unit ("LED 4000K", "3000 K"), 0
 * where there is none or several that differ. */
double photometry_kelvin(const char *text, size_t length);
/* The same of a field that holds nothing else: "3000", and codes of lamps by their rendering ("830" is 3000 K). */
double photometry_kelvin_field(const char *text, size_t length);

/* lines.c: a text by lines and by numbers. */
typedef struct photometry_text {
    const char *at, *end, *name;
    noc_log *log;
    int line; /* the last that photometry_line gave, from 1; where numbers are read, the one that `at` is in */
} photometry_text;
/* The next line without its end and the blanks around it; false at the end. */
bool photometry_line(photometry_text *t, const char **line, size_t *length);
/* A number among blanks and commas, over as many lines as it takes; `what` is for messages. */
noc_status photometry_number(photometry_text *t, const char *what, double *out);
noc_status photometry_whole(photometry_text *t, const char *what, long least, long most, long *out);
/* The same of a number that is read: of the line that t is in. */
noc_status photometry_as_whole(const photometry_text *t, const char *what, double x, long least, long most, long *out);
bool photometry_more(photometry_text *t); /* anything but blanks left? */
/* The number that a line is, with a comma for a point where there is no other; false if it is none. */
bool photometry_line_number(const char *line, size_t length, double *out);
/* "NAME:LINE: ..." */
noc_status photometry_bad(const photometry_text *t, int line, const char *fmt, ...) NOC_PRINTF(3, 4);
/* Counts angles and values against the limits, and makes room. */
noc_status photometry_reserve(photometry_text *t, photometry_grid *g, long planes, long gammas);

/* A kind of file (ies.c, eulumdat.c; load.c has their table). */
typedef struct photometry_format {
    bool (*probe)(const char *head, size_t size);
    /* The whole text, which has a 0 behind it, into a new profile. Texts that p->texts has no memory for may be left
     * out: who calls looks at it. */
    noc_status (*read)(photometry_text *t, noc_profile *p);
} photometry_format;
extern const photometry_format photometry_ies, photometry_eulumdat;

/* profile.c, of types A and B: the angles that an axis of the grid spans, mirrored where they begin at 0; and the
 * intensity at horizontal angle h and vertical angle v, 0 beyond these. Degrees, cd. */
void photometry_span(const double *angle, size_t n, double *from, double *to);
double photometry_grid_at(const photometry_grid *g, double h, double v);

/* table.c: what core/profile.h looks up: candela a lumen at even steps of two angles, bilinear between them. Rows are
 * angles from a pole, columns are angles around it. Of type C the pole is the axis: rows are gamma, from 0 on, columns
 * are C, all around. Of type A the pole points down and of B to the left, as seen along the axis, so that rows are 90
 * degrees more than the vertical (A) or horizontal (B) angle, and columns the other angle: nothing is resampled. */
typedef struct photometry_table {
    NOC_ARRAY(float) cells; /* row after row, the corners of a step: near, next, far, last of core/profile.h */
    int rows, columns;      /* steps */
    char type;              /* 'A', 'B' or 'C' */
    double row_from, row_to, column_from, column_to; /* degrees; nothing is sent beyond */
    double gamma_max;                                /* degrees from the axis, beyond which nothing is sent */
    float peak;                                      /* greatest value */
    bool upward;                                     /* sends something beyond 90 degrees */
} photometry_table;
noc_status photometry_table_make(photometry_table *t, const noc_profile *p, noc_log *log);
void photometry_table_free(photometry_table *t);

#endif
