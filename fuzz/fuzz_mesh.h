/* What the fuzzers of mesh readers share. */
#ifndef NOC_FUZZ_MESH_H
#define NOC_FUZZ_MESH_H

#include "import/import.h"
#include "scene/scene.h"

#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void on_message(void *user, noc_log_level level, const char *text) {
    *(int *)user += level == NOC_LOG_ERROR && *text;
}

static noc_status as_it_is(void *ctx, double *xyz, size_t count) {
    double *sum = ctx;
    for (size_t i = 0; i < 3 * count; i++)
        *sum += xyz[i];
    return NOC_OK;
}

/* A file in memory that holds the head and the data; its path is /proc/self/fd/NUMBER. */
static int file_of(const char *head, const uint8_t *data, size_t size) {
    int fd = memfd_create("fuzz", 0);
    if (fd < 0 || write(fd, head, strlen(head)) != (ssize_t)strlen(head) || write(fd, data, size) != (ssize_t)size)
        abort();
    return fd;
}

#endif
