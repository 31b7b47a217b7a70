/* The files that a scene is made of, as its load meets them. */
#include "import/load/load.h"

static void note(const importer *im, const char *path) {
    if (path)
        noc_scene_add_source(im->scene, path, NULL);
}

void sources_note_given(const importer *im, const char *const *paths, size_t count, const char *built) {
    const noc_import_params *p = im->params;
    note(im, built);
    note(im, p->environment);
    note(im, p->lamp_body);
    note(im, p->lamp_profile);
    for (size_t i = 0; i < p->cars.bodies.count; i++)
        note(im, p->cars.bodies.text[i]);
    for (size_t i = 0; i < count; i++)
        if (paths[i][0] == '@')
            note(im, paths[i] + 1);
}

static void on_named(void *user, const char *path) {
    const reading *r = user;
    noc_scene_add_source(r->im->scene, path, r->in->path);
}

import_listener sources_listener(reading *r) {
    return r->im->inspect ? (import_listener){ 0 } : (import_listener){ on_named, r };
}
