/* Views that sum light up as it is shaded (render/frame_views.h): each where HERE.views has its bit. */
#include "core/measured.h"
#include "core/sources.h"

Floats slots_; /* of the pixel at hand: labels from first_ on, then sums */
uint first_;
uint slot_count_;
float source_label(uint i) { return slots_.at[first_ + i * BLOCK]; }
float source_sum(uint i) { return slots_.at[first_ + (slot_count_ + i) * BLOCK]; }

/* arrays: that a block has. */
void add_source(Floats to, uint slots, uint arrays, place p, float label, float y) {
    slots_ = to;
    first_ = arrays * p.block * BLOCK + p.lane;
    slot_count_ = slots;
    source_slot s = source_find(slots, label);
    EXACT float sum = s.sum + y;
    to.at[first_ + (slots + s.at) * BLOCK] = sum;
    to.at[first_ + s.at * BLOCK] = label;
}

/* c: what a light adds to a pixel's colour. */
void note_light(place p, uint id, vec3 c) {
    if ((HERE.views & (VK_VIEW_GROUP | VK_VIEW_PLACED | VK_VIEW_EMITTERS)) == 0u)
        return;
    float y = luminance(c);
    if (!colour_finite(c) || !(y > 0.0))
        return;
    light_record l = HERE.lights.at[id];
    if ((HERE.views & VK_VIEW_GROUP) != 0u)
        add_source(HERE.view_group, SOURCE_SLOTS, 2u * SOURCE_SLOTS, p, source_group(l.flags), y);
    if ((HERE.views & VK_VIEW_PLACED) != 0u)
        add_source(HERE.view_placed, SOURCE_SLOTS, 2u * SOURCE_SLOTS, p, source_placed(l.kind, l.flags), y);
    if ((HERE.views & VK_VIEW_EMITTERS) != 0u)
        add_source(HERE.view_emitters, EMITTER_SLOTS, 2u * EMITTER_SLOTS + 1u, p, HERE.emitter_labels.at[id], y);
}

void note_sky(place p, vec3 c) {
    if ((HERE.views & VK_VIEW_EMITTERS) == 0u)
        return;
    uint at = ((2u * EMITTER_SLOTS + 1u) * p.block + 2u * EMITTER_SLOTS) * BLOCK + p.lane;
    float y = 0.0;
    if (colour_finite(c))
        y = luminance(c);
    EXACT float sum = max_(HERE.view_emitters.at[at], 0.0) + y;
    HERE.view_emitters.at[at] = sum;
}

bool measures(place p) { return (HERE.views & VK_VIEW_LUX) != 0u && HERE.view_lux.at[p.slot] >= 0.0; }

void add_lux(place p, float e) {
    if (!lux_adds(e))
        return;
    EXACT float sum = HERE.view_lux.at[p.slot] + e;
    HERE.view_lux.at[p.slot] = sum;
}

/* A sample's light at the surface s; c: what it adds to the colour. */
void note_sample(place p, surf s, reservoir q, light l, vec3 c) {
    if (measures(p))
        add_lux(p, sample_lux(s, q, l));
    note_light(p, q.light, c);
}
