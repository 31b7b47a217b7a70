/* Lamps that lie far from all others, where no city tells where lamps are: a slip in a coordinate, or a CRS that is
 * another. Groups are what lamps less than 20 km apart make, step by step. They are told by cells, each with the box of
 * its lamps, so that a million lamps of a land cost no more than their cells. */
#include "import/load/load.h"

#include <math.h>

#define APART 20e3 /* m between groups, as between meshes and the rest */
#define EDGE 5e3   /* m, of a cell */
#define REACH 5    /* cells in which others less than APART away lie */
#define FEW 3      /* lamps of a group that is left out beside one of twice as many, */
#define RARE 100   /* or of this times as many */

typedef struct place {
    double xy[2];
    const given_place *given;
    input *in;
    uint32_t cell;
} place;

typedef struct cell {
    int64_t at[2];
    double lo[2], hi[2];
    size_t count;
    uint32_t next;  /* of its hash, + 1 */
    uint32_t group; /* a cell of the same group, at last the group's first */
} cell;

typedef struct strays {
    NOC_ARRAY(place) places;
    NOC_ARRAY(cell) cells;
    uint32_t *first; /* chains of cells: index + 1 */
    size_t size;     /* of first: a power of two */
} strays;

static uint32_t *chain_of(const strays *s, const int64_t at[2]) {
    uint64_t h = (uint64_t)at[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)at[1] * 0xc2b2ae3d27d4eb4fu;
    return &s->first[(h ^ h >> 32) & (s->size - 1)];
}

/* NULL: nothing lies there. */
static cell *find_cell(const strays *s, const int64_t at[2]) {
    for (uint32_t i = *chain_of(s, at); i; i = s->cells.data[i - 1].next)
        if (s->cells.data[i - 1].at[0] == at[0] && s->cells.data[i - 1].at[1] == at[1])
            return &s->cells.data[i - 1];
    return NULL;
}

/* False: memory was refused. */
static bool put_place(strays *s, place *p) {
    const int64_t at[2] = { (int64_t)floor(p->xy[0] / EDGE), (int64_t)floor(p->xy[1] / EDGE) };
    cell *c = find_cell(s, at);
    if (!c) {
        uint32_t *chain = chain_of(s, at), number = (uint32_t)s->cells.len;
        if (!array_push(&s->cells, (cell){ .at = { at[0], at[1] }, .next = *chain, .group = number }))
            return false;
        *chain = number + 1;
        c = &s->cells.data[number];
    }
    for (int k = 0; k < 2; k++) {
        c->lo[k] = c->count ? NOC_MIN(c->lo[k], p->xy[k]) : p->xy[k];
        c->hi[k] = c->count ? NOC_MAX(c->hi[k], p->xy[k]) : p->xy[k];
    }
    c->count++;
    p->cell = (uint32_t)(c - s->cells.data);
    return true;
}

/* ---- groups ---- */

static double gap(const cell *a, const cell *b) {
    double d[2];
    for (int k = 0; k < 2; k++)
        d[k] = NOC_MAX(0, NOC_MAX(a->lo[k] - b->hi[k], b->lo[k] - a->hi[k]));
    return hypot(d[0], d[1]);
}

static uint32_t group_of(strays *s, uint32_t i) {
    while (s->cells.data[i].group != i) {
        s->cells.data[i].group = s->cells.data[s->cells.data[i].group].group;
        i = s->cells.data[i].group;
    }
    return i;
}

static void join(strays *s, uint32_t i) {
    for (int64_t n = 0; n < (2 * REACH + 1) * (2 * REACH + 1); n++) {
        const cell *c = &s->cells.data[i];
        const int64_t at[2] = { c->at[0] + n % (2 * REACH + 1) - REACH, c->at[1] + n / (2 * REACH + 1) - REACH };
        const cell *other = find_cell(s, at);
        if (!other || gap(c, other) > APART)
            continue;
        uint32_t a = group_of(s, i), b = group_of(s, (uint32_t)(other - s->cells.data));
        s->cells.data[NOC_MAX(a, b)].group = NOC_MIN(a, b);
    }
}

/* Counts of groups go to their first cells. Returns the largest, the earlier one of equals. */
static uint32_t find_groups(strays *s) {
    uint32_t most = 0;
    for (uint32_t i = 0; i < s->cells.len; i++)
        join(s, i);
    for (uint32_t i = 0; i < s->cells.len; i++) {
        uint32_t group = group_of(s, i);
        if (group != i)
            s->cells.data[group].count += s->cells.data[i].count;
    }
    for (uint32_t i = 0; i < s->cells.len; i++)
        if (group_of(s, i) == i && s->cells.data[i].count > s->cells.data[most].count)
            most = i;
    return most;
}

static bool is_stray(size_t count, size_t most) { return 2 * count <= most && (count <= FEW || RARE * count <= most); }

/* m from a place to the cells of a group */
static double distance(strays *s, const place *p, uint32_t group) {
    cell at = { .lo = { p->xy[0], p->xy[1] }, .hi = { p->xy[0], p->xy[1] } };
    double nearest = INFINITY;
    for (uint32_t i = 0; i < s->cells.len; i++)
        if (group_of(s, i) == group)
            nearest = NOC_MIN(nearest, gap(&at, &s->cells.data[i]));
    return nearest;
}

/* ---- what becomes of them ---- */

/* Would it lie among the others with its two coordinates exchanged? */
static bool seems_exchanged(importer *im, strays *s, const place *p, uint32_t most) {
    place other = { .in = p->in };
    return p->given && place_exchanged(im, p->given, other.xy) && distance(s, &other, most) <= APART;
}

/* Returns whether it is left out. The first is measured for the message. */
static bool judge(importer *im, strays *s, const place *p, uint32_t most, double *farthest) {
    uint32_t group = group_of(s, p->cell);
    if (group == most)
        return false;
    char at[80] = "";
    if (p->given)
        noc_snprintf(at, sizeof(at), "at %.10g %.10g", p->given->xy[0], p->given->xy[1]);
    bool stray = is_stray(s->cells.data[group].count, s->cells.data[most].count);
    if (stray)
        geo_issue(p->in->issues, GEO_SKIPPED,
                  seems_exchanged(im, s, p, most)
                      ? "lamp more than 20 km from all others: its coordinates seem exchanged"
                      : "lamp more than 20 km from all others",
                  at);
    else
        geo_issue(p->in->issues, GEO_GUESSED, "lamp of a group more than 20 km from most of them", at);
    *farthest = *farthest > 0 ? *farthest : distance(s, p, most);
    return stray;
}

static void warn(const importer *im, size_t left, size_t apart, size_t all, double metres) {
    size_t count = left ? left : apart;
    if (count)
        noc_warn(im->log, "%zu of %zu lamps %s more than 20 km from %s others, the first by %.0f km%s", count, all,
                 count == 1 ? "is" : "are", left ? "all" : "the", metres / 1000,
                 left ? ", and left out: are the coordinates right?" : ": are they in another CRS than it seems?");
}

/* Lamps that are left out go from im->lamps. */
static void judge_all(importer *im, strays *s) {
    uint32_t most = find_groups(s);
    size_t kept = 0, left = 0, apart = 0;
    double metres = 0;
    for (size_t i = 0; i < s->places.len; i++) {
        const place *p = &s->places.data[i];
        bool stray = judge(im, s, p, most, &metres);
        left += stray;
        apart += !stray && group_of(s, p->cell) != most;
        p->in->lamps_lost += stray;
        if (!im->inspect && !stray)
            im->lamps.data[kept++] = im->lamps.data[i];
    }
    if (!im->inspect)
        im->lamps.len = kept;
    im->lamps_stray = left;
    warn(im, left, apart, s->places.len, metres);
}

/* False: memory was refused. */
static bool list_places(importer *im, strays *s) {
    for (size_t i = 0; i < im->lamps.len && !im->inspect; i++) {
        const pending_lamp *l = &im->lamps.data[i];
        if (!array_push(&s->places, (place){ { l->lamp.xyz[0], l->lamp.xyz[1] }, &l->given, &im->inputs[l->input], 0 }))
            return false;
    }
    for (size_t i = 0; i < im->input_count && im->inspect; i++)
        for (size_t k = 0; k < im->inputs[i].lamps_seen.len; k++) {
            const seen_lamp *l = &im->inputs[i].lamps_seen.data[k];
            if (!array_push(&s->places, (place){ { l->xy[0], l->xy[1] }, &l->given, &im->inputs[i], 0 }))
                return false;
        }
    for (s->size = 64; s->size < 2 * s->places.len;)
        s->size *= 2;
    return (s->first = noc_calloc(s->size, sizeof(*s->first))) != NULL;
}

noc_status strays_drop(importer *im) {
    strays s = { .size = 0 };
    bool ok = list_places(im, &s);
    for (size_t i = 0; i < s.places.len && ok; i++)
        ok = put_place(&s, &s.places.data[i]);
    if (ok && s.cells.len > 1)
        judge_all(im, &s);
    array_free(&s.places);
    array_free(&s.cells);
    free(s.first);
    return ok ? NOC_OK : noc_no_memory(im->log, "import");
}
