/* nocturne/photometry.h: luminous intensity distributions of luminaires, from IES LM-63 and EULUMDAT files, from
 * numbers, or built in. noc_scene_add_profile (nocturne/scene.h) gives them to lights.
 *
 * Directions are those of CIE 121 (C, gamma), in degrees: gamma is the angle from the luminaire's axis, which points
 * straight down as it was measured, and C turns around the axis, counter-clockwise as seen from above. Files of
 * photometric type A and B are turned into these: the axis is then the way the floodlight aims, C 0 is to its right and
 * C 90 upwards, as seen from behind it. */
#ifndef NOCTURNE_PHOTOMETRY_H
#define NOCTURNE_PHOTOMETRY_H

#include <nocturne/log.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct noc_profile noc_profile;

/* Lumens between angles of gamma, of one side of a luminaire: IES TM-15's zones. */
typedef struct noc_profile_zones {
    double low, medium, high, very_high; /* 0 to 30, 30 to 60, 60 to 80, 80 to 90 degrees */
} noc_profile_zones;

/* Texts live as long as the profile. Angles are in degrees, intensities in cd, flux in lm. */
typedef struct noc_profile_info {
    const char *format;       /* "IES LM-63-2002, type C", "EULUMDAT", "numbers", "built in" */
    const char *name;         /* of the luminaire, "" if there is none */
    const char *manufacturer; /* "" if there is none */
    const char *lamp;         /* "" if there is none */
    const char *symmetry;     /* "about the axis", "C 0-180", "C 0-90", "C 90-270", "none" */
    double lamp_lumens;       /* of all lamps, with ballast factors; NaN: absolute photometry, which states none */
    /* Light output ratio that is stated; NaN where none is, as in all IES files. EULUMDAT states one, and a file of
     * relative photometry no more than 1. */
    double lor;
    double lumens;     /* of the luminaire: the integral of its intensities over the sphere */
    double flux_error; /* lumens / (lamp_lumens lor) - 1; IES: what is above lamp_lumens, else 0; NaN: nothing stated */
    double peak, peak_c, peak_gamma;
    double upward;       /* upward light ratio: share of the lumens above 90 degrees */
    int planes, gammas;  /* angles as the file has them */
    double c_min, c_max; /* of the file */
    double gamma_min, gamma_max;
    double street;  /* the C angle that looks across the street, by the light itself: the end that more of it goes to;
                     * where ends are alike, across from where it reaches farther; else 0 in IES files, 90 in EULUMDAT;
                     * of types A and B 90 */
    double watts;   /* 0: not told */
    double kelvin;  /* colour temperature by its colour appearance or its labels ("LED 4000K"); 0: not told */
    int lamp_sets;  /* EULUMDAT: the first one counts */
    double size[3]; /* luminous opening: width, length, height, m; negative as in IES files: round */
    noc_profile_zones forward; /* the half of it around `street` */
    noc_profile_zones back;    /* the other half */
    double up_low, up_high;    /* 90 to 100, 100 to 180 degrees */
    int bug[3];                /* backlight, uplight and glare ratings 0 to 5 of TM-15, for asymmetric luminaires */
    const double *c, *gamma;   /* the grid that `cd` is of, all around: c_count planes of gamma_count intensities */
    int c_count, gamma_count;
    const double *cd; /* plane after plane */
} noc_profile_info;

/* Above so much of flux_error a file is warned of: a 1 % grid error is usual, more is not. */
#define NOC_PROFILE_TOLERANCE 0.05

/* Reads a file, told apart by its content; *profile is NULL after an error. */
NOC_API noc_status noc_profile_load(noc_log *log, const char *path, noc_profile **profile);
/* The same of bytes; name is for messages. */
NOC_API noc_status noc_profile_read(noc_log *log, const void *data, size_t size, const char *name,
                                    noc_profile **profile);

/* Made of numbers: planes at ascending angles c, gammas at ascending angles gamma within 0..180, cd[plane * gammas +
 * gamma] not negative. The last angle says what the planes mean, as in LM-63: one plane at 0: all around; up to 90: a
 * quarter; up to 180: a half; from 90 to 270: a half of C 90-270; up to 360: all, where 360 may be left out when the
 * first is 0. No light is below the first and beyond the last gamma. All are copied. */
typedef struct noc_profile_params {
    const char *name; /* NULL: none */
    int planes, gammas;
    const double *c, *gamma, *cd;
    double street; /* the C angle that looks across the street */
} noc_profile_params;
NOC_API noc_status noc_profile_create(noc_log *log, const noc_profile_params *params, noc_profile **profile);

/* Distributions of our own making, none of which is a measured luminaire: "cobra-head" (a road luminaire on an arm,
 * full cut-off, two beams along the road), "post-top" (a lantern, alike all around, not cut off), "wall" (all forward,
 * full cut-off), "flood" (about its own axis, half its peak at 30 degrees), "bollard" (a ring on the ground, full
 * cut-off): C 0 is the street. "low-beam" is a car's headlamp on roads that are driven on the right: its axis looks
 * ahead and level, C 0 to the right. */
NOC_API noc_status noc_profile_builtin(noc_log *log, const char *name, noc_profile **profile);
NOC_API const char *noc_profile_builtin_name(int i); /* from 0; NULL beyond the last */

NOC_API void noc_profile_destroy(noc_profile *profile); /* NULL is allowed */
NOC_API void noc_profile_get_info(const noc_profile *profile, noc_profile_info *info);
/* Luminous intensity in a direction, cd, linear between the angles of the grid. */
NOC_API double noc_profile_intensity(const noc_profile *profile, double c, double gamma);
/* Luminous flux within those gammas and a half turn around C angle `c`, or all around where c is NaN, lm. */
NOC_API double noc_profile_flux(const noc_profile *profile, double gamma_min, double gamma_max, double c);
/* Does it look like a file of this kind? head: at least the first 2 kB of it, or all. */
NOC_API bool noc_profile_probe(const void *head, size_t size);

#ifdef __cplusplus
}
#endif
#endif
