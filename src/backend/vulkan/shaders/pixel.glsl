/* A work group of a pass over pixels: 64 invocations, four blocks in a row. */
layout(local_size_x = 64) in;

bool in_grid() { return gl_GlobalInvocationID.x < FRAME.blocks_x * BLOCK; }
place my_place() { return place_in_row(gl_GlobalInvocationID.x, HERE.first_row + gl_GlobalInvocationID.y); }
