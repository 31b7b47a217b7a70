/* PNG by libpng: 8-bit sRGB is written; every colour type and depth is read, as sRGB. */
#include "image/internal.h"

#include <png.h>
#include <setjmp.h>
#include <zlib.h>

typedef struct png_job {
    png_structp png;
    png_infop info;
    jmp_buf escape;   /* where libpng's errors go */
    const char *name; /* for messages */
    noc_log *log;
    noc_status status;
    output *out;         /* writing: into a file, */
    byte_buffer *to;     /* or into memory */
    const uint8_t *data; /* reading */
    size_t size, at;
    noc_image *image;
    pixel_bytes *bytes; /* where 8-bit pixels are asked for, in place of an image */
    int cutoff;         /* and of them those of a smaller alpha are holes */
    bool refused;       /* memory, to libpng, which does without it where it can */
    png_byte *buffer;   /* one row, or all of an interlaced picture */
    float *table;       /* code value to linear */
} png_job;

static void on_error(png_structp png, png_const_charp message) {
    png_job *job = png_get_error_ptr(png);
    if (job->status == NOC_OK)
        job->status = job->refused ? noc_no_memory(job->log, job->name)
                                   : noc_error(job->log, NOC_ERR_FORMAT, "%s: PNG: %s", job->name, message);
    longjmp(job->escape, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    png_job *job = png_get_error_ptr(png);
    noc_debug(job->log, "%s: PNG: %s", job->name, message);
}

static png_voidp on_alloc(png_structp png, png_alloc_size_t size) {
    png_job *job = png_get_mem_ptr(png);
    void *p = noc_alloc(size);
    job->refused = job->refused || !p;
    return p;
}

static void on_free(png_structp png, png_voidp p) { free(p); }

/* What libpng did without may be a part of the picture, or of its metadata. */
static void check_refused(png_job *job) {
    if (job->refused && job->status == NOC_OK)
        job->status = noc_no_memory(job->log, job->name);
}

static void write_data(png_structp png, png_bytep data, png_size_t size) {
    png_job *job = png_get_io_ptr(png);
    if (job->to && array_append(job->to, data, size))
        return;
    job->refused = job->to;
    if (job->to)
        png_error(png, "no memory");
    if (fwrite(data, 1, size, job->out->file) == size)
        return;
    job->status = output_failed(job->out, job->log);
    png_error(png, "writing failed");
}

static void flush_data(png_structp png) { (void)png; }

static void read_data(png_structp png, png_bytep data, png_size_t size) {
    png_job *job = png_get_io_ptr(png);
    if (size > job->size - job->at) {
        job->status =
            noc_error(job->log, NOC_ERR_FORMAT, "%s: PNG: the file ends too early, at byte %zu", job->name, job->size);
        png_error(png, "end of file");
    }
    memcpy(data, job->data + job->at, size);
    job->at += size;
}

static bool is_ascii(const char *s) {
    for (; *s; s++)
        if ((unsigned char)*s > 126)
            return false;
    return true;
}

/* tEXt is Latin-1, iTXt UTF-8: plain ASCII goes into the one that every program reads. */
static void set_text(png_job *job, const meta_list *meta) {
    for (size_t i = 0; i < meta->entries.len; i++) {
        const meta_entry *e = &meta->entries.data[i];
        png_text text = { .key = (char *)(uintptr_t)e->key, .text = (char *)(uintptr_t)e->value };
        text.compression = is_ascii(e->value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        png_set_text(job->png, job->info, &text, 1);
    }
}

/* fast: for who waits for the picture rather than for the file. Of libpng's filters and zlib's strategies, differences
 * from the mean of left and above, with repeated bytes alone as matches, give the smallest file of those that take half
 * of the time of level 1. */
static noc_status write_rows(png_job *job, const uint8_t *rgb, int width, int height, const meta_list *meta,
                             bool fast) {
    job->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, job, on_error, on_warning, job, on_alloc, on_free);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    if (!job->info) {
        png_destroy_write_struct(&job->png, NULL);
        return noc_no_memory(job->log, job->name);
    }
    if (setjmp(job->escape) == 0) {
        png_set_write_fn(job->png, job, write_data, flush_data);
        png_set_IHDR(job->png, job->info, (png_uint_32)width, (png_uint_32)height, 8, PNG_COLOR_TYPE_RGB,
                     PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_set_sRGB_gAMA_and_cHRM(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
        if (fast) {
            png_set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_AVG);
            png_set_compression_level(job->png, 1);
            png_set_compression_strategy(job->png, Z_RLE);
        }
        set_text(job, meta);
        png_write_info(job->png, job->info);
        for (int y = 0; y < height; y++)
            png_write_row(job->png, rgb + (size_t)y * (size_t)width * 3);
        png_write_end(job->png, NULL);
    }
    png_destroy_write_struct(&job->png, &job->info);
    check_refused(job);
    return job->status;
}

noc_status image_write_png(output *o, const uint8_t *rgb, int width, int height, const meta_list *meta, noc_log *log) {
    return write_rows(&(png_job){ .name = o->path, .log = log, .out = o }, rgb, width, height, meta, false);
}

noc_status image_encode_png(byte_buffer *to, const uint8_t *rgb, int width, int height, noc_log *log) {
    to->len = 0;
    return write_rows(&(png_job){ .name = "PNG", .log = log, .to = to }, rgb, width, height, &(meta_list){ 0 }, true);
}

/* Everything becomes RGBA of 8 or 16 bits, in the machine's byte order. */
static int set_transforms(png_job *job) {
    int depth = png_get_bit_depth(job->png, job->info), colour = png_get_color_type(job->png, job->info);
    png_set_expand(job->png); /* palettes, 1 to 4 bits, tRNS */
    if (!(colour & PNG_COLOR_MASK_COLOR))
        png_set_gray_to_rgb(job->png);
    png_set_add_alpha(job->png, 0xffff, PNG_FILLER_AFTER); /* where there is none yet */
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    if (depth == 16)
        png_set_swap(job->png);
#endif
    return depth == 16 ? 16 : 8;
}

/* Linear values of all codes. */
static float *decode_table(int depth) {
    int codes = 1 << depth;
    float *table = noc_alloc((size_t)codes * sizeof(float));
    for (int i = 0; table && i < codes; i++)
        table[i] = (float)srgb_decode((double)i / (codes - 1));
    return table;
}

/* Over black: colour times alpha, in linear light. */
static void store_row(float *rgb, const png_byte *row, int width, int depth, const float *table) {
    float opaque = (float)((1 << depth) - 1);
    for (size_t x = 0; x < (size_t)width; x++) {
        uint16_t v[4];
        if (depth == 16)
            memcpy(v, row + 8 * x, sizeof(v));
        else
            for (int k = 0; k < 4; k++)
                v[k] = row[4 * x + (size_t)k];
        for (int k = 0; k < 3; k++)
            rgb[3 * x + (size_t)k] = table[v[k]] * ((float)v[3] / opaque);
    }
}

/* Deflate packs 1032 to 1 at most: a file that cannot hold its picture is known before any memory is given to it. */
static bool plausible(png_job *job) {
    double packed = (double)png_get_rowbytes(job->png, job->info) * png_get_image_height(job->png, job->info);
    if (packed / 1032 <= (double)job->size)
        return true;
    job->status =
        noc_error(job->log, NOC_ERR_FORMAT, "%s: PNG: %u x %u pixels cannot be in a file of %zu bytes", job->name,
                  png_get_image_width(job->png, job->info), png_get_image_height(job->png, job->info), job->size);
    return false;
}

static uint8_t byte_of(const png_byte *row, size_t channel, int depth) {
    uint16_t v;
    if (depth != 16)
        return row[channel];
    memcpy(&v, row + 2 * channel, sizeof(v));
    return (uint8_t)(v / 257);
}

/* The colour, whatever shines through it, and where that is a hole. */
static void store_bytes(const png_job *job, int y, const png_byte *row, int depth) {
    size_t width = (size_t)job->bytes->width, first = (size_t)y * width;
    for (size_t x = 0; x < width; x++) {
        for (size_t k = 0; k < 3; k++)
            job->bytes->rgb[3 * (first + x) + k] = byte_of(row, 4 * x + k, depth);
        if (job->bytes->holes)
            job->bytes->holes[first + x] = byte_of(row, 4 * x + 3, depth) < job->cutoff;
    }
}

/* What Nocturne's writers tell of a picture, before its pixels. */
static void read_texts(png_job *job) {
    png_textp texts = NULL;
    int count = 0;
    png_get_text(job->png, job->info, &texts, &count);
    for (int i = 0; i < count; i++) {
        double ev100;
        if (!texts[i].text)
            continue;
        if (!strcmp(texts[i].key, "channel"))
            noc_snprintf(job->image->channel, sizeof(job->image->channel), "%s", texts[i].text);
        else if (!strcmp(texts[i].key, "smoothed"))
            job->image->smoothed = true;
        else if (!strcmp(texts[i].key, "ev100") && noc_parse_double(texts[i].text, &ev100))
            job->image->ev100 = ev100;
    }
}

static bool make_room(png_job *job, int width, int height, int depth) {
    if (job->bytes) {
        if (width != job->bytes->width || height != job->bytes->height)
            png_error(job->png, "two heads");
        job->bytes->rgb = noc_alloc_large((size_t)width * (size_t)height, 3);
        bool holes = job->bytes->rgb && job->cutoff;
        job->bytes->holes = holes ? noc_alloc_large((size_t)width * (size_t)height, 1) : NULL;
        if (!job->bytes->rgb || (holes && !job->bytes->holes))
            job->status = noc_no_memory(job->log, job->name);
        return job->status == NOC_OK;
    }
    job->image = noc_image_create(width, height, job->log);
    if (!job->image) {
        job->status = NOC_ERR_MEMORY;
        return false;
    }
    read_texts(job);
    job->table = decode_table(depth);
    if (!job->table)
        job->status = noc_no_memory(job->log, job->name);
    return job->table;
}

/* libpng may jump out of here, so what must be freed is kept in the job. */
static void read_pixels(png_job *job) {
    png_set_read_fn(job->png, job, read_data);
    png_set_user_limits(job->png, NOC_IMAGE_MAX_SIDE, NOC_IMAGE_MAX_SIDE);
    png_set_chunk_malloc_max(job->png, 64u << 20);
    png_set_chunk_cache_max(job->png, 256);
    png_read_info(job->png, job->info);
    if (!plausible(job))
        return;
    int width = (int)png_get_image_width(job->png, job->info), height = (int)png_get_image_height(job->png, job->info);
    int depth = set_transforms(job);
    int passes = png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    size_t row_bytes = png_get_rowbytes(job->png, job->info), rows = passes > 1 ? (size_t)height : 1;
    if (row_bytes != (size_t)width * 4 * (size_t)(depth / 8))
        png_error(job->png, "unexpected layout of a row");
    if (!make_room(job, width, height, depth))
        return;
    job->buffer = noc_alloc_large(rows, row_bytes);
    if (!job->buffer) {
        job->status = noc_error(job->log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", job->name, width, height);
        return;
    }
    /* An interlaced picture is whole only after its last pass: its rows are kept until then. */
    for (int pass = 0; pass < passes - 1; pass++)
        for (size_t y = 0; y < rows; y++)
            png_read_row(job->png, job->buffer + y * row_bytes, NULL);
    for (int y = 0; y < height; y++) {
        png_byte *row = job->buffer + (rows > 1 ? (size_t)y : 0) * row_bytes;
        png_read_row(job->png, row, NULL);
        if (job->bytes)
            store_bytes(job, y, row, depth);
        else
            store_row(job->image->rgb + (size_t)y * (size_t)width * 3, row, width, depth, job->table);
    }
    png_read_end(job->png, NULL);
}

static noc_status read_all(png_job *job) {
    job->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, job, on_error, on_warning, job, on_alloc, on_free);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    if (!job->info) {
        png_destroy_read_struct(&job->png, NULL, NULL);
        return noc_no_memory(job->log, job->name);
    }
    if (setjmp(job->escape) == 0)
        read_pixels(job);
    png_destroy_read_struct(&job->png, &job->info, NULL);
    check_refused(job);
    free(job->buffer);
    free(job->table);
    return job->status;
}

noc_status image_read_png8(const uint8_t *data, size_t size, const char *name, int cutoff, noc_log *log,
                           pixel_bytes *out) {
    png_job job = { .name = name, .log = log, .data = data, .size = size, .bytes = out, .cutoff = cutoff };
    noc_status status = read_all(&job);
    if (out->holes && !memchr(out->holes, 1, (size_t)out->width * (size_t)out->height)) {
        free(out->holes);
        out->holes = NULL;
    }
    return status;
}

noc_image *image_read_png(const uint8_t *data, size_t size, const char *name, noc_log *log) {
    png_job job = { .name = name, .log = log, .data = data, .size = size };
    job.status = read_all(&job);
    if (job.status != NOC_OK) {
        noc_image_destroy(job.image);
        return NULL;
    }
    return job.image;
}
