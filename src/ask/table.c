/* The table of a ranking as CSV. */
#include "ask/ask.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Names are strangers' words: spreadsheets run what begins like a formula, and an apostrophe makes it text to them. */
static void csv_text(FILE *out, const char *text) {
    fputs(",\"", out);
    if (*text && strchr("=+-@", *text))
        putc('\'', out);
    for (const char *p = text; *p; p++) {
        if (*p == '"')
            putc('"', out);
        putc((unsigned char)*p < ' ' ? ' ' : *p, out);
    }
    putc('"', out);
}

static void csv_number(FILE *out, double v, int decimals) {
    if (!isfinite(v))
        putc(',', out);
    else if (decimals < 0)
        fprintf(out, ",%.6g", v);
    else
        fprintf(out, ",%.*f", decimals, v);
}

/* The last columns: what the scene's lamps give of their flux, and what was asked about. */
static void csv_end(FILE *out, const noc_scene *scene, const char *region) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    csv_number(out, info.maintenance, -1);
    csv_text(out, region);
    putc('\n', out);
}

static void csv_row(FILE *out, const noc_scene *scene, const noc_report *report, const noc_influence_row *row,
                    size_t rank, const char *region) {
    const noc_emitter *e = &row->emitter;
    const noc_report_lamp *lamp = noc_report_find_lamp(report, e->light);
    noc_scene_info info;
    double at[3] = { e->centre[0], e->centre[1], e->centre[2] };
    noc_scene_get_info(scene, &info);
    if (*info.given_crs && noc_scene_from_local(scene, NULL, at))
        at[0] = at[1] = at[2] = NAN;
    const double numbers[] = { row->lux.value, row->lux.error, row->share.value, row->share.error };
    fprintf(out, "%zu", rank);
    csv_text(out, e->name);
    csv_text(out, noc_emitter_kind_name(e->kind));
    csv_text(out, e->of);
    for (int k = 0; k < 4; k++)
        csv_number(out, numbers[k], -1);
    for (int k = 0; k < 3; k++)
        csv_number(out, at[k], 3);
    csv_number(out, row->distance, 2);
    csv_number(out, e->lumens, -1);
    csv_number(out, e->kelvin, 0);
    csv_text(out, e->inferred ? "inferred" : lamp ? "mapped" : "");
    csv_text(out, lamp ? lamp->street : "");
    csv_text(out, lamp ? lamp->file : "");
    csv_text(out, lamp ? lamp->profile : "");
    putc(',', out);
    csv_text(out, info.given_crs);
    fputs(",,,,", out);
    csv_end(out, scene, region);
}

#define NO_ESTIMATE ((noc_estimate){ NAN, NAN })

/* A line of a sum. area: of the surfaces that get it, m2; NaN: none. parts: by lamps and by windows; NULL: none. */
static void csv_sum(FILE *out, const noc_scene *scene, const char *name, const char *kind, noc_estimate lux,
                    noc_estimate share, double area, const noc_estimate parts[2], const char *region) {
    const double numbers[] = { lux.value, lux.error, share.value, share.error };
    fprintf(out, ",\"%s\",\"%s\",\"\"", name, kind);
    for (int k = 0; k < 4; k++)
        csv_number(out, numbers[k], -1);
    fputs(",,,,,,,\"\",\"\",\"\",\"\"", out);
    csv_number(out, area, -1);
    fputs(",\"\"", out);
    for (int k = 0; k < 2; k++) {
        csv_number(out, parts ? parts[k].value : NAN, -1);
        csv_number(out, parts ? parts[k].error : NAN, -1);
    }
    csv_end(out, scene, region);
}

/* Lamps and windows in any case, the first two; of other kinds those that bring anything. */
static void csv_kinds(FILE *out, const noc_scene *scene, const noc_influence_sum *sum, const char *region) {
    for (int k = 0; k < NOC_EMITTER_KIND_COUNT; k++)
        if (k <= NOC_EMITTER_WINDOW || sum->kinds[k].emitters)
            csv_sum(out, scene, noc_emitter_kind_name((noc_emitter_kind)k), "kind", sum->kinds[k].lux,
                    sum->kinds[k].share, NAN, NULL, region);
}

char *noc_influence_csv(const noc_scene *scene, const noc_report *report, const noc_influence_row *rows, size_t count,
                        const noc_influence_sum *sum, const noc_influence_class *classes, size_t class_count,
                        const char *region) {
    char *text = NULL;
    size_t size;
    double area = class_count ? 0 : NAN;
    if (!scene || !sum || (count && !rows) || (class_count && !classes)) {
        noc_null(NULL, __func__);
        return NULL;
    }
    region = region ? region : "";
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fputs("rank,name,kind,of,lux,lux_error,share,share_error,x,y,z,distance,lumens,kelvin,placed,street,file,profile,"
          "area,crs,lamps_lux,lamps_lux_error,windows_lux,windows_lux_error,"
          "maintenance,region\n",
          out);
    for (size_t i = 0; i < count; i++)
        csv_row(out, scene, report, &rows[i], i + 1, region);
    for (size_t i = 0; i < class_count; i++)
        area += classes[i].weight;
    csv_kinds(out, scene, sum, region);
    csv_sum(out, scene, "", "sky", sum->sky, sum->sky_share, NAN, NULL, region);
    csv_sum(out, scene, sum->windows_counted ? "windows counted" : "without windows", "all", sum->lux,
            sum->lux.value > 0 ? (noc_estimate){ 1, 0 } : NO_ESTIMATE, area,
            (const noc_estimate[]){ sum->kinds[NOC_EMITTER_LAMP].lux, sum->kinds[NOC_EMITTER_WINDOW].lux }, region);
    for (size_t i = 0; i < class_count; i++)
        csv_sum(out, scene, noc_class_name(classes[i].cls), "class", classes[i].lux, NO_ESTIMATE, classes[i].weight,
                (const noc_estimate[]){ classes[i].lamps, classes[i].windows }, region);
    bool bad = ferror(out);
    if (fclose(out) || bad) {
        free(text);
        return NULL;
    }
    return text;
}
