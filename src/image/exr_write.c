/* OpenEXR, writing, by its C core: pictures as linear float cd/m2 with their mask, channels as floats; ZIP, with units.
 */
#include "image/exr_zip.h"
#include "image/internal.h"

#include <errno.h>
#include <openexr.h>

typedef struct exr_writer {
    exr_context_t context;
    int part;
    output *out;
    const noc_image *image; /* NULL: a channel is written */
    const noc_channel *channel;
    int width, height;
    noc_log *log;
    noc_status status;
    float *rgb;        /* one chunk, finite */
    uint16_t *emitter; /* one chunk, half */
    exr_zip zip;
} exr_writer;

static noc_status status_of(exr_result_t code) { return code == EXR_ERR_OUT_OF_MEMORY ? NOC_ERR_MEMORY : NOC_ERR_IO; }

/* What this thread writes: the context must not be asked, whose lock may be held where an error is told. */
static _Thread_local exr_writer *writing;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message) {
    exr_writer *w = writing;
    if (w && w->status == NOC_OK)
        w->status = noc_error(w->log, status_of(code), "%s: EXR: %s", w->out->path, message);
}

static int64_t write_data(exr_const_context_t context, void *user, const void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t report) {
    exr_writer *w = user;
    FILE *f = w->out->file;
    /* Seeking flushes, and only the table of chunks at the end goes back. */
    if ((uint64_t)ftello(f) != offset && fseeko(f, (off_t)offset, SEEK_SET) != 0)
        w->status = output_failed(w->out, w->log);
    else if (fwrite(buffer, 1, size, f) == size)
        return (int64_t)size;
    else if (w->status == NOC_OK)
        w->status = output_failed(w->out, w->log);
    return -1;
}

/* Numbers a pixel, without the mask. */
static int components(const exr_writer *w) { return w->channel ? w->channel->components : 3; }

/* Returns false when a step failed; the handler has reported it, or it is reported here. */
static bool ok(exr_writer *w, exr_result_t result) {
    if (result != EXR_ERR_SUCCESS && w->status == NOC_OK)
        w->status =
            noc_error(w->log, status_of(result), "%s: EXR: %s", w->out->path, exr_get_default_error_message(result));
    return w->status == NOC_OK;
}

/* Names that readers give a meaning to even where this file does not set them. */
static bool is_reserved(const char *key) {
    static const char *const names[] = { "chunkCount", "maxSamplesPerPixel", "name", "preview", "tiles", "type",
                                         "version" };
    for (size_t i = 0; i < NOC_COUNT(names); i++)
        if (!strcmp(key, names[i]))
            return true;
    return false;
}

static bool write_header(exr_writer *w, const meta_list *meta) {
    static const exr_attr_chromaticities_t rec709 = { 0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f };
    static const exr_attr_v2f_t d65 = { { .x = 0.3127f, .y = 0.3290f } };
    exr_context_t c = w->context;
    bool good = ok(w, exr_add_part(c, NULL, EXR_STORAGE_SCANLINE, &w->part)) &&
                ok(w, exr_initialize_required_attr_simple(c, w->part, w->width, w->height, EXR_COMPRESSION_ZIP));
    static const char *const colours[] = { "B", "G", "R" };
    for (int k = 0; w->image && k < 3 && good; k++)
        good = ok(w, exr_add_channel(c, w->part, colours[k], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    for (int k = 0; w->channel && k < components(w) && good; k++) /* a vector's are X, Y, Z, a number is Y */
        good = ok(w, exr_add_channel(c, w->part,
                                     components(w) == 1 ? "Y"
                                     : k == 0           ? "X"
                                     : k == 1           ? "Y"
                                                        : "Z",
                                     EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1));
    if (w->image && w->image->emitter && good)
        good = ok(w, exr_add_channel(c, w->part, "emitter", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LINEAR, 1, 1));
    if (w->image && good)
        good = ok(w, exr_attr_set_chromaticities(c, w->part, "chromaticities", &rec709)) &&
               ok(w, exr_attr_set_v2f(c, w->part, "adoptedNeutral", &d65)) &&
               ok(w, exr_attr_set_float(c, w->part, "whiteLuminance", 1));
    good = good && ok(w, exr_set_longname_support(c, 1));
    for (size_t i = 0; good && i < meta->entries.len; i++) {
        const meta_entry *e = &meta->entries.data[i];
        const exr_attribute_t *old = NULL;
        /* "Channels" may be a key, "channels" is what the format itself needs. */
        bool set = exr_get_attribute_by_name(c, w->part, e->key, &old) == EXR_ERR_SUCCESS && old;
        if (is_reserved(e->key) || (set && old->type != EXR_ATTR_STRING))
            w->status = noc_error(w->log, NOC_ERR_ARGUMENT, "%s: EXR: metadata key '%s' is taken by the format",
                                  w->out->path, e->key);
        good = w->status == NOC_OK && ok(w, exr_attr_set_string(c, w->part, e->key, e->value));
    }
    return good && ok(w, exr_write_header(c));
}

/* Copies the rows of a chunk, without what is not finite. */
static void fill_chunk(exr_writer *w, int y0, int rows) {
    const noc_image *image = w->image;
    size_t n = (size_t)rows * (size_t)w->width, first = (size_t)y0 * (size_t)w->width;
    size_t per = (size_t)components(w);
    for (size_t i = 0; w->channel && i < per * n; i++) {
        float v = w->channel->value[per * first + i];
        w->rgb[i] = __builtin_isfinite(v) ? v : per == 1 ? -1 : 0;
    }
    if (!image)
        return;
    for (size_t i = 0; i < n; i++) {
        const float *rgb = image->rgb + 3 * (first + i);
        bool finite = image_finite(rgb);
        for (int k = 0; k < 3; k++)
            w->rgb[3 * i + (size_t)k] = finite ? rgb[k] : 0;
        if (image->emitter)
            w->emitter[i] = image->emitter[first + i] ? 0x3c00 : 0; /* half 1 */
    }
}

static bool set_channels(exr_writer *w, exr_encode_pipeline_t *encode) {
    for (int i = 0; i < encode->channel_count; i++) {
        exr_coding_channel_info_t *ch = &encode->channels[i];
        bool mask = strcmp(ch->channel_name, "emitter") == 0;
        char name = ch->channel_name[0];
        int k = name == 'R' || name == 'X' ? 0 : name == 'G' || name == 'Y' ? 1 : 2;
        ch->user_pixel_stride = mask ? 2 : 4 * components(w);
        ch->user_line_stride = ch->user_pixel_stride * w->width;
        ch->encode_from_ptr =
            mask ? (const uint8_t *)w->emitter : (const uint8_t *)(w->rgb + (components(w) == 1 ? 0 : k));
    }
    return true;
}

static void write_chunks(exr_writer *w) {
    int32_t lines = 0;
    if (!ok(w, exr_get_scanlines_per_chunk(w->context, w->part, &lines)))
        return;
    size_t n = (size_t)lines * (size_t)w->width;
    bool mask = w->image && w->image->emitter;
    w->rgb = noc_alloc_large(n, (size_t)components(w) * sizeof(float));
    w->emitter = mask ? noc_alloc_large(n, sizeof(uint16_t)) : NULL;
    bool zips = exr_zip_begin(&w->zip, n * ((size_t)components(w) * sizeof(float) + sizeof(uint16_t)));
    if (!w->rgb || (mask && !w->emitter) || !zips) {
        w->status = noc_error(w->log, NOC_ERR_MEMORY, "%s: EXR: no memory", w->out->path);
        return;
    }
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    bool good = true;
    for (int y = 0; good && y < w->height; y += lines) {
        exr_chunk_info_t chunk;
        good = ok(w, exr_write_scanline_chunk_info(w->context, w->part, y, &chunk));
        if (good && y == 0)
            good = ok(w, exr_encoding_initialize(w->context, w->part, &chunk, &encode)) && set_channels(w, &encode) &&
                   ok(w, exr_encoding_choose_default_routines(w->context, w->part, &encode));
        else if (good)
            good = ok(w, exr_encoding_update(w->context, w->part, &chunk, &encode)) && set_channels(w, &encode);
        if (good) {
            encode.compress_fn = exr_zip_chunk;
            encode.encoding_user_data = &w->zip;
            fill_chunk(w, y, chunk.height);
            good = ok(w, exr_encoding_run(w->context, w->part, &encode));
        }
    }
    encode.compressed_buffer = NULL; /* of the zip */
    if (encode.context)
        exr_encoding_destroy(w->context, &encode);
}

static noc_status write_file(exr_writer *w, const meta_list *meta) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.user_data = w;
    writing = w;
    init.write_fn = write_data;
    init.error_handler_fn = on_error;
    init.alloc_fn = noc_alloc;
    init.free_fn = free;
    if (ok(w, exr_start_write(&w->context, w->out->path, EXR_WRITE_FILE_DIRECTLY, &init)) && write_header(w, meta))
        write_chunks(w);
    /* Writes the table of chunks, also after an error: the temporary file goes away then. */
    if (w->context) {
        exr_result_t result = exr_finish(&w->context);
        ok(w, result);
    }
    writing = NULL;
    free(w->rgb);
    free(w->emitter);
    exr_zip_end(&w->zip);
    return w->status;
}

noc_status image_write_exr(output *o, const noc_image *image, const meta_list *meta, noc_log *log) {
    exr_writer w = { .out = o, .image = image, .width = image->width, .height = image->height, .log = log };
    return write_file(&w, meta);
}

noc_status image_write_exr_channel(output *o, const noc_channel *channel, const meta_list *meta, noc_log *log) {
    exr_writer w = { .out = o, .channel = channel, .width = channel->width, .height = channel->height, .log = log };
    return write_file(&w, meta);
}
