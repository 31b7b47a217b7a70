/* core/learned_cells.h: the visibility cache, a table of cells (core/learned.h), each with counts for lights. A cell is
 * CELL_WORDS words of memory. Its key has a run of CELL_RUN of them, in one of which it lies, and a light has a set of
 * CELL_WAYS places in it.
 *
 * All counts are whole numbers. What a frame has observed is counted a run at a time, by one thread or invocation, in
 * the order of tiles: so the table is the same for any number of them, and also where old counts are halved or old
 * cells give way. Includers supply cell_load and cell_store. */
#ifndef CORE_LEARNED_CELLS_H
#define CORE_LEARNED_CELLS_H

#include "core/learned.h"

#define NO_CELL 0xffffffffu
#define MOST_ASKED 1024u         /* of one light; what is old counts less and less */
#define MOST_ASKED_ALL 0x100000u /* of all lights of a cell */

FN u1 cell_load(CTX u1 cell, u1 word);
FN void cell_store(CTX u1 cell, u1 word, u1 x);

/* NO_CELL where nothing is known. */
FN1 u1 cell_find(CTX cell_key k, u1 cells) {
    u1 first = cell_run(k, cells);
    u1 found = NO_CELL;
    for (u1 i = 0u; i < CELL_RUN && found == NO_CELL; i++)
        if (cell_load(PASS first + i, CELL_PLACE) == k.place && cell_load(PASS first + i, CELL_CHECK) == k.check)
            found = first + i;
    return found;
}

/* The key's cell, which is used now; where it has none, that of its run which was not used for longest. */
FN1 u1 cell_claim(CTX cell_key k, u1 cells, u1 now) {
    u1 cell = cell_find(PASS k, cells);
    if (cell == NO_CELL) {
        cell = cell_run(k, cells);
        for (u1 i = cell + 1u, end = cell + CELL_RUN; i < end; i++)
            if (cell_load(PASS i, CELL_USED) < cell_load(PASS cell, CELL_USED))
                cell = i;
        for (u1 i = 0u; i < CELL_WORDS; i++)
            cell_store(PASS cell, i, 0u);
        cell_store(PASS cell, CELL_PLACE, k.place);
        cell_store(PASS cell, CELL_CHECK, k.check);
    }
    cell_store(PASS cell, CELL_USED, now);
    return cell;
}

/* The first place of a light's set. */
FN1 u1 cell_set(u1 id) { return shr(id * 0x9e3779b9u, 28) * CELL_WAYS; }

FN1 u1 asked_of(u1 counts) { return counts & 0xffffu; }
FN1 u1 seen_of(u1 counts) { return shr(counts, 16); }

/* The light's place, or CELL_LIGHTS. */
FN1 u1 cell_light(CTX u1 cell, u1 id) {
    u1 first = cell_set(id);
    u1 found = CELL_LIGHTS;
    for (u1 i = first; i < first + CELL_WAYS && found == CELL_LIGHTS; i++)
        if (cell_load(PASS cell, CELL_LIGHT + i) == id && asked_of(cell_load(PASS cell, CELL_COUNTS + i)) != 0u)
            found = i;
    return found;
}

/* Visibility expected of a light, 0 to 1. */
FN1 f1 cell_visibility(CTX u1 cell, u1 id) {
    f1 visibility = LEARNED_UNKNOWN;
    if (cell != NO_CELL) {
        visibility = learned_visibility(F32(cell_load(PASS cell, CELL_ASKED)), F32(cell_load(PASS cell, CELL_SEEN)),
                                        LEARNED_UNKNOWN);
        u1 at = cell_light(PASS cell, id);
        if (at != CELL_LIGHTS) {
            u1 counts = cell_load(PASS cell, CELL_COUNTS + at);
            visibility = learned_visibility(F32(asked_of(counts)), F32(seen_of(counts)), visibility);
        }
    }
    return visibility;
}

/* The place for a light that has none: that of the light that least is known of. */
FN1 u1 cell_give_way(CTX u1 cell, u1 id) {
    u1 at = cell_set(id);
    for (u1 i = at + 1u, end = at + CELL_WAYS; i < end; i++)
        if (asked_of(cell_load(PASS cell, CELL_COUNTS + i)) < asked_of(cell_load(PASS cell, CELL_COUNTS + at)))
            at = i;
    cell_store(PASS cell, CELL_LIGHT + at, id);
    cell_store(PASS cell, CELL_COUNTS + at, 0u);
    return at;
}

/* So many rays from the cell to one light, 1 to 2^15, of which so many arrived, in the counts of all lights. */
FN1 void cell_count_all(CTX u1 cell, u1 asked, u1 seen) {
    u1 age = 0u;
    if (cell_load(PASS cell, CELL_ASKED) > MOST_ASKED_ALL)
        age = 1u;
    cell_store(PASS cell, CELL_ASKED, shr(cell_load(PASS cell, CELL_ASKED), age) + asked);
    cell_store(PASS cell, CELL_SEEN, shr(cell_load(PASS cell, CELL_SEEN), age) + seen);
}

/* In the counts of that light, which are of its set alone. */
FN1 void cell_count_light(CTX u1 cell, u1 id, u1 asked, u1 seen) {
    u1 at = cell_light(PASS cell, id);
    if (at == CELL_LIGHTS)
        at = cell_give_way(PASS cell, id);
    u1 counts = cell_load(PASS cell, CELL_COUNTS + at);
    u1 age = 0u;
    if (asked_of(counts) > MOST_ASKED)
        age = 1u;
    cell_store(PASS cell, CELL_COUNTS + at,
               (shr(asked_of(counts), age) + asked) | shl(shr(seen_of(counts), age) + seen, 16));
}

FN1 void cell_count(CTX u1 cell, u1 id, u1 asked, u1 seen) {
    cell_count_all(PASS cell, asked, seen);
    cell_count_light(PASS cell, id, asked, seen);
}

#endif
