/* Luminous intensity distributions of a scene's lights: tables in the form that core/profile.h looks up. */
#include "scene/scene.h"

#include "photometry/photometry.h"

#include <math.h>

enum { MOST_PROFILES = LIGHT_PROFILE_BITS >> LIGHT_PROFILE, CELL = 4 };

static size_t first_cell(const noc_scene *scene) {
    return NOC_MAX(scene->profile_cells.len / CELL, (size_t)MOST_PROFILES);
}

/* Of a table, with its window. */
static size_t cells_of(const photometry_table *t) {
    return (size_t)t->rows * (size_t)t->columns + (t->type != 'C' ? 1 : 0);
}

/* Heads first, as many as there may be, so that tables stay where they are. */
static void put_table(noc_scene *scene, const photometry_table *t) {
    float *cells = scene->profile_cells.data;
    size_t first = first_cell(scene), end = first + cells_of(t);
    double rows_a_turn = t->rows * 360 / (t->row_to - t->row_from);
    uint32_t pole = t->type == 'A' ? PROFILE_DOWN : t->type == 'B' ? PROFILE_LEFT : 0;
    if (!scene->profile_cells.len)
        memset(cells, 0, first * CELL * sizeof(float));
    if (pole) {
        double from = t->column_from < 0 ? t->column_from + 360 : t->column_from;
        const float window[CELL] = { (float)((90 + t->row_from) / 360), (float)(from / 360),
                                     (float)(t->columns * 360 / (t->column_to - t->column_from)) };
        memcpy(cells + CELL * first++, window, sizeof(window));
    }
    uint32_t steps = pole << PROFILE_POLE | (uint32_t)t->rows << 16 | (uint32_t)t->columns, place = (uint32_t)first;
    float *head = cells + scene->profiles.len * CELL;
    memcpy(head, &place, sizeof(place));
    memcpy(head + 1, &steps, sizeof(steps));
    head[2] = (float)rows_a_turn;
    head[3] = (float)(t->gamma_max / 360);
    memcpy(cells + CELL * first, t->cells.data, t->cells.len * sizeof(float));
    scene->profile_cells.len = end * CELL;
}

/* Of noc_scene_profile, by Simpson's rule between the rows, so that light which is all at the axis counts, too. The
 * squared cosine is 2 pi / 3 over a hemisphere. */
static float strength_of(const photometry_table *t) {
    double squares = 0, step = (t->row_to - t->row_from) / t->rows * M_PI / 180;
    double start = (t->type == 'C' ? t->row_from : t->row_from + 90) * M_PI / 180;
    for (int r = 0; r < t->rows; r++)
        for (int c = 0; c < 2 * t->columns; c++) { /* both sides of each cell */
            const float *corner = t->cells.data + CELL * (r * t->columns + c / 2) + c % 2;
            double a = (double)corner[0], b = (double)corner[2], middle = (a + b) / 2, low = start + r * step;
            squares += a * a * sin(low) + 4 * middle * middle * sin(low + .5 * step) + b * b * sin(low + step);
        }
    squares *= step / 6 * (t->column_to - t->column_from) * M_PI / 180 / (2 * t->columns);
    return fminf((float)sqrt(squares / (t->upward ? 4 * M_PI : 2 * M_PI / 3)), t->peak);
}

int noc_scene_add_profile(noc_scene *scene, const noc_profile *profile) {
    if (!scene || !profile) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    noc_profile_info info;
    noc_scene_profile made = { 0 };
    photometry_table t;
    noc_profile_get_info(profile, &info);
    if (scene->profiles.len == MOST_PROFILES) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "profile %s: a scene has at most %d", info.name, MOST_PROFILES);
        return -1;
    }
    noc_status status = photometry_table_make(&t, profile, NULL); /* a profile sends light, so it is memory */
    if (status || !noc_scene_keep_name(scene, info.name, &made.name)) {
        if (status)
            noc_scene_out_of_memory(scene);
        else
            photometry_table_free(&t);
        return -1;
    }
    made.peak = t.peak;
    made.strength = strength_of(&t);
    made.upward = t.upward;
    noc_scene_lock_commit(scene); /* frames read the array */
    bool room = array_reserve(&scene->profiles, scene->profiles.len + 1) &&
                array_reserve(&scene->profile_cells, (first_cell(scene) + cells_of(&t)) * CELL);
    if (room) {
        put_table(scene, &t);
        scene->profiles.data[scene->profiles.len++] = made;
    }
    noc_scene_unlock_commit(scene);
    photometry_table_free(&t);
    if (!room) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    return (int)scene->profiles.len;
}

const char *noc_light_profile_fault(const noc_scene *scene, const noc_light *l) {
    if (!l->profile)
        return NULL;
    if (l->profile < 0 || (size_t)l->profile > scene->profiles.len)
        return "no such profile";
    if (l->kind != NOC_LIGHT_POINT && l->kind != NOC_LIGHT_SPHERE && l->kind != NOC_LIGHT_DISC)
        return "only points, spheres and discs have a profile";
    double d2 = 0, c2 = 0;
    for (int k = 0; k < 3; k++) {
        d2 += l->direction[k] * l->direction[k];
        c2 += l->c0[k] * l->c0[k];
    }
    return d2 > 0 && d2 < 1e20 && c2 < 1e20 ? NULL : "a profile needs a direction";
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Of unit length; false if there is none. */
static bool unit(double a[3]) {
    double length = sqrt(dot(a, a));
    for (int k = 0; k < 3 && length > 1e-9; k++)
        a[k] /= length;
    return length > 1e-9;
}

void noc_light_set_profile(const noc_scene *scene, const noc_light *l, noc_light_record *r) {
    const noc_scene_profile *p = &scene->profiles.data[l->profile - 1];
    double n[3], a[3], length = l->kind == NOC_LIGHT_DISC ? l->radius : 1;
    memcpy(n, l->direction, sizeof(n));
    memcpy(a, l->c0, sizeof(a));
    unit(n);
    unit(a);
    double along = dot(a, n);
    for (int k = 0; k < 3; k++)
        a[k] -= along * n[k];
    if (!unit(a)) { /* no C 0, or one along the axis: any */
        int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
        least = fabs(n[2]) < fabs(n[least]) ? 2 : least;
        for (int k = 0; k < 3; k++)
            a[k] = (k == least) - n[least] * n[k];
        unit(a);
    }
    double b[3] = { n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0] };
    for (int k = 0; k < 3; k++) {
        r->a[k] = (float)(length * a[k]);
        r->b[k] = (float)(length * b[k]);
    }
    r->area = p->peak;
    r->flags |= (uint32_t)l->profile << LIGHT_PROFILE | (p->upward ? NOC_LIGHT_TWO_SIDED : 0);
}

void noc_profile_orient(const noc_profile *profile, const double axis[3], const double street[3], double c0[3]) {
    if (!axis || !street || !c0)
        return;
    double n[3], a[3];
    memcpy(n, axis, sizeof(n));
    memcpy(a, street, sizeof(a));
    bool turned = unit(n) && unit(a);
    double along = dot(a, n), angle = profile ? profile->info.street * M_PI / 180 : 0;
    for (int k = 0; k < 3; k++)
        a[k] -= along * n[k];
    turned = turned && unit(a);
    /* C turns from a towards -n x a */
    double b[3] = { n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0] };
    for (int k = 0; k < 3; k++)
        c0[k] = turned ? a[k] * cos(angle) + b[k] * sin(angle) : 0;
}
