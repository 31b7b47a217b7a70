/* Pictures to files and back: PNG, OpenEXR, metadata, errors. */
#include "../files.h"

#include "image/internal.h"

#include <math.h>
#include <openexr.h>
#include <fcntl.h>
#include <png.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

static char folder[] = "/tmp/noc-image-XXXXXX";
static char warnings[4096];
static int error_count;

static void on_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level == NOC_LOG_WARN)
        snprintf(warnings, sizeof(warnings), "%s", text);
    error_count += level == NOC_LOG_ERROR;
}

static noc_log *log_;

static int set_up(void **state) {
    (void)state;
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    noc_log_destroy(log_);
    DIR *d = opendir(folder);
    for (struct dirent *e; d && (e = readdir(d));)
        unlinkat(dirfd(d), e->d_name, 0);
    if (d)
        closedir(d);
    return rmdir(folder);
}

static const char *in_folder(const char *name) {
    static char path[4][512];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof(path[turn]), "%s/%s", folder, name);
    return path[turn];
}

/* Values over many magnitudes, small negative ones too. */
static noc_image *random_image(int width, int height, bool mask) {
    noc_image *image = noc_image_create(width, height, log_);
    uint32_t s = 12345;
    for (size_t i = 0; i < 3 * image_pixels(image); i++) {
        s = s * 1664525u + 1013904223u;
        image->rgb[i] = exp2f((float)(s >> 8) / 16777216.f * 40 - 20) * (s & 64 ? 1 : -1e-3f);
    }
    if (mask) {
        assert_true(image_add_mask(image, log_));
        for (size_t i = 0; i < image_pixels(image); i++)
            image->emitter[i] = i % 7 == 0;
    }
    return image;
}

static void exr_keeps_every_bit(void **state) {
    (void)state;
    /* One chunk holds 16 lines: sizes below, at and beyond it. */
    static const int sizes[][2] = { { 1, 1 }, { 7, 16 }, { 33, 17 }, { 130, 71 } };
    for (size_t k = 0; k < NOC_COUNT(sizes); k++)
        for (int mask = 0; mask < 2; mask++) {
            noc_image *a = random_image(sizes[k][0], sizes[k][1], mask);
            assert_int_equal(noc_image_write(a, in_folder("a.EXR"), NULL, NULL, log_), NOC_OK);
            bool linear = false;
            noc_image *b = noc_image_read(in_folder("a.EXR"), log_, &linear);
            assert_non_null(b);
            assert_true(linear);
            assert_int_equal(b->width, a->width);
            assert_int_equal(b->height, a->height);
            assert_memory_equal(a->rgb, b->rgb, 3 * sizeof(float) * image_pixels(a));
            assert_int_equal(b->emitter != NULL, mask);
            if (mask)
                assert_memory_equal(a->emitter, b->emitter, image_pixels(a));
            noc_image_destroy(a);
            noc_image_destroy(b);
        }
}

/* Noise is packed by a quick way, of which the head of zlib's stream tells, what repeats is packed well, and a chunk
 * that does not shrink is as it was. */
static void exr_is_compressed_quickly(void **state) {
    (void)state;
    enum { EVEN, NOISE, BITS, KINDS };
    for (int k = 0; k < KINDS; k++) {
        noc_image *image = noc_image_create(64, 16, log_);
        uint64_t s = 1;
        for (size_t i = 0; i < 3 * image_pixels(image); i++) {
            s = s * 6364136223846793005u + 1442695040888963407u;
            uint32_t bits = (uint32_t)(s >> 32) & 0xbfffffff; /* finite */
            image->rgb[i] = k == EVEN ? 1 : (s >> 20) % 3 ? 1 + 0x1p-32f * (float)(s >> 32) : 0;
            if (k == BITS)
                memcpy(&image->rgb[i], &bits, sizeof(bits));
        }
        assert_int_equal(noc_image_write(image, in_folder("q.exr"), NULL, NULL, log_), NOC_OK);
        exr_context_t c;
        exr_chunk_info_t chunk;
        assert_int_equal(exr_start_read(&c, in_folder("q.exr"), NULL), EXR_ERR_SUCCESS);
        assert_int_equal(exr_read_scanline_chunk_info(c, 0, 0, &chunk), EXR_ERR_SUCCESS);
        uint8_t *bytes = test_malloc(chunk.packed_size);
        assert_int_equal(exr_read_chunk(c, 0, &chunk, bytes), EXR_ERR_SUCCESS);
        assert_int_equal(chunk.unpacked_size, 3 * sizeof(float) * image_pixels(image));
        assert_true(k == BITS || (bytes[0] & 15) == 8); /* RFC 1950: deflate */
        if (k == EVEN)
            assert_true(chunk.packed_size < chunk.unpacked_size / 50);
        else if (k == NOISE)
            assert_true(chunk.packed_size < chunk.unpacked_size && bytes[1] >> 6 == 0); /* by the fastest algorithm */
        else
            assert_int_equal(chunk.packed_size, chunk.unpacked_size);
        test_free(bytes);
        exr_finish(&c);
        noc_image *back = noc_image_read(in_folder("q.exr"), log_, NULL);
        assert_non_null(back);
        assert_memory_equal(back->rgb, image->rgb, 3 * sizeof(float) * image_pixels(image));
        noc_image_destroy(back);
        noc_image_destroy(image);
    }
}

static void png_is_within_quantisation(void **state) {
    (void)state;
    noc_image *a = noc_image_create(256, 3, log_);
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 256; x++)
            for (int k = 0; k < 3; k++)
                a->rgb[3 * (y * 256 + x) + k] = (float)(1.2 * srgb_decode((x + 0.3 * y) / 256.0) * (k == y ? 1 : 0.5));
    noc_display_params linear = { .ev100 = 0, .tonemap = NOC_TONEMAP_LINEAR };
    assert_int_equal(noc_image_write(a, in_folder("a.png"), &linear, NULL, log_), NOC_OK);
    bool is_linear = true;
    noc_image *b = noc_image_read(in_folder("a.png"), log_, &is_linear);
    assert_non_null(b);
    assert_false(is_linear);
    assert_true(b->ev100 == 0 && !*b->channel && isnan(a->ev100));
    for (size_t i = 0; i < 3 * image_pixels(a); i++)
        assert_true(fabs(srgb_encode(a->rgb[i] / 1.2) - srgb_encode(b->rgb[i])) <= 0.5 / 255 + 1e-6);
    noc_image_destroy(a);
    noc_image_destroy(b);
}

static void srgb8_survives(void **state) {
    (void)state;
    uint8_t rgb[16 * 16 * 3];
    for (size_t i = 0; i < sizeof(rgb); i++)
        rgb[i] = (uint8_t)i;
    assert_int_equal(noc_image_write_srgb8(rgb, 16, 16, in_folder("s.PNG"), NULL, log_), NOC_OK);
    noc_image *b = noc_image_read(in_folder("s.PNG"), log_, NULL);
    assert_non_null(b);
    for (size_t i = 0; i < sizeof(rgb); i++)
        assert_int_equal(lrint(255 * srgb_encode(b->rgb[i])), rgb[i]);
    noc_image_destroy(b);
}

static const char *text_of_png(const char *path, const char *key, bool *has_srgb) {
    static char text[256];
    text[0] = 0;
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    png_init_io(png, f);
    png_read_info(png, info);
    png_textp list = NULL;
    int n = 0, intent;
    png_get_text(png, info, &list, &n);
    for (int i = 0; i < n; i++)
        if (strcmp(list[i].key, key) == 0)
            snprintf(text, sizeof(text), "%s", list[i].text);
    *has_srgb = png_get_sRGB(png, info, &intent) != 0;
    png_destroy_read_struct(&png, &info, NULL);
    fclose(f);
    return text;
}

static const char *const keys[] = { "crs", "Comment", "Software" };
static const char *const values[] = { "EPSG:25832", "Straßenlaternen 夜", "mine" };
static const noc_image_meta meta = { 3, keys, values };

static void png_holds_metadata(void **state) {
    (void)state;
    noc_image *a = random_image(4, 4, false);
    noc_display_params display = { .ev100 = 2.5, .tonemap = NOC_TONEMAP_REINHARD };
    const char *path = in_folder("m.png");
    assert_int_equal(noc_image_write(a, path, &display, &meta, log_), NOC_OK);
    bool srgb = false;
    assert_string_equal(text_of_png(path, "crs", &srgb), "EPSG:25832");
    assert_true(srgb);
    assert_string_equal(text_of_png(path, "Comment", &srgb), values[1]);
    assert_string_equal(text_of_png(path, "Software", &srgb), "mine");
    assert_string_equal(text_of_png(path, "ev100", &srgb), "2.5000");
    assert_string_equal(text_of_png(path, "tonemap", &srgb), "reinhard");
    noc_image_destroy(a);
}

static const char *text_of_exr(exr_context_t c, const char *key) {
    const char *s = NULL;
    int32_t n = 0;
    assert_int_equal(exr_attr_get_string(c, 0, key, &n, &s), EXR_ERR_SUCCESS);
    return s;
}

static void exr_holds_units_and_metadata(void **state) {
    (void)state;
    noc_image *a = random_image(4, 4, true);
    const char *path = in_folder("m.exr");
    assert_int_equal(noc_image_write(a, path, NULL, &meta, log_), NOC_OK);
    exr_context_t c;
    assert_int_equal(exr_start_read(&c, path, NULL), EXR_ERR_SUCCESS);
    assert_string_equal(text_of_exr(c, "units"), "cd/m2");
    assert_string_equal(text_of_exr(c, "crs"), "EPSG:25832");
    assert_string_equal(text_of_exr(c, "Comment"), values[1]);
    assert_string_equal(text_of_exr(c, "Software"), "mine");
    float white = 0;
    exr_attr_chromaticities_t primaries;
    assert_int_equal(exr_attr_get_float(c, 0, "whiteLuminance", &white), EXR_ERR_SUCCESS);
    assert_true(white == 1);
    assert_int_equal(exr_attr_get_chromaticities(c, 0, "chromaticities", &primaries), EXR_ERR_SUCCESS);
    assert_true(primaries.red_x == 0.64f && primaries.white_y == 0.329f);
    exr_attr_v2f_t neutral;
    assert_int_equal(exr_attr_get_v2f(c, 0, "adoptedNeutral", &neutral), EXR_ERR_SUCCESS);
    assert_true(neutral.x == 0.3127f && neutral.y == 0.329f);
    const exr_attr_chlist_t *list;
    exr_compression_t compression;
    assert_int_equal(exr_get_channels(c, 0, &list), EXR_ERR_SUCCESS);
    assert_int_equal(exr_get_compression(c, 0, &compression), EXR_ERR_SUCCESS);
    assert_int_equal(compression, EXR_COMPRESSION_ZIP);
    assert_int_equal(list->num_channels, 4);
    assert_string_equal(list->entries[3].name.str, "emitter");
    exr_finish(&c);
    noc_image_destroy(a);
}

static void bad_metadata_is_refused(void **state) {
    (void)state;
    noc_image *a = random_image(2, 2, false);
    static const char *const bad[] = {
        "",
        " x",
        "x ",
        "a  b",
        "tab\t",
        "\xc3\xa4",
        "0123456789012345678901234567890123456789012345678901234567890123456789012345678901"
    };
    const char *value = "v";
    size_t before = files_in(folder);
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_image_write(a, in_folder("bad.png"), NULL, &(noc_image_meta){ 1, &bad[i], &value }, log_),
                         NOC_ERR_ARGUMENT);
    static const char *const taken[] = { "channels", "version", "tiles" };
    for (size_t i = 0; i < NOC_COUNT(taken); i++)
        assert_int_equal(noc_image_write(a, in_folder("bad.exr"), NULL, &(noc_image_meta){ 1, &taken[i], &value },
                                         log_),
                         NOC_ERR_ARGUMENT);
    assert_int_equal(files_in(folder), before);
    noc_image_destroy(a);
}

static void non_finite_never_reaches_a_file(void **state) {
    (void)state;
    noc_image *a = random_image(20, 20, false);
    a->rgb[3] = NAN;
    a->rgb[10] = INFINITY;
    warnings[0] = 0;
    assert_int_equal(noc_image_write(a, in_folder("n.exr"), NULL, NULL, log_), NOC_OK);
    assert_non_null(strstr(warnings, "2 of 400 pixels"));
    noc_image *b = noc_image_read(in_folder("n.exr"), log_, NULL);
    for (size_t i = 0; i < 3 * image_pixels(a); i++) {
        bool bad = (i >= 3 && i < 6) || (i >= 9 && i < 12);
        assert_true(b->rgb[i] == (bad ? 0 : a->rgb[i]));
    }
    noc_display_params display = { .ev100 = 0 };
    uint8_t shown[20 * 20 * 3];
    noc_image_to_srgb8(a, &display, shown);
    assert_int_equal(shown[3] | shown[4] | shown[5] | shown[9] | shown[10] | shown[11], 0);
    noc_image_destroy(a);
    noc_image_destroy(b);
}

static void one_error(noc_status got, noc_status expected, const char *part) {
    assert_int_equal(got, expected);
    assert_int_equal(error_count, 1);
    assert_non_null(strstr(noc_log_last_error(log_), part));
    error_count = 0;
}

static void writing_fails_once_and_leaves_nothing(void **state) {
    (void)state;
    noc_image *a = random_image(3, 3, false);
    size_t before = files_in(folder);
    error_count = 0;
    one_error(noc_image_write(a, in_folder("a.jpg"), NULL, NULL, log_), NOC_ERR_UNSUPPORTED, ".png or .exr");
    one_error(noc_image_write(a, "png", NULL, NULL, log_), NOC_ERR_UNSUPPORTED, ".png or .exr");
    one_error(noc_image_write(a, ".exr", NULL, NULL, log_), NOC_ERR_UNSUPPORTED, ".png or .exr");
    one_error(noc_image_write_srgb8((uint8_t[3]){ 0 }, 1, 1, in_folder("a.exr"), NULL, log_), NOC_ERR_UNSUPPORTED,
              "use .png");
    one_error(noc_image_write_srgb8((uint8_t[3]){ 0 }, 0, 1, in_folder("a.png"), NULL, log_), NOC_ERR_ARGUMENT,
              "0 x 1");
    one_error(noc_image_write(a, in_folder("missing/a.exr"), NULL, NULL, log_), NOC_ERR_IO, "No such file");
    one_error(noc_image_write(a, in_folder("missing/a.png"), NULL, NULL, log_), NOC_ERR_IO, "No such file");
    assert_int_equal(files_in(folder), before);
    mkdir(in_folder("d.png"), 0777);
    one_error(noc_image_write(a, in_folder("d.png"), NULL, NULL, log_), NOC_ERR_IO, "it is a directory");
    rmdir(in_folder("d.png"));
    assert_int_equal(symlink("/dev/full", in_folder("full.exr")), 0);
    one_error(noc_image_write(a, in_folder("full.exr"), NULL, NULL, log_), NOC_ERR_IO, "not a regular file");
    unlink(in_folder("full.exr"));
    assert_int_equal(files_in(folder), before);
    noc_image_destroy(a);
}

/* A failing disk: the stream of the temporary file is one that refuses every byte. */
static void a_full_disk_is_reported(void **state) {
    (void)state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    noc_image *a = random_image(64, 64, true);
    size_t before = files_in(folder);
    for (int exr = 0; exr < 2; exr++) {
        error_count = 0;
        output o;
        assert_int_equal(output_open(&o, in_folder(exr ? "f.exr" : "f.png"), log_), NOC_OK);
        o.file = freopen("/dev/full", "wb", o.file);
        assert_non_null(o.file);
        meta_list list = { 0 };
        uint8_t rgb[64 * 64 * 3] = { 0 };
        noc_status status = exr ? image_write_exr(&o, a, &list, log_) : image_write_png(&o, rgb, 64, 64, &list, log_);
        one_error(output_close(&o, status, log_), NOC_ERR_IO, "No space left");
        assert_int_equal(files_in(folder), before);
    }
    noc_image_destroy(a);
}

static void an_old_picture_survives_a_failure(void **state) {
    (void)state;
    noc_image *a = random_image(9, 9, false);
    assert_int_equal(noc_image_write(a, in_folder("old.exr"), NULL, NULL, log_), NOC_OK);
    output o;
    assert_int_equal(output_open(&o, in_folder("old.exr"), log_), NOC_OK);
    fputs("half of a picture", o.file);
    assert_int_equal(output_close(&o, NOC_ERR_CANCELLED, log_), NOC_ERR_CANCELLED);
    noc_image *b = noc_image_read(in_folder("old.exr"), log_, NULL);
    assert_non_null(b);
    assert_memory_equal(a->rgb, b->rgb, 3 * sizeof(float) * image_pixels(a));
    noc_image_destroy(a);
    noc_image_destroy(b);
}

static void make_file(const char *name) {
    FILE *f = fopen(in_folder(name), "w");
    fputs("half of a picture", f);
    fclose(f);
}

/* What a killed run left goes with the next picture of that name; what others write stays. */
static void leftovers_are_swept(void **state) {
    (void)state;
    static const char *const left[] = { ".swept.exr.1-0.part", ".swept.exr.999999-12.part" };
    static const char *const kept[] = { ".other.exr.1-0.part",  ".swept.exr.part",     ".swept.exr.1-.part",
                                        ".swept.exr.1-0.parts", ".swept.exr.x-0.part", "swept.exr.1-0.part",
                                        ".swept.exr.77-0.part" };
    noc_image *a = random_image(2, 2, false);
    for (size_t i = 0; i < NOC_COUNT(left); i++)
        make_file(left[i]);
    for (size_t i = 0; i < NOC_COUNT(kept); i++)
        make_file(kept[i]);
    int living = open(in_folder(kept[6]), O_RDWR); /* as a writer that lives holds it */
    assert_int_equal(flock(living, LOCK_EX), 0);
    /* before the work, as the program does */
    assert_int_equal(noc_image_check_path(in_folder("swept.exr"), log_), NOC_OK);
    for (size_t i = 0; i < NOC_COUNT(left); i++)
        assert_int_equal(access(in_folder(left[i]), F_OK), -1);
    for (size_t i = 0; i < NOC_COUNT(kept); i++)
        assert_int_equal(access(in_folder(kept[i]), F_OK), 0);
    output first, second; /* two writers of one name do not take each other's files */
    assert_int_equal(output_open(&first, in_folder("swept.exr"), log_), NOC_OK);
    assert_int_equal(output_open(&second, in_folder("swept.exr"), log_), NOC_OK);
    assert_int_equal(access(first.temporary, F_OK), 0);
    assert_int_equal(output_close(&second, NOC_OK, log_), NOC_OK);
    assert_int_equal(output_close(&first, NOC_OK, log_), NOC_OK);
    close(living);
    assert_int_equal(noc_image_write(a, in_folder("swept.exr"), NULL, NULL, log_), NOC_OK);
    assert_int_equal(access(in_folder(kept[6]), F_OK), -1);
    noc_image_destroy(a);
}

/* Another process that begins the same file again and again takes nothing from under this one. */
static void writers_of_one_name(void **state) {
    (void)state;
    enum { FILES = 400 };
    output o;
    pid_t self = getpid(), child = fork();
    while (child == 0) {
        if (!output_open(&o, in_folder("raced.exr"), NULL))
            output_close(&o, NOC_ERR_CANCELLED, NULL);
        if (getppid() != self)
            _exit(0); /* nobody is left to end it */
    }
    assert_true(child > 0);
    int failed = 0;
    for (int i = 0; i < FILES; i++)
        failed += output_open(&o, in_folder("raced.exr"), log_) || output_close(&o, NOC_OK, log_);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    assert_int_equal(failed, 0);
}

static void a_link_is_followed(void **state) {
    (void)state;
    noc_image *a = random_image(2, 2, false);
    assert_int_equal(noc_image_write(a, in_folder("real.exr"), NULL, NULL, log_), NOC_OK);
    assert_int_equal(symlink("real.exr", in_folder("link.exr")), 0);
    a->rgb[0] = 77;
    assert_int_equal(noc_image_write(a, in_folder("link.exr"), NULL, NULL, log_), NOC_OK);
    struct stat st;
    assert_int_equal(lstat(in_folder("link.exr"), &st), 0);
    assert_true(S_ISLNK(st.st_mode));
    noc_image *b = noc_image_read(in_folder("real.exr"), log_, NULL);
    assert_true(b->rgb[0] == 77);
    noc_image_destroy(a);
    noc_image_destroy(b);
}

/* A link to what is not there yet: that is made, in the link's folder, and the link stays. */
static void a_dangling_link_is_followed(void **state) {
    (void)state;
    noc_image *a = random_image(2, 2, false);
    assert_int_equal(mkdir(in_folder("sub"), 0777), 0);
    assert_int_equal(symlink("sub/second.exr", in_folder("first.exr")), 0);
    assert_int_equal(symlink("made.exr", in_folder("sub/second.exr")), 0);
    assert_int_equal(noc_image_write(a, in_folder("first.exr"), NULL, NULL, log_), NOC_OK);
    struct stat st;
    assert_int_equal(lstat(in_folder("first.exr"), &st), 0);
    assert_true(S_ISLNK(st.st_mode));
    assert_int_equal(lstat(in_folder("sub/second.exr"), &st), 0);
    assert_true(S_ISLNK(st.st_mode));
    assert_int_equal(lstat(in_folder("sub/made.exr"), &st), 0);
    assert_true(S_ISREG(st.st_mode));
    noc_image_destroy(a);
    unlink(in_folder("sub/made.exr"));
    unlink(in_folder("sub/second.exr"));
    rmdir(in_folder("sub"));
}

/* What a writer would fail on, asked before: the same errors, and nothing is left or changed. */
static void paths_are_checked_before(void **state) {
    (void)state;
    size_t before = files_in(folder);
    assert_int_equal(noc_image_check_path(in_folder("new.exr"), log_), NOC_OK);
    assert_int_equal(files_in(folder), before);
    FILE *f = fopen(in_folder("given.exr"), "w");
    fputs("old", f);
    fclose(f);
    assert_int_equal(noc_image_check_path(in_folder("given.exr"), log_), NOC_OK);
    struct stat st;
    assert_int_equal(stat(in_folder("given.exr"), &st), 0);
    assert_int_equal(st.st_size, 3);
    unlink(in_folder("given.exr"));
    char name[300];
    memset(name, 'x', sizeof(name));
    strcpy(name + 252, ".exr"); /* 256 bytes: one more than a name may have */
    one_error(noc_image_check_path(in_folder(name), log_), NOC_ERR_IO, "too long");
    assert_int_equal(noc_image_check_path(in_folder(name + 1), log_), NOC_OK);
    one_error(noc_image_check_path(in_folder("missing/a.exr"), log_), NOC_ERR_IO, "No such file");
    assert_int_equal(symlink("ring.exr", in_folder("ring.exr")), 0);
    one_error(noc_image_check_path(in_folder("ring.exr"), log_), NOC_ERR_IO, "symbolic links");
    unlink(in_folder("ring.exr"));
    assert_int_equal(files_in(folder), before);
}

static void reading_fails_once(void **state) {
    (void)state;
    error_count = 0;
    assert_null(noc_image_read(in_folder("missing.png"), log_, NULL));
    one_error(NOC_OK, NOC_OK, "No such file");
    assert_null(noc_image_read(folder, log_, NULL));
    one_error(NOC_OK, NOC_OK, "directory");
    FILE *f = fopen(in_folder("text.png"), "wb");
    fputs("this is not a picture", f);
    fclose(f);
    assert_null(noc_image_read(in_folder("text.png"), log_, NULL));
    one_error(NOC_OK, NOC_OK, "not a PNG, OpenEXR or Radiance HDR file");
    f = fopen(in_folder("empty.exr"), "wb");
    fclose(f);
    assert_null(noc_image_read(in_folder("empty.exr"), log_, NULL));
    one_error(NOC_OK, NOC_OK, "not a PNG, OpenEXR or Radiance HDR file");
}

static void sizes_are_checked(void **state) {
    (void)state;
    error_count = 0;
    assert_null(noc_image_create(0, 5, log_));
    one_error(NOC_OK, NOC_OK, "0 x 5");
    assert_null(noc_image_create(5, NOC_IMAGE_MAX_SIDE + 1, log_));
    one_error(NOC_OK, NOC_OK, "32769");
    noc_image_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_keeps_every_bit),
        cmocka_unit_test(exr_is_compressed_quickly),
        cmocka_unit_test(png_is_within_quantisation),
        cmocka_unit_test(srgb8_survives),
        cmocka_unit_test(png_holds_metadata),
        cmocka_unit_test(exr_holds_units_and_metadata),
        cmocka_unit_test(bad_metadata_is_refused),
        cmocka_unit_test(non_finite_never_reaches_a_file),
        cmocka_unit_test(writing_fails_once_and_leaves_nothing),
        cmocka_unit_test(a_full_disk_is_reported),
        cmocka_unit_test(an_old_picture_survives_a_failure),
        cmocka_unit_test(leftovers_are_swept),
        cmocka_unit_test(writers_of_one_name),
        cmocka_unit_test(a_link_is_followed),
        cmocka_unit_test(a_dangling_link_is_followed),
        cmocka_unit_test(paths_are_checked_before),
        cmocka_unit_test(reading_fails_once),
        cmocka_unit_test(sizes_are_checked),
    };
    return cmocka_run_group_tests_name("image files", tests, set_up, tear_down);
}
