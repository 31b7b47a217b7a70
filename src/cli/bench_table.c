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
    printf("nocturne %s, %s, %s\n", noc_version(), noc_features(), bench_processor(a));
    for (size_t i = 0; i < args->common.input_count; i++)
        printf("%s%s", i ? ", " : "", noc_text_clean(a, sizeof(a), args->common.inputs[i]));
    printf(": %s, %s", noc_text_many(a, info->triangles, "triangle"), noc_text_many(c, info->lights, "light"));
    if (info->windows)
        printf(", %s, %s lit", noc_text_many(a, info->windows, "window"), noc_text_count(c, info->windows_lit));
    printf("; read in %s\n", noc_text_seconds(d, b->load_seconds));
    printf("Pictures of %d x %d; times are medians of up to %s, all rows of a table in turn: ms by the\n"
           "clock, CPU ms of all threads together.",
           args->width, args->height, noc_text_many(a, (uint64_t)args->frames, "frame"));
    if (args->time > 0)
        printf(" All of it takes about %.0f s at most (--time).", args->time);
    printf("\n");
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
           "  %-18s %7s %7s  %8s %7s  %6s %6s  %7s  %7s %7s\n",
           "", "ms", "CPU ms", "floor ms", "CPU ms", "ratio", "CPU", "M rays", "M/s", "first");
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        const noc_lab_times *s = &r->times;
        if (r->section != BENCH_FLOOR)
            continue;
        if (strcmp(view, r->view))
            printf("  %s\n", view = r->view);
        double rays = (double)(s->last.rays_primary + s->last.rays_shadow);
        printf("    %-16s %s %s   %s %s  %s %s  %7.3f  %7.1f %s\n", r->name, ms(t[0], s->wall_seconds),
               ms(t[1], s->cpu_seconds), ms(t[2], s->floor.wall_seconds), ms(t[3], s->floor.cpu_seconds),
               ratio(t[4], bench_ratio(s->wall_seconds, s->floor.wall_seconds)),
               ratio(t[5], bench_ratio(s->cpu_seconds, s->floor.cpu_seconds)), 1e-6 * rays,
               1e-6 * rays / s->floor.wall_seconds, ms(t[6], s->first.wall_seconds));
    }
    printf("  ratio: the frame over its floor; M/s: rays of the floor in a second; first: ms of the very first frame,\n"
           "  which also makes what was not there\n");
}

/* A table's line without the blanks of its last columns. */
static void print_trimmed(char *line) {
    size_t n = strlen(line);
    while (n && line[n - 1] == ' ')
        n--;
    printf("%.*s\n", (int)n, line);
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
        n += (size_t)snprintf(line + n, sizeof(line) - n, " %11s", cell);
    }
    if (any)
        print_trimmed(line);
}

static void print_passes_of(const bench *b, const char *view) {
    const bench_row *rows[BENCH_METHODS];
    char t[16];
    printf("  %-23s", view);
    for (int m = 0; m < BENCH_METHODS; m++) {
        const char *name = bench_method_names[m];
        rows[m] = bench_find(b, BENCH_FLOOR, view, name);
        printf(" %11s", strncmp(name, "restir-", 7) ? name : name + 7);
    }
    putchar('\n');
    for (int p = 0; p < NOC_PASS_COUNT; p++)
        print_pass(rows, p);
    printf("    %-21s", "thread ms");
    for (int m = 0; m < BENCH_METHODS; m++)
        printf(" %11s", rows[m] ? ms(t, bench_pass_sum(&rows[m]->times)) : "");
    putchar('\n');
}

static void print_candidates(const bench *b) {
    char t[16];
    printf("\ncandidates: drawn and weighed for what the street's pixels see, without a shadow ray\n"
           "  %-18s %20s %9s\n",
           "", "M, in a thread second", "ms");
    for (size_t i = 0; i < b->row_count; i++)
        if (b->rows[i].section == BENCH_CANDIDATES)
            printf("  %-18s %21.1f %9s\n", b->rows[i].name, 1e-6 * b->rows[i].candidates,
                   ms(t, b->rows[i].times.wall_seconds));
}

/* A table of what grows: each row against the first one. */
static void print_growth(const bench *b, bench_section section, const char *title) {
    char t[8][16], c[3][32];
    const bench_row *first = NULL;
    bool scene = section != BENCH_RESOLUTION && section != BENCH_THREADS, own = section != BENCH_WINDOWS;
    printf("\n%s: %s\n  %-14s %7s %7s %7s", bench_section_names[section], title, "", "ms", "CPU ms", "times");
    if (section == BENCH_THREADS)
        printf(" %9s\n", "faster");
    else if (section == BENCH_RESOLUTION)
        printf(" %9s %9s\n", "ns, pixel", "memory");
    else
        printf("  %8s %6s %6s %11s %10s%s\n", "floor ms", "times", "ratio", "triangles", "lights",
               own ? "  made, s    memory" : "");
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        const noc_lab_times *s = &r->times;
        if (r->section != section)
            continue;
        first = first ? first : r;
        printf("  %-14s %s %s %s", r->name, ms(t[0], s->wall_seconds), ms(t[1], s->cpu_seconds),
               ratio(t[2], bench_ratio(s->cpu_seconds, first->times.cpu_seconds)));
        if (section == BENCH_THREADS)
            printf("    %s\n", ratio(t[3], bench_ratio(first->times.wall_seconds, s->wall_seconds)));
        else if (section == BENCH_RESOLUTION)
            printf(" %9.0f %9s\n", 1e9 * s->cpu_seconds / ((double)r->width * r->height),
                   noc_text_bytes(c[0], s->last.picture_bytes));
        else
            printf("   %s %s %s %11s %10s", ms(t[3], s->floor.wall_seconds),
                   ratio(t[4], bench_ratio(s->floor.cpu_seconds, first->times.floor.cpu_seconds)),
                   ratio(t[5], bench_ratio(s->cpu_seconds, s->floor.cpu_seconds)), noc_text_count(c[0], r->triangles),
                   noc_text_count(c[1], r->lights));
        if (scene && own)
            printf(" %8.2f %9s", r->load_seconds + s->first.build_seconds + s->lights.build_seconds,
                   noc_text_bytes(c[2], s->lights.scene_bytes + s->lights.bytes));
        if (scene)
            putchar('\n');
    }
    if (scene)
        printf("  times: CPU time over that of the first row; ratio: of CPU times, the frame over its floor\n");
    print_left(b, section);
}

static void print_isa(const bench *b) {
    char t[8][16];
    const bench_row *first = bench_find(b, BENCH_ISA, NULL, "scalar");
    printf("\nisa: %s and candidates (uniform) by instruction set\n  %-14s %7s %7s %7s  %13s %7s\n",
           bench_method_names[b->args->method], "", "ms", "CPU ms", "faster", "M candidates", "faster");
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        if (r->section == BENCH_ISA)
            printf("  %-14s %s %s  %s  %13.1f  %s\n", r->name, ms(t[0], r->times.wall_seconds),
                   ms(t[1], r->times.cpu_seconds),
                   ratio(t[2], first ? bench_ratio(first->times.cpu_seconds, r->times.cpu_seconds) : NAN),
                   1e-6 * r->candidates, ratio(t[3], first ? bench_ratio(r->candidates, first->candidates) : NAN));
    }
    printf("  candidates are those of a thread in a second; faster: than scalar, by CPU time\n");
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
    switch (section) {
    case BENCH_FLOOR: print_floor(b); break;
    case BENCH_PASSES:
        printf("\npasses: shares of the thread time of a frame\n");
        print_passes_of(b, "street");
        print_passes_of(b, "aerial");
        break;
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
