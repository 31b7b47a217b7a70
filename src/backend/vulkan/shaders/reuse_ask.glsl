/* Rays from the neighbours that are asked to the sample held. */
void main() {
    if (!in_grid())
        return;
    place p = my_place(), q = p;
    q.slot = slot_in_band(p);
    combination c = begin_combination(p);
    int asked = reuse_asked(neighbours_);
    for (int i = 0; i < asked; i++) {
        bool ask = reuse_asks(c.held, i, target_at(c, i));
        segment s;
        s.o = s.d = vec3(0.0);
        if (ask) {
            uint slot = asked_slot(i);
            receiver r = receiver_at(neighbour_surfaces_, slot / BLOCK, slot % BLOCK);
            s = shadow_segment(r.p, r.n, light_of_neighbours(c.held.light), c.held.u, c.held.v, HERE.ray_offset);
        }
        ray_put(q, uint(i), ask, s.o, s.d);
    }
}
