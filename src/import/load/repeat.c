/* The same thing named twice gives its light once: files, objects of overlapping tiles, lamps. docs/formats.md states
 * the rules.
 *
 * Of an object only a record stays: hashes of its id and of its corners, and its extent. It is made when the object
 * ends, or, of those too large to be held, when its first part is handed on; equal objects are cut at the same corner.
 */
#include "import/load/load.h"

#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#define GRID 1e-3      /* m; corners are equal where they round to the same of it */
#define CELL 2.0       /* m; of the places of objects: their tolerance is half of it at most */
#define LAMP_CELL 1.0  /* m */
#define SAME_PLACE 0.1 /* m between lamps of two files: degrees with six decimals are that coarse */
#define SAME_LAMP 1.0  /* m between lamps of two files that have one id */
#define MOST 64        /* lamps of a cell that are looked at: more than stand in a square metre */

/* ---- files ---- */

static bool same_content(const char *a, const char *b) {
    enum { BLOCK = 1 << 14 };
    int fa = open(a, O_RDONLY | O_CLOEXEC), fb = open(b, O_RDONLY | O_CLOEXEC);
    char x[BLOCK], y[BLOCK];
    ssize_t n = -1, m;
    while (fa >= 0 && fb >= 0 && (n = read(fa, x, BLOCK)) > 0) {
        for (m = 0; m < n;) {
            ssize_t got = read(fb, y + m, (size_t)(n - m));
            if (got <= 0)
                break;
            m += got;
        }
        if (m < n || memcmp(x, y, (size_t)n))
            break;
    }
    if (fa >= 0)
        close(fa);
    if (fb >= 0)
        close(fb);
    return n == 0;
}

static bool same_folder(const char *a, const char *b) {
    const char *x = strrchr(a, '/'), *y = strrchr(b, '/');
    size_t n = x ? (size_t)(x - a) : 0, m = y ? (size_t)(y - b) : 0;
    return n == m && !memcmp(a, b, n);
}

bool same_file(const char *a, const char *b) {
    struct stat s, t;
    return !strcmp(a, b) || (!stat(a, &s) && !stat(b, &t) && s.st_dev == t.st_dev && s.st_ino == t.st_ino);
}

/* Why b is a again; NULL where it is not. */
static const char *file_again(const input *a, const input *b) {
    if (a->reader != b->reader)
        return NULL;
    if (!a->reader)
        return strcmp(a->path, b->path) ? NULL : "built-in scene that is named twice";
    if (!a->is_file || !b->is_file)
        return NULL;
    if (a->device == b->device && a->inode == b->inode)
        return "file that is named twice";
    /* a glTF's buffers lie beside it: other ones in another folder */
    bool alone = a->reader != &noc_reader_gltf || same_folder(a->path, b->path);
    return a->size == b->size && alone && same_content(a->path, b->path) ? "copy of another file" : NULL;
}

bool repeat_file(importer *im, size_t index) {
    input *in = &im->inputs[index];
    for (size_t i = 0; i < index; i++) {
        const char *why = file_again(&im->inputs[i], in);
        if (!why)
            continue;
        in->started = true;
        in->file.bytes = in->bytes;
        in->file.format = in->reader ? in->reader->name : "built-in scene";
        geo_issue(in->issues, GEO_SPARED, why, im->inputs[i].path);
        noc_warn(im->log, "%s: %s (%s): taken once", in->path, why, im->inputs[i].path);
        return true;
    }
    return false;
}

/* ---- objects ---- */

static uint64_t mix(uint64_t h) {
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    return h ^ h >> 32;
}

static uint64_t hash_text(const char *text) { return mix(noc_hash_text(text)); }

void repeat_polygon(object_now *now, noc_class cls, const double *xyz, size_t count) {
    uint64_t sum = mix((uint64_t)cls + 1);
    for (size_t i = 0; i < count; i++) {
        uint64_t h = (uint64_t)cls;
        for (size_t k = 0; k < 3; k++) {
            double v = xyz[3 * i + k];
            if (!isfinite(v))
                continue;
            h = mix(h + k + (uint64_t)llround(v / GRID));
            now->lo[k] = now->any ? NOC_MIN(now->lo[k], v) : v;
            now->hi[k] = now->any ? NOC_MAX(now->hi[k], v) : v;
        }
        now->any = true;
        sum += h;
    }
    now->shape += sum; /* a sum: whatever the order of corners and polygons */
}

/* Do the extents agree, but for rounding and what another level of detail adds? */
static bool near_equal(const object_record *r, const object_now *now) {
    double diagonal = 0;
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, now->hi[k] - now->lo[k]);
    double tolerance = .01 + NOC_MIN(.05 * diagonal, .5 * CELL - .01);
    for (int k = 0; k < 3; k++)
        if (!(fabs(r->lo[k] - now->lo[k]) <= tolerance && fabs(r->hi[k] - now->hi[k]) <= tolerance))
            return false;
    return true;
}

static uint64_t place_key(uint64_t id, geo_kind kind, double cx, double cy) {
    return mix(id + (uint64_t)kind + mix((uint64_t)(int64_t)cx * 0x9e3779b97f4a7c15u + (uint64_t)(int64_t)cy));
}

/* Chains of records over two tables that grow with them. */
static void link_record(object_records *all, uint32_t index) {
    object_record *r = &all->list.data[index];
    const uint64_t keys[2] = { r->place, r->shape };
    for (int t = 0; t < 2; t++) {
        uint32_t *first = &all->first[t][keys[t] & (all->size - 1)];
        r->next[t] = *first;
        *first = index + 1;
    }
}

/* False: memory was refused. */
static bool add_record(object_records *all, object_record record) {
    if (!array_push(&all->list, record))
        return false;
    if (all->list.len <= all->size) {
        link_record(all, (uint32_t)all->list.len - 1);
        return true;
    }
    size_t size = all->size ? 2 * all->size : 1024;
    uint32_t *first[2] = { noc_calloc(size, sizeof(uint32_t)), noc_calloc(size, sizeof(uint32_t)) };
    if (!first[0] || !first[1]) {
        free(first[0]);
        free(first[1]);
        all->list.len--;
        return false;
    }
    all->size = size;
    for (int t = 0; t < 2; t++) {
        free(all->first[t]);
        all->first[t] = first[t];
    }
    for (size_t i = 0; i < all->list.len; i++)
        link_record(all, (uint32_t)i);
    return true;
}

static const object_record *find_equal(const object_records *all, const object_now *now, geo_kind kind) {
    uint32_t i = all->size ? all->first[1][now->shape & (all->size - 1)] : 0;
    for (; i; i = all->list.data[i - 1].next[1]) {
        const object_record *r = &all->list.data[i - 1];
        if (r->shape == now->shape && r->kind == (uint32_t)kind && near_equal(r, now))
            return r;
    }
    return NULL;
}

/* The same id in another file, at the same place: ids such as "1" are often given anew in each. */
static const object_record *find_named(const object_records *all, const object_now *now, geo_kind kind, uint64_t id,
                                       size_t current) {
    double at[2];
    for (int k = 0; k < 2; k++)
        at[k] = (now->lo[k] + now->hi[k]) / 2 / CELL - .5;
    for (int corner = 0; corner < 4 && all->size; corner++) {
        uint64_t key = place_key(id, kind, floor(at[0]) + (corner & 1), floor(at[1]) + (corner >> 1));
        for (uint32_t i = all->first[0][key & (all->size - 1)]; i; i = all->list.data[i - 1].next[0]) {
            const object_record *r = &all->list.data[i - 1];
            if (r->place == key && r->input != current && near_equal(r, now))
                return r;
        }
    }
    return NULL;
}

noc_status repeat_object(importer *im, input *in, const object_now *now, const char *id) {
    if (in->object_decided || !now->any)
        return NOC_OK;
    in->object_decided = true;
    size_t index = (size_t)(in - im->inputs);
    uint64_t name = hash_text(id);
    const object_record *r = find_equal(&im->records, now, now->kind);
    if (!r && *id)
        r = find_named(&im->records, now, now->kind, name, index);
    if (r) {
        geo_issue(in->found, GEO_SPARED,
                  r->input == index ? "object that the file holds twice: taken once"
                                    : "object that another file holds, too: taken once",
                  id);
        in->file.objects_repeated++;
        in->object_repeated = true;
        return NOC_OK;
    }
    object_record record = { .shape = now->shape, .input = (uint32_t)index, .kind = (uint32_t)now->kind };
    for (int k = 0; k < 3; k++) {
        record.lo[k] = (float)now->lo[k];
        record.hi[k] = (float)now->hi[k];
    }
    record.place = place_key(name, now->kind, floor((now->lo[0] + now->hi[0]) / 2 / CELL),
                             floor((now->lo[1] + now->hi[1]) / 2 / CELL));
    return add_record(&im->records, record) ? NOC_OK : noc_no_memory(im->log, in->path);
}

void repeat_free(object_records *records) {
    array_free(&records->list);
    free(records->first[0]);
    free(records->first[1]);
}

/* ---- lamps ---- */

static bool called_alike(const geo_lamp *a, const geo_lamp *b) {
    const char *const x[2] = { a->id, a->ref }, *const y[2] = { b->id, b->ref };
    for (int i = 0; i < 4; i++)
        if (*x[i / 2] && !strcmp(x[i / 2], y[i % 2]))
            return true;
    return false;
}

static bool same_lamp(const pending_lamp *a, const pending_lamp *b) {
    double d = hypot(a->lamp.xyz[0] - b->lamp.xyz[0], a->lamp.xyz[1] - b->lamp.xyz[1]);
    return a->input != b->input && (d <= SAME_PLACE || (d <= SAME_LAMP && called_alike(&a->lamp, &b->lamp)));
}

/* A lamp with a body belongs to an object, whose id is its own: the same again comes of an object that the file holds
 * twice. Rows of a table are lamps each, though two of one pole share its name. */
static bool given_twice(const pending_lamp *a, const pending_lamp *b) {
    return a->input == b->input && a->lamp.body_heads && b->lamp.body_heads && *a->lamp.id &&
           !strcmp(a->lamp.id, b->lamp.id) && !memcmp(a->lamp.xyz, b->lamp.xyz, sizeof(a->lamp.xyz));
}

/* One of those around that is this lamp; NULL: there is none. */
static const pending_lamp *find_lamp(importer *im, const geo_cells *cells, const pending_lamp *p) {
    for (int c = 0; c < 9; c++) {
        size_t seen = 0;
        for (uint32_t k = *geo_cells_at(cells, p->lamp.xyz, c); k && seen++ < MOST;
             k = cells->next[k - 1], im->lamp_looks++)
            if (same_lamp(&im->lamps.data[k - 1], p) || given_twice(&im->lamps.data[k - 1], p))
                return &im->lamps.data[k - 1];
    }
    return NULL;
}

/* Does one of its own file stand at the very place? A thousand lamps of one file at one place are one, to those of
 * another. */
static bool stands_there(importer *im, const geo_cells *cells, const pending_lamp *p) {
    size_t seen = 0;
    for (uint32_t k = *geo_cells_at(cells, p->lamp.xyz, 4); k && seen++ < MOST;
         k = cells->next[k - 1], im->lamp_looks++) {
        const pending_lamp *q = &im->lamps.data[k - 1];
        if (q->input == p->input && q->lamp.xyz[0] == p->lamp.xyz[0] && q->lamp.xyz[1] == p->lamp.xyz[1])
            return true;
    }
    return false;
}

noc_status repeat_lamps(importer *im) {
    pending_lamp *lamps = im->lamps.data;
    geo_cells cells;
    size_t kept = 0;
    bool several = false;
    for (size_t i = 1; i < im->lamps.len; i++)
        several = several || lamps[i].input != lamps[0].input || lamps[i].lamp.body_heads;
    if (!several)
        return NOC_OK;
    if (!geo_cells_create(&cells, im->lamps.len, LAMP_CELL))
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < im->lamps.len; i++) {
        const pending_lamp p = lamps[i];
        const pending_lamp *same = find_lamp(im, &cells, &p);
        if (same) {
            input *in = &im->inputs[p.input];
            geo_issue(in->issues, GEO_SPARED,
                      same->input == p.input ? "lamp that the file holds twice: taken once"
                                             : "lamp that another file holds, too: taken once",
                      p.lamp.id);
            in->file.lamps_repeated++;
            continue;
        }
        lamps[kept] = p;
        if (!stands_there(im, &cells, &p))
            geo_cells_add(&cells, p.lamp.xyz, kept);
        kept++;
    }
    im->lamps.len = kept;
    geo_cells_free(&cells);
    return NOC_OK;
}
