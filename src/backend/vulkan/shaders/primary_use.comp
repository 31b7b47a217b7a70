#version 460
/* What the camera's rays hit becomes the receivers of the G-buffer (core/primary.h). */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"

#include "images.glsl"
#include "core/facade.h"
#include "core/primary.h"

/* The albedo that a texture gives the receiver r, 0: none. */
uint texel_of(ray_hit h, receiver r, place p, uvec3 vertex, bool placed, placement m) {
    uint image = HERE.image_places.at[h.material];
    image_corners at;
    if (image == 0u || !find_corners(vertex, at))
        return 0u;
    uint x = p.x & ~3u, y = p.y & ~3u;
    float apart2 = rays_apart2(frame_direction(x, y), frame_direction(x, y + 1u));
    float width = hit_width(h, r.n, apart2, placed ? placement_scale2(m) : 1.0);
    return hit_texel(h, image - 1u, at, width, splat3(HERE.materials.at[h.material].albedo));
}

/* Where the hit is on a window in the wall: of what that is made, and its light. */
bool find_window(inout ray_hit h, uint triangle) {
    uint number = triangle < HERE.facade_triangles ? HERE.triangle_facade.at[triangle] : 0u;
    if (number == 0u)
        return false;
    facade_record of = HERE.facades.at[number - 1u];
    vec3 p = hit_point(h.at, h.u, h.v);
    uint cell = facade_cell(facade_of_record(of), p);
    uint light = cell == NO_CELL ? NO_LIGHT : HERE.facade_cells.at[cell];
    if (light == NO_LIGHT)
        return false;
    light_record l = HERE.lights.at[light];
    if (!window_covers(splat3(l.p), splat3(l.a), splat3(l.b), p))
        return false;
    h.material = of.material;
    h.light = light;
    return true;
}

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    uint b = p.slot / BLOCK, l = p.lane, number = HERE.hits.at[b].triangle[l];
    uint instance = NO_INSTANCE, texel = 0u, triangle = VK_NO_TRIANGLE;
    receiver r = receiver_none();
    if (p.inside && number != NO_HIT) {
        tlas_entry e = HERE.entries.at[HERE.hits.at[b].entry[l]];
        triangle = e.order.at[number];
        uvec3 vertex = vertices_of(triangle);
        ray_hit h;
        h.at.a = three_of(HERE.positions, vertex.x);
        h.at.b = three_of(HERE.positions, vertex.y);
        h.at.c = three_of(HERE.positions, vertex.z);
        h.u = HERE.hits.at[b].u[l];
        h.v = HERE.hits.at[b].v[l];
        h.far_ = HERE.hits.at[b].t[l];
        h.d = vec3(HERE.rays.at[b].d[0][l], HERE.rays.at[b].d[1][l], HERE.rays.at[b].d[2][l]);
        h.material = HERE.triangle_material.at[triangle];
        h.light = HERE.triangle_light.at[triangle];
        instance = e.instance;
        bool placed = e.placed != NO_INSTANCE, window = !placed && find_window(h, triangle);
        placement m;
        if (placed) {
            m = placement_of_rows(HERE.instances.at[e.placed].transform);
            if (h.light != NO_LIGHT)
                h.light = HERE.instance_lights.at[HERE.instances.at[e.placed].lights + h.light];
            if (instance == NO_INSTANCE)
                triangle = HERE.triangle_count + e.placed; /* a body, for views */
        }
        r = receiver_of_hit(h, placed, m);
        if (HERE.textured != 0u && !window)
            texel = texel_of(h, r, p, vertex, placed, m);
    }
    receiver_put(HERE.surfaces, p.block, l, r, texel);
    if ((HERE.views & VK_VIEW_TRIANGLES) != 0u)
        HERE.view_triangles.at[p.slot] = triangle;
    if (HERE.instanced != 0u)
        HERE.instance.at[p.slot] = instance;
}
