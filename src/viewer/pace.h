/* pace: the resolution of a moving picture, by the time that its frames took. Pure functions. */
#ifndef NOC_VIEWER_PACE_H
#define NOC_VIEWER_PACE_H

/* Halvings of the number of pixels: level 0 is the whole picture. */
enum { PACE_LEVELS = 9, PACE_START = 4 };

typedef struct pace {
    int level;
    int fits; /* frames in a row after which a finer level would have been in time, too */
    int late; /* frames in a row that took too long */
} pace;

/* Sides of a picture at that level: at least 16 px, and never more than the whole. */
void pace_size(int level, int width, int height, int *w, int *h);

/* The coarsest level that still shows something, of one of so many panes: what a frame takes beside its pixels makes
 * coarser ones hardly faster. */
int pace_coarsest(int width, int height, int panes);

/* The level after a frame that took so many seconds, for pictures that are to take `budget` seconds each. A change of
 * size loses reservoirs, so it becomes coarser when two frames in a row were too long (at once when one was far too
 * long), and finer when many in a row had time to spare. */
int pace_after(pace *p, double seconds, double budget, int coarsest);

/* Seconds until a picture at rest is sent again, when it has come to rest so many seconds ago: intervals grow, because
 * its error falls by the root of the frames. */
double pace_rest(double rested);

#endif
