/* Regions that are places: a point, and what pixels see. */
#include "ask/ask.h"

#include <ctype.h>
#include <math.h>

#define FARTHEST 1e6 /* m; polygons have cells whose numbers are of 32 bits */

enum { RECT_RAYS = 16384 }; /* of a rectangle at most; each stands for some pixels then */
enum { PANES = 64 };        /* that a pixel is seen through */

noc_status ask_to_local(const asked *a, double xyz[3]) {
    noc_scene_info info;
    noc_scene_get_info(a->scene, &info);
    bool none = !a->params->crs && !*info.given_crs;
    noc_status status = none ? NOC_OK : noc_scene_to_local(a->scene, a->params->crs, xyz);
    for (int k = 0; k < 3 && !status; k++)
        if (!(fabs(xyz[k]) < FARTHEST))
            status = noc_error(a->log, NOC_ERR_ARGUMENT,
                               "region: in %.60s it lies more than 1000 km away from the scene%s%.60s",
                               a->params->crs    ? a->params->crs
                               : *info.given_crs ? info.given_crs
                                                 : "local metres",
                               a->params->crs && *info.given_crs ? ", whose CRS is " : "",
                               a->params->crs ? info.given_crs : "");
    return status;
}

static bool unit(double n[3]) {
    double length = hypot(hypot(n[0], n[1]), n[2]);
    bool usable = length > 1e-300 && isfinite(length);
    for (int k = 0; k < 3 && usable; k++)
        n[k] /= length;
    return usable;
}

static noc_status add(const asked *a, const noc_hit *hit, double weight, const noc_ray *ray, const noc_ray *next) {
    noc_patch p = noc_hit_patch(hit, weight, ray, next);
    return noc_region_add(a->to, &p, 1);
}

/* ---- points ---- */

/* The first surface under a place, facing up. */
static noc_status add_under(const asked *a, const double at[3], double reach) {
    noc_ray ray = { { at[0], at[1], at[2] }, { 0, 0, -1 }, reach };
    noc_hit hit;
    noc_status status = noc_view_cast(a->view, &ray, 1, &hit);
    if (status != NOC_OK)
        return status;
    return hit.hit ? add(a, &hit, 1, NULL, NULL)
                   : noc_error(a->log, NOC_ERR_ARGUMENT, "region: there is no surface at point:%.60s", a->text);
}

/* Where the numbers end and a CRS begins, as in "9.18,48.78,EPSG:4326": behind a comma, by a letter. NULL: there is
 * none. */
static const char *find_crs(const char *text) {
    for (const char *p = strchr(text, ','); p; p = strchr(p + 1, ','))
        if (isalpha((unsigned char)p[1 + strspn(p + 1, " ")]))
            return p + 1 + strspn(p + 1, " ");
    return NULL;
}

/* said: the text as it was given, with its CRS. */
static noc_status add_point(const asked *a, const char *said) {
    double n[6] = { 0, 0, 0, 0, 0, 1 }, ground;
    bool turned = noc_text_numbers(a->text, ',', 6, n), placed = turned || noc_text_numbers(a->text, ',', 3, n);
    if (!placed && !noc_text_numbers(a->text, ',', 2, n))
        return noc_error(
            a->log, NOC_ERR_ARGUMENT,
            "region: point:%.60s is not X,Y or X,Y,Z or X,Y,Z,NX,NY,NZ, each with a CRS at the end or without", said);
    noc_status status = ask_to_local(a, n);
    if (status != NOC_OK)
        return status;
    if (placed) {
        noc_hit meter = { .place = { n[0], n[1], n[2] }, .normal = { n[3], n[4], n[5] }, .material = -1 };
        return unit(meter.normal) ? add(a, &meter, 1, NULL, NULL)
                                  : noc_error(a->log, NOC_ERR_ARGUMENT, "region: point:%.60s faces nowhere", a->text);
    }
    noc_scene_info info;
    noc_scene_get_info(a->scene, &info);
    bool found = noc_scene_ground(a->scene, n[0], n[1], &ground);
    n[2] = found ? ground + 0.02 : info.bounds_max[2] + 1;
    return add_under(a, n, found ? 0.1 : info.bounds_max[2] - info.bounds_min[2] + 2);
}

noc_status ask_point(const asked *a) {
    const char *crs = find_crs(a->text), *end = crs;
    char numbers[400];
    if (!crs)
        return add_point(a, a->text);
    while (*--end != ',') {}
    noc_region_params params = *a->params;
    asked in_crs = *a;
    params.crs = crs;
    in_crs.params = &params;
    in_crs.text = numbers;
    noc_snprintf(numbers, sizeof(numbers), "%.*s", (int)NOC_MIN(end - a->text, 399), a->text);
    return add_point(&in_crs, a->text);
}

/* ---- pixels ---- */

static noc_status check_picture(const asked *a, const double *at, size_t count) {
    const noc_region_params *p = a->params;
    if (!p->camera || p->width < 1 || p->height < 1)
        return noc_error(a->log, NOC_ERR_ARGUMENT, "region: pixels need a camera");
    for (size_t i = 0; i < count; i++)
        if (!(at[i] >= 0 && at[i] < (i % 2 ? p->height : p->width)))
            return noc_error(a->log, NOC_ERR_ARGUMENT, "region: \"%.60s\" lies outside of a picture of %d x %d",
                             a->text, p->width, p->height);
    return NOC_OK;
}

/* The share of light that goes straight through the surface. */
static double through(const asked *a, const noc_hit *hit) {
    noc_material m;
    return noc_scene_get_material(a->scene, hit->material, &m, NULL) == NOC_OK ? m.transmittance : 0;
}

/* The surface that is seen there; nothing is added where there is none. Through surfaces that let light pass those
 * behind are seen, too: each has the weight that it has in the picture. */
static noc_status add_seen(const asked *a, double x, double y) {
    const noc_region_params *p = a->params;
    noc_ray ray, next;
    noc_hit hit;
    if (noc_camera_ray(p->camera, p->width, p->height, (double[2]){ x, y }, &ray) != NOC_OK ||
        noc_camera_ray(p->camera, p->width, p->height, (double[2]){ x, y + 1 }, &next) != NOC_OK)
        return noc_error(a->log, NOC_ERR_ARGUMENT, "region: the camera looks nowhere");
    noc_status status = NOC_OK;
    noc_ray on = ray; /* from the last pane */
    double length = hypot(hypot(ray.direction[0], ray.direction[1]), ray.direction[2]), way = 0, passes = 1;
    for (int n = 0; n < PANES && passes > 0 && !status; n++) {
        status = noc_view_cast(a->view, &on, 1, &hit);
        if (status || !hit.hit)
            break;
        double seen = n + 1 < PANES ? passes * (1 - through(a, &hit)) : passes, step = hit.distance + 1e-4;
        passes -= seen;
        hit.distance += way;
        way += step;
        for (int k = 0; k < 3; k++)
            on.origin[k] += ray.direction[k] / length * step;
        if (seen > 0)
            status = add(a, &hit, seen, &ray, &next);
    }
    return status;
}

static noc_status check_seen(const asked *a) {
    noc_region_info info;
    noc_region_get_info(a->to, &info);
    return info.patches ? NOC_OK
                        : noc_error(a->log, NOC_ERR_ARGUMENT, "region: no surface is seen at \"%.60s\"", a->text);
}

noc_status ask_pixel(const asked *a) {
    double at[2];
    if (!noc_text_numbers(a->text, ',', 2, at))
        return noc_error(a->log, NOC_ERR_ARGUMENT, "region: pixel:%.60s is not X,Y", a->text);
    noc_status status = check_picture(a, at, 2);
    status = status ? status : add_seen(a, floor(at[0]) + 0.5, floor(at[1]) + 0.5);
    return status ? status : check_seen(a);
}

noc_status ask_rect(const asked *a) {
    double at[4];
    if (!noc_text_numbers(a->text, ',', 4, at))
        return noc_error(a->log, NOC_ERR_ARGUMENT, "region: rect:%.60s is not X0,Y0,X1,Y1", a->text);
    noc_status status = check_picture(a, at, 4);
    if (status != NOC_OK)
        return status;
    double x0 = floor(fmin(at[0], at[2])), x1 = floor(fmax(at[0], at[2])) + 1, y0 = floor(fmin(at[1], at[3])),
           y1 = floor(fmax(at[1], at[3])) + 1;
    double step = fmax(1, sqrt((x1 - x0) * (y1 - y0) / RECT_RAYS));
    for (double y = y0 + 0.5 * step; y < y1 && !status; y += step)
        for (double x = x0 + 0.5 * step; x < x1 && !status; x += step)
            status = add_seen(a, x, y);
    return status ? status : check_seen(a);
}
