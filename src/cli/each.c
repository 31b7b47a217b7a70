/* build --each: a built city a tile. A tile is loaded with those around it, and what is its own is saved, so that a
 * tile is the same file whoever builds it. Files that are there and were made of the same are left; who finds all of
 * them there writes the index. */
#include "each.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define AROUND 3 /* halos: tiles within so much may be nearer to a place of the halo than the tile */

/* Tiles around one, in the order of all. */
typedef struct around {
    size_t *of; /* numbers of inputs */
    size_t count;
} around;

static bool meets(const each_input *a, const each_input *b, double m) {
    return a->extent[0] - m <= b->extent[2] && b->extent[0] <= a->extent[2] + m && a->extent[1] - m <= b->extent[3] &&
           b->extent[1] <= a->extent[3] + m;
}

static int by_west(const void *x, const void *y) {
    const each_input *a = *(const each_input *const *)x, *b = *(const each_input *const *)y;
    return a->extent[0] < b->extent[0] ? -1 : a->extent[0] > b->extent[0] ? 1 : a < b ? -1 : a > b;
}

static int by_number(const void *x, const void *y) {
    size_t a = *(const size_t *)x, b = *(const size_t *)y;
    return a < b ? -1 : a > b;
}

/* Good tiles from west to east; free() it. */
static const each_input **sort_west(const each_build *b, size_t *count) {
    const each_input **list = cli_alloc((b->tiles + 1) * sizeof(*list));
    *count = 0;
    for (size_t i = 0; i < b->tiles; i++)
        if (!b->inputs[i].broken)
            list[(*count)++] = &b->inputs[i];
    qsort(list, *count, sizeof(*list), by_west);
    return list;
}

/* Of those from west to east that begin not farther west than a tile is wide. */
static around find_around(const each_build *b, const each_input **west, size_t count, const each_input *in, double m) {
    around a = { NULL, 0 };
    size_t low = 0, high = count, end;
    double from = in->extent[0] - m - b->widest;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (west[middle]->extent[0] < from)
            low = middle + 1;
        else
            high = middle;
    }
    for (end = low; end < count && west[end]->extent[0] <= in->extent[2] + m;)
        end++;
    a.of = cli_alloc((end - low + 1) * sizeof(*a.of));
    for (size_t i = low; i < end; i++)
        if (meets(in, west[i], m))
            a.of[a.count++] = (size_t)(west[i] - b->inputs);
    qsort(a.of, a.count, sizeof(*a.of), by_number);
    return a;
}

/* All that the file depends on. */
static void make_key(const each_build *b, const each_input *in, const around *near, const around *far, char key[65]) {
    uint64_t sum[2];
    for (int i = 0; i < 2; i++) {
        uint64_t s = cli_sum(b->options, &i, sizeof(i));
        s = each_sum_text(s, in->name);
        for (size_t k = 0; k < near->count; k++) {
            s = each_sum_text(s, b->inputs[near->of[k]].name);
            s = cli_sum(s, &b->inputs[near->of[k]].sum, sizeof(uint64_t));
        }
        for (size_t k = 0; k < far->count; k++)
            s = cli_sum(s, b->inputs[far->of[k]].extent, sizeof(in->extent));
        for (size_t k = b->tiles; k < b->count; k++)
            s = cli_sum(s, &b->inputs[k].sum, sizeof(uint64_t));
        sum[i] = each_sum_text(s, b->place.crs);
    }
    snprintf(key, 65, "%016llx%016llx", (unsigned long long)sum[0], (unsigned long long)sum[1]);
}

static char *file_of(const each_build *b, const each_input *in) {
    return cli_format("%s/%s.noct", b->folder, in->name);
}

static bool is_done(const each_build *b, const each_input *in, const char *key, noc_tile_info *info) {
    char *path = file_of(b, in);
    bool done = !noc_built_get_tile(path, NULL, info) && !strcmp(info->key, key);
    free(path);
    return done;
}

/* ---- one tile ---- */

static noc_status save(const each_build *b, const each_input *in, const noc_scene *scene, const noc_report *report,
                       const around *near, const around *far, const char *key) {
    const char **paths = cli_alloc((far->count + 1) * sizeof(*paths));
    double(*extents)[4] = cli_alloc((far->count + 1) * sizeof(*extents));
    noc_tile tile = { .paths = paths, .extents = (const double(*)[4])extents, .count = far->count, .key = key };
    for (size_t i = 0; i < far->count; i++) {
        const each_input *of = &b->inputs[far->of[i]];
        bool loaded = bsearch(&far->of[i], near->of, near->count, sizeof(*near->of), by_number) != NULL;
        paths[i] = loaded ? of->path : NULL;
        memcpy(extents[i], of->extent, sizeof(of->extent));
        tile.own = of == in ? i : tile.own;
    }
    char *path = file_of(b, in);
    noc_status status =
        noc_scene_save(scene, path, &(noc_save_params){ report, b->recipe, { cli_goes_on, NULL }, &tile });
    free(path);
    free(extents);
    free(paths);
    return status;
}

static noc_status build_tile(const each_build *b, const each_input *in, const around *near, const around *far,
                             const char *key) {
    noc_import_params params = *b->import;
    size_t commons = b->count - b->tiles;
    const char **paths = cli_alloc((near->count + commons + 1) * sizeof(*paths));
    for (size_t i = 0; i < near->count; i++)
        paths[i] = b->inputs[near->of[i]].path;
    for (size_t i = 0; i < commons; i++)
        paths[near->count + i] = b->inputs[b->tiles + i].path;
    char *box = cli_format("%.17g,%.17g,%.17g,%.17g", in->extent[0] - b->halo - .001, in->extent[1] - b->halo - .001,
                           in->extent[2] + b->halo + .001, in->extent[3] + b->halo + .001);
    params.bbox = box;
    params.scene_crs = b->place.crs;
    params.progress = (noc_progress){ cli_goes_on, NULL };
    noc_report *report = NULL;
    noc_scene *scene = noc_scene_create(b->log);
    noc_status status = scene ? noc_scene_load(scene, paths, near->count + commons, &params, &report) : NOC_ERR_MEMORY;
    status = status ? status : save(b, in, scene, report, near, far, key);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    free(box);
    free(paths);
    return status;
}

typedef struct tally {
    size_t built, there, failed, missing;
} tally;

static void run_tile(const each_build *b, const each_input **west, size_t count, size_t i, bool build, tally *t,
                     noc_tile_entry *entry) {
    const each_input *in = &b->inputs[i];
    around near = find_around(b, west, count, in, b->halo), far = find_around(b, west, count, in, AROUND * b->halo + 1);
    char key[65];
    make_key(b, in, &near, &far, key);
    bool done = is_done(b, in, key, &entry->info);
    t->there += done && build;
    if (!done && build && !cli_interrupted()) {
        bool failed = build_tile(b, in, &near, &far, key) != NOC_OK;
        if (failed && !cli_interrupted())
            cli_error("%.200s: no tile was built of it", in->path);
        t->failed += failed;
        t->built += !failed;
        done = !failed;
    }
    t->missing += !done && !build;
    free(near.of);
    free(far.of);
}

/* ---- all ---- */

static int write_index(const each_build *b, const noc_tile_entry *entries, size_t count) {
    return noc_tiles_write(b->folder, b->place.crs, entries, count, b->log) ? CLI_FAILURE : CLI_OK;
}

/* Whoever finds all tiles there. */
static int finish(const each_build *b, const each_input **west, size_t count) {
    noc_tile_entry *entries = cli_alloc((count + 1) * sizeof(*entries));
    tally t = { 0 };
    size_t n = 0;
    for (size_t i = 0; i < b->tiles; i++) {
        if (b->inputs[i].broken)
            continue;
        run_tile(b, west, count, i, false, &t, &entries[n]);
        char *path = file_of(b, &b->inputs[i]);
        struct stat st;
        entries[n].bytes = stat(path, &st) ? 0 : (unsigned long long)st.st_size;
        entries[n++].location = cli_format("%s.noct", b->inputs[i].name);
        free(path);
    }
    int status = t.missing ? CLI_OK : write_index(b, entries, n);
    if (!b->args->quiet && t.missing)
        cli_error("%zu of %zu tiles are not there yet: who ends last writes the index, and so does this command again",
                  t.missing, n);
    else if (!b->args->quiet && !status)
        printf("%s\n  tiles     %zu in index.geojson\n", b->folder, n);
    for (size_t i = 0; i < n; i++)
        free((char *)entries[i].location);
    free(entries);
    return status;
}

int each_run(each_build *b) {
    size_t count, broken = 0;
    const each_input **west = sort_west(b, &count);
    tally t = { 0 };
    for (size_t i = 0; i < b->tiles && !cli_interrupted(); i++) {
        noc_tile_entry entry;
        bool own = i % (size_t)b->part.count == (size_t)(b->part.number - 1);
        broken += b->inputs[i].broken;
        if (!own || b->inputs[i].broken)
            continue;
        if (!b->args->quiet)
            cli_progress_show((double)i / (double)b->tiles, -1, "building tiles");
        run_tile(b, west, count, i, true, &t, &entry);
    }
    cli_progress_clear();
    int status = t.failed || broken ? CLI_FAILURE : CLI_OK;
    if (!b->args->quiet)
        printf("built %zu tiles; %zu were there; %zu failed\n", t.built, t.there, t.failed + broken);
    if (cli_interrupted()) {
        cli_error("interrupted: the same command builds the tiles that are missing");
        status = CLI_INTERRUPTED + cli_interrupted();
    } else if (!t.failed) {
        int joined = finish(b, west, count);
        status = status ? status : joined;
    }
    free(west);
    return status;
}
