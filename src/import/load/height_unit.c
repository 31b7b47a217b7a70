/* The unit of heights: that of a CRS's vertical part, of a raster, of --height-unit, else that of x and y. Most files
 * name none: many in feet have their heights in metres, and the other way round. */
#include "import/load/load.h"

#include <math.h>

static const struct {
    const char *word, *name;
    double metres;
} units[] = {
    { "m", "metres", 1 },          { "ft", "feet", .3048 },      { "us-ft", "US survey feet", 1200. / 3937 },
    { "dm", "decimetres", .1 },    { "cm", "centimetres", .01 }, { "mm", "millimetres", .001 },
    { "metres", "", 1 },           { "meters", "", 1 },          { "feet", "", .3048 },
    { "us_ft", "", 1200. / 3937 }, { "ftus", "", 1200. / 3937 },
};
enum { NAMED = 6 }; /* the others are spellings */

static double unit_of(const char *word) {
    for (size_t i = 0; i < NOC_COUNT(units); i++)
        if (noc_ieq(word, units[i].word))
            return units[i].metres;
    return 0;
}

static int find(double metres) {
    for (int i = 0; i < NAMED; i++)
        if (fabs(metres / units[i].metres - 1) < 1e-7)
            return i;
    return -1;
}

const char *height_unit_name(double metres) { return find(metres) < 0 ? NULL : units[find(metres)].name; }
const char *height_unit_word(double metres) { return find(metres) < 0 ? NULL : units[find(metres)].word; }

/* ---- --height-unit [FILE=]UNIT ---- */

noc_status height_unit_check(const noc_import_params *p, noc_log *log) {
    for (size_t i = 0; i < p->height_unit.count; i++) {
        const char *text = p->height_unit.text[i], *equals = strrchr(text, '=');
        if (equals == text || unit_of(equals ? equals + 1 : text) == 0)
            return noc_error(
                log, NOC_ERR_ARGUMENT,
                "--height-unit \"%.100s\": pass a unit or FILE=UNIT; units are m, ft, us-ft, dm, cm and mm", text);
    }
    return NOC_OK;
}

static bool has_heights(const input *in) { return in->reader && in->reader->reads != NOC_READS_MESH; }

/* Gives the inputs that are called `name`, or with NULL all, the unit. Returns their number; *mesh is one that is
 * called so and has none. */
static size_t give(importer *im, const char *name, double unit, const char **mesh) {
    size_t count = 0;
    for (size_t i = 0; i < im->input_count; i++) {
        input *in = &im->inputs[i];
        if (name && (!strncmp(in->path, BUILTIN, strlen(BUILTIN)) || !given_is_called(in->path, name)))
            continue;
        if (!has_heights(in)) {
            *mesh = in->path;
            continue;
        }
        in->unit = unit;
        count++;
    }
    return count;
}

noc_status height_unit_take(importer *im) {
    for (size_t i = 0; i < im->params->height_unit.count; i++) {
        const char *text = im->params->height_unit.text[i], *equals = strrchr(text, '='), *mesh = NULL;
        char *name = equals ? noc_strdup(text) : NULL;
        if (equals && !name)
            return noc_no_memory(im->log, "--height-unit");
        if (name)
            name[equals - text] = 0;
        size_t count = give(im, name, unit_of(equals ? equals + 1 : text), &mesh);
        free(name);
        if (!equals || im->inspect || (count && !mesh))
            continue;
        if (mesh)
            return noc_error(im->log, NOC_ERR_ARGUMENT, "--height-unit \"%.100s\": %s has one unit for x, y and z",
                             text, mesh);
        return noc_error(im->log, NOC_ERR_ARGUMENT,
                         "--height-unit \"%.100s\": no input is called so; FILE is an input, the end of its path, or a "
                         "pattern (\"tiles/*\")",
                         text);
    }
    return NOC_OK;
}

/* ---- of one CRS of a file ---- */

static void set(source_crs *s, double metres, bool named, const char *by) {
    s->unit = metres;
    s->unit_named = named;
    s->unit_by = by;
    if (s->crs)
        geo_crs_set_height_unit(s->crs, metres);
}

void height_unit_settle(const input *in, source_crs *s) {
    bool named = false;
    double metres = s->crs ? geo_crs_height_unit(s->crs, &named) : 1;
    if (in->unit > 0 && has_heights(in))
        set(s, in->unit, true, "by --height-unit");
    else if (named)
        set(s, metres, true, "by the CRS");
    else
        set(s, metres, false, s->crs && !geo_crs_is_geographic(s->crs) ? "as x and y are" : "as nothing names a unit");
}

noc_status height_unit_heights(void *ctx, double metres) {
    reading *r = ctx;
    source_crs *s = r->source;
    if (!s) {
        noc_status status = place_crs(r, NULL, r->in->path, NULL);
        if (status)
            return status;
        s = r->source;
    }
    if (!s->ready && !(r->in->unit > 0))
        set(s, metres, true, "by the file");
    return NOC_OK;
}

double height_unit_now(void *ctx) {
    const reading *r = ctx;
    return r->source ? r->source->unit : 1;
}
