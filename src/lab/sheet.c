/* Contact sheets: pictures side by side, each with its name above it, and insets below it where its camera has some. */
#include "lab/sheet.h"

enum { GAP = 4, LABEL = 22, NAME = 14, FRAME = 2 };

static const struct {
    const char *name;
    uint8_t rgb[3];
} colours[LAB_INSETS] = {
    { "red", { 235, 70, 60 } },
    { "green", { 70, 200, 90 } },
    { "blue", { 90, 150, 255 } },
    { "yellow", { 240, 205, 60 } },
};

const char *lab_inset_colour(int inset) { return colours[inset].name; }

/* Insets stand side by side, two at least, so that one alone is not as wide as the picture. */
static int inset_width(const lab_sheet *s) {
    int n = s->camera->inset_count < 2 ? 2 : s->camera->inset_count;
    return (s->panel_width - (n - 1) * GAP) / n;
}

static int inset_height(const lab_sheet *s, int inset) {
    const int *box = s->camera->insets[inset].box;
    int height = (int)((double)inset_width(s) * box[3] / box[2] + 0.5);
    return height < 1 ? 1 : height > s->picture_height ? s->picture_height : height;
}

noc_status lab_start_sheet(lab_sheet *s, const lab_crop *crop, const lab_camera *camera, size_t panels,
                           const char *name, noc_log *log) {
    int columns = crop->columns, rows = ((int)panels + columns - 1) / columns, insets = 0;
    *s = (lab_sheet){ .crop = crop,
                      .camera = camera,
                      .panel_width = crop->width * crop->scale,
                      .picture_height = crop->height * crop->scale };
    for (int i = 0; i < camera->inset_count; i++)
        insets = inset_height(s, i) > insets ? inset_height(s, i) : insets;
    s->panel_height = LABEL + s->picture_height + (insets ? GAP + insets + NAME : 0);
    s->width = columns * s->panel_width + (columns - 1) * GAP;
    s->height = rows * s->panel_height + (rows - 1) * GAP;
    if (s->width > NOC_IMAGE_MAX_SIDE || s->height > NOC_IMAGE_MAX_SIDE)
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: it would be larger than %d px", name, NOC_IMAGE_MAX_SIDE);
    size_t bytes = (size_t)s->width * (size_t)s->height * 3;
    s->rgb = noc_alloc(bytes);
    if (!s->rgb)
        return noc_no_memory(log, name);
    memset(s->rgb, 40, bytes);
    return NOC_OK;
}

/* A box of a picture, enlarged to so many pixels: each is the nearest of the picture's. */
static void enlarge(lab_sheet *s, const uint8_t *rgb, int width, const int box[4], int left, int top, int w, int h) {
    for (int y = 0; y < h; y++) {
        const uint8_t *row =
            rgb + ((size_t)(box[1] + (int)((long long)y * box[3] / h)) * (size_t)width + (size_t)box[0]) * 3;
        uint8_t *to = s->rgb + ((size_t)(top + y) * (size_t)s->width + (size_t)left) * 3;
        for (int x = 0; x < w; x++)
            memcpy(to + 3 * (size_t)x, row + 3 * (size_t)((long long)x * box[2] / w), 3);
    }
}

static void dot(lab_sheet *s, int x, int y, const uint8_t colour[3]) {
    if (x >= 0 && y >= 0 && x < s->width && y < s->height)
        memcpy(s->rgb + ((size_t)y * (size_t)s->width + (size_t)x) * 3, colour, 3);
}

/* Inside a rectangle of the sheet, along its edges. */
static void frame(lab_sheet *s, int left, int top, int w, int h, const uint8_t colour[3]) {
    for (int k = 0; k < FRAME; k++) {
        for (int x = 0; x < w; x++) {
            dot(s, left + x, top + k, colour);
            dot(s, left + x, top + h - 1 - k, colour);
        }
        for (int y = 0; y < h; y++) {
            dot(s, left + k, top + y, colour);
            dot(s, left + w - 1 - k, top + y, colour);
        }
    }
}

/* As large as fits; what is too long even for small letters ends in dots. */
static void write_in(lab_sheet *s, int x, int y, int w, const char *text, int scale, const uint8_t colour[3]) {
    char cut[LAB_TEXT];
    noc_snprintf(cut, sizeof(cut), "%s", text);
    while (scale > 1 && noc_text_srgb8(NULL, 0, 0, 0, 0, cut, scale, colour) > w)
        scale--;
    for (size_t n = strlen(cut); n > 3 && noc_text_srgb8(NULL, 0, 0, 0, 0, cut, scale, colour) > w; n--) {
        while (n > 4 && (cut[n - 4] & 0xc0) == 0x80) /* a whole character of UTF-8 goes */
            n--;
        memcpy(cut + n - 4, "...", 4);
    }
    noc_text_srgb8(s->rgb, s->width, s->height, x, y, cut, scale, colour);
}

void lab_add_panel(lab_sheet *s, size_t panel, const uint8_t *rgb, int width, const char *label) {
    static const uint8_t white[3] = { 235, 235, 235 };
    const lab_crop *crop = s->crop;
    int left = (int)(panel % (size_t)crop->columns) * (s->panel_width + GAP),
        top = (int)(panel / (size_t)crop->columns) * (s->panel_height + GAP);
    write_in(s, left + 2, top + 2, s->panel_width - 4, label, 2, white);
    if (!rgb)
        return;
    top += LABEL;
    enlarge(s, rgb, width, (const int[]){ crop->x, crop->y, crop->width, crop->height }, left, top, s->panel_width,
            s->picture_height);
    for (int i = 0; i < s->camera->inset_count; i++) {
        const lab_inset *in = &s->camera->insets[i];
        int w = inset_width(s), h = inset_height(s, i), x = left + i * (w + GAP), y = top + s->picture_height + GAP;
        enlarge(s, rgb, width, in->box, x, y, w, h);
        frame(s, x, y, w, h, colours[i].rgb);
        write_in(s, x, y + h + 3, w, in->name, 1, colours[i].rgb);
    }
    for (int i = 0; i < s->camera->inset_count; i++) {
        const int *box = s->camera->insets[i].box;
        frame(s, left + box[0] * crop->scale - FRAME, top + box[1] * crop->scale - FRAME,
              box[2] * crop->scale + 2 * FRAME, box[3] * crop->scale + 2 * FRAME, colours[i].rgb);
    }
}
