/* What the helper is asked. It comes from the library, which is trusted; what is understood can be asked again, by the
 * same bytes. */
#include "fuzz.h"

#include "import/remote/remote.h"

#include <sys/socket.h>
#include <unistd.h>

static remote_record ask_again(const remote_request *q) {
    remote_record batch = { 0 };
    const geo_sink sink = { .named_lamps = q->sink.named_lamps, .inspect = q->sink.inspect };
    remote_ask(&batch, q->reader, q->path, &q->params, &sink);
    return batch;
}

static bool receive(const void *data, size_t size, remote_request *q) {
    int ends[2];
    FUZZ_REQUIRE(!socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
    FUZZ_REQUIRE(!size || send(ends[0], data, size, MSG_DONTWAIT) == (ssize_t)size);
    close(ends[0]);
    bool good = remote_receive(ends[1], q);
    close(ends[1]);
    return good;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    remote_request q, same;
    fuzz_memory(data, size);
    bool good = receive(data, size, &q);
    fuzz_memory_back();
    if (good) {
        FUZZ_REQUIRE(q.reader && q.path);
        remote_record once = ask_again(&q);
        FUZZ_REQUIRE(receive(once.bytes.data, once.bytes.len, &same));
        remote_record twice = ask_again(&same);
        FUZZ_REQUIRE(once.bytes.len == twice.bytes.len && !memcmp(once.bytes.data, twice.bytes.data, once.bytes.len));
        array_free(&once.bytes);
        array_free(&twice.bytes);
        remote_request_free(&same);
    }
    remote_request_free(&q);
    return 0;
}
