/* A pixel's combination with the reservoirs of others (core/combine.h): its neighbours by their numbers, and the two
 * halves between which rays are traced. */
#include "core/neighbours.h"
#include "core/placement.h"
#include "core/reuse.h"
#include "core/shading.h"
#include "surfaces.glsl"

#define NO_NEIGHBOUR 0xffffffffu

uint neighbour_[MAX_NEIGHBOURS]; /* slot of neighbour i; NO_NEIGHBOUR: there is none */
int neighbours_;                 /* draws */
float most_m_;                   /* cap of a neighbour's M */
vec3 neighbour_eye_;
SurfaceBlocks neighbour_surfaces_;
bool partners_; /* one neighbour is asked, which differs from pixel to pixel */
uint partner_;
float answer_[MAX_NEIGHBOURS];

reservoir neighbour_at(uint slot) {
    if (slot == NO_NEIGHBOUR)
        return reservoir(0u, 0.0, 0.0, 0.0, 0.0, 0.0);
    return reservoir_cap(reservoir_at(HERE.source, slot / BLOCK, slot % BLOCK), most_m_);
}

bool neighbour_some(int i) { return neighbour_[i] != NO_NEIGHBOUR; }
bool neighbour_on(int i) { return neighbour_[i] != NO_NEIGHBOUR; }
reservoir neighbour_resv(int i) { return neighbour_at(neighbour_[i]); }
reservoir neighbour_resv_of(uint i) { return neighbour_at(neighbour_[i]); }
float neighbour_answer(int i) { return answer_[i]; }

uint asked_slot(int i) { return neighbour_[partners_ ? partner_ : uint(i)]; }
surf neighbour_surf(int i) {
    uint slot = asked_slot(i);
    return surf_at(neighbour_surfaces_, slot / BLOCK, slot % BLOCK, neighbour_eye_);
}

#include "core/combine.h"

/* Takes the pixel at (x, y) of `from` as neighbour i, if it sees a surface like `here`. */
void offer_neighbour(int i, receiver here, SurfaceBlocks from, pixel at) {
    neighbour_[i] = NO_NEIGHBOUR;
    if (!at.inside || !receives(here))
        return;
    place q = place_at(at.x, at.y);
    if (receivers_alike(here, receiver_at(from, q.block, q.lane)))
        neighbour_[i] = q.slot;
}

#ifdef TEMPORAL
/* What the pixel sees, where it was in the frame before. */
receiver taken_back(place p) {
    receiver here = receiver_at(HERE.surfaces, p.block, p.lane);
    uint instance = HERE.moved != 0u ? HERE.instance.at[p.slot] : NO_INSTANCE;
    if (instance != NO_INSTANCE && HERE.backs.at[instance].known != 0u)
        here = receiver_back(here, splat3(HERE.backs.at[instance].from),
                             placement_of_rows(HERE.backs.at[instance].rows));
    return here;
}

/* The pixel of the frame before that saw what this one sees. */
void gather(place p) {
    receiver here = taken_back(p);
    neighbours_ = 1;
    most_m_ = FRAME.m_max;
    neighbour_eye_ = splat3(FRAME.previous.eye);
    neighbour_surfaces_ = HERE.previous;
    offer_neighbour(0, here, HERE.previous, history_place(here));
}
#define OWN HERE.target
#define OWN_VISIBLE HERE.target_visible
light light_of_neighbours(uint i) { return past_light_load(i); }
#else
/* Pixels around. */
void gather(place p) {
    receiver here = receiver_at(HERE.surfaces, p.block, p.lane);
    uint key = neighbour_key(p.x, p.y);
    neighbours_ = int(FRAME.neighbours);
    most_m_ = 1e30;
    neighbour_eye_ = eye_now();
    neighbour_surfaces_ = HERE.surfaces;
    for (int i = 0; i < neighbours_; i++) {
        v3 offset = neighbour_offset(key, HERE.dimension + DIM_NEIGHBOUR(i));
        offer_neighbour(i, here, HERE.surfaces, neighbour_place(p.x, p.y, offset));
    }
}
#define OWN HERE.source
#define OWN_VISIBLE HERE.source_visible
light light_of_neighbours(uint i) { return light_load(i); }
#endif

/* What both halves begin with. */
struct combination {
    surf s;
    reservoir own;
    reservoir_builder held;
    uint key;
};

combination begin_combination(place p) {
    combination c;
    gather(p);
    c.s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
    c.own = reservoir_at(OWN, p.block, p.lane);
    c.key = key_at(p, FRAME.index);
    c.held = reuse_begin(c.s, c.own, c.key, HERE.dimension, neighbours_);
    partners_ = reuse_asked(neighbours_) < neighbours_;
    partner_ = partners_ ? reuse_partner(c.key, HERE.dimension, neighbours_) : 0u;
    return c;
}

/* Target of the sample held at the i-th neighbour that is asked, unshadowed. */
float target_at(combination c, int i) {
    bool on = c.held.w_sum > 0.0 && asked_slot(i) != NO_NEIGHBOUR;
    if (partners_ && on)
        on = neighbour_at(asked_slot(i)).m > 0.0;
    return on ? reuse_target(i, on, c.held, light_of_neighbours(c.held.light)) : 0.0;
}
