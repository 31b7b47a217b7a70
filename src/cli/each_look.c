/* What is known of inputs before they are built: which of them are tiles, where these lie, and a sum of each. */
#include "each.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define KNOWN ".known" /* folder of what was found, a file an input */

uint64_t each_sum_text(uint64_t sum, const char *text) {
    return text ? cli_sum(sum, text, strlen(text) + 1) : cli_sum(sum, "\1", 1);
}

static const char *last_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Without endings: "a.gml.gz" is a. */
static char *tile_name(const char *path) {
    static const char *const endings[] = { ".gz", ".zip", ".gml", ".xml", ".json", ".city", ".citygml" };
    const char *name = last_name(path);
    size_t n = strlen(name);
    for (size_t i = 0; i < sizeof(endings) / sizeof(*endings); i++) {
        size_t e = strlen(endings[i]);
        if (n > e && !strncmp(name + n - e, endings[i], e))
            n -= e;
    }
    return cli_format("%.*s", (int)n, name);
}

static bool sum_file(const char *path, uint64_t *sum) {
    static char buffer[1 << 16];
    FILE *in = fopen(path, "rb");
    *sum = 0;
    for (size_t n; in && (n = fread(buffer, 1, sizeof(buffer), in)) > 0;)
        *sum = cli_sum(*sum, buffer, n);
    bool ok = in && !ferror(in);
    if (in)
        fclose(in);
    return ok;
}

uint64_t each_sum_file(uint64_t sum, const char *path) {
    uint64_t of;
    return sum_file(path, &of) ? cli_sum(sum, &of, sizeof(of)) : sum;
}

/* ---- what was found before ---- */

/* Where it is kept; what must be the same for it to hold. */
static char *known_path(const each_build *b, const each_input *in, char *stamp, size_t size) {
    struct stat st;
    if (stat(in->path, &st))
        memset(&st, 0, sizeof(st));
    uint64_t of = each_sum_text(b->options, in->path);
    of = each_sum_text(of, b->place.crs);
    snprintf(stamp, size, "%016llx %llu %lld.%09ld", (unsigned long long)of, (unsigned long long)st.st_size,
             (long long)st.st_mtim.tv_sec, (long)st.st_mtim.tv_nsec);
    return cli_format("%s/" KNOWN "/%016llx", b->folder, (unsigned long long)each_sum_text(0, in->path));
}

/* tile: whether it is one. */
static bool read_known(const each_build *b, each_input *in, bool *tile) {
    char stamp[80], line[400] = "", kind[8] = "";
    char *path = known_path(b, in, stamp, sizeof(stamp));
    FILE *file = fopen(path, "r");
    size_t n = strlen(stamp);
    unsigned long long sum = 0;
    bool got = file && fgets(line, sizeof(line), file) && !strncmp(line, stamp, n) &&
               sscanf(line + n, " %7s %llx %lf %lf %lf %lf", kind, &sum, &in->extent[0], &in->extent[1], &in->extent[2],
                      &in->extent[3]) == 6;
    if (file)
        fclose(file);
    free(path);
    *tile = !strcmp(kind, "tile");
    in->sum = sum;
    return got;
}

/* It appears whole. One that cannot be written is found again. */
static void keep_known(const each_build *b, const each_input *in, bool tile) {
    char stamp[80];
    char *path = known_path(b, in, stamp, sizeof(stamp)), *making = cli_format("%s.%ld", path, (long)getpid());
    FILE *file = fopen(making, "w");
    if (file) {
        fprintf(file, "%s %s %llx %.17g %.17g %.17g %.17g\n", stamp, tile ? "tile" : "common",
                (unsigned long long)in->sum, in->extent[0], in->extent[1], in->extent[2], in->extent[3]);
        if (fclose(file) || rename(making, path))
            unlink(making);
    }
    free(making);
    free(path);
}

/* ---- looking ---- */

/* The part of "EPSG:25832 (ETRS89 / UTM zone 32N)" that is a definition; free() it. */
static char *definition(const char *crs) {
    const char *space = strchr(crs, ' '), *colon = strchr(crs, ':');
    bool code = space && colon && colon < space && space[1] == '(';
    return code ? cli_format("%.*s", (int)(space - crs), crs) : cli_format("%s", crs);
}

/* Where the file's extent lies in the CRS of all. */
static noc_status take_extent(const each_build *b, const noc_report_file *file, each_input *in) {
    enum { STEPS = 8 };
    double xyz[STEPS + 1][STEPS + 1][3];
    char *crs = definition(file->crs);
    bool same = !b->place.crs || !*crs || !strcmp(crs, b->place.crs);
    for (int i = 0; i <= STEPS; i++)
        for (int k = 0; k <= STEPS; k++) {
            xyz[i][k][0] = file->extent_min[0] + (file->extent_max[0] - file->extent_min[0]) * i / STEPS;
            xyz[i][k][1] = file->extent_min[1] + (file->extent_max[1] - file->extent_min[1]) * k / STEPS;
            xyz[i][k][2] = file->extent_min[2];
        }
    noc_status status =
        same ? NOC_OK : noc_scene_to_local_all(b->place.scene, crs, &xyz[0][0][0], (size_t)(STEPS + 1) * (STEPS + 1));
    free(crs);
    const double none[4] = { INFINITY, INFINITY, -INFINITY, -INFINITY };
    memcpy(in->extent, none, sizeof(none));
    for (int i = 0; i < (STEPS + 1) * (STEPS + 1) && !status; i++)
        for (int k = 0; k < 2; k++) {
            in->extent[k] = fmin(in->extent[k], (&xyz[0][0][0])[3 * i + k]);
            in->extent[2 + k] = fmax(in->extent[2 + k], (&xyz[0][0][0])[3 * i + k]);
        }
    return status;
}

static bool is_city(const noc_report_file *file) {
    return !strncmp(file->format, "CityGML", 7) || !strncmp(file->format, "CityJSON", 8);
}

/* Reads the file as far as that tells where it lies. */
static noc_status look(const each_build *b, each_input *in, bool *tile) {
    noc_import_params params = *b->import;
    noc_report *report = NULL;
    params.windows = NOC_SWITCH_OFF;
    params.strict = false;
    params.lamps = params.tracks = params.lamp_columns = (noc_texts){ 0 };
    params.progress = (noc_progress){ cli_goes_on, NULL };
    noc_status status = noc_inspect(b->log, in->path, &params, &report);
    const noc_report_file *file = noc_report_get_file(report, 0);
    *tile = !status && file && is_city(file);
    if (*tile && file->has_extent)
        status = take_extent(b, file, in);
    else if (*tile)
        *tile = false;
    if (!status && !sum_file(in->path, &in->sum)) {
        cli_error("%.200s: cannot be read: %s", in->path, strerror(errno));
        status = NOC_ERR_IO;
    }
    noc_report_destroy(report);
    return status;
}

/* The CRS that the first tile comes to, which all have. */
static int settle_place(each_build *b, const char *const *paths, size_t count) {
    noc_log *quiet = noc_log_create(NULL);
    bool placed = false;
    for (size_t i = 0; i < count && !placed && !cli_interrupted(); i++) {
        noc_import_params params = *b->import;
        noc_report *report = NULL;
        noc_scene *scene = noc_scene_create(quiet);
        noc_scene_info info;
        params.windows = params.infer_lamps = params.traffic = NOC_SWITCH_OFF;
        params.textures = params.strict = false;
        params.lamps = params.tracks = params.lamp_columns = (noc_texts){ 0 };
        params.environment = params.lamp_body = NULL;
        params.luminaire_count = params.group_count = params.group_states.count = params.named_material_count = 0;
        params.progress = (noc_progress){ cli_goes_on, NULL };
        if (scene && !noc_scene_load(scene, &paths[i], 1, &params, &report) &&
            is_city(noc_report_get_file(report, 0))) {
            noc_scene_get_info(scene, &info);
            const char *crs = *info.given_crs ? info.given_crs : info.crs;
            b->place.crs = *crs ? definition(crs) : NULL;
            placed = true;
        }
        noc_report_destroy(report);
        noc_scene_destroy(scene);
    }
    noc_log_destroy(quiet);
    if (cli_interrupted())
        return CLI_FAILURE;
    if (!placed) {
        cli_error("none of the %zu inputs is a city model that can be read", count);
        return CLI_FAILURE;
    }
    b->place.scene = noc_scene_create(b->log);
    if (!b->place.scene)
        cli_no_memory();
    return b->place.crs && noc_scene_set_crs(b->place.scene, b->place.crs, (double[3]){ 0 }) ? CLI_FAILURE : CLI_OK;
}

/* Tiles first, by name. */
static int by_name(const void *x, const void *y) {
    const each_input *a = x, *b = y;
    if (!a->name != !b->name)
        return a->name ? -1 : 1;
    return strcmp(a->name ? a->name : a->path, a->name ? b->name : b->path);
}

static int sort(each_build *b) {
    qsort(b->inputs, b->count, sizeof(*b->inputs), by_name);
    for (size_t i = 0; i < b->count && b->inputs[i].name; i++) {
        const each_input *in = &b->inputs[i];
        b->tiles = i + 1;
        b->widest = fmax(b->widest, in->broken ? 0 : in->extent[2] - in->extent[0]);
        if (i && !strcmp(in->name, b->inputs[i - 1].name)) {
            cli_error("%.200s and %.200s would both be %.100s.noct: build them into different folders",
                      b->inputs[i - 1].path, in->path, in->name);
            return CLI_FAILURE;
        }
    }
    return CLI_OK;
}

int each_look(each_build *b, const char *const *paths, size_t count) {
    char *known = cli_format("%s/" KNOWN, b->folder);
    mkdir(known, 0777);
    free(known);
    int status = settle_place(b, paths, count);
    if (status)
        return status;
    b->inputs = cli_alloc((count + 1) * sizeof(*b->inputs));
    b->count = count;
    size_t first = (size_t)(b->part.number - 1) * count / (size_t)b->part.count; /* each begins elsewhere */
    for (size_t k = 0; k < count; k++) {
        size_t i = (first + k) % count;
        each_input *in = &b->inputs[i];
        bool tile = false;
        in->path = paths[i];
        if (!b->args->quiet)
            cli_progress_show((double)k / (double)count, -1, "looking at %zu files", count);
        if (!read_known(b, in, &tile)) {
            if (look(b, in, &tile))
                in->broken = tile = true;
            else
                keep_known(b, in, tile);
        }
        if (cli_interrupted())
            return CLI_FAILURE;
        in->name = tile ? tile_name(in->path) : NULL;
    }
    cli_progress_clear();
    return sort(b);
}
