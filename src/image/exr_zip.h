/* exr_zip: compresses the chunks of an OpenEXR file that is written. */
#ifndef NOC_IMAGE_EXR_ZIP_H
#define NOC_IMAGE_EXR_ZIP_H

#include <openexr.h>
#include <stdbool.h>
#include <stdint.h>
#include <zlib.h>

typedef struct exr_zip {
    z_stream z;
    uint8_t *sorted, *out;
    size_t room; /* bytes of out */
} exr_zip;

/* For chunks of at most so many bytes. False: memory was refused. Ended in any case. */
bool exr_zip_begin(exr_zip *zip, size_t largest);
void exr_zip_end(exr_zip *zip);

/* A pipeline's compress_fn; its encoding_user_data is the exr_zip. */
exr_result_t exr_zip_chunk(exr_encode_pipeline_t *encode);

#endif
