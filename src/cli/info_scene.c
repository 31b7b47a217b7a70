/* nocturne info --scene: all inputs as one scene, in numbers. */
#include "info.h"

#include <stdlib.h>
#include <string.h>

noc_status info_load(const info_args *args, const char *const *inputs, size_t count, noc_log *log, info_city *city) {
    double started = cli_now();
    *city = (info_city){ .scene = noc_scene_create(log) };
    noc_status status =
        city->scene ? noc_scene_load(city->scene, inputs, count, &args->import, &city->report) : NOC_ERR_MEMORY;
    status = status ? status : cli_switch_built(&args->common, city->scene, &args->import, city->report);
    city->seconds = cli_now() - started;
    cli_progress_clear();
    noc_scene_get_info(city->scene, &city->info);
    noc_report_get_totals(city->report, &city->totals);
    return status;
}

void info_city_end(info_city *city) {
    noc_report_destroy(city->report);
    noc_scene_destroy(city->scene);
}

/* The sky that render draws: the recipe's, else the default. */
double info_sky(const info_args *args) {
    noc_render_params render = noc_render_default_params();
    const noc_option *o;
    for (size_t i = 0; (o = noc_recipe_option(args->common.recipe, i)); i++)
        if (!strcmp(o->name, "sky"))
            noc_recipe_set(args->common.recipe, o, &render, NULL); /* it was checked when it was read */
    return render.sky;
}

static void print_lamps(const noc_report_totals *t, double maintenance) {
    char a[32];
    const struct {
        const char *what;
        size_t count;
    } rows[] = { { "moved", t->lamps_moved }, { "dropped", t->lamps_dropped }, { "repeated", t->lamps_repeated } };
    printf("  %-11s %s mapped", "lamps", noc_text_count(a, t->lamps_mapped));
    printf(", %s inferred", noc_text_count(a, t->lamps_inferred));
    const char *before = "; ";
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        if (rows[i].count) {
            printf("%s%s %s", before, noc_text_count(a, rows[i].count), rows[i].what);
            before = ", ";
        }
    if (maintenance != 1)
        printf("; they give %g of their flux", maintenance);
    putchar('\n');
    if (*t->profiles)
        printf("  %-11s %s\n", "profiles", t->profiles);
}

static void print_timing(const info_city *city) {
    char a[32], b[32];
    double bytes = (double)city->totals.bytes_read;
    printf("  %-11s %s", "import", noc_text_seconds(a, city->seconds));
    if (bytes > 1e6 && city->seconds > 0)
        printf(", %.0f MB/s of %s", 1e-6 * bytes / city->seconds, noc_text_bytes(b, city->totals.bytes_read));
    printf("\n  %-11s %s at most, %s of them the scene\n", "memory", noc_text_bytes(a, cli_peak_memory()),
           noc_text_bytes(b, city->info.memory_bytes));
}

void info_print_city(const info_city *city, const info_args *args) {
    const noc_scene_info *info = &city->info;
    const noc_report_totals *t = &city->totals;
    char a[32], b[64];
    printf("scene of %s\n", noc_text_many(b, args->common.input_count, "input"));
    if (*info->given_crs)
        printf("  %-11s %s\n", "CRS", info->given_crs);
    printf("  %-11s %.0f x %.0f x %.0f m\n", "size", info->bounds_max[0] - info->bounds_min[0],
           info->bounds_max[1] - info->bounds_min[1], info->bounds_max[2] - info->bounds_min[2]);
    if (t->objects)
        printf("  %-11s %s, %s of them buildings\n", "objects", noc_text_count(a, t->objects),
               noc_text_count(b, t->buildings));
    printf("  %-11s %s\n", "triangles", noc_text_count(a, info->triangles));
    info_print_counts(info->triangles_by_class);
    if (info->transparent_triangles)
        printf("  %-11s %s through which light goes\n", "transparent",
               noc_text_many(b, info->transparent_triangles, "triangle"));
    if (info->instances)
        printf("  %-11s %s that show %s\n", "instances", noc_text_count(a, info->instances),
               noc_text_many(b, info->instance_triangles, "triangle"));
    cli_print_windows("  windows     ", &t->windows);
    cli_print_sky("  sky         ", info_sky(args));
    print_lamps(t, info->maintenance);
    if (t->tracks || t->cars)
        printf("  %-11s %s, %s of them along roads\n", "cars", noc_text_count(a, t->cars),
               noc_text_count(b, t->road_cars));
    printf("  %-11s %s\n", "lights", noc_text_count(a, info->lights));
    cli_print_lights("  rules       ", "  groups      ", city->report);
    size_t count;
    noc_report_line *issues = cli_issues(city->report, &count);
    info_print_lines(issues, count, "skipped");
    info_print_lines(issues, count, "repaired");
    info_print_lines(issues, count, "guessed");
    free(issues);
    if (args->timing)
        print_timing(city);
}
