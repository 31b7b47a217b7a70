/* First frames beside the reference: the same part of each picture, displayed alike, in one PNG. */
#include "experiment.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { GAP = 4, PANEL = 320, MOST_COLUMNS = 4 };

typedef struct panels {
    const experiment_lab *lab;
    int width, height;   /* of a picture */
    size_t count;        /* the reference and one a configuration */
    uint8_t **pictures;  /* 8-bit sRGB */
} panels;

static uint8_t *display(const noc_image *image, double ev100) {
    noc_display_params params = noc_display_default_params();
    params.auto_exposure = false;
    params.ev100 = ev100;
    uint8_t *rgb = cli_alloc((size_t)image->width * (size_t)image->height * 3);
    noc_image_to_srgb8(image, &params, rgb);
    return rgb;
}

static int read_pictures(panels *p, size_t scene, size_t camera) {
    double ev100 = noc_image_auto_ev100(p->lab->reference);
    p->pictures[0] = display(p->lab->reference, ev100);
    for (size_t i = 1; i < p->count; i++) {
        char *path = experiment_picture(p->lab, experiment_find_run(p->lab, scene, camera, i - 1, 0));
        bool linear;
        noc_image *image = noc_image_read(path, p->lab->log, &linear);
        bool same = image && image->width == p->width && image->height == p->height;
        if (image && !same)
            cli_error("%s: it is of another size; delete it", path);
        free(path);
        p->pictures[i] = same ? display(image, ev100) : NULL;
        noc_image_destroy(image);
        if (!same)
            return CLI_FAILURE;
    }
    return CLI_OK;
}

/* The part where the pictures differ most from the reference, as seen: a sum over each rectangle by running sums. */
static void choose(const panels *p, experiment_crop *crop) {
    size_t w = (size_t)p->width + 1;
    double *sums = cli_alloc(sizeof(double) * w * ((size_t)p->height + 1)), most = -1;
    for (int y = 0; y < p->height; y++) {
        double row = 0;
        for (int x = 0; x < p->width; x++) {
            size_t at = ((size_t)y * (size_t)p->width + (size_t)x) * 3;
            for (size_t i = 1; i < p->count; i++)
                for (size_t c = 0; c < 3; c++)
                    row += abs(p->pictures[i][at + c] - p->pictures[0][at + c]);
            sums[((size_t)y + 1) * w + (size_t)x + 1] = row + sums[(size_t)y * w + (size_t)x + 1];
        }
    }
    crop->width = (p->width + 2) / 3;
    crop->height = (p->height + 2) / 3;
    int step = p->width / 60 + 1;
    for (int y = 0; y + crop->height <= p->height; y += step) {
        for (int x = 0; x + crop->width <= p->width; x += step) {
            const double *a = sums + (size_t)y * w + (size_t)x, *b = a + (size_t)crop->height * w;
            double sum = b[crop->width] - b[0] - a[crop->width] + a[0];
            if (sum > most) {
                most = sum;
                crop->x = x;
                crop->y = y;
            }
        }
    }
    free(sums);
}

static void copy_panel(const panels *p, const experiment_crop *crop, const uint8_t *from, uint8_t *to, size_t stride) {
    for (int y = 0; y < crop->height * crop->scale; y++) {
        const uint8_t *row = from + ((size_t)(crop->y + y / crop->scale) * (size_t)p->width + (size_t)crop->x) * 3;
        for (int x = 0; x < crop->width * crop->scale; x++)
            memcpy(to + (size_t)y * stride + (size_t)x * 3, row + (size_t)(x / crop->scale) * 3, 3);
    }
}

static int write_sheet(const panels *p, const experiment_crop *crop, const char *path) {
    int columns = crop->columns, rows = ((int)p->count + columns - 1) / columns;
    int w = crop->width * crop->scale, h = crop->height * crop->scale;
    int width = columns * w + (columns - 1) * GAP, height = rows * h + (rows - 1) * GAP;
    if (width > NOC_IMAGE_MAX_SIDE || height > NOC_IMAGE_MAX_SIDE) {
        cli_error("%s: it would be larger than %d px", path, NOC_IMAGE_MAX_SIDE);
        return CLI_FAILURE;
    }
    uint8_t *sheet = cli_alloc((size_t)width * (size_t)height * 3);
    memset(sheet, 128, (size_t)width * (size_t)height * 3);
    for (size_t i = 0; i < p->count; i++) {
        size_t x = i % (size_t)columns * (size_t)(w + GAP), y = i / (size_t)columns * (size_t)(h + GAP);
        copy_panel(p, crop, p->pictures[i], sheet + (y * (size_t)width + x) * 3, (size_t)width * 3);
    }
    const char *keys[] = { "picture" }, *values[] = { "the reference and first frames, row by row" };
    noc_status status = noc_image_write_srgb8(sheet, width, height, path, &(noc_image_meta){ 1, keys, values }, p->lab->log);
    free(sheet);
    return status ? CLI_FAILURE : CLI_OK;
}

int experiment_make_crops(experiment_lab *lab, size_t scene, size_t camera, const char *name) {
    const experiment_spec *spec = &lab->spec;
    experiment_crop *crop = &lab->crops[scene * spec->camera_count + camera];
    panels p = { lab, spec->width, spec->height, spec->config_count + 1, NULL };
    p.pictures = cli_alloc(sizeof(uint8_t *) * p.count);
    int status = read_pictures(&p, scene, camera);
    if (!status) {
        *crop = (experiment_crop){ .x = spec->crop_box[0], .y = spec->crop_box[1], .width = spec->crop_box[2], .height = spec->crop_box[3] };
        if (!crop->width)
            choose(&p, crop);
        crop->scale = crop->width < PANEL ? PANEL / crop->width : 1;
        crop->columns = p.count < MOST_COLUMNS ? (int)p.count : MOST_COLUMNS;
        char *path = cli_format("%s/%s", lab->folder, name);
        status = write_sheet(&p, crop, path);
        crop->made = !status;
        free(path);
    }
    for (size_t i = 0; i < p.count; i++)
        free(p.pictures[i]);
    free(p.pictures);
    return status;
}
