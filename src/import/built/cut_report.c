/* What is told of a tile: of its own file all, of files that all tiles have what is in the tile. */
#include "import/built/cut.h"

#define SECTION "tile"

/* Of a file that is common: who reads it tells what it lacks, once for each tile, so that it is not counted here. */
static noc_report_file common_file(const noc_report_file *from) {
    return (noc_report_file){ .path = from->path,
                              .format = from->format,
                              .crs = from->crs,
                              .crs_given = from->crs_given,
                              .height_unit_by = from->height_unit_by,
                              .height_unit = from->height_unit,
                              .bytes = from->bytes };
}

/* Numbers of files: NOC_JOIN_NONE of those that are other tiles'. */
static bool take_files(const noc_report *report, const noc_tile *tile, noc_report *to, uint32_t *number) {
    noc_report one = *report; /* with the files that are taken alone */
    bool ok = true;
    one.panes.len = one.rule_count = 0;
    one.lamps_inferred = one.road_cars = one.roads_drawn = one.images_reduced = 0;
    for (size_t i = 0; ok && i < report->files.len; i++) {
        cut_file of = built_cut_file(tile, report->files.data[i].path);
        noc_report_file file = of == CUT_OWN ? report->files.data[i] : common_file(&report->files.data[i]);
        number[i] = of == CUT_OTHERS ? NOC_JOIN_NONE : (uint32_t)to->files.len;
        file.lamps_mapped = file.lights = 0;
        one.files.data = &file;
        one.files.len = 1;
        ok = of == CUT_OTHERS || built_join_report(to, &one, NULL, 0);
    }
    return ok;
}

static bool take_windows(const noc_scene *whole, const noc_report *report, const uint32_t *number, noc_report *to,
                         const bool *taken, uint32_t own) {
    size_t w = 0;
    for (size_t i = 0; i < report->panes.len; i++) {
        const report_panes *p = &report->panes.data[i];
        uint32_t file = number[p->file] == NOC_JOIN_NONE ? own : number[p->file];
        for (size_t end = w + p->panes; w < end && w < whole->windows.len; w++) {
            if (!taken[w])
                continue;
            if (!report_pane(to, file, p->counts))
                return false;
            if (file == own || !p->counts)
                continue;
            const float *e = whole->lights.data[whole->windows.data[w].light].e;
            to->files.data[file].windows.windows++;
            to->files.data[file].windows.lit += e[0] > 0 || e[1] > 0 || e[2] > 0;
        }
    }
    return true;
}

noc_report *built_cut_report(const noc_scene *part, const noc_scene *whole, const noc_report *report,
                             const noc_tile *tile, const bool *taken, const bool *lights) {
    noc_report *to = report_create();
    uint32_t *number = noc_calloc(report->files.len + 1, sizeof(*number)), own = 0;
    bool ok = to && number && take_files(report, tile, to, number);
    for (size_t i = 0; ok && i < report->files.len; i++)
        own = built_cut_file(tile, report->files.data[i].path) == CUT_OWN ? number[i] : own;
    ok = ok && take_windows(whole, report, number, to, taken, own);
    for (size_t i = 0; ok && i < report->mapped.len; i++) {
        const report_lamp *l = &report->mapped.data[i];
        uint32_t file = number[l->file] == NOC_JOIN_NONE ? own : number[l->file]; /* of a neighbour, in this tile */
        if (file >= to->files.len || !lights[l->first])
            continue;
        to->files.data[file].lamps_mapped++;
        to->files.data[file].lamps += file != own;
        to->files.data[file].lights += l->end - l->first;
    }
    if (ok) {
        to->lamps_inferred = part->lights_inferred;
        memcpy(to->profiles, report->profiles, sizeof(to->profiles));
        for (size_t i = 0; i < part->cars.len; i++)
            to->road_cars++;
    }
    free(number);
    if (ok && !to->arena.refused)
        return to;
    noc_report_destroy(to);
    return NULL;
}

/* ---- the file's own word ---- */

void built_write_tile(noct_writer *w, const noc_scene *part, const noc_report *told, const noc_tile *tile) {
    noc_report_totals t;
    char text[400];
    const double *e = tile->extents[tile->own];
    noc_report_get_totals(told, &t);
    noc_snprintf(text, sizeof(text), "%.17g %.17g %.17g %.17g %zu %zu %zu %zu %.64s", e[0], e[1], e[2], e[3],
                 t.buildings, part->windows.len, t.lamps_mapped + t.lamps_inferred, part->triangle_light.len,
                 tile->key ? tile->key : "-");
    noct_put_array(w, SECTION, text, strlen(text), 1);
}

noc_status noc_built_get_tile(const char *path, noc_log *log, noc_tile_info *info) {
    char *text = NULL;
    if (!path || !info)
        return noc_null(log, __func__);
    *info = (noc_tile_info){ 0 };
    noc_status status = noct_read_text(path, SECTION, 400, log, &text);
    if (status)
        return status;
    unsigned long long *n[] = { &info->buildings, &info->windows, &info->lamps, &info->triangles };
    const char *at = text ? text : "";
    bool ok = true;
    for (int i = 0; i < 4 && ok; i++) {
        const char *end = at + strcspn(at, " ");
        ok = noc_scan_double(at, end, &info->extent[i]) == end && *end;
        at = ok ? end + 1 : at;
    }
    for (size_t i = 0; i < NOC_COUNT(n) && ok; i++) {
        char *end;
        *n[i] = strtoull(at, &end, 10);
        ok = end > at && *end == ' ';
        at = ok ? end + 1 : at;
    }
    if (ok && strcmp(at, "-"))
        noc_snprintf(info->key, sizeof(info->key), "%s", at);
    free(text);
    return ok ? NOC_OK : noc_error(log, NOC_ERR_FORMAT, "%s: was not built as a tile", path);
}
