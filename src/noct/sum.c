/* XXH64 (Yann Collet), from its specification. */
#include "noct/noct.h"

#define P1 0x9e3779b185ebca87u
#define P2 0xc2b2ae3d27d4eb4fu
#define P3 0x165667b19e3779f9u
#define P4 0x85ebca77c2b2ae63u
#define P5 0x27d4eb2f165667c5u

static uint64_t rotate(uint64_t x, int bits) { return x << bits | x >> (64 - bits); }
static uint64_t round_of(uint64_t lane, uint64_t word) { return rotate(lane + word * P2, 31) * P1; }
static uint64_t merge(uint64_t sum, uint64_t lane) { return (sum ^ round_of(0, lane)) * P1 + P4; }

static uint64_t word_at(const uint8_t *p) {
    uint64_t word;
    memcpy(&word, p, sizeof(word));
    return word;
}

/* Whole stripes of 32 bytes. */
static uint64_t stripes(const uint8_t *p, const uint8_t *end) {
    uint64_t a = P1 + P2, b = P2, c = 0, d = -P1;
    for (; p < end; p += 32) {
        a = round_of(a, word_at(p));
        b = round_of(b, word_at(p + 8));
        c = round_of(c, word_at(p + 16));
        d = round_of(d, word_at(p + 24));
    }
    uint64_t sum = rotate(a, 1) + rotate(b, 7) + rotate(c, 12) + rotate(d, 18);
    return merge(merge(merge(merge(sum, a), b), c), d);
}

uint64_t noct_sum(const void *data, size_t size) {
    const uint8_t *p = data;
    size_t whole = size & ~(size_t)31, left = size - whole;
    uint64_t sum = (whole ? stripes(p, p + whole) : P5) + size;
    uint32_t half;
    p += whole;
    for (; left >= 8; left -= 8, p += 8)
        sum = rotate(sum ^ round_of(0, word_at(p)), 27) * P1 + P4;
    if (left >= 4) {
        memcpy(&half, p, sizeof(half));
        sum = rotate(sum ^ half * P1, 23) * P2 + P3;
        left -= 4;
        p += 4;
    }
    for (; left; left--, p++)
        sum = rotate(sum ^ *p * P5, 11) * P1;
    sum = (sum ^ sum >> 33) * P2;
    sum = (sum ^ sum >> 29) * P3;
    return sum ^ sum >> 32;
}
