/* nocturne bench as tables. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Milliseconds in seven columns. */
static const char *ms(char text[16], double seconds) {
    double v = 1e3 * seconds;
    snprintf(text, 16, v < 99.95 ? "%7.2f" : v < 9999.5 ? "%7.1f" : "%7.0f", v);
    return text;
}

static const char *ratio(char text[16], double v) {
    snprintf(text, 16, isfinite(v) ? "%6.2f" : "     -", v);
    return text;
}

void bench_print_head(const bench *b) {
    const bench_args *args = b->args;
    const noc_scene_info *info = &b->info;
    char a[80], c[64], d[64];
    const noc_device_info *device = noc_device_get_info(b->device);
    printf("nocturne %s, %s, %s, %s\n", noc_version(), noc_features(), noc_backend_name(device->backend),
           noc_text_clean(a, sizeof(a), device->name));
    for (size_t i = 0; i < args->common.input_count; i++)
        printf("%s%s", i ? ", " : "", noc_text_clean(a, sizeof(a), args->common.inputs[i]));
    printf(": %s, %s", noc_text_many(a, info->triangles, "triangle"), noc_text_many(c, info->lights, "light"));
    if (info->windows)
        printf(", %s, %s lit", noc_text_many(a, info->windows, "window"), noc_text_count(c, info->windows_lit));
    printf("; read in %s\n", noc_text_seconds(d, b->load_seconds));
    printf("Pictures of %d x %d", args->width, args->height);
    if (b->large > 0)
        printf(", since time is short: a frame of 480 x 270 took %s", noc_text_seconds(d, b->large));
    printf(".\nEach row has the medians of its frames (%d at most), all rows of a table in turn: ms by the\n"
           "clock, CPU ms of all threads together.",
           args->frames);
    if (args->time > 0)
        printf(" All of it takes about %.4g s at most (--time); rows that do not fit are left out.", args->time);
    printf("\n");
}

/* Of how many frames a row's figures are the medians, marked where they are few. */
static const char *frames(char text[16], const bench_row *r) {
    snprintf(text, 16, "%5zu%s", r->times.frames, r->times.frames < 3 ? "*" : "");
    return text;
}

static void print_frames_legend(const bench *b, bench_section section) {
    for (size_t i = 0; i < b->row_count; i++)
        if (b->rows[i].section == section && b->rows[i].times.frames < 3) {
            printf("  *: of fewer than three frames\n");
            return;
        }
}

static void print_left(const bench *b, bench_section section) {
    for (size_t i = 0; i < b->left_count; i++)
        if (b->left[i].section == section)
            printf("  left out: %s: %s\n", b->left[i].what, b->left[i].why);
}

static void print_floor(const bench *b) {
    char t[8][16];
    const char *view = "";
    printf("\nfloor: frames, and the time of their rays alone\n"
           "  %-18s %7s %7s  %8s %9s  %6s %8s  %7s  %7s %7s %6s\n",
           "", "ms", "CPU ms", "floor ms", "floor CPU", "ratio", "by clock", "M rays", "M/s", "first", "frames");
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        const noc_lab_times *s = &r->times;
        if (r->section != BENCH_FLOOR)
            continue;
        if (strcmp(view, r->view))
            printf("  %s\n", view = r->view);
        double rays = (double)(s->last.rays_primary + s->last.rays_shadow);
        printf("    %-16s %s %s   %s   %s  %s   %s  %7.3f  %7.1f %s  %s\n", r->name, ms(t[0], s->wall_seconds),
               ms(t[1], s->cpu_seconds), ms(t[2], s->floor.wall_seconds), ms(t[3], s->floor.cpu_seconds),
               ratio(t[4], bench_ratio(s->cpu_seconds, s->floor.cpu_seconds)),
               ratio(t[5], bench_ratio(s->wall_seconds, s->floor.wall_seconds)), 1e-6 * rays,
               1e-6 * rays / s->floor.wall_seconds, ms(t[6], s->first.wall_seconds), frames(t[7], r));
    }
    printf(
        "  ratio: CPU time of the frame over that of its floor; by clock: the same of ms; M/s: rays of the floor in a\n"
        "  second; first: ms of the very first frame, which also makes what was not there\n");
    print_frames_legend(b, BENCH_FLOOR);
    print_left(b, BENCH_FLOOR);
}

/* A table's line without the blanks of its last columns. */
static void print_trimmed(char *line) {
    size_t n = strlen(line);
    while (n && line[n - 1] == ' ')
        n--;
    printf("%.*s\n", (int)n, line);
}

/* Columns as wide as their names. */
static int column(int method) {
    int n = (int)strlen(bench_method_names[method]);
    return n > 8 ? n : 8;
}

static void print_pass(const bench_row *const rows[BENCH_METHODS], int pass) {
    char line[160];
    size_t n = (size_t)snprintf(line, sizeof(line), "    %-21s", noc_pass_name((noc_pass)pass));
    bool any = false;
    for (int m = 0; m < BENCH_METHODS; m++) {
        double share = rows[m] ? bench_ratio(rows[m]->times.pass_seconds[pass], bench_pass_sum(&rows[m]->times)) : 0;
        any = any || share > 0;
        char cell[16] = "";
        if (share > 0)
            snprintf(cell, sizeof(cell), "%.1f %%", 100 * share);
        n += (size_t)snprintf(line + n, sizeof(line) - n, " %*s", column(m), cell);
    }
    if (any)
        print_trimmed(line);
}

static void print_passes_of(const bench *b, const char *view) {
    const bench_row *rows[BENCH_METHODS];
    char t[16];
    printf("  %-23s", view);
    for (int m = 0; m < BENCH_METHODS; m++) {
        rows[m] = bench_find(b, BENCH_FLOOR, view, bench_method_names[m]);
        printf(" %*s", column(m), bench_method_names[m]);
    }
    putchar('\n');
    for (int p = 0; p < NOC_PASS_COUNT; p++)
        print_pass(rows, p);
    char line[160], count[160];
    size_t n = (size_t)snprintf(line, sizeof(line), "    %-21s", "thread ms");
    size_t k = (size_t)snprintf(count, sizeof(count), "    %-21s", "frames");
    for (int m = 0; m < BENCH_METHODS; m++) {
        n += (size_t)snprintf(line + n, sizeof(line) - n, " %*s", column(m),
                              rows[m] ? ms(t, bench_pass_sum(&rows[m]->times)) : "");
        k += (size_t)snprintf(count + k, sizeof(count) - k, " %*s", column(m), rows[m] ? frames(t, rows[m]) : "");
    }
    print_trimmed(line);
    print_trimmed(count);
}

static void print_passes(const bench *b) {
    printf("\npasses: shares of the thread time of a frame\n");
    print_passes_of(b, "street");
    print_passes_of(b, "aerial");
    printf("  thread time: by the clock on each thread, waiting for a core included, summed over threads\n");
    print_frames_legend(b, BENCH_FLOOR);
}

static void print_candidates(const bench *b) {
    char t[2][16];
    printf("\ncandidates: drawn and weighed for what the street's pixels see, without a shadow ray\n"
           "  %-18s %8s %9s %7s\n",
           "", "M/s", "ms", "frames");
    for (size_t i = 0; i < b->row_count; i++)
        if (b->rows[i].section == BENCH_CANDIDATES)
            printf("  %-18s %8.1f %9s  %s\n", b->rows[i].name, 1e-6 * b->rows[i].candidates,
                   ms(t[0], b->rows[i].times.wall_seconds), frames(t[1], &b->rows[i]));
    printf(
        "  M/s: million in a second of thread time, which is by the clock on a thread, waiting for a core included\n");
    print_frames_legend(b, BENCH_CANDIDATES);
    print_left(b, BENCH_CANDIDATES);
}

/* A table of what grows: each row against the first one. */
static void print_growth(const bench *b, bench_section section, const char *title) {
    char t[8][16], c[3][32];
    const bench_row *first = NULL;
    bool scene = section != BENCH_RESOLUTION && section != BENCH_THREADS, own = section != BENCH_WINDOWS;
    printf("\n%s: %s\n  %-14s %7s %7s %7s", bench_section_names[section], title, "", "ms", "CPU ms", "CPU x");
    if (section == BENCH_THREADS)
        printf(" %9s %6s\n", "faster", "frames");
    else if (section == BENCH_RESOLUTION)
        printf(" %9s %9s %6s\n", "ns, pixel", "memory", "frames");
    else
        printf("  %8s %7s %6s %11s %10s%s %6s\n", "floor ms", "floor x", "ratio", "triangles", "lights",
               own ? "  made, s    memory" : "", "frames");
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        const noc_lab_times *s = &r->times;
        if (r->section != section)
            continue;
        first = first ? first : r;
        printf("  %-14s %s %s %s", r->name, ms(t[0], s->wall_seconds), ms(t[1], s->cpu_seconds),
               ratio(t[2], bench_ratio(s->cpu_seconds, first->times.cpu_seconds)));
        if (section == BENCH_THREADS)
            printf("    %s", ratio(t[3], bench_ratio(first->times.wall_seconds, s->wall_seconds)));
        else if (section == BENCH_RESOLUTION)
            printf(" %9.0f %9s", 1e9 * s->cpu_seconds / ((double)r->width * r->height),
                   noc_text_bytes(c[0], s->last.picture_bytes));
        else
            printf("   %s  %s %s %11s %10s", ms(t[3], s->floor.wall_seconds),
                   ratio(t[4], bench_ratio(s->floor.cpu_seconds, first->times.floor.cpu_seconds)),
                   ratio(t[5], bench_ratio(s->cpu_seconds, s->floor.cpu_seconds)), noc_text_count(c[0], r->triangles),
                   noc_text_count(c[1], r->lights));
        if (scene && own)
            printf(" %8.2f %9s", r->load_seconds + s->first.build_seconds + s->lights.build_seconds,
                   noc_text_bytes(c[2], s->lights.scene_bytes + s->lights.bytes));
        printf("  %s\n", frames(t[6], r));
    }
    printf("  CPU x: CPU time over that of the first row%s\n",
           scene                      ? ", floor x the floor's; ratio: the frame's over its floor's"
           : section == BENCH_THREADS ? "; faster: than the first row, by the clock"
                                      : "; ns: of CPU time");
    print_frames_legend(b, section);
    print_left(b, section);
}

static void print_isa(const bench *b) {
    char t[8][16];
    const bench_row *first = bench_find(b, BENCH_ISA, NULL, "scalar");
    printf("\nisa: %s and candidates (uniform) by instruction set\n  %-14s %7s %7s %7s  %14s %7s %6s\n",
           bench_method_names[b->args->method], "", "ms", "CPU ms", "faster", "candidates M/s", "more", "frames");
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        if (r->section == BENCH_ISA)
            printf("  %-14s %s %s  %s  %14.1f  %s  %s\n", r->name, ms(t[0], r->times.wall_seconds),
                   ms(t[1], r->times.cpu_seconds),
                   ratio(t[2], first ? bench_ratio(first->times.cpu_seconds, r->times.cpu_seconds) : NAN),
                   1e-6 * r->candidates, ratio(t[3], first ? bench_ratio(r->candidates, first->candidates) : NAN),
                   frames(t[4], r));
    }
    printf("  faster: than scalar, by CPU time; M/s: million in a second of thread time; more: than scalar\n");
    print_frames_legend(b, BENCH_ISA);
    print_left(b, BENCH_ISA);
}

static void print_memory(const bench *b) {
    char c[32];
    double pixels = (double)b->args->width * b->args->height;
    const bench_row *still = bench_find(b, BENCH_FLOOR, "street", bench_method_names[BENCH_STILL]);
    printf("\nmemory\n");
    for (int m = 0; m < BENCH_METHODS; m++) {
        const bench_row *r = bench_find(b, BENCH_FLOOR, "street", bench_method_names[m]);
        if (r)
            printf("%s%s %.0f%s",
                   m % 3 ? ", "
                   : m   ? "                     "
                         : "  bytes a pixel      ",
                   bench_method_names[m], (double)r->times.last.picture_bytes / pixels, m % 3 == 2 ? "\n" : "");
    }
    if (still) {
        double triangles = (double)b->info.triangles;
        printf("  bytes a triangle   scene %.0f, with its lights and images; ray tracing structure %.0f\n",
               (double)b->info.memory_bytes / triangles, (double)still->times.last.structure_bytes / triangles);
    }
    const char *before = "  bytes a light     ";
    if (still && still->times.lights.lights) {
        printf("%s lists %.0f", before, (double)still->times.lights.bytes / (double)still->times.lights.lights);
        before = ",";
    }
    for (size_t i = 0; i < b->row_count; i++) {
        const noc_light_stats *l = &b->rows[i].times.lights;
        if (b->rows[i].section != BENCH_CANDIDATES || !l->lights)
            continue;
        printf("%s %s %.0f", before, b->rows[i].name, (double)l->bytes / (double)l->lights);
        before = ",";
    }
    if (*before == ',')
        putchar('\n');
    if (still)
        printf("  learned visibility  %s\n", noc_text_bytes(c, still->times.last.learned_bytes));
    printf("  of the process     %s at most\n", noc_text_bytes(c, cli_peak_memory()));
}

void bench_print_section(const bench *b, bench_section section) {
    char title[96];
    const char *method = bench_method_names[b->args->method];
    if (section != BENCH_MEMORY && !bench_rows_of(b, section == BENCH_PASSES ? BENCH_FLOOR : section)) {
        printf("\n%s\n", bench_section_names[section]);
        print_left(b, section);
        return;
    }
    switch (section) {
    case BENCH_FLOOR: print_floor(b); break;
    case BENCH_PASSES: print_passes(b); break;
    case BENCH_CANDIDATES: print_candidates(b); break;
    case BENCH_ISA: print_isa(b); break;
    case BENCH_MEMORY: print_memory(b); break;
    default:
        snprintf(title, sizeof(title), "%s%s", method,
                 section == BENCH_LIGHTS      ? " in builtin:mess"
                 : section == BENCH_TRIANGLES ? " in streets of builtin:city, with its lights"
                                              : " of the street");
        print_growth(b, section, title);
    }
}
