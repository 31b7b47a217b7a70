/* Records between the library and its helper (import/remote/remote.h): heads stay those of what follows them. */
#include "mutate.h"

#include "import/remote/remote.h"

#include <math.h>

enum { RECORDS = 64 };
typedef struct wire_record {
    uint32_t kind;
    fuzz_part content;
} wire_record;

static bool is_kind(uint32_t kind) {
    return (kind >= REMOTE_READER && kind <= REMOTE_GO) || (kind >= REMOTE_LOG && kind <= REMOTE_END);
}

/* The records at the input's beginning; what follows them is left at *rest. */
static uint32_t split(fuzz_part in, wire_record *records, fuzz_part *rest) {
    uint32_t n = 0;
    remote_head head;
    while (n < RECORDS && in.size >= sizeof(head)) {
        memcpy(&head, in.data, sizeof(head));
        if (!is_kind(head.kind) || head.size_high || head.size_low > in.size - sizeof(head))
            break;
        records[n++] = (wire_record){ head.kind, { in.data + sizeof(head), head.size_low } };
        in.data += sizeof(head) + head.size_low;
        in.size -= sizeof(head) + head.size_low;
    }
    *rest = in;
    return n;
}

static void put_record(fuzz_bytes *out, uint32_t kind, uint64_t size, fuzz_part content) {
    mutate_put(out, kind, 4, false);
    mutate_put(out, size >> 32, 4, false);
    mutate_put(out, size & UINT32_MAX, 4, false);
    FUZZ_REQUIRE(array_append(out, content.data, content.size));
}

/* One number of a struct or an array, another. */
static void change_number(fuzz_part in, uint32_t *random, fuzz_bytes *out) {
    static const double odd[] = { 0, -1, 1, 1e308, -1e15, NAN, INFINITY, 1e-320, 180, 90.5 };
    static const uint64_t whole[] = { 0, 1, 2, 255, 1u << 31, UINT32_MAX, (uint64_t)1 << 60, UINT64_MAX };
    size_t item = mutate_random(random, 3) ? 8 : 4, at = out->len;
    FUZZ_REQUIRE(array_append(out, in.data, in.size));
    if (in.size < item)
        return;
    uint8_t *to = out->data + at + item * mutate_random(random, (uint32_t)(in.size / item));
    if (mutate_random(random, 2))
        memcpy(to, &whole[mutate_random(random, NOC_COUNT(whole))], item);
    else
        memcpy(to, &odd[mutate_random(random, NOC_COUNT(odd))], item); /* of a float: what its bits are */
}

static void change_content(wire_record r, size_t most, uint32_t *random, fuzz_bytes *out) {
    fuzz_bytes now = { 0 };
    if (mutate_random(random, 2))
        mutate_raw(r.content, most, random, &now);
    else
        change_number(r.content, random, &now);
    put_record(out, r.kind, now.len, (fuzz_part){ now.data, now.len });
    array_free(&now);
}

bool mutate_wire(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    static const uint64_t lies[] = { 0, 1, UINT32_MAX, (uint64_t)1 << 32, UINT64_MAX };
    wire_record records[RECORDS];
    fuzz_part rest;
    uint32_t n = split(in, records, &rest);
    if (!n)
        return false;
    uint32_t chosen = mutate_random(random, n), what = mutate_random(random, 10);
    for (uint32_t i = 0; i < n; i++) {
        wire_record r = records[i];
        if (i != chosen)
            put_record(out, r.kind, r.content.size, r.content);
        else if (what == 0) /* another kind */
            put_record(out, REMOTE_LOG + mutate_random(random, REMOTE_END - REMOTE_LOG + 1), r.content.size, r.content);
        else if (what == 1) /* again */
            for (int k = 0; k < 2; k++)
                put_record(out, r.kind, r.content.size, r.content);
        else if (what == 2) /* another in its place; or none, where it is that itself */
            for (uint32_t other = mutate_random(random, n), k = 0; other != i && k < 1; k++)
                put_record(out, records[other].kind, records[other].content.size, records[other].content);
        else if (what == 3) /* of a size that it has not */
            put_record(out, r.kind,
                       mutate_random(random, 2) ? r.content.size + mutate_random(random, 9) - 4
                                                : lies[mutate_random(random, NOC_COUNT(lies))],
                       r.content);
        else
            change_content(r, most - NOC_MIN(most, in.size), random, out);
    }
    FUZZ_REQUIRE(array_append(out, rest.data, rest.size));
    return true;
}
