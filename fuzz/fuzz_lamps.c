/* Lamps: tables (CSV), Overpass JSON, and what GDAL reads: OpenStreetMap XML and PBF, GeoJSON, GeoPackage, Shapefile,
 * FlatGeobuf. With FUZZ_TRACKS tracks of cars: GPX, points in XML, and tables and maps that the user names as such. */
#include "fuzz.h"

#include "import/load/load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const noc_reader *const readers[] = { &noc_reader_overpass, &noc_reader_tracks, &noc_reader_vector, NULL };
    enum { HEAD = 4096 };
    char head[HEAD + 1] = "";
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    fuzz_sink s;
    fuzz_sink_start(&s, log);
    s.sink.named_tracks = FUZZ_TRACKS;
    noc_import_params params = noc_import_default_params();
    char *path = fuzz_file("map", (fuzz_part){ data, size });
    fuzz_memory(data, size);
    noc_stream *stream = noc_stream_open(path, log, NULL);
    size_t len = 0;
    noc_status status = stream ? NOC_OK : NOC_ERR_IO;
    for (size_t got = 1; !status && got && len < HEAD; len += got)
        status = noc_stream_read(stream, head + len, HEAD - len, &got);
    const noc_reader *reader = status ? NULL : find_reader(readers, head, len);
    if (reader) {
        const char *format;
        status = noc_stream_rewind(stream);
        status = status ? status : reader->read(stream, &params, &s.sink, &format);
    }
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK) && !s.in_object);
    noc_stream_close(stream);
    fuzz_sink_end(&s);
    noc_log_destroy(log);
    free(path);
    return 0;
}
