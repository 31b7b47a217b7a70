/* Surveyed heights of lamps: whether they are heights of this city, and the ground that is laid through them. */
#include "city/city.h"
#include "import/load/load.h"

#include <math.h>

#define OTHER_SYSTEM                                                                                                   \
    8.0 /* m off, all alike: another height system. Those in use in one country differ by less, or by some 50 m */
#define ALIKE 0.2   /* of that offset: half of the lamps lie within so much of it */
#define STEEP 0.2   /* a lamp is believed that far off what the city tells, for each metre to where it tells it */
#define OFF 3.0     /* m more */
#define ON_DECK 2.0 /* m between a lamp's foot and the deck of a bridge that it stands on */

/* Height of the ground that the city tells of, and how far away it tells it; false where it does not. */
static bool told_height(const importer *im, const city_ground *ground, const double *p, double *z, double *distance) {
    *distance = 0;
    if (!ground)
        return noc_scene_ground(im->scene, p[0], p[1], z);
    *z = city_ground_height(ground, p[0], p[1], distance);
    return isfinite(*distance);
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, size_t count) {
    qsort(values, count, sizeof(*values), compare_doubles);
    return values[count / 2];
}

/* The unit that brings lamps to the ground; NULL: none. `ground` is its height where they are `off` it. */
static const char *unit_to_ground(const importer *im, size_t index, double ground, double off) {
    static const double units[] = { 1, .3048 };
    const input *in = &im->inputs[index];
    double unit = in->sources.len ? in->sources.data[0]->unit : 1;
    for (size_t i = 0; i < NOC_COUNT(units) && !(in->unit > 0); i++)
        if (fabs(units[i] / unit - 1) > .01 && fabs((ground + off) * units[i] / unit - ground) < .03 * fabs(ground))
            return height_unit_word(units[i]);
    return NULL;
}

/* One input's lamps: forgets their heights where all of them are off alike. */
static void check_input(importer *im, const city_ground *ground, size_t index, double *off) {
    size_t n = 0;
    double ground_z = 0;
    bool zero = true; /* heights that are none are 0 */
    for (size_t i = 0; i < im->lamps.len; i++) {
        const pending_lamp *p = &im->lamps.data[i];
        double z, distance;
        if (p->input != index || !isfinite(p->lamp.xyz[2]) || !told_height(im, ground, p->lamp.xyz, &z, &distance))
            continue;
        off[n++] = p->lamp.xyz[2] - z;
        ground_z += z;
        zero = zero && fabs(p->lamp.xyz[2] + im->origin[2]) < 1e-3;
    }
    if (n < (zero ? 1 : 3))
        return;
    double middle = median(off, n);
    for (size_t i = 0; i < n; i++)
        off[i] = fabs(off[i] - middle);
    if (!(fabs(middle) > OTHER_SYSTEM && median(off, n) < ALIKE * fabs(middle)))
        return;
    for (size_t i = 0; i < im->lamps.len; i++)
        if (im->lamps.data[i].input == index)
            im->lamps.data[i].lamp.xyz[2] = NAN;
    const char *path = im->inputs[index].path, *unit = unit_to_ground(im, index, ground_z / (double)n, middle);
    char mend[240] = "";
    if (unit)
        noc_snprintf(mend, sizeof(mend), "; pass --height-unit %.200s=%s if they are in that unit", path, unit);
    noc_warn(
        im->log,
        "%s: its %zu lamps with a height lie some %.1f m %s the city's ground, alike: are their heights of another "
        "system (ellipsoidal, another datum, feet)? They are not followed: the lamps stand on the ground%s",
        path, n, fabs(middle), middle > 0 ? "above" : "below", mend);
    geo_issues_add(im->inputs[index].issues, GEO_GUESSED, "elevation of a lamp of another system, not followed", n, "");
}

/* What was laid of a file. */
typedef struct leveling {
    size_t count;
    double z, off;
    const char *example;
} leveling;

typedef struct levelings {
    importer *im;
    leveling *of; /* of each input */
    size_t now;   /* input of the surfaces that are asked */
} levelings;

static void tell_one(levelings *l, size_t index, const char *reason, const city_laid *laid) {
    leveling *of = &l->of[index];
    geo_issue(l->im->inputs[index].issues, GEO_GUESSED, reason, laid->name ? laid->name : "");
    of->example = of->count++ ? of->example : laid->name;
    of->z = laid->z;
    of->off = laid->off;
}

static void tell_surface(void *user, const city_laid *laid) {
    levelings *l = user;
    tell_one(l, l->now, "surface at a height that is none, laid on what is around it", laid);
    if (!laid->follows)
        geo_issue(l->im->inputs[l->now].issues, GEO_GUESSED, "surface whose corners alone were laid on the ground",
                  laid->name ? laid->name : "");
}

static void tell_outline(void *user, const city_laid *laid) {
    levelings *l = user;
    tell_one(l, l->im->outlines.data[laid->number].input,
             "outline of a building at a height that is none, put on the ground", laid);
}

static void warn_of_levels(const importer *im, const leveling *of, const char *one, const char *many) {
    for (size_t i = 0; i < im->input_count; i++)
        if (of[i].count)
            noc_warn(im->log,
                     "%s: %zu %s, such as \"%.60s\", level at %.2f m, %.0f m %s what stands around: without a height, "
                     "it seems, and laid on the ground",
                     im->inputs[i].path, of[i].count, of[i].count == 1 ? one : many, of[i].example ? of[i].example : "",
                     of[i].z, fabs(of[i].off), of[i].off < 0 ? "below" : "above");
}

noc_status heights_of_surfaces(importer *im) {
    levelings l = { .im = im, .of = noc_calloc(im->input_count + 1, sizeof(*l.of)) };
    if (!l.of)
        return noc_no_memory(im->log, "import");
    noc_status status =
        city_lay_outlines(im->scene, im->outlines.data, im->outlines.len, -im->origin[2], tell_outline, &l);
    warn_of_levels(im, l.of, "outline of a building", "outlines of buildings");
    memset(l.of, 0, im->input_count * sizeof(*l.of));
    for (; l.now < im->input_count && !status; l.now++) {
        const input *in = &im->inputs[l.now];
        if (in->started && in->reader && in->reader->reads == NOC_READS_CITY)
            status = city_lay_level_surfaces(im->scene, in->first_mesh, in->end_mesh, -im->origin[2], tell_surface, &l);
    }
    warn_of_levels(im, l.of, "surface of roads, lawns or water", "surfaces of roads, lawns or water");
    free(l.of);
    return status;
}

noc_status heights_check(importer *im, const city_ground *ground) {
    double *off = noc_alloc((im->lamps.len + 1) * sizeof(*off));
    if (!off)
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < im->input_count; i++)
        if (im->inputs[i].file.lamps)
            check_input(im, ground, i, off);
    free(off);
    return NOC_OK;
}

void heights_lay(importer *im, city_ground *ground, double *points, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double *p = points + 3 * i, z, distance;
        if (isfinite(p[2]) && noc_scene_highest(im->scene, 1u << NOC_CLASS_BRIDGE, p[0], p[1], &z) &&
            fabs(p[2] - z) < ON_DECK) { /* the ground is below it */
            p[2] = NAN;
            continue;
        }
        /* between houses the city tells little: there a lamp may be on a hill; beside one it may be a slip of the pen
         */
        if (isfinite(p[2]) && told_height(im, ground, p, &z, &distance) && !(fabs(p[2] - z) <= OFF + STEEP * distance))
            p[2] = NAN;
    }
    city_ground_lay(ground, points, count);
}
