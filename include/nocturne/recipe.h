/* nocturne/recipe.h: a city in one file: its inputs, how they are read, what it is made of, and cameras by name.
 *
 * A recipe is YAML whose first key is "nocturne", the version of this format. Under it stand
 *
 *     nocturne: 1
 *     name: Ingolstadt              # any text
 *     inputs: [city.gml, dem.tif]   # as on the command line, as seen from the recipe's folder
 *     crs: EPSG:25832               # and any other option of render by its name (docs/options.md)
 *     lamps:                        # options whose names begin with "lamp-", and
 *       files: [lamps.geojson]      # --lamps
 *       height: 8                   # --lamp-height
 *     windows:                      # the same of "window-", and
 *       make: on                    # --windows
 *       lit: 0.3
 *     sky:                          # options whose names begin with "environment-", and
 *       zenith: sqm:18.8            # --sky; sky: sqm:18.8 says it alone
 *       environment: night.exr      # --environment
 *       light: on                   # --environment-light
 *     materials:                    # by class: noc_class_name
 *       wall: { albedo: [0.5, 0.45, 0.4], roughness: 0.8 }
 *       road: W3                    # noc_road_classes
 *     materials-by-name:            # as the inputs name them: noc_scene_find_material
 *       steel_dark: { metalness: 1, roughness: 0.3 }
 *     luminaires:                   # rules for lamps: nocturne/luminaire.h
 *       - { match: { lamp_type: "LED*", watts: ">= 60" }, profile: road.ies, kelvin: 4000 }
 *     groups:                       # of lights, by name
 *       square: { match: { street: "Market*" }, scale: 0.5, kelvin: 2200 }
 *     cameras:                      # by name; the first one is the recipe's own
 *       square: { eye: [10, -40, 1.7], target: [0, 0, 4], fov: 60 }
 *     paths:                        # of cameras, by name: keys of nocturne/path.h
 *       flight: { loop: off, keys: [{ camera: square }, { eye: [10, 40, 90], target: [0, 0, 4], seconds: 8, hour: 23 }]
 * }
 *
 * What a user says beside a recipe wins over it. */
#ifndef NOCTURNE_RECIPE_H
#define NOCTURNE_RECIPE_H

#include <nocturne/option.h>
#include <nocturne/path.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct noc_recipe noc_recipe;

typedef struct noc_recipe_camera {
    const char *name;
    noc_camera_params params;
} noc_recipe_camera;

typedef struct noc_recipe_path {
    const char *name;
    bool loop;
    size_t key_count;
    const noc_path_key *keys;
} noc_recipe_path;

/* Texts and arrays belong to the recipe. */
typedef struct noc_recipe_info {
    const char *path;
    const char *name; /* "" where it has none */
    size_t input_count;
    const char *const *inputs; /* builtin:NAME, or paths that the process can open */
    size_t camera_count;
    const noc_recipe_camera *cameras; /* in the file's order */
    size_t path_count;
    const noc_recipe_path *paths; /* in the file's order */
    size_t material_count;
    const noc_material *materials; /* for noc_import_params.materials: of one class each, the rest its defaults */
    size_t named_material_count;
    const noc_named_material *named_materials; /* for noc_import_params */
    size_t luminaire_count, group_count;
    const noc_luminaire_rule *luminaires; /* for noc_import_params, in the file's order */
    const noc_group_rule *groups;
    bool has_preset;
    noc_preset preset; /* what the recipe's options stand on */
} noc_recipe_info;

/* Is the file a recipe, or a built city (nocturne/built.h), which holds one? By its content; false where it cannot be
 * read. */
NOC_API bool noc_recipe_is(const char *path);

/* Reads a recipe. Its inputs are not opened; a built city's is itself. The first thing that is wrong with it is
 * reported with file, line and key. NOC_ERR_IO, NOC_ERR_FORMAT, NOC_ERR_ARGUMENT for a value that cannot be,
 * NOC_ERR_MEMORY. *recipe is NULL then, else the caller's to destroy. */
NOC_API noc_status noc_recipe_load(const char *path, noc_log *log, noc_recipe **recipe);
NOC_API void noc_recipe_destroy(noc_recipe *recipe); /* NULL is allowed */

NOC_API const noc_recipe_info *noc_recipe_get_info(const noc_recipe *recipe);

/* Sets what params take as lists to the recipe's: materials, those by name, luminaires, groups. NULL for either changes
 * nothing. */
NOC_API void noc_recipe_lists(const noc_recipe *recipe, noc_import_params *params);

/* The options that the recipe says, in its order; NULL beyond the last. They are rows of the tables of
 * nocturne/option.h. */
NOC_API const noc_option *noc_recipe_option(const noc_recipe *recipe, size_t index);
/* Sets the field of params, a struct that this row is of, to what the recipe says. Texts in it are the recipe's. */
NOC_API noc_status noc_recipe_set(const noc_recipe *recipe, const noc_option *option, void *params, noc_log *log);

/* An option and what is said of it: one text, of NOC_OPTION_TEXTS several. */
typedef struct noc_recipe_value {
    const noc_option *option;
    const char *const *texts;
    size_t count;
} noc_recipe_value;

/* A recipe as text, which noc_recipe_load reads back to the same: the parts of info but its path, and values of
 * options. A profile that a rule finds in a folder of its own is named with that folder. What is no UTF-8 is
 * NOC_ERR_FORMAT. *text is malloc'ed (free it), NULL after an error. */
NOC_API noc_status noc_recipe_write(const noc_recipe_info *info, const noc_recipe_value *values, size_t count,
                                    noc_log *log, char **text);

#ifdef __cplusplus
}
#endif
#endif
