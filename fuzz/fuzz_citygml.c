/* CityGML (FUZZ_CITYJSON 0) and CityJSON (1), and the streams below them. The file's size chooses the level of detail
 * and the axis order. */
#include "fuzz.h"

#include "import/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const noc_reader *reader = FUZZ_CITYJSON ? &noc_reader_cityjson : &noc_reader_citygml;
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    fuzz_sink s;
    fuzz_sink_start(&s, log);
    s.lat_first = size & 8;
    noc_import_params params = noc_import_default_params();
    params.lod = (int)(size % 5);
    char *path = fuzz_file("city.gml", (fuzz_part){ data, size });
    fuzz_memory(data, size);
    noc_stream *stream = noc_stream_open(path, log, NULL);
    noc_status status = NOC_ERR_IO;
    if (stream) {
        const char *format;
        status = reader->read(stream, &params, &s.sink, &format);
        FUZZ_REQUIRE(status || !s.in_object);
    }
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK));
    noc_stream_close(stream);
    fuzz_sink_end(&s);
    noc_log_destroy(log);
    free(path);
    return 0;
}
