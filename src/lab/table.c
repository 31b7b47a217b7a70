/* results.csv: one row a configuration, camera, repetition, frame and mode, appended as they come. Its key column tells
 * which settings a row belongs to, so an experiment goes on where it stopped and never mixes in rows of other settings.
 */
#include "lab/lab.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char header[] =
    "scene,camera,configuration,repetition,mode,frame,seed,wall_s,cpu_s,wall_total_s,cpu_total_s,rmse8,relmse,"
    "relmse_clamped,bias,unlit,relmse_unlit,rmse8_all,relmse_all,relmse_clamped_all,bias_all,unlit_all,"
    "relmse_unlit_all,build_s,memory_bytes,rays_shadow,dropped,"
    "light_build_s,light_volumes_s,light_tuning_s,light_hierarchy_s,light_boxes_s,light_bytes,scene_bytes,influence,"
    "found_none,found_median,found_99,key";
static const char *const modes[] = { "alone", "accumulated" };
enum { TELLING = 7, FIELDS = TELLING + COL_COUNT + 1, MODE = 4, FRAME = 5 };

/* Splits a line in place; a field in quotes may hold commas and doubled quotes. false: not this many fields. */
static bool split(char *line, char *fields[FIELDS]) {
    char *c = line;
    for (int i = 0; i < FIELDS; i++) {
        bool quoted = *c == '"';
        char *out = fields[i] = c += quoted;
        for (; quoted ? *c && !(*c == '"' && c[1] != '"') : *c && *c != ','; c++) {
            c += quoted && *c == '"';
            *out++ = *c;
        }
        if (quoted && *c++ != '"')
            return false;
        char end = *c;
        *out = 0;
        if (end != (i + 1 < FIELDS ? ',' : 0))
            return false;
        c++;
    }
    return true;
}

static bool parse_row(char *line, lab_stored *row) {
    char *fields[FIELDS], *end;
    if (!split(line, fields))
        return false;
    const char *key = fields[FIELDS - 1]; /* becomes a picture's name */
    if (strlen(key) != LAB_KEY - 1 || strspn(key, "0123456789abcdef") != LAB_KEY - 1)
        return false;
    memcpy(row->key, key, LAB_KEY);
    row->mode = strcmp(fields[MODE], modes[LAB_ACCUMULATED]) ? LAB_ALONE : LAB_ACCUMULATED;
    row->frame = atoi(fields[FRAME]);
    row->claimed = false;
    for (int i = 0; i < COL_COUNT; i++) {
        row->values[i] = strtod(fields[TELLING + i], &end);
        if (*end || end == fields[TELLING + i])
            return false;
    }
    return row->frame > 0 && row->frame <= LAB_FRAMES;
}

/* Spreadsheets run what begins like a formula: an apostrophe before it makes it text to them. */
static void quote(FILE *out, const char *text) {
    bool plain = !strpbrk(text, ",\"");
    if (!plain)
        fputc('"', out);
    if (strchr("=+-@", *text))
        fputc('\'', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"')
            fputc('"', out);
        fputc(*c, out);
    }
    fputs(plain ? "," : "\",", out);
}

static void print_row(const lab_session *lab, FILE *out, const lab_run *run, int mode, int frame) {
    const lab_spec *spec = &lab->spec;
    quote(out, spec->scenes[spec->cameras[run->camera].scene].name);
    quote(out, spec->cameras[run->camera].name);
    quote(out, spec->configs[run->config].name);
    fprintf(out, "%d,%s,%d,%u,", run->repetition + 1, modes[mode], frame, lab_params(lab, run).seed);
    for (int i = 0; i < COL_COUNT; i++)
        fprintf(out, "%.9g,", run->rows[mode][frame - 1].values[i]);
    fprintf(out, "%s\n", run->key);
}

/* Is the file's first line our header, whole, or cut where the program was killed? */
static bool is_header(const char *line, size_t n) {
    size_t whole = sizeof(header) - 1;
    return n <= whole ? !memcmp(line, header, n)
                      : n == whole + 1 && !memcmp(line, header, whole) && line[whole] == '\n';
}

/* Reads what earlier sessions left. *whole: bytes up to the end of the last whole line; -1 where the file is no such
 * table. */
static int read_table(lab_session *lab, const char *path, long *whole) {
    struct stat st;
    *whole = 0;
    if (stat(path, &st) && errno == ENOENT)
        return CLI_OK;
    FILE *file = cli_open(path); /* a pipe is not waited for */
    if (!file)
        return CLI_FAILURE;
    char *line = NULL;
    size_t size = 0, room = 0;
    bool first = true;
    for (ssize_t n; (n = getline(&line, &size, file)) > 0; *whole += n) {
        if (first && !is_header(line, (size_t)n)) {
            *whole = -1;
            break;
        }
        if (line[n - 1] != '\n')
            break;
        line[n - 1] = 0;
        if (lab->stored_count == room) {
            room = room ? 2 * room : 256;
            lab->stored = lab_longer(lab->stored, room * sizeof(*lab->stored));
        }
        bool row = !first && parse_row(line, &lab->stored[lab->stored_count]);
        lab->stored_count += row;
        lab->rows_broken += !first && !row;
        first = false;
    }
    free(line);
    fclose(file);
    return CLI_OK;
}

static int open_for_rows(lab_session *lab, const char *path, long whole) {
    lab->csv = fopen(path, whole ? "r+" : "w");
    bool ok = lab->csv != NULL;
    if (ok && whole) /* a line that was cut short when the program was killed */
        ok = !ftruncate(fileno(lab->csv), whole) && !fseek(lab->csv, 0, SEEK_END);
    else if (ok)
        ok = fprintf(lab->csv, "%s\n", header) > 0 && !fflush(lab->csv);
    if (!ok)
        cli_error("%s: %s", path, strerror(errno));
    return ok ? CLI_OK : CLI_FAILURE;
}

/* A name that no table has that was put aside before: results.old.csv, results.old-2.csv, ... The folder is locked. */
static char *old_name(const lab_session *lab) {
    struct stat st;
    char *name = cli_format("%s/results.old.csv", lab->folder);
    for (int i = 2; !lstat(name, &st); i++) {
        free(name);
        name = cli_format("%s/results.old-%d.csv", lab->folder, i);
    }
    return name;
}

/* replaced: another file is about to take its name, which it keeps until then, so that a kill in between loses nothing.
 */
static int put_aside(const char *path, const char *old, bool replaced) {
    bool linked = replaced && !link(path, old); /* not every file system can */
    int status = linked || !rename(path, old) ? CLI_OK : CLI_FAILURE;
    if (status)
        cli_error("%s: %s", path, strerror(errno));
    return status;
}

int lab_open_table(lab_session *lab) {
    char *path = cli_format("%s/results.csv", lab->folder);
    long whole;
    int status = read_table(lab, path, &whole);
    if (!status && whole < 0) {
        char *old = old_name(lab);
        cli_error("warning: %s is a table of another kind; it is kept as %s", path, strrchr(old, '/') + 1);
        status = put_aside(path, old, false);
        free(old);
        whole = 0;
    }
    status = status ? status : open_for_rows(lab, path, whole);
    free(path);
    return status;
}

lab_row *lab_row_of(lab_run *run, int mode, int frame) {
    if (frame > run->room) {
        int room = frame > 2 * run->room ? frame : 2 * run->room;
        for (int m = 0; m < LAB_MODES; m++) {
            run->rows[m] = lab_longer(run->rows[m], sizeof(lab_row) * (size_t)room);
            memset(run->rows[m] + run->room, 0, sizeof(lab_row) * (size_t)(room - run->room));
        }
        run->room = room;
    }
    run->count = frame > run->count ? frame : run->count;
    return &run->rows[mode][frame - 1];
}

void lab_claim(lab_session *lab, lab_run *run) {
    for (size_t i = 0; i < lab->stored_count; i++) {
        lab_stored *row = &lab->stored[i];
        if (row->claimed || strcmp(row->key, run->key))
            continue;
        row->claimed = true;
        if (!lab_has_mode(&lab->spec, run->camera, row->mode) ||
            row->frame > lab_frames(&lab->spec, run->camera, run->config))
            continue; /* asked for before, not now: it stays in the table */
        lab_row *mine = lab_row_of(run, row->mode, row->frame);
        lab->rows_twice += mine->done;
        lab->rows_done += !mine->done;
        lab->rows_old += !mine->done;
        mine->done = true;
        memcpy(mine->values, row->values, sizeof(mine->values));
    }
}

int lab_append(lab_session *lab, const lab_run *run, int mode, int frame) {
    print_row(lab, lab->csv, run, mode, frame);
    if (!fflush(lab->csv))
        return CLI_OK;
    cli_error("%s/results.csv: %s", lab->folder, strerror(errno));
    return CLI_FAILURE;
}

static void tell_rows(size_t count, const char *what, const char *old) {
    char rows[64];
    if (count)
        cli_error("%s of results.csv %s: kept in %s", noc_text_many(rows, count, "row"), what, strrchr(old, '/') + 1);
}

int lab_tidy_table(lab_session *lab) {
    size_t others = 0;
    for (size_t i = 0; i < lab->stored_count; i++) {
        if (lab->stored[i].claimed)
            continue;
        others++;
        char *picture = lab_picture(lab, lab->stored[i].key, lab->stored[i].mode, lab->stored[i].frame);
        unlink(picture); /* where there is one; no row shows it any more */
        free(picture);
    }
    if (!others && !lab->rows_broken && !lab->rows_twice)
        return CLI_OK;
    char *temporary;
    FILE *file = lab_create(lab, "results.csv", &temporary);
    if (!file)
        return CLI_FAILURE;
    char *path = cli_format("%s/results.csv", lab->folder), *old = old_name(lab);
    tell_rows(others, "came from other settings", old);
    tell_rows(lab->rows_broken, "could not be read", old);
    tell_rows(lab->rows_twice, "stood there twice", old);
    fprintf(file, "%s\n", header);
    for (size_t r = 0; r < lab->run_count; r++)
        for (int frame = 1; frame <= lab->runs[r].count; frame++)
            for (int mode = 0; mode < LAB_MODES; mode++)
                if (lab->runs[r].rows[mode][frame - 1].done)
                    print_row(lab, file, &lab->runs[r], mode, frame);
    int status = fflush(file) ? CLI_OK : put_aside(path, old, true); /* what could not be written, finishing tells */
    free(path);
    free(old);
    if (status) {
        lab_discard(file, temporary);
        return status;
    }
    return lab_finish(lab, file, "results.csv", temporary);
}
