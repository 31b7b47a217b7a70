/* The brightness of the night sky in the words of those who measure it. */
#include "base/base.h"

#include <nocturne/render.h>

#include <math.h>

/* cd/m2 of 0 mag/arcsec2 (units of the sky's brightness: lightpollution.pk.edu.pl). */
#define SKY_ZERO 108000.0
#define SQM_BRIGHTEST 14.0
#define SQM_DARKEST 25.0

/* mag/arcsec2 of Bortle's classes 1 to 9: docs/defaults.md, "Sky". */
static const double bortle[] = { 21.9, 21.6, 21.4, 20.8, 19.8, 18.9, 18.3, 17.6, 16.8 };

double noc_sky_luminance(double sqm) { return SKY_ZERO * pow(10, -0.4 * sqm); }

double noc_sky_sqm(double luminance) { return luminance > 0 ? -2.5 * log10(luminance / SKY_ZERO) : NAN; }

const char *noc_sky_read(const char *text, double *luminance) {
    double number;
    if (!text || !luminance)
        return "is missing";
    if (!strncmp(text, "sqm:", 4)) {
        if (!noc_parse_double(text + 4, &number) || !(number >= SQM_BRIGHTEST && number <= SQM_DARKEST))
            return "is not sqm:14 to sqm:25 (mag/arcsec2)";
        *luminance = noc_sky_luminance(number);
        return NULL;
    }
    if (!strncmp(text, "bortle:", 7)) {
        if (!noc_parse_double(text + 7, &number) || !(number >= 1 && number <= 9) || number != floor(number))
            return "is not bortle:1 to bortle:9";
        *luminance = noc_sky_luminance(bortle[(int)number - 1]);
        return NULL;
    }
    return "is not a number (cd/m2), sqm:14 to sqm:25 or bortle:1 to bortle:9";
}
