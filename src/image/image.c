/* Pictures in memory. */
#include "image/internal.h"

#include <math.h>
#include <unistd.h>

/* Memory of the machine. A picture beyond it is refused here: the kernel would promise it, and then kill the program.
 */
static double machine_bytes(void) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (double)pages * (double)page : 1e30;
}

void *image_alloc_pixels(int width, int height, size_t size, noc_log *log) {
    double bytes = (double)width * height * (double)size;
    void *p = bytes < machine_bytes() ? noc_alloc_large((size_t)width * (size_t)height, size) : NULL;
    if (!p)
        noc_error(log, NOC_ERR_MEMORY, "image: no memory for %d x %d pixels (%.0f MB)", width, height,
                  ceil(bytes * 1e-6));
    return p;
}

noc_image *noc_image_create(int width, int height, noc_log *log) {
    if (width < 1 || height < 1 || width > NOC_IMAGE_MAX_SIDE || height > NOC_IMAGE_MAX_SIDE) {
        noc_error(log, NOC_ERR_ARGUMENT, "image: %d x %d pixels is outside 1..%d a side", width, height,
                  NOC_IMAGE_MAX_SIDE);
        return NULL;
    }
    noc_image *image = noc_calloc(1, sizeof(*image));
    if (!image) {
        noc_no_memory(log, "image");
        return NULL;
    }
    image->width = width;
    image->height = height;
    image->ev100 = NAN;
    image->rgb = image_alloc_pixels(width, height, 3 * sizeof(float), log);
    if (image->rgb)
        return image;
    noc_image_destroy(image);
    return NULL;
}

bool image_add_mask(noc_image *image, noc_log *log) {
    if (!image->emitter)
        image->emitter = image_alloc_pixels(image->width, image->height, 1, log);
    return image->emitter != NULL;
}

void noc_image_destroy(noc_image *image) {
    if (!image)
        return;
    free(image->rgb);
    free(image->emitter);
    free(image->coverage);
    free(image);
}

bool noc_image_is_black(const noc_image *image) {
    size_t n = image ? (size_t)image->width * (size_t)image->height * 3 : 0;
    for (size_t i = 0; i < n; i++)
        if (image->rgb[i] > 0)
            return false;
    return true;
}
