/* The CRSs that the user gives to inputs: --crs for those that name none, --file-crs for one in place of what it names.
 * Where no input is there that may name none, --crs replaces what cities name, if their coordinates fit it; maps and
 * tables keep theirs, as lamps in degrees beside a city whose CRS is wrong. */
#include "import/load/load.h"

#include <fnmatch.h>
#include <math.h>

#define MOST_NAMED 3    /* files in a warning */
#define FAR_OUTSIDE 3.0 /* degrees outside the CRS's area of use: coordinates do not fit it */

static bool is_given(const char *crs) { return crs && crs[strspn(crs, " \t\r\n")]; }

noc_status given_status(noc_status status) { return !status || status == NOC_ERR_MEMORY ? status : NOC_ERR_ARGUMENT; }

noc_status given_crs_check(const noc_import_params *p, noc_log *log) {
    const struct {
        const char *option, *crs;
        bool metric;
    } given[] = { { "--crs", p->crs, false }, { "--scene-crs", p->scene_crs, true } };
    for (size_t i = 0; i < NOC_COUNT(given); i++) {
        if (!is_given(given[i].crs))
            continue;
        noc_status status;
        geo_crs *crs = geo_crs_create(given[i].crs, given[i].option, log, &status);
        if (crs && given[i].metric && !geo_crs_is_metric(crs))
            status =
                noc_error(log, NOC_ERR_ARGUMENT, "%s: a scene's CRS must be projected, in metres", geo_crs_name(crs));
        geo_crs_destroy(crs);
        if (status)
            return given_status(status);
    }
    return NOC_OK;
}

/* ---- --file-crs FILE=CRS ---- */

bool given_is_called(const char *path, const char *name) {
    while (!strncmp(name, "./", 2))
        name += 2;
    for (const char *end = path, *slash; end; end = slash ? slash + 1 : NULL) {
        if (!strcmp(end, name) || !fnmatch(name, end, 0))
            return true;
        slash = strchr(end, '/');
    }
    return same_file(name, path);
}

/* Gives the CRS to the inputs that are called `name`. Returns their number. */
static size_t give(importer *im, const char *name, const char *crs, bool degrees) {
    size_t count = 0;
    for (size_t i = 0; i < im->input_count; i++) {
        input *in = &im->inputs[i];
        if (!*name || !strncmp(in->path, BUILTIN, strlen(BUILTIN)) || !given_is_called(in->path, name))
            continue;
        in->crs = crs;
        in->crs_degrees = degrees;
        count++;
    }
    return count;
}

/* Both a file's name and a CRS (a PROJ string) may hold "=": the first one that has an input before it counts. */
static noc_status take_one(importer *im, const char *text) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !is_given(equals + 1))
        return noc_error(im->log, NOC_ERR_ARGUMENT, "--file-crs \"%.100s\" is not FILE=CRS", text);
    char *name = noc_strdup(text);
    if (!name)
        return noc_no_memory(im->log, "--file-crs");
    bool found = false;
    noc_status status = NOC_OK;
    for (; equals && !found && !status; equals = strchr(equals + 1, '=')) {
        memcpy(name, text, (size_t)(equals - text));
        name[equals - text] = 0;
        if (!(found = give(im, name, equals + 1, false)))
            continue;
        char place[200];
        noc_snprintf(place, sizeof(place), "--file-crs %.150s", name);
        geo_crs *crs = geo_crs_create(equals + 1, place, im->log, &status);
        if (crs && geo_crs_is_geographic(crs))
            give(im, name, equals + 1, true);
        geo_crs_destroy(crs);
        status = given_status(status);
    }
    free(name);
    if (!found && !status && !im->inspect) /* which is of one input of several */
        status = noc_error(im->log, NOC_ERR_ARGUMENT,
                           "--file-crs \"%.100s\": no input is called so; FILE is an input, the end of its path, or a "
                           "pattern (\"tiles/*\")",
                           text);
    return status;
}

noc_status given_crs_take(importer *im) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < im->params->file_crs.count && !status; i++)
        status = take_one(im, im->params->file_crs.text[i]);
    return status;
}

const char *given_crs_of(const importer *im, const input *in) {
    return in->crs ? in->crs : is_given(im->params->crs) ? im->params->crs : NULL;
}

noc_status given_crs_override(reading *r, const char *spelling, bool taken, const char *place, geo_crs **crs) {
    noc_status status;
    *crs = geo_crs_create(r->in->crs, "--file-crs", r->log, &status);
    if (!*crs || !*spelling || r->in->strange_crs >= MOST_STRANGE)
        return given_status(status);
    geo_crs *named = geo_crs_create_plain(spelling, place, NULL, &status);
    if (!named && status == NOC_ERR_MEMORY) {
        geo_crs_destroy(*crs);
        *crs = NULL;
        return noc_no_memory(r->log, place);
    }
    r->in->strange_crs += !named;
    const char *name = geo_crs_name(*crs);
    if (!named || !geo_crs_equal(named, *crs))
        noc_warn(r->log, "%s: its coordinates are taken as %.100s, by --file-crs, in place of %s%.80s%s", place,
                 strcmp(name, "unknown") ? name : r->in->crs, taken ? "the format's " : "what it names, ",
                 named ? geo_crs_name(named) : spelling, named ? "" : " (not understood)");
    geo_crs_destroy(named);
    return NOC_OK;
}

/* ---- --crs in place of what cities name ---- */

bool given_crs_replaces(const importer *im, const input *in) {
    bool replaces = is_given(im->params->crs) && !in->crs && in->reader->reads == NOC_READS_CITY;
    for (size_t i = 0; i < im->input_count && replaces; i++)
        replaces = !im->inputs[i].without_crs || im->inputs[i].crs || im->inputs[i].left_out;
    return replaces;
}

noc_status given_crs_replace(reading *r, geo_crs **crs, geo_crs **named) {
    const importer *im = r->im;
    if (!*crs || !given_crs_replaces(im, r->in))
        return NOC_OK;
    noc_status status;
    geo_crs *given = geo_crs_create(im->params->crs, "--crs", r->log, &status);
    if (!given) {
        geo_crs_destroy(*crs);
        return given_status(status);
    }
    bool same = geo_crs_equal(given, *crs);
    geo_crs_destroy(same ? given : NULL);
    *named = same ? NULL : *crs;
    *crs = same ? *crs : given;
    return NOC_OK;
}

static bool has_lat_first(const geo_crs *crs) { return geo_crs_is_geographic(crs) && geo_crs_lat_first(crs); }

static bool fits(geo_crs *crs, double x, double y) { return geo_crs_outside(crs, x, y) <= FAR_OUTSIDE; }

void given_crs_fit(reading *r, source_crs *s, double x, double y) {
    if (!s->named || s->fits || fits(s->crs, x, y) || fits(s->crs, y, x)) {
        s->fits = true;
        return;
    }
    bool turned = has_lat_first(s->named) != s->lat_first;
    if (!fits(s->named, turned ? y : x, turned ? x : y))
        return;
    geo_crs_destroy(s->crs);
    s->crs = s->named;
    s->named = NULL;
    s->turned = turned;
    height_unit_settle(r->in, s);
}

void given_crs_replaced(reading *r, source_crs *s, const double xy[2]) {
    if (!s->named)
        return;
    double to[2], from[2], x = xy[0] - s->shift_x, y = xy[1];
    bool exchange = (has_lat_first(s->named) != s->lat_first) != s->swap;
    bool placed = geo_crs_lonlat_near(s->crs, xy[0], xy[1], to) &&
                  geo_crs_lonlat_near(s->named, exchange ? y : x, exchange ? x : y, from);
    char moved[60] = "where they have no place";
    if (placed)
        noc_snprintf(moved, sizeof(moved), "%.*f km from there", place_distance_km(from, to) < 10 ? 3 : 0,
                     place_distance_km(from, to));
    noc_warn(r->log,
             "%s: its coordinates are taken as %.100s, by --crs, in place of what it names, %.80s, %s; where the "
             "file is right, pass --file-crs FILE=CRS for the other inputs instead",
             r->in->path, geo_crs_name(s->crs), geo_crs_name(s->named), moved);
    s->replaced = true;
    geo_crs_destroy(s->named);
    s->named = NULL;
}

/* ---- where --crs does not apply ---- */

/* Returns a CRS of the input that is another than the one given, NULL: none. Sets *used if the given one applies.
 * with_taken: also those that the file does not hold. */
static const source_crs *other_crs(const input *in, const geo_crs *given, bool with_taken, bool *used) {
    const source_crs *other = NULL;
    for (size_t i = 0; i < in->sources.len && !in->crs; i++) {
        const source_crs *s = in->sources.data[i];
        bool same = !s->crs || geo_crs_equal(s->crs, given);
        *used = *used || (same && s->crs);
        if (!other && !same && (with_taken || !s->taken))
            other = s;
    }
    return other;
}

void given_crs_warn(importer *im) {
    geo_crs *given = is_given(im->params->crs) ? geo_crs_create(im->params->crs, "--crs", NULL, NULL) : NULL;
    if (!given)
        return; /* none, or memory was refused, which the next thing reports */
    bool used = false;
    for (size_t i = 0; i < im->input_count; i++)
        other_crs(&im->inputs[i], given, false, &used);
    char list[600] = "";
    size_t count = 0, n = 0;
    const char *first = NULL;
    for (size_t i = 0; i < im->input_count; i++) {
        /* the format's own CRS is expected beside a file that --crs is for */
        const source_crs *s = other_crs(&im->inputs[i], given, !used, &(bool){ false });
        if (!s)
            continue;
        if (count++ < MOST_NAMED)
            n += (size_t)noc_snprintf(list + n, sizeof(list) - n, "%s%.100s (%.80s%s)", n ? ", " : "",
                                      im->inputs[i].path, geo_crs_name(s->crs), s->taken ? ", its format's" : "");
        first = first ? first : im->inputs[i].path;
    }
    if (count)
        noc_warn(im->log,
                 "--crs %.80s is for cities and inputs that name no CRS, and is not used for %s%s; if it is right "
                 "there, pass --file-crs %.100s=%.80s",
                 im->params->crs, list, count > MOST_NAMED ? " and others" : "", first, im->params->crs);
    geo_crs_destroy(given);
}
