/* Shown frames beside the reference: the same part of each picture, displayed alike, in one PNG. */
#include "lab/lab.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PANEL = 320, MOST_COLUMNS = 4 };

/* A picture at a time is read and held: a spec may have a hundred configurations. */
typedef struct panels {
    const lab_session *lab;
    size_t camera;
    int frame;
    int width, height;  /* of a picture */
    double ev100;       /* of all: the reference's automatic exposure */
    uint8_t *reference; /* 8-bit sRGB */
} panels;

bool lab_shows(const lab_spec *spec, size_t camera, int frame) {
    if (spec->cameras[camera].frames)
        return frame == spec->cameras[camera].frames;
    for (size_t i = 0; i < spec->shown_count; i++)
        if (spec->shown[i] == frame)
            return true;
    return false;
}

char *lab_sheet_name(const lab_session *lab, size_t camera, int frame) {
    int mode = lab_shown_mode(&lab->spec, camera);
    char *slug = lab_slug(lab, camera);
    char *name = cli_format("%s-%s%d.png", slug, mode == LAB_ACCUMULATED ? "mean" : "frame", frame);
    free(slug);
    return name;
}

static uint8_t *display(const noc_image *image, double ev100) {
    noc_display_params params = noc_display_default_params();
    params.auto_exposure = false;
    params.ev100 = ev100;
    uint8_t *rgb = cli_alloc((size_t)image->width * (size_t)image->height * 3);
    noc_image_to_srgb8(image, &params, rgb);
    return rgb;
}

/* *picture is NULL where this configuration has no such frame. */
static int read_picture(const panels *p, size_t config, uint8_t **picture) {
    const lab_run *run = lab_find_run(p->lab, p->camera, config, 0);
    *picture = NULL;
    char *path = lab_picture(p->lab, run->key, lab_shown_mode(&p->lab->spec, p->camera), p->frame);
    bool linear;
    noc_image *image = access(path, F_OK) ? NULL : noc_image_read(path, p->lab->log, &linear);
    bool there = image || !access(path, F_OK), same = image && image->width == p->width && image->height == p->height;
    if (image && !same)
        cli_error("%s: it is of another size; delete it", path);
    if (same)
        *picture = display(image, p->ev100);
    noc_image_destroy(image);
    free(path);
    return there && !same ? CLI_FAILURE : CLI_OK;
}

/* The part where the pictures differ most from the reference, as seen: a sum over each rectangle by running sums. */
static int choose(const panels *p, lab_crop *crop) {
    size_t w = (size_t)p->width, count = w * (size_t)p->height;
    double *sums = cli_alloc(sizeof(double) * (w + 1) * ((size_t)p->height + 1)), most = -1;
    uint32_t *differences = cli_alloc(sizeof(uint32_t) * count);
    int status = CLI_OK;
    for (size_t i = 0; !status && i < p->lab->spec.config_count; i++) {
        uint8_t *picture;
        status = read_picture(p, i, &picture);
        for (size_t k = 0; picture && k < 3 * count; k++)
            differences[k / 3] += (uint32_t)abs(picture[k] - p->reference[k]);
        free(picture);
    }
    for (size_t y = 0; y < (size_t)p->height; y++) {
        double row = 0;
        for (size_t x = 0; x < w; x++) {
            row += differences[y * w + x];
            sums[(y + 1) * (w + 1) + x + 1] = row + sums[y * (w + 1) + x + 1];
        }
    }
    crop->width = (p->width + 2) / 3;
    crop->height = (p->height + 2) / 3;
    int step = p->width / 60 + 1;
    for (int y = 0; y + crop->height <= p->height; y += step) {
        for (int x = 0; x + crop->width <= p->width; x += step) {
            const double *a = sums + (size_t)y * (w + 1) + (size_t)x, *b = a + (size_t)crop->height * (w + 1);
            double sum = b[crop->width] - b[0] - a[crop->width] + a[0];
            if (sum > most) {
                most = sum;
                crop->x = x;
                crop->y = y;
            }
        }
    }
    free(differences);
    free(sums);
    return status;
}

static int write_sheet(const panels *p, const lab_crop *crop, const char *name) {
    const lab_spec *spec = &p->lab->spec;
    lab_sheet sheet;
    int status = lab_start_sheet(&sheet, crop, &spec->cameras[p->camera], spec->config_count + 1);
    if (status) {
        cli_error("%s/%s: it would be larger than %d px", p->lab->folder, name, NOC_IMAGE_MAX_SIDE);
        return status;
    }
    lab_add_panel(&sheet, 0, p->reference, p->width, "reference");
    for (size_t i = 0; i < spec->config_count && !status; i++) {
        uint8_t *picture = NULL;
        status = read_picture(p, i, &picture);
        if (!status)
            lab_add_panel(&sheet, i + 1, picture, p->width, spec->configs[i].name);
        free(picture);
    }
    char *path = cli_format("%s/%s", p->lab->folder, name);
    const char *keys[] = { "picture" },
               *values[] = { "the reference, and one frame of each configuration, row by row" };
    if (!status && noc_image_write_srgb8(sheet.rgb, sheet.width, sheet.height, path,
                                         &(noc_image_meta){ 1, keys, values }, p->lab->log))
        status = CLI_FAILURE;
    free(path);
    free(sheet.rgb);
    return status;
}

int lab_make_crops(lab_session *lab, size_t camera) {
    const lab_spec *spec = &lab->spec;
    lab_crop *crop = &lab->crops[camera];
    double ev100 = cli_auto_ev100(lab->reference);
    panels p = { lab, camera, 0, spec->width, spec->height, ev100, display(lab->reference, ev100) };
    *crop = (lab_crop){
        .x = spec->crop_box[0], .y = spec->crop_box[1], .width = spec->crop_box[2], .height = spec->crop_box[3]
    };
    int motion = spec->cameras[camera].frames, status = CLI_OK;
    if (spec->cameras[camera].inset_count)
        *crop = (lab_crop){ .width = spec->width, .height = spec->height };
    for (size_t i = 0; !status && i < (motion ? 1 : spec->shown_count); i++) {
        p.frame = motion ? motion : spec->shown[i];
        if (!crop->width)
            status = choose(&p, crop); /* by the first of them, for all */
        crop->scale = crop->width < PANEL ? PANEL / crop->width : 1;
        crop->columns = spec->config_count + 1 < MOST_COLUMNS ? (int)spec->config_count + 1 : MOST_COLUMNS;
        char *name = lab_sheet_name(lab, camera, p.frame);
        status = status ? status : write_sheet(&p, crop, name);
        free(name);
    }
    free(p.reference);
    return status;
}
