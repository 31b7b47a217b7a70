#include "base/base.h"

#include <nocturne/render.h>

void noc_render_use_preset(noc_render_params *p, noc_preset preset) {
    if (!p)
        return;
    noc_render_params d = noc_render_default_params();
    bool interactive = preset == NOC_PRESET_INTERACTIVE;
    p->method = d.method;
    p->candidates = d.candidates;
    p->list = interactive ? 32 : d.list;
    p->tail = interactive ? 64 : d.tail;
    p->shadow_rays = preset == NOC_PRESET_QUICK ? 4 : d.shadow_rays;
    p->learn = d.learn;
    p->temporal = d.temporal;
    p->spatial = d.spatial;
    p->history = d.history;
    p->bias = d.bias;
    p->bias_rays = d.bias_rays;
    p->visibility_reuse = d.visibility_reuse;
}
