/* GeoTIFF, whose bytes GDAL takes apart, and the triangles of its grid. */
#include "fuzz.h"

#include "import/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    fuzz_sink s;
    fuzz_sink_start(&s, log);
    noc_import_params params = noc_import_default_params();
    params.max_memory = 0.02;
    params.terrain_triangles = 2000;
    char *path = fuzz_file("terrain.tif", (fuzz_part){ data, size });
    fuzz_memory(data, size);
    noc_stream *stream = noc_stream_open(path, log, NULL);
    noc_status status = NOC_ERR_IO;
    if (stream && !noc_reader_terrain.missing) {
        const char *format;
        noc_stream_limit(stream, &params);
        status = noc_reader_terrain.read(stream, &params, &s.sink, &format);
        FUZZ_REQUIRE(status || !s.in_object);
    }
    fuzz_memory_back();
    FUZZ_REQUIRE(noc_reader_terrain.missing || errors == (status != NOC_OK));
    noc_stream_close(stream);
    fuzz_sink_end(&s);
    noc_log_destroy(log);
    free(path);
    return 0;
}
