/* CityGML (FUZZ_CITYJSON 0) and CityJSON (1), and the streams below them. The file's size chooses the level of detail,
 * the axis order, and whether threads read it: what they tell is what one does. */
#include "fuzz.h"

#include "import/citygml/citygml.h"

/* ---- sides ---- */

static noc_status refuse_lamp(void *ctx, const geo_lamp *lamp) {
    (void)ctx;
    (void)lamp;
    return NOC_ERR_UNSUPPORTED;
}

static geo_sink *create(void *ctx) {
    fuzz_sink *side = calloc(1, sizeof(*side));
    fuzz_sink_start(side, NULL);
    if (!side->sink.issues) { /* memory was refused */
        free(side);
        return NULL;
    }
    side->lat_first = ((fuzz_sink *)ctx)->lat_first;
    side->sink.lamp = refuse_lamp;
    return &side->sink;
}

static void forget(geo_sink *sink) {
    ((fuzz_sink *)sink->ctx)->in_object = false;
    geo_issues_clear(sink->issues);
}

static noc_status take(void *ctx, geo_sink *sink) {
    fuzz_sink *s = ctx, *side = sink->ctx;
    FUZZ_REQUIRE(!side->in_object);
    s->sum += side->sum;
    geo_issues_merge(s->sink.issues, sink->issues);
    forget(sink);
    return NOC_OK;
}

static void destroy(geo_sink *sink) {
    fuzz_sink *side = sink->ctx;
    fuzz_sink_end(side);
    free(side);
}

/* ---- readings ---- */

/* Into s, which is ended by the caller. */
static noc_status read_by(int threads, const char *path, const uint8_t *data, size_t size, bool refuse, fuzz_sink *s) {
    static const geo_sides sides = { 3, create, take, forget, destroy };
    const noc_reader *reader = FUZZ_CITYJSON ? &noc_reader_cityjson : &noc_reader_citygml;
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    fuzz_sink_start(s, log);
    s->lat_first = size & 8;
    s->sink.sides = threads > 1 ? &sides : NULL;
    cg_members_at_once = 200;
    noc_import_params params = noc_import_default_params();
    params.lod = (int)(size % 5);
    if (refuse)
        fuzz_memory(data, size);
    noc_stream *stream = noc_stream_open(path, log, NULL);
    noc_status status = NOC_ERR_IO;
    if (stream) {
        const char *format;
        status = reader->read(stream, &params, &s->sink, &format);
        FUZZ_REQUIRE(status || !s->in_object);
    }
    if (refuse)
        fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK));
    noc_stream_close(stream);
    noc_log_destroy(log);
    return status;
}

static void require_same(const geo_issues *a, const geo_issues *b) {
    FUZZ_REQUIRE(geo_issues_count(a) == geo_issues_count(b));
    for (size_t i = 0; i < geo_issues_count(a); i++) {
        const char *reason[2], *examples[2];
        bool repaired[2];
        size_t count[2];
        for (int k = 0; k < 2; k++)
            FUZZ_REQUIRE(geo_issues_get(k ? b : a, i, &reason[k], &repaired[k], &count[k], &examples[k]));
        FUZZ_REQUIRE(!strcmp(reason[0], reason[1]) && !strcmp(examples[0], examples[1]) && count[0] == count[1] &&
                     repaired[0] == repaired[1]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *path = fuzz_file("city.gml", (fuzz_part){ data, size });
    fuzz_sink s, t;
    bool threads = !FUZZ_CITYJSON && size & 16;
    read_by(threads ? 3 : 1, path, data, size, true, &s);
    fuzz_sink_end(&s);
    if (threads) {
        noc_status one = read_by(1, path, data, size, false, &s), three = read_by(3, path, data, size, false, &t);
        FUZZ_REQUIRE(one == three);
        require_same(s.sink.issues, t.sink.issues);
        fuzz_sink_end(&s);
        fuzz_sink_end(&t);
    }
    free(path);
    return 0;
}
