/* A frame that takes long is run in pieces, so that its caller can break it off between them. A piece is as many rows
 * of a step as are expected to take PIECE_SECONDS, by what invocations of its shader took before; steps that take less
 * are put together. A frame of which less is expected is one submission that nobody waits for: it is not cut. */
#include "backend/vulkan/vulkan.h"

#define PIECE_SECONDS 0.1
enum { FIRST_INVOCATIONS = 1 << 15, MOST_GROWTH = 4 }; /* of a shader's first piece; of rows from piece to piece */

static bool can_cut(vk_domain domain) {
    return domain == VK_DOMAIN_PIXELS || domain == VK_DOMAIN_LAYERS || domain == VK_DOMAIN_TILES ||
           domain == VK_DOMAIN_BLOCKS || domain == VK_DOMAIN_RAYS;
}

static uint32_t rows_of(const vk_view *v, const vk_step *s) { return s->rows ? s->rows : v->b.blocks_y; }

/* Of a row of blocks; a step that is not cut counts as one. */
static double invocations_a_row(const vk_view *v, const vk_step *s) {
    return can_cut(s->domain) ? (double)v->b.blocks_x * BLOCK * s->slots : 1.0 / rows_of(v, s);
}

double noc_vk_expected_seconds(const vk_view *v, const vk_step *s) {
    double cost = v->pace.cost[s->pass][s->shader];
    return cost > 0 ? cost * invocations_a_row(v, s) * rows_of(v, s) : INFINITY;
}

void noc_vk_begin_pace(vk_view *v, double expected) {
    vk_pace *p = &v->pace;
    p->on = p->progress && p->progress->update && expected > PIECE_SECONDS;
    p->due = 0;
    memset(p->recorded, 0, sizeof(p->recorded));
}

bool noc_vk_may_go_on(const vk_view *v) {
    const noc_progress *p = v->pace.progress;
    return !p || !p->update || p->update(p->user, "rendering", v->pace.done);
}

bool noc_vk_piece_is_due(const vk_view *v, const vk_step *next) {
    const vk_pace *p = &v->pace;
    return p->on && (p->due >= PIECE_SECONDS || (p->due > 0 && !(p->cost[next->pass][next->shader] > 0)));
}

uint32_t noc_vk_next_piece(vk_view *v, const vk_step *s, uint32_t first, uint32_t last) {
    vk_pace *p = &v->pace;
    uint32_t left = rows_of(v, s) - first, n = left, unit = s->domain == VK_DOMAIN_TILES ? 4 : 1;
    double row = invocations_a_row(v, s), cost = p->on ? p->cost[s->pass][s->shader] : 0;
    if (!p->on)
        return left;
    if (can_cut(s->domain)) {
        double rows = cost > 0 ? (PIECE_SECONDS - p->due) / (cost * row) : FIRST_INVOCATIONS / row;
        rows = NOC_MIN(rows, last ? MOST_GROWTH * (double)last : left);
        n = NOC_MIN(NOC_MAX((uint32_t)rows / unit * unit, unit), left);
    }
    p->recorded[s->pass][s->shader] += row * n;
    p->due += cost > 0 ? cost * row * n : PIECE_SECONDS;
    return n;
}

void noc_vk_note_piece(vk_view *v, double seconds) {
    vk_pace *p = &v->pace;
    double *cost = p->cost[0], *recorded = p->recorded[0];
    for (int i = 0; i < NOC_PASS_COUNT * VK_SHADER_COUNT; i++)
        if (recorded[i] > 0) { /* one that was unknown is alone in its piece */
            double now = cost[i] > 0 ? cost[i] * seconds / p->due : seconds / recorded[i];
            cost[i] = NOC_MAX(NOC_MAX(now, cost[i] / 2), 1e-15); /* other rows may take longer than these */
        }
    p->due = 0;
    memset(p->recorded, 0, sizeof(p->recorded));
}

void noc_vk_note_frame(vk_view *v, double seconds) {
    if (seconds > PIECE_SECONDS && !v->pace.on)
        memset(v->pace.cost, 0, sizeof(v->pace.cost));
}
