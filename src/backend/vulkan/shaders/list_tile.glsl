/* The tile at hand as lists use it: its memory (list_memory.h), and core's bridges. After the bridge. */
#include "tile.glsl"
#include "backend/vulkan/list_memory.h"
#include "core/list_sketch.h"
#include "core/list_build.h"

/* ---- clusters: a head of 16 words a hierarchy, then blocks of nodes and of lights ---- */

uint cluster_word(uint at) { return HERE.clusters.at[at]; }
float cluster_real(uint at) { return uintBitsToFloat(cluster_word(at)); }
list_top top_load(uint part) { return list_top(cluster_word(16u * part), cluster_word(16u * part + 1u)); }
uint lights_of_cluster(uint part, uint cluster) { return cluster_word(16u * part + 2u) + 48u * cluster; }
list_node node_load(uint part, uint level, uint block, int l) {
    uint at = cluster_word(16u * part + 3u + level) + 160u * block + uint(l);
    return list_node(vec3(cluster_real(at), cluster_real(at + 16u), cluster_real(at + 32u)), cluster_real(at + 48u),
                     vec3(cluster_real(at + 64u), cluster_real(at + 80u), cluster_real(at + 96u)),
                     cluster_real(at + 112u), cluster_real(at + 128u), cluster_real(at + 144u));
}
list_cluster cluster_load(uint part, uint cluster) {
    list_node n = node_load(part, 0u, cluster / 16u, int(cluster % 16u));
    return list_cluster(n.c, n.radius, n.power);
}
list_brief brief_load(uint part, uint cluster, int l) {
    uint at = lights_of_cluster(part, cluster) + uint(l);
    return list_brief(cluster_word(at + 16u), cluster_word(at + 32u));
}
uint cluster_light(uint part, uint cluster, uint place) {
    return cluster_word(lights_of_cluster(part, cluster) + place);
}

list_material list_material_load(uint material) {
    material_record m = HERE.materials.at[material];
    return list_material(splat3(m.albedo), (FRAME.flags & FRAME_MATTE) != 0u ? 0.0 : m.f0, m.alpha);
}

/* ---- what is chosen ---- */

void entry_store(uint i, list_entry e) {
    tile_store(TILE_CHOSEN + i, e.light);
    tile_store(TILE_CHANCE + i, e.weight);
}
list_entry entry_load(uint i) { return list_entry(tile_load(TILE_CHOSEN + i), tile_real(TILE_CHANCE + i)); }
