/* What the pixels of a band know of their tile's list and of their rays over it (list_memory.h). After the bridge. */
#include "backend/vulkan/list_memory.h"

uint tile_; /* of the band, whose list is at hand */

uint tile_load(uint at) { return HERE.scratch.at[tile_ * HERE.tile_words + at]; }
float tile_real(uint at) { return uintBitsToFloat(tile_load(at)); }

/* The tile of a block in the band. */
uint tile_of(uint block_x, uint block_y) { return (block_y - HERE.first_row) / 4u * HERE.tiles_x + block_x / 4u; }
/* The number of a block in its tile. */
uint number_in_tile(place p) {
    uint x = p.block % FRAME.blocks_x, y = p.block / FRAME.blocks_x;
    return (y - HERE.first_row) % 4u * min(4u, FRAME.blocks_x - x / 4u * 4u) + x % 4u;
}

uint pixel_; /* of the band */

uint pixel_word(uint field) { return HERE.pixels_at + field * HERE.slots + pixel_; }
uint pixel_load(uint field) { return HERE.scratch.at[pixel_word(field)]; }
float pixel_real(uint field) { return uintBitsToFloat(pixel_load(field)); }
void pixel_store(uint field, uint x) { HERE.scratch.at[pixel_word(field)] = x; }
void pixel_store(uint field, float x) { pixel_store(field, floatBitsToUint(x)); }
uint ray_field(uint ray, uint field) { return PIXEL_RAYS + ray * RAY_WORDS + field; }

void find_pixel(place p) {
    tile_ = tile_of(p.block % FRAME.blocks_x, p.block / FRAME.blocks_x);
    pixel_ = slot_in_band(p);
}

uint entry_light(uint i) { return tile_load(TILE_LIGHT + i); }
float entry_weight(uint i) { return tile_real(TILE_WEIGHT + i); }
