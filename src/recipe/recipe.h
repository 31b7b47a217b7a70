/* recipe: a city in one YAML file. yaml.c reads the file into nodes that know their lines, recipe.c takes what they say
 * into options, cameras and materials, paths.c what it says of paths, rules.c into rules for lamps and groups of
 * lights. */
#ifndef NOC_RECIPE_H
#define NOC_RECIPE_H

#include "base/base.h"

#include <nocturne/built.h>
#include <nocturne/recipe.h>
#include <nocturne/text.h>
#include <yaml.h>

/* An option and what the recipe says of it: one text, of NOC_OPTION_TEXTS several. */
typedef struct recipe_setting {
    const noc_option *option;
    const char **texts;
    size_t count;
} recipe_setting;

struct noc_recipe {
    noc_recipe_info info;
    noc_arena arena; /* of all texts and arrays */
    NOC_ARRAY(recipe_setting) settings;
    NOC_ARRAY(const char *) inputs;
    NOC_ARRAY(noc_recipe_camera) cameras;
    NOC_ARRAY(noc_recipe_path) paths;
    NOC_ARRAY(noc_material) materials;
    NOC_ARRAY(noc_named_material) named_materials;
    NOC_ARRAY(noc_luminaire_rule) luminaires;
    NOC_ARRAY(noc_group_rule) groups;
};

/* A file while it is taken. */
typedef struct recipe_file {
    const char *path;
    noc_log *log;
    bool built; /* a built city's, which is its input */
    yaml_document_t yaml;
    size_t read; /* bytes of nodes, those that aliases repeat each time */
    noc_recipe *recipe;
    noc_log *listener; /* of calls whose errors are told with their line: the last one is in `told` */
    char told[400];
} recipe_file;

/* ---- rules.c ---- */

noc_status recipe_take_luminaires(recipe_file *f, yaml_node_t *list);
noc_status recipe_take_groups(recipe_file *f, yaml_node_t *map);

/* ---- yaml.c ---- */

noc_status recipe_open(recipe_file *f); /* reads path into yaml, which is the caller's to delete where it is NOC_OK */
/* NOC_ERR_FORMAT with "FILE:LINE: " before the message; of node, or of the file's end where it is NULL. */
noc_status recipe_wrong(const recipe_file *f, const yaml_node_t *node, const char *fmt, ...) NOC_PRINTF(3, 4);
yaml_node_t *recipe_node(recipe_file *f, int index);
/* The text of a scalar, NULL for other nodes, and for one that is empty or holds a zero byte. */
const char *recipe_text(const yaml_node_t *node);
/* Calls take for each pair of a mapping. An error for anything but a mapping, for keys that are no texts, and for one
 * that comes twice. what: of the node, for messages. */
noc_status recipe_each(recipe_file *f, yaml_node_t *map, const char *what,
                       noc_status (*take)(void *ctx, const yaml_node_t *key, yaml_node_t *value), void *ctx);
/* The texts of a sequence, or a scalar's one, in the recipe's arena. */
noc_status recipe_texts(recipe_file *f, yaml_node_t *node, const char *key, const char ***texts, size_t *count);
/* Exactly count numbers of a sequence. */
noc_status recipe_numbers(recipe_file *f, yaml_node_t *node, const char *key, size_t count, double *out);
/* A path as seen from the recipe's folder; builtin:NAME stays. NULL: memory was refused. */
const char *recipe_path(recipe_file *f, const char *path);

/* ---- recipe.c ---- */

/* What a call that told f->listener returned, as an error of that node. */
noc_status recipe_said(const recipe_file *f, const yaml_node_t *node, noc_status status);
/* Sets the row's field of params to a scalar. A text stays the recipe's. */
noc_status recipe_option(recipe_file *f, const noc_option *o, yaml_node_t *value, void *params);
/* "no key ratoi in windows; is it ratio?" */
noc_status recipe_unknown(const recipe_file *f, const yaml_node_t *key, const char *where, const char *const *words,
                          size_t count);
/* Sets the option's field of params. What is wrong is told with its line. */
noc_status recipe_set(const recipe_file *f, const yaml_node_t *node, const noc_option *o, void *params,
                      const char *text);
/* A key of a camera: view, eye, target, crs or fov. what: the camera, for messages; words: all that it may have. */
noc_status recipe_camera_key(recipe_file *f, noc_camera_params *params, const yaml_node_t *key, yaml_node_t *value,
                             const char *what, const char *const *words, size_t word_count);
/* What is wrong with where its keys say that a camera stands, NULL for nothing: eye and target go together, crs only
 * with them, and they are two places. */
const char *recipe_misplaced(const noc_camera_params *params);

/* ---- paths.c ---- */

noc_status recipe_take_paths(recipe_file *f, yaml_node_t *value); /* once the cameras are known */

#endif
