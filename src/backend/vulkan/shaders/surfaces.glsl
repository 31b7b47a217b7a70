/* Surfaces of receivers: what they are made of, seen from an eye. */
surf surf_at(SurfaceBlocks g, uint block, uint l, vec3 eye) {
    receiver r = receiver_at(g, block, l);
    material_record m = HERE.materials.at[r.material == NO_SURFACE ? 0u : r.material];
    return surf_of_receiver(r.p, r.n, eye, material_of_record(m), g.at[block].texel[l],
                            (FRAME.flags & FRAME_MATTE) != 0u);
}

vec3 eye_now() { return splat3(FRAME.camera.eye); }

/* c + more, unless that is not finite, which is counted. */
vec3 add_colour(vec3 c, vec3 more, uint at) {
    if (!colour_finite(more)) {
        count_one(VK_COUNT_DROPPED, at);
        return c;
    }
    EXACT vec3 sum = c + more;
    return sum;
}
