#include "viewer/pace.h"

#include <math.h>

#define LATE 1.4     /* budgets: longer is too long */
#define FAR_LATE 2.5 /* budgets: and this at once */
#define SPARE 0.4    /* budgets: twice the pixels would still be in time */
#define SPARE_FRAMES 6
#define SHORTEST_REST 0.25 /* s */
#define LONGEST_REST 5     /* s */
#define FEWEST_PIXELS 4e4  /* 267 x 150 */
#define LEAST_SIDE 16      /* px */

static int side(int level, int whole) {
    int least = whole < LEAST_SIDE ? whole : LEAST_SIDE;
    int scaled = (int)lrint(whole * pow(0.5, 0.5 * level));
    return scaled < least ? least : scaled;
}

void pace_size(int level, int width, int height, int *w, int *h) {
    *w = side(level, width);
    *h = side(level, height);
}

int pace_coarsest(int width, int height, int panes) {
    double least = fmax(FEWEST_PIXELS / panes, FEWEST_PIXELS / 4), pixels = (double)width * height;
    return pixels > least ? (int)fmin(floor(log2(pixels / least)), PACE_LEVELS - 1) : 0;
}

int pace_after(pace *p, double seconds, double budget, int coarsest) {
    double share = fmin(seconds / budget, 1e6);
    p->late = share > LATE ? p->late + 1 : 0;
    p->fits = share < SPARE ? p->fits + 1 : 0;
    if (share > FAR_LATE || p->late >= 2) {
        int down = (int)lrint(log2(share));
        p->level += down > 1 ? down : 1;
        p->late = 0;
    } else if (p->fits >= SPARE_FRAMES) {
        p->level--;
        p->fits = 0;
    }
    p->level = p->level < 0 ? 0 : p->level > coarsest ? coarsest : p->level;
    return p->level;
}

double pace_rest(double rested) {
    double wait = 0.5 * rested;
    return wait < SHORTEST_REST ? SHORTEST_REST : wait > LONGEST_REST ? LONGEST_REST : wait;
}
