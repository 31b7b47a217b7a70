/* Colours of temperatures. */
#include "base/base.h"

#include <nocturne/luminaire.h>

#include <math.h>

/* Krystek's approximation of the Planckian locus in CIE 1960 (u, v), 1000..15000 K: M. Krystek, "An algorithm to
 * calculate correlated colour temperature", Color Research & Application 10 (1985) 38-40. Then (u, v) -> (x, y) -> XYZ
 * with Y = 1 -> linear Rec.709 (IEC 61966-2-1 matrix). What lies outside the gamut is clipped, and the luminance made 1
 * again. */
void noc_kelvin_rgb(double kelvin, float rgb[3]) {
    double t = isfinite(kelvin) ? NOC_CLAMP(kelvin, 1000, 15000) : 6500;
    double u =
        (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t);
    double v =
        (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t);
    double d = 2 * u - 8 * v + 4, x = 3 * u / d, y = 2 * v / d;
    double X = x / y, Z = (1 - x - y) / y;
    double c[3] = { 3.2404542 * X - 1.5371385 - 0.4985314 * Z, -0.9692660 * X + 1.8760108 + 0.0415560 * Z,
                    0.0556434 * X - 0.2040259 + 1.0572252 * Z };
    for (int i = 0; i < 3; i++)
        c[i] = NOC_MAX(c[i], 0);
    double luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    for (int i = 0; i < 3 && rgb; i++)
        rgb[i] = (float)(c[i] / luminance);
}

double noc_rgb_kelvin(const float rgb[3]) {
    double low = 1000, high = 15000;
    float c[3];
    if (!rgb)
        return NAN;
    double luminance = .2126 * rgb[0] + .7152 * rgb[1] + .0722 * rgb[2];
    if (!(luminance > 0))
        return NAN;
    for (int i = 0; i < 50; i++) { /* less red, and more of the others, the hotter it is */
        double middle = (low + high) / 2;
        noc_kelvin_rgb(middle, c);
        bool hotter = (rgb[1] + rgb[2]) * (double)c[0] > (c[1] + c[2]) * (double)rgb[0];
        *(hotter ? &low : &high) = middle;
    }
    noc_kelvin_rgb(low, c);
    for (int i = 0; i < 3; i++)
        if (!(fabs(rgb[i] / luminance - c[i]) <= 1e-3))
            return NAN;
    return low;
}
