/* A built city against its inputs: seconds of noc_scene_load from either, and to the first picture.
 *
 *   bench_built [--rounds N] [--footprints] INPUT... [-- INPUT...]...     cities one behind another
 *
 * Least of the rounds, of wall and of processor time, in turn, so that both meet the same machine. read: the file's
 * bytes into memory, by one thread, which is what no load can be faster than; map: the same bytes mapped and summed. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "noct/noct.h"

#include <fcntl.h>
#include <nocturne/nocturne.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct spent {
    double wall, cpu;
} spent;

static spent now(void) { return (spent){ noc_wall_seconds(), noc_cpu_seconds() }; }

static void keep_least(spent *least, spent from) {
    spent to = now();
    least->wall = NOC_MIN(least->wall, to.wall - from.wall);
    least->cpu = NOC_MIN(least->cpu, to.cpu - from.cpu);
}

static bool footprints;

static noc_scene *load(const char *const *inputs, size_t count, noc_report **report, spent *least) {
    noc_scene *scene = noc_scene_create(bench_log());
    noc_import_params params = noc_import_default_params();
    params.footprints = footprints;
    spent from = now();
    if (noc_scene_load(scene, inputs, count, &params, report)) {
        noc_scene_destroy(scene);
        return NULL;
    }
    keep_least(least, from);
    return scene;
}

/* A small frame: what it takes beyond the load is the ray tracing structure, and those of the lights. */
static bool draw(const noc_scene *scene, spent *least) {
    noc_camera camera;
    noc_render_params params = noc_render_default_params();
    noc_camera_params place = noc_camera_default_params();
    params.width = 320;
    params.height = 180;
    spent from = now();
    if (noc_scene_place_camera(scene, &place, 16 / 9.0, &camera, NULL))
        return false;
    noc_view *view = own_view(scene, 0, bench_log());
    bool ok = view && !noc_view_render(view, &camera, &params, NULL);
    if (ok)
        keep_least(least, from);
    close_view(view);
    return ok;
}

static void touch(const char *path, spent *read_all, spent *map) {
    struct stat st;
    int fd = open(path, O_RDONLY);
    if (fd < 0 || fstat(fd, &st))
        return;
    size_t size = (size_t)st.st_size;
    spent from = now();
    void *bytes = noc_alloc_pages(size);
    for (size_t at = 0; bytes && at < size;) {
        ssize_t n = pread(fd, (char *)bytes + at, size - at, (off_t)at);
        if (n <= 0)
            break;
        at += (size_t)n;
    }
    keep_least(read_all, from);
    noc_free_pages(bytes, size);
    from = now();
    bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
    volatile uint64_t sum = bytes == MAP_FAILED ? 0 : noct_sum(bytes, size);
    (void)sum;
    keep_least(map, from);
    munmap(bytes, size);
    close(fd);
}

static bool bench(const char *const *inputs, size_t count, int rounds) {
    char path[] = "/tmp/bench-built-XXXXXX";
    const char *built[] = { path };
    spent files = { 1e9, 1e9 }, file = files, first = files, first_built = files, read_all = files, map = files;
    noc_scene_info info = { 0 };
    struct stat st = { 0 };
    close(mkstemp(path));
    bool ok = true;
    for (int i = 0; i < rounds && ok; i++) {
        noc_report *report = NULL;
        noc_scene *scene = load(inputs, count, &report, &files);
        ok = scene && (i || !noc_scene_save(scene, path, &(noc_save_params){ report, NULL }));
        ok = ok && draw(scene, &first);
        noc_scene_get_info(scene, &info);
        noc_report_destroy(report);
        noc_scene_destroy(scene);
        scene = ok ? load(built, 1, NULL, &file) : NULL;
        ok = scene && draw(scene, &first_built);
        noc_scene_destroy(scene);
        touch(path, &read_all, &map);
    }
    const char *slash = strrchr(inputs[0], '/');
    if (ok && !stat(path, &st))
        printf("%-32.32s %9zu %8.1f %9.1f %8.2f %7.1f %9.1f %8.2f %7.1f %6.2f %6.2f %7.2f %7.2f\n",
               slash ? slash + 1 : inputs[0], info.triangles, 1e-6 * (double)st.st_size, 1e3 * files.wall,
               1e3 * file.wall, files.wall / file.wall, 1e3 * files.cpu, 1e3 * file.cpu, files.cpu / file.cpu,
               1e3 * read_all.wall, 1e3 * map.wall, files.wall + first.wall, file.wall + first_built.wall);
    else
        printf("%s: failed\n", inputs[0]);
    fflush(stdout);
    unlink(path);
    return ok;
}

int main(int argc, char **argv) {
    int at = 1, rounds = 3;
    bool ok = true;
    if (argc > 2 && !strcmp(argv[1], "--rounds")) {
        rounds = atoi(argv[2]);
        at = 3;
    }
    if (at < argc && !strcmp(argv[at], "--footprints")) {
        footprints = true;
        at++;
    }
    printf("%-32s %9s %8s %9s %8s %7s %9s %8s %7s %6s %6s %7s %7s\n", "", "", "", "load ms", "", "", "CPU ms", "", "",
           "read", "map", "first picture, s", "");
    printf("%-32s %9s %8s %9s %8s %7s %9s %8s %7s %6s %6s %7s %7s\n", "city", "triangles", "MB", "files", "built",
           "times", "files", "built", "times", "ms", "ms", "files", "built");
    for (int end; at < argc; at = end + 1) {
        for (end = at; end < argc && strcmp(argv[end], "--");)
            end++;
        if (end > at)
            ok = bench((const char *const *)argv + at, (size_t)(end - at), rounds) && ok;
    }
    return ok ? 0 : 1;
}
