/* keep: what a scene holds, in a built city's file and out of it. Each kind of thing has a pair of functions, in one
 * file; import/built/built.c has the table of them, and says in which order they are read.
 *
 * write: what is published; nothing can go wrong but the writer. read: into an empty scene; the file is a stranger's,
 * so each number is looked at before it counts. Large arrays stay where the file's bytes lie (array_borrow). Errors are
 * told by noct_wrong and noct_no_memory. */
#ifndef NOC_SCENE_KEEP_H
#define NOC_SCENE_KEEP_H

#include "noct/noct.h"
#include "scene/scene.h"

/* keep_scene.c: the scene as a whole; groups and profiles of lights. */
void noc_keep_scene(noct_writer *w, const noc_scene *s);
noc_status noc_kept_scene(noct_file *f, noc_scene *s);
void noc_keep_groups(noct_writer *w, const noc_scene *s);
noc_status noc_kept_groups(noct_file *f, noc_scene *s);
void noc_keep_profiles(noct_writer *w, const noc_scene *s);
noc_status noc_kept_profiles(noct_file *f, noc_scene *s);

/* keep_lights.c: groups and profiles come before. Windows come behind the lights that they are. */
void noc_keep_lights(noct_writer *w, const noc_scene *s);
noc_status noc_kept_lights(noct_file *f, noc_scene *s);
void noc_keep_windows(noct_writer *w, const noc_scene *s);
noc_status noc_kept_windows(noct_file *f, noc_scene *s);
/* Is each of these a light as noc_scene_add_light, a mesh or an instance makes one? */
bool noc_kept_light_fits(const noc_scene *s, const noc_light_record *r);

/* keep_models.c: models come before the meshes that they are made of, instances behind the lights that are theirs. */
void noc_keep_models(noct_writer *w, const noc_scene *s);
noc_status noc_kept_models(noct_file *f, noc_scene *s);
void noc_keep_instances(noct_writer *w, const noc_scene *s);
noc_status noc_kept_instances(noct_file *f, noc_scene *s);
void noc_keep_bodies(noct_writer *w, const noc_scene *s); /* behind the meshes and the lights */
noc_status noc_kept_bodies(noct_file *f, noc_scene *s);

/* keep_environment.c */
void noc_keep_environment(noct_writer *w, const noc_scene *s);
noc_status noc_kept_environment(noct_file *f, noc_scene *s);

/* keep_traffic.c: behind the instances that are cars. */
void noc_keep_traffic(noct_writer *w, const noc_scene *s);
noc_status noc_kept_traffic(noct_file *f, noc_scene *s);

/* street.c */
void noc_keep_streets(noct_writer *w, const noc_scene *s);
noc_status noc_kept_streets(noct_file *f, noc_scene *s);

/* keep_textures.c: before the materials that have them. */
void noc_keep_textures(noct_writer *w, const noc_scene *s);
noc_status noc_kept_textures(noct_file *f, noc_scene *s);

/* keep_surfaces.c: materials, of surfaces and of classes, then meshes with their triangles, which show lights and are
 * made of materials. */
void noc_keep_materials(noct_writer *w, const noc_scene *s);
noc_status noc_kept_materials(noct_file *f, noc_scene *s);
void noc_keep_classes(noct_writer *w, const noc_scene *s); /* what was said of them */
noc_status noc_kept_classes(noct_file *f, noc_scene *s);
void noc_keep_meshes(noct_writer *w, const noc_scene *s);
noc_status noc_kept_meshes(noct_file *f, noc_scene *s);

/* keep_facades.c: behind windows and meshes. */
void noc_keep_facades(noct_writer *w, const noc_scene *s);
noc_status noc_kept_facades(noct_file *f, noc_scene *s);

/* When all is read: makes what is not kept as it follows from the rest. The scene is committed then. */
noc_status noc_kept_done(noct_file *f, noc_scene *s);
/* After an error, and in the end: the scene takes the file's bytes, which its arrays may lie in. */
void noc_kept_take(noct_file *f, noc_scene *s);
/* After an error: what was not looked at is not there for who still asks the scene. */
void noc_kept_forget(noc_scene *s);

static inline bool noc_kept_finite(const float *v, size_t n, float most) {
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= v[i] >= -most && v[i] <= most;
    return ok;
}

#endif
