/* The mutator that libFuzzer calls, and what formats share. */
#include "mutate.h"

#include <math.h>
#include <stdio.h>
#include <zlib.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);

uint32_t mutate_random(uint32_t *state, uint32_t below) {
    *state = *state * 747796405u + 2891336453u; /* PCG's permutation of a linear congruential generator */
    uint32_t x = (*state >> (*state >> 28 & 15) % 4 ^ *state) * 277803737u;
    x ^= x >> 22;
    return below ? x % below : 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed) {
    uint32_t random = seed * 2654435769u + 1;
    fuzz_bytes out = { 0 };
    mutate_any((fuzz_part){ data, size }, most, &random, &out);
    if (out.len > most) { /* too long: the bytes as they are may still be mutated */
        out.len = 0;
        mutate_raw((fuzz_part){ data, size }, most, &random, &out);
    }
    size = NOC_MIN(out.len, most);
    if (size)
        memcpy(data, out.data, size);
    array_free(&out);
    return size;
}

/* Some bytes again and again: for buffers that end somewhere. */
static void stretch(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    size_t at = mutate_random(random, (uint32_t)in.size), n = 1 + mutate_random(random, 8);
    n = NOC_MIN(n, in.size - at);
    FUZZ_REQUIRE(array_append(out, in.data, at));
    for (size_t end = out->len + NOC_MIN(most, (size_t)8 << mutate_random(random, 8)); out->len < end;)
        FUZZ_REQUIRE(array_append(out, in.data + at, n));
    FUZZ_REQUIRE(array_append(out, in.data + at, in.size - at));
}

void mutate_raw(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    if (in.size && most > in.size + 16 && !mutate_random(random, 16)) {
        stretch(in, most - in.size, random, out);
        return;
    }
    size_t room = NOC_MAX(in.size, NOC_MIN(most, in.size + in.size / 4 + 64)), at = out->len;
    FUZZ_REQUIRE(array_reserve(out, at + room + 1));
    if (in.size)
        memcpy(out->data + at, in.data, in.size);
    out->len += LLVMFuzzerMutate(out->data + at, in.size, room);
}

void mutate_any(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    static const mutate_fn formats[] = { mutate_parts, mutate_wire, mutate_gzip, mutate_zip, mutate_png,
                                         mutate_glb,   mutate_pbf,  mutate_json, mutate_xml, mutate_lines };
    size_t at = out->len;
    bool raw = !mutate_random(random, 8);
    for (size_t i = 0; !raw && i < NOC_COUNT(formats); i++) {
        if (formats[i](in, most, random, out))
            return;
        out->len = at;
    }
    mutate_raw(in, most, random, out);
}

void mutate_number(const char *text, size_t size, uint32_t *random, char out[64]) {
    static const char *const odd[] = { "0",
                                       "-0",
                                       "-1",
                                       "1",
                                       "2",
                                       "1e308",
                                       "-1e308",
                                       "1e-320",
                                       "nan",
                                       "inf",
                                       "4294967295",
                                       "4294967296",
                                       "2147483647",
                                       "-2147483648",
                                       "9223372036854775807",
                                       "18446744073709551616",
                                       "1e999",
                                       "0.1",
                                       "65535",
                                       "256",
                                       "1000000",
                                       "1e15",
                                       "0x10",
                                       "" };
    double value = 0;
    const char *end = text + size;
    noc_scan_double(text, end, &value);
    switch (mutate_random(random, 7)) {
    case 6:
        snprintf(out, 64, "%0*.*f", 1 + (int)mutate_random(random, 60), (int)mutate_random(random, 3),
                 fmod(value, 1000));
        break;
    case 0: snprintf(out, 64, "%s", odd[mutate_random(random, NOC_COUNT(odd))]); break;
    case 1: snprintf(out, 64, "%.17g", -value); break;
    case 2:
        snprintf(out, 64, "%.17g", value + (mutate_random(random, 2) ? 1 : -1) * (1 << mutate_random(random, 6)));
        break;
    case 3: snprintf(out, 64, "%.9g", value * pow(10, (double)mutate_random(random, 9) - 4)); break;
    case 4: snprintf(out, 64, "%u", mutate_random(random, 100)); break;
    default: snprintf(out, 64, "%.9g", value + ((double)mutate_random(random, 2001) - 1000) / 1000); break;
    }
}

void mutate_put(fuzz_bytes *out, uint64_t value, int bytes, bool big_endian) {
    for (int i = 0; i < bytes; i++) {
        int byte = big_endian ? bytes - 1 - i : i;
        FUZZ_REQUIRE(array_push(out, byte < 8 ? (uint8_t)(value >> 8 * byte) : 0));
    }
}

bool mutate_inflate(fuzz_part in, int window_bits, fuzz_bytes *out) {
    enum { MOST = 1 << 20 };
    z_stream z = { .next_in = (Bytef *)in.data, .avail_in = (uInt)in.size };
    if (inflateInit2(&z, window_bits) != Z_OK)
        return false;
    int status = Z_OK;
    for (size_t start = out->len; status == Z_OK && out->len - start < MOST;) {
        FUZZ_REQUIRE(array_reserve(out, out->len + 4096));
        z.next_out = out->data + out->len;
        z.avail_out = 4096;
        status = inflate(&z, Z_NO_FLUSH);
        out->len += 4096 - z.avail_out;
    }
    inflateEnd(&z);
    return status == Z_STREAM_END;
}

void mutate_deflate(fuzz_part in, int window_bits, fuzz_bytes *out) {
    z_stream z = { .next_in = (Bytef *)in.data, .avail_in = (uInt)in.size };
    if (deflateInit2(&z, 1, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return;
    size_t room = deflateBound(&z, (uLong)in.size) + 64;
    FUZZ_REQUIRE(array_reserve(out, out->len + room));
    z.next_out = out->data + out->len;
    z.avail_out = (uInt)room;
    deflate(&z, Z_FINISH);
    out->len += z.total_out;
    deflateEnd(&z);
}

/* ---- several files in one input ---- */

bool mutate_parts(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    fuzz_part part[FUZZ_PARTS];
    if (in.size < FUZZ_MAGIC || memcmp(in.data, FUZZ_WORD, FUZZ_MAGIC))
        return false;
    int n = fuzz_parts(in.data, in.size, part);
    uint32_t chosen = mutate_random(random, (uint32_t)n), what = mutate_random(random, 24);
    FUZZ_REQUIRE(array_append(out, (const uint8_t *)FUZZ_WORD, FUZZ_MAGIC));
    for (uint32_t i = 0; i < (uint32_t)n; i++) {
        fuzz_bytes now = { 0 };
        if (i == chosen && what == 0 && n > 1) /* left out */
            continue;
        if (i == chosen && what > 1)
            mutate_any(part[i], most - NOC_MIN(most, in.size - part[i].size), random, &now);
        else
            FUZZ_REQUIRE(array_append(&now, part[i].data, part[i].size));
        for (int k = 0; k < (i == chosen && what == 1 && n < FUZZ_PARTS ? 2 : 1); k++) { /* twice */
            mutate_put(out, now.len, 4, false);
            FUZZ_REQUIRE(array_append(out, now.data, now.len));
        }
        array_free(&now);
    }
    return true;
}

/* ---- lines of text ---- */

static bool is_text(fuzz_part in) {
    for (size_t i = 0; i < in.size; i++)
        if (in.data[i] < 32 && !strchr("\t\r\n", in.data[i] ? in.data[i] : 1))
            return false;
    return in.size > 0;
}

/* One number of the text, another. */
static bool change_number(fuzz_part in, uint32_t *random, fuzz_bytes *out) {
    size_t from = mutate_random(random, (uint32_t)in.size), to;
    while (from < in.size && !(in.data[from] >= '0' && in.data[from] <= '9'))
        from++;
    while (from && from < in.size && strchr("0123456789.-", in.data[from - 1]))
        from--;
    for (to = from; to < in.size && in.data[to] && strchr("0123456789.-eE", in.data[to]);)
        to++;
    if (from >= in.size)
        return false;
    char number[64];
    mutate_number((const char *)in.data + from, to - from, random, number);
    FUZZ_REQUIRE(array_append(out, in.data, from));
    FUZZ_REQUIRE(array_append(out, (uint8_t *)number, strlen(number)));
    FUZZ_REQUIRE(array_append(out, in.data + to, in.size - to));
    return true;
}

/* The line that a random place is in. */
static fuzz_part some_line(fuzz_part in, uint32_t *random) {
    size_t from = mutate_random(random, (uint32_t)in.size), to = from;
    while (from && in.data[from - 1] != '\n')
        from--;
    while (to < in.size && in.data[to++] != '\n')
        ;
    return (fuzz_part){ in.data + from, to - from };
}

bool mutate_lines(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    if (!is_text(in))
        return false;
    uint32_t what = mutate_random(random, 8);
    if (what < 3 && change_number(in, random, out))
        return true;
    fuzz_part line = some_line(in, random), other = some_line(in, random);
    size_t before = (size_t)(line.data - in.data), after = before + line.size;
    if (what < 5) { /* within a line, or a part of one made long */
        if (mutate_random(random, 6))
            return false;
        stretch(in, most, random, out);
        return true;
    }
    FUZZ_REQUIRE(array_append(out, in.data, before));
    if (what == 5) /* another line in its place, or before it */
        FUZZ_REQUIRE(array_append(out, other.data, other.size));
    uint32_t times = what == 6 ? 1 + mutate_random(random, 4) : what == 5 ? mutate_random(random, 2) : 0;
    for (; times > 0 && out->len < most; times--)
        FUZZ_REQUIRE(array_append(out, line.data, line.size));
    FUZZ_REQUIRE(array_append(out, in.data + after, in.size - after));
    return true;
}
