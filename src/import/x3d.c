/* Materials as X3D has them, which CityGML and CityJSON took over, as ours. */
#include "import/import.h"

#include <math.h>

#define DIELECTRIC                                                                                                     \
    0.04 /* reflectance at normal incidence that a specular colour of 1 stands for: glass, paint, stone */
#define GREATEST_EXPONENT 128 /* X3D: shininess 1 */
#define DARKEST NOC_TEXTURE_DARKEST
#define BRIGHTEST NOC_TEXTURE_BRIGHTEST

static double linear_of(double code) { return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4); }

void import_x3d_colour(geo_appearance *a, const double rgb[3]) {
    a->coloured = true;
    for (int k = 0; k < 3; k++) {
        double code = isfinite(rgb[k]) ? NOC_CLAMP(rgb[k], 0, 1) : 0;
        a->albedo[k] = (float)NOC_CLAMP(linear_of(code), DARKEST, BRIGHTEST);
    }
}

void import_x3d_transparency(geo_appearance *a, double transparency, geo_issues *issues) {
    a->transmittance = isfinite(transparency) ? (float)NOC_CLAMP(transparency, 0, 1) : 0;
    if (!isfinite(transparency))
        geo_issue(issues, GEO_GUESSED, "transparency that is no number, taken as opaque", a->name);
    else if (transparency < 0 || transparency > 1)
        geo_issue(issues, GEO_GUESSED, "material values out of range, clamped", a->name);
}

/* The exponent of a Phong lobe as alpha of GGX: Walter et al. 2007, "Microfacet Models for Refraction through Rough
 * Surfaces", Beckmann's 2 / alpha^2 - 2. */
void import_x3d_gloss(geo_appearance *a, const double specular[3], double shininess) {
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = isfinite(specular[k]) ? NOC_MAX(most, specular[k]) : most;
    double exponent = GREATEST_EXPONENT * (isfinite(shininess) ? NOC_CLAMP(shininess, 0, 1) : 0);
    a->f0 = (float)(DIELECTRIC * NOC_MIN(most, 1));
    a->roughness = (float)NOC_CLAMP(sqrt(sqrt(2 / (exponent + 2))), 0.05, 1);
}
