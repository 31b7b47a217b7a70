/* Fuzzer of the CityGML reader and of the streams below it.
 *
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined -D_GNU_SOURCE -Iinclude -Isrc fuzz/fuzz_citygml.c \
 *       src/import/citygml*.c src/import/stream.c src/geo/issues.c src/base/{log,memory,text}.c \
 *       -lexpat -lzip -lz -lm -lpthread -o fuzz_citygml
 *   ./fuzz_citygml -max_len=20000 CORPUS
 *
 * The first byte chooses the level of detail and the axis order; the rest is the file. */
#include "import/import.h"

#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct state {
    bool lat_first, in_object, told;
    double sum; /* of all that is handed over, so that the sanitizers see it read */
} state;

static noc_status crs(void *ctx, const char *name, const char *place, bool *lat_first) {
    state *s = ctx;
    s->told = true;
    s->sum += (double)((name ? strlen(name) : 0) + strlen(place));
    *lat_first = s->lat_first;
    return NOC_OK;
}

static noc_status begin_object(void *ctx, const geo_object *object) {
    state *s = ctx;
    if (s->in_object || object->kind >= GEO_KIND_COUNT || object->lod < -1 || object->lod > 4)
        abort();
    s->in_object = true;
    s->sum += (double)strlen(object->id);
    return NOC_OK;
}

static noc_status polygon(void *ctx, const geo_polygon *p) {
    state *s = ctx;
    if (!s->in_object || !s->told || !p->ring_count || p->cls >= NOC_CLASS_COUNT)
        abort();
    const double *xyz = p->xyz;
    for (size_t r = 0; r < p->ring_count; r++) {
        if (p->ring_size[r] < 3)
            abort();
        for (size_t i = 0; i < 3 * p->ring_size[r]; i++)
            s->sum += *xyz++;
    }
    s->sum += (double)strlen(p->id);
    return NOC_OK;
}

static noc_status end_object(void *ctx) {
    state *s = ctx;
    if (!s->in_object)
        abort();
    s->in_object = false;
    return NOC_OK;
}

static noc_status lamp(void *ctx, const geo_lamp *l) {
    state *s = ctx;
    s->sum += l->xyz[0] + l->xyz[1] + l->xyz[2] + (double)strlen(l->id);
    return NOC_OK;
}

static bool progress(void *ctx, double done) {
    (void)ctx;
    return done >= 0 && done <= 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size < 2)
        return 0;
    int fd = memfd_create("fuzz", 0);
    if (fd < 0 || write(fd, data + 1, size - 1) != (ssize_t)(size - 1))
        abort();
    char *path = noc_format("/proc/self/fd/%d", fd);
    state s = { .lat_first = data[0] & 8 };
    geo_issues *issues = geo_issues_create();
    geo_sink sink = { .ctx = &s, .issues = issues, .crs = crs, .begin_object = begin_object, .polygon = polygon,
                      .end_object = end_object, .lamp = lamp, .progress = progress };
    noc_import_params params = noc_import_default_params();
    params.lod = data[0] & 7;
    noc_stream *stream = noc_stream_open(path, NULL);
    if (stream) {
        const char *format;
        noc_status status = noc_reader_citygml.read(stream, &params, &sink, &format);
        if (!status && s.in_object)
            abort();
    }
    noc_stream_close(stream);
    geo_issues_destroy(issues);
    free(path);
    close(fd);
    volatile double keep = s.sum;
    (void)keep;
    return 0;
}
