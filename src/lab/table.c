/* results.csv: one row a configuration, camera, repetition, frame and mode, appended as they come. Its key column tells
 * which settings a row belongs to, so an experiment goes on where it stopped and never mixes in rows of other settings.
 */
#include "lab/table.h"
#include "lab/file.h"

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#define TELLING "scene,camera,configuration,repetition,mode,frame,seed,backend,device,reference"
static const char *const columns[COL_COUNT + 1] = {
    [COL_WALL] = "wall_s",
    [COL_CPU] = "cpu_s",
    [COL_WALL_TOTAL] = "wall_total_s",
    [COL_CPU_TOTAL] = "cpu_total_s",
    [COL_RMSE8] = "rmse8",
    [COL_RELMSE] = "relmse",
    [COL_CLAMPED] = "relmse_clamped",
    [COL_BIAS] = "bias",
    [COL_UNLIT] = "unlit",
    [COL_RELMSE_UNLIT] = "relmse_unlit",
    [COL_RMSE8_ALL] = "rmse8_all",
    [COL_RELMSE_ALL] = "relmse_all",
    [COL_CLAMPED_ALL] = "relmse_clamped_all",
    [COL_BIAS_ALL] = "bias_all",
    [COL_UNLIT_ALL] = "unlit_all",
    [COL_RELMSE_UNLIT_ALL] = "relmse_unlit_all",
    [COL_BUILD] = "build_s",
    [COL_MEMORY] = "memory_bytes",
    [COL_RAYS] = "rays_shadow",
    [COL_DROPPED] = "dropped",
    [COL_LIGHT_BUILD] = "light_build_s",
    [COL_VOLUMES] = "light_volumes_s",
    [COL_TUNING] = "light_tuning_s",
    [COL_HIERARCHY] = "light_hierarchy_s",
    [COL_BOXES] = "light_boxes_s",
    [COL_LIGHT_BYTES] = "light_bytes",
    [COL_SCENE_BYTES] = "scene_bytes",
    [COL_INFLUENCE] = "influence",
    [COL_FOUND_NONE] = "found_none",
    [COL_FOUND_MEDIAN] = "found_median",
    [COL_FOUND_99] = "found_99",
};

const char *const *noc_lab_columns(void) { return columns; }

static void print_header(char text[1024]) {
    int n = noc_snprintf(text, 1024, "%s", TELLING);
    for (int i = 0; i < COL_COUNT; i++)
        n += noc_snprintf(text + n, 1024 - (size_t)n, ",%s", columns[i]);
    noc_snprintf(text + n, 1024 - (size_t)n, ",key");
}

static const char *const modes[] = { "alone", "accumulated" };
enum { FIRST = 10, FIELDS = FIRST + COL_COUNT + 1, MODE = 4, FRAME = 5, REFERENCE = 9 };

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
    char *fields[FIELDS];
    if (!split(line, fields))
        return false;
    const char *key = fields[FIELDS - 1]; /* becomes a picture's name */
    if (strlen(key) != LAB_KEY - 1 || strspn(key, "0123456789abcdef") != LAB_KEY - 1)
        return false;
    memcpy(row->key, key, LAB_KEY);
    row->mode = strcmp(fields[MODE], modes[LAB_ACCUMULATED]) ? LAB_ALONE : LAB_ACCUMULATED;
    row->reference = lab_backend_of(fields[REFERENCE]);
    row->claimed = false;
    for (int i = 0; i < COL_COUNT; i++)
        if (!lab_parse_number(fields[FIRST + i], &row->values[i]))
            return false;
    long long frame;
    bool right = noc_parse_int(fields[FRAME], &frame) && frame > 0 && frame <= LAB_FRAMES;
    row->frame = right ? (int)frame : 0;
    return right;
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
    const lab_spec *spec = lab->spec;
    quote(out, spec->scenes[spec->cameras[run->camera].scene].name);
    quote(out, spec->cameras[run->camera].name);
    quote(out, spec->configs[run->config].name);
    noc_fprintf(out, "%d,%s,%d,%u,", run->repetition + 1, modes[mode], frame, lab_params_of(lab, run).seed);
    quote(out, noc_backend_name(lab->device.backend));
    quote(out, lab->device.name);
    const lab_row *row = &run->rows[mode][frame - 1];
    quote(out, noc_backend_name(row->reference));
    for (int i = 0; i < COL_COUNT; i++)
        noc_fprintf(out, "%.9g,", row->values[i]);
    noc_fprintf(out, "%s\n", run->key);
}

/* Is the file's first line our header, whole, or cut where the program was killed? */
static bool is_header(const char *line, size_t n) {
    char header[1024];
    print_header(header);
    size_t whole = strlen(header);
    return n <= whole ? !memcmp(line, header, n)
                      : n == whole + 1 && !memcmp(line, header, whole) && line[whole] == '\n';
}

/* Takes one line without its end. */
static noc_status read_row(lab_session *lab, char *line) {
    lab_stored row;
    if (!parse_row(line, &row))
        lab->rows_broken++;
    else if (!array_push(&lab->stored, row))
        return noc_no_memory(lab->log, "results.csv");
    return NOC_OK;
}

noc_status lab_read_table(lab_session *lab, const char *path, long *whole) {
    struct stat st;
    *whole = 0;
    if (stat(path, &st) && errno == ENOENT)
        return NOC_OK;
    FILE *file = lab_open_file(path, lab->log);
    if (!file)
        return NOC_ERR_IO;
    char *line = NULL;
    size_t size = 0;
    bool first = true;
    noc_status status = NOC_OK;
    for (ssize_t n; !status && (n = getline(&line, &size, file)) > 0; *whole += n) {
        if (first && !is_header(line, (size_t)n)) {
            *whole = -1;
            break;
        }
        if (line[n - 1] != '\n')
            break;
        line[n - 1] = 0;
        status = first ? NOC_OK : read_row(lab, line);
        first = false;
    }
    if (!status && *whole >= 0 && !feof(file)) /* what is not read must not be cut off */
        status = lab_io_error(lab->log, path);
    free(line);
    fclose(file);
    return status;
}

noc_status lab_open_rows(lab_session *lab, const char *path, long whole) {
    char header[1024];
    print_header(header);
    lab->csv = fopen(path, whole ? "r+" : "w");
    bool ok = lab->csv != NULL;
    if (ok && whole) /* a line that was cut short when the program was killed */
        ok = !ftruncate(fileno(lab->csv), whole) && !fseek(lab->csv, 0, SEEK_END);
    else if (ok)
        ok = noc_fprintf(lab->csv, "%s\n", header) > 0 && !fflush(lab->csv);
    return ok ? NOC_OK : lab_io_error(lab->log, path);
}

/* A name that no table has that was put aside before: results.old.csv, results.old-2.csv, ... The folder is locked.
 * NULL after reporting that memory was refused. */
char *lab_old_name(const lab_session *lab) {
    struct stat st;
    char *name = noc_format("%s/results.old.csv", lab->folder);
    for (int i = 2; name && !lstat(name, &st); i++) {
        free(name);
        name = noc_format("%s/results.old-%d.csv", lab->folder, i);
    }
    if (!name)
        noc_no_memory(lab->log, "results.csv");
    return name;
}

/* replaced: another file is about to take its name, which it keeps until then, so that a kill in between loses nothing.
 */
static noc_status put_aside(const lab_session *lab, const char *path, const char *old, bool replaced) {
    bool linked = replaced && !link(path, old); /* not every file system can */
    return linked || !rename(path, old) ? NOC_OK : lab_io_error(lab->log, path);
}

/* Another program's file of that name. */
static noc_status keep_strange(const lab_session *lab, const char *path) {
    char *old = lab_old_name(lab);
    if (!old)
        return NOC_ERR_MEMORY;
    noc_warn(lab->log, "%s is a table of another kind or version; it is kept as %s", path, strrchr(old, '/') + 1);
    noc_status status = put_aside(lab, path, old, false);
    free(old);
    return status;
}

noc_status lab_open_table(lab_session *lab) {
    char *path = noc_format("%s/results.csv", lab->folder);
    long whole = 0;
    noc_status status = path ? lab_read_table(lab, path, &whole) : noc_no_memory(lab->log, "results.csv");
    if (!status && whole < 0) {
        status = keep_strange(lab, path);
        whole = 0;
    }
    status = status ? status : lab_open_rows(lab, path, whole);
    free(path);
    return status;
}

noc_status lab_claim(lab_session *lab, lab_run *run) {
    for (size_t i = 0; i < lab->stored.len; i++) {
        lab_stored *row = &lab->stored.data[i];
        if (row->claimed || strcmp(row->key, run->key))
            continue;
        row->claimed = true;
        if (!lab_has_mode(lab->spec, run->camera, row->mode) ||
            row->frame > lab_frames(lab->spec, run->camera, run->config))
            continue; /* asked for before, not now: it stays in the table */
        lab_row *mine = lab_row_of(lab, run, row->mode, row->frame);
        if (!mine)
            return NOC_ERR_MEMORY;
        lab->rows_twice += mine->done;
        lab->rows_done += !mine->done;
        lab->rows_old += !mine->done;
        mine->done = true;
        mine->reference = row->reference;
        memcpy(mine->values, row->values, sizeof(mine->values));
    }
    return NOC_OK;
}

static noc_status table_error(const lab_session *lab) {
    return noc_error(lab->log, NOC_ERR_IO, "%s/results.csv: %s", lab->folder, strerror(errno));
}

noc_status lab_append(lab_session *lab, const lab_run *run, int mode, int frame) {
    print_row(lab, lab->csv, run, mode, frame);
    return fflush(lab->csv) ? table_error(lab) : NOC_OK;
}

static void tell_rows(const lab_session *lab, size_t count, const char *what, const char *old) {
    char rows[64];
    if (count)
        noc_warn(lab->log, "%s of results.csv %s: kept in %s", noc_text_many(rows, count, "row"), what,
                 strrchr(old, '/') + 1);
}

/* Pictures of rows that no run has any more go, and are counted. */
static noc_status drop_pictures(const lab_session *lab, size_t *others) {
    *others = 0;
    for (size_t i = 0; i < lab->stored.len; i++) {
        const lab_stored *row = &lab->stored.data[i];
        if (row->claimed)
            continue;
        char *picture = lab_picture_path(lab, row->key, row->mode, row->frame);
        if (!picture)
            return NOC_ERR_MEMORY;
        unlink(picture); /* where there is one; no row shows it any more */
        free(picture);
        ++*others;
    }
    return NOC_OK;
}

static void print_all(const lab_session *lab, FILE *out) {
    char header[1024];
    print_header(header);
    noc_fprintf(out, "%s\n", header);
    for (size_t r = 0; r < lab->run_count; r++)
        for (int frame = 1; frame <= lab->runs[r].count; frame++)
            for (int mode = 0; mode < LAB_MODES; mode++)
                if (lab->runs[r].rows[mode][frame - 1].done)
                    print_row(lab, out, &lab->runs[r], mode, frame);
}

/* From here on rows go to the new file. */
static noc_status turn_to(lab_session *lab, const char *path) {
    lab->stored.len = lab->rows_broken = lab->rows_twice = 0;
    fclose(lab->csv); /* each row was flushed */
    lab->csv = fopen(path, "a");
    return lab->csv ? NOC_OK : lab_io_error(lab->log, path);
}

noc_status lab_tidy_table(lab_session *lab, bool *left_out) {
    size_t others;
    noc_status status = drop_pictures(lab, &others);
    bool lost = others || lab->rows_broken || lab->rows_twice;
    *left_out = others || lab->rows_broken;
    if (status || (!lost && !lab->taken.len))
        return status;
    char *path = noc_format("%s/results.csv", lab->folder), *old = path ? lab_old_name(lab) : NULL;
    output file;
    status = !path ? noc_no_memory(lab->log, "results.csv")
             : old ? lab_create_file(lab->folder, "results.csv", lab->log, &file)
                   : NOC_ERR_MEMORY;
    if (!status) {
        tell_rows(lab, others, "came from other settings", old);
        tell_rows(lab, lab->rows_broken, "could not be read", old);
        tell_rows(lab, lab->rows_twice, "stood there twice", old);
        print_all(lab, file.file);
        /* what could not be written, finishing tells */
        status = fflush(file.file) ? NOC_OK : lost ? put_aside(lab, path, old, true) : NOC_OK;
        status = output_close(&file, status, lab->log);
        status = status ? status : turn_to(lab, path);
    }
    free(path);
    free(old);
    return status;
}
