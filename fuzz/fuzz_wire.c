/* What comes back from the helper that reads maps and OBJ, which the file may have taken over: records in pieces of
 * all sizes. They go to a sink that looks at all, and in one run in 4 to the importer's own, as from a file of lamps or
 * a mesh. */
#include "fuzz.h"

#include "import/load/load.h"
#include "import/remote/remote.h"

static fuzz_part bytes;

/* How many bytes come next: one record, so that who reads beyond it is seen; or any number. */
static size_t piece(size_t at) {
    remote_head head;
    size_t left = bytes.size - at, n = 1 + (at * 31 + bytes.size) % 5000;
    if (bytes.size & 1 && left >= sizeof(head)) {
        memcpy(&head, bytes.data + at, sizeof(head));
        n = sizeof(head) + head.size_low;
    }
    return NOC_MIN(n, left);
}

static noc_status take_all(geo_sink *sink, const mesh_parts *parts) {
    remote_result result = { 0 };
    remote_taker t = { .path = "fuzz", .sink = sink, .parts = parts, .result = &result };
    noc_status status = NOC_OK;
    for (size_t at = 0, n; !status && !t.ended && at < bytes.size; at += n) {
        n = piece(at);
        char *room = remote_room(&t, n);
        status = room ? NOC_OK : NOC_ERR_MEMORY;
        if (room) {
            memcpy(room, bytes.data + at, n);
            t.bytes.len += n;
        }
        if (room)
            fuzz_forbid_rest(&t.bytes);
        while (!status && remote_take(&t, &status))
            continue;
        if (room)
            fuzz_allow_rest(&t.bytes);
    }
    if (!status && !t.ended)
        status = noc_error(sink->log, NOC_ERR_FORMAT, "ended early");
    FUZZ_REQUIRE(memchr(result.format, 0, sizeof(result.format)));
    remote_taker_free(&t);
    return status;
}

/* ---- the importer's sinks ---- */

static noc_status read_map(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format) {
    return take_all(sink, NULL);
}

static noc_status read_mesh(const char *path, noc_stream *stream, const noc_import_params *params, noc_scene *scene,
                            const mesh_place *place, geo_issues *issues, const char **format) {
    fuzz_sink other; /* of an OBJ, the importer's is asked for progress alone */
    fuzz_sink_start(&other, scene->log);
    mesh_scene to = { .scene = scene, .place = place, .issues = issues };
    const mesh_parts parts = mesh_scene_parts(&to);
    noc_status status = other.sink.issues ? take_all(&other.sink, &parts) : noc_no_memory(scene->log, "fuzz");
    fuzz_sink_end(&other);
    return status;
}

static bool any(const char *head, size_t size) { return true; }

static void to_scene(const uint8_t *data, size_t size, noc_log *log, int *errors) {
    static const noc_reader map = { .name = "map", .reads = NOC_READS_LAMPS, .probe = any, .read = read_map };
    static const noc_reader mesh = { .name = "mesh", .reads = NOC_READS_MESH, .probe = any, .read_mesh = read_mesh };
    const noc_reader *const readers[] = { fuzz_seldom(data, size, 8) ? &mesh : &map, NULL };
    noc_import_params params = noc_import_default_params();
    char *path = fuzz_file("wire", (fuzz_part){ (const uint8_t *)"wire", 4 });
    noc_scene *scene = noc_scene_create(log);
    noc_report *report = NULL;
    fuzz_memory(data, size);
    noc_status status = load_inputs(scene, readers, (const char *const[]){ path }, 1, &params, false, &report);
    fuzz_memory_back();
    FUZZ_REQUIRE(*errors == (status != NOC_OK));
    if (!status)
        fuzz_check_scene(scene, false);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    free(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    bytes = (fuzz_part){ data, size };
    if (fuzz_seldom(data, size, 4)) {
        to_scene(data, size, log, &errors);
    } else {
        fuzz_sink s;
        fuzz_sink_start(&s, log);
        s.told = true; /* what the reader would tell before it emits is the importer's to ask for */
        fuzz_memory(data, size);
        noc_status status = take_all(&s.sink, NULL);
        fuzz_memory_back();
        FUZZ_REQUIRE(errors == (status != NOC_OK));
        fuzz_sink_end(&s);
    }
    noc_log_destroy(log);
    return 0;
}
