/* What reading one input may cost: files are written by strangers, and a few kilobytes can ask for gigabytes. */
#include "import/import.h"

#include <math.h>
#include <unistd.h>

#define FREE_BYTES 16e6             /* that a reader may take without a word */
#define FREE_EXPANSION 1073741824.0 /* bytes that any file may grow to: one lamp may be placed ten thousand times */
#define FREE_POINTS 10e6            /* that instances of any file may place: 3 s of processor time */

static double most_expanded(const import_budget *b) {
    return b->expansion > 0 ? NOC_MAX(b->expansion * b->stored, FREE_EXPANSION) : INFINITY;
}

bool import_fits(const import_budget *b, double bytes) {
    bool fits = bytes <= b->memory && bytes <= most_expanded(b);
    if (fits && b->claim && bytes > FREE_BYTES)
        b->claim(b->claimant, bytes);
    return fits;
}

noc_status import_affords(const import_budget *b, double bytes, const char *name, const char *what, noc_log *log) {
    if (bytes > b->memory)
        return noc_error(log, NOC_ERR_MEMORY, "%s: %s would take %.3g GB; the limit --max-memory is %.3g GB", name,
                         what, bytes / 1e9, b->memory / 1e9);
    if (bytes > most_expanded(b))
        return noc_error(log, NOC_ERR_MEMORY,
                         "%s: %s would take %.3g GB, of a file of %.3g MB; the limit --max-expansion is "
                         "%g times",
                         name, what, bytes / 1e9, b->stored / 1e6, b->expansion);
    return NOC_OK;
}

noc_status import_affords_instances(const import_budget *b, double points, const char *name, noc_log *log) {
    if (!(b->instances > 0) || points <= NOC_MAX(b->instances * b->stored, FREE_POINTS))
        return NOC_OK;
    return noc_error(log, NOC_ERR_MEMORY,
                     "%s: instances of its templates would place over %.3g million points, of a file of %.3g MB; the "
                     "limit --max-instances is %g a byte",
                     name, floor(points / 1e6), b->stored / 1e6, b->instances);
}

import_budget import_budget_of(const noc_import_params *params) {
    double memory = 1e9 * params->max_memory;
    if (!(memory > 0)) {
        long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
        memory = pages > 0 && size > 0 ? 0.75 * (double)pages * (double)size : 8e9;
    }
    return (import_budget){ .memory = memory, .expansion = params->max_expansion, .instances = params->max_instances };
}

/* Bytes that jansson 2.14 takes for each, by the sizes of its structures. Signs within texts are counted too. */
double import_json_cost(const char *text, size_t size) {
    enum { ARRAY = 144, OBJECT = 256, MEMBER = 96, ITEM = 48, STRING_END = 32 };
    size_t cost = size;
    for (const char *p = text, *end = text + size; p < end; p++)
        switch (*p) {
        case '[': cost += ARRAY + ITEM; break;
        case '{': cost += OBJECT + ITEM; break;
        case ':': cost += MEMBER; break;
        case ',': cost += ITEM; break;
        case '"': cost += STRING_END; break;
        default: break;
        }
    return (double)cost;
}
