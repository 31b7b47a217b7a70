/* Surfaces that let light through, as any-hit shaders find them. After the bridge. */
#include "images.glsl"
#include "core/through.h"

hitAttributeEXT vec2 pane_at_; /* barycentric, of the second and the third corner */

/* The scene's number of the triangle at hand. */
uint pane_triangle() {
    tlas_entry e = HERE.entries.at[gl_InstanceCustomIndexEXT];
    return e.order.at[gl_PrimitiveID];
}

/* Of the triangle at hand, where the ray meets it. */
float pane_transmittance(uint triangle) {
    vk_pane_record m = HERE.panes.at[HERE.triangle_material.at[triangle]];
    image_corners at;
    if (m.holes == 0u || !find_corners(vertices_of(triangle), at))
        return m.transmittance;
    float u = image_at(at.u, pane_at_.x, pane_at_.y), v = image_at(at.v, pane_at_.x, pane_at_.y);
    return texture_hole(m.holes - 1u, u, v) ? 1.0 : m.transmittance;
}
