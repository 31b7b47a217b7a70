/* Mutations that know formats: what is changed lies inside the checksums, lengths, compression and syntax around it,
 * which are made anew. One mutation in eight is libFuzzer's own, on the bytes as they are. */
#ifndef NOC_FUZZ_MUTATE_H
#define NOC_FUZZ_MUTATE_H

#include "fuzz.h"

typedef struct fuzz_bytes {
    uint8_t *data;
    size_t len, cap;
} fuzz_bytes;

/* Random numbers, one stream a mutation. */
uint32_t mutate_random(uint32_t *state, uint32_t below); /* 0 where below is 0 */

/* Appends a mutation of the bytes to out, whatever they are. most: its length, about. */
void mutate_any(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
/* libFuzzer's own, with the dictionary. */
void mutate_raw(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
/* Another number for the one that text spells. */
void mutate_number(const char *text, size_t size, uint32_t *random, char out[64]);

/* A format: false, with out as it was, where the bytes are not of it after all. */
typedef bool (*mutate_fn)(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_parts(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_wire(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_gzip(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_zip(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_png(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_glb(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_pbf(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_json(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_xml(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);
bool mutate_lines(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out);

/* zlib, of at most 1 MB. */
bool mutate_inflate(fuzz_part in, int window_bits, fuzz_bytes *out);
void mutate_deflate(fuzz_part in, int window_bits, fuzz_bytes *out);
void mutate_put(fuzz_bytes *out, uint64_t value, int bytes, bool big_endian);

#endif
