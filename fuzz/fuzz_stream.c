/* Streams: plain, gzip, zip. What is read in large steps is what is read in small ones, after rewinding. */
#include "fuzz.h"

#include "import/import.h"

enum { MOST = 1 << 20 }; /* a bomb is not this fuzzer's to wait for */

typedef struct content {
    uint64_t sum, bytes;
    noc_status status;
} content;

static content read_in_steps(noc_stream *stream, size_t step, int *errors) {
    static uint8_t buffer[4096];
    content c = { 0 };
    *errors = 0;
    c.status = noc_stream_rewind(stream);
    for (size_t got = 1; !c.status && got && c.bytes < MOST; c.bytes += got) {
        c.status = noc_stream_read(stream, buffer, NOC_MIN(step, (size_t)(MOST - c.bytes)), &got);
        for (size_t i = 0; i < got; i++)
            c.sum = c.sum * 31 + buffer[i];
    }
    double progress = noc_stream_progress(stream);
    FUZZ_REQUIRE(*errors == (c.status != NOC_OK) && progress >= 0 && progress <= 1);
    FUZZ_REQUIRE(noc_stream_read_bytes(stream) >= c.bytes); /* the most that were read since it was opened */
    return c;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    char *path = fuzz_file("stream", (fuzz_part){ data, size });
    fuzz_memory(data, size);
    noc_stream *stream = noc_stream_open(path, log, NULL);
    FUZZ_REQUIRE(errors == !stream);
    if (stream) {
        content a = read_in_steps(stream, 4096, &errors), b = read_in_steps(stream, 1 + size % 997, &errors);
        bool refused = a.status == NOC_ERR_MEMORY || b.status == NOC_ERR_MEMORY; /* to one of them */
        FUZZ_REQUIRE(refused || (a.status == b.status && (a.status || (a.sum == b.sum && a.bytes == b.bytes))));
    }
    noc_stream_close(stream);
    fuzz_memory_back();
    noc_log_destroy(log);
    free(path);
    return 0;
}
