/* Pictures that others name as textures: PNG and JPEG, the size that their head tells, then all of them. */
#include "fuzz.h"

#include "image/pixels.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0, width = 0, height = 0;
    noc_log *log = fuzz_log(&errors);
    pixel_bytes pixels;
    noc_status status = pixels_size(data, size, "fuzz", log, &width, &height);
    FUZZ_REQUIRE(errors == (status != NOC_OK));
    if (!status)
        FUZZ_REQUIRE(width >= 1 && height >= 1 && width <= PIXELS_SIDE && height <= PIXELS_SIDE);
    bool large = !status && (size_t)width * (size_t)height > 1 << 20; /* is read in the same way, and takes long */
    errors = 0;
    fuzz_memory(data, size);
    status = large ? NOC_ERR_UNSUPPORTED : pixels_read(data, size, "fuzz", 0, log, &pixels);
    fuzz_memory_back();
    FUZZ_REQUIRE(large || errors == (status != NOC_OK));
    if (!status) {
        volatile unsigned sum = 0;
        FUZZ_REQUIRE(pixels.rgb && pixels.width == width && pixels.height == height);
        for (size_t i = 0; i < 3 * (size_t)width * (size_t)height; i++)
            sum += pixels.rgb[i];
        (void)sum;
        free(pixels.rgb);
    }
    noc_log_destroy(log);
    return 0;
}
