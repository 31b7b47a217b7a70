/* What may be carried from frame to frame: reservoirs, G-buffer, the running mean. */
#include "render/backend.h"

#include <nocturne/option.h>

void noc_history_reset(noc_history *history) { *history = (noc_history){ .set = -1, .epoch = history->epoch + 1 }; }

static bool same_vec(const double a[3], const double b[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

static bool same_camera(const noc_camera *a, const noc_camera *b) {
    return same_vec(a->eye, b->eye) && same_vec(a->target, b->target) && same_vec(a->up, b->up) &&
           a->fov_deg == b->fov_deg;
}

/* What changed options make useless: row by row of the option table, which names every field that can change a picture;
 * AOVs are not among them. */
static unsigned resets_of(const noc_render_params *a, const noc_render_params *b) {
    const noc_option *table = noc_render_options();
    unsigned resets = NOC_RESETS_NOTHING;
    char why[1];
    for (const noc_option *o = table; o->name; o++) {
        if (!memcmp((const char *)a + o->offset, (const char *)b + o->offset, noc_option_size(o)))
            continue;
        if (!noc_option_idle(o, table, a, why, sizeof(why)) || !noc_option_idle(o, table, b, why, sizeof(why)))
            resets |= o->resets;
    }
    return resets;
}

void noc_history_forget(noc_history *h, unsigned resets) {
    if (resets == NOC_RESETS_ALL)
        noc_history_reset(h);
    if (resets & NOC_RESETS_MEAN)
        h->accumulated = 0;
    if (resets & NOC_RESETS_RESERVOIRS)
        h->reusable = h->surfaces = false;
}

/* Does this frame see the surfaces of the last one, to the bit? Views of what its rays hit are gathered from those. */
static bool same_surfaces(const noc_history *h, const frame_constants *c, uint64_t commits, uint32_t aovs) {
    const uint32_t hits = 1u << NOC_AOV_OBJECT | 1u << NOC_AOV_CLASS;
    return h->surfaces && h->seen == commits && !(aovs & hits) && !memcmp(&h->view, &c->camera, sizeof(h->view));
}

void noc_history_begin(noc_history *h, const noc_camera *camera, const noc_render_params *params, uint64_t commits,
                       noc_frame *frame) {
    if (h->started)
        noc_history_forget(h, resets_of(&h->params, params));
    if (h->started && (!same_camera(&h->camera, camera) || h->commits != commits))
        h->accumulated = 0;
    *frame = (noc_frame){ .params = params,
                          .epoch = h->epoch,
                          .accumulated = params->accumulate ? h->accumulated : 0,
                          .seen_before = h->viewed,
                          .history = h->started && h->reusable,
                          .history_set = h->set,
                          .previous_gbuffer = h->gbuffer };
    frame_constants *c = &frame->constants;
    noc_make_frame_constants(params, h->index, frame->history, c);
    noc_make_frame_camera(camera, params, h->index, &c->camera);
    c->previous = h->viewed ? h->view : c->camera;
    c->previous.width = c->camera.width;
    c->previous.height = c->camera.height;
    frame->gbuffer = same_surfaces(h, c, commits, params->aovs) ? h->gbuffer : 1 - h->gbuffer;
    h->started = true;
    h->reusable = false; /* until the frame is completed */
    h->params = *params;
    h->camera = *camera;
    h->commits = commits;
}

void noc_history_end(noc_history *h, const noc_frame *frame, int next_set) {
    h->view = frame->constants.camera;
    h->viewed = h->surfaces = true;
    h->seen = h->commits;
    h->gbuffer = frame->gbuffer;
    h->set = next_set;
    h->reusable = next_set >= 0;
    h->accumulated = frame->accumulated + 1;
    h->index++;
}

/* The dropped frame's random numbers are not used again, so that what replaces it is independent of where it stopped.
 * The first stage only reads what the frame before left. */
void noc_history_drop(noc_history *h, const noc_frame *frame, bool first_stage) {
    h->index++;
    h->reusable = frame->history && first_stage;
    h->surfaces = false;
}
