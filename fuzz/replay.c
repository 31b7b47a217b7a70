/* In the place of libFuzzer: runs each file that is named, or every file of a folder, through a fuzzer once.
 * Prints TAP. */
#include "fuzz.h"

#include <dirent.h>
#include <stdio.h>

static int runs;

static void run_file(const char *path) {
    FILE *f = fopen(path, "rb");
    FUZZ_REQUIRE(f);
    NOC_ARRAY(uint8_t) data = { 0 };
    uint8_t part[4096];
    for (size_t n; (n = fread(part, 1, sizeof(part), f)) > 0;)
        FUZZ_REQUIRE(array_append(&data, part, n));
    fclose(f);
    uint8_t *exact = noc_alloc(data.len); /* its own block, so that a read beyond it is seen */
    if (data.len)
        memcpy(exact, data.data, data.len);
    fprintf(stderr, "# %s\n", path);
    LLVMFuzzerTestOneInput(exact, data.len);
    runs++;
    free(exact);
    array_free(&data);
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        DIR *d = opendir(argv[i]);
        for (struct dirent *e; d && (e = readdir(d));) {
            if (*e->d_name == '.')
                continue;
            char *path = noc_format("%s/%s", argv[i], e->d_name);
            run_file(path);
            free(path);
        }
        if (d)
            closedir(d);
        else
            run_file(argv[i]);
    }
    printf("%s 1 - %d inputs\n1..1\n", runs ? "ok" : "not ok", runs);
    return runs ? 0 : 1;
}
