/* ask: regions by what people call them (noc_region_find). */
#ifndef NOC_ASK_H
#define NOC_ASK_H

#include "base/base.h"
#include <nocturne/nocturne.h>

/* A region that is asked for. */
typedef struct asked {
    noc_view *view;
    const noc_scene *scene;
    const noc_region_params *params;
    noc_log *log;
    const char *text; /* behind the word and its colon */
    noc_region *to;   /* empty */
} asked;

/* place.c: each fills the region, or reports what is wrong. */
noc_status ask_point(const asked *a);
noc_status ask_pixel(const asked *a);
noc_status ask_rect(const asked *a);

/* named.c, streets.c */
noc_status ask_object(const asked *a);
noc_status ask_polygon(const asked *a);
noc_status ask_street(const asked *a);

enum { ASK_PLACES = 20000 };      /* points that ground is made of, about */
#define ASK_FINEST 0.1            /* m between them */
extern const uint32_t ask_ground; /* classes that are ground: 1u << noc_class each */

/* area.c: ground as it is seen from above, by points of a grid. */
typedef struct ask_cells {
    NOC_ARRAY(uint64_t) keys; /* of cells; some may come twice */
    double step;              /* m */
} ask_cells;
/* Of the cells whose jittered places are within so far of the line, or in the rings. */
noc_status ask_add_line(const asked *a, const noc_street *street, double beside, ask_cells *cells);
noc_status ask_add_rings(const asked *a, const noc_rings *rings, ask_cells *cells);
/* Adds the ground in those cells. classes: 1u << noc_class each. *found: cells with such a surface. */
noc_status ask_add_ground(const asked *a, ask_cells *cells, uint32_t classes, size_t *found);

/* Coordinates as people say them to the scene's frame; an error is reported. */
noc_status ask_to_local(const asked *a, double xyz[3]);

#endif
