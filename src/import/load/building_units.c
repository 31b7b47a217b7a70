/* Heights of buildings that are hardly in the unit that they were read in. Hardly any file names it; the middle of many
 * buildings, or of their storeys, does, and so does terrain of another file under their feet. */
#include "import/load/load.h"

#include <math.h>

#define FEWEST 10      /* buildings that are evidence */
#define FEWEST_FEET 3  /* of a CRS of feet, where two units are likely */
#define FLAT 0.002     /* m: outlines have no height, and houses in kilometres have one */
#define MOST_FEET 1000 /* buildings of an input that are compared with terrain */
#define FOOT 0.3048

/* What the median of a quantity may be [m], and what is usual. */
typedef struct range {
    const char *what;
    double usual, least, most;
} range;
static const range heights = { "height of a building", 8, 2, 60 };
static const range storeys = { "height of a building's storey", 3.2, 1.8, 7 };

/* ---- what is known ---- */

bool units_see_building(importer *im, input *in, const object_now *now) {
    double height = now->hi[2] - now->lo[2];
    bool map = in->reader && in->reader->reads == NOC_READS_LAMPS; /* which footprint_keep has */
    if (now->kind != GEO_BUILDING || !now->any || !(height > FLAT) || map)
        return true;
    double area = (now->hi[0] - now->lo[0]) * (now->hi[1] - now->lo[1]);
    const building_size size = { .height = (float)height,
                                 .width = (float)sqrt(area),
                                 .storey = now->storeys >= 2 ? (float)(height / now->storeys) : 0 };
    const float foot[3] = { (float)((now->lo[0] + now->hi[0]) / 2), (float)((now->lo[1] + now->hi[1]) / 2),
                            (float)now->lo[2] };
    size_t numbers = NOC_COUNT(foot);
    bool compared = im->input_count > 1 && in->feet.len < numbers * MOST_FEET;
    return array_push(&in->sizes, size) && (!compared || array_append(&in->feet, foot, numbers));
}

/* The United States and Canada, roughly: longitudes and latitudes. */
static bool measures_in_feet(const double lonlat[2]) {
    static const double boxes[][4] = {
        { -125, 32.5, -114, 49 }, { -114, 31.3, -106.5, 49 }, { -106.5, 29, -101, 49 },   { -101, 25.8, -97, 49 },
        { -97, 24.4, -80, 49 },   { -80, 28, -66, 49 },       { -141, 49, -52, 84 },      { -66, 43, -52, 49 },
        { -170, 51, -129, 72 },   { -161, 18.5, -154, 22.5 }, { -68, 17.5, -64.5, 18.6 },
    };
    for (size_t i = 0; i < NOC_COUNT(boxes); i++)
        if (lonlat[0] >= boxes[i][0] && lonlat[1] >= boxes[i][1] && lonlat[0] <= boxes[i][2] &&
            lonlat[1] <= boxes[i][3])
            return true;
    return false;
}

bool units_of_feet(const source_crs *source, const double xy[2]) {
    double lonlat[2];
    if (!source || !source->crs)
        return false;
    bool feet = !geo_crs_is_geographic(source->crs) && !geo_crs_is_metric(source->crs);
    return feet || (geo_crs_lonlat_near(source->crs, xy[0], xy[1], lonlat) && measures_in_feet(lonlat));
}

/* ---- which unit it may be ---- */

typedef struct doubt {
    const char *name, *word; /* NULL: no unit is plausible; word NULL: --height-unit has none for it */
    double factor;
} doubt;

/* The unit in place of `unit` [m] that brings the value between least and most, next to what is usual; of them feet
 * where metres were taken, and metres where feet were, go before all others. */
static doubt other_unit(double value, double unit, const range *r) {
    static const double others[] = { FOOT, 1, .1, .01, .001, 1000, 1 / FOOT };
    doubt best = { NULL, NULL, 1 };
    double nearest = INFINITY;
    bool metric = unit == 1, feet = fabs(unit / FOOT - 1) < 1e-4;
    for (size_t i = 0; i < NOC_COUNT(others); i++) {
        double factor = others[i] / unit, x = value * factor, off = fabs(log(x / r->usual));
        if (fabs(factor - 1) < 1e-4 || (others[i] > 1 && !metric) || x < r->least || x > r->most || off >= nearest)
            continue;
        nearest = off;
        best = (doubt){ height_unit_name(others[i]), height_unit_word(others[i]), factor };
        if (!best.name)
            best.name = others[i] == 1000 ? "kilometres" : "metres, converted as if they were feet";
        if ((metric && i == 0) || (feet && i == 1))
            break;
    }
    return best;
}

static void warn(const importer *im, const input *in, const char *which, const range *r, size_t count, double value,
                 const doubt *d) {
    char mend[300] = "", times[160] = "";
    const char *now = height_unit_word(in->sources.len ? in->sources.data[0]->unit : 1);
    if (d->name)
        noc_snprintf(times, sizeof(times), "are heights in %s? Times %.5g it would be %.3g m", d->name, d->factor,
                     value * d->factor);
    if (d->word && now)
        noc_snprintf(mend, sizeof(mend), ": pass --height-unit %.100s=%s if they are, --height-unit %.100s=%s if not",
                     in->path, d->word, in->path, now);
    noc_warn(im->log, "%s: the %s %s, of %zu, is %.3g m, which is hardly one: %s%s", in->path, which, r->what, count,
             value, d->name ? times : "in which unit are heights?", mend);
}

/* ---- an input, or several that have few buildings each ---- */

typedef NOC_ARRAY(float) floats;
typedef struct evidence {
    floats heights, storeys, slender; /* sorted by prepare; slender: heights by widths */
} evidence;

static bool gather(evidence *e, const input *in) {
    bool ok = true;
    for (size_t i = 0; i < in->sizes.len && ok; i++) {
        const building_size *b = &in->sizes.data[i];
        ok = array_push(&e->heights, b->height) && (b->storey <= 0 || array_push(&e->storeys, b->storey)) &&
             (b->width <= 0 || array_push(&e->slender, b->height / b->width));
    }
    return ok;
}

static int by_value(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void prepare(evidence *e) {
    floats *all[] = { &e->heights, &e->storeys, &e->slender };
    for (size_t i = 0; i < NOC_COUNT(all); i++)
        if (all[i]->len)
            qsort(all[i]->data, all[i]->len, sizeof(float), by_value);
}

static double share_of(const floats *f, size_t above, size_t of) { return (double)f->data[f->len * above / of]; }

/* Returns true after a warning if the median is out of range. */
static bool judge(const importer *im, const input *in, const floats *values, size_t fewest, double unit,
                  const range *r) {
    if (values->len < fewest)
        return false;
    double median = share_of(values, 1, 2);
    if (median >= r->least && median <= r->most)
        return false;
    doubt d = other_unit(median, unit, r);
    warn(im, in, "median", r, values->len, median, &d);
    return true;
}

/* Where feet and metres are both likely, what is plausible by itself is compared with what it would be in the other
 * one. Few buildings are lower than 2 m, and half of a city are not lower than 4 m: where they are, metres were taken
 * for feet. Houses as narrow as towers, and no low ones among them, are in feet that were taken for metres. */
static bool judge_feet(const importer *im, const input *in, const evidence *e, const source_crs *s) {
    static const range low = { "height of a building", 8, 3, 60 }, high = { "height of a building", 8, 2, 60 };
    size_t count = e->heights.len;
    bool feet = fabs(s->unit / FOOT - 1) < 1e-4, metric = s->unit == 1;
    if (count < FEWEST_FEET || (!feet && !metric))
        return false;
    double median = share_of(&e->heights, 1, 2), tenth = share_of(&e->heights, 1, 10);
    double slender = e->slender.len ? share_of(&e->slender, 1, 2) : 0;
    bool is_low = feet && (median < (s->unit_named ? 3 : 4) || (count >= FEWEST && tenth < (s->unit_named ? 1.5 : 2)));
    bool is_high = metric && median > 18 && tenth > 6 && slender > (s->unit_named ? 2 : 1.4);
    if (!is_low && !is_high)
        return false;
    doubt d = other_unit(median, s->unit, is_low ? &low : &high);
    if (d.name)
        warn(im, in, is_low && median >= 4 ? "median (one in ten is lower than 2 m)" : "median", &heights, count,
             median, &d);
    return d.name != NULL;
}

/* Returns true after a warning if the unit is hardly that of the heights. */
static bool judge_one(const importer *im, const input *in, evidence *e) {
    static const source_crs local = { .unit = 1 };
    const source_crs *s = in->sources.len ? in->sources.data[0] : &local;
    const noc_report_file *f = &in->file;
    const double middle[2] = { (f->extent_min[0] + f->extent_max[0]) / 2, (f->extent_min[1] + f->extent_max[1]) / 2 };
    if (in->unit > 0)
        return false;
    prepare(e);
    bool feet = f->has_extent && units_of_feet(s, middle);
    size_t fewest = feet ? FEWEST_FEET : FEWEST;
    bool map = in->reader && in->reader->reads == NOC_READS_LAMPS; /* its heights are in no unit of the CRS */
    double unit = map ? 1 : s->unit;
    const source_crs as = { .unit = unit, .unit_named = s->unit_named };
    bool high = judge(im, in, &e->heights, fewest, unit, &heights);
    bool told = e->storeys.len >= fewest, odd = judge(im, in, &e->storeys, fewest, unit, &storeys);
    return high || odd || (feet && !told && judge_feet(im, in, e, &as));
}

static void count(input *in) {
    geo_issues_add(in->issues, GEO_GUESSED, "height of a building in a unit that is doubtful", in->sizes.len, "");
}

static void free_evidence(evidence *e) {
    array_free(&e->heights);
    array_free(&e->storeys);
    array_free(&e->slender);
}

/* Returns true if the inputs' heights were read alike. */
static bool alike(const input *a, const input *b) {
    double x = a->sources.len ? a->sources.data[0]->unit : 1, y = b->sources.len ? b->sources.data[0]->unit : 1;
    return x == y && a->reader == b->reader && !(a->unit > 0) && !(b->unit > 0);
}

static bool judge_few(importer *im, const input *first) {
    evidence e = { 0 };
    bool ok = true;
    for (size_t i = (size_t)(first - im->inputs); i < im->input_count && ok; i++)
        if (im->inputs[i].sizes.len < FEWEST && alike(first, &im->inputs[i]))
            ok = gather(&e, &im->inputs[i]);
    bool doubtful = ok && judge_one(im, first, &e);
    for (size_t i = (size_t)(first - im->inputs); i < im->input_count; i++)
        if (im->inputs[i].sizes.len < FEWEST && alike(first, &im->inputs[i])) {
            if (doubtful)
                count(&im->inputs[i]);
            im->inputs[i].sizes.len = 0;
        }
    free_evidence(&e);
    return ok;
}

noc_status units_check_buildings(importer *im) {
    bool ok = true;
    for (size_t i = 0; i < im->input_count && ok; i++) {
        input *in = &im->inputs[i];
        evidence e = { 0 };
        if (in->sizes.len && in->sizes.len < FEWEST && in->unit <= 0)
            ok = judge_few(im, in);
        else if (in->sizes.len && (ok = gather(&e, in)) && judge_one(im, in, &e))
            count(in);
        free_evidence(&e);
        array_free(&in->sizes);
    }
    return ok ? NOC_OK : noc_no_memory(im->log, "import");
}

/* ---- terrain of another input ---- */

/* Their feet against the ground there: one 3.28 times as high as the other, building by building. */
static bool compare(importer *im, input *in) {
    floats ratios = { 0 }, grounds = { 0 };
    double z;
    bool ok = true;
    for (size_t i = 0; i + 2 < in->feet.len && ok; i += 3) {
        const float *p = in->feet.data + i;
        if (noc_scene_ground(im->scene, (double)p[0], (double)p[1], &z) && fabs(z) > 5 && fabsf(p[2]) > 1.5f)
            ok = array_push(&ratios, (float)z / p[2]) && array_push(&grounds, (float)z);
    }
    size_t n = ratios.len;
    if (ok && n >= FEWEST_FEET && 2 * n > in->feet.len / 3) {
        qsort(ratios.data, n, sizeof(float), by_value);
        qsort(grounds.data, n, sizeof(float), by_value);
        double low = share_of(&ratios, 1, 5), ratio = share_of(&ratios, 1, 2), high = share_of(&ratios, 4, 5);
        double times = ratio > 1 ? ratio : 1 / ratio, ground = share_of(&grounds, 1, 2);
        if (high - low < .06 * ratio && fabs(times * FOOT - 1) < .03) {
            noc_warn(
                im->log,
                "%s: its %zu buildings stand at %.4g m and the ground there lies at %.4g m, %.3g times as high: one "
                "is in feet, the other in metres, and one was taken for the other: --height-unit FILE=m or "
                "FILE=ft puts it right (nocturne info shows what each was read in)",
                in->path, n, ground / ratio, ground, ratio);
            geo_issues_add(in->issues, GEO_GUESSED,
                           "building at feet whose terrain is in metres, or the other way round", n, "");
        }
    }
    array_free(&ratios);
    array_free(&grounds);
    return ok;
}

noc_status units_check_terrain(importer *im) {
    bool terrain = false, ok = true;
    for (size_t t = 0; t < im->scene->triangle_material.len && !terrain; t++)
        terrain = im->scene->materials.data[im->scene->triangle_material.data[t]].cls == NOC_CLASS_TERRAIN;
    for (size_t i = 0; i < im->input_count; i++) {
        if (terrain && im->inputs[i].feet.len)
            ok = compare(im, &im->inputs[i]) && ok;
        array_free(&im->inputs[i].feet);
    }
    return ok ? NOC_OK : noc_no_memory(im->log, "import");
}
