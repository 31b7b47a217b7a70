/* Pictures as files in memory. */
#include "viewer/option.h"
#include "viewer/out.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The whole file; NULL where it cannot be read, and `why` then has the cause. */
static unsigned char *read_whole(const char *path, size_t *size, char *why, size_t why_size) {
    struct stat st;
    FILE *f = fopen(path, "rb");
    unsigned char *data = f && !fstat(fileno(f), &st) ? malloc((size_t)st.st_size + 1) : NULL;
    *size = data ? fread(data, 1, (size_t)st.st_size, f) : 0;
    bool whole = data && *size == (size_t)st.st_size;
    if (!whole)
        snprintf(why, why_size, "%s cannot be read: %s", path, strerror(errno));
    if (f)
        fclose(f);
    if (whole)
        return data;
    free(data);
    return NULL;
}

/* What was set of the world, as options of a load. The caller frees the texts, which are `count` pieces of *room. */
static bool say_groups(const out_view *v, noc_import_params *import, char **room) {
    enum { PIECE = 200 };
    world_made made;
    if (!world_get_made(v->world, &made))
        return false;
    *room = malloc(NOC_TEXTS * PIECE);
    import->group_states.count = 0;
    for (size_t i = 0; i < made.group_count && i < NOC_TEXTS && *room; i++) {
        char *text = *room + i * PIECE;
        snprintf(text, PIECE, "%.80s=", made.groups[i].name);
        world_group_text(&made.groups[i], text + strlen(text), PIECE - strlen(text));
        import->group_states.text[import->group_states.count++] = text;
    }
    free(made.groups);
    return *room;
}

static bool write_file(const out_view *v, noc_view *of, const char *path, noc_log *log) {
    noc_import_params import;
    char *room = NULL;
    world_import(v->world, &import);
    viewer_picture p = { .scene = world_scene(v->world),
                         .view = of,
                         .report = world_report(v->world),
                         .camera = *v->camera,
                         .render = look_params(v->look, v->width, v->height),
                         .display = v->look->display,
                         .channel = out_look(v).channel,
                         .show = v->look->show,
                         .preset = v->look->preset,
                         .frames = v->frames,
                         .import = &import };
    bool written = say_groups(v, &import, &room) && !v->source->write(v->source->user, &p, path, log);
    free(room);
    return written;
}

/* By way of a file of its own, for that is what the writers make. */
bool out_picture(const out_view *v, noc_view *of, bool exr, unsigned char **data, size_t *size, char *why,
                 size_t why_size) {
    const char *base = getenv("TMPDIR");
    char folder[300], path[320];
    viewer_ear ear = { why, why_size };
    *data = NULL;
    *size = 0;
    snprintf(folder, sizeof(folder), "%.200s/nocturne-XXXXXX", base && *base ? base : "/tmp");
    snprintf(why, why_size, "the picture cannot be written to %s", folder);
    if (!mkdtemp(folder)) {
        snprintf(why, why_size, "a folder for the picture cannot be made as %s: %s", folder, strerror(errno));
        return false;
    }
    snprintf(path, sizeof(path), "%s/night.%s", folder, exr ? "exr" : "png");
    noc_log *log = viewer_listen(&ear);
    if (write_file(v, of, path, log))
        *data = read_whole(path, size, why, why_size);
    noc_log_destroy(log);
    unlink(path);
    rmdir(folder);
    return *data;
}
