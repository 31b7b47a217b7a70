/* Shown frames beside the reference: the same part of each picture, displayed alike, in one PNG. */
#include "lab/crops.h"
#include "lab/sheet.h"

#include <math.h>
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
    bool light;         /* the light view; the reference, which has none, is shown as it is seen */
} panels;

/* NULL after reporting that memory was refused. */
static uint8_t *display(const noc_image *image, double ev100, bool light, noc_log *log) {
    noc_display_params params = noc_display_default_params();
    params.auto_exposure = false;
    params.ev100 = ev100;
    if (light) { /* as it was written: white is 1 */
        params.tonemap = NOC_TONEMAP_LINEAR;
        params.ev100 = -log2(1.2);
        params.white_kelvin = 0;
    }
    uint8_t *rgb = noc_alloc((size_t)image->width * (size_t)image->height * 3);
    if (rgb && !noc_image_to_srgb8(image, &params, rgb))
        return rgb;
    free(rgb);
    noc_no_memory(log, "pictures");
    return NULL;
}

/* *picture is NULL where this configuration has no such frame. */
static noc_status read_picture(const panels *p, size_t config, uint8_t **picture) {
    const lab_session *lab = p->lab;
    const lab_run *run = lab_find_run(lab, p->camera, config, 0);
    *picture = NULL;
    char *path = p->light ? lab_light_path(lab, run->key, p->frame)
                          : lab_picture_path(lab, run->key, lab_shown_mode(lab->spec, p->camera), p->frame);
    if (!path)
        return NOC_ERR_MEMORY;
    noc_status status = NOC_OK;
    bool linear;
    noc_image *image = access(path, F_OK) ? NULL : noc_image_read(path, lab->log, &linear);
    if (!image && !access(path, F_OK)) {
        status = NOC_ERR_FORMAT; /* reported */
    } else if (image && (image->width != p->width || image->height != p->height)) {
        status = noc_error(lab->log, NOC_ERR_FORMAT, "%s: it is of another size; delete it", path);
    } else if (image) {
        *picture = display(image, p->ev100, p->light, lab->log);
        status = *picture ? NOC_OK : NOC_ERR_MEMORY;
    }
    noc_image_destroy(image);
    free(path);
    return status;
}

/* Where the sum of the differences over a third of the picture is largest, by running sums. */
static void find_most(const panels *p, const uint32_t *differences, double *sums, lab_crop *crop) {
    size_t w = (size_t)p->width;
    double most = -1;
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
}

/* The part where the pictures differ most from the reference, as seen. */
static noc_status choose(const panels *p, lab_crop *crop) {
    size_t w = (size_t)p->width, count = w * (size_t)p->height;
    double *sums = noc_calloc((w + 1) * ((size_t)p->height + 1), sizeof(double));
    uint32_t *differences = noc_calloc(count, sizeof(uint32_t));
    noc_status status = sums && differences ? NOC_OK : noc_no_memory(p->lab->log, "pictures");
    for (size_t i = 0; !status && i < p->lab->spec->config_count; i++) {
        uint8_t *picture;
        status = read_picture(p, i, &picture);
        for (size_t k = 0; picture && k < 3 * count; k++)
            differences[k / 3] += (uint32_t)abs(picture[k] - p->reference[k]);
        free(picture);
    }
    if (!status)
        find_most(p, differences, sums, crop);
    free(differences);
    free(sums);
    return status;
}

static noc_status fill_sheet(const panels *p, lab_sheet *sheet) {
    const lab_spec *spec = p->lab->spec;
    noc_status status = NOC_OK;
    lab_add_panel(sheet, 0, p->reference, p->width, "reference");
    for (size_t i = 0; i < spec->config_count && !status; i++) {
        uint8_t *picture = NULL;
        status = read_picture(p, i, &picture);
        if (!status)
            lab_add_panel(sheet, i + 1, picture, p->width, spec->configs[i].name);
        free(picture);
    }
    return status;
}

static noc_status write_sheet(const panels *p, const lab_crop *crop) {
    const lab_spec *spec = p->lab->spec;
    char name[LAB_TEXT];
    lab_sheet sheet = { .rgb = NULL };
    char *path = noc_format("%s/%s", p->lab->folder, lab_sheet_name(spec, p->camera, p->frame, p->light, name));
    noc_status status =
        path ? lab_start_sheet(&sheet, crop, &spec->cameras[p->camera], spec->config_count + 1, path, p->lab->log)
             : noc_no_memory(p->lab->log, name);
    status = status ? status : fill_sheet(p, &sheet);
    const char *keys[] = { "picture" }, *values[] = {
        p->light ? "the reference, and the light that each pixel chose, by each configuration, row by row"
                 : "the reference, and one frame of each configuration, row by row"
    };
    if (!status)
        status = noc_image_write_srgb8(sheet.rgb, sheet.width, sheet.height, path, &(noc_image_meta){ 1, keys, values },
                                       p->lab->log);
    free(path);
    free(sheet.rgb);
    return status;
}

/* As many rows as MOST_COLUMNS takes, all of them full or nearly so. */
static int columns_of(int count) {
    int rows = (count + MOST_COLUMNS - 1) / MOST_COLUMNS;
    return (count + rows - 1) / rows;
}

noc_status lab_make_crops(lab_session *lab, size_t camera) {
    const lab_spec *spec = lab->spec;
    lab_crop *crop = &lab->crops[camera];
    double ev100 = noc_image_auto_ev100(lab->reference);
    panels p = { lab, camera, 0, spec->width, spec->height, ev100, NULL, false };
    p.reference = isnan(ev100) ? NULL : display(lab->reference, ev100, false, lab->log);
    if (!p.reference)
        return isnan(ev100) ? noc_no_memory(lab->log, "pictures") : NOC_ERR_MEMORY;
    *crop = (lab_crop){
        .x = spec->crop_box[0], .y = spec->crop_box[1], .width = spec->crop_box[2], .height = spec->crop_box[3]
    };
    int motion = spec->cameras[camera].frames;
    if (spec->cameras[camera].inset_count)
        *crop = (lab_crop){ .width = spec->width, .height = spec->height };
    noc_status status = NOC_OK;
    for (size_t i = 0; !status && i < (motion ? 1 : spec->shown_count); i++) {
        p.frame = motion ? motion : spec->shown[i];
        if (!crop->width)
            status = choose(&p, crop); /* by the first of them, for all */
        if (status)
            break;
        crop->scale = crop->width < PANEL ? PANEL / crop->width : 1;
        crop->columns = columns_of((int)spec->config_count + 1);
        for (int light = 0; light <= spec->light_view && !status; light++) {
            p.light = light;
            status = write_sheet(&p, crop);
        }
        p.light = false;
    }
    free(p.reference);
    return status;
}
