/* nocturne compare: error figures of a picture against a reference. */
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct compare_args {
    cli_args common;
    const char *output, *exposure;
    bool json;
    noc_compare_params compare;
} compare_args;

#define A compare_args
static const noc_option own_options[] = {
    { "output", "Output", NOC_OPTION_TEXT, offsetof(A, output), 0, 0, NULL, "FILE",
      "difference picture to write, .png" },
    { "json", "Output", NOC_OPTION_BOOL, offsetof(A, json), 0, 1, NULL, "", "print JSON instead of a table" },
    { "ceiling", "Figures", NOC_OPTION_REAL, offsetof(A, compare.ceiling), 1e-6, 1e9, NULL, "cd/m2",
      "both pictures are cut off here in the clamped rows (not for PNG)" },
    { "exposure", "Display", NOC_OPTION_TEXT, offsetof(A, exposure), 0, 0, NULL, "EV",
      "\"auto\" (of the reference), or EV100: for RMSE-8" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }
static int run(void *arguments);

static const compare_args defaults = { .exposure = "auto", .compare = noc_compare_default_params() };
static const char *const by_exposure[] = { "auto-exposure", "ev100", NULL };

const cli_command cli_compare = {
    "compare",
    "PICTURE REFERENCE",
    "Prints how far a picture is from a reference of the same size.",
    "RMSE-8 is on 8-bit sRGB, 0 to 255, both with the reference's exposure and one\n"
    "tone map; RMSE and relMSE are on linear luminance; bias is mean(picture) /\n"
    "mean(reference). Definitions: docs/estimator.md. PNG against PNG is compared as\n"
    "displayed: RMSE-8 is of their 8-bit values, luminances are shares of white, and\n"
    "both should have one exposure. PNG against EXR, and views (--show), are refused.\n"
    "Examples\n"
    "  nocturne compare restir.exr reference.exr -o difference.png\n",
    { { options, 0, NULL },
      { noc_display_options, offsetof(A, compare.display), by_exposure },
      { cli_common_options, 0, NULL } },
    sizeof(compare_args),
    &defaults,
    run,
};

static void print_row(const char *name, const noc_metrics *m) {
    char pixels[32];
    printf("  %-28s %10s  %8.3f  %10.5g  %10.5g  ", name, noc_text_count(pixels, m->pixels), m->rmse8, m->rmse,
           m->relmse);
    printf(isfinite(m->bias) ? "%8.4f\n" : "       -\n", m->bias);
}

/* What a reference lacks makes up much of relMSE, however good the picture is. */
static void print_unlit(const noc_metrics *m) {
    char pixels[64];
    if (m->unlit && isfinite(m->relmse))
        printf("  %s lit in the picture and 0 in the reference: %.3g %% of relMSE\n",
               noc_text_many(pixels, m->unlit, "pixel"), 100 * m->relmse_unlit / m->relmse);
}

static void print_output(const compare_args *args) {
    char path[240];
    if (args->output && !args->common.quiet)
        printf("  difference picture: %s\n", noc_text_clean(path, sizeof(path), args->output));
}

static void print_table(const compare_args *args, const noc_comparison *c, const noc_image *image) {
    char a[160], b[160], clamped[48];
    printf("%s against %s, %d x %d\n\n", noc_text_clean(a, sizeof(a), args->common.inputs[0]),
           noc_text_clean(b, sizeof(b), args->common.inputs[1]), image->width, image->height);
    bool relative = args->compare.relative;
    printf("  %-28s %10s  %8s  %10s  %10s  %8s\n", "", "pixels", "RMSE-8", relative ? "RMSE" : "RMSE cd/m2", "relMSE",
           "bias");
    print_row("all pixels", &c->all);
    if (relative) {
        print_unlit(&c->all);
        printf("\n  mean luminance %.6g against %.6g of white\n", c->all.mean_x, c->all.mean_r);
        print_output(args);
        return;
    }
    snprintf(clamped, sizeof(clamped), "  clamped to %.6g cd/m2", c->ceiling);
    print_row(clamped, &c->all_clamped);
    if (c->has_mask) {
        print_row("pixels that see no emitter", &c->dark);
        print_row(clamped, &c->dark_clamped);
    } else {
        printf("  the reference has no emitter mask: no figures without emitters\n");
    }
    print_unlit(&c->all);
    printf("\n  mean luminance %.6g against %.6g cd/m2; RMSE-8 at EV100 %.2f\n", c->all.mean_x, c->all.mean_r,
           c->ev100);
    print_output(args);
}

static void json_row(const char *name, const noc_metrics *m, bool last) {
    const struct {
        const char *key;
        double value;
    } fields[] = {
        { "pixels", (double)m->pixels }, { "rmse8", m->rmse8 },         { "rmse", m->rmse },
        { "relmse", m->relmse },         { "bias", m->bias },           { "mean", m->mean_x },
        { "mean_reference", m->mean_r }, { "unlit", (double)m->unlit }, { "relmse_unlit", m->relmse_unlit },
    };
    printf("  \"%s\": {", name);
    for (size_t i = 0; i < sizeof(fields) / sizeof(*fields); i++) {
        printf("%s\"%s\": ", i ? ", " : "", fields[i].key);
        cli_json_number(stdout, fields[i].value);
    }
    printf("}%s\n", last ? "" : ",");
}

static void print_json(const compare_args *args, const noc_comparison *c, const noc_image *image) {
    printf("{\n  \"picture\": ");
    cli_json_text(stdout, args->common.inputs[0]);
    printf(",\n  \"reference\": ");
    cli_json_text(stdout, args->common.inputs[1]);
    if (args->output) {
        printf(",\n  \"difference\": ");
        cli_json_text(stdout, args->output);
    }
    bool relative = args->compare.relative, mask = c->has_mask && !relative;
    printf(",\n  \"width\": %d, \"height\": %d, \"unit\": \"%s\"", image->width, image->height,
           relative ? "white" : "cd/m2");
    if (!relative) {
        printf(", \"ceiling\": ");
        cli_json_number(stdout, c->ceiling);
        printf(", \"ev100\": ");
        cli_json_number(stdout, c->ev100);
    }
    printf(",\n");
    json_row("all", &c->all, relative);
    if (!relative)
        json_row("all_clamped", &c->all_clamped, !mask);
    if (mask) {
        json_row("no_emitter", &c->dark, false);
        json_row("no_emitter_clamped", &c->dark_clamped, true);
    }
    printf("}\n");
}

static noc_status write_difference(const compare_args *args, const noc_image *x, const noc_image *r, noc_log *log) {
    uint8_t *rgb = NULL;
    int width, height;
    bool relative = args->compare.relative;
    noc_status status = noc_image_difference(x, r, &(noc_difference_params){ .unit = relative ? "of white" : NULL },
                                             &rgb, &width, &height, log);
    if (status)
        return status;
    const char *keys[] = { "picture" }, *values[] = { relative ? "signed difference of luminance, white = 1"
                                                               : "signed difference of luminance, cd/m2" };
    status = noc_image_write_srgb8(rgb, width, height, args->output, &(noc_image_meta){ 1, keys, values }, log);
    free(rgb);
    return status;
}

/* Views hold no light, and what was displayed has lost its unit: figures of either would mean nothing. */
static noc_status check_comparable(const compare_args *args, noc_image *const pictures[2], const bool linear[2]) {
    char shown[160], name[40];
    for (int i = 0; i < 2; i++) {
        if (!*pictures[i]->channel)
            continue;
        cli_error("%s: it holds the view \"%s\", no luminance: pictures alone are compared",
                  noc_text_clean(shown, sizeof(shown), args->common.inputs[i]),
                  noc_text_clean(name, sizeof(name), pictures[i]->channel));
        return NOC_ERR_ARGUMENT;
    }
    if (linear[0] != linear[1]) {
        cli_error("%s: it is displayed (PNG), the other is linear (EXR): PNG is compared with PNG, EXR with EXR",
                  noc_text_clean(shown, sizeof(shown), args->common.inputs[linear[0]]));
        return NOC_ERR_ARGUMENT;
    }
    double one = pictures[0]->ev100, other = pictures[1]->ev100;
    if (fabs(one - other) >= 0.005 && !args->common.quiet) /* false where one is not told */
        cli_error("warning: the exposures differ, EV100 %.2f and %.2f: the figures hold that difference too. "
                  "Render both with one --exposure, or compare .exr",
                  one, other);
    return NOC_OK;
}

static int compare(compare_args *args, noc_log *log) {
    noc_image *pictures[2] = { NULL };
    bool linear[2] = { false };
    noc_status status = NOC_OK;
    noc_comparison figures;
    for (int i = 0; i < 2 && !status; i++) {
        pictures[i] = noc_image_read(args->common.inputs[i], log, &linear[i]);
        status = pictures[i] ? NOC_OK : NOC_ERR_FORMAT;
    }
    status = status ? status : check_comparable(args, pictures, linear);
    args->compare.relative = !linear[0];
    status = status ? status : noc_image_compare(pictures[0], pictures[1], &args->compare, &figures, log);
    if (!status && args->output)
        status = write_difference(args, pictures[0], pictures[1], log);
    if (!status)
        (args->json ? print_json : print_table)(args, &figures, pictures[0]);
    noc_image_destroy(pictures[0]);
    noc_image_destroy(pictures[1]);
    return status ? CLI_FAILURE : CLI_OK;
}

static int run(void *arguments) {
    compare_args *args = arguments;
    if (args->common.input_count != 2)
        return cli_usage(&cli_compare, "two pictures are compared: the one, and the reference");
    int status = cli_parse_exposure(&cli_compare, args->exposure, &args->compare.display);
    if (!status && args->output)
        status = cli_check_output(&cli_compare, args->output, CLI_PNG, &args->common);
    if (status)
        return status;
    noc_log *log = cli_log_create(&args->common);
    status = compare(args, log);
    noc_log_destroy(log);
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
