/* Walls behind panes. A pane stands some centimetres before its wall, so that a place of the wall behind it is dark.
 * Here walls are cut along the panes before them. */
#ifndef NOC_REGION_PANES_H
#define NOC_REGION_PANES_H

#include "scene/region.h"
#include "scene/scene.h"

/* A triangle of a pane, as it faces outwards. */
typedef struct region_pane {
    double p[3][3], n[3];
    double lo[3], hi[3]; /* its bounds */
} region_pane;

typedef struct region_panes {
    NOC_ARRAY(region_pane) of; /* ascending by lo[0] */
    double widest;             /* the greatest hi[0] - lo[0] */
    bool counted;              /* the panes are parts of the region themselves */
    size_t pieces;             /* of walls, that cuts have made so far */
} region_panes;

/* Adds a triangle of a pane, which must have an area. false: no memory. */
bool region_panes_add(region_panes *panes, const noc_patch *pane) NOC_MUST_USE;
/* Sorts them: once after the last of them was added. */
void region_panes_sort(region_panes *panes);
void region_panes_free(region_panes *panes);

/* Adds a triangle of a wall to the region without what lies behind panes; where the panes are not counted themselves,
 * what lies behind them is added at their faces. NOC_ERR_MEMORY, not reported; NOC_ERR_ARGUMENT, not reported: more
 * than REGION_PIECES pieces. */
enum { REGION_PIECES = 4000000 };
noc_status region_panes_cut(region_panes *panes, const noc_patch *wall, noc_region *to) NOC_MUST_USE;

#endif
