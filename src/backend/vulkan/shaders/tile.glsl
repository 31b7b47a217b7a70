/* The tile at hand, which a work group has for itself: its blocks, and its memory in scratch. After list_group.glsl and
 * the bridge. */
layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint WORKERS = 256u;

/* What invocations have stored before in shared memory is loaded after it. */
void settle() {
    memoryBarrierShared();
    barrier();
}

shared uint first_;
uint from_first(uint x) {
    if (FIRST_WORKER)
        first_ = x;
    settle();
    return first_;
}

uint tile_ = gl_WorkGroupID.y * HERE.tiles_x + gl_WorkGroupID.x; /* of the band */
uint tile_number_ = tile_ + HERE.first_row / 4u * HERE.tiles_x;  /* of the picture */
uint tile_wide_ = minu1(4u, FRAME.blocks_x - 4u * gl_WorkGroupID.x);
uint tile_blocks_ = tile_wide_ * minu1(4u, HERE.blocks_y - HERE.first_row - 4u * gl_WorkGroupID.y);

/* The picture's number of a block of the tile. */
uint block_of_tile(uint i) {
    uint row = HERE.first_row + 4u * gl_WorkGroupID.y + i / tile_wide_;
    return row * FRAME.blocks_x + 4u * gl_WorkGroupID.x + i % tile_wide_;
}

uint tile_load(uint at) { return HERE.scratch.at[tile_ * HERE.tile_words + at]; }
float tile_real(uint at) { return uintBitsToFloat(tile_load(at)); }
void tile_store(uint at, uint x) { HERE.scratch.at[tile_ * HERE.tile_words + at] = x; }
void tile_store(uint at, float x) { tile_store(at, floatBitsToUint(x)); }
