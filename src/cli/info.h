/* nocturne info: what its files share. */
#ifndef NOC_CLI_INFO_H
#define NOC_CLI_INFO_H

#include "cli.h"

typedef struct info_args {
    cli_args common;
    bool json, timing, each_lamp;
    noc_switch scene;
    noc_import_params import;
    noc_builtin_params builtin;
} info_args;

/* "skipped", "repaired" or "guessed". */
const char *info_action(const noc_report_line *line);
void info_print_file(const noc_report_file *file, const info_args *args);
void info_print_counts(const size_t counts[NOC_CLASS_COUNT]);
void info_print_lines(const noc_report_line *lines, size_t count, const char *action);

/* info_scene.c: all inputs as one scene. What there is to tell of it, whatever the status. */
typedef struct info_city {
    noc_report *report;
    noc_scene *scene;
    noc_scene_info info;
    noc_report_totals totals;
    double seconds; /* that the load took */
} info_city;
noc_status info_load(const info_args *args, const char *const *inputs, size_t count, noc_log *log, info_city *city);
void info_city_end(info_city *city);
double info_sky(const info_args *args); /* [cd/m2] at the zenith */
void info_print_city(const info_city *city, const info_args *args);

/* info_json.c */
/* One file as a JSON object: an error, what is reported of it, or the built-in scene; the others are NULL. */
void info_json_file(const char *path, const char *error, const noc_report_file *file, const noc_scene_info *scene,
                    bool timing);
noc_status info_json_city(const info_city *city, const info_args *args);

/* info_lamps.c: a line of CSV, or a JSON object, for each lamp of the scene. */
noc_status info_lamps(const info_city *city, bool json);

/* info_built.c: the head of a built city, as text or as a JSON object. */
noc_status info_built(const char *path, bool json, noc_log *log);

/* info_profile.c: a luminaire's file (IES, EULUMDAT), as text or as a JSON object. */
bool info_is_profile(const char *path);
noc_status info_profile(const char *path, bool json, noc_log *log);

#endif
