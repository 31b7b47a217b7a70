/* OpenEXR, reading, by its C core: flat scanline and tiled parts, half, float and uint, R G B or Y, any compression it
 * knows. */
#include "image/exr.h"

/* OpenEXR 3.1 compares each channel with all before it, and so each attribute. */
#define MOST_CHANNELS 1024
#define MOST_ATTRIBUTES 4096

static noc_status status_of(exr_result_t code) {
    switch (code) {
    case EXR_ERR_OUT_OF_MEMORY: return NOC_ERR_MEMORY;
    case EXR_ERR_FEATURE_NOT_IMPLEMENTED: return NOC_ERR_UNSUPPORTED;
    default: return NOC_ERR_FORMAT;
    }
}

/* What this thread reads: the context must not be asked, whose lock may be held where an error is told. */
static _Thread_local exr_reader *reading;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message) {
    exr_reader *r = reading;
    if (r && r->status == NOC_OK)
        r->status = noc_error(r->log, status_of(code), "%s: EXR: %s", r->name, message);
}

bool exr_ok(exr_reader *r, exr_result_t result) {
    if (result != EXR_ERR_SUCCESS && r->status == NOC_OK)
        r->status = noc_error(r->log, status_of(result), "%s: EXR: %s", r->name, exr_get_default_error_message(result));
    return r->status == NOC_OK;
}

static int64_t read_data(exr_const_context_t context, void *user, void *buffer, uint64_t size, uint64_t offset,
                         exr_stream_error_func_ptr_t report) {
    const exr_reader *r = user;
    if (offset > r->size)
        return 0;
    uint64_t n = NOC_MIN(size, r->size - offset);
    memcpy(buffer, r->data + offset, n);
    return (int64_t)n;
}

static int64_t query_size(exr_const_context_t context, void *user) {
    const exr_reader *r = user;
    return (int64_t)r->size;
}

/* The text at *at, which is moved behind its end; NULL where it has none. */
static const char *text_at(const exr_reader *r, size_t *at) {
    const uint8_t *text = r->data + *at, *end = memchr(text, 0, r->size - *at);
    *at = end ? (size_t)(end + 1 - r->data) : r->size;
    return end ? (const char *)text : NULL;
}

/* Channels of a list that begins at `at`. */
static size_t count_channels(const exr_reader *r, size_t at, size_t end) {
    enum { BEHIND_NAME = 16 }; /* bytes: type, linearity, sampling */
    const char *name;
    size_t n = 0;
    for (; at < end && (name = text_at(r, &at)) && *name; at += NOC_MIN((size_t)BEHIND_NAME, r->size - at))
        n++;
    return n;
}

/* Are the headers so long that OpenEXR would not get done with them? What is wrong with them otherwise is left to it.
 */
static bool has_too_much(exr_reader *r) {
    bool several = r->size > 8 && r->data[5] & 0x10; /* headers, ended by an empty one */
    size_t at = NOC_MIN(r->size, (size_t)8), attributes = 0;
    const char *name, *type, *much = NULL;
    for (bool first = true; !much && (name = text_at(r, &at)) && (*name || (several && !first));) {
        first = !*name;
        if (first)
            continue;
        if (!(type = text_at(r, &at)) || r->size - at < 4)
            break;
        const uint8_t *p = r->data + at;
        size_t size = (size_t)p[0] | (size_t)p[1] << 8 | (size_t)p[2] << 16 | (size_t)p[3] << 24;
        at += 4;
        if (size > r->size - at)
            break;
        if (++attributes > MOST_ATTRIBUTES)
            much = "attributes";
        else if (!strcmp(type, "chlist") && count_channels(r, at, at + size) > MOST_CHANNELS)
            much = "channels";
        at += size;
    }
    if (much)
        r->status = noc_error(r->log, NOC_ERR_UNSUPPORTED, "%s: EXR: more than %d %s, which are not read", r->name,
                              *much == 'a' ? MOST_ATTRIBUTES : MOST_CHANNELS, much);
    return much != NULL;
}

/* Largest ratio of unpacked to packed bytes, by compression; 0: no useful bound. */
static double packing_bound(exr_compression_t compression) {
    switch (compression) {
    case EXR_COMPRESSION_NONE: return 1;
    case EXR_COMPRESSION_RLE: return 128;
    case EXR_COMPRESSION_ZIPS:
    case EXR_COMPRESSION_ZIP:
    case EXR_COMPRESSION_PXR24: return 1400; /* deflate's 1032, and PXR24 drops a quarter before it */
    default: return 0;
    }
}

/* A file that cannot hold what it declares is known before any memory is given to it. */
static bool plausible(exr_reader *r, double width, double height) {
    exr_compression_t compression;
    const exr_attr_chlist_t *list = NULL;
    int32_t chunks = 0;
    uint64_t chunk_bytes = 0;
    if (!exr_ok(r, exr_get_compression(r->context, r->part, &compression)) ||
        !exr_ok(r, exr_get_channels(r->context, r->part, &list)) ||
        !exr_ok(r, exr_get_chunk_count(r->context, r->part, &chunks)) ||
        !exr_ok(r, exr_get_chunk_unpacked_size(r->context, r->part, &chunk_bytes)))
        return false;
    double bytes = 0, bound = packing_bound(compression);
    for (int i = 0; i < list->num_channels; i++)
        bytes += width * height * (list->entries[i].pixel_type == EXR_PIXEL_HALF ? 2 : 4);
    /* Each chunk has 8 bytes in the table and at least 8 of its own. */
    if (16.0 * chunks <= (double)r->size && (bound == 0 || bytes <= bound * (double)r->size) && chunk_bytes < 1u << 31)
        return true;
    r->status =
        noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: %.0f x %.0f pixels in %d channels cannot be in a file of %zu bytes",
                  r->name, width, height, list->num_channels, r->size);
    return false;
}

static bool make_image(exr_reader *r) {
    if (!exr_ok(r, exr_get_data_window(r->context, r->part, &r->window)))
        return false;
    double width = (double)r->window.max.x - r->window.min.x + 1,
           height = (double)r->window.max.y - r->window.min.y + 1;
    if (!(width >= 1 && height >= 1 && width <= NOC_IMAGE_MAX_SIDE && height <= NOC_IMAGE_MAX_SIDE)) {
        r->status = noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: %.0f x %.0f pixels is outside 1..%d a side", r->name,
                              width, height, NOC_IMAGE_MAX_SIDE);
        return false;
    }
    if (!plausible(r, width, height))
        return false;
    r->image = noc_image_create((int)width, (int)height, r->log);
    if (!r->image || (r->has_mask && !image_add_mask(r->image, r->log))) {
        r->status = NOC_ERR_MEMORY;
        return false;
    }
    if (r->has_mask && !(r->mask = noc_alloc_large(image_pixels(r->image), sizeof(float))))
        r->status = noc_error(r->log, NOC_ERR_MEMORY, "%s: no memory for its mask", r->name);
    return r->status == NOC_OK;
}

/* IEEE binary16, exactly. */
static float half_to_float(uint16_t h) {
    uint32_t sign = (uint32_t)(h & 0x8000) << 16, exponent = h >> 10 & 31, mantissa = h & 1023, bits;
    if (exponent == 0) { /* zero and subnormal: a multiple of 2^-24 */
        float f = (float)mantissa * 0x1p-24f;
        return sign ? -f : f;
    }
    if (exponent == 31)
        bits = sign | 0x7f800000 | mantissa << 13;
    else
        bits = sign | (exponent + 112) << 23 | mantissa << 13;
    float f;
    memcpy(&f, &bits, sizeof(f));
    return f;
}

/* One line of one channel: little-endian samples to every stride-th float. */
static void unpack_line(const uint8_t *from, int type, int width, float *to, int stride) {
    for (int x = 0; x < width; x++, to += stride) {
        if (type == EXR_PIXEL_HALF) {
            *to = half_to_float((uint16_t)(from[2 * x] | from[2 * x + 1] << 8));
            continue;
        }
        const uint8_t *p = from + 4 * x;
        uint32_t bits = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
        if (type == EXR_PIXEL_UINT)
            *to = (float)bits;
        else
            memcpy(to, &bits, sizeof(bits));
    }
}

/* A channel's name within the layer; NULL: it is of another one. */
static const char *within_layer(const exr_reader *r, const char *channel) {
    size_t n = strlen(r->layer);
    return strncmp(channel, r->layer, n) == 0 ? channel + n : NULL;
}

static int component(const exr_reader *r, const char *channel) {
    static const char *const kept[][3] = {
        [EXR_RGB] = { "R", "G", "B" }, [EXR_GREY] = { "Y", "", "" }, [EXR_CHROMA] = { "RY", "Y", "BY" }
    };
    const char *name = within_layer(r, channel);
    for (int k = 0; k < 3 && name && *name; k++)
        if (strcmp(name, kept[r->layout][k]) == 0)
            return k;
    return -1;
}

/* Where a channel's pixel (x, y) goes, NULL for channels that are not wanted. */
static float *target(exr_reader *r, const char *channel, size_t x, size_t y, int *stride) {
    size_t pixel = y * (size_t)r->image->width + x;
    const char *name = within_layer(r, channel);
    *stride = 1;
    if (r->mask && name && strcmp(name, "emitter") == 0)
        return r->mask + pixel;
    int k = component(r, channel);
    *stride = 3;
    return k >= 0 ? r->image->rgb + 3 * pixel + k : NULL;
}

/* In the pipeline in place of the library's own routines: one of those, in 3.1.5, was seen to write outside the picture
 * on a damaged tiled file. Lines of a chunk follow each other, in each its channels, planar. */
static exr_result_t unpack_chunk(exr_decode_pipeline_t *decode) {
    exr_reader *r = decode->decoding_user_data;
    const exr_chunk_info_t *chunk = &decode->chunk;
    const uint8_t *from = decode->unpacked_buffer;
    size_t line_bytes = 0;
    for (int i = 0; i < decode->channel_count; i++)
        line_bytes += (size_t)chunk->width * (size_t)decode->channels[i].bytes_per_element;
    if (!from || chunk->unpacked_size != line_bytes * (size_t)chunk->height)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int y = 0; y < chunk->height; y++)
        for (int i = 0; i < decode->channel_count; i++) {
            const exr_coding_channel_info_t *ch = &decode->channels[i];
            int stride;
            float *to = target(r, ch->channel_name, (size_t)r->x, (size_t)(r->y + y), &stride);
            if (to)
                unpack_line(from, ch->data_type, chunk->width, to, stride);
            from += (size_t)chunk->width * (size_t)ch->bytes_per_element;
        }
    return EXR_ERR_SUCCESS;
}

/* Buffers begin as zeros, so that what a damaged chunk leaves out is black and not what was in memory before; and have
 * some bytes more than asked for, since decoders of bit streams read ahead. */
static void *alloc_buffer(exr_transcoding_pipeline_buffer_id_t id, size_t size) {
    return size < SIZE_MAX - 64 ? noc_calloc(1, size + 64) : NULL;
}
static void free_buffer(exr_transcoding_pipeline_buffer_id_t id, void *buffer) { free(buffer); }

static bool run_pipeline(exr_reader *r, const exr_chunk_info_t *chunk, exr_decode_pipeline_t *decode) {
    if (!exr_ok(r, exr_decoding_initialize(r->context, r->part, chunk, decode)))
        return false;
    decode->decoding_user_data = r;
    decode->alloc_fn = alloc_buffer;
    decode->free_fn = free_buffer;
    for (int i = 0; i < decode->channel_count; i++) { /* only looked at for choosing, and never as plain planes */
        exr_coding_channel_info_t *ch = &decode->channels[i];
        ch->user_data_type = EXR_PIXEL_FLOAT;
        ch->user_bytes_per_element = 4;
        ch->user_pixel_stride = 12;
        ch->user_line_stride = 12 * r->image->width;
        ch->decode_to_ptr = (uint8_t *)r->image->rgb;
    }
    if (!exr_ok(r, exr_decoding_choose_default_routines(r->context, r->part, decode)))
        return false;
    decode->unpack_and_convert_fn = unpack_chunk;
    return exr_ok(r, exr_decoding_run(r->context, r->part, decode));
}

/* The chunk at (x, y), relative to the data window, which must be width x height. */
static bool read_chunk(exr_reader *r, const exr_chunk_info_t *chunk, int x, int y, int width, int height) {
    bool stored = chunk->compression == EXR_COMPRESSION_NONE;
    if (chunk->width != width || chunk->height != height || chunk->packed_size == 0 || chunk->packed_size > r->size ||
        (stored && chunk->packed_size != chunk->unpacked_size)) {
        r->status = noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: the chunk at %d, %d has a wrong size", r->name, x, y);
        return false;
    }
    r->x = x;
    r->y = y;
    /* A pipeline a chunk: one that is used again keeps buffers of the chunk before. */
    exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
    bool good = run_pipeline(r, chunk, &decode);
    if (decode.context)
        exr_decoding_destroy(r->context, &decode);
    return good;
}

static bool read_scanlines(exr_reader *r) {
    int32_t lines = 0;
    if (!exr_ok(r, exr_get_scanlines_per_chunk(r->context, r->part, &lines)))
        return false;
    lines = NOC_MAX(lines, 1);
    for (int y = 0; y < r->image->height; y += lines) {
        exr_chunk_info_t chunk;
        if (!exr_ok(r, exr_read_scanline_chunk_info(r->context, r->part, r->window.min.y + y, &chunk)) ||
            !read_chunk(r, &chunk, 0, y, r->image->width, NOC_MIN(lines, r->image->height - y)))
            return false;
    }
    return true;
}

/* The full-size level of a tiled part. */
static bool read_tiles(exr_reader *r) {
    int32_t tw = 0, th = 0;
    if (!exr_ok(r, exr_get_tile_sizes(r->context, r->part, 0, 0, &tw, &th)))
        return false;
    if (tw < 1 || th < 1) {
        r->status = noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: tiles of %d x %d pixels", r->name, tw, th);
        return false;
    }
    for (int ty = 0; ty <= (r->image->height - 1) / th; ty++)
        for (int tx = 0; tx <= (r->image->width - 1) / tw; tx++) {
            exr_chunk_info_t chunk;
            if (!exr_ok(r, exr_read_tile_chunk_info(r->context, r->part, tx, ty, 0, 0, &chunk)) ||
                !read_chunk(r, &chunk, tx * tw, ty * th, NOC_MIN(tw, r->image->width - tx * tw),
                            NOC_MIN(th, r->image->height - ty * th)))
                return false;
        }
    return true;
}

static void read_channel_name(exr_reader *r) {
    const exr_attribute_t *attribute = NULL;
    if (exr_get_attribute_by_name(r->context, r->part, "channel", &attribute) == EXR_ERR_SUCCESS && attribute &&
        attribute->type == EXR_ATTR_STRING)
        noc_snprintf(r->image->channel, sizeof(r->image->channel), "%.*s", attribute->string->length,
                     attribute->string->str);
}

static void finish_image(exr_reader *r) {
    const exr_attribute_t *smoothed = NULL;
    size_t n = image_pixels(r->image);
    read_channel_name(r);
    r->image->smoothed = exr_get_attribute_by_name(r->context, r->part, "smoothed", &smoothed) == EXR_ERR_SUCCESS;
    exr_apply_colours(r);
    for (size_t i = 0; r->mask && i < n; i++)
        r->image->emitter[i] = r->mask[i] != 0; /* not-a-number counts as an emitter: then it is left out */
}

noc_image *image_read_exr(const uint8_t *data, size_t size, const char *name, noc_log *log) {
    exr_reader r = { .data = data, .size = size, .name = name, .log = log };
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.user_data = &r;
    reading = &r;
    init.read_fn = read_data;
    init.size_fn = query_size;
    init.error_handler_fn = on_error;
    init.alloc_fn = noc_alloc;
    init.free_fn = free;
    init.max_image_width = init.max_image_height = NOC_IMAGE_MAX_SIDE;
    init.max_tile_width = init.max_tile_height = NOC_IMAGE_MAX_SIDE;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    if (!has_too_much(&r) && exr_ok(&r, exr_start_read(&r.context, name, &init)) && exr_choose(&r) &&
        exr_read_colours(&r) && make_image(&r) && (r.tiled ? read_tiles(&r) : read_scanlines(&r)))
        finish_image(&r);
    if (r.context)
        exr_finish(&r.context);
    reading = NULL;
    free(r.mask);
    if (r.status != NOC_OK) {
        noc_image_destroy(r.image);
        return NULL;
    }
    return r.image;
}
