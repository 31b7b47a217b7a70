/* Colour spaces of pictures: matrices to the working space, linear Rec. 709 with D65 as white. */
#include "image/internal.h"

#include <math.h>

#define SMALLEST 1e-6 /* of a white's y, of the area of primaries, of what a primary adds to white */

const colour_space colour_rec709 = { { { 0.64, 0.33 }, { 0.30, 0.60 }, { 0.15, 0.06 }, { 0.3127, 0.3290 } } };

/* Bradford's cone responses of CIE XYZ, as ICC and OpenEXR have them. */
static const double cones[3][3] = { { 0.8951, 0.2664, -0.1614 },
                                    { -0.7502, 1.7135, 0.0367 },
                                    { 0.0389, -0.0685, 1.0296 } };

void colour_apply(const double m[3][3], const double from[3], double to[3]) {
    for (int i = 0; i < 3; i++)
        to[i] = m[i][0] * from[0] + m[i][1] * from[1] + m[i][2] * from[2];
}

static void multiply(const double a[3][3], const double b[3][3], double to[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            to[i][k] = a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k];
}

static double determinant(const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static void invert(const double m[3][3], double to[3][3]) {
    double d = determinant(m);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
            to[i][k] = (m[a][c] * m[b][e] - m[a][e] * m[b][c]) / d;
        }
}

static void tristimulus(const double xy[2], double xyz[3]) { /* at Y = 1 */
    xyz[0] = xy[0] / xy[1];
    xyz[1] = 1;
    xyz[2] = (1 - xy[0] - xy[1]) / xy[1];
}

/* RGB to XYZ, white having Y = 1; what is wrong with the space, or NULL. */
static const char *rgb_to_xyz(const colour_space *space, double to[3][3]) {
    const double(*xy)[2] = space->xy;
    double primaries[3][3], inverse[3][3], white[3], part[3];
    for (int k = 0; k < 4; k++)
        if (!(fabs(xy[k][0]) < 1e6 && fabs(xy[k][1]) < 1e6))
            return "not all of them are numbers";
    if (xy[3][1] < SMALLEST)
        return "their white has no luminance";
    for (int k = 0; k < 3; k++) {
        primaries[0][k] = xy[k][0];
        primaries[1][k] = xy[k][1];
        primaries[2][k] = 1 - xy[k][0] - xy[k][1];
    }
    if (fabs(determinant(primaries)) < SMALLEST)
        return "red, green and blue lie on one line";
    invert(primaries, inverse);
    tristimulus(xy[3], white);
    colour_apply(inverse, white, part);
    for (int k = 0; k < 3; k++) {
        if (fabs(part[k]) < SMALLEST)
            return "their white lies on the line between two of red, green and blue";
        for (int i = 0; i < 3; i++)
            to[i][k] = primaries[i][k] * part[k];
    }
    return NULL;
}

/* XYZ to XYZ, so that what had the colour `neutral` has that of D65. */
static const char *adapt(const double neutral[2], double to[3][3]) {
    double white[3], from[3], d65[3], scaled[3][3], inverse[3][3];
    if (!(fabs(neutral[0]) < 1e6 && neutral[1] >= SMALLEST && neutral[1] < 1e6))
        return "their neutral has no luminance";
    tristimulus(neutral, white);
    colour_apply(cones, white, from);
    tristimulus(colour_rec709.xy[3], white);
    colour_apply(cones, white, d65);
    for (int i = 0; i < 3; i++) {
        if (from[i] < SMALLEST)
            return "their white is no colour that eyes could adapt to";
        for (int k = 0; k < 3; k++)
            scaled[i][k] = cones[i][k] * d65[i] / from[i];
    }
    invert(cones, inverse);
    multiply(inverse, scaled, to);
    return NULL;
}

/* XYZ under a neutral to the working space. */
static const char *from_xyz(const double neutral[2], double to[3][3]) {
    double bradford[3][3], working[3][3], inverse[3][3];
    const char *fault = adapt(neutral, bradford);
    if (fault || (fault = rgb_to_xyz(&colour_rec709, working)))
        return fault;
    invert(working, inverse);
    multiply(inverse, bradford, to);
    return NULL;
}

const char *colour_from_xyz(const double *neutral, double to[3][3]) {
    return from_xyz(neutral ? neutral : colour_rec709.xy[3], to);
}

const char *colour_from_rgb(const colour_space *space, double to[3][3]) {
    double xyz[3][3], working[3][3];
    const char *fault = rgb_to_xyz(space, xyz);
    if (fault || (fault = from_xyz(space->xy[3], working)))
        return fault;
    multiply(working, xyz, to);
    return NULL;
}

const char *colour_luminance(const colour_space *space, double y[3]) {
    double xyz[3][3];
    const char *fault = rgb_to_xyz(space, xyz);
    for (int k = 0; k < 3 && !fault; k++)
        y[k] = xyz[1][k];
    return fault;
}

bool colour_near(const colour_space *a, const colour_space *b) {
    for (int k = 0; k < 4; k++)
        if (!(fabs(a->xy[k][0] - b->xy[k][0]) < 1e-6 && fabs(a->xy[k][1] - b->xy[k][1]) < 1e-6))
            return false;
    return true;
}
