/* The parts of a built city, in the order in which they are read. */
#include "import/built/built.h"
#include "import/built/cut.h"
#include "scene/keep.h"

#include <nocturne/built.h>

#define RECIPE "recipe"
#define MOST_RECIPE ((size_t)1 << 20) /* bytes */

typedef struct built_part {
    void (*write)(noct_writer *w, const noc_scene *s);
    noc_status (*read)(noct_file *f, noc_scene *s);
} built_part;

static const char *definition(const struct geo_crs *crs, const char *kept) {
    return crs ? geo_crs_definition(crs) : kept;
}

static void write_crs(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "crs");
    noct_put_text(w, definition(s->crs, s->crs_kept));
    noct_put_text(w, definition(s->given_crs, s->given_crs_kept));
    noct_end(w);
}

/* A text that outlives the pages of the scene that it is from. */
static bool keep_text(noc_scene *to, const char *text, const char **kept) {
    *kept = arena_strdup(&to->names, text);
    return !text || *kept;
}

static bool copy_text(const char *text, char **out) {
    *out = noc_strdup(text);
    return !text || *out;
}

bool built_copy_head(const noc_scene *from, noc_scene *to) {
    memcpy(to->origin, from->origin, sizeof(to->origin));
    memcpy(to->given_origin, from->given_origin, sizeof(to->given_origin));
    to->own_camera = from->own_camera;
    to->maintenance = from->maintenance;
    to->wet = from->wet;
    to->time = from->time;
    return keep_text(to, definition(from->crs, from->crs_kept), &to->crs_kept) &&
           keep_text(to, definition(from->given_crs, from->given_crs_kept), &to->given_crs_kept) &&
           copy_text(from->crs_name, &to->crs_name) && copy_text(from->given_crs_name, &to->given_crs_name) &&
           copy_text(from->without_crs, &to->without_crs);
}

/* They are made when they are asked for: PROJ takes longer to open its database than a city to load. */
static noc_status read_crs(noct_file *f, noc_scene *s) {
    noct_cursor c = noct_section(f, "crs");
    s->crs_kept = noct_get_text(&c);
    s->given_crs_kept = noct_get_text(&c);
    noct_read_whole(f, &c, "crs");
    return f->status;
}

/* What a part needs of others stands before it. */
static const built_part parts[] = {
    { noc_keep_scene, noc_kept_scene },       { write_crs, read_crs },
    { noc_keep_groups, noc_kept_groups },     { noc_keep_profiles, noc_kept_profiles },
    { noc_keep_models, noc_kept_models },     { noc_keep_lights, noc_kept_lights },
    { noc_keep_windows, noc_kept_windows },   { noc_keep_instances, noc_kept_instances },
    { noc_keep_traffic, noc_kept_traffic },   { noc_keep_environment, noc_kept_environment },
    { noc_keep_textures, noc_kept_textures }, { noc_keep_materials, noc_kept_materials },
    { noc_keep_classes, noc_kept_classes },   { noc_keep_meshes, noc_kept_meshes },
    { noc_keep_facades, noc_kept_facades },   { noc_keep_streets, noc_kept_streets },
    { noc_keep_bodies, noc_kept_bodies },
};

/* All that must be the same where a file is written and where it is read. */
uint64_t built_layout(void) {
    const uint64_t numbers[] = { sizeof(noc_light_record),  sizeof(noc_scene_group), NOC_CLASS_COUNT,
                                 NOC_LIGHT_KIND_COUNT,      NOC_WINDOW_KIND_COUNT,   NOC_WALL_VERDICT_COUNT,
                                 LIGHT_PROFILE_BITS,        sizeof(noc_scene_stop),  sizeof(noc_scene_car),
                                 sizeof(noc_scene_profile), sizeof(noc_scene_body),  sizeof(noc_facade_record),
                                 sizeof(noc_scene_window),  NOC_COUNT(parts),        built_report_layout() };
    return noct_sum(numbers, sizeof(numbers));
}

static noc_status save(const noc_scene *scene, const char *path, const noc_save_params *params,
                       const noc_report *report) {
    noc_status status;
    noct_writer *w = noct_create(path, built_layout(), scene->log, &status);
    if (!w)
        return status;
    noc_scene_lock_read(scene);
    for (size_t i = 0; i < NOC_COUNT(parts); i++) {
        if (params)
            noct_watch(w, &params->progress, (double)i / NOC_COUNT(parts));
        parts[i].write(w, scene);
    }
    noc_scene_unlock_read(scene);
    built_write_report(w, report);
    if (params && params->tile)
        built_write_tile(w, scene, report, params->tile);
    if (params && params->recipe)
        noct_put_array(w, RECIPE, params->recipe, strlen(params->recipe), 1);
    return noct_close(w, NOC_OK);
}

static noc_status save_tile(const noc_scene *scene, const char *path, const noc_save_params *params) {
    noc_scene *part;
    noc_report *told;
    if (!params->report || params->tile->own >= params->tile->count || !params->tile->paths[params->tile->own])
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "%.400s: a tile needs the report of its load, and its file",
                         path);
    noc_status status = built_cut(scene, params->report, params->tile, &part, &told);
    status = status ? status : save(part, path, params, told);
    built_cut_free(part, told);
    return status;
}

noc_status noc_scene_save(const noc_scene *scene, const char *path, const noc_save_params *params) {
    if (!scene || !path)
        return noc_null(scene ? scene->log : NULL, __func__);
    if (!scene->committed || scene->edits.len || scene->added)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "%.400s: the scene is not committed, or edits of it are not",
                         path);
    if (params && params->recipe && strlen(params->recipe) > MOST_RECIPE)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "%.400s: its recipe has more than 1 MiB", path);
    return params && params->tile ? save_tile(scene, path, params)
                                  : save(scene, path, params, params ? params->report : NULL);
}

noc_status built_read(importer *im, const char *path) {
    noct_file f;
    noc_scene *s = im->scene;
    noc_status status =
        noct_open(&f, path, built_layout(), im->memory, im->params->threads, &im->params->progress, im->log);
    for (size_t i = 0; i < NOC_COUNT(parts) && !status; i++)
        status = parts[i].read(&f, s);
    if (!status)
        status = built_read_report(&f, im->report);
    if (!status)
        status = noc_kept_done(&f, s);
    if (status) {
        noc_kept_forget(s);
        im->report->rule_count = 0;
    }
    noc_kept_take(&f, s);
    noct_close_file(&f);
    return status;
}

bool noc_built_is(const char *path) { return path && noct_is(path); }

noc_status noc_built_get_recipe(const char *path, noc_log *log, char **text) {
    if (!path || !text)
        return noc_null(log, __func__);
    return noct_read_text(path, RECIPE, MOST_RECIPE, log, text);
}

noc_status noc_built_get_info(const char *path, noc_log *log, noc_built_info *info) {
    _Alignas(64) uint8_t page[NOCT_HEAD];
    noct_file f;
    if (!path || !info)
        return noc_null(log, __func__);
    *info = (noc_built_info){ 0 };
    noc_status status = noct_read_head(&f, path, page, log);
    if (status)
        return status;
    info->version = f.head->version;
    memcpy(info->writer, f.head->writer, sizeof(f.head->writer));
    info->bytes = f.head->size;
    info->section_count = f.head->sections;
    for (uint32_t i = 0; i < f.head->sections; i++) {
        memcpy(info->sections[i].name, f.entries[i].name, sizeof(f.entries[i].name));
        info->sections[i].bytes = f.entries[i].bytes;
    }
    return NOC_OK;
}
