/* Textures, and where vertices are in them. After the bridge. */
uint texel_load(uint place) { return HERE.texels.at[place]; }

uvec3 vertices_of(uint triangle) {
    return uvec3(HERE.indices.at[3u * triangle], HERE.indices.at[3u * triangle + 1u],
                 HERE.indices.at[3u * triangle + 2u]);
}

vec2 corner_in_image(uint vertex) {
    return vec2(uintBitsToFloat(HERE.image_corners.at[2u * vertex]),
                uintBitsToFloat(HERE.image_corners.at[2u * vertex + 1u]));
}

#include "core/texture.h"

/* False: the triangle's mesh has no places in images. */
bool find_corners(uvec3 vertex, out image_corners at) {
    if (HERE.image_corners.at[2u * vertex.x] == 0xffffffffu)
        return false;
    vec2 a = corner_in_image(vertex.x), b = corner_in_image(vertex.y), c = corner_in_image(vertex.z);
    at.u = vec3(a.x, b.x, c.x);
    at.v = vec3(a.y, b.y, c.y);
    return true;
}
