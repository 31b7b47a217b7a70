/* What the fuzzers share. Each is one LLVMFuzzerTestOneInput; libFuzzer drives it (`make fuzz`), or replay.c, which
 * runs files through it as a test. Whatever the bytes are: no crash, no leak, and one error or none.
 *
 * An input is one file, or several, each behind its length (fuzz_parts). Mutations know the formats (mutate.h), so that
 * they get past checksums, compression and parsers. */
#ifndef NOC_FUZZ_H
#define NOC_FUZZ_H

#include "base/base.h"
#include "geo/geo.h"
#include "scene/scene.h"

#include <sanitizer/asan_interface.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A broken promise: reported like a crash. */
#define FUZZ_REQUIRE(what) ((what) ? (void)0 : fuzz_broken(__FILE__, __LINE__, #what))
_Noreturn void fuzz_broken(const char *file, int line, const char *what);

/* Once in so many inputs, by their bytes, so that what is found comes again: for what takes long. */
bool fuzz_seldom(const uint8_t *data, size_t size, uint32_t once_in);

/* Refuses memory in one run in 4, as their bytes say: one of the library's allocations, or all from one on. Until
 * fuzz_memory_back. */
void fuzz_memory(const uint8_t *data, size_t size);
void fuzz_memory_back(void);

/* What lies behind the bytes that an array holds, for AddressSanitizer: who touches it is seen, until it is allowed
 * again. */
#define fuzz_forbid_rest(a) ASAN_POISON_MEMORY_REGION((a)->data + (a)->len, ((a)->cap - (a)->len) * sizeof(*(a)->data))
#define fuzz_allow_rest(a) ASAN_UNPOISON_MEMORY_REGION((a)->data + (a)->len, ((a)->cap - (a)->len) * sizeof(*(a)->data))

/* A log that counts its errors in *errors. */
noc_log *fuzz_log(int *errors);

/* Parts of an input: a magic word, then each behind its length, little-endian. What does not begin so is one part. */
enum { FUZZ_PARTS = 4, FUZZ_MAGIC = 4 };
#define FUZZ_WORD "NFZ1"
typedef struct fuzz_part {
    const uint8_t *data;
    size_t size;
} fuzz_part;
int fuzz_parts(const uint8_t *data, size_t size, fuzz_part parts[FUZZ_PARTS]);

/* Writes a file NAME in a folder of this process's own, which is removed at exit. The path is the caller's to free. */
char *fuzz_file(const char *name, fuzz_part content);

/* A sink that looks at all that it is given, and wants it as geo.h promises. */
typedef struct fuzz_sink {
    geo_sink sink;
    bool in_object, told, lat_first;
    uint32_t looks; /* that were numbered */
    double sum;     /* of all that was handed over, so that the sanitizers see it read */
} fuzz_sink;
void fuzz_sink_start(fuzz_sink *s, noc_log *log);
void fuzz_sink_end(fuzz_sink *s);

/* What a renderer would rely on, of a scene that was committed; and the camera that is found for it, which takes
 * longer. */
void fuzz_check_scene(const noc_scene *scene, bool camera);

/* built_seeds.c: of record alone. */
void built_seeds(const char *out);

#endif
