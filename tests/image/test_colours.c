/* What OpenEXR files say of their colours, their layers and their parts: to one picture, or one error. The numbers to
 * be met are published ones: IEC 61966-2-1, ITU-R BT.2087, the Academy's matrices, Lindbloom's for D50. */
#include "test.h"

#include "image/internal.h"

#include <math.h>

enum { RED = 0, GREEN = 2, BLUE = 4, WHITE = 6 };

static char error[1024];
static int errors;
static void hear(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level == NOC_LOG_ERROR) {
        errors++;
        snprintf(error, sizeof(error), "%s", text);
    }
}

/* A file by hand: rows of floats, as it is, so that it may say what no writer would. */
typedef struct file {
    uint8_t data[8192];
    size_t size;
} file;

static void add(file *f, const void *bytes, size_t n) {
    assert_true(f->size + n <= sizeof(f->data));
    memcpy(f->data + f->size, bytes, n);
    f->size += n;
}
static void add_int(file *f, int32_t v) { add(f, &v, sizeof(v)); }

static void attribute(file *f, const char *name, const char *type, const void *data, size_t size) {
    add(f, name, strlen(name) + 1);
    add(f, type, strlen(type) + 1);
    add_int(f, (int32_t)size);
    add(f, data, size);
}

/* channels: "A B C", in the order of the alphabet. */
static int add_channels(file *f, const char *channels) {
    file list = { .size = 0 };
    int count = 0;
    for (const char *c = channels; *c; count++) {
        size_t n = strcspn(c, " ");
        add(&list, c, n);
        add(&list, "", 1);
        const int32_t rest[4] = { 2, 0, 1, 1 }; /* float, nothing, every pixel */
        add(&list, rest, sizeof(rest));
        c += n + (c[n] == ' ');
    }
    add(&list, "", 1);
    attribute(f, "channels", "chlist", list.data, list.size);
    return count;
}

static void add_size(file *f, int width) {
    const int32_t box[4] = { 0, 0, width - 1, 0 };
    const float centre[2] = { 0, 0 }, one = 1;
    attribute(f, "compression", "compression", "", 1);
    attribute(f, "dataWindow", "box2i", box, sizeof(box));
    attribute(f, "displayWindow", "box2i", box, sizeof(box));
    attribute(f, "lineOrder", "lineOrder", "", 1);
    attribute(f, "pixelAspectRatio", "float", &one, sizeof(one));
    attribute(f, "screenWindowCenter", "v2f", centre, sizeof(centre));
    attribute(f, "screenWindowWidth", "float", &one, sizeof(one));
}

static void begin(file *f, bool parts) {
    *f = (file){ .size = 0 };
    add(f, (uint8_t[]){ 0x76, 0x2f, 0x31, 1, 2, parts ? 0x10 : 0, 0, 0 }, 8);
}

/* The row of one part's file: count channels of `width` floats. */
static void add_row(file *f, const float *values, int count, int width) {
    uint64_t at = f->size + 8;
    add(f, &at, sizeof(at));
    add_int(f, 0);
    add_int(f, 4 * count * width);
    add(f, values, 4 * (size_t)(count * width));
}

static noc_image *read_file(const file *f) {
    uint8_t *copy = malloc(f->size);
    noc_log *log = noc_log_create(&(noc_log_params){ .message = hear });
    memcpy(copy, f->data, f->size);
    errors = 0;
    *error = 0;
    noc_image *image = image_read_memory(copy, f->size, "some.exr", log, NULL);
    if (errors != !image)
        fail_msg("%d errors: %s", errors, error);
    noc_log_destroy(log);
    free(copy);
    return image;
}

static void read_error(const file *f, const char *part) {
    assert_null(read_file(f));
    if (!strstr(error, part) || !strstr(error, "some.exr"))
        fail_msg("\"%s\" is not in \"%s\"", part, error);
}

/* What a file says beside its pixels. */
typedef struct says {
    const float *chromaticities, *white_luminance, *neutral;
} says;

/* One pixel, its channels in the order of the alphabet. */
static void one_pixel(file *f, const char *channels, const float *values, const says *what) {
    begin(f, false);
    int count = add_channels(f, channels);
    add_size(f, 1);
    if (what->chromaticities)
        attribute(f, "chromaticities", "chromaticities", what->chromaticities, 32);
    if (what->white_luminance)
        attribute(f, "whiteLuminance", "float", what->white_luminance, 4);
    if (what->neutral)
        attribute(f, "adoptedNeutral", "v2f", what->neutral, 8);
    add(f, "", 1);
    add_row(f, values, count, 1);
}

static void expect(const char *channels, const float *values, says what, const double rgb[3], double tolerance) {
    file f;
    one_pixel(&f, channels, values, &what);
    noc_image *image = read_file(&f);
    if (!image)
        fail_msg("%s", error);
    for (int k = 0; k < 3; k++)
        if (!(fabs(image->rgb[k] - rgb[k]) <= tolerance))
            fail_msg("%s: %.9g, not %.9g", channels, image->rgb[k], rgb[k]);
    noc_image_destroy(image);
}

static const float rec709[] = { .64f, .33f, .3f, .6f, .15f, .06f, .3127f, .329f },
                   ap0[] = { .7347f, .2653f, 0, 1, .0001f, -.077f, .32168f, .33767f },
                   ap1[] = { .713f, .293f, .165f, .83f, .128f, .044f, .32168f, .33767f },
                   rec2020[] = { .708f, .292f, .17f, .797f, .131f, .046f, .3127f, .329f },
                   xyz[] = { 1, 0, 0, 1, 0, 0, 1 / 3.f, 1 / 3.f }, d65[] = { .3127f, .329f },
                   d50[] = { .3457f, .3585f }, d60[] = { .32168f, .33767f };
static const double picture[] = { 100, 50, 25 }, white[] = { 1, 1, 1 };

static void chromaticities_are_converted(void **state) {
    (void)state;
    expect("B G R", (float[]){ 25, 50, 100 }, (says){ NULL }, picture, 0);
    expect("B G R", (float[]){ 25, 50, 100 }, (says){ .chromaticities = rec709, .neutral = d65 }, picture, 0);
    expect("B G R", (float[]){ 31.6525f, 58.825f, 63.6325f }, (says){ .chromaticities = xyz }, picture, .02);
    expect("B G R", (float[]){ 29.10422f, 52.06922f, 67.54719f }, (says){ .chromaticities = ap0 }, picture, 1e-3);
    expect("B G R", (float[]){ 29.10422f, 52.06922f, 67.54719f }, (says){ .chromaticities = ap0, .neutral = d60 },
           picture, 1e-3);
    expect("B G R", (float[]){ 29.28542f, 53.17337f, 79.47039f }, (says){ .chromaticities = ap1 }, picture, 1e-3);
    expect("B G R", (float[]){ 28.43f, 53.17f, 80.2875f }, (says){ .chromaticities = rec2020 }, picture, .03);
}

/* RGB (1, 1, 1) is neutral, and XYZ of that colour is: both are white here. */
static void neutrals_become_white(void **state) {
    (void)state;
    expect("B G R", (float[]){ 1, 1, 1 }, (says){ .chromaticities = ap0 }, white, 1e-6);
    expect("B G R", (float[]){ 1, 1, 1 }, (says){ .neutral = d50 }, white, 1e-6);
    expect("B G R", (float[]){ 1.08905f, 1, .95046f }, (says){ .chromaticities = xyz }, white, 1e-3);
    expect("B G R", (float[]){ 1.08905f, 1, .95046f }, (says){ .chromaticities = xyz, .neutral = d65 }, white, 1e-3);
    expect("B G R", (float[]){ .8251f, 1, .9642f }, (says){ .chromaticities = xyz, .neutral = d50 }, white, 1e-3);
    /* Lindbloom: sRGB of D50 has red of X, Y, Z .4360747 .2225045 .0139322 */
    expect("B G R", (float[]){ .0139322f, .2225045f, .4360747f }, (says){ .chromaticities = xyz, .neutral = d50 },
           (double[]){ 1, 0, 0 }, 1e-3);
}

static void white_luminance_is_a_scale(void **state) {
    (void)state;
    const float hundred = 100, two = 2;
    expect("B G R", (float[]){ .25f, .5f, 1 }, (says){ .white_luminance = &hundred }, picture, 0);
    expect("B G R", (float[]){ 14.55211f, 26.03461f, 33.773595f },
           (says){ .chromaticities = ap0, .white_luminance = &two }, picture, 1e-3);
    expect("Y", (float[]){ .5f }, (says){ .chromaticities = ap0, .white_luminance = &two }, white, 0);
}

/* R = (RY + 1) Y, B alike, and Y is what the primaries say. */
static void luminance_and_chroma(void **state) {
    (void)state;
    float y = .212639f * 100 + .715169f * 50 + .072192f * 25;
    expect("BY RY Y", (float[]){ 25 / y - 1, 100 / y - 1, y }, (says){ NULL }, picture, 1e-3);
    /* of AP0: .343966 .728166 -.072133 (SMPTE ST 2065-1) */
    y = .3439664f * 67.54719f + .7281661f * 52.06922f - .0721325f * 29.10422f;
    expect("BY RY Y", (float[]){ 29.10422f / y - 1, 67.54719f / y - 1, y }, (says){ .chromaticities = ap0 }, picture,
           2e-3);
}

static void colours_that_are_none(void **state) {
    (void)state;
    const float pixel[3] = { 1, 1, 1 }, none = 0, below = -1, nan = NAN, infinite = INFINITY,
                bad_neutral[] = { .3f, 0 };
    static const struct {
        int at;
        float to[2];
        const char *message;
    } cases[] = {
        { WHITE, { .3127f, 0 }, "white has no luminance" },    { WHITE, { .3127f, -.3f }, "white has no luminance" },
        { RED, { NAN, .33f }, "not all of them are numbers" }, { GREEN, { .3f, INFINITY }, "not all of them" },
        { BLUE, { .47f, .465f }, "lie on one line" },          { BLUE, { .64f, .33f }, "lie on one line" },
        { WHITE, { .395f, .195f }, "between two of" }
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        float c[8];
        file f;
        memcpy(c, rec709, sizeof(c));
        memcpy(c + cases[i].at, cases[i].to, 8);
        one_pixel(&f, "B G R", pixel, &(says){ .chromaticities = c });
        read_error(&f, cases[i].message);
    }
    const float *const luminances[] = { &none, &below, &nan, &infinite };
    file f;
    for (size_t i = 0; i < NOC_COUNT(luminances); i++) {
        one_pixel(&f, "B G R", pixel, &(says){ .white_luminance = luminances[i] });
        read_error(&f, "whiteLuminance");
    }
    one_pixel(&f, "B G R", pixel, &(says){ .neutral = bad_neutral });
    read_error(&f, "white has no luminance");
    one_pixel(&f, "B G R", pixel, &(says){ .chromaticities = xyz, .neutral = bad_neutral });
    read_error(&f, "neutral has no luminance");
    begin(&f, false);
    add_channels(&f, "B G R");
    add_size(&f, 1);
    attribute(&f, "adoptedNeutral", "int", "\1\0\0", 4);
    attribute(&f, "whiteLuminance", "int", "\1\0\0", 4);
    add(&f, "", 1);
    add_row(&f, pixel, 3, 1);
    read_error(&f, "adoptedNeutral is of a type that is not its own");
}

static void one_layer_is_the_picture(void **state) {
    (void)state;
    expect("ViewLayer.Combined.A ViewLayer.Combined.B ViewLayer.Combined.G ViewLayer.Combined.R ViewLayer.Depth.Z",
           (float[]){ 1, 25, 50, 100, 7 }, (says){ NULL }, picture, 0);
    expect(".A .B .G .R", (float[]){ 1, 25, 50, 100 }, (says){ NULL }, picture, 0);
    /* normals are X, Y, Z: no luminance */
    expect("a.Combined.B a.Combined.G a.Combined.R a.Normal.X a.Normal.Y a.Normal.Z",
           (float[]){ 25, 50, 100, .1f, .2f, .3f }, (says){ NULL }, picture, 0);
    /* what has no layer's name comes before what has one */
    expect("B G R a.B a.G a.R b.B b.G b.R", (float[]){ 25, 50, 100, 1, 2, 3, 4, 5, 6 }, (says){ NULL }, picture, 0);
    expect("Y a.B a.G a.R", (float[]){ 1, 4, 5, 6 }, (says){ NULL }, white, 0);
    expect("a.B a.G a.R", (float[]){ 29.10422f, 52.06922f, 67.54719f }, (says){ .chromaticities = ap0 }, picture, 1e-3);
}

static void a_mask_belongs_to_its_layer(void **state) {
    (void)state;
    file f;
    one_pixel(&f, "a.B a.G a.R a.emitter", (float[]){ 1, 2, 3, 1 }, &(says){ NULL });
    noc_image *image = read_file(&f);
    assert_true(image && image->emitter && image->emitter[0] == 1);
    noc_image_destroy(image);
    one_pixel(&f, "a.B a.G a.R b.emitter", (float[]){ 1, 2, 3, 1 }, &(says){ NULL });
    image = read_file(&f);
    assert_true(image && !image->emitter);
    noc_image_destroy(image);
}

static void what_there_is_is_told(void **state) {
    (void)state;
    file f;
    const float values[40] = { 0 };
    one_pixel(&f, "a.B a.G a.R b.c.B b.c.G b.c.R", values, &(says){ NULL });
    read_error(&f, "2 layers have channels R, G and B: a, b.c.");
    one_pixel(&f, "A a.B a.G b.R", values, &(says){ NULL });
    read_error(&f, "has neither channels R, G, B nor Y; there are A, a.B, a.G, b.R");
    one_pixel(&f, "a.G a.R b.B", values, &(says){ NULL });
    read_error(&f, "there are a.G, a.R, b.B");
    one_pixel(&f, "a b c d e f g h i j", values, &(says){ NULL });
    read_error(&f, "there are a, b, c, d, e, f, g, h and 2 more");
    one_pixel(&f, "a\n.B", values, &(says){ NULL });
    read_error(&f, "there are a .B");
}

/* Parts of one pixel and one row. */
static void several_parts(file *f, int count, const char *const (*parts)[2], const float *values) {
    int channels[8];
    begin(f, true);
    for (int i = 0; i < count; i++) {
        channels[i] = add_channels(f, parts[i][1]);
        attribute(f, "chunkCount", "int", "\1\0\0", 4);
        add_size(f, 1);
        attribute(f, "name", "string", parts[i][0], strlen(parts[i][0]));
        attribute(f, "type", "string", "scanlineimage", 13);
        add(f, "", 1);
    }
    add(f, "", 1);
    uint64_t at = f->size + 8 * (size_t)count;
    for (int i = 0; i < count; i++) {
        add(f, &at, sizeof(at));
        at += 12 + 4 * (uint64_t)channels[i];
    }
    for (int i = 0; i < count; i++) {
        add_int(f, i);
        add_int(f, 0);
        add_int(f, 4 * channels[i]);
        add(f, values, 4 * (size_t)channels[i]);
        values += channels[i];
    }
}

static void parts_of_a_file(void **state) {
    (void)state;
    static const char *const good[][2] = { { "depth", "Z" }, { "beauty", "c.B c.G c.R" }, { "other", "B G R" } },
                             *const bad[][2] = { { "depth", "Z" }, { "id", "id" } },
                             *const many[][2] = { { "depth", "Z" }, { "all", "a.B a.G a.R b.B b.G b.R" } };
    file f;
    several_parts(&f, 3, good, (float[]){ 9, 25, 50, 100, 1, 1, 1 });
    noc_image *image = read_file(&f);
    if (!image)
        fail_msg("%s", error);
    for (int k = 0; k < 3; k++)
        assert_true(image->rgb[k] == picture[k]);
    noc_image_destroy(image);
    several_parts(&f, 2, bad, (float[]){ 0, 0 });
    read_error(&f, "there are the part depth, the part id");
    several_parts(&f, 2, many, (float[7]){ 0 });
    read_error(&f, "2 layers have channels R, G and B: a, b.");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chromaticities_are_converted),
        cmocka_unit_test(neutrals_become_white),
        cmocka_unit_test(white_luminance_is_a_scale),
        cmocka_unit_test(luminance_and_chroma),
        cmocka_unit_test(colours_that_are_none),
        cmocka_unit_test(one_layer_is_the_picture),
        cmocka_unit_test(a_mask_belongs_to_its_layer),
        cmocka_unit_test(what_there_is_is_told),
        cmocka_unit_test(parts_of_a_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
