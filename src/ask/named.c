/* Objects by their id, and polygons. */
#include "ask/ask.h"

#include <math.h>
#include <unistd.h>

enum { MOST_CELLS = 4000000 }; /* that are looked at */

const uint32_t ask_ground = 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_BRIDGE |
                            1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_GREEN | 1u << NOC_CLASS_WATER |
                            1u << NOC_CLASS_GROUND | 1u << NOC_CLASS_OTHER;

static noc_status no_object(const asked *a) {
    size_t count = noc_scene_object_slots(a->scene), n = 0;
    const char **names = noc_alloc(NOC_MAX(count, 1) * sizeof(*names)), *last = NULL;
    char said[64], near[64];
    if (!names)
        return noc_no_memory(a->log, "region");
    for (size_t i = 0; i < count; i++) {
        const char *name = noc_scene_object_name(a->scene, i);
        if (name && *name && (!last || strcmp(name, last) != 0))
            last = names[n++] = name;
    }
    noc_text_clean(said, sizeof(said), a->text);
    const char *nearest = noc_text_nearest(a->text, names, n);
    noc_status status = nearest
                            ? noc_error(a->log, NOC_ERR_ARGUMENT, "region: there is no object \"%s\"; is it \"%s\"?",
                                        said, noc_text_clean(near, sizeof(near), nearest))
                            : noc_error(a->log, NOC_ERR_ARGUMENT, "region: there is no object \"%s\" among %zu%s%s%s",
                                        said, n, n ? "; the first is \"" : "",
                                        n ? noc_text_clean(near, sizeof(near), names[0]) : "", n ? "\"" : "");
    free(names);
    return status;
}

noc_status ask_object(const asked *a) {
    noc_region_info info;
    noc_status status = noc_region_add_object(a->to, a->scene, a->text, a->params->classes);
    noc_region_get_info(a->to, &info);
    bool none = status == NOC_ERR_ARGUMENT;
    for (size_t i = 0; none && i < noc_scene_object_slots(a->scene); i++) {
        const char *name = noc_scene_object_name(a->scene, i);
        if (name && !strcmp(name, a->text))
            return status; /* it is there, and what is wrong was told */
    }
    return none ? no_object(a) : status;
}

/* ---- polygons ---- */

static double area_of(const noc_rings *rings) {
    double sum = 0;
    const double *xy = rings->xy;
    for (size_t r = 0; r < rings->count; xy += 2 * rings->size[r++])
        for (size_t i = 0, n = rings->size[r], j = n - 1; i < n; j = i++)
            sum +=
                0.5 * ((xy[2 * j] - xy[0]) * (xy[2 * i + 1] - xy[1]) - (xy[2 * i] - xy[0]) * (xy[2 * j + 1] - xy[1]));
    return fabs(sum);
}

static double box_of(const noc_rings *rings) {
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    size_t points = 0;
    for (size_t r = 0; r < rings->count; r++)
        points += rings->size[r];
    for (size_t i = 0; i < 2 * points; i++) {
        lo[i % 2] = fmin(lo[i % 2], rings->xy[i]);
        hi[i % 2] = fmax(hi[i % 2], rings->xy[i]);
    }
    return (hi[0] - lo[0]) * (hi[1] - lo[1]);
}

static noc_status to_local(const asked *a, noc_rings *rings) {
    noc_region_params params = *a->params;
    asked of = *a;
    size_t points = 0;
    noc_status status = NOC_OK;
    if (*rings->crs)
        params.crs = rings->crs;
    of.params = &params;
    for (size_t r = 0; r < rings->count; r++)
        points += rings->size[r];
    for (size_t i = 0; i < points && !status; i++) {
        double at[3] = { rings->xy[2 * i], rings->xy[2 * i + 1], 0 };
        status = ask_to_local(&of, at);
        rings->xy[2 * i] = at[0];
        rings->xy[2 * i + 1] = at[1];
    }
    return status;
}

noc_status ask_polygon(const asked *a) {
    noc_rings rings;
    bool wkt = strchr(a->text, '(') || noc_ieq(a->text, "POLYGON EMPTY") || noc_ieq(a->text, "MULTIPOLYGON EMPTY");
    if (!wkt && (!a->params->files || !*a->text))
        return noc_error(a->log, NOC_ERR_ARGUMENT, "region: polygon: needs %sWKT, POLYGON((X Y, X Y, ...))",
                         a->params->files ? "a file, or " : "");
    if (!wkt && strspn(a->text, "0123456789+-.eE, ") == strlen(a->text) && access(a->text, F_OK))
        return noc_error(a->log, NOC_ERR_ARGUMENT,
                         "region: polygon:%s is no file; corners are written as WKT, POLYGON((X Y, X Y, ...))",
                         noc_text_clean((char[120]){ 0 }, 120, a->text));
    noc_status status = wkt ? noc_rings_parse(a->text, &rings, a->log) : noc_rings_read(a->text, &rings, a->log);
    if (status != NOC_OK)
        return status;
    ask_cells cells = { .step = 1 };
    size_t found = 0;
    status = to_local(a, &rings);
    if (!status) {
        cells.step = fmax(ASK_FINEST, fmax(sqrt(area_of(&rings) / ASK_PLACES), sqrt(box_of(&rings) / MOST_CELLS)));
        status = ask_add_rings(a, &rings, &cells);
    }
    status = status ? status : ask_add_ground(a, &cells, ask_ground, &found);
    if (!status && !found)
        status =
            noc_error(a->log, NOC_ERR_ARGUMENT, "region: there is no ground in the polygon that is seen from above");
    array_free(&cells.keys);
    noc_rings_free(&rings);
    return status;
}
