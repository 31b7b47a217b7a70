/* Cities in numbers: the thesis's table 6.1 for the data of ../shared, and what windows and cars add to a frame.
 *
 *   bench_cities SHARED                                  the table, as Markdown
 *   bench_cities SHARED frames [WIDTH HEIGHT [FRAMES]]   default: 640 360 4
 *
 * SHARED is the folder that holds data/. Each city is measured by a process of its own, so that the peak memory
 * (getrusage) is its own. Import is noc_scene_load; the first picture is its view, ray tracing structure and one frame
 * of the preset interactive at 640 x 360. Then the scene is saved as a built city, loaded and drawn again. All as
 * wall / processor seconds.
 *
 * Frames are seen along the street, CPU ms, median of FRAMES after the first, with each pass's share of the threads'
 * time: lamps only, with windows, and with cars, from one camera. These cities have no tracks of cars, so each of their
 * cars drives along five lamps, where the next one is nearer than 45 m.
 *
 * NOCTURNE_READER names the program nocturne-reader, which maps are read by. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include <math.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PARTS = 3, MOST_FRAMES = 64, MOST_LAMPS = 4096, TRACK_LAMPS = 5 };

typedef struct city {
    const char *name, *parts[PARTS];
    bool footprints, frames;
} city;

static const city cities[] = {
    { "Ingolstadt",
      { "cities/ingolstadt/ingolstadt_lod3_combined.gml.gz", "lights/ingolstadt/ingolstadt_street_lamps.geojson" },
      .frames = true },
    { "The Hague", { "cities/denhaag/DenHaag_01.city.json.gz" } },
    { "Rotterdam, Delfshaven", { "cities/rotterdam/3-20-DELFSHAVEN.city.json.gz" }, .frames = true },
    { "Rotterdam, Ommoord", { "cities/rotterdam/rotterdam_ommoord_converted.city.json.gz" } },
    { "Helsinki, Viikki", { "cities/helsinki/viikintiedepuisto.gml.gz" }, .frames = true },
    { "Helsinki, centre (outlines)", { "lights/helsinki/Helsinki.osm.pbf" }, .footprints = true },
    { "Berlin, Mitte", { "cities/berlin/berlin_mitte_lod2_v10.gml.gz" } },
    { "Dresden", { "cities/dresden/LoD2_33_416_5656_2_SN_14_Buildings.gml.gz" } },
    { "North Rhine-Westphalia", { "cities/nrw/LoD2_32_280_5659_1_NW.gml.gz" } },
    { "Potsdam", { "cities/potsdam/Potsdam_LoD1.gml.gz" } },
    { "Zurich", { "cities/zurich/zurich_subset_lod2.city.json.gz" } },
    { "Delft, 3D BAG", { "cities/delft/delft_3dbag_v11.city.jsonl.gz" } },
    { "Delft, 3dfier", { "cities/delft/delft_3dfier_v20.city.json.gz" } },
    { "Lyon, opera", { "cities/lyon/Opera-Lyon_CityGML3.0_LOD2.gml.gz" } },
    { "Melbourne, roundabout", { "cities/melbourne/citygml3_roads_roundabout.gml.gz" } },
    { "Tokyo", { "cities/plateau_tokyo/53395404_bldg_6697_op.gml.gz" } },
    { "Osaka", { "cities/plateau_osaka/51357309_bldg_6697_op.gml.gz" } },
    { "Kawasaki", { "cities/plateau_kawasaki/53392642_bldg_6697_op2.gml.gz" } },
    { "Tamana", { "cities/plateau_tamana/49303425_bldg_6697_op.gml.gz" } },
    { "Yokosuka", { "cities/plateau_yokosuka/52397519_bldg_6697_op.gml.gz" } },
    { "Washington (outlines)",
      { "lights/washington_dc/buildings.geojson.gz", "lights/washington_dc/streetlights.csv.gz" },
      .footprints = true },
};

static double wall_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double cpu_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* NULL after saying why. */
static noc_scene *load(const char *shared, const city *c, const noc_import_params *given, noc_log *log,
                       noc_report **report) {
    char paths[PARTS][1024];
    const char *inputs[PARTS];
    size_t count = 0;
    noc_import_params params = *given;
    params.footprints = c->footprints;
    for (int i = 0; i < PARTS && c->parts[i]; i++) {
        snprintf(paths[i], sizeof(paths[i]), "%s/data/%s", shared, c->parts[i]);
        inputs[count++] = paths[i];
    }
    noc_scene *scene = noc_scene_create(log);
    if (noc_scene_load(scene, inputs, count, &params, report) == NOC_OK)
        return scene;
    noc_scene_destroy(scene);
    return NULL;
}

static bool first_picture(const noc_scene *scene, noc_log *log) {
    noc_render_params p = noc_render_default_params();
    noc_camera camera;
    noc_render_use_preset(&p, NOC_PRESET_INTERACTIVE);
    p.width = 640;
    p.height = 360;
    if (noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 16.0 / 9, &camera) != NOC_OK)
        return false;
    noc_view *view = own_view(scene, 0, log);
    bool ok = view && noc_view_render(view, &camera, &p, NULL) == NOC_OK;
    close_view(view);
    return ok;
}

/* "519 collapsed ring, 123 ring with too few points" of what is lost, for no repair. */
static void print_skipped(const noc_report *report) {
    const char *before = "";
    for (size_t i = 0; i < noc_report_file_count(report); i++) {
        const noc_report_file *f = noc_report_get_file(report, i);
        for (size_t k = 0; k < f->line_count; k++)
            if (!f->lines[k].repaired) {
                printf("%s%zu %s", before, f->lines[k].count, f->lines[k].reason);
                before = ", ";
            }
    }
}

typedef struct taken {
    double wall, cpu;
} taken;

static taken since(taken start) { return (taken){ wall_seconds() - start.wall, cpu_seconds() - start.cpu }; }

/* From a built city to its first picture. */
static bool draw_built(const noc_scene *scene, const noc_report *report, noc_log *log, taken *loaded, taken *drawn) {
    char path[] = "/tmp/bench-cities-XXXXXX";
    int file = mkstemp(path);
    const char *input = path;
    bool ok = file >= 0 && noc_scene_save(scene, path, &(noc_save_params){ .report = report }) == NOC_OK;
    taken start = { wall_seconds(), cpu_seconds() };
    noc_scene *again = ok ? noc_scene_create(log) : NULL;
    ok = ok && noc_scene_load(again, &input, 1, NULL, NULL) == NOC_OK;
    *loaded = since(start);
    ok = ok && first_picture(again, log);
    *drawn = since(start);
    noc_scene_destroy(again);
    if (file >= 0) {
        close(file);
        unlink(path);
    }
    return ok;
}

static int tell_city(const char *shared, const city *c) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = bench_tell });
    noc_import_params params = noc_import_default_params();
    noc_report *report = NULL;
    taken start = { wall_seconds(), cpu_seconds() }, built, again;
    noc_scene *scene = load(shared, c, &params, log, &report);
    taken loaded = since(start);
    if (!scene || !first_picture(scene, log))
        return 1;
    taken drawn = since(start);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    if (!draw_built(scene, report, log, &built, &again))
        return 1;
    double area = 0;
    noc_report_totals t;
    noc_scene_info info;
    noc_report_get_totals(report, &t);
    noc_scene_get_info(scene, &info);
    for (int v = 0; v < NOC_WALL_VERDICT_COUNT; v++)
        area += t.windows.area[v];
    printf("| %s | %zu | %zu | %zu | %zu | ", c->name, t.buildings, info.triangles + info.instance_triangles,
           t.windows.windows, t.windows.lit);
    if (area > 0)
        printf("%.1f, %.1f", 100 * (double)t.windows.windows / area, 100 * (double)t.windows.lit / area);
    printf(" | %zu, %zu | %zu | ", t.lamps_mapped, t.lamps_inferred, t.cars);
    print_skipped(report);
    printf(" | %.1f | %.2f / %.2f | %.2f / %.2f | %.2f / %.2f | %.2f / %.2f | %.0f |\n",
           1e-6 * (double)t.bytes_read / loaded.cpu, loaded.wall, loaded.cpu, drawn.wall, drawn.cpu, built.wall,
           built.cpu, again.wall, again.cpu, 1e-3 * (double)usage.ru_maxrss);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return 0;
}

/* ---- frames ---- */

/* Chains of lamps, as tracks in longitude and latitude. false: there are none, or they cannot be written. */
static bool write_tracks(const noc_scene *scene, const char *path) {
    static double lamps[MOST_LAMPS][3];
    size_t count = 0, tracks = 0;
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    for (size_t i = 0; i < info.light_slots && count < MOST_LAMPS; i++) {
        noc_light_info light;
        bool lamp = noc_scene_get_light(scene, i, &light) == NOC_OK && !light.removed &&
                    light.light.kind != NOC_LIGHT_PARALLELOGRAM && light.light.kind != NOC_LIGHT_TRIANGLE;
        if (lamp)
            memcpy(lamps[count++], light.light.position, sizeof(lamps[0]));
    }
    FILE *f = fopen(path, "w");
    if (!f)
        return false;
    fprintf(f, "<?xml version=\"1.0\"?><gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\">");
    for (size_t left = count; left;) {
        double at[3];
        memcpy(at, lamps[--left], sizeof(at));
        tracks++;
        fprintf(f, "<trk><trkseg>");
        for (int points = 1;; points++) {
            double place[3] = { at[0], at[1], at[2] }, nearest = 45;
            if (noc_scene_from_local(scene, "EPSG:4326", place) == NOC_OK)
                fprintf(f, "<trkpt lon=\"%.8f\" lat=\"%.8f\"/>", place[0], place[1]);
            size_t next = left;
            for (size_t i = 0; i < left; i++) {
                double d = hypot(lamps[i][0] - at[0], lamps[i][1] - at[1]);
                if (d < nearest) {
                    nearest = d;
                    next = i;
                }
            }
            if (next == left || points == TRACK_LAMPS)
                break;
            memcpy(at, lamps[next], sizeof(at));
            memmove(lamps[next], lamps[--left], sizeof(at));
        }
        fprintf(f, "</trkseg></trk>");
    }
    fprintf(f, "</gpx>\n");
    return !fclose(f) && tracks;
}

typedef struct way {
    const char *name;
    bool preset;
    noc_preset of;
    noc_candidates candidates;
} way;
static const way ways[] = { { "still", true, NOC_PRESET_STILL },
                            { "interactive", true, NOC_PRESET_INTERACTIVE },
                            { "restir, uniform", .candidates = NOC_CANDIDATES_UNIFORM },
                            { "restir, influence", .candidates = NOC_CANDIDATES_INFLUENCE } };
enum { WAYS = sizeof(ways) / sizeof(*ways) };

static bool measure(const noc_scene *scene, const noc_camera *camera, const way *w, const int size[3]) {
    noc_render_params p = noc_render_default_params();
    if (w->preset) {
        noc_render_use_preset(&p, w->of);
    } else {
        p.method = NOC_METHOD_RESTIR;
        p.candidates = w->candidates;
        p.spatial = p.temporal = true;
    }
    p.width = size[0];
    p.height = size[1];
    noc_view *view = own_view(scene, 0, NULL);
    double cpu[MOST_FRAMES], pass[NOC_PASS_COUNT] = { 0 };
    noc_frame_stats stats;
    bool ok = view && noc_view_render(view, camera, &p, NULL) == NOC_OK;
    for (int i = 0; ok && i < size[2]; i++) {
        ok = noc_view_render(view, camera, &p, NULL) == NOC_OK;
        noc_view_get_stats(view, &stats);
        cpu[i] = stats.cpu_seconds;
        for (int k = 0; k < NOC_PASS_COUNT; k++)
            pass[k] += stats.pass_seconds[k];
    }
    if (ok) {
        double all = 0;
        const char *before = "";
        for (int k = 0; k < NOC_PASS_COUNT; k++)
            all += pass[k];
        printf(" %.0f (", 1e3 * bench_median(cpu, size[2]));
        for (int k = 0; k < NOC_PASS_COUNT; k++)
            if (pass[k] >= .04 * all) {
                printf("%s%s %.0f", before, noc_pass_name((noc_pass)k), 100 * pass[k] / all);
                before = ", ";
            }
        printf(" %%) |");
        fflush(stdout);
    }
    close_view(view);
    return ok;
}

static int tell_frames(const char *shared, const city *c, const int size[3]) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = bench_tell });
    noc_camera camera = { 0 };
    char tracks[] = "/tmp/bench-cities-XXXXXX";
    int file = mkstemp(tracks);
    bool ok = file >= 0;
    static const char *const stages[] = { "lamps only", "+ windows", "+ cars" };
    for (int stage = 0; ok && stage < 3; stage++) {
        noc_import_params params = noc_import_default_params();
        params.windows = stage ? NOC_SWITCH_ON : NOC_SWITCH_OFF;
        params.traffic = stage > 1 ? NOC_SWITCH_ON : NOC_SWITCH_OFF;
        if (stage > 1)
            params.tracks = (noc_texts){ { tracks }, 1 };
        noc_scene *scene = load(shared, c, &params, log, NULL);
        noc_scene_info info;
        noc_scene_get_info(scene, &info);
        ok = scene &&
             (stage || (noc_scene_camera(scene, NOC_VIEWPOINT_STREET, (double)size[0] / size[1], &camera) == NOC_OK &&
                        write_tracks(scene, tracks)));
        if (ok)
            printf("| %s, %s | %zu, %zu |", c->name, stages[stage], info.lights, info.cars);
        for (int i = 0; ok && i < WAYS; i++)
            ok = measure(scene, &camera, &ways[i], size);
        printf("\n");
        noc_scene_destroy(scene);
    }
    if (file >= 0) {
        close(file);
        unlink(tracks);
    }
    noc_log_destroy(log);
    return ok ? 0 : 1;
}

/* In a process of its own. */
static int apart(const char *shared, const city *c, const int *size) {
    fflush(stdout);
    pid_t child = fork();
    if (!child) {
        int status = size ? tell_frames(shared, c, size) : tell_city(shared, c);
        fflush(stdout);
        _exit(status);
    }
    int status = 1;
    if (child < 0 || waitpid(child, &status, 0) != child || status)
        fprintf(stderr, "bench_cities: %s could not be measured\n", c->name);
    return status != 0;
}

int main(int argc, char **argv) {
    bool frames = argc > 2 && !strcmp(argv[2], "frames");
    int size[3] = { 640, 360, 4 }, failed = 0;
    for (int i = 3; i < argc && i < 6; i++)
        size[i - 3] = atoi(argv[i]);
    if (argc < 2 || (argc > 2 && !frames) || argc == 4 || size[0] < 1 || size[1] < 1 || size[2] < 1 ||
        size[2] > MOST_FRAMES) {
        fprintf(stderr, "usage: bench_cities SHARED [frames [WIDTH HEIGHT [FRAMES]]]\n");
        return 2;
    }
    if (frames) {
        printf("| city | lights, cars |");
        for (int i = 0; i < WAYS; i++)
            printf(" %s |", ways[i].name);
        printf("\n|---|---|---|---|---|---|\n");
    } else {
        printf(
            "| city | buildings | triangles | windows | lit | on 100 m² of wall, lit | lamps mapped, inferred | cars "
            "| skipped | MB/s | import, s | first picture, s | import of .noct, s | its first picture, s | peak, MB |\n"
            "|---|--:|--:|--:|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|\n");
    }
    for (size_t i = 0; i < sizeof(cities) / sizeof(*cities); i++)
        if (!frames || cities[i].frames)
            failed += apart(argv[1], &cities[i], frames ? size : NULL);
    return failed ? 1 : 0;
}
