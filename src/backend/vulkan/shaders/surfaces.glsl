/* Surfaces of receivers: what they are made of, seen from an eye. */
surf surf_of(receiver r, uint texel, vec3 eye) {
    surf s;
    s.p = r.p;
    s.n = r.n;
    vec3 d = sub3(eye, s.p);
    EXACT float inv = 1.0 / sqrt(max_(dot3(d, d), 1e-20));
    s.wo = mul3(d, inv);
    material_record m = HERE.materials.at[r.material == NO_SURFACE ? 0u : r.material];
    s.albedo = splat3(m.albedo);
    s.f0 = (FRAME.flags & FRAME_MATTE) != 0u ? 0.0 : m.f0;
    s.alpha = m.alpha;
    return s;
}

surf surf_at(SurfaceBlocks g, uint block, uint l, vec3 eye) {
    return surf_of(receiver_at(g, block, l), g.at[block].texel[l], eye);
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
