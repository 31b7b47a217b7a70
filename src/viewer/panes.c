#include "viewer/panes.h"

#include "viewer/legend.h"
#include "viewer/option.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOVING_QUALITY 80 /* of JPEG, of 100 */
#define RESTING_QUALITY 92
#define MOST_SMOOTHED 3e5 /* pixels: a smoother takes some 330 bytes each */
#define ADAPTS_IN 0.4     /* s: exposure follows the picture with that time constant */
#define MOST_APART 0.35   /* EV: pictures that move are metered so far from those at rest, at most */
#define TELLING 6         /* pictures after a rest that tell it */
#define LOOKS_AWAY 5.0    /* s: nobody looks where a picture was not shown for so long */

noc_status panes_init(panes *p, viewer_world *world, outbox *box, noc_log *log, const look *first) {
    *p = (panes){ .world = world, .box = box, .log = log, .exposure = NAN, .moved = TELLING, .change = 1 };
    p->encoder = noc_image_encoder_create(log);
    p->pane[0].look = *first;
    return p->encoder ? panes_set_layout(p, WIRE_SINGLE) : NOC_ERR_MEMORY;
}

static void drop_smoother(pane *of) {
    noc_smoother_destroy(of->smoother);
    of->smoother = NULL;
    of->calm = NULL;
}

static void drop(pane *of) {
    drop_smoother(of);
    noc_view_destroy(of->view);
    of->view = NULL;
}

void panes_finish(panes *p) {
    for (int i = 0; i < WIRE_PANES; i++) {
        drop(&p->pane[i]);
        json_decref(p->pane[i].legend);
    }
    noc_image_encoder_destroy(p->encoder);
    free(p->rgb);
    *p = (panes){ 0 };
}

/* What the panes of the layout `methods` differ in, from the first one's look. */
static const char *const methods[WIRE_PANES][2] = { { "reference", "lists" }, { "is", "lists" },
                                                    { "ris", "lists" },       { "ris", "influence" },
                                                    { "ris", "light-bvh" },   { "restir", "lists" } };

static int panes_of(wire_layout layout) {
    static const int count[] = {
        [WIRE_SINGLE] = 1, [WIRE_DIVIDER] = 2, [WIRE_METHODS] = WIRE_PANES, [WIRE_DIFFERENCE] = 3
    };
    return count[layout];
}

static void set_method(look *l, const char *method, const char *candidates) {
    char why[128];
    look_set(l, "method", method, why, sizeof(why));
    if (candidates)
        look_set(l, "candidates", candidates, why, sizeof(why));
}

/* All panes of a difference show one kind of numbers: where the reference cannot, they begin with the picture. */
static void let_reference_show(look *l) {
    look other = *l;
    char why[128];
    if (!look_set(&other, "method", "reference", why, sizeof(why)))
        look_set(l, "show", "picture", why, sizeof(why));
}

noc_status panes_set_layout(panes *p, wire_layout layout) {
    int count = panes_of(layout);
    if (layout == WIRE_METHODS && p->layout != layout)
        p->own = p->pane[0].look;
    if (p->layout == WIRE_METHODS && p->layout != layout)
        p->pane[0].look = p->own;
    if (layout == WIRE_DIFFERENCE && p->layout != layout)
        let_reference_show(&p->pane[0].look);
    for (int i = 0; i < WIRE_PANES; i++) {
        bool viewed = i < count && !(layout == WIRE_DIFFERENCE && i == 2);
        if (i >= count || !viewed) {
            drop(&p->pane[i]);
        } else if (!p->pane[i].view) {
            p->pane[i].view = noc_view_create(world_device(p->world), world_scene(p->world));
            if (!p->pane[i].view)
                return NOC_ERR_MEMORY;
        }
        if (p->layout != layout)
            p->pane[i].bar = i && viewed ? p->pane[0].bar : i ? (noc_bar){ 0 } : p->pane[0].bar;
        if (i && p->layout != layout)
            p->pane[i].look = p->pane[0].look;
        if (layout == WIRE_METHODS && p->layout != layout) {
            set_method(&p->pane[i].look, methods[i][0], methods[i][1]);
            p->pane[i].look.smooth = false; /* what methods make of it is compared */
        }
        p->pane[i].shown = 0;
    }
    if (layout == WIRE_DIFFERENCE)
        set_method(&p->pane[1].look, "reference", NULL);
    p->layout = layout;
    p->count = count;
    p->change++;
    return NOC_OK;
}

static panes_need need_of(const look *before, const look *after) {
    if (memcmp(&before->render, &after->render, sizeof(before->render)))
        return PANES_ANEW;
    return before->show != after->show || before->frames != after->frames ? PANES_FRAME : PANES_PUBLISH;
}

bool panes_set(panes *p, int which, const char *name, const char *value, panes_need *need, char *why, size_t size) {
    static const char *const of_bars[] = { "show", "show-range", "show-scale", "isolines" }; /* it is found anew */
    *need = PANES_PUBLISH;
    if (which >= p->count) {
        snprintf(why, size, "there is no pane %d", which);
        return false;
    }
    bool of_bar = viewer_among(name, of_bars, sizeof(of_bars) / sizeof(*of_bars));
    bool all = which < 0 || (of_bar && p->layout == WIRE_DIFFERENCE); /* which shows one kind of numbers */
    look next[WIRE_PANES];
    int first = all ? 0 : which, end = all ? p->count : which + 1;
    for (int i = first; i < end; i++) {
        next[i] = p->pane[i].look;
        if (!look_set(&next[i], name, value, why, size))
            return false;
    }
    for (int i = first; i < end; i++) {
        panes_need now = need_of(&p->pane[i].look, &next[i]);
        *need = now > *need ? now : *need;
        p->pane[i].look = next[i];
        if (of_bar)
            p->pane[i].bar = (noc_bar){ 0 };
    }
    return true;
}

/* Returns the caption of a pane among others. */
static const char *caption_of(const panes *p, int which) {
    static const char *const names[] = { "reference",      "importance sampling", "RIS, lists",
                                         "RIS, influence", "RIS, light BVH",      "ReSTIR" };
    if (p->layout == WIRE_METHODS)
        return names[which];
    if (p->layout == WIRE_DIFFERENCE)
        return which == 2 ? "difference" : which ? "reference" : "this";
    return p->layout == WIRE_DIVIDER ? which ? "B" : "A" : "";
}

/* The reference is shown as it was rendered: a pane of that method or of that caption is never smoothed. */
static bool is_reference(const panes *p, int which) {
    return p->pane[which].look.render.method == NOC_METHOD_REFERENCE || !strcmp(caption_of(p, which), "reference");
}

/* ---- frames ---- */

noc_status panes_headlight(panes *p, const noc_camera *camera, int width, int height, const noc_progress *progress) {
    pane *to = &p->pane[0];
    noc_render_params params = noc_render_default_params();
    params.width = width;
    params.height = height;
    params.method = NOC_METHOD_HEADLIGHT;
    uint64_t world = world_published(p->world);
    noc_status status = noc_view_render(to->view, camera, &params, progress);
    noc_view_get_stats(to->view, &to->stats);
    to->method = params.method;
    to->world = world;
    return status;
}

/* What is to be shown of a moving frame; NULL: the frame. */
static const noc_image *smooth(panes *p, pane *of) {
    if (!of->smoother)
        of->smoother = noc_smoother_create(world_device(p->world));
    return of->smoother ? noc_smoother_step(of->smoother, of->view, NULL) : NULL;
}

noc_status panes_render(panes *p, int which, const noc_camera *camera, int width, int height, bool rests,
                        const noc_progress *progress) {
    pane *to = &p->pane[which];
    noc_render_params params = look_params(&to->look, width, height);
    bool calm = to->look.smooth && !to->look.show && !is_reference(p, which) && (double)width * height <= MOST_SMOOTHED;
    bool varies = rests && params.accumulate; /* a mean has one */
    params.aovs |= varies ? 1u << NOC_AOV_VARIANCE : calm && !rests ? NOC_SMOOTH_AOVS : 0;
    uint64_t change = p->change, world = world_published(p->world);
    noc_status status = noc_view_render(to->view, camera, &params, progress);
    noc_view_get_stats(to->view, &to->stats);
    if (!to->stats.frames) /* what was broken off has taken the picture before it along */
        to->shown = 0;
    if (status)
        return status;
    to->varies = varies;
    to->calm = NULL;
    if (params.aovs & NOC_SMOOTH_AOVS && !rests)
        to->calm = smooth(p, to);
    to->width = width;
    to->height = height;
    to->method = params.method;
    to->world = world;
    to->shown = change;
    return NOC_OK;
}

/* ---- pictures ---- */

static bool reserve(panes *p, int width, int height) {
    size_t need = (size_t)width * (size_t)height * 3;
    if (need > p->rgb_size) {
        free(p->rgb);
        p->rgb = malloc(need);
        p->rgb_size = p->rgb ? need : 0;
    }
    return need <= p->rgb_size;
}

/* Automatic exposure that does not flicker: it follows that of the first pane's pictures in a while, and all panes have
 * the same. Of a coarse and smoothed picture the meter sees other peaks than of a whole one: exposure is kept while the
 * first of them after a rest tell how far it is off, and then they are corrected by that. */
static void expose(panes *p, int which, const noc_image *image, bool moves, double now) {
    double found = which && !isnan(p->exposure) ? NAN : noc_image_auto_ev100(image);
    if (isnan(found))
        return;
    if (moves && p->moved < TELLING) {
        p->apart += (fmax(-MOST_APART, fmin(p->exposure - found, MOST_APART)) - p->apart) / ++p->moved;
        p->exposed = now;
        return;
    }
    found += moves ? p->apart : 0;
    double share = isnan(p->exposure) ? 1 : 1 - exp(-(now - p->exposed) / ADAPTS_IN);
    p->exposure = isnan(p->exposure) ? found : p->exposure + share * (found - p->exposure);
    p->exposed = now;
    p->moved = moves ? p->moved : 0;
}

/* Takes a picture that the library has made. */
static noc_status take(panes *p, uint8_t *rgb, const wire_head *head) {
    bool room = reserve(p, head->width, head->height);
    if (room)
        memcpy(p->rgb, rgb, (size_t)head->width * (size_t)head->height * 3);
    free(rgb);
    return room ? NOC_OK : NOC_ERR_MEMORY;
}

static bool shows_lights(const look *l) {
    noc_aov aov = (noc_aov)(l->show - 1);
    return aov == NOC_AOV_INFLUENTIAL || aov == NOC_AOV_RUNNER_UP || aov == NOC_AOV_LIGHT;
}

/* The first pane whose bar is found as that of `which`: it finds it for both. */
static int finds_bar(const panes *p, int which) {
    const look *l = &p->pane[which].look;
    for (int i = 0; i < which; i++) {
        const look *other = &p->pane[i].look;
        if (p->pane[i].view && other->show == l->show && other->channel.scale == l->channel.scale &&
            other->channel.low == other->channel.high && p->pane[i].bar.high > p->pane[i].bar.low)
            return i;
    }
    return which;
}

/* Ends that are found are kept as long as they fit, and are the same in all panes: a colour means one thing. */
static noc_status settle_bar(panes *p, int which, const noc_channel *channel, noc_channel_params *params) {
    pane *of = &p->pane[which];
    int from = finds_bar(p, which);
    params->last = &of->bar;
    noc_bar bar = p->pane[from].bar;
    if (from == which || params->low != params->high) {
        noc_status status = noc_channel_bar(channel, params, &bar, p->log);
        if (status)
            return status;
    }
    of->bar = bar;
    params->low = bar.low;
    params->high = bar.high;
    return NOC_OK;
}

/* Numbers in colours. */
static noc_status draw_numbers(panes *p, int which, wire_head *head) {
    pane *of = &p->pane[which];
    of->ev100 = NAN;
    noc_channel_params params = of->look.channel;
    params.part = NOC_CHANNEL_PICTURE;
    noc_channel *channel = noc_view_aov(of->view, (noc_aov)(of->look.show - 1));
    uint8_t *rgb = NULL;
    noc_status status = channel ? NOC_OK : NOC_ERR_MEMORY;
    if (!status && look_has_bar(&of->look))
        status = settle_bar(p, which, channel, &params);
    if (!status)
        status = noc_channel_to_srgb8(channel, &params, &rgb, &head->width, &head->height, p->log);
    legend_names names;
    if (!status && shows_lights(&of->look) && !legend_name_lights(&names, channel, world_scene(p->world)))
        status = NOC_ERR_MEMORY;
    json_decref(of->legend);
    of->legend = status ? NULL : legend_of(channel, &params, p->log);
    noc_channel_destroy(channel);
    head->flags |= WIRE_LEGEND;
    if (status) {
        free(rgb);
        return status;
    }
    return take(p, rgb, head);
}

/* The picture of a look as sRGB in p->rgb. */
static noc_status draw(panes *p, int which, const panes_picture *what, wire_head *head) {
    pane *from = &p->pane[which];
    noc_image *own = from->calm ? NULL : noc_view_image(from->view);
    const noc_image *image = from->calm ? from->calm : own;
    if (!image)
        return NOC_ERR_MEMORY;
    head->flags |= from->calm ? WIRE_SMOOTHED : 0;
    noc_display_params display = from->look.display;
    if (display.auto_exposure) {
        expose(p, which, image, what->moves, what->now);
        display.auto_exposure = isnan(p->exposure);
        display.ev100 = p->exposure - display.compensation;
    }
    from->ev100 = display.auto_exposure ? NAN : display.ev100;
    noc_status status =
        reserve(p, image->width, image->height) ? noc_image_to_srgb8(image, &display, p->rgb) : NOC_ERR_MEMORY;
    head->width = image->width;
    head->height = image->height;
    noc_image_destroy(own);
    return status;
}

/* Of two pictures of the same size: while one has its first frame of another size, there is none. */
static noc_status draw_difference(panes *p, wire_head *head) {
    pane *to = &p->pane[2];
    if (p->pane[0].width != p->pane[1].width || p->pane[0].height != p->pane[1].height || !p->pane[0].stats.frames ||
        !p->pane[1].stats.frames)
        return NOC_ERR_CANCELLED;
    noc_image *x = noc_view_image(p->pane[0].view), *r = noc_view_image(p->pane[1].view);
    uint8_t *rgb = NULL;
    noc_difference_params params = { .last = &to->bar, .part = NOC_CHANNEL_PICTURE };
    noc_bar bar;
    noc_status status = x && r ? NOC_OK : NOC_ERR_MEMORY;
    if (!status)
        status = noc_image_compare(x, r, NULL, &to->compared, p->log);
    if (!status)
        status = noc_image_difference_bar(x, r, &params, &bar, p->log);
    if (!status) {
        to->bar = bar;
        params.limit = bar.high;
        status = noc_image_difference(x, r, &params, &rgb, &head->width, &head->height, p->log);
    }
    status = status ? status : take(p, rgb, head);
    json_decref(to->legend);
    to->legend = status ? NULL : legend_of_difference(&bar);
    noc_image_destroy(x);
    noc_image_destroy(r);
    head->flags |= WIRE_LEGEND;
    return status;
}

double panes_error(panes *p, int which) {
    const pane *of = &p->pane[which];
    noc_image *image = of->view && of->varies && of->stats.frames > 1 ? noc_view_image(of->view) : NULL;
    noc_channel *variance = image ? noc_view_aov(of->view, NOC_AOV_VARIANCE) : NULL;
    double sum = 0, mean = 0;
    size_t count = 0, pixels = variance ? (size_t)variance->width * (size_t)variance->height : 0;
    for (size_t i = 0; i < pixels; i++) {
        if (!(variance->value[i] >= 0))
            continue;
        const float *c = image->rgb + 3 * i;
        sum += (double)variance->value[i];
        mean += 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
        count++;
    }
    noc_channel_destroy(variance);
    noc_image_destroy(image);
    if (!count || !(mean > 0))
        return NAN;
    return sqrt(sum / (double)count / (double)of->stats.frames) / (mean / (double)count);
}

static void set_number(json_t *to, const char *key, double value) {
    json_object_set_new(to, key, isfinite(value) ? json_real(value) : json_null());
}

/* What the newest picture of a pane was made with. A difference is as old as the older of the two that it is of. */
static void tell_made(const panes *p, int which, json_t *m) {
    const pane *of = &p->pane[which];
    uint64_t older = p->pane[0].world < p->pane[1].world ? p->pane[0].world : p->pane[1].world;
    json_object_set_new(m, "world", json_integer((json_int_t)(of->view ? of->world : older)));
    look made = of->look;
    made.render.method = of->method;
    static const char *const names[] = { "show", "method" };
    for (int i = 0; i < 2 && of->view; i++) {
        char text[64];
        look_get(&made, names[i], text, sizeof(text));
        json_object_set_new(m, names[i], json_string(text));
    }
}

static char *stats_of(panes *p, int which, const panes_picture *what, const wire_head *head) {
    const pane *of = &p->pane[which];
    bool fewer = !of->view && p->pane[1].stats.frames < p->pane[0].stats.frames; /* a difference has those of both */
    const noc_frame_stats *f = &p->pane[of->view ? which : fewer].stats;
    json_t *m = wire_begin("stats");
    json_object_set_new(m, "pane", json_integer(which));
    tell_made(p, which, m);
    json_object_set_new(m, "frames", json_integer((json_int_t)f->frames));
    set_number(m, "seconds", f->wall_seconds);
    set_number(m, "rays", f->wall_seconds > 0 ? (double)(f->rays_primary + f->rays_shadow) / f->wall_seconds : 0);
    set_number(m, "error", (double)head->error);
    json_object_set_new(m, "size", json_pack("[ii]", head->width, head->height));
    const noc_camera *c = what->camera;
    json_object_set_new(m, "camera",
                        json_pack("{s:[fff],s:[fff],s:f}", "eye", c->eye[0], c->eye[1], c->eye[2], "target",
                                  c->target[0], c->target[1], c->target[2], "fov", c->fov_deg));
    if (of->view)
        set_number(m, "ev100", of->ev100);
    if (!of->view) {
        set_number(m, "rmse", of->compared.all.rmse);
        set_number(m, "relmse", of->compared.all.relmse);
        set_number(m, "bias", of->compared.all.bias);
    }
    if (of->legend && (of->look.show || !of->view))
        json_object_set(m, "legend", of->legend);
    return wire_end(m);
}

static noc_status encode(panes *p, const wire_head *head, bool moves, unsigned char **message, size_t *size) {
    const uint8_t *data;
    size_t bytes;
    noc_status status = noc_image_encode_srgb8(p->encoder, head->png ? NOC_IMAGE_PNG : NOC_IMAGE_JPEG,
                                               moves ? MOVING_QUALITY : RESTING_QUALITY, p->rgb, head->width,
                                               head->height, &data, &bytes);
    if (status)
        return status;
    *size = WIRE_HEAD + bytes;
    *message = malloc(OUTBOX_ROOM + *size);
    if (!*message)
        return NOC_ERR_MEMORY;
    wire_write_head(head, *message + OUTBOX_ROOM);
    memcpy(*message + OUTBOX_ROOM + WIRE_HEAD, data, bytes);
    return NOC_OK;
}

noc_status panes_publish(panes *p, int which, const panes_picture *what) {
    pane *of = &p->pane[which];
    const noc_frame_stats *f = &p->pane[of->view ? which : 0].stats;
    wire_head head = { .kind = WIRE_IS_PICTURE,
                       .pane = which,
                       .png = what->lossless || !noc_image_codec_built(NOC_IMAGE_JPEG),
                       .flags = what->moves ? WIRE_MOVES : 0,
                       .number = of->number + 1,
                       .input = what->input,
                       .frames = (uint32_t)f->frames,
                       .error = what->moves ? NAN : (float)panes_error(p, which),
                       .seconds = (float)f->wall_seconds };
    noc_status status = !of->view       ? draw_difference(p, &head)
                        : of->look.show ? draw_numbers(p, which, &head)
                                        : draw(p, which, what, &head);
    unsigned char *message = NULL;
    size_t size = 0;
    status = status ? status : encode(p, &head, what->moves, &message, &size);
    if (status)
        return status;
    if (what->lossless) /* it rests for a while: a third or more of its memory is not needed */
        drop_smoother(of);
    of->number++;
    outbox_picture(p->box, which, of->number, message, size, stats_of(p, which, what, &head));
    return NOC_OK;
}

bool panes_watched(panes *p, int which, double now) { return outbox_waits(p->box, which, now) < LOOKS_AWAY; }

json_t *panes_state(const panes *p) {
    json_t *list = json_array();
    for (int i = 0; i < p->count; i++) {
        const look *l = &p->pane[i].look;
        json_t *idle = look_idle(l, p->has_map);
        if (is_reference(p, i))
            json_object_set_new(idle, "smooth", json_string("the reference is not smoothed"));
        json_array_append_new(list, json_pack("{s:o?,s:o?,s:s,s:b}", "values", look_values(l), "idle", idle, "caption",
                                              caption_of(p, i), "failed", p->pane[i].failed));
    }
    return list;
}
