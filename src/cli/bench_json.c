/* nocturne bench as JSON: seconds, bytes and counts. */
#include "bench.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static void number(FILE *out, const char *name, double v) {
    fprintf(out, ", \"%s\": ", name);
    cli_json_number(out, v);
}

/* What a number of nothing would be is left out. */
static void number_if(FILE *out, const char *name, double v) {
    if (v > 0)
        number(out, name, v);
}

static void passes(FILE *out, const noc_lab_times *s) {
    double sum = bench_pass_sum(s);
    const char *before = "";
    fprintf(out, ",\n      \"passes\": [");
    for (int p = 0; p < NOC_PASS_COUNT; p++) {
        if (!(s->pass_seconds[p] > 0))
            continue;
        fprintf(out, "%s{\"pass\": \"%s\"", before, noc_pass_name((noc_pass)p));
        number(out, "thread_s", s->pass_seconds[p]);
        number(out, "share", bench_ratio(s->pass_seconds[p], sum));
        fputc('}', out);
        before = ", ";
    }
    fputc(']', out);
}

static void row(FILE *out, const bench_row *r) {
    const noc_lab_times *s = &r->times;
    fprintf(out, "{\"name\": ");
    cli_json_text(out, r->name);
    if (r->view)
        fprintf(out, ", \"view\": \"%s\"", r->view);
    fprintf(out, ", \"width\": %d, \"height\": %d, \"triangles\": %zu, \"lights\": %zu", r->width, r->height,
            r->triangles, r->lights);
    number_if(out, "threads", r->threads);
    number(out, "frames", (double)s->frames);
    number(out, "wall_s", s->wall_seconds);
    number(out, "cpu_s", s->cpu_seconds);
    number(out, "first_wall_s", s->first.wall_seconds);
    if (s->floors) {
        number(out, "floor_wall_s", s->floor.wall_seconds);
        number(out, "floor_cpu_s", s->floor.cpu_seconds);
        number(out, "floor_ratio", bench_ratio(s->cpu_seconds, s->floor.cpu_seconds));
        number(out, "floor_ratio_wall", bench_ratio(s->wall_seconds, s->floor.wall_seconds));
    }
    number(out, "rays_primary", (double)s->last.rays_primary);
    number(out, "rays_shadow", (double)s->last.rays_shadow);
    number_if(out, "candidates_per_thread_s", r->candidates);
    number_if(out, "load_s", r->load_seconds);
    number(out, "structure_build_s", s->last.build_seconds);
    number(out, "lights_build_s", s->lights.build_seconds);
    number(out, "picture_bytes", (double)s->last.picture_bytes);
    number(out, "structure_bytes", (double)s->last.structure_bytes);
    number(out, "learned_bytes", (double)s->last.learned_bytes);
    number(out, "lights_bytes", (double)s->lights.bytes);
    number(out, "scene_bytes", (double)s->lights.scene_bytes);
    fprintf(out, ", \"path\": \"%s\"", s->last.path ? s->last.path : "");
    passes(out, s);
    fputc('}', out);
}

static void rows(const bench *b, FILE *out, bench_section section) {
    const char *before = "";
    for (size_t i = 0; i < b->row_count; i++) {
        if (b->rows[i].section != section)
            continue;
        fprintf(out, "%s\n    ", before);
        row(out, &b->rows[i]);
        before = ",";
    }
}

/* {"street": {"still": 1.5, ...}, ...}: by CPU time, or by the clock. */
static void floor_ratios(const bench *b, FILE *out, const char *name, bool wall) {
    const char *view = "";
    fprintf(out, ",\n  \"%s\": {", name);
    for (size_t i = 0; i < b->row_count; i++) {
        const bench_row *r = &b->rows[i];
        if (r->section != BENCH_FLOOR)
            continue;
        if (strcmp(view, r->view))
            fprintf(out, "%s\"%s\": {", *view ? "}, " : "", r->view);
        else
            fputs(", ", out);
        view = r->view;
        fprintf(out, "\"%s\": ", r->name);
        const noc_lab_times *s = &r->times;
        cli_json_number(out, wall ? bench_ratio(s->wall_seconds, s->floor.wall_seconds)
                                  : bench_ratio(s->cpu_seconds, s->floor.cpu_seconds));
    }
    fputs(*view ? "}}" : "}", out);
}

static void memory(const bench *b, FILE *out) {
    const bench_row *still = bench_find(b, BENCH_FLOOR, "street", bench_method_names[BENCH_STILL]);
    double pixels = (double)b->args->width * b->args->height, triangles = (double)b->info.triangles;
    fprintf(out, ",\n  \"memory\": {\"peak_bytes\": %llu", (unsigned long long)cli_peak_memory());
    if (still) {
        number(out, "bytes_per_pixel", (double)still->times.last.picture_bytes / pixels);
        number(out, "scene_bytes_per_triangle", (double)b->info.memory_bytes / triangles);
        number(out, "structure_bytes_per_triangle", (double)still->times.last.structure_bytes / triangles);
        number(out, "lists_bytes_per_light",
               bench_ratio((double)still->times.lights.bytes, (double)still->times.lights.lights));
    }
    fputc('}', out);
}

void bench_json(const bench *b, bool complete, FILE *out) {
    const bench_args *args = b->args;
    const noc_scene_info *info = &b->info;
    const noc_device_info *device = noc_device_get_info(b->device);
    noc_device_info processor;
    fprintf(out, "{\n  \"nocturne\": \"%s\", \"features\": ", noc_version());
    cli_json_text(out, noc_features());
    fprintf(out, ", \"backend\": \"%s\", \"device\": ", noc_backend_name(device->backend));
    cli_json_text(out, device->name);
    noc_device_find(NULL, &processor, b->log);
    fprintf(out, ", \"processor\": ");
    cli_json_text(out, processor.name);
    fprintf(out, ",\n  \"cores\": %ld, \"threads\": %d, \"complete\": %s,\n  \"inputs\": [",
            sysconf(_SC_NPROCESSORS_ONLN), args->device.threads, complete ? "true" : "false");
    for (size_t i = 0; i < args->common.input_count; i++) {
        fputs(i ? ", " : "", out);
        cli_json_text(out, args->common.inputs[i]);
    }
    fprintf(out, "],\n  \"scene\": {\"triangles\": %zu, \"lights\": %zu, \"windows\": %zu, \"windows_lit\": %zu",
            info->triangles, info->lights, info->windows, info->windows_lit);
    number(out, "bytes", (double)info->memory_bytes);
    number(out, "load_s", b->load_seconds);
    fprintf(out, "},\n  \"width\": %d, \"height\": %d, \"method\": \"%s\"", args->width, args->height,
            bench_method_names[args->method]);
    if (b->measured[BENCH_FLOOR] || b->measured[BENCH_PASSES]) {
        floor_ratios(b, out, "floor_ratio", false);
        floor_ratios(b, out, "floor_ratio_wall", true);
    }
    const char *before = "";
    fprintf(out, ",\n  \"tables\": {");
    for (int s = 0; s < BENCH_MEMORY; s++) {
        if (s == BENCH_PASSES || !(b->measured[s] || (s == BENCH_FLOOR && b->measured[BENCH_PASSES])))
            continue;
        fprintf(out, "%s\n  \"%s\": [", before, bench_section_names[s]);
        rows(b, out, (bench_section)s);
        fputc(']', out);
        before = ",";
    }
    fputc('}', out);
    if (b->measured[BENCH_MEMORY])
        memory(b, out);
    fprintf(out, ",\n  \"left_out\": [");
    for (size_t i = 0; i < b->left_count; i++) {
        fprintf(out, "%s\n    {\"table\": \"%s\", \"what\": ", i ? "," : "", bench_section_names[b->left[i].section]);
        cli_json_text(out, b->left[i].what);
        fprintf(out, ", \"why\": ");
        cli_json_text(out, b->left[i].why);
        fputc('}', out);
    }
    fputs("]\n}\n", out);
}
