/* Streets by name: as a map spells it, else as people do. */
#include "ask/ask.h"

#include <math.h>

#define PAVEMENT 4.0 /* m beside a carriageway that pavements are looked for in */

enum { OFFERED = 3 }; /* names that are offered in place of one that there is not */

static const uint32_t roads = 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_BRIDGE;

/* ---- names ---- */

/* Names that there are, each once, and how a search compares them. */
typedef struct street_names {
    const char **name;
    char **folded;
    size_t count;
} street_names;

static void free_names(street_names *names) {
    for (size_t i = 0; i < names->count; i++)
        free(names->folded[i]);
    free(names->folded);
    free((void *)names->name);
}

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static noc_status fold_names(const asked *a, street_names *out) {
    size_t most = NOC_MAX(noc_scene_streets(a->scene), 1), n = 0;
    noc_street s;
    *out = (street_names){ noc_alloc(most * sizeof(char *)), noc_alloc(most * sizeof(char *)), 0 };
    if (!out->name || !out->folded)
        return noc_no_memory(a->log, "region");
    for (size_t i = 0; noc_scene_get_street(a->scene, i, &s); i++)
        if (s.name && *s.name)
            out->name[n++] = s.name;
    qsort((void *)out->name, n, sizeof(char *), by_name);
    for (size_t i = 0; i < n; i++)
        if (!out->count || strcmp(out->name[i], out->name[out->count - 1]) != 0) {
            out->name[out->count] = out->name[i];
            if (!(out->folded[out->count++] = noc_text_fold(out->name[i], true)))
                return noc_no_memory(a->log, "region");
        }
    return NOC_OK;
}

/* The name whose folded form is at that place of the list. */
static const char *take(street_names *names, size_t i) {
    free(names->folded[i]);
    names->folded[i] = noc_text_fold("", true); /* it is not offered twice */
    return names->name[i];
}

/* The next best name to offer: one that holds the words, else one that differs in a letter or two. NULL: none. */
static const char *offer(street_names *names, const char *folded) {
    for (size_t i = 0; i < names->count && *folded; i++)
        if (names->folded[i] && strstr(names->folded[i], folded))
            return take(names, i);
    const char *nearest = noc_text_nearest(folded, (const char *const *)names->folded, names->count);
    for (size_t i = 0; nearest && i < names->count; i++)
        if (names->folded[i] == nearest)
            return take(names, i);
    return NULL;
}

static bool is_object(const asked *a) {
    for (size_t i = 0; i < noc_scene_object_slots(a->scene); i++) {
        const char *name = noc_scene_object_name(a->scene, i);
        if (name && *name && !strcmp(name, a->text))
            return true;
    }
    return false;
}

static noc_status no_street(const asked *a, street_names *names, const char *folded) {
    char said[64], near[64], all[256] = "";
    noc_text_clean(said, sizeof(said), a->text);
    if (is_object(a))
        return noc_error(a->log, NOC_ERR_ARGUMENT,
                         "region: \"%s\" is an object of the model and no street of a map: ask for object:%s", said,
                         said);
    if (!names->count)
        return noc_error(a->log, NOC_ERR_ARGUMENT,
                         "region: there is no street \"%s\": no input names streets, as a map does (OpenStreetMap)",
                         said);
    const char *first = names->name[0], *next;
    for (int i = 0; i < OFFERED && (next = offer(names, folded)); i++) {
        size_t n = strlen(all);
        noc_snprintf(all + n, sizeof(all) - n, "%s\"%s\"", i ? " or " : "", noc_text_clean(near, sizeof(near), next));
    }
    return *all
               ? noc_error(a->log, NOC_ERR_ARGUMENT, "region: there is no street \"%s\"; is it %s?", said, all)
               : noc_error(a->log, NOC_ERR_ARGUMENT, "region: there is no street \"%s\" among %zu; the first is \"%s\"",
                           said, names->count, noc_text_clean(near, sizeof(near), first));
}

/* The name that is meant, by its folded form, which is said. */
static noc_status find_folded(const asked *a, const char **name) {
    street_names names;
    noc_status status = fold_names(a, &names);
    char *folded = status ? NULL : noc_text_fold(a->text, true), said[64], near[64];
    if (!status && !folded)
        status = noc_no_memory(a->log, "region");
    for (size_t i = 0; !status && !*name && i < names.count; i++)
        if (*folded && !strcmp(names.folded[i], folded))
            *name = names.name[i];
    if (*name)
        noc_warn(a->log, "region: street \"%s\" is taken for \"%s\"", noc_text_clean(said, sizeof(said), a->text),
                 noc_text_clean(near, sizeof(near), *name));
    else if (!status)
        status = no_street(a, &names, folded);
    free(folded);
    free_names(&names);
    return status;
}

static bool is_called(const noc_street *s, const char *name) { return noc_ieq(s->name, name) || noc_ieq(s->id, name); }

/* ---- ground ---- */

static double length_of(const noc_street *s) {
    double sum = 0;
    for (size_t i = 0; i + 1 < s->point_count; i++)
        sum +=
            hypot((double)s->points[2 * i + 2] - s->points[2 * i], (double)s->points[2 * i + 3] - s->points[2 * i + 1]);
    return sum;
}

static noc_status add_streets(const asked *a, const char *name, double step, double beside, uint32_t classes,
                              size_t *found, size_t *looked) {
    ask_cells cells = { .step = step };
    noc_street s;
    noc_status status = NOC_OK;
    for (size_t i = 0; noc_scene_get_street(a->scene, i, &s) && !status; i++)
        if (is_called(&s, name))
            status = ask_add_line(a, &s, s.width / 2 + beside, &cells);
    *looked = cells.keys.len;
    status = status ? status : ask_add_ground(a, &cells, classes, found);
    array_free(&cells.keys);
    return status;
}

static double area_of(const asked *a, const char *name) {
    double area = 0;
    noc_street s;
    for (size_t i = 0; noc_scene_get_street(a->scene, i, &s); i++)
        if (is_called(&s, name))
            area += length_of(&s) * (s.width + 2 * PAVEMENT);
    return area;
}

/* The roads and pavements beside its middle; where the scene has none there, the ground as wide as the carriageway. */
noc_status ask_street(const asked *a) {
    const char *name = a->text;
    double area = area_of(a, name);
    if (!(area > 0)) {
        name = NULL;
        noc_status status = find_folded(a, &name);
        if (status)
            return status;
        area = area_of(a, name);
    }
    double step = fmax(ASK_FINEST, sqrt(area / ASK_PLACES));
    size_t found = 0, looked = 0;
    noc_status status = add_streets(a, name, step, PAVEMENT, roads, &found, &looked);
    if (!status && !found)
        status = add_streets(a, name, step, 0, ask_ground, &found, &looked);
    char said[64];
    return status || found
               ? status
               : noc_error(a->log, NOC_ERR_ARGUMENT, "region: street \"%s\" has no ground that is seen from above",
                           noc_text_clean(said, sizeof(said), a->text));
}
