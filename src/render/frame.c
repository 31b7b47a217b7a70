/* What is the same for all pixels of a frame: its cameras and numbers; and what of cameras and parameters can be wrong.
 */
#include "core/blocks.h"
#include "light/influence.h"
#include "render/backend.h"

#include <math.h>
#include <nocturne/option.h>
#include <stdio.h>

noc_status noc_render_check(const noc_render_params *p, noc_log *log) {
    if (!p)
        return noc_null(log, __func__);
    noc_isa isa;
    noc_status status = noc_option_check(noc_render_options(), p, "render", log);
    if (!status)
        status = noc_choose_isa(p->isa, &isa, log);
    return status ? status : noc_check_aovs(p, log);
}

typedef struct {
    double x, y, z;
} vec;

static vec cross(vec a, vec b) { return (vec){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x }; }
static double norm(vec a) { return sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }
static vec scale(vec a, double s) { return (vec){ a.x * s, a.y * s, a.z * s }; }
static vec load(const double *a) { return (vec){ a[0], a[1], a[2] }; }

noc_status noc_check_camera(const noc_camera *c, noc_log *log) {
    for (int i = 0; i < 3; i++)
        if (!(fabs(c->eye[i]) < 1e7 && fabs(c->target[i]) < 1e7 && isfinite(c->up[i])))
            return noc_error(log, NOC_ERR_ARGUMENT, "camera: eye, target and up must be finite and within 10 000 km");
    if (!(c->fov_deg >= 0.01 && c->fov_deg <= 179))
        return noc_error(log, NOC_ERR_ARGUMENT, "camera: field of view is %g degrees, must be in 0.01..179",
                         c->fov_deg);
    vec eye = load(c->eye), target = load(c->target);
    vec forward = { target.x - eye.x, target.y - eye.y, target.z - eye.z };
    double l = norm(forward), up = norm(load(c->up));
    if (!(l > 1e-9))
        return noc_error(log, NOC_ERR_ARGUMENT, "camera: eye and target are the same point");
    if (!(up > 1e-30 && up < 1e30))
        return noc_error(log, NOC_ERR_ARGUMENT, "camera: up has no direction");
    return NOC_OK;
}

static void store(vec a, float out[3]) {
    out[0] = (float)a.x;
    out[1] = (float)a.y;
    out[2] = (float)a.z;
}

/* Place of a frame's rays in their pixels: the R2 sequence (Roberts 2018), begun at the pixel's centre, moved by the
 * seed. A low-discrepancy sequence over frames converges edges faster than random places. */
static void frame_jitter(const noc_render_params *p, uint32_t frame, float out[2]) {
    static const double step[2] = { 0.75487766624669276, 0.56984029099805327 };
    for (int i = 0; i < 2; i++) {
        double start = fmod(p->seed * step[1 - i], 1.0);
        double x = p->jitter ? fmod(0.5 + start + frame * step[i], 1.0) : 0.5;
        out[i] = NOC_MIN((float)x, 0x1.fffffep-1f);
    }
}

void noc_make_frame_camera(const noc_camera *camera, const noc_render_params *params, uint32_t frame,
                           frame_camera *out) {
    vec eye = load(camera->eye), target = load(camera->target), up = load(camera->up);
    vec forward = { target.x - eye.x, target.y - eye.y, target.z - eye.z };
    forward = scale(forward, 1 / norm(forward));
    up = scale(up, 1 / norm(up));
    vec right = cross(forward, up);
    if (norm(right) < 1e-6) { /* looking along up: any other direction stands in for it */
        up = fabs(forward.y) < 0.9 ? (vec){ 0, 1, 0 } : (vec){ 1, 0, 0 };
        right = cross(forward, up);
    }
    right = scale(right, 1 / norm(right));
    up = cross(right, forward);
    double t = tan(camera->fov_deg * M_PI / 360), aspect = (double)params->width / params->height;
    *out = (frame_camera){ .width = (float)params->width, .height = (float)params->height };
    store(eye, out->eye);
    store(forward, out->forward);
    store(scale(right, t * aspect), out->right);
    store(scale(up, t), out->up);
    out->inv_right2 = (float)(1 / (t * aspect * t * aspect));
    out->inv_up2 = (float)(1 / (t * t));
    frame_jitter(params, frame, out->jitter);
}

_Static_assert((int)BIAS_BIASED == NOC_BIAS_BIASED && (int)BIAS_MIS == NOC_BIAS_MIS &&
                   (int)BIAS_PAIRWISE == NOC_BIAS_PAIRWISE && (int)BIAS_COUNTED == NOC_BIAS_COUNTED,
               "a frame's bias is a noc_bias");

void noc_make_frame_constants(const noc_render_params *p, uint32_t frame, bool history, frame_constants *out) {
    uint32_t flags = (history ? FRAME_HISTORY : 0) | (p->emitters ? FRAME_EMITTERS : 0) |
                     (p->final_ray ? FRAME_FINAL_RAY : 0) | (noc_uses_bias_rays(p) ? FRAME_BIAS_RAYS : 0) |
                     (p->gloss ? 0 : FRAME_MATTE);
    *out = (frame_constants){ .width = (uint32_t)p->width,
                              .height = (uint32_t)p->height,
                              .blocks_x = ((uint32_t)p->width + BLOCK_SIDE - 1) / BLOCK_SIDE,
                              .seed = p->seed,
                              .index = frame,
                              .flags = flags,
                              .bias = (uint32_t)p->bias,
                              .draws = (uint32_t)p->draws,
                              .list = (uint32_t)p->list,
                              .tail = (uint32_t)p->tail,
                              .shadow_rays = (uint32_t)p->shadow_rays,
                              .uniform_every = (uint32_t)p->uniform_every,
                              .rays = (uint32_t)p->rays,
                              .neighbours = (uint32_t)p->neighbours,
                              .influence = noc_influence_scale(p->influence),
                              .radius = (float)p->radius,
                              .m_max = (float)(p->history * p->draws),
                              .reject_depth = (float)p->reject_depth,
                              .reject_normal = (float)p->reject_normal,
                              .sky = (float)p->sky };
}

/* Less light than that, and a map is black: what divides by it stays a float. */
#define BLACK 1e-20
#define MOST_SCALE 1e27 /* times the brightest texel it is a float, too */

void noc_make_frame_environment(const noc_scene *scene, const noc_render_params *p, frame_constants *out) {
    const noc_environment *e = scene->environment;
    if (!e)
        return;
    bool scaled = p->environment_lux > 0 && e->lux > BLACK;
    double scale = NOC_MIN(p->environment_scale * (scaled ? p->environment_lux / e->lux : 1), MOST_SCALE);
    double turn = fmod(0.75 - p->environment_rotation / 360 + 2, 1); /* a middle in the north has its left edge south */
    bool lights = p->environment_light && e->power > BLACK && scale > 0;
    out->flags |= FRAME_ENVIRONMENT | (lights ? FRAME_MAP_LIGHTS : 0);
    out->environment_width = (uint32_t)e->light_width;
    out->environment_height = (uint32_t)e->light_height;
    out->backdrop_width = (uint32_t)e->width;
    out->backdrop_height = (uint32_t)e->height;
    out->environment_turn = (float)turn < 1 ? (float)turn : 0;
    out->environment_scale = (float)scale;
    out->environment_inverse_power = e->power > BLACK ? (float)(1 / e->power) : 0;
    out->environment_level = (float)(scale * e->lux / M_PI);
}
