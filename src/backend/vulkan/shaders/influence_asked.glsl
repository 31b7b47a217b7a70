/* What the groups of a tile asked, and what they list. After influence.glsl, and tile_load and tile_real. */
vec3 group_three(uint group, uint field) {
    return vec3(tile_real(group_word(group, field)), tile_real(group_word(group, field + 1u)),
                tile_real(group_word(group, field + 2u)));
}
influence_region group_region(uint group) {
    return influence_box(group_three(group, GROUP_LO), group_three(group, GROUP_HI), group_three(group, GROUP_N),
                         tile_real(group_word(group, GROUP_BACK)));
}

uint tiles_of_band() { return HERE.pixels_at / HERE.tile_words; }
uint pool_word(uint at) { return HERE.pixels_at + at; }

/* Where the group's lights are in the pool, and how many it lists: none where the pool has no room for them. */
uint found_from(uint group) { return tile_load(FOUND_FROM) + tile_load(group_word(group, GROUP_FROM)); }
uint found_count(uint group) {
    uint count = tile_load(group_word(group, GROUP_COUNT));
    return found_from(group) + count <= HERE.pool_room ? count : 0u;
}

/* Where the samples of a tile's set begin, and the sums of its pixels' weights. */
uint draws_at(uint tile, uint set) {
    return HERE.pixels_at + tiles_of_band() * FOUND_POOL + FOUND_SPARE +
           (tile * CUT_SIXTEENS + set) * HERE.draws * DRAW_WORDS;
}
uint sums_at() { return draws_at(tiles_of_band(), 0u); }
