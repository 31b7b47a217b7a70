/* Influence volumes as OBJ, to be looked at. y points up in the file, as most programs take OBJ: (x, y, z) is written
 * as x z -y. */
#include "light/influence.h"

#include <ctype.h>
#include <stdio.h>

/* Corners around a volume's axis, and rings of them from its pole to its rim or other pole. */
enum { AROUND = 16, RINGS = 6 };

typedef struct obj_out {
    FILE *file;
    size_t vertices; /* written so far */
} obj_out;

static void vertex(obj_out *o, const double p[3]) {
    fprintf(o->file, "v %.6g %.6g %.6g\n", p[0], p[2], 0 - p[1]);
    o->vertices++;
}

/* Axes s and t that make a right-handed frame with the unit vector n. */
static void frame_of(const double n[3], double s[3], double t[3]) {
    int i = fabs(n[0]) < fabs(n[1]) ? 0 : 1; /* not the largest */
    double up[3] = { i == 0, i == 1, 0 }, length = 0;
    for (int k = 0; k < 3; k++)
        s[k] = up[(k + 1) % 3] * n[(k + 2) % 3] - up[(k + 2) % 3] * n[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        length += s[k] * s[k];
    for (int k = 0; k < 3; k++)
        s[k] /= sqrt(length);
    for (int k = 0; k < 3; k++)
        t[k] = n[(k + 1) % 3] * s[(k + 2) % 3] - n[(k + 2) % 3] * s[(k + 1) % 3];
}

static void ring(obj_out *o, const double c[3], const double n[3], double radius, double angle) {
    double s[3], t[3];
    frame_of(n, s, t);
    for (int i = 0; i < AROUND; i++) {
        double a = 2 * M_PI * i / AROUND, p[3];
        for (int k = 0; k < 3; k++)
            p[k] = c[k] + radius * (cos(angle) * n[k] + sin(angle) * (cos(a) * s[k] + sin(a) * t[k]));
        vertex(o, p);
    }
}

/* A sphere, or the part of it before the plane `behind` metres behind its centre, which closes it. Corners lie on its
 * surface, faces look out. */
static void solid(obj_out *o, const double c[3], const double n[3], double radius, double behind) {
    bool cut = behind < radius;
    double end = cut ? acos(-behind / radius) : M_PI, pole[3], other[3];
    int rings = cut ? RINGS : 2 * RINGS - 1;
    size_t first = o->vertices + 2; /* of the first ring; the pole is before it, and counting is from 1 */
    for (int k = 0; k < 3; k++) {
        pole[k] = c[k] + radius * n[k];
        other[k] = c[k] - radius * n[k];
    }
    vertex(o, pole);
    for (int r = 1; r <= rings; r++)
        ring(o, c, n, radius, end * r / (cut ? rings : rings + 1));
    if (!cut)
        vertex(o, other);
    for (size_t i = 0; i < AROUND; i++)
        fprintf(o->file, "f %zu %zu %zu\n", first - 1, first + i, first + (i + 1) % AROUND);
    for (size_t r = 0; r + 1 < (size_t)rings; r++)
        for (size_t i = 0; i < AROUND; i++) {
            size_t a = first + r * AROUND + i, b = first + r * AROUND + (i + 1) % AROUND;
            fprintf(o->file, "f %zu %zu %zu %zu\n", a, a + AROUND, b + AROUND, b);
        }
    size_t last = first + (size_t)(rings - 1) * AROUND;
    if (cut)
        fputc('f', o->file);
    for (size_t i = 0; i < AROUND; i++)
        if (cut)
            fprintf(o->file, " %zu", last + AROUND - 1 - i);
        else
            fprintf(o->file, "f %zu %zu %zu\n", last + i, last + AROUND, last + (i + 1) % AROUND);
    if (cut)
        fputc('\n', o->file);
}

/* The first of its lights gives a volume its name, as far as OBJ can have it. */
static void name_of(const noc_influence *v, const noc_scene *scene, uint32_t volume, char out[64]) {
    uint32_t first = v->first ? v->first[volume] : volume, end = v->first ? v->first[volume + 1] : volume + 1;
    const char *name = scene->light_names.data[v->ids[first]];
    int n = snprintf(out, 64, "volume_%u", volume);
    if (end - first > 1)
        n += snprintf(out + n, 64 - (size_t)n, "_of_%u", end - first);
    if (name)
        n += snprintf(out + n, 64 - (size_t)n, "_%.24s", name);
    for (char *p = out; *p; p++)
        if (!isalnum((unsigned char)*p))
            *p = '_';
}

static void box(obj_out *o, const noc_influence_box *b) {
    static const unsigned faces[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                          { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    size_t first = o->vertices + 1;
    for (int i = 0; i < 8; i++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = i >> k & 1 ? b->hi[k] : b->lo[k];
        vertex(o, p);
    }
    for (int f = 0; f < 6; f++)
        fprintf(o->file, "f %zu %zu %zu %zu\n", first + faces[f][0], first + faces[f][1], first + faces[f][2],
                first + faces[f][3]);
}

void noc_influence_write(const noc_influence *v, const noc_scene *scene, double set, FILE *file) {
    obj_out o = { file, 0 };
    double scale = set > 0 ? (double)noc_influence_scale(set) : (double)v->scale;
    fprintf(file, "# Influence volumes of %u lights, S_r = %.6g m; metres in the scene's local frame, y up\n",
            v->shining[NOC_STANDING] + v->shining[NOC_MOVING], scale);
    fprintf(file, "# scene-crs-name %s\n# scene-origin %.12g %.12g %.12g\n", scene->crs_name ? scene->crs_name : "",
            scene->origin[0], scene->origin[1], scene->origin[2]);
    for (uint32_t i = 0; i < v->volume_count; i++) {
        const noc_influence_volume *a = &v->volumes[i];
        double c[3] = { a->c[0], a->c[1], a->c[2] }, n[3] = { 0, 0, 1 };
        double length = sqrt((double)a->m[0] * a->m[0] + (double)a->m[1] * a->m[1] + (double)a->m[2] * a->m[2]);
        for (int k = 0; k < 3 && length > 0; k++)
            n[k] = a->m[k] / length;
        char name[64];
        if (!(a->root > 0))
            continue;
        name_of(v, scene, i, name);
        if (v->boxes && v->box_of[i] < v->box_count)
            fprintf(file, "o %s_in_box_%u\n", name, v->box_of[i]);
        else
            fprintf(file, "o %s\n", name);
        solid(&o, c, n, scale * a->root + a->size, length > 0 ? 1 / length : INFINITY);
    }
    for (uint32_t i = 0; v->boxes && i < v->box_count; i++) {
        fprintf(file, "o box_%u\n", i);
        box(&o, &v->boxes[i]);
    }
}
