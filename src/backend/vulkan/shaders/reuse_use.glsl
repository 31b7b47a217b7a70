/* The combination, with the answers of the rays where there were any. */
void main() {
    if (!in_grid())
        return;
    place p = my_place();
    combination c = begin_combination(p);
    bool rays = (FRAME.flags & FRAME_BIAS_RAYS) != 0u;
    if (FRAME.bias != BIAS_BIASED) {
        int asked = reuse_asked(neighbours_);
        for (int i = 0; i < asked; i++) {
            float t = target_at(c, i);
            bool ask = rays && reuse_asks(c.held, i, t);
            bool clear = ask && HERE.answers.at[uint(i) * HERE.slots + slot_in_band(p)] == VK_ANSWER_CLEAR;
            answer_[i] = reuse_answer(t, ask, clear);
        }
    }
    combined r = reuse_end(c.s, c.own, c.held, c.key, HERE.dimension, neighbours_);
    reservoir_put(HERE.target, p.block, p.lane, r.r);
    HERE.target_visible.at[p.slot] = OWN_VISIBLE.at[p.slot] != 0u && r.own ? 1u : 0u;
}
