/* The dialect kernel as C with CORE_LANES values a variable, or scalar: one object for each instruction set. */
#include <string.h>

#include "core/dialect.h"
#include "dialect_slots.h"

struct core_context {
    uint32_t *out; /* slot-major: slot * items + item */
    uint32_t items, first;
    uint32_t *words; /* of a tile */
};

FN void put_u32(CTX u32 item, int slot, u32 x) {
    (void)item;
    memcpy(ctx->out + (size_t)slot * ctx->items + ctx->first, &x, sizeof(x));
}

FN void put_real(CTX u32 item, int slot, real x) {
    (void)item;
    memcpy(ctx->out + (size_t)slot * ctx->items + ctx->first, &x, sizeof(x));
}

FN void put_u1(CTX u1 item, int slot, u1 x) { ctx->out[(size_t)slot * ctx->items + item] = x; }
FN u1 word_load(CTX u1 i) { return ctx->words[i]; }
FN void word_store(CTX u1 i, u1 x) { ctx->words[i] = x; }
FN u32 words_load(CTX u1 first) {
    u32 x;
    memcpy(&x, ctx->words + first, sizeof(x));
    return x;
}
FN void words_store(CTX u1 first, u32 x) { memcpy(ctx->words + first, &x, sizeof(x)); }
FN const float *words_row(CTX u1 first) { return (const float *)(const void *)(ctx->words + first); }
FN u32 lane_places(u1 first) {
    uint32_t n[LANES];
    u32 r;
    for (uint32_t i = 0; i < LANES; i++)
        n[i] = first + i;
    memcpy(&r, n, sizeof(r));
    return r;
}

#define ITEM_COUNT ctx->items
#include "dialect_kernel.h"

#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)

/* items must be a multiple of the lanes. */
void JOIN(dialect_run_, LANES)(uint32_t *out, uint32_t items);
void JOIN(dialect_run_, LANES)(uint32_t *out, uint32_t items) {
    uint32_t lane[LANES], words[TILE_WORDS];
    for (uint32_t first = 0; first < items; first += LANES) {
        struct core_context ctx = { out, items, first, words };
        for (uint32_t i = 0; i < LANES; i++)
            lane[i] = first + i;
        u32 item;
        memcpy(&item, lane, sizeof(item));
        dialect_item(&ctx, item);
        for (uint32_t i = 0; i < LANES; i++) {
            dialect_tile(&ctx, first + i);
            dialect_tile_lists(&ctx, first + i);
        }
    }
}
