/* nocturne info of a built city: its head. What it is built from is told like any files. */
#include "info.h"

#include <string.h>

/* What a section holds, of those that grow with a city; NULL: its name is a word. */
static const char *section_words(const char *name) {
    static const char *const words[][2] = {
        { "lightnam", "names of lights" },
        { "corners", "corners of triangles" },
        { "shown", "lights of triangles" },
        { "made", "lights before their groups" },
        { "walls", "which walls have windows" },
        { "tables", "luminaires' intensities" },
        { "material", "materials" },
        { "sky", "map around" },
        { "texels", "images" },
        { "panes", "windows' files" },
    };
    for (size_t i = 0; i < sizeof(words) / sizeof(*words); i++)
        if (!strcmp(words[i][0], name))
            return words[i][1];
    return name;
}

static void print_text(const char *path, const noc_built_info *file) {
    char a[64], name[400];
    printf("%s\n", noc_text_clean(name, sizeof(name), path));
    printf("  %-11s built city, version %u, by nocturne %s\n", "format", file->version, file->writer);
    printf("  %-11s %s\n", "size", noc_text_bytes(a, file->bytes));
    for (size_t i = 0; i < file->section_count; i++)
        if (file->sections[i].bytes >= file->bytes / 100)
            printf("    %-26s %10s\n", section_words(file->sections[i].name),
                   noc_text_bytes(a, file->sections[i].bytes));
}

static void print_json(const char *path, const noc_built_info *file) {
    fputs("  {\"path\": ", stdout);
    cli_json_text(stdout, path);
    printf(", \"format\": \"built city\", \"version\": %u, \"writer\": ", file->version);
    cli_json_text(stdout, file->writer);
    printf(", \"bytes\": %llu, \"sections\": {", file->bytes);
    for (size_t i = 0; i < file->section_count; i++) {
        fputs(i ? ", " : "", stdout);
        cli_json_text(stdout, file->sections[i].name);
        printf(": %llu", file->sections[i].bytes);
    }
    fputs("}}", stdout);
}

noc_status info_built(const char *path, bool json, noc_log *log) {
    noc_built_info file;
    noc_status status = noc_built_get_info(path, log, &file);
    if (!status && json)
        print_json(path, &file);
    else if (status && json)
        info_json_file(path, noc_log_last_error(log), NULL, NULL, false);
    else if (!status)
        print_text(path, &file);
    return status;
}
