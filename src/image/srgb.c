/* The sRGB transfer function, IEC 61966-2-1. */
#include "image/internal.h"

#include <math.h>

double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

double srgb_decode(double code) { return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4); }

void srgb8_table_init(srgb8_table *table) {
    for (int i = 0; i < 255; i++)
        table->threshold[i] = (float)srgb_decode((i + 0.5) / 255);
}

/* Bisection in the thresholds: rounds exactly, and is faster than pow. */
uint8_t srgb8_encode(const srgb8_table *table, float linear) {
    int code = 0;
    for (int step = 128; step; step /= 2)
        if (linear >= table->threshold[code + step - 1])
            code += step;
    return (uint8_t)code;
}
