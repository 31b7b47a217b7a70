/* Lines in a channel's picture where its numbers pass given values. */
#include "image/legend.h"

#include <nocturne/text.h>

#include <math.h>

bool isolines_good(const noc_isolines *lines) {
    bool good = lines->count >= 0 && lines->count <= NOC_ISOLINES && lines->round >= 0 && lines->round <= NOC_ISOLINES;
    for (int i = 0; good && i < lines->count; i++)
        good = isfinite(lines->value[i]) && lines->value[i] > (i ? lines->value[i - 1] : 0);
    return good;
}

bool noc_isolines_parse(const char *text, noc_isolines *lines) {
    enum { LONGEST = 30 * NOC_ISOLINES };
    char copy[LONGEST];
    size_t length = text ? strlen(text) : 0, count = 1;
    noc_isolines read = { .count = 0 };
    if (!lines || !length || length >= sizeof(copy))
        return false;
    memcpy(copy, text, length + 1);
    bool list = strchr(copy, ',') != NULL;
    if (copy[length - 1] == ',')
        copy[length - 1] = 0;
    for (const char *at = copy; *at; at++)
        count += *at == ',';
    if (count > NOC_ISOLINES || !noc_text_numbers(copy, ',', count, read.value))
        return false;
    if (list) {
        read.count = (int)count;
    } else {
        if (read.value[0] != floor(read.value[0]) || !(read.value[0] >= 0 && read.value[0] <= NOC_ISOLINES))
            return false;
        read = (noc_isolines){ .round = (int)read.value[0] };
    }
    if (!isolines_good(&read))
        return false;
    *lines = read;
    return true;
}

int noc_isolines_text(const noc_isolines *lines, char *text, size_t size) {
    char all[30 * NOC_ISOLINES] = "";
    size_t n = 0;
    if (!lines || !isolines_good(lines))
        return -1;
    if (!lines->count)
        return noc_snprintf(text, size, "%d", lines->round);
    for (int i = 0; i < lines->count; i++) /* one has a comma behind it */
        n += (size_t)noc_snprintf(all + n, sizeof(all) - n, "%s%.15g%s", i ? "," : "", lines->value[i],
                                  lines->count == 1 ? "," : "");
    return noc_snprintf(text, size, "%s", all);
}

/* What is smoothed and looked at, on the bar's scale: NAN where a pixel has no value. */
typedef struct field {
    const legend *l;
    int width, height, reach; /* smoothed over 2 reach + 1 pixels each way */
    float *value;
    uint8_t *line; /* number + 1 of the line through a pixel; 0: none */
} field;

static float scaled(const legend *l, float v) {
    if (!isfinite(v) || v < 0)
        return NAN;
    return l->bar.logarithmic ? log2f(fmaxf(v, 1e-30f)) : v;
}

/* Means over a span of `count` numbers of those that there are; in place. before: room for so
 * many. */
static void smooth(float *v, int count, int reach, float *before) {
    double sum = 0;
    int some = 0;
    for (int i = 0; i < count; i++)
        before[i] = v[i];
    for (int i = -reach; i < count; i++) {
        if (i + reach < count && !isnan(before[i + reach])) {
            sum += before[i + reach];
            some++;
        }
        if (i > reach && !isnan(before[i - reach - 1])) {
            sum -= before[i - reach - 1];
            some--;
        }
        if (i >= 0 && !isnan(before[i]))
            v[i] = (float)(sum / some);
    }
}

/* Columns are smoothed side by side, so that memory is read along rows. */
enum { SIDE = 16 };
static void smooth_columns(field *f, int x, float *before) {
    float *room = before + f->height;
    int n = NOC_MIN(SIDE, f->width - x);
    for (int y = 0; y < f->height; y++)
        for (int k = 0; k < n; k++)
            room[k * f->height + y] = f->value[(size_t)y * (size_t)f->width + (size_t)(x + k)];
    for (int k = 0; k < n; k++)
        smooth(room + (size_t)k * (size_t)f->height, f->height, f->reach, before);
    for (int y = 0; y < f->height; y++)
        for (int k = 0; k < n; k++)
            f->value[(size_t)y * (size_t)f->width + (size_t)(x + k)] = room[k * f->height + y];
}

/* The line between two neighbours, as its number + 1; 0: none. Where numbers jump, as at the edges of things, there is
 * none either. */
static uint8_t between(const field *f, const float *at, float a, float b) {
    float low = fminf(a, b), high = fmaxf(a, b), step = 0.8f / (float)(2 * f->reach + 1);
    for (size_t k = 0; k < f->l->bar.line_count; k++)
        if (low < at[k] && high >= at[k])
            return high - low > step * (f->l->bar.logarithmic ? 1 : at[k] * 0.7f) ? 0 : (uint8_t)(k + 1);
    return 0;
}

static void find_lines(field *f) {
    const legend *l = f->l;
    float at[NOC_ISOLINES];
    size_t w = (size_t)f->width;
    for (size_t k = 0; k < l->bar.line_count; k++)
        at[k] = scaled(l, (float)l->lines[k]);
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++) {
            size_t i = (size_t)y * w + (size_t)x;
            float here = f->value[i], right = x + 1 < f->width ? f->value[i + 1] : NAN;
            float below = y + 1 < f->height ? f->value[i + w] : NAN;
            uint8_t line = isnan(here) || isnan(right) ? 0 : between(f, at, here, right);
            f->line[i] = line || isnan(here) || isnan(below) ? line : between(f, at, here, below);
        }
}

/* false: no memory. */
static bool field_make(field *f, const legend *l) {
    const noc_channel *c = l->channel;
    size_t n = channel_pixels(c);
    *f = (field){ .l = l, .width = c->width, .height = c->height, .reach = 2 * l->scale };
    f->value = noc_alloc_large(n, sizeof(*f->value));
    f->line = noc_alloc_large(n, 1);
    size_t most = (size_t)NOC_MAX(c->width, (SIDE + 1) * c->height);
    float *before = noc_alloc_large(most, sizeof(*before));
    if (!f->value || !f->line || !before) {
        free(before);
        return false;
    }
    for (size_t i = 0; i < n; i++)
        f->value[i] = scaled(l, c->value[i]);
    for (int y = 0; y < c->height; y++)
        smooth(f->value + (size_t)y * (size_t)c->width, c->width, f->reach, before);
    for (int x = 0; x < c->width; x += SIDE)
        smooth_columns(f, x, before);
    free(before);
    find_lines(f);
    return true;
}

static void field_free(field *f) {
    free(f->value);
    free(f->line);
}

/* Values beside lines: in each cell of a grid one of each line, where it comes nearest to the cell's middle, and as
 * long as they do not touch. */
enum { CELL = 220, MOST = 96, LENGTH = 24 };
typedef struct box {
    int x, y, width, height;
} box;

static bool touches(const box *a, const box *b, int count) {
    for (int i = 0; i < count; i++)
        if (a->x < b[i].x + b[i].width && b[i].x < a->x + a->width && a->y < b[i].y + b[i].height &&
            b[i].y < a->y + a->height)
            return true;
    return false;
}

/* Of each line the pixel of a cell that is next to its middle; x < 0: it does not pass through, or for a few pixels. */
static void nearest(const field *f, const box *cell, int (*at)[2]) {
    int best[NOC_ISOLINES], length[NOC_ISOLINES] = { 0 };
    for (size_t k = 0; k < f->l->bar.line_count; k++) {
        best[k] = INT32_MAX;
        at[k][0] = -1;
    }
    for (int y = cell->y; y < NOC_MIN(cell->y + cell->height, f->height); y++)
        for (int x = cell->x; x < NOC_MIN(cell->x + cell->width, f->width); x++) {
            int dx = x - cell->x - cell->width / 2, dy = y - cell->y - cell->height / 2, far = dx * dx + dy * dy;
            int line = f->line[(size_t)y * (size_t)f->width + (size_t)x];
            if (line)
                length[line - 1]++;
            if (!line || far >= best[line - 1])
                continue;
            best[line - 1] = far;
            at[line - 1][0] = x;
            at[line - 1][1] = y;
        }
    for (size_t k = 0; k < f->l->bar.line_count; k++)
        if (length[k] < LENGTH * f->l->scale)
            at[k][0] = -1;
}

static void label_cell(const field *f, canvas *to, int left, const box *cell, box *taken, int *count) {
    const legend *l = f->l;
    int at[NOC_ISOLINES][2];
    nearest(f, cell, at);
    for (size_t k = 0; k < l->bar.line_count && *count < MOST; k++) {
        char text[32];
        if (at[k][0] < 0)
            continue;
        noc_snprintf(text, sizeof(text), "%.6g", l->lines[k]);
        int w = text_width(text, l->scale) + 2 * l->scale, h = (TEXT_HEIGHT + 2) * l->scale;
        box b = { at[k][0] - w / 2, at[k][1] - h / 2, w, h };
        bool inside = b.x >= 0 && b.y >= 0 && b.x + w <= f->width && b.y + h <= f->height;
        if (!inside || touches(&b, taken, *count))
            continue;
        taken[(*count)++] = b;
        const uint8_t *on = colormap_at(l->bar.map, colorbar_position(&l->bar, l->lines[k]));
        canvas_fill(to, left + b.x, b.y, w, h, on);
        text_draw(to, left + b.x + l->scale, b.y + l->scale, text, l->scale, colormap_ink(on));
    }
}

static void draw_values(const field *f, canvas *to, int left) {
    int size = CELL * f->l->scale / 2 + CELL / 2, count = 0;
    box taken[MOST];
    for (int y = 0; y < f->height; y += size)
        for (int x = 0; x < f->width; x += size)
            label_cell(f, to, left, &(box){ x, y, size, size }, taken, &count);
}

noc_status isolines_draw(const legend *l, canvas *to, int left, noc_log *log) {
    field f;
    if (!field_make(&f, l)) {
        field_free(&f);
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for the isolines of %d x %d pixels", l->channel->name,
                         l->channel->width, l->channel->height);
    }
    int thick = l->scale;
    for (int y = 0; y < f.height; y++)
        for (int x = 0; x < f.width; x++) {
            int line = f.line[(size_t)y * (size_t)f.width + (size_t)x];
            if (!line)
                continue;
            const uint8_t *on = colormap_at(l->bar.map, colorbar_position(&l->bar, l->lines[line - 1]));
            canvas_fill(to, left + x, y, NOC_MIN(thick, f.width - x), NOC_MIN(thick, f.height - y), colormap_ink(on));
        }
    draw_values(&f, to, left);
    field_free(&f);
    return NOC_OK;
}
