/* PNG, EXR and Radiance HDR, and with two parts the comparison of two pictures, its figures and its difference. */
#include "fuzz.h"

#include "image/internal.h"

#include <math.h>

static noc_image *read_part(fuzz_part part, noc_log *log, int *errors) {
    *errors = 0;
    noc_image *image = image_read_memory(part.data, part.size, "fuzz", log, NULL);
    FUZZ_REQUIRE(*errors == !image);
    return image;
}

static void find_text(fuzz_part part) {
    static const char *const keys[] = { "Title", "comments", "Software", "" };
    for (size_t i = 0; i < sizeof(keys) / sizeof(*keys); i++) {
        size_t length = 0, at = image_find_text(part.data, part.size, keys[i], &length);
        FUZZ_REQUIRE(!at || (at <= part.size && length <= part.size - at));
    }
}

static void compare(const noc_image *x, const noc_image *r, noc_log *log, int *errors) {
    noc_comparison c;
    uint8_t *rgb = NULL;
    int width, height;
    *errors = 0;
    noc_status status = noc_image_compare(x, r, NULL, &c, log);
    FUZZ_REQUIRE(*errors == (status != NOC_OK));
    if (!status)
        FUZZ_REQUIRE(c.all.rmse >= 0 && c.all.rmse8 >= 0 && c.all.rmse8 <= 255);
    *errors = 0;
    status = noc_image_difference(x, r, NULL, &rgb, &width, &height, log);
    FUZZ_REQUIRE(*errors == (status != NOC_OK));
    if (!status)
        FUZZ_REQUIRE(rgb && width > 0 && height > 0);
    free(rgb);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_part part[FUZZ_PARTS];
    int n = fuzz_parts(data, size, part), errors;
    noc_log *log = fuzz_log(&errors);
    find_text(part[0]);
    fuzz_memory(data, size);
    noc_image *x = read_part(part[0], log, &errors), *r = n > 1 && x ? read_part(part[1], log, &errors) : NULL;
    if (x && r)
        compare(x, r, log, &errors);
    fuzz_memory_back();
    noc_image_destroy(x);
    noc_image_destroy(r);
    noc_log_destroy(log);
    return 0;
}
