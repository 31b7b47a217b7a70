#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

void fuzz_broken(const char *file, int line, const char *what) {
    fprintf(stderr, "%s:%d: broken promise: %s\n", file, line, what);
    abort();
}

static uint32_t hash_of(const uint8_t *data, size_t size) {
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ data[i]) * 16777619u;
    return hash ^ hash >> 15;
}

bool fuzz_seldom(const uint8_t *data, size_t size, uint32_t once_in) { return hash_of(data, size) % once_in == 0; }

void fuzz_memory(const uint8_t *data, size_t size) {
    uint32_t hash = hash_of(data, size) * 2654435769u; /* not the bits that fuzz_seldom looks at */
    if (hash >> 30)
        return;
    uint32_t bits = (hash >> 24 & 15) % 13; /* the first allocations as often as later ones, which are more */
    noc_refuse_allocation(1 + (hash >> 4 & ((1u << bits) - 1)), (hash >> 28 & 3) == 0);
}

void fuzz_memory_back(void) { noc_refuse_allocation(0, false); }

static void count_error(void *user, noc_log_level level, const char *text) {
    FUZZ_REQUIRE(text && *text);
    *(int *)user += level == NOC_LOG_ERROR;
}

noc_log *fuzz_log(int *errors) {
    return noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = count_error, .user = errors });
}

int fuzz_parts(const uint8_t *data, size_t size, fuzz_part parts[FUZZ_PARTS]) {
    parts[0] = (fuzz_part){ data, size };
    if (size < FUZZ_MAGIC || memcmp(data, FUZZ_WORD, FUZZ_MAGIC))
        return 1;
    const uint8_t *end = data + size;
    int n = 0;
    for (data += FUZZ_MAGIC; n < FUZZ_PARTS && end - data >= 4; n++) {
        uint32_t length;
        memcpy(&length, data, 4);
        data += 4;
        length = (uint32_t)NOC_MIN((size_t)length, (size_t)(end - data));
        parts[n] = (fuzz_part){ data, length };
        data += length;
    }
    if (!n)
        parts[n++] = (fuzz_part){ end, 0 };
    return n;
}

/* ---- files ---- */

static char folder[64];

static void remove_folder(void) {
    char *command = noc_format("rm -rf '%s'", folder);
    if (system(command))
        fprintf(stderr, "fuzz: cannot remove %s\n", folder);
    free(command);
}

char *fuzz_file(const char *name, fuzz_part content) {
    if (!*folder) {
        snprintf(folder, sizeof(folder), "%s/nocturne-fuzz-XXXXXX", access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
        FUZZ_REQUIRE(mkdtemp(folder));
        atexit(remove_folder);
    }
    char *path = noc_format("%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    FUZZ_REQUIRE(f && fwrite(content.data, 1, content.size, f) == content.size && !fclose(f));
    return path;
}

/* ---- a sink ---- */

static noc_status crs(void *ctx, const char *name, const char *place, bool *lat_first) {
    fuzz_sink *s = ctx;
    s->told = true;
    s->sum += (double)((name ? strlen(name) : 0) + strlen(place));
    *lat_first = s->lat_first;
    return NOC_OK;
}

static noc_status begin_object(void *ctx, const geo_object *object) {
    fuzz_sink *s = ctx;
    FUZZ_REQUIRE(!s->in_object && object->kind < GEO_KIND_COUNT && object->lod >= -1 && object->lod <= 4);
    s->in_object = true;
    s->sum += (double)strlen(object->id);
    return NOC_OK;
}

static noc_status appearance(void *ctx, const geo_appearance *a, uint32_t *number) {
    fuzz_sink *s = ctx;
    FUZZ_REQUIRE((unsigned)a->wrap <= NOC_WRAP_CLAMP && a->f0 <= 1 && a->roughness <= 1);
    for (int k = 0; k < 3 && a->coloured; k++)
        FUZZ_REQUIRE(a->albedo[k] >= 0 && a->albedo[k] <= 1);
    s->sum += a->image ? (double)strlen(a->image) : 0;
    *number = ++s->looks;
    return NOC_OK;
}

static noc_status polygon(void *ctx, const geo_polygon *p) {
    fuzz_sink *s = ctx;
    FUZZ_REQUIRE(s->in_object && s->told && p->ring_count && p->cls < NOC_CLASS_COUNT);
    FUZZ_REQUIRE(p->appearance <= s->looks && (p->appearance || !p->uv));
    const double *xyz = p->xyz;
    const float *uv = p->uv;
    for (size_t r = 0; r < p->ring_count && uv; r++)
        for (size_t i = 0; i < 2 * p->ring_size[r]; i++)
            s->sum += isfinite(*uv) ? (double)*uv : 0, uv++;
    for (size_t r = 0; r < p->ring_count; r++) {
        FUZZ_REQUIRE(p->ring_size[r] >= 3);
        for (size_t i = 0; i < 3 * p->ring_size[r]; i++)
            s->sum += *xyz++;
    }
    s->sum += (double)strlen(p->id);
    return NOC_OK;
}

static noc_status end_object(void *ctx) {
    fuzz_sink *s = ctx;
    FUZZ_REQUIRE(s->in_object);
    s->in_object = false;
    return NOC_OK;
}

static noc_status lamp(void *ctx, const geo_lamp *l) {
    fuzz_sink *s = ctx;
    FUZZ_REQUIRE(isfinite(l->xyz[0]) && isfinite(l->xyz[1]) && l->count >= 0);
    s->sum += l->xyz[0] + l->xyz[1] + l->xyz[2] + (double)strlen(l->id);
    return NOC_OK;
}

static noc_status footprint(void *ctx, const geo_footprint *f) {
    fuzz_sink *s = ctx;
    const double *xyz = f->xyz;
    FUZZ_REQUIRE(!s->in_object && s->told && f->ring_count);
    FUZZ_REQUIRE(!(f->height > 1000) && !(f->levels > 1000) && !(f->min_height < 0));
    for (size_t r = 0; r < f->ring_count; r++) {
        FUZZ_REQUIRE(f->ring_size[r] >= 3);
        for (size_t i = 0; i < 3 * f->ring_size[r]; i++)
            s->sum += *xyz++;
    }
    s->sum += (double)strlen(f->id);
    return NOC_OK;
}

static noc_status road(void *ctx, const geo_road *r) {
    fuzz_sink *s = ctx;
    FUZZ_REQUIRE(!s->in_object && s->told && r->point_count >= 2);
    FUZZ_REQUIRE((unsigned)r->cls < GEO_ROAD_CLASSES && (unsigned)r->lit <= GEO_LIT_YES);
    FUZZ_REQUIRE(!(r->width <= 0) && !(r->speed <= 0) && r->lanes >= 0 && r->lanes <= GEO_ROAD_MOST_LANES);
    for (size_t i = 0; i < 3 * r->point_count; i++)
        s->sum += r->xyz[i];
    s->sum += (double)(strlen(r->id) + strlen(r->name));
    return NOC_OK;
}

static noc_status area_of(void *ctx, const geo_polygon *area) {
    fuzz_sink *s = ctx;
    const double *xyz = area->xyz;
    FUZZ_REQUIRE(!s->in_object && s->told && area->ring_count);
    for (size_t r = 0; r < area->ring_count; r++)
        for (size_t i = 0; i < 3 * area->ring_size[r]; i++)
            s->sum += *xyz++;
    s->sum += (double)strlen(area->id);
    return NOC_OK;
}

static noc_status track(void *ctx, const geo_track *t) {
    fuzz_sink *s = ctx;
    const double *xyz = t->xyz;
    size_t number = 0;
    FUZZ_REQUIRE(!s->in_object && s->told && t->part_count);
    for (size_t p = 0; p < t->part_count; p++) {
        FUZZ_REQUIRE(t->part_size[p] >= 2);
        for (size_t i = 0; i < t->part_size[p]; i++, xyz += 3, number++) {
            FUZZ_REQUIRE(isfinite(xyz[0]) && isfinite(xyz[1]) && (!t->seconds || isfinite(t->seconds[number])));
            s->sum += xyz[0] + xyz[1];
        }
    }
    s->sum += (double)strlen(t->id);
    return NOC_OK;
}

static bool progress(void *ctx, double done) {
    (void)ctx;
    FUZZ_REQUIRE(done >= 0 && done <= 1);
    return true;
}

void fuzz_sink_start(fuzz_sink *s, noc_log *log) {
    *s = (fuzz_sink){ 0 };
    s->sink = (geo_sink){ .ctx = s,
                          .log = log,
                          .issues = geo_issues_create(),
                          .crs = crs,
                          .appearance = appearance,
                          .begin_object = begin_object,
                          .polygon = polygon,
                          .end_object = end_object,
                          .lamp = lamp,
                          .footprint = footprint,
                          .road = road,
                          .area = area_of,
                          .track = track,
                          .progress = progress };
}

void fuzz_sink_end(fuzz_sink *s) {
    volatile double keep = s->sum;
    (void)keep;
    geo_issues_destroy(s->sink.issues);
}

void fuzz_check_scene(const noc_scene *scene, bool camera) {
    for (size_t i = 0; i < scene->indices.len; i++) {
        size_t at = 3 * (size_t)scene->indices.data[i];
        FUZZ_REQUIRE(at + 2 < scene->positions.len);
        const float *p = &scene->positions.data[at];
        FUZZ_REQUIRE(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]));
    }
    for (size_t i = 0; i < scene->lights.len; i++) {
        const noc_light_record *r = &scene->lights.data[i];
        for (int k = 0; k < 3; k++)
            FUZZ_REQUIRE(isfinite(r->p[k]) && isfinite(r->e[k]) && r->e[k] >= 0);
    }
    noc_camera found;
    if (camera && noc_scene_city_triangles(scene))
        FUZZ_REQUIRE(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1.5, &found) == NOC_OK);
}
