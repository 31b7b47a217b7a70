/* Whether faces of buildings look outwards. Faces have light on their outer side alone, and a city whose two
 * coordinates are exchanged is mirrored, so that all of its walls look inwards: both orders may be places on Earth, and
 * of a city alone nothing else tells. */
#include "import/load/load.h"

#include <math.h>

#define FEWEST 3 /* closed buildings that are evidence */
#define MOST .9  /* share of them that looks inwards */
#define OPEN .02 /* of the area: vector area of faces that close a space */
#define THIN .1  /* of the box: volume of such that are all to one side of it */

/* p: corners of a triangle, from the building's first corner on. */
static void add_triangle(building_faces *f, double p[3][3]) {
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) {
        u[k] = p[1][k] - p[0][k];
        v[k] = p[2][k] - p[0][k];
        for (int c = 0; c < 3; c++) {
            f->lo[k] = f->area > 0 || c ? NOC_MIN(f->lo[k], p[c][k]) : p[c][k];
            f->hi[k] = f->area > 0 || c ? NOC_MAX(f->hi[k], p[c][k]) : p[c][k];
        }
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = u[i] * v[j] - u[j] * v[i];
        f->sum[k] += n[k];
        f->volume += n[k] * p[0][k] / 6;
    }
    f->area += hypot(hypot(n[0], n[1]), n[2]);
}

void faces_add(building_faces *f, const part_surface *s) {
    if (!f->any && s->vertex_count)
        memcpy(f->origin, s->xyz, sizeof(f->origin));
    f->any = f->any || s->vertex_count;
    for (size_t i = 0; i < 3 * s->triangle_count; i += 3) {
        double p[3][3];
        for (size_t c = 0; c < 3; c++)
            for (size_t k = 0; k < 3; k++)
                p[c][k] = s->xyz[3 * (size_t)s->indices[i + c] + k] - f->origin[k];
        add_triangle(f, p);
    }
}

void faces_end(input *in) {
    building_faces *f = &in->faces;
    double box = (f->hi[0] - f->lo[0]) * (f->hi[1] - f->lo[1]) * (f->hi[2] - f->lo[2]);
    bool closed = f->area > 0 && hypot(hypot(f->sum[0], f->sum[1]), f->sum[2]) < OPEN * f->area;
    if (closed && fabs(f->volume) > THIN * box)
        ++*(f->volume > 0 ? &in->outwards : &in->inwards);
    *f = (building_faces){ 0 };
}

static bool looks_inwards(size_t inwards, size_t outwards) {
    return inwards + outwards >= FEWEST && (double)inwards >= MOST * (double)(inwards + outwards);
}

/* Cities in many files may have a building a file: such are judged together. */
static bool has_few(const input *in) { return in->inwards + in->outwards < FEWEST; }

noc_status faces_check(importer *im) {
    size_t few[2] = { 0 }, inwards = 0, closed = 0, files = 0;
    const char *first = NULL;
    bool degrees = false;
    for (size_t i = 0; i < im->input_count; i++)
        if (has_few(&im->inputs[i])) {
            few[0] += im->inputs[i].inwards;
            few[1] += im->inputs[i].outwards;
        }
    for (size_t i = 0; i < im->input_count; i++) {
        input *in = &im->inputs[i];
        if (!in->inwards || !(has_few(in) ? looks_inwards(few[0], few[1]) : looks_inwards(in->inwards, in->outwards)))
            continue;
        geo_issues_add(in->issues, GEO_GUESSED, "building whose faces look inwards, as those of a mirrored city do",
                       in->inwards, "");
        first = first ? first : in->path;
        degrees = degrees || in->file.degrees;
        inwards += in->inwards;
        closed += in->inwards + in->outwards;
        files++;
    }
    if (!files)
        return NOC_OK;
    char more[40] = "";
    if (files > 1)
        noc_snprintf(more, sizeof(more), " and %zu more", files - 1);
    noc_warn(im->log,
             "%s%s: the faces of %zu of %zu closed buildings look inwards, and no light falls on their outside: are %s "
             "exchanged, which mirrors a city, or all faces turned?",
             first, more, inwards, closed, degrees ? "latitude and longitude" : "its two coordinates");
    return NOC_OK;
}
