/* The files that a scene is made of: its inputs, and what these name. */
#include "scene/scene.h"

#include <inttypes.h>
#include <sys/stat.h>

/* What tells a file from all others, whatever it is called. */
#define IDENTITY 48
static bool identify(const char *path, char identity[IDENTITY]) {
    struct stat st;
    if (stat(path, &st) || !S_ISREG(st.st_mode))
        return false;
    noc_snprintf(identity, IDENTITY, "%" PRIu64 " %" PRIu64, (uint64_t)st.st_dev, (uint64_t)st.st_ino);
    return true;
}

void noc_scene_add_source(noc_scene *scene, const char *path, const char *by) {
    noc_scene_sources *s = &scene->sources;
    char identity[IDENTITY];
    uint64_t there;
    if (!identify(path, identity))
        return;
    pthread_mutex_lock(&s->lock);
    if (!map_get(&s->of, identity, &there)) {
        noc_scene_source source = { arena_strdup(&s->texts, path), arena_strdup(&s->texts, by) };
        if (s->texts.refused || !array_push(&s->list, source) || !map_put(&s->of, identity, s->list.len - 1, NULL))
            s->refused = true;
    }
    pthread_mutex_unlock(&s->lock);
}

const char *noc_scene_find_source(const noc_scene *scene, const char *path, const char **by) {
    char identity[IDENTITY];
    uint64_t at;
    if (by)
        *by = NULL;
    if (!scene || !path || !identify(path, identity) || !map_get(&scene->sources.of, identity, &at))
        return NULL;
    const noc_scene_source *source = &scene->sources.list.data[at];
    if (by)
        *by = source->by;
    return source->path;
}

void noc_scene_sources_free(noc_scene_sources *s) {
    map_free(&s->of);
    array_free(&s->list);
    arena_free(&s->texts);
    pthread_mutex_destroy(&s->lock);
}
