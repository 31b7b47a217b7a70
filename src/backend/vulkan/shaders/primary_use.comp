#version 460
/* What the camera's rays hit becomes the receivers of the G-buffer. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/hit.h"

vec3 corner(uint vertex) { return three_of(HERE.positions, vertex); }

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    uint b = p.slot / BLOCK, l = p.lane;
    receiver r = receiver_none();
    uint triangle = HERE.hits.at[b].triangle[l];
    if (p.inside && triangle != 0xffffffffu) {
        tlas_entry e = HERE.entries.at[HERE.hits.at[b].entry[l]];
        triangle = e.order.at[triangle];
        vec3 d = vec3(HERE.rays.at[b].d[0][l], HERE.rays.at[b].d[1][l], HERE.rays.at[b].d[2][l]);
        corners t;
        t.a = corner(HERE.indices.at[3u * triangle]);
        t.b = corner(HERE.indices.at[3u * triangle + 1u]);
        t.c = corner(HERE.indices.at[3u * triangle + 2u]);
        r.p = hit_point(t, HERE.hits.at[b].u[l], HERE.hits.at[b].v[l]);
        vec3 n = hit_normal(t);
        EXACT float toward = n.x * d.x + n.y * d.y + n.z * d.z;
        EXACT float d2 = d.x * d.x + d.y * d.y + d.z * d.z;
        float side = toward < 0.0 ? 1.0 : -1.0;
        r.n = n * side;
        r.depth = HERE.hits.at[b].t[l] * sqrt(d2);
        r.material = HERE.triangle_material.at[triangle];
        uint id = HERE.triangle_light.at[triangle];
        if (id != NO_LIGHT) {
            light_record q = HERE.lights.at[id];
            bool shows = (side > 0.0 || (q.flags & LIGHT_TWO_SIDED) != 0u) &&
                         (q.e[0] > 0.0 || q.e[1] > 0.0 || q.e[2] > 0.0);
            id = shows ? id : NO_LIGHT;
        }
        r.light = id;
    }
    receiver_put(HERE.surfaces, p.block, l, r, 0u);
}
