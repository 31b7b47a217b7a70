/* nocturne bench: what its files share. */
#ifndef NOC_CLI_BENCH_H
#define NOC_CLI_BENCH_H

#include "cli.h"

#include <nocturne/lab.h>

/* In the order in which they are measured and told. */
typedef enum bench_section {
    BENCH_FLOOR,  /* methods against their trace floor, by view */
    BENCH_PASSES, /* of the same frames */
    BENCH_CANDIDATES,
    BENCH_LIGHTS,
    BENCH_WINDOWS,
    BENCH_TRIANGLES,
    BENCH_RESOLUTION,
    BENCH_THREADS,
    BENCH_ISA,
    BENCH_MEMORY, /* of what floor and candidates made */
    BENCH_SECTIONS
} bench_section;

extern const char *const bench_section_names[BENCH_SECTIONS];

enum { BENCH_STILL, BENCH_INTERACTIVE, BENCH_UNIFORM, BENCH_INFLUENCE, BENCH_BIAS_RAYS, BENCH_LISTS, BENCH_METHODS };
extern const char *const bench_method_names[BENCH_METHODS];

typedef struct bench_args {
    cli_args common;
    const char *output, *only, *size;
    bool json, quick;
    int frames, method;
    noc_device_params device;
    double time; /* s; 0: no limit */
    noc_import_params import;
    noc_builtin_params builtin;
    bool sections[BENCH_SECTIONS]; /* that are asked for */
    int width, height;
    int base_width, base_height; /* of the first row of the table resolution */
} bench_args;

/* A row of a section's table. What does not apply to it is 0. */
typedef struct bench_row {
    bench_section section;
    const char *view; /* floor: "street" */
    char name[40];    /* of the method, the picker, the instruction set; else of what grows */
    int width, height, threads;
    size_t triangles, lights;
    double load_seconds;   /* of its scene, where it has one of its own */
    double candidates;     /* in a second of thread time */
    size_t surface_pixels; /* that they are drawn for */
    noc_lab_times times;
} bench_row;

/* What was left out, and why. */
typedef struct bench_left {
    bench_section section;
    char what[48], why[160];
} bench_left;

enum { BENCH_ROWS = 96, BENCH_LEFT = 48 };

typedef struct bench {
    bench_args *args;
    noc_log *log;
    noc_device *device;
    noc_scene *scene;
    noc_scene_info info;
    double load_seconds, begun;
    noc_view *kept;                /* the first picture: while it is there, so is the ray tracing structure */
    double frame;                  /* s, by the clock: of a frame of it at the size that is measured, about */
    double large;                  /* s: of a frame at the default size, where smaller pictures are taken; else 0 */
    bool measured[BENCH_SECTIONS]; /* with at least one round of each row */
    bench_row rows[BENCH_ROWS];
    size_t row_count;
    bench_left left[BENCH_LEFT];
    size_t left_count;
} bench;

/* bench_measure.c */
/* A first picture, whose time says how large the others are. */
noc_status bench_probe(bench *b);
/* All that is asked for. printed is called after each section that is there. */
noc_status bench_measure(bench *b, void (*printed)(const bench *b, bench_section section));
noc_status bench_load(bench *b, bool windows, noc_scene **scene); /* the inputs */
double bench_ratio(double a, double b);                           /* NAN where there is no ratio */
/* The first row of a section of that name, and view where it is not NULL; NULL: there is none. */
const bench_row *bench_find(const bench *b, bench_section section, const char *view, const char *name);
double bench_pass_sum(const noc_lab_times *times);
size_t bench_rows_of(const bench *b, bench_section section);
/* bench_room.c: memory that may still be taken, bytes. */
double bench_room(const noc_import_params *import);

/* bench_table.c */
void bench_print_head(const bench *b);
void bench_print_section(const bench *b, bench_section section);

/* bench_json.c */
void bench_json(const bench *b, bool complete, FILE *out);

#endif
