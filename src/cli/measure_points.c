/* nocturne measure --points: lines of numbers in, CSV out. */
#include "measure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_POINTS 100000000
#define DARK 1e-3 /* lx */
enum { NUMBERS = 6 };

static void grow(point_list *l) {
    if (l->count < l->capacity)
        return;
    l->capacity = l->capacity ? 2 * l->capacity : 1024;
    noc_meter *meters = realloc(l->meters, l->capacity * sizeof(*meters));
    double *xyz = meters ? realloc(l->xyz, 3 * l->capacity * sizeof(*xyz)) : NULL;
    if (!meters || !xyz)
        cli_no_memory();
    l->meters = meters;
    l->xyz = xyz;
}

/* The numbers of a line, parted by blanks, tabs or commas: 3, 6, or 0 where it is empty or a comment; else -1. */
static int read_numbers(const char *line, double out[NUMBERS]) {
    int n = 0;
    for (const char *p = line; *(p += strspn(p, " \t,;\r\n")) && *p != '#'; n++) {
        char word[64];
        size_t length = strcspn(p, " \t,;\r\n#");
        if (n == NUMBERS || length >= sizeof(word))
            return -1;
        memcpy(word, p, length);
        word[length] = 0;
        if (!noc_text_numbers(word, ',', 1, &out[n]))
            return -1;
        p += length;
    }
    return n == 0 || n == 3 || n == NUMBERS ? n : -1;
}

/* Scales a normal to length 1, whatever its size. Returns false for 0, 0, 0. */
static bool make_unit(double v[3]) {
    double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(most > 0))
        return false;
    for (int k = 0; k < 3; k++)
        v[k] /= most;
    double length = hypot(hypot(v[0], v[1]), v[2]);
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return true;
}

static noc_status add(const measure_args *args, point_list *l, const char *name, size_t line, const char *text) {
    noc_response response = (noc_response)args->response;
    double v[NUMBERS] = { 0, 0, 0, 0, 0, 1 };
    char shown[60];
    int n = read_numbers(text, v);
    if (n < 0) {
        cli_error("%.200s:%zu: \"%s\" is not x y z or x y z nx ny nz", name, line,
                  noc_text_clean(shown, sizeof(shown), text));
        return NOC_ERR_FORMAT;
    }
    if (!n)
        return NOC_OK;
    if (!make_unit(v + 3)) {
        cli_error("%.200s:%zu: the normal is 0, 0, 0", name, line);
        return NOC_ERR_FORMAT;
    }
    if (response == NOC_RESPONSE_SEMICYLINDER && !(hypot(v[3], v[4]) > 0)) {
        cli_error("%.200s:%zu: the normal has no azimuth, and a half cylinder faces one: x y z nx ny nz", name, line);
        return NOC_ERR_FORMAT;
    }
    if (l->count == MOST_POINTS) {
        cli_error("%.200s:%zu: more than %d points", name, line, MOST_POINTS);
        return NOC_ERR_FORMAT;
    }
    grow(l);
    memcpy(l->xyz + 3 * l->count, v, 3 * sizeof(*v));
    l->meters[l->count] = (noc_meter){ .normal = { v[3], v[4], v[5] }, .response = response };
    l->count++;
    return NOC_OK;
}

/* A byte order mark, which spreadsheets write, is skipped. */
static const char *without_mark(const char *text, size_t line) {
    return line == 1 && !strncmp(text, "\xef\xbb\xbf", 3) ? text + 3 : text;
}

noc_status measure_read_points(const measure_args *args, point_list *l) {
    const char *name = args->points;
    bool piped = !strcmp(name, "-");
    FILE *in = piped ? stdin : fopen(name, "r");
    char *text = NULL;
    size_t capacity = 0, line = 0;
    noc_status status = NOC_OK;
    name = piped ? "standard input" : name;
    if (!in) {
        cli_error("%.200s: cannot be read: %s", name, strerror(errno));
        return NOC_ERR_IO;
    }
    while (!status && getline(&text, &capacity, in) >= 0) {
        line++;
        status = add(args, l, name, line, without_mark(text, line));
    }
    if (!status && ferror(in)) {
        cli_error("%.200s: cannot be read: %s", name, strerror(errno));
        status = NOC_ERR_IO;
    }
    if (!status && !l->count) {
        cli_error("%.200s: there are no points in it", name);
        status = NOC_ERR_FORMAT;
    }
    free(text);
    if (!piped)
        fclose(in);
    return status;
}

/* To the scene's frame. */
static noc_status take_in(measure_job *job, point_list *l) {
    bool none = !job->args->crs && !*job->site.info.given_crs;
    l->said = cli_alloc(3 * l->count * sizeof(*l->said));
    memcpy(l->said, l->xyz, 3 * l->count * sizeof(*l->said));
    noc_status status = none ? NOC_OK : noc_scene_to_local_all(job->site.scene, job->args->crs, l->xyz, l->count);
    for (size_t i = 0; i < l->count && !status; i++) {
        memcpy(l->meters[i].place, l->xyz + 3 * i, sizeof(l->meters[i].place));
        for (int k = 0; k < 3; k++)
            if (!status && !(fabs(l->xyz[3 * i + (size_t)k]) < 1e6)) {
                cli_error("%.200s: %.10g %.10g %.10g lies more than 1000 km away from the scene, in %.60s",
                          job->args->points, l->said[3 * i], l->said[3 * i + 1], l->said[3 * i + 2],
                          job->args->crs              ? job->args->crs
                          : *job->site.info.given_crs ? job->site.info.given_crs
                                                      : "local metres");
                status = NOC_ERR_ARGUMENT;
            }
    }
    return status;
}

/* Why a point is dark, as a quoted field of CSV; nothing where it has light or lies in the open. Some light of the sky
 * leaks below the ground at its border: less than any place in the open has. */
static noc_status write_note(measure_job *job, FILE *out, const noc_meter *meter, double lux) {
    char text[160] = "";
    noc_status status =
        lux > 0 ? NOC_OK : noc_view_buried(job->site.view, job->site.scene, meter->place, text, sizeof(text));
    fputs(*text ? ",\"" : ",", out);
    for (const char *p = text; *p; p++)
        fprintf(out, *p == '"' ? "\"\"" : "%c", *p);
    fputs(*text ? "\"\n" : "\n", out);
    return status;
}

static noc_status write_readings(measure_job *job, const point_list *l, const noc_reading *readings) {
    const char *output = job->args->render.output;
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        cli_no_memory();
    fputs("x,y,z,nx,ny,nz,lux,error,samples,note\n", out);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < l->count && !status; i++) {
        const double *p = l->said + 3 * i, *n = l->meters[i].normal;
        fprintf(out, "%.10g,%.10g,%.10g,%.6g,%.6g,%.6g,%.6g,%.3g,%u", p[0], p[1], p[2], n[0], n[1], n[2],
                readings[i].lux, readings[i].error, readings[i].samples);
        status = write_note(job, out, &l->meters[i], readings[i].lux);
    }
    if (fclose(out))
        cli_no_memory();
    if (status) {
        free(text);
        return status;
    }
    if (output && strcmp(output, "-") != 0)
        status = noc_text_save(output, text, size, job->site.log);
    else
        fputs(text, stdout); /* which is looked at in the end */
    free(text);
    return status;
}

void measure_free_points(point_list *l) {
    free(l->meters);
    free(l->xyz);
    free(l->said);
}

noc_status measure_points(measure_job *job, point_list *l) {
    noc_reading *readings = NULL;
    noc_status status = take_in(job, l);
    if (!status) {
        readings = cli_alloc(l->count * sizeof(*readings));
        status = noc_measure_points(job->site.view, l->meters, l->count, &job->params, &job->progress, readings, NULL);
        cli_progress_clear();
    }
    status = status ? status : write_readings(job, l, readings);
    free(readings);
    return status;
}
