/* Distributions of our own making for common street lights. Each is a formula whose shape is told here; none is a
 * measured luminaire. C 0 looks across the street, 1 is about the peak. */
#include "photometry/photometry.h"

#include <math.h>

static double lobe(double x, double middle, double width) {
    double t = (x - middle) / width;
    return exp(-t * t);
}

/* How far C is from `c`, degrees. */
static double turned(double c, double from) { return fabs(remainder(c - from, 360)); }

/* From 1 to 0 over the last degrees before the horizon: full cut-off. */
static double cut_off(double gamma, double last) {
    double t = NOC_CLAMP((90 - gamma) / last, 0, 1);
    return t * t * (3 - 2 * t);
}

/* A road luminaire on an arm, full cut-off (no light upward): two beams along the road, 68 degrees to either side of
 * the street and 64 up from straight down, over a base of a Lambertian kind; three tenths go behind it. IES type II,
 * medium. */
static double cobra_head(double c, double gamma) {
    double side = lobe(turned(c, 68), 0, 34) + lobe(turned(c, -68), 0, 34), front = cos(c * M_PI / 180);
    double base = .30 * cos(gamma * M_PI / 180) * (1 + .35 * front);
    double beam = side * lobe(gamma, 64, 17);
    double street = .35 * fmax(front, 0) * lobe(gamma, 45, 22);
    double back = .22 * fmax(-front, 0) * lobe(gamma, 35, 25);
    return (base + beam + street + back) * cut_off(gamma, 20);
}

/* A lantern or globe on a post with a shade: alike all around, most at 66 degrees, a sixth upward, nothing straight up,
 * little straight down, where its post is. Not cut off. */
static double post_top(double c, double gamma) {
    double shade = NOC_CLAMP((140 - gamma) / 50, 0, 1);
    return (.18 + lobe(gamma, 66, 30) * .82) * (.35 + .65 * sin(gamma * M_PI / 180)) * shade * shade;
}

/* On a wall: all forward, most at 52 degrees, full cut-off. */
static double wall(double c, double gamma) {
    double front = .5 + .5 * cos(c * M_PI / 180);
    return (.35 * cos(gamma * M_PI / 180) + front * front * lobe(gamma, 52, 24)) * (.15 + .85 * front) *
           cut_off(gamma, 15);
}

/* A floodlight, about its own axis: half of its peak at 30 degrees, nothing beyond 75. */
static double flood(double c, double gamma) {
    double t = NOC_CLAMP((75 - gamma) / 20, 0, 1);
    return exp(-M_LN2 * pow(gamma / 30, 2.4)) * t;
}

/* Louvred: a ring on the ground around it, most at 68 degrees, nothing upward, little on its own foot. */
static double bollard(double c, double gamma) { return (.06 + lobe(gamma, 68, 20)) * cut_off(gamma, 12); }

/* A headlamp's passing beam, for driving on the right. The axis looks ahead and level, C 0 to the right, C 90 up. The
 * cut-off lies 0.57 degrees (1 %) below the level, and to the right of the middle rises from there by 15 degrees to
 * 1.4 above it. Below it lie a hot spot, a spread over the road and a faint apron, above it some stray light. At 700 lm
 * its intensities keep what UN Regulations 112 and 149 ask of class B at their test points
 * (tests/photometry/test_builtin.c). */
static double low_beam(double c, double gamma) {
    const double degrees = 180 / M_PI, ahead = cos(gamma / degrees), across = sin(gamma / degrees);
    double h = atan2(across * cos(c / degrees), ahead) * degrees, v = asin(across * sin(c / degrees)) * degrees;
    double edge = -.57 + NOC_CLAMP(h * tan(15 / degrees), 0, 2), below = edge - v;
    double lit = NOC_CLAMP((below + .25) / .5, 0, 1), deep = fmax(below, 0), rim = NOC_CLAMP((60 - gamma) / 10, 0, 1);
    double spot = 16000 * lobe(h, 1.5, 5) * lobe(deep, 0, 2.2), spread = 5500 * lobe(h, 0, 18) * lobe(deep, 0, 6);
    double apron = 1200 * lobe(h, 0, 38) * lobe(deep, 0, 15), stray = 150 * lobe(h, 0, 30) * lobe(v, 0, 12);
    return (lit * lit * (3 - 2 * lit) * (spot + spread + apron) + stray) * rim;
}

static const struct {
    const char *name;
    double (*shape)(double c, double gamma);
    double most_gamma, c_step, gamma_step;
} builtins[] = { { "cobra-head", cobra_head, 90, 5, 2.5 },
                 { "post-top", post_top, 140, 360, 2.5 },
                 { "wall", wall, 90, 5, 2.5 },
                 { "flood", flood, 75, 360, 2.5 },
                 { "bollard", bollard, 90, 360, 2.5 },
                 { "low-beam", low_beam, 60, 2.5, .5 } };

const char *noc_profile_builtin_name(int i) { return i >= 0 && i < (int)NOC_COUNT(builtins) ? builtins[i].name : NULL; }

noc_status noc_profile_builtin(noc_log *log, const char *name, noc_profile **profile) {
    enum { PLANES = 144, MOST = 181 };
    if (!name || !profile)
        return noc_null(log, __func__);
    *profile = NULL;
    size_t i = 0;
    while (i < NOC_COUNT(builtins) && strcmp(name, builtins[i].name))
        i++;
    if (i == NOC_COUNT(builtins))
        return noc_error(log, NOC_ERR_ARGUMENT, "profile %s: there is no built-in one of that name", name);
    double c[PLANES], gamma[MOST], *cd = noc_alloc(sizeof(double) * PLANES * MOST);
    int planes = (int)lround(360 / builtins[i].c_step);
    int gammas = (int)lround(builtins[i].most_gamma / builtins[i].gamma_step) + 1;
    if (!cd)
        return noc_no_memory(log, name);
    for (int k = 0; k < gammas; k++)
        gamma[k] = builtins[i].gamma_step * k;
    for (int p = 0; p < planes; p++) {
        c[p] = builtins[i].c_step * p;
        for (int k = 0; k < gammas; k++)
            cd[p * gammas + k] = fmax(builtins[i].shape(c[p], gamma[k]), 0);
    }
    noc_status status =
        noc_profile_create(log, &(noc_profile_params){ builtins[i].name, planes, gammas, c, gamma, cd, 0 }, profile);
    free(cd);
    if (!status)
        (*profile)->info.format = "built in";
    return status;
}
