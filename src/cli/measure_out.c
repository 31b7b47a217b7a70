/* nocturne measure: figures of regions and of the raster. */
#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void json_figure(FILE *out, const char *before, const char *name, double v) {
    fprintf(out, ",%s\"%s\": ", before, name);
    cli_json_number(out, v);
}

void measure_json_figures(FILE *out, const measure_job *job, const measure_told *t, const char *before) {
    static const noc_lux_least none = { 0, NAN, NAN, NAN, NAN, 0, 0, NAN, NAN };
    const noc_lux_figures *f = &t->figures;
    const noc_lux_least *l = t->has_least ? &t->least : &none;
    const struct {
        const char *name;
        double value;
    } rows[] = { { "readings", (double)f->readings },
                 { "area", t->area > 0 ? t->area : NAN },
                 { "mean", f->mean },
                 { "mean_error", t->info.mean_error },
                 { "minimum", l->lux },
                 { "minimum_error", l->error },
                 { "minimum_low", l->low },
                 { "minimum_high", l->high },
                 { "minimum_candidates", t->has_least ? (double)l->candidates : NAN },
                 { "minimum_x", t->has_least ? t->least_at[0] : NAN },
                 { "minimum_y", t->has_least ? t->least_at[1] : NAN },
                 { "least_reading", f->least },
                 { "maximum", f->most },
                 { "uniformity", l->uniformity },
                 { "uniformity_error", l->uniformity_error },
                 { "left_out", t->has_least ? (double)t->left_out : NAN },
                 { "percentile_5", f->low },
                 { "median", f->median },
                 { "percentile_95", f->high },
                 { "reading_error", t->info.error },
                 { "readings_over_error", (double)t->info.short_of_it },
                 { "maintenance", job->site.info.maintenance },
                 { "sky", job->args->render.render.sky } };
    if (t->has_least)
        fprintf(out, ",%s\"minimum_resolved\": %s", before, l->candidates == 1 ? "true" : "false");
    fprintf(out, ",%s\"windows_counted\": %s", before, job->args->count_windows ? "true" : "false");
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        json_figure(out, before, rows[i].name, rows[i].value);
}

static void print_json(const measure_job *job, const measure_told *t) {
    printf("%s{\"nocturne\": \"%s\", \"measured\": ", job->lead, noc_version());
    cli_json_text(stdout, t->what);
    printf(",\n  \"crs\": ");
    cli_json_text(stdout, job->site.info.given_crs);
    cli_site_json(&job->site, &job->args->render);
    measure_json_figures(stdout, job, t, "\n  ");
    json_figure(stdout, "\n  ", "seconds", t->info.seconds);
    printf("}");
}

static void print_least(const measure_told *t) {
    const noc_lux_least *l = &t->least;
    char count[32];
    if (!t->has_least) {
        printf("  minimum     %.4g lx of single readings, too low by their noise: --region has one with its error\n",
               t->figures.least);
        return;
    }
    printf("  minimum     %.4g lx ± %.2g", l->lux, l->error);
    if (l->candidates == 1)
        printf(" at %.10g %.10g\n", t->least_at[0], t->least_at[1]);
    else
        printf(", between %.4g and %.4g lx: its place is open, %s points may have it\n", l->low, l->high,
               noc_text_count(count, l->candidates));
    if (l->lux == 0 && l->error == 0)
        printf("              no light was found there in %u samples, which is not proof that there is none\n",
               l->samples);
    if (isfinite(l->uniformity))
        printf("  Uo          %.3g ± %.2g, minimum over mean\n", l->uniformity, l->uniformity_error);
}

static void print_text(measure_job *job, const measure_told *t) {
    const noc_lux_figures *f = &t->figures;
    char count[32], area[32], time[32];
    printf("%s%s: %s readings", job->lead, t->what, noc_text_count(count, f->readings));
    if (t->area > 0)
        printf(" on %s m2", cli_number(area, t->area));
    printf(" in %s\n", noc_text_seconds(time, t->info.seconds));
    if (f->readings) {
        printf("  mean        %.4g lx ± %.2g\n", f->mean, t->info.mean_error);
        print_least(t);
        printf("  maximum     %.4g lx, of single readings\n", f->most);
        printf("  percentiles %.4g lx (5 %%), %.4g lx (50 %%), %.4g lx (95 %%)\n", f->low, f->median, f->high);
        printf("  error       %.2g %% of a reading (median); %s over %.3g %%\n", 100 * t->info.error,
               noc_text_count(count, t->info.short_of_it), 100 * job->params.error);
    }
    if (t->left_out)
        printf("  left out    %s points: something stands on the ground there\n", noc_text_count(count, t->left_out));
    if (job->site.info.maintenance != 1)
        printf("  lamps give %g of their flux (--maintenance); meshes that shine, windows and cars all of theirs\n",
               job->site.info.maintenance);
    printf("  windows %s\n", job->args->count_windows ? "count" : "are dark (--count-windows)");
}

static void tell(measure_job *job, const measure_told *t) {
    if (job->args->json)
        print_json(job, t);
    else
        print_text(job, t);
    job->lead = job->args->json ? ",\n" : "\n";
}

/* ---- regions ---- */

/* Its parts are points: a place, or one in each cell of the ground. */
static noc_status find_meters(measure_job *job, const char *text, noc_log *log, noc_meter **meters,
                              noc_region_info *info) {
    const noc_render_params *render = &job->args->render.render;
    noc_region_params of = { .camera = &job->site.camera,
                             .width = render->width,
                             .height = render->height,
                             .crs = job->args->crs,
                             .files = true };
    noc_region *region = noc_region_find(job->site.view, job->site.scene, text, &of, log);
    if (!region)
        return NOC_ERR_ARGUMENT;
    noc_region_get_info(region, info);
    *meters = cli_alloc(info->patches * sizeof(**meters));
    for (size_t i = 0; i < info->patches; i++) {
        noc_patch p;
        noc_region_get_patch(region, i, &p);
        for (int k = 0; k < 3; k++) {
            (*meters)[i].place[k] = p.p[k] + job->args->meter_height * p.n[k];
            (*meters)[i].normal[k] = p.n[k];
        }
    }
    noc_region_destroy(region);
    return NOC_OK;
}

static noc_status figures_of(measure_job *job, const noc_meter *meters, size_t count, noc_reading *readings, float *lux,
                             measure_told *t) {
    noc_view *view = job->site.view;
    noc_status status = noc_measure_points(view, meters, count, &job->params, &job->progress, readings, &t->info);
    for (size_t i = 0; i < count; i++)
        lux[i] = (float)readings[i].lux;
    status = status ? status : noc_lux_figures_of(lux, NULL, count, &t->figures, job->site.log);
    status = status
                 ? status
                 : noc_measure_least(view, meters, count, readings, &t->info, &job->params, &job->progress, &t->least);
    cli_progress_clear();
    if (status)
        return status;
    double at[3];
    memcpy(at, meters[t->least.meter].place, sizeof(at));
    if (*job->site.info.given_crs)
        status = noc_scene_from_local(job->site.scene, NULL, at);
    memcpy(t->least_at, at, sizeof(t->least_at));
    t->has_least = true;
    return status;
}

noc_status measure_told_region(measure_job *job, const char *region, noc_log *log, measure_told *t) {
    noc_meter *meters = NULL;
    noc_region_info info;
    *t = (measure_told){ .what = region };
    noc_status status = find_meters(job, region, log, &meters, &info);
    if (status)
        return status;
    noc_reading *readings = cli_alloc(info.patches * sizeof(*readings));
    float *lux = cli_alloc(info.patches * sizeof(*lux));
    status = figures_of(job, meters, info.patches, readings, lux, t);
    t->area = strncmp(region, "street:", 7) && strncmp(region, "polygon:", 8) ? 0 : info.weight;
    t->left_out = info.left_out;
    free(lux);
    free(readings);
    free(meters);
    return status;
}

noc_status measure_regions(measure_job *job) {
    const noc_texts *regions = &job->args->regions;
    bool array = job->args->json && regions->count > 1;
    noc_status status = NOC_OK;
    job->lead = array ? "[\n" : "";
    for (size_t i = 0; i < regions->count && !status; i++) {
        measure_told t;
        status = measure_told_region(job, regions->text[i], job->site.log, &t);
        if (!status)
            tell(job, &t);
    }
    if (job->args->json && *job->lead == ',')
        puts(array ? "\n]" : "");
    return status;
}

/* ---- the raster ---- */

static noc_status tell_raster(measure_job *job, const noc_raster *r, measure_told *t) {
    size_t area = (size_t)r->width * (size_t)r->height;
    noc_status status = noc_lux_figures_of(r->lux, r->share, area, &t->figures, job->site.log);
    if (status)
        return status;
    if (!job->args->json)
        printf("%s%d x %d pixels of %g: ", job->lead, r->width, r->height, r->step);
    job->lead = job->args->json ? job->lead : "";
    tell(job, t);
    if (job->args->json)
        puts("");
    return NOC_OK;
}

noc_status measure_raster(measure_job *job) {
    const measure_args *args = job->args;
    measure_told t = { .what = args->render.output };
    char sky[32], maintenance[32], error[32], key[NOC_CONTENT_KEY];
    job->lead = job->lead ? job->lead : "";
    noc_raster *r = noc_measure_raster(job->site.view, &job->raster, &job->params, &job->progress, &t.info);
    cli_progress_clear();
    if (!r)
        return NOC_ERR_FORMAT;
    noc_scene_content(job->site.scene, key);
    snprintf(sky, sizeof(sky), "%.6g", args->render.render.sky);
    snprintf(maintenance, sizeof(maintenance), "%g", job->site.info.maintenance);
    snprintf(error, sizeof(error), "%g", args->error);
    const char *const items[][2] = { { "TIFFTAG_SOFTWARE", "nocturne" },
                                     { "NOCTURNE_VERSION", noc_version() },
                                     { "NOCTURNE_SCENE", key },
                                     { "NOCTURNE_SKY_CD_M2", sky },
                                     { "NOCTURNE_MAINTENANCE", maintenance },
                                     { "NOCTURNE_WINDOWS", args->count_windows ? "counted" : "dark" },
                                     { "NOCTURNE_BOUNCES", "0" },
                                     { "NOCTURNE_ERROR", error },
                                     { NULL, NULL } };
    noc_status status = NOC_OK;
    if (!t.info.readings) {
        cli_error("%.100s: not written: no pixel of the raster has such ground, all of it is nodata",
                  args->render.output);
        status = NOC_ERR_ARGUMENT;
    }
    status = status ? status : noc_raster_write(r, args->render.output, items, job->site.log);
    status = status ? status : tell_raster(job, r, &t);
    noc_raster_destroy(r);
    return status;
}
