/* Scores of a tile, and what its work group finds out of them together. Shared memory: what lasts, and a pool that the
 * stages of a shader use one after the other. */
shared uint group_[LIST_GROUPS]; /* part, level, block */
shared float patch_[15 * LIST_PATCHES];
shared uint part_[256];
shared uint pool_[POOL_WORDS];

float pool_real(uint at) { return uintBitsToFloat(pool_[at]); }
void pool_store(uint at, float x) { pool_[at] = floatBitsToUint(x); }

list_group group_of(uint word) { return list_group(word >> 31, word >> 27 & 15u, word & 0x7ffffffu); }
uint word_of(list_group g) { return g.part << 31 | g.level << 27 | g.block; }
void list_group_store(uint group, list_group g) { group_[group] = word_of(g); }
list_group list_group_load(uint group) { return group_of(group_[group]); }

void patch_store(uint i, list_patch t) {
    uint at = 15u * i;
    for (uint k = 0u; k < 3u; k++) {
        patch_[at + k] = t.c[k];
        patch_[at + 4u + k] = t.axis[k];
        patch_[at + 10u + k] = t.wo[k];
    }
    patch_[at + 3u] = t.radius;
    patch_[at + 7u] = t.spread;
    patch_[at + 8u] = t.share;
    patch_[at + 9u] = t.reflectance;
    patch_[at + 13u] = t.gloss;
    patch_[at + 14u] = t.alpha2;
}
list_patch patch_load(uint i) {
    uint at = 15u * i;
    return list_patch(vec3(patch_[at], patch_[at + 1u], patch_[at + 2u]), patch_[at + 3u],
                      vec3(patch_[at + 4u], patch_[at + 5u], patch_[at + 6u]), patch_[at + 7u], patch_[at + 8u],
                      patch_[at + 9u], vec3(patch_[at + 10u], patch_[at + 11u], patch_[at + 12u]), patch_[at + 13u],
                      patch_[at + 14u]);
}

/* Groups from LIST_SPARE on are in shared memory. */
float score_at(uint group, uint place) {
    if (group >= LIST_SPARE)
        return pool_real(POOL_SPARE + 16u * (group - LIST_SPARE) + place);
    return tile_real(TILE_SCORES + 16u * group + place);
}
float score_load(uint group, int l) { return score_at(group, uint(l)); }
void score_clear(uint group, uint place) { tile_store(TILE_SCORES + 16u * group + place, 0.0); }

/* ---- the sum of all scores: core/list_groups.h has its shape ---- */

/* Not an array: glslang 12 does not come back from a precise sum of an array's elements. */
float part_at(uint i) { return uintBitsToFloat(part_[16u * i + worker]); }
float quarter_of_parts(uint i) {
    precise float sum = (part_at(i) + part_at(i + 8u)) + (part_at(i + 4u) + part_at(i + 12u));
    return sum;
}

float groups_sum(uint end) {
    for (uint k = worker / 16u; k < 16u; k += WORKERS / 16u)
        part_[16u * k + worker % 16u] = floatBitsToUint(column_sum(k, end, int(worker % 16u)));
    settle();
    if (worker < 16u) {
        precise float sum =
            (quarter_of_parts(0u) + quarter_of_parts(2u)) + (quarter_of_parts(1u) + quarter_of_parts(3u));
        pool_store(POOL_SPARE + worker, sum);
    }
    settle();
    return score_sum(LIST_SPARE);
}
