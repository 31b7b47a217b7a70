#version 460
/* A tile's list as its pixels read it: copies of lights where there is room, lights in brief, and what the visibility
 * cache expects of them in each cell that the tile's blocks lie in. 3 barriers. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "list_tile.glsl"
#include "core/learned.h"
#include "list_seen.glsl"

uint cell_load(uint cell, uint word) { return HERE.learned.at[CACHE_HEAD + CELL_WORDS * cell + word]; }
void cell_store(uint cell, uint word, uint x) {} /* nothing is learned here */
#include "core/learned_cells.h"

#define NO_BLOCK 0xffffffffu

shared uint key_[2 * TILE_CELLS];
shared uint alike_[TILE_CELLS]; /* of each block: the first one in its cell; NO_BLOCK: it sees no surface */
shared uint known_[TILE_CELLS]; /* of each cell */
shared uint row_[TILE_CELLS];

uint copies_;

uint entry_in(uint at, uint rows) { return at % 16u * rows + at / 16u; }
uint entry_lights(uint row, int l, uint rows, uint count) {
    return entry_load(minu1(entry_in(16u * row + uint(l), rows), count - 1u) / copies_).light;
}
void sketch_put(uint at, uint field, float x) { tile_store(TILE_SKETCHES + field * LIST_ROOM + at, x); }
void sketch_store(uint row, int l, list_sketch k) {
    uint at = 16u * row + uint(l);
    for (uint c = 0u; c < 3u; c++) {
        sketch_put(at, c, k.middle[c]);
        sketch_put(at, 4u + c, k.normal[c]);
        sketch_put(at, 8u + c, k.shine[c]);
        sketch_put(at, 12u + c, k.beside[c]);
    }
    sketch_put(at, 3u, k.radius);
    sketch_put(at, 7u, k.size);
    sketch_put(at, 11u, uintBitsToFloat(k.shape));
    sketch_put(at, 15u, k.level);
}

bool learns() { return (HERE.list_flags & LIST_LEARNS) != 0u; }

/* ---- cells ---- */

cell_key key_of_block(uint i) {
    uint block = block_of_tile(i), lanes = 0u;
    for (uint l = 0u; l < 16u; l++)
        lanes |= (HERE.surfaces.at[block].material[l] != NO_SURFACE ? 1u : 0u) << l;
    if (lanes == 0u)
        return cell_key(NO_BLOCK, 0u);
    receiver r = receiver_at(HERE.surfaces, block, cell_lane(lanes));
    return learns() ? cell_key_at(FRAME.camera, r.p, r.n, r.depth) : cell_key(0u, 1u);
}

void find_blocks() {
    EACH_INDEX(i, uint(TILE_CELLS)) {
        cell_key k = cell_key(NO_BLOCK, 0u);
        if (i < tile_blocks_)
            k = key_of_block(i);
        key_[2u * i] = k.place;
        key_[2u * i + 1u] = k.check;
    }
    settle();
    EACH_INDEX(i, uint(TILE_CELLS)) {
        uint first = NO_BLOCK;
        for (uint k = TILE_CELLS; k-- > 0u;)
            if (key_[2u * i + 1u] != 0u && key_[2u * k] == key_[2u * i] && key_[2u * k + 1u] == key_[2u * i + 1u])
                first = k;
        alike_[i] = first;
    }
    settle();
}

/* Number of the cell whose first block is i. */
uint cell_number_of(uint i) {
    uint n = 0u;
    for (uint k = 0u; k < i; k++)
        n += alike_[k] == k ? 1u : 0u;
    return n;
}

/* A row of observations for each cell. A frame that has too many of them learns from those it has room for. */
void take_row(uint cell, uint block) {
    uint row = atomicAdd(HERE.observed.at[SEEN_ROWS], 1u);
    if (row >= HERE.observed_rows) {
        count_one(VK_COUNT_UNLEARNED, cell);
        row = NO_BLOCK;
    } else {
        HERE.observed.at[row_word(row) + ROW_ITEM] = tile_number_ * TILE_CELLS + cell;
        HERE.observed.at[row_word(row) + ROW_KEY] = key_[2u * block];
        HERE.observed.at[row_word(row) + ROW_KEY + 1u] = key_[2u * block + 1u];
    }
    row_[cell] = row;
    tile_store(TILE_ROW + cell, row);
}

void find_cells() {
    EACH_INDEX(i, uint(TILE_CELLS)) {
        if (alike_[i] != NO_BLOCK)
            tile_store(TILE_CELL + i, cell_number_of(alike_[i]));
        if (alike_[i] == i) {
            uint cell = cell_number_of(i);
            known_[cell] = NO_CELL;
            if (learns()) {
                known_[cell] = cell_find(cell_key(key_[2u * i], key_[2u * i + 1u]), HERE.cells);
                take_row(cell, i);
            }
        }
    }
    settle();
}

void expect(uint cells, uint count) {
    uint rows = list_rows(count);
    for (uint c = 0u; c < cells; c++) {
        EACH_INDEX(at, 16u * rows) {
            uint i = entry_in(at, rows);
            list_prior b = list_prior(0.0, 0.0);
            if (i < count) {
                list_entry e = entry_copy(entry_load(i / copies_), copies_);
                b = list_prior_of(e.weight, cell_visibility(known_[c], e.light));
            }
            tile_store(TILE_PRIORS + 2u * LIST_ROOM * c + at, b.share);
            tile_store(TILE_PRIORS + 2u * LIST_ROOM * c + LIST_ROOM + at, b.expect);
        }
        if (learns() && row_[c] != NO_BLOCK)
            EACH_INDEX(i, count) HERE.observed.at[row_word(row_[c]) + ROW_COUNTS + i] = 0u;
    }
}

void main() {
    uint once = tile_load(TILE_ENTRIES);
    copies_ = list_copies(once, FRAME.list + FRAME.tail, FRAME.shadow_rays, FRAME.draws);
    uint count = once * copies_;
    if (FIRST_WORKER)
        tile_store(TILE_COUNT, count);
    if (learns() && FIRST_WORKER)
        HERE.observed.at[lights_word(tile_number_)] = count;
    if (count == 0u)
        return;
    EACH_INDEX(i, count) {
        list_entry e = entry_copy(entry_load(i / copies_), copies_);
        tile_store(TILE_LIGHT + i, e.light);
        tile_store(TILE_WEIGHT + i, e.weight);
        if (learns())
            HERE.observed.at[lights_word(tile_number_) + 1u + i] = e.light;
    }
    list_sketches(count);
    find_blocks();
    find_cells();
    expect(cell_number_of(TILE_CELLS), count);
}
