/* A built city against its inputs: noc_scene_load from either, the first picture, and the memory of both.
 *
 *   bench_built [--rounds N] [--cold] [--footprints] INPUT... [-- INPUT...]...     cities one behind another
 *
 * Each load is of a process of its own, as a program's is. Least of the rounds, of wall and of processor time (that of
 * helpers too), in turn, so that both meet the same machine. A load is all of noc_scene_load: reading, checksums, a
 * look at each number, the commit. The picture holds besides what both sides pay: the ray tracing structure, and those
 * of the lights. peak: resident memory, MB, when the picture is there. read: the file's bytes into fresh memory, by one
 * thread, which is what no load can be faster than; map: the same bytes mapped and summed.
 * --cold: the system forgets all that lies in the folders of the inputs, and the built file, before each load. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "noct/noct.h"

#include <fcntl.h>
#include <ftw.h>
#include <nocturne/nocturne.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct spent {
    double wall, cpu;
} spent;

/* What a process tells of its load and its picture. */
typedef struct told {
    spent load, picture;
    double peak; /* bytes */
    size_t triangles;
    bool ok;
} told;

static bool footprints, cold;

static spent now(void) {
    struct rusage helpers;
    getrusage(RUSAGE_CHILDREN, &helpers);
    return (spent){ noc_wall_seconds(), noc_cpu_seconds() + (double)helpers.ru_utime.tv_sec +
                                            (double)helpers.ru_stime.tv_sec +
                                            1e-6 * (double)(helpers.ru_utime.tv_usec + helpers.ru_stime.tv_usec) };
}

static spent since(spent from) {
    spent to = now();
    return (spent){ to.wall - from.wall, to.cpu - from.cpu };
}

static void keep_least(spent *least, spent of) {
    least->wall = NOC_MIN(least->wall, of.wall);
    least->cpu = NOC_MIN(least->cpu, of.cpu);
}

static int forget(const char *path, const struct stat *st, int kind, struct FTW *at) {
    (void)st;
    (void)at;
    int fd = kind == FTW_F ? open(path, O_RDONLY) : -1;
    if (fd >= 0) {
        fsync(fd);
        (void)!posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
        close(fd);
    }
    return 0;
}

static void forget_all(const char *const *inputs, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char *in = strdup(inputs[i]), *slash = in ? strrchr(in, '/') : NULL;
        bool built = !strncmp(inputs[i], "/tmp/", 5);
        if (slash && !built)
            *slash = 0;
        nftw(slash ? in : ".", forget, 16, FTW_PHYS);
        free(in);
    }
}

/* A small frame: what it takes beyond the load is the ray tracing structure, and those of the lights. */
static bool draw(const noc_scene *scene) {
    noc_camera camera;
    noc_render_params params = noc_render_default_params();
    noc_camera_params place = noc_camera_default_params();
    params.width = 320;
    params.height = 180;
    if (noc_scene_place_camera(scene, &place, 16 / 9.0, &camera, NULL))
        return false;
    noc_view *view = own_view(scene, 0, bench_log());
    bool ok = view && !noc_view_render(view, &camera, &params, NULL);
    close_view(view);
    return ok;
}

/* save: where the built city goes, instead of a picture; NULL: nowhere. */
static told load(const char *const *inputs, size_t count, const char *save) {
    noc_scene *scene = noc_scene_create(bench_log());
    noc_import_params params = noc_import_default_params();
    noc_report *report = NULL;
    noc_scene_info info = { 0 };
    struct rusage usage;
    params.footprints = footprints;
    spent from = now();
    told t = { .ok = !noc_scene_load(scene, inputs, count, &params, &report) };
    t.load = since(from);
    if (t.ok)
        t.ok = save ? !noc_scene_save(scene, save, &(noc_save_params){ report, NULL }) : draw(scene);
    t.picture = since(from);
    noc_scene_get_info(scene, &info);
    t.triangles = info.triangles;
    getrusage(RUSAGE_SELF, &usage);
    t.peak = 1024.0 * (double)usage.ru_maxrss;
    return t;
}

static told load_apart(const char *const *inputs, size_t count, const char *save) {
    told t = { 0 };
    int ends[2];
    if (cold)
        forget_all(inputs, count);
    fflush(stdout);
    if (pipe(ends))
        return t;
    pid_t child = fork();
    if (!child) {
        t = load(inputs, count, save);
        _exit(write(ends[1], &t, sizeof(t)) != sizeof(t));
    }
    close(ends[1]);
    if (child < 0 || read(ends[0], &t, sizeof(t)) != sizeof(t))
        t.ok = false;
    close(ends[0]);
    if (child > 0)
        waitpid(child, NULL, 0);
    return t;
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
    keep_least(read_all, since(from));
    noc_free_pages(bytes, size);
    from = now();
    bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
    volatile uint64_t sum = bytes == MAP_FAILED ? 0 : noct_sum(bytes, size);
    (void)sum;
    keep_least(map, since(from));
    munmap(bytes, size);
    close(fd);
}

static bool bench(const char *const *inputs, size_t count, int rounds) {
    char path[] = "/tmp/bench-built-XXXXXX";
    const char *built[] = { path };
    const spent most = { 1e9, 1e9 };
    told files = { .load = most, .picture = most }, file = files;
    spent read_all = most, map = most;
    struct stat st = { 0 };
    close(mkstemp(path));
    bool ok = load_apart(inputs, count, path).ok;
    for (int i = 0; i < 2 * rounds && ok; i++) {
        told t = i % 2 ? load_apart(built, 1, NULL) : load_apart(inputs, count, NULL), *least = i % 2 ? &file : &files;
        keep_least(&least->load, t.load);
        keep_least(&least->picture, t.picture);
        least->peak = t.peak;
        least->triangles = t.triangles;
        ok = t.ok;
        if (i % 2)
            touch(path, &read_all, &map);
    }
    const char *slash = strrchr(inputs[0], '/');
    if (ok && !stat(path, &st))
        printf("%-32.32s %9zu %7.1f %8.1f %7.1f %6.1f %8.1f %7.1f %6.1f %6.1f %6.1f %6.2f %6.2f %6.0f %6.0f\n",
               slash ? slash + 1 : inputs[0], file.triangles, 1e-6 * (double)st.st_size, 1e3 * files.load.wall,
               1e3 * file.load.wall, files.load.wall / file.load.wall, 1e3 * files.load.cpu, 1e3 * file.load.cpu,
               files.load.cpu / file.load.cpu, 1e3 * read_all.wall, 1e3 * map.wall, files.picture.wall,
               file.picture.wall, 1e-6 * files.peak, 1e-6 * file.peak);
    else
        printf("%s: failed\n", inputs[0]);
    fflush(stdout);
    unlink(path);
    return ok;
}

int main(int argc, char **argv) {
    int at = 1, rounds = 3;
    bool ok = true;
    for (; at < argc && !strncmp(argv[at], "--", 2) && argv[at][2]; at++)
        if (!strcmp(argv[at], "--rounds") && at + 1 < argc)
            rounds = atoi(argv[++at]);
        else if (!strcmp(argv[at], "--cold"))
            cold = true;
        else if (!strcmp(argv[at], "--footprints"))
            footprints = true;
    printf("%-32s %9s %7s %8s %7s %6s %8s %7s %6s %6s %6s %6s %6s %6s %6s\n", "", "", "", "load ms", "", "", "CPU ms",
           "", "", "read", "map", "picture", "s", "peak", "MB");
    printf("%-32s %9s %7s %8s %7s %6s %8s %7s %6s %6s %6s %6s %6s %6s %6s\n", "city", "triangles", "MB", "files",
           "built", "times", "files", "built", "times", "ms", "ms", "files", "built", "files", "built");
    for (int end; at < argc; at = end + 1) {
        for (end = at; end < argc && strcmp(argv[end], "--");)
            end++;
        if (end > at)
            ok = bench((const char *const *)argv + at, (size_t)(end - at), rounds) && ok;
    }
    return ok ? 0 : 1;
}
