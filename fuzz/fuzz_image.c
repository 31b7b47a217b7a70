/* Fuzzing the picture readers. With libFuzzer:
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined -DNOC_LIBFUZZER ...
 * Without it, a program that reads each file it is given, once and then with `-n ROUNDS` random mutations of it (`-s SEED` picks
 * them, `-k FILE` keeps the last one).
 * Either way: no crash, no leak, and exactly one error or one picture. */
#include "image/internal.h"

#include <stdio.h>

static int errors;

static void on_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    (void)text;
    errors += level == NOC_LOG_ERROR;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = on_message });
    errors = 0;
    noc_image *image = image_read_memory(data, size, "fuzz", log, NULL);
    if (errors != (image ? 0 : 1))
        abort();
    noc_image_destroy(image);
    noc_log_destroy(log);
    return 0;
}

#ifndef NOC_LIBFUZZER

static uint64_t state = 1;

static size_t next(size_t n) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (size_t)(state % n);
}

/* The input in the making is kept, so that one that crashes can be looked at. */
static void keep(const char *path, const uint8_t *data, size_t size) {
    FILE *f = path ? fopen(path, "wb") : NULL;
    if (!f)
        return;
    fwrite(data, 1, size, f);
    fclose(f);
}

static void mutate(const uint8_t *data, size_t size, const char *kept) {
    size_t n = next(8) ? size : next(size + 1);
    uint8_t *copy = noc_alloc(n); /* its own block, so that a read beyond it is seen */
    memcpy(copy, data, n);
    for (size_t k = n ? 1 + next(8) : 0; k > 0; k--)
        copy[next(next(2) ? NOC_MIN(n, 512) : n)] = (uint8_t)next(256);
    keep(kept, copy, n);
    LLVMFuzzerTestOneInput(copy, n);
    free(copy);
}

static bool fuzz_file(const char *path, long rounds, const char *kept) {
    FILE *f = fopen(path, "rb");
    if (!f) {
        fprintf(stderr, "fuzz_image: cannot open %s\n", path);
        return false;
    }
    NOC_ARRAY(uint8_t) data = { 0 };
    uint8_t part[4096];
    for (size_t n; (n = fread(part, 1, sizeof(part), f)) > 0;)
        array_append(&data, part, n);
    fclose(f);
    uint8_t *exact = noc_alloc(data.len);
    if (data.len)
        memcpy(exact, data.data, data.len);
    LLVMFuzzerTestOneInput(exact, data.len);
    for (long i = 0; i < rounds; i++)
        mutate(exact, data.len, kept);
    free(exact);
    array_free(&data);
    return true;
}

int main(int argc, char **argv) {
    long rounds = 0;
    const char *kept = NULL;
    bool good = true;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-n") == 0 && i + 1 < argc)
            rounds = strtol(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "-s") == 0 && i + 1 < argc)
            state = strtoull(argv[++i], NULL, 10) * 2 + 1;
        else if (strcmp(argv[i], "-k") == 0 && i + 1 < argc)
            kept = argv[++i];
        else
            good = fuzz_file(argv[i], rounds, kept) && good;
    }
    if (argc < 2)
        fprintf(stderr, "usage: fuzz_image [-n ROUNDS] [-s SEED] [-k KEEP_LAST_INPUT] FILE...\n");
    return good && argc > 1 ? 0 : 1;
}

#endif
