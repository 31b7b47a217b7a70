/* Observations of a frame (list_memory.h). After the bridge. */
uint lights_word(uint tile) { return SEEN_HEAD + tile * (HERE.list_room + 1u); } /* their number comes first */
uint row_word(uint row) {
    uint tiles = HERE.tiles_x * ((HERE.blocks_y + 3u) / 4u);
    return SEEN_HEAD + tiles * (HERE.list_room + 1u) + row * (ROW_COUNTS + HERE.list_room);
}

/* Where the list of a run of cells begins. */
uint run_word(uint run) { return CACHE_HEAD + CELL_WORDS * HERE.cells + run; }
