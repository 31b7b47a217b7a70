/* Readers: every layout of PNG and OpenEXR that others write, and hostile files. */
#include "test.h"

#include "image/internal.h"

#include <math.h>
#include <openexr.h>
#include <png.h>

enum { W = 37, H = 21 };

typedef struct bytes {
    NOC_ARRAY(uint8_t) a;
} bytes;

static int errors;
static char error[300];
static void on_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level != NOC_LOG_ERROR)
        return;
    errors++;
    snprintf(error, sizeof(error), "%s", text);
}
static noc_log *log_;
static int set_up(void **state) {
    (void)state;
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = on_message });
    return log_ ? 0 : -1;
}
static int tear_down(void **state) {
    (void)state;
    noc_log_destroy(log_);
    return 0;
}

/* PNG of any kind. */
static void append(png_structp png, png_bytep data, png_size_t n) {
    bytes *b = png_get_io_ptr(png);
    assert_true(array_append(&b->a, data, n));
}
static void no_flush(png_structp png) { (void)png; }

static unsigned pattern(int x, int y, int channel, int depth) {
    return (unsigned)(x * 7 + y * 13 + channel * 29 + x * y * 257) & ((1u << depth) - 1);
}

static bytes make_png(int colour, int depth, bool interlaced) {
    bytes b = { 0 };
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &b, append, no_flush);
    png_set_IHDR(png, info, W, H, depth, colour, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
    if (colour == PNG_COLOR_TYPE_PALETTE) {
        png_color palette[256];
        png_byte alpha[256];
        for (int i = 0; i < 256; i++) {
            palette[i] = (png_color){ (png_byte)i, (png_byte)(255 - i), (png_byte)(i * 3) };
            alpha[i] = (png_byte)(i % 2 ? 255 : 128);
        }
        png_set_PLTE(png, info, palette, 1 << depth);
        png_set_tRNS(png, info, alpha, 1 << depth, NULL);
    }
    png_write_info(png, info);
    int channels = png_get_channels(png, info), passes = png_set_interlace_handling(png);
    png_set_packing(png); /* one byte a sample under 8 bits */
    for (int p = 0; p < passes; p++)
        for (int y = 0; y < H; y++) {
            uint8_t row[W * 4 * 2];
            for (int i = 0; i < W * channels; i++) {
                unsigned v = pattern(i / channels, y, i % channels, depth);
                if (depth == 16) {
                    row[2 * i] = (uint8_t)(v >> 8);
                    row[2 * i + 1] = (uint8_t)v;
                } else {
                    row[i] = (uint8_t)v;
                }
            }
            png_write_row(png, row);
        }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return b;
}

static void expected_png(int colour, int depth, int x, int y, double rgb[3]) {
    double top = (1 << depth) - 1, alpha = 1;
    bool grey = !(colour & PNG_COLOR_MASK_COLOR);
    if (colour == PNG_COLOR_TYPE_PALETTE) {
        unsigned i = pattern(x, y, 0, depth);
        double c[3] = { i, 255 - i, (uint8_t)(i * 3) };
        alpha = i % 2 ? 1 : 128 / 255.0;
        for (int k = 0; k < 3; k++)
            rgb[k] = srgb_decode(c[k] / 255) * alpha;
        return;
    }
    if (colour & PNG_COLOR_MASK_ALPHA)
        alpha = pattern(x, y, grey ? 1 : 3, depth) / top;
    for (int k = 0; k < 3; k++)
        rgb[k] = srgb_decode(pattern(x, y, grey ? 0 : k, depth) / top) * alpha;
}

static const int png_kinds[][2] = { { PNG_COLOR_TYPE_GRAY, 1 },        { PNG_COLOR_TYPE_GRAY, 2 },
                                    { PNG_COLOR_TYPE_GRAY, 4 },        { PNG_COLOR_TYPE_GRAY, 8 },
                                    { PNG_COLOR_TYPE_GRAY, 16 },       { PNG_COLOR_TYPE_GRAY_ALPHA, 8 },
                                    { PNG_COLOR_TYPE_GRAY_ALPHA, 16 }, { PNG_COLOR_TYPE_RGB, 8 },
                                    { PNG_COLOR_TYPE_RGB, 16 },        { PNG_COLOR_TYPE_RGBA, 8 },
                                    { PNG_COLOR_TYPE_RGBA, 16 },       { PNG_COLOR_TYPE_PALETTE, 1 },
                                    { PNG_COLOR_TYPE_PALETTE, 4 },     { PNG_COLOR_TYPE_PALETTE, 8 } };

static void every_kind_of_png(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(png_kinds); i++)
        for (int interlaced = 0; interlaced < 2; interlaced++) {
            int colour = png_kinds[i][0], depth = png_kinds[i][1];
            bytes b = make_png(colour, depth, interlaced);
            bool linear = true;
            noc_image *a = image_read_memory(b.a.data, b.a.len, "kind.png", log_, &linear);
            assert_non_null(a);
            assert_false(linear);
            for (int y = 0; y < H; y++)
                for (int x = 0; x < W; x++) {
                    double rgb[3];
                    expected_png(colour, depth, x, y, rgb);
                    for (int k = 0; k < 3; k++)
                        assert_true(fabs(a->rgb[3 * (y * W + x) + k] - rgb[k]) < 1e-5);
                }
            noc_image_destroy(a);
            array_free(&b.a);
        }
}

/* OpenEXR of any kind, through its C core. */
typedef struct exr_kind {
    exr_pixel_type_t type;
    exr_compression_t compression;
    int tile;             /* 0: scanlines */
    const char *channels; /* one letter each, 'e' for emitter, in the order of the alphabet */
} exr_kind;

static int64_t put(exr_const_context_t c, void *user, const void *data, uint64_t n, uint64_t at,
                   exr_stream_error_func_ptr_t e) {
    (void)c;
    (void)e;
    bytes *b = user;
    if (at + n > b->a.len) {
        assert_true(array_reserve(&b->a, at + n));
        memset(b->a.data + b->a.len, 0, at + n - b->a.len);
        b->a.len = at + n;
    }
    memcpy(b->a.data + at, data, n);
    return (int64_t)n;
}

static float exr_value(int x, int y, char channel) {
    if (channel == 'e')
        return (x + y) % 3 == 0;
    return (float)((x * 5 + y * 11 + channel) % 64); /* exact as half, float and uint */
}

#define EXR_OK(call) assert_int_equal((call), EXR_ERR_SUCCESS)

static void exr_chunk(exr_context_t c, const exr_kind *kind, const exr_chunk_info_t *chunk, int x0, int y0) {
    static float pixels[16][W * 64];
    size_t width = (size_t)chunk->width, channels = strlen(kind->channels);
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    EXR_OK(exr_encoding_initialize(c, 0, chunk, &encode));
    assert_int_equal((size_t)encode.channel_count, channels);
    for (size_t k = 0; k < channels; k++) {
        assert_true(width * (size_t)chunk->height <= NOC_COUNT(pixels[0]));
        for (int y = 0; y < chunk->height; y++)
            for (int x = 0; x < chunk->width; x++) {
                float v = exr_value(x0 + x, y0 + y, kind->channels[k]);
                uint32_t u = (uint32_t)v;
                if (kind->type == EXR_PIXEL_UINT)
                    memcpy(&pixels[k][(size_t)y * width + (size_t)x], &u, 4);
                else
                    pixels[k][(size_t)y * width + (size_t)x] = v;
            }
        encode.channels[k].user_data_type = kind->type == EXR_PIXEL_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
        encode.channels[k].user_bytes_per_element = 4;
        encode.channels[k].user_pixel_stride = 4;
        encode.channels[k].user_line_stride = 4 * chunk->width;
        encode.channels[k].encode_from_ptr = (const uint8_t *)pixels[k];
    }
    EXR_OK(exr_encoding_choose_default_routines(c, 0, &encode));
    EXR_OK(exr_encoding_run(c, 0, &encode));
    EXR_OK(exr_encoding_destroy(c, &encode));
}

static bytes make_exr(const exr_kind *kind, int x0, int y0) {
    bytes b = { 0 };
    exr_context_t c;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.user_data = &b;
    init.write_fn = put;
    int part;
    EXR_OK(exr_start_write(&c, "memory", EXR_WRITE_FILE_DIRECTLY, &init));
    EXR_OK(exr_add_part(c, NULL, kind->tile ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &part));
    exr_attr_box2i_t window = { .min = { .x = x0, .y = y0 }, .max = { .x = x0 + W - 1, .y = y0 + H - 1 } };
    EXR_OK(exr_initialize_required_attr(c, 0, &window, &window, 1, &(exr_attr_v2f_t){ 0 }, 1,
                                        EXR_LINEORDER_INCREASING_Y, kind->compression));
    if (kind->tile)
        EXR_OK(exr_set_tile_descriptor(c, 0, (uint32_t)kind->tile, (uint32_t)kind->tile, EXR_TILE_ONE_LEVEL,
                                       EXR_TILE_ROUND_DOWN));
    for (const char *ch = kind->channels; *ch; ch++)
        EXR_OK(exr_add_channel(c, 0, *ch == 'e' ? "emitter" : (char[2]){ *ch, 0 }, kind->type, EXR_PERCEPTUALLY_LINEAR,
                               1, 1));
    EXR_OK(exr_write_header(c));
    exr_chunk_info_t chunk;
    int32_t lines = 1;
    if (!kind->tile)
        EXR_OK(exr_get_scanlines_per_chunk(c, 0, &lines));
    for (int y = 0; !kind->tile && y < H; y += lines) {
        EXR_OK(exr_write_scanline_chunk_info(c, 0, y0 + y, &chunk));
        exr_chunk(c, kind, &chunk, 0, y);
    }
    for (int y = 0; kind->tile && y < H; y += kind->tile)
        for (int x = 0; x < W; x += kind->tile) {
            EXR_OK(exr_write_tile_chunk_info(c, 0, x / kind->tile, y / kind->tile, 0, 0, &chunk));
            exr_chunk(c, kind, &chunk, x, y);
        }
    EXR_OK(exr_finish(&c));
    return b;
}

static const exr_kind exr_kinds[] = {
    { EXR_PIXEL_FLOAT, EXR_COMPRESSION_NONE, 0, "BGR" }, { EXR_PIXEL_HALF, EXR_COMPRESSION_NONE, 0, "ABGR" },
    { EXR_PIXEL_UINT, EXR_COMPRESSION_NONE, 0, "BGR" },  { EXR_PIXEL_FLOAT, EXR_COMPRESSION_RLE, 0, "BGRe" },
    { EXR_PIXEL_HALF, EXR_COMPRESSION_ZIPS, 0, "Y" },    { EXR_PIXEL_UINT, EXR_COMPRESSION_ZIP, 0, "BGRe" },
    { EXR_PIXEL_HALF, EXR_COMPRESSION_PIZ, 0, "BGR" },   { EXR_PIXEL_FLOAT, EXR_COMPRESSION_PIZ, 0, "ABGRZ" },
    { EXR_PIXEL_HALF, EXR_COMPRESSION_PXR24, 0, "BGR" }, { EXR_PIXEL_FLOAT, EXR_COMPRESSION_ZIP, 16, "BGR" },
    { EXR_PIXEL_HALF, EXR_COMPRESSION_NONE, 8, "BGRe" }, { EXR_PIXEL_FLOAT, EXR_COMPRESSION_NONE, 64, "Ye" },
    { EXR_PIXEL_HALF, EXR_COMPRESSION_RLE, 1, "BGR" },   { EXR_PIXEL_HALF, EXR_COMPRESSION_B44, 0, "BGR" },
    { EXR_PIXEL_HALF, EXR_COMPRESSION_PIZ, 16, "BGR" },
};

static void every_kind_of_exr(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(exr_kinds); i++) {
        const exr_kind *kind = &exr_kinds[i];
        /* The data window may begin anywhere, left of and above the origin too. */
        bytes b = make_exr(kind, i % 2 ? -5 : 0, i % 3 ? 7 : -3);
        bool linear = false;
        noc_image *a = image_read_memory(b.a.data, b.a.len, "kind.exr", log_, &linear);
        assert_non_null(a);
        assert_true(linear);
        assert_int_equal(a->width, W);
        assert_int_equal(a->height, H);
        bool grey = strchr(kind->channels, 'Y') != NULL;
        assert_int_equal(a->emitter != NULL, strchr(kind->channels, 'e') != NULL);
        /* B44 keeps 4 x 4 blocks of half in 14 bytes: lossy. */
        double tolerance = kind->compression == EXR_COMPRESSION_B44 ? 4 : 0;
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                for (int k = 0; k < 3; k++)
                    assert_true(fabs(a->rgb[3 * (y * W + x) + k] - exr_value(x, y, grey ? 'Y' : "RGB"[k])) <=
                                tolerance);
                if (a->emitter)
                    assert_int_equal(a->emitter[y * W + x], (x + y) % 3 == 0);
            }
        noc_image_destroy(a);
        array_free(&b.a);
    }
}

static void missing_channels_are_an_error(void **state) {
    (void)state;
    exr_kind kind = { EXR_PIXEL_HALF, EXR_COMPRESSION_ZIP, 0, "BGZ" };
    bytes b = make_exr(&kind, 0, 0);
    errors = 0;
    assert_null(image_read_memory(b.a.data, b.a.len, "odd.exr", log_, NULL));
    assert_int_equal(errors, 1);
    assert_non_null(strstr(noc_log_last_error(log_), "odd.exr: EXR: has neither channels R, G, B nor Y"));
    array_free(&b.a);
}

static void put_attribute(bytes *b, const char *name, const char *type, const void *data, uint32_t size) {
    const uint8_t length[4] = { (uint8_t)size, (uint8_t)(size >> 8), (uint8_t)(size >> 16), (uint8_t)(size >> 24) };
    assert_true(array_append(&b->a, (const uint8_t *)name, strlen(name) + 1));
    assert_true(array_append(&b->a, (const uint8_t *)type, strlen(type) + 1));
    assert_true(array_append(&b->a, length, sizeof(length)));
    assert_true(array_append(&b->a, (const uint8_t *)data, size));
}

/* What the beginning of a file with so many channels, or attributes, or parts of a few each, is refused for. */
static void refused_for(int channels, int attributes, int parts, const char *why) {
    static const uint8_t head[2][8] = { { 0x76, 0x2f, 0x31, 1, 2, 0, 0, 0 }, { 0x76, 0x2f, 0x31, 1, 2, 0x10, 0, 0 } };
    bytes b = { 0 }, list = { 0 };
    for (int i = 0; i <= channels; i++) {
        char entry[24] = { 0 }; /* the last one ends the list */
        if (i < channels)
            snprintf(entry, sizeof(entry), "x%06d", i);
        entry[8] = entry[16] = entry[20] = 1;
        size_t size = i < channels ? sizeof(entry) : 1;
        assert_true(array_append(&list.a, (uint8_t *)entry, size));
    }
    assert_true(array_append(&b.a, head[parts > 1], sizeof(head[0])));
    for (int part = 0; part < parts; part++) {
        put_attribute(&b, "channels", "chlist", list.a.data, (uint32_t)list.a.len);
        for (int i = 1; i < attributes; i++) {
            char name[20];
            snprintf(name, sizeof(name), "a%06d", i);
            put_attribute(&b, name, "int", &i, sizeof(i));
        }
        assert_true(array_push(&b.a, 0));
    }
    assert_true(array_push(&b.a, 0));
    errors = 0;
    assert_null(image_read_memory(b.a.data, b.a.len, "much.exr", log_, NULL));
    assert_int_equal(errors, 1);
    assert_true((strstr(error, "more than") != NULL) == (why != NULL) && (!why || strstr(error, why)));
    array_free(&b.a);
    array_free(&list.a);
}

static void long_headers_are_errors(void **state) {
    (void)state;
    refused_for(1024, 4, 1, NULL); /* other attributes are missing */
    refused_for(1025, 4, 1, "more than 1024 channels");
    refused_for(3, 4096, 1, NULL);
    refused_for(3, 4097, 1, "more than 4096 attributes");
    refused_for(3, 5, 1000, "more than 4096 attributes");
    refused_for(3, 5, 100, NULL);
}

static void one_result(const uint8_t *data, size_t n) {
    errors = 0;
    noc_image *a = image_read_memory(data, n, "hostile", log_, NULL);
    assert_int_equal(errors, a ? 0 : 1);
    noc_image_destroy(a);
}

/* A file cut anywhere is an error, never a picture: whatever is missing. */
static void cut_files_are_errors(void **state) {
    (void)state;
    bytes files[3] = { make_png(PNG_COLOR_TYPE_RGB, 8, false), make_png(PNG_COLOR_TYPE_PALETTE, 4, true),
                       make_exr(&(exr_kind){ EXR_PIXEL_FLOAT, EXR_COMPRESSION_ZIP, 0, "BGRe" }, 0, 0) };
    for (size_t k = 0; k < NOC_COUNT(files); k++) {
        for (size_t n = 0; n < files[k].a.len; n += k == 2 && n > 700 ? 7 : 1) {
            uint8_t *copy = noc_alloc(n); /* its own block, so that ASan sees a read beyond it */
            memcpy(copy, files[k].a.data, n);
            errors = 0;
            assert_null(image_read_memory(copy, n, "cut", log_, NULL));
            assert_int_equal(errors, 1);
            free(copy);
        }
        array_free(&files[k].a);
    }
}

static uint32_t seed = 99;
static uint32_t next(uint32_t n) {
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)seed * n) >> 32);
}

/* Checksums hide everything behind them from plain mutations: libpng is told elsewhere, here they are mended. */
static void mend_png(uint8_t *data, size_t n) {
    for (size_t at = 8; at + 12 <= n;) {
        uint32_t length =
            (uint32_t)data[at] << 24 | (uint32_t)data[at + 1] << 16 | (uint32_t)data[at + 2] << 8 | data[at + 3];
        if (length > n - at - 12)
            return;
        uint32_t crc = 0xffffffffu;
        for (size_t i = at + 4; i < at + 8 + length; i++) {
            crc ^= data[i];
            for (int k = 0; k < 8; k++)
                crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
        }
        crc = ~crc;
        for (int k = 0; k < 4; k++)
            data[at + 8 + length + (size_t)k] = (uint8_t)(crc >> (24 - 8 * k));
        at += length + 12;
    }
}

static void mutate(const bytes *from, bool png) {
    size_t n = from->a.len - (next(8) == 0 ? next((uint32_t)from->a.len) : 0);
    uint8_t *data = noc_alloc(n);
    memcpy(data, from->a.data, n);
    static const uint8_t odd[] = { 0, 1, 0x7f, 0x80, 0xff };
    for (uint32_t k = 1 + next(6); k > 0 && n > 16; k--) {
        /* Half of them in the head, where sizes and types are. */
        size_t at = 4 + next((uint32_t)(next(2) ? NOC_MIN(n, 400) - 4 : n - 4));
        data[at] = next(3) ? (uint8_t)next(256) : odd[next(NOC_COUNT(odd))];
    }
    if (png && next(4))
        mend_png(data, n);
    one_result(data, n);
    free(data);
}

static void mutated_files_end_in_one_error_or_a_picture(void **state) {
    (void)state;
    const char *rounds = getenv("NOC_FUZZ_ROUNDS");
    int n = rounds ? atoi(rounds) : 100;
    for (size_t i = 0; i < NOC_COUNT(png_kinds); i++) {
        bytes b = make_png(png_kinds[i][0], png_kinds[i][1], i % 2);
        for (int k = 0; k < n; k++)
            mutate(&b, true);
        array_free(&b.a);
    }
    for (size_t i = 0; i < NOC_COUNT(exr_kinds); i++) {
        bytes b = make_exr(&exr_kinds[i], 0, 0);
        for (int k = 0; k < n; k++)
            mutate(&b, false);
        array_free(&b.a);
    }
}

/* Declared sizes are not believed: no memory is asked for what the file cannot hold. */
static void huge_sizes_are_errors(void **state) {
    (void)state;
    bytes b = make_png(PNG_COLOR_TYPE_RGB, 8, false);
    static const uint8_t sides[][4] = { { 0x00, 0x00, 0x80, 0x00 },
                                        { 0x7f, 0xff, 0xff, 0xff },
                                        { 0xff, 0xff, 0xff, 0xff } };
    for (size_t i = 0; i < NOC_COUNT(sides); i++) {
        memcpy(b.a.data + 16, sides[i], 4);
        memcpy(b.a.data + 20, sides[i], 4);
        mend_png(b.a.data, b.a.len);
        errors = 0;
        assert_null(image_read_memory(b.a.data, b.a.len, "huge.png", log_, NULL));
        assert_int_equal(errors, 1);
    }
    array_free(&b.a);
    b = make_exr(&exr_kinds[0], 0, 0);
    for (size_t at = 0; at + 32 < b.a.len; at++)
        if (memcmp(b.a.data + at, "dataWindow", 11) == 0) {
            int32_t side[2] = { 32767, 32767 };
            memcpy(b.a.data + at + 11 + 6 + 4 + 8, side, sizeof(side));
        }
    errors = 0;
    assert_null(image_read_memory(b.a.data, b.a.len, "huge.exr", log_, NULL));
    assert_int_equal(errors, 1);
    array_free(&b.a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_png),
        cmocka_unit_test(every_kind_of_exr),
        cmocka_unit_test(missing_channels_are_an_error),
        cmocka_unit_test(cut_files_are_errors),
        cmocka_unit_test(huge_sizes_are_errors),
        cmocka_unit_test(long_headers_are_errors),
        cmocka_unit_test(mutated_files_end_in_one_error_or_a_picture),
    };
    return cmocka_run_group_tests_name("image read", tests, set_up, tear_down);
}
