/* panes: the pictures that a client sees beside each other, each a view with a look of its own, all through one camera.
 * Used by the session's thread alone. */
#ifndef NOC_VIEWER_PANES_H
#define NOC_VIEWER_PANES_H

#include "viewer/outbox.h"
#include "viewer/wire.h"
#include "viewer/look.h"
#include "viewer/world.h"

typedef struct pane {
    noc_view *view; /* NULL: the difference of the panes 0 and 1 */
    look look;
    int width, height;      /* of its last frame */
    noc_method method;      /* of that */
    uint64_t world;         /* world_published before that */
    noc_smoother *smoother; /* of moving pictures; NULL until there was one */
    const noc_image *calm;  /* its picture of the last frame; NULL: that is shown as it is */
    bool varies;            /* that kept its variance */
    bool failed;            /* its last frame: there is none until something changes */
    uint64_t shown;         /* the change (panes.change) that its newest frame shows; 0: none */
    uint32_t number;        /* of its newest picture */
    noc_frame_stats stats;
    noc_comparison compared; /* of a difference */
    double ev100;            /* of its newest picture; NaN: that is of numbers */
    noc_bar bar;             /* of its newest picture of numbers, or difference; high 0: there was none */
    json_t *legend;          /* of its newest picture, where that is of numbers; NULL: none */
} pane;

typedef struct panes {
    viewer_world *world;
    outbox *box;
    noc_log *log;
    noc_image_encoder *encoder;
    uint8_t *rgb; /* room of a picture */
    size_t rgb_size;
    wire_layout layout;
    int count;
    pane pane[WIRE_PANES];
    look own;                 /* of pane 0 before all methods were shown, to go back to */
    double exposure, exposed; /* EV100 that pictures have now, and when it was found; NaN: none was */
    double apart;             /* EV that the meter of moving pictures is below that of those at rest */
    int moved;                /* pictures after a rest that have told it */
    bool has_map;             /* there is one around the city */
    uint64_t change;          /* counts what makes other pictures: input, options, edits */
} panes;

/* NOC_ERR_MEMORY after reporting. */
noc_status panes_init(panes *p, viewer_world *world, outbox *box, noc_log *log, const look *first);
void panes_finish(panes *p);
noc_status panes_set_layout(panes *p, wire_layout layout);
/* What a change of a look asks for. */
typedef enum panes_need {
    PANES_PUBLISH, /* its picture again, as it is */
    PANES_FRAME,   /* one more frame: another mode looks at what that keeps */
    PANES_ANEW     /* the mean begins anew */
} panes_need;
/* Sets an option of a pane's look, -1: of all. false, with why: it cannot be. */
bool panes_set(panes *p, int which, const char *name, const char *value, panes_need *need, char *why, size_t size);

/* Renders a frame of a pane. */
/* A quick picture by a headlight, for which nothing of the lights is made: what is seen before their structures are. */
noc_status panes_headlight(panes *p, const noc_camera *camera, int width, int height, const noc_progress *progress);
noc_status panes_render(panes *p, int which, const noc_camera *camera, int width, int height, bool rests,
                        const noc_progress *progress);

/* A picture of the pane as it is now goes to the outbox. */
typedef struct panes_picture {
    bool moves, lossless;
    uint32_t input; /* newest that it shows */
    double now;
    const noc_camera *camera;
} panes_picture;
noc_status panes_publish(panes *p, int which, const panes_picture *what);

/* Does anybody look at pictures of that pane: was the last one shown, or sent not long ago? */
bool panes_watched(panes *p, int which, double now);
double panes_error(panes *p, int which); /* relative standard error of the mean; NaN: not known */
json_t *panes_state(const panes *p);     /* list for `state` */

#endif
