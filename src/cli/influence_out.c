/* What nocturne influence prints and writes: a row an emitter, then what is left, the sky and the sum. */
#include "influence.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is told of an emitter beside its light: of lamps, by the report. */
typedef struct told {
    const noc_report_lamp *lamp; /* NULL: nothing */
    double at[3];                /* in the scene's CRS, or local metres */
} told;

static told tell(const influence_job *job, const noc_influence_row *row) {
    told t = { noc_report_find_lamp(job->site.report, row->emitter.light), { 0 } };
    memcpy(t.at, row->emitter.centre, sizeof(t.at));
    if (*job->site.info.given_crs && noc_scene_from_local(job->site.scene, NULL, t.at))
        t.at[0] = t.at[1] = t.at[2] = NAN;
    return t;
}

/* ---- the table ---- */

static void print_estimate(noc_estimate e, bool share) {
    double by = share ? 100 : 1;
    printf(share ? " %6.2f" : " %9.4g", e.value * by);
    printf(share ? " ±%-5.2f" : " ±%-8.2g", e.error * by);
}

static void print_name(const noc_influence_row *row, const told *t) {
    const noc_emitter *e = &row->emitter;
    char name[64], street[48];
    noc_text_clean(name, sizeof(name), *e->name ? e->name : "unnamed");
    printf("  %s", name);
    if (e->instance >= 0) {
        noc_text_clean(name, sizeof(name), e->of);
        printf(" of %s %d", name, e->instance);
    }
    if (e->light_count > 1)
        printf(" (%zu lights)", e->light_count);
    if (e->inferred)
        printf(", inferred");
    if (t->lamp && *t->lamp->street)
        printf(", %s", noc_text_clean(street, sizeof(street), t->lamp->street));
    if (t->lamp && *t->lamp->file) {
        const char *slash = strrchr(t->lamp->file, '/');
        printf(", %s", noc_text_clean(street, sizeof(street), slash ? slash + 1 : t->lamp->file));
    }
    putchar('\n');
}

static void print_row(const influence_job *job, const noc_influence_row *row) {
    told t = tell(job, row);
    char kelvin[16] = "-";
    if (isfinite(row->emitter.kelvin))
        snprintf(kelvin, sizeof(kelvin), "%.0f", row->emitter.kelvin);
    print_estimate(row->lux, false);
    print_estimate(row->share, true);
    printf("  %-8s %8.1f %8.0f %6s", noc_emitter_kind_name(row->emitter.kind), row->distance, row->emitter.lumens,
           kelvin);
    print_name(row, &t);
}

static void print_known(noc_estimate e, bool share) {
    if (isfinite(e.value))
        print_estimate(e, share);
    else
        printf(share ? " %6s %6s" : " %9s %9s", "-", "");
}

static void print_rest(const char *name, noc_estimate lux, noc_estimate share) {
    print_estimate(lux, false);
    print_known(share, true);
    printf("  %s\n", name);
}

static void print_classes(const influence_job *job) {
    if (!job->class_count)
        return;
    printf("%11s%9s%10s%10s%15s%5s %9s  %s\n", "lx by lamps", "", "by windows", "",
           job->sum.windows_counted ? "by all" : "without windows", "", "m2", "of its surfaces");
    for (size_t i = 0; i < job->class_count; i++) {
        const noc_influence_class *c = &job->classes[i];
        print_known(c->lamps, false);
        print_known(c->windows, false);
        print_known(c->lux, false);
        printf(" %9.*f  %s\n", c->weight < 100 ? 1 : 0, c->weight, noc_class_name(c->cls));
    }
}

/* The sums by kind of light: lamps, windows, then the strongest first. Shares of those that count are 100 %. */
static void print_kinds(const noc_influence_sum *s) {
    static const char *const nouns[] = { [NOC_EMITTER_LAMP] = "lamp",
                                         [NOC_EMITTER_WINDOW] = "window",
                                         [NOC_EMITTER_VEHICLE] = "vehicle light",
                                         [NOC_EMITTER_SURFACE] = "surface",
                                         [NOC_EMITTER_OTHER] = "other light" };
    bool done[NOC_EMITTER_KIND_COUNT] = { false };
    char name[64];
    printf("%10s%9s %7s %6s   %s\n", "lx", "", "share %", "", "by kind");
    for (;;) {
        int best = -1;
        for (int k = 0; k < NOC_EMITTER_KIND_COUNT; k++)
            if (!done[k] && s->kinds[k].emitters &&
                (best < 0 || (best > NOC_EMITTER_WINDOW && s->kinds[k].lux.value > s->kinds[best].lux.value)))
                best = k;
        if (best < 0)
            break;
        done[best] = true;
        print_rest(noc_text_many(name, s->kinds[best].emitters, nouns[best]), s->kinds[best].lux, s->kinds[best].share);
    }
    if (s->sky.value > 0)
        print_rest("sky", s->sky, s->sky_share);
}

void influence_print_maintenance(const influence_job *job) {
    if (job->site.info.maintenance != 1)
        printf("lamps give %g of their flux (--maintenance); meshes that shine, windows and cars all of theirs\n",
               job->site.info.maintenance);
}

/* Lamps first, windows beside them, then the sum of what counts. */
static void print_parts(const influence_job *job) {
    const noc_influence_sum *s = &job->sum;
    static const char *const nouns[] = { "lamp", "window" };
    char a[64], b[64];
    for (int k = NOC_EMITTER_LAMP; k <= NOC_EMITTER_WINDOW; k++)
        printf("%s lx ± %.2g by %s%s\n", cli_number(a, s->kinds[k].lux.value), s->kinds[k].lux.error,
               noc_text_many(b, s->kinds[k].emitters, nouns[k]),
               k == NOC_EMITTER_LAMP || s->windows_counted ? "" : ", not counted below (--count-windows)");
    printf("%s lx ± %.2g by %s%s%s\n", cli_number(a, s->lux.value), s->lux.error,
           noc_text_many(b, s->emitters, "light"), s->sky.value > 0 ? " and the sky" : "",
           s->windows_counted ? "" : ", without windows");
    influence_print_maintenance(job);
}

static noc_status print_table(influence_job *job) {
    const noc_influence_sum *s = &job->sum;
    const noc_region_info *r = &job->region_info;
    double at[3] = { r->centre[0], r->centre[1], r->centre[2] };
    char a[64], b[64], region[100];
    if (*job->site.info.given_crs && noc_scene_from_local(job->site.scene, NULL, at))
        return NOC_ERR_ARGUMENT;
    noc_text_clean(region, sizeof(region), job->asked);
    printf("%s: %s %.3f %.3f %.3f in %s\n", region, r->point ? "at" : "around", cli_shown(at[0], 3),
           cli_shown(at[1], 3), cli_shown(at[2], 3),
           *job->site.info.given_crs ? job->site.info.given_crs : "local metres");
    if (*job->buried)
        printf("it lies %s: a luxmeter there is dark\n", job->buried);
    print_parts(job);
    if (s->luminance.value > 0)
        printf("%s cd/m2 ± %.2g towards the camera of this, without what shines itself\n",
               cli_number(a, s->luminance.value), s->luminance.error);
    print_classes(job);
    if (s->lux.value > 0 || s->kinds[NOC_EMITTER_WINDOW].lux.value > 0)
        print_kinds(s);
    if (job->count)
        printf("%10s%9s %7s %6s   %-8s %8s %8s %6s  %s\n", "lx", "", "share %", "", "kind", "m away", "lm", "K",
               "name, street, file");
    for (size_t i = 0; i < job->count; i++)
        print_row(job, &job->rows[i]);
    if (s->emitters > job->count) {
        snprintf(b, sizeof(b), "%s others", noc_text_count(a, s->emitters - job->count));
        print_rest(b, s->rest, s->rest_share);
    }
    if (s->sky.value > 0)
        print_rest("sky", s->sky, s->sky_share);
    if (!job->args->render.common.quiet)
        printf("%s rays in %s\n", noc_text_count(a, s->rays), noc_text_seconds(b, s->seconds));
    return NOC_OK;
}

/* ---- JSON and CSV ---- */

static void json_estimate(const char *name, noc_estimate e) {
    printf("\"%s\": ", name);
    cli_json_number(stdout, e.value);
    printf(", \"%s_error\": ", name);
    cli_json_number(stdout, e.error);
}

static void json_text(const char *name, const char *text) {
    printf(", \"%s\": ", name);
    cli_json_text(stdout, text);
}

static void json_number(const char *name, double v) {
    printf(", \"%s\": ", name);
    cli_json_number(stdout, v);
}

/* An object of texts; of a key that comes twice the last one counts, as readers of JSON have it. */
void influence_json_tags(const char *tags) {
    printf(", \"tags\": {");
    for (const char *p = tags; *p;) {
        size_t n = strcspn(p, "\n"), key = strcspn(p, "=");
        char *text = cli_format("%.*s", (int)n, p);
        bool pair = key < n;
        if (pair)
            text[key] = 0;
        fputs(p == tags ? "" : ", ", stdout);
        cli_json_text(stdout, text);
        printf(": ");
        cli_json_text(stdout, pair ? text + key + 1 : "");
        free(text);
        p += n + (p[n] == '\n');
    }
    printf("}");
}

static void json_row(const influence_job *job, const noc_influence_row *row) {
    told t = tell(job, row);
    const noc_emitter *e = &row->emitter;
    printf("    {");
    json_estimate("lux", row->lux);
    printf(", ");
    json_estimate("share", row->share);
    json_text("kind", noc_emitter_kind_name(e->kind));
    json_text("name", e->name);
    json_text("of", e->of);
    json_number("instance", e->instance >= 0 ? e->instance : NAN);
    json_number("light", (double)e->light);
    json_number("lights", (double)e->light_count);
    json_number("x", t.at[0]);
    json_number("y", t.at[1]);
    json_number("z", t.at[2]);
    json_number("distance", row->distance);
    json_number("lumens", e->lumens);
    json_number("kelvin", round(e->kelvin));
    json_text("placed", e->inferred ? "inferred" : t.lamp ? "mapped" : "");
    json_text("street", t.lamp ? t.lamp->street : "");
    json_text("file", t.lamp ? t.lamp->file : "");
    json_text("profile", t.lamp ? t.lamp->profile : "");
    influence_json_tags(t.lamp ? t.lamp->tags : "");
    printf("}");
}

/* All of them, those that bring nothing, too; sky is beside them. */
static void json_kinds(const noc_influence_sum *s) {
    printf("],\n  \"kinds\": [");
    for (int k = 0; k < NOC_EMITTER_KIND_COUNT; k++) {
        printf("%s    {\"kind\": \"%s\", ", k ? ",\n" : "\n", noc_emitter_kind_name((noc_emitter_kind)k));
        json_estimate("lux", s->kinds[k].lux);
        printf(", ");
        json_estimate("share", s->kinds[k].share);
        json_number("lights", (double)s->kinds[k].emitters);
        printf("}");
    }
}

static noc_status print_json(influence_job *job) {
    const noc_influence_sum *s = &job->sum;
    printf("{\"nocturne\": \"%s\", \"region\": ", noc_version());
    cli_json_text(stdout, job->asked);
    json_text("crs", job->site.info.given_crs);
    printf(", \"note\": ");
    cli_json_text(stdout, *job->buried ? job->buried : NULL);
    cli_site_json(&job->site, &job->args->render);
    printf(",\n ");
    json_estimate("lamps", s->kinds[NOC_EMITTER_LAMP].lux);
    printf(",\n ");
    json_estimate("windows", s->kinds[NOC_EMITTER_WINDOW].lux);
    printf(", \"windows_counted\": %s,\n ", s->windows_counted ? "true" : "false");
    json_estimate("lux", s->lux);
    json_number("maintenance", job->site.info.maintenance);
    printf(",\n ");
    json_estimate("sky", s->sky);
    printf(", ");
    json_estimate("sky_share", s->sky_share);
    printf(",\n ");
    json_estimate("rest", s->rest);
    printf(", ");
    json_estimate("rest_share", s->rest_share);
    printf(",\n ");
    json_estimate("luminance", influence_has_eye(job->asked)
                                   ? s->luminance
                                   : (noc_estimate){ NAN, NAN }); /* of a place there is none */
    json_number("lights", (double)s->emitters);
    json_number("samples", (double)s->samples);
    json_number("rays", (double)s->rays);
    json_number("seconds", s->seconds);
    if (job->class_count)
        json_number("area", job->region_info.weight);
    printf(",\n  \"classes\": [");
    for (size_t i = 0; i < job->class_count; i++) {
        printf("%s    {\"class\": \"%s\"", i ? ",\n" : "\n", noc_class_name(job->classes[i].cls));
        json_number("area", job->classes[i].weight);
        printf(", ");
        json_estimate("lamps", job->classes[i].lamps);
        printf(", ");
        json_estimate("windows", job->classes[i].windows);
        printf(", ");
        json_estimate("lux", job->classes[i].lux);
        printf("}");
    }
    json_kinds(s);
    printf("],\n  \"rows\": [");
    for (size_t i = 0; i < job->count; i++) {
        fputs(i ? ",\n" : "\n", stdout);
        json_row(job, &job->rows[i]);
    }
    printf("\n]}\n");
    return NOC_OK;
}

noc_status influence_print(influence_job *job) { return job->args->json ? print_json(job) : print_table(job); }

bool influence_csv_alone(const influence_args *args) { return args->csv && !strcmp(args->csv, "-"); }

/* One head of names, before the first region's rows. */
noc_status influence_add_csv(influence_job *job) {
    char *text = noc_influence_csv(job->site.scene, job->site.report, job->rows, job->count, &job->sum, job->classes,
                                   job->class_count, job->asked);
    if (!text)
        cli_no_memory();
    char *before = job->csv, *rows = before ? strchr(text, '\n') + 1 : text;
    job->csv = cli_format("%s%s", before ? before : "", rows);
    free(before);
    free(text);
    return NOC_OK;
}

noc_status influence_write_csv(influence_job *job) {
    if (influence_csv_alone(job->args)) {
        fputs(job->csv, stdout); /* which is looked at in the end */
        return NOC_OK;
    }
    return noc_text_save(job->args->csv, job->csv, strlen(job->csv), job->site.log);
}
