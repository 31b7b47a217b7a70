/* What is imported, in one number: the scene, its names and CRSs, and what the report says. */
#ifndef NOC_TEST_DIGEST_H
#define NOC_TEST_DIGEST_H

#include "scene/scene.h"
#include <nocturne/nocturne.h>

typedef struct digest {
    uint64_t sum;
} digest;

static void add_bytes(digest *d, const void *data, size_t size) {
    for (const unsigned char *p = data; size--; p++)
        d->sum = (d->sum ^ *p) * 0x100000001b3u;
}

static void add_text(digest *d, const char *text) { add_bytes(d, text ? text : "-", text ? strlen(text) + 1 : 1); }

static void add_number(digest *d, double x) { add_bytes(d, &x, sizeof(x)); }

static uint64_t digest_of(const noc_scene *scene, const noc_report *report) {
    digest d = { 0xcbf29ce484222325u };
    char key[NOC_CONTENT_KEY] = "";
    if (scene->committed)
        noc_scene_content(scene, key);
    add_text(&d, key);
    add_text(&d, scene->crs_name);
    add_text(&d, scene->given_crs_name);
    add_text(&d, scene->without_crs);
    for (size_t i = 0; i < scene->meshes.len; i++)
        add_text(&d, scene->meshes.data[i].name);
    for (size_t i = 0; i < scene->light_names.len; i++)
        add_text(&d, scene->light_names.data[i]);
    for (size_t i = 0; i < scene->walls.len; i++)
        add_number(&d, scene->walls.data[i]);
    for (size_t i = 0; i < noc_report_file_count(report); i++) {
        const noc_report_file *f = noc_report_get_file(report, i);
        const char *texts[] = { f->path, f->format, f->crs, f->crs_given };
        const size_t numbers[] = { f->objects,    f->polygons,        f->triangles,   f->lights,
                                   f->lamps,      f->lamps_mapped,    f->points,      f->column_count,
                                   f->line_count, f->windows.windows, f->windows.own, f->windows.lit };
        for (size_t k = 0; k < NOC_COUNT(texts); k++)
            add_text(&d, texts[k]);
        for (size_t k = 0; k < NOC_COUNT(numbers); k++)
            add_number(&d, (double)numbers[k]);
        for (size_t k = 0; k < f->column_count; k++) {
            add_text(&d, f->columns[k].name);
            add_text(&d, f->columns[k].field);
            add_text(&d, f->columns[k].example);
            add_number(&d, (double)f->columns[k].values);
        }
        for (size_t k = 0; k < f->line_count; k++) {
            add_text(&d, f->lines[k].reason);
            add_text(&d, f->lines[k].examples);
            add_number(&d, (double)f->lines[k].count);
        }
    }
    return d.sum;
}

#endif
