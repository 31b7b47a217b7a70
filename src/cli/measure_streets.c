/* nocturne measure --streets: the figures of each street that has a name, as lines of GeoJSON. */
#include "measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A street as noc_scene_get_street has it, one of several that may have its name. */
typedef struct named_street {
    noc_street street;
    size_t index;
} named_street;

static int by_name(const void *a, const void *b) {
    const named_street *x = a, *y = b;
    int order = strcmp(x->street.name, y->street.name);
    return order ? order : (x->index > y->index) - (x->index < y->index);
}

/* All that have a name, sorted by it. The caller frees them. */
static named_street *find_streets(const noc_scene *scene, size_t *count) {
    size_t all = noc_scene_streets(scene);
    named_street *found = cli_alloc((all + 1) * sizeof(*found));
    *count = 0;
    for (size_t i = 0; i < all; i++) {
        named_street s = { .index = i };
        if (noc_scene_get_street(scene, i, &s.street) && s.street.name && *s.street.name)
            found[(*count)++] = s;
    }
    qsort(found, *count, sizeof(*found), by_name);
    return found;
}

/* Its middle, longitude and latitude; of a scene without CRS local metres. */
static noc_status put_line(FILE *out, const measure_job *job, const noc_street *s) {
    bool crs = *job->site.info.given_crs != 0;
    double *xyz = cli_alloc(3 * s->point_count * sizeof(*xyz));
    for (size_t i = 0; i < 3 * s->point_count; i++)
        xyz[i] = i % 3 == 2 ? 0 : (double)s->points[2 * (i / 3) + i % 3];
    noc_status status = crs ? noc_scene_from_local_all(job->site.scene, "OGC:CRS84", xyz, s->point_count) : NOC_OK;
    for (size_t i = 0; i < s->point_count && !status; i++)
        fprintf(out, "%s[%.*f, %.*f]", i ? ", " : "[", crs ? 7 : 3, xyz[3 * i], crs ? 7 : 3, xyz[3 * i + 1]);
    fputs("]", out);
    free(xyz);
    return status;
}

/* Roads of one name: their figures, and their lines. */
static noc_status put_street(FILE *out, measure_job *job, const named_street *s, size_t count, const measure_told *t,
                             bool first) {
    fprintf(out, "%s{\"type\": \"Feature\", \"properties\": {\"street\": ", first ? "" : ",\n");
    cli_json_text(out, s->street.name);
    fputs(", \"width\": ", out);
    cli_json_number(out, s->street.width);
    measure_json_figures(out, job, t, " ");
    fputs("}, \"geometry\": {\"type\": \"MultiLineString\", \"coordinates\": [", out);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < count && !status; i++) {
        fputs(i ? ", " : "", out);
        status = put_line(out, job, &s[i].street);
    }
    fputs("]}}", out);
    return status;
}

typedef struct street_counts {
    size_t measured, without;
} street_counts;

/* Of all roads that of the street which is measured now, in its steps, each from 0 to 1. */
typedef struct street_progress {
    noc_progress whole;
    double before, part; /* of all */
    double most;         /* of the street */
} street_progress;

static bool update(void *user, const char *what, double done) {
    street_progress *p = user;
    p->most = fmax(p->most, done);
    return p->whole.update(p->whole.user, what, p->before + p->part * p->most);
}

static noc_status put_all(FILE *out, measure_job *job, const named_street *s, size_t count, street_counts *of) {
    noc_status status = NOC_OK;
    fprintf(out, "{\"type\": \"FeatureCollection\", \"nocturne\": \"%s\",%s \"features\": [\n", noc_version(),
            *job->site.info.given_crs ? "" : " \"crs\": null,");
    street_progress progress = { .whole = job->progress };
    job->progress = (noc_progress){ update, &progress };
    for (size_t i = 0, end; i < count && !status; i = end) {
        for (end = i + 1; end < count && !strcmp(s[end].street.name, s[i].street.name); end++)
            ;
        progress.before = (double)i / (double)count;
        progress.part = (double)(end - i) / (double)count;
        progress.most = 0;
        char *region = cli_format("street:%s", s[i].street.name);
        measure_told t;
        status = measure_told_region(job, region, NULL, &t);
        if (status == NOC_ERR_ARGUMENT) { /* it has no ground */
            of->without++;
            status = NOC_OK;
        } else if (!status) {
            status = put_street(out, job, s + i, end - i, &t, !of->measured++);
        }
        free(region);
    }
    job->progress = progress.whole;
    fputs("\n]}\n", out);
    return status;
}

noc_status measure_streets(measure_job *job) {
    const char *path = job->args->streets;
    size_t count, size = 0;
    char *text = NULL;
    named_street *s = find_streets(job->site.scene, &count);
    if (!count) {
        free(s);
        cli_error("--streets: the city has no street with a name: add the map of its roads");
        return NOC_ERR_ARGUMENT;
    }
    FILE *out = open_memstream(&text, &size);
    if (!out)
        cli_no_memory();
    street_counts of = { 0 };
    noc_status status = put_all(out, job, s, count, &of);
    bool whole = !ferror(out);
    whole = !fclose(out) && whole;
    free(s);
    if (!whole)
        cli_no_memory();
    if (!status && !of.measured) {
        cli_error("--streets: none of %zu streets has ground: --map-surfaces lays that of the map's roads", of.without);
        status = NOC_ERR_ARGUMENT;
    }
    if (!status && !strcmp(path, "-"))
        fputs(text, stdout); /* which is looked at in the end */
    else if (!status)
        status = noc_text_save(path, text, size, job->site.log);
    if (!status && strcmp(path, "-") && !job->args->json) {
        printf("%s%s: %zu streets", job->lead ? job->lead : "", path, of.measured);
        printf(of.without ? ", %zu more have no ground\n" : "\n", of.without);
        job->lead = "\n";
    }
    free(text);
    return status;
}
