/* OpenEXR, reading: colours and luminance, as chromaticities, whiteLuminance and adoptedNeutral tell them. */
#include "image/exr.h"

#include <math.h>

static bool wrong(exr_reader *r, const char *attribute, const char *fault) {
    r->status = noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: its %s are of no use: %s", r->name, attribute, fault);
    return false;
}

/* The attribute, where the file has it; another type than its own is an error. */
static const exr_attribute_t *find(exr_reader *r, const char *name, exr_attribute_type_t type) {
    const exr_attribute_t *a = NULL;
    if (exr_get_attribute_by_name(r->context, r->part, name, &a) != EXR_ERR_SUCCESS || !a)
        return NULL;
    if (a->type == type)
        return a;
    if (r->status == NOC_OK)
        r->status = noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: its attribute %s is of a type that is not its own",
                              r->name, name);
    return NULL;
}

/* CIE XYZ itself, stored as R, G and B: the axes as primaries, and X = Y = Z, which is no white, where one is asked
 * for.
 */
static bool is_xyz(const colour_space *space) {
    static const double axes[4][2] = { { 1, 0 }, { 0, 1 }, { 0, 0 }, { 1 / 3., 1 / 3. } };
    for (int k = 0; k < 4; k++)
        if (!(fabs(space->xy[k][0] - axes[k][0]) < 1e-3 && fabs(space->xy[k][1] - axes[k][1]) < 1e-3))
            return false;
    return true;
}

bool exr_read_colours(exr_reader *r) {
    exr_colours *c = &r->colours;
    colour_space space = colour_rec709;
    const exr_attribute_t *a = find(r, "chromaticities", EXR_ATTR_CHROMATICITIES);
    if (a) {
        const exr_attr_chromaticities_t *p = a->chromaticities;
        space = (colour_space){
            { { p->red_x, p->red_y }, { p->green_x, p->green_y }, { p->blue_x, p->blue_y }, { p->white_x, p->white_y } }
        };
    }
    const exr_attribute_t *neutral = find(r, "adoptedNeutral", EXR_ATTR_V2F);
    const double xy[2] = { neutral ? neutral->v2f->x : 0, neutral ? neutral->v2f->y : 0 };
    bool xyz = is_xyz(&space);
    if (neutral) /* RGB (1, 1, 1) is neutral: OpenEXR's pull request 650 */
        memcpy(space.xy[3], xy, sizeof(xy));
    c->scale = 1;
    if ((a = find(r, "whiteLuminance", EXR_ATTR_FLOAT)))
        c->scale = a->f;
    if (r->status != NOC_OK)
        return false;
    if (!(c->scale > 0 && c->scale < 1e30))
        return wrong(r, "cd/m2 of white (whiteLuminance)", "they are not above 0");
    const char *fault =
        xyz ? colour_from_xyz(neutral ? xy : NULL, c->to_working) : colour_from_rgb(&space, c->to_working);
    if (!fault && r->layout == EXR_CHROMA)
        fault = colour_luminance(&space, c->luminance);
    c->convert = r->layout != EXR_GREY && !colour_near(&space, &colour_rec709);
    return fault ? wrong(r, "chromaticities", fault) : true;
}

void exr_apply_colours(const exr_reader *r) {
    const exr_colours *c = &r->colours;
    size_t n = image_pixels(r->image);
    if (!c->convert && c->scale == 1 && r->layout == EXR_RGB)
        return;
    for (size_t i = 0; i < n; i++) {
        float *rgb = r->image->rgb + 3 * i;
        double from[3] = { rgb[0], rgb[1], rgb[2] }, to[3];
        if (r->layout == EXR_GREY)
            from[1] = from[2] = from[0];
        if (r->layout == EXR_CHROMA) {
            double y = from[1], red = (from[0] + 1) * y, blue = (from[2] + 1) * y;
            from[0] = red;
            from[1] = (y - red * c->luminance[0] - blue * c->luminance[2]) / c->luminance[1];
            from[2] = blue;
        }
        if (c->convert)
            colour_apply(c->to_working, from, to);
        else
            memcpy(to, from, sizeof(to));
        for (int k = 0; k < 3; k++)
            rgb[k] = (float)(to[k] * c->scale);
    }
}
