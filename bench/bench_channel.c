/* What colouring a channel costs, CPU ms: median of 15 rounds.
 *
 *   bench_channel [WIDTH HEIGHT]     default: 1280 720 */
#include "base/base.h"
#include <nocturne/image.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 15 };

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure(const char *what, const noc_channel *c, const noc_channel_params *p) {
    double ms[ROUNDS];
    for (int i = 0; i < ROUNDS; i++) {
        uint8_t *rgb = NULL;
        int width, height;
        double start = noc_cpu_seconds();
        if (noc_channel_to_srgb8(c, p, &rgb, &width, &height, NULL))
            exit(1);
        ms[i] = 1e3 * (noc_cpu_seconds() - start);
        free(rgb);
    }
    qsort(ms, ROUNDS, sizeof(*ms), compare);
    printf("%-40s %6.2f ms\n", what, ms[ROUNDS / 2]);
}

int main(int argc, char **argv) {
    int width = argc > 2 ? atoi(argv[1]) : 1280, height = argc > 2 ? atoi(argv[2]) : 720;
    noc_channel *c = noc_channel_create(width, height, 1, NULL);
    if (!c)
        return 1;
    uint32_t h = 1;
    for (int i = 0; i < width * height; i++) { /* hills and noise over three decades, a tenth without a value */
        double x = i % width * 0.011, y = i / width * 0.017;
        h = h * 1664525u + 1013904223u;
        c->value[i] = h >> 28 ? (float)pow(10, 1.5 * sin(x) * cos(y) + 0.1 * (h >> 8) / (1 << 24)) : -1;
    }
    noc_channel_params found = { 0 }, told = { .low = 0.03, .high = 50 }, alone = told, isolines = told;
    alone.part = isolines.part = NOC_CHANNEL_PICTURE;
    isolines.isolines = (noc_isolines){ { 1, 2, 5, 10, 20 }, .count = 5 };
    c->scale = NOC_CHANNEL_LOG;
    measure("logarithmic, ends found, legend", c, &found);
    measure("logarithmic, ends told, legend", c, &told);
    measure("logarithmic, picture alone", c, &alone);
    measure("logarithmic, picture with five isolines", c, &isolines);
    c->scale = NOC_CHANNEL_LINEAR;
    measure("linear, picture alone", c, &alone);
    alone.part = NOC_CHANNEL_LEGEND;
    measure("legend alone, ends told", c, &alone);
    c->scale = NOC_CHANNEL_LABELS;
    alone.part = NOC_CHANNEL_PICTURE;
    for (int i = 0; i < width * height; i++)
        c->value[i] = (float)(i % width / 8 + i / width / 8 * (width / 8));
    measure("labels, picture alone", c, &alone);
    noc_channel_destroy(c);
    return 0;
}
