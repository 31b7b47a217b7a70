/* nocturne info: what its files share. */
#ifndef NOC_CLI_INFO_H
#define NOC_CLI_INFO_H

#include "cli.h"

typedef struct info_args {
    cli_args common;
    bool json;
    noc_import_params import;
    noc_builtin_params builtin;
} info_args;

/* "skipped", "repaired" or "guessed". */
const char *info_action(const noc_report_line *line);

/* One file as a JSON object: an error, what is reported of it, or the built-in scene; the others are NULL. */
void cli_info_json(const char *path, const char *error, const noc_report_file *file, const noc_scene_info *scene);

/* info_profile.c: a luminaire's file (IES, EULUMDAT), as text or as a JSON object. */
bool info_is_profile(const char *path);
noc_status info_profile(const char *path, bool json, noc_log *log);

#endif
