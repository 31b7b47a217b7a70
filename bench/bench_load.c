/* Loading in numbers: processor time and peak memory of the program and of its helper, from files to a picture.
 *
 *   bench_load [--rounds N] [--threads N] [--no-textures] INPUT[,INPUT...] ...
 *
 * Each argument is a scene, loaded by a process of its own, N times (3), in turn with the others; the least times are
 * told. Load is noc_scene_load up to the commit: the program's processor seconds and those of nocturne-reader, which
 * reads OBJ and maps; MB/s are the bytes read over both, after decompression. Reading is the sum over the files, from
 * their first bytes to the last object in the scene. Structure is the ray tracing structure,
 * by a frame without lights; lights is the first frame of the default method after that, 64 x 36. Peaks are resident
 * memory, of the program with the picture.
 *
 * NOCTURNE_READER names the program nocturne-reader. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_SCENES = 32 };

typedef struct result {
    double load, helper, wall, reading, picture, structure, lights; /* s; wall, reading, picture: by the clock */
    double peak, helper_peak;                                       /* MB */
    double bytes;
    size_t triangles;
} result;

static double seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double cpu(void) { return seconds(CLOCK_PROCESS_CPUTIME_ID); }

static double used(const struct timeval *t) { return (double)t->tv_sec + 1e-6 * (double)t->tv_usec; }

static bool draw(noc_scene *scene, noc_method method, noc_log *log, noc_view **view) {
    noc_render_params p = noc_render_default_params();
    noc_camera camera;
    p.method = method;
    p.width = 64;
    p.height = 36;
    if (!*view)
        *view = own_view(scene, 0, log);
    return *view && noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, 16.0 / 9, &camera) == NOC_OK &&
           noc_view_render(*view, &camera, &p, NULL) == NOC_OK;
}

static bool measure(const char *spec, const noc_import_params *params, result *r) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = bench_tell });
    noc_scene *scene = noc_scene_create(log);
    noc_report *report = NULL;
    noc_view *view = NULL;
    const char *paths[16];
    size_t count = 0;
    char *copy = strdup(spec);
    for (char *rest = copy, *path; copy && count < 16 && (path = strtok_r(rest, ",", &rest));)
        paths[count++] = path;
    double start = cpu(), wall = seconds(CLOCK_MONOTONIC);
    if (noc_scene_load(scene, paths, count, params, &report) != NOC_OK)
        return false;
    r->load = cpu() - start;
    r->wall = seconds(CLOCK_MONOTONIC) - wall;
    start = cpu();
    if (!draw(scene, NOC_METHOD_HEADLIGHT, log, &view))
        return false;
    r->structure = cpu() - start;
    start = cpu();
    if (!draw(scene, noc_render_default_params().method, log, &view))
        return false;
    r->lights = cpu() - start;
    r->picture = seconds(CLOCK_MONOTONIC) - wall;
    struct rusage own, helper;
    getrusage(RUSAGE_SELF, &own);
    getrusage(RUSAGE_CHILDREN, &helper);
    noc_report_totals totals;
    noc_scene_info info;
    noc_report_get_totals(report, &totals);
    r->reading = 0;
    for (size_t i = 0; i < noc_report_file_count(report); i++)
        r->reading += noc_report_get_file(report, i)->seconds;
    noc_scene_get_info(scene, &info);
    r->helper = used(&helper.ru_utime) + used(&helper.ru_stime);
    r->peak = 1e-3 * (double)own.ru_maxrss;
    r->helper_peak = 1e-3 * (double)helper.ru_maxrss;
    r->bytes = (double)totals.bytes_read;
    r->triangles = info.triangles + info.instance_triangles;
    free(copy);
    close_view(view);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return true;
}

static void keep_least(double *least, double x, bool first) { *least = first || x < *least ? x : *least; }

/* In a process of its own, whose result comes back through shared memory. */
static bool apart(const char *spec, const noc_import_params *params, result *shared, result *least, bool first) {
    fflush(stdout);
    pid_t child = fork();
    if (!child)
        _exit(measure(spec, params, shared) ? 0 : 1);
    int status = 1;
    if (child < 0 || waitpid(child, &status, 0) != child || status) {
        fprintf(stderr, "bench_load: %s could not be measured\n", spec);
        return false;
    }
    double *to = &least->load;
    const double *from = &shared->load;
    for (size_t i = 0; i < offsetof(result, bytes) / sizeof(double); i++)
        keep_least(to + i, from[i], first);
    least->bytes = shared->bytes;
    least->triangles = shared->triangles;
    return true;
}

int main(int argc, char **argv) {
    noc_import_params params = noc_import_default_params();
    const char *specs[MOST_SCENES];
    int count = 0, rounds = 3;
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--no-textures"))
            params.textures = false;
        else if (!strcmp(argv[i], "--rounds") && i + 1 < argc)
            rounds = atoi(argv[++i]);
        else if (!strcmp(argv[i], "--threads") && i + 1 < argc)
            params.threads = atoi(argv[++i]);
        else if (count < MOST_SCENES)
            specs[count++] = argv[i];
    }
    if (!count || rounds < 1) {
        fprintf(
            stderr,
            "usage: bench_load [--rounds N] [--threads N] [--no-textures] INPUT[,INPUT...] [INPUT[,INPUT...] ...]\n");
        return 2;
    }
    static result least[MOST_SCENES];
    result *shared = mmap(NULL, sizeof(*shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bool ok = shared != MAP_FAILED;
    for (int round = 0; round < rounds && ok; round++)
        for (int i = 0; i < count && ok; i++)
            ok = apart(specs[i], &params, shared, &least[i], round == 0);
    if (!ok)
        return 1;
    printf(
        "| scene | MB | triangles | load CPU s, helper | MB/s | load, of that reading, first picture, s by the clock | "
        "structure, lights CPU s | peak MB, helper |\n|---|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < count; i++) {
        const result *r = &least[i];
        const char *slash = strrchr(specs[i], '/');
        printf("| %s | %.1f | %zu | %.2f, %.2f | %.0f | %.2f, %.2f, %.2f | %.2f, %.2f | %.0f, %.0f |\n",
               slash ? slash + 1 : specs[i], 1e-6 * r->bytes, r->triangles, r->load, r->helper,
               1e-6 * r->bytes / (r->load + r->helper), r->wall, r->reading, r->picture, r->structure, r->lights,
               r->peak, r->helper_peak);
    }
    return 0;
}
