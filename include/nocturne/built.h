/* nocturne/built.h: a city as one file, as `nocturne build` writes it: a committed scene, ready to be rendered.
 *
 * noc_scene_load takes such a file like any input, tells it by its content, and reads no file of another kind with it.
 * The scene is the one that was saved: it renders the same pictures, bit for bit, and may be edited as that could. What
 * a build decides is decided: of noc_import_params only threads, max_memory, strict, progress, environment, materials,
 * wet and group_states are read. Rain falls on what classes were made of when the scene was saved, and not twice.
 * Windows are switched by noc_scene_set_windows, cars by noc_scene_set_time.
 *
 * Several such files are read as one scene, where they stand in the CRS that all were built in: what they share
 * (materials, models, groups of lights by name) is there once, and the land to the horizon is laid around all. The
 * camera, the environment map and the time are those of the first file. An object that two files hold is there twice.
 *
 * The file is read as a whole and checked: what it holds is a stranger's word, as of all inputs. Its numbers lie as the
 * machine has them, and as this version of the library keeps them: one of another version, or of a machine with another
 * order of bytes, is refused with the advice to build it again. So it is no format to keep a city in for years. */
#ifndef NOCTURNE_BUILT_H
#define NOCTURNE_BUILT_H

#include <nocturne/import.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A tile of a city that is built in parts: what of a scene is its own, of which it is loaded with those around it. */
typedef struct noc_tile {
    /* This tile and its neighbours: the paths that they were loaded by, and their extents, x0, y0, x1, y1 in the
     * scene's CRS. Tiles must be listed in one order in every call */
    const char *const *paths;
    const double (*extents)[4];
    size_t count, own; /* own: which of them it is */
    const char *key;   /* kept in the file, for who wants to know what it was made of; NULL: none */
} noc_tile;

typedef struct noc_save_params {
    /* Of the load that made the scene, which a load of the file gives again, but for the folders that its files lay in;
     * NULL, the default: none */
    const noc_report *report;
    /* A recipe without inputs (nocturne/recipe.h): cameras by name, and options, which noc_recipe_load finds in the
     * file; NULL, the default: none */
    const char *recipe;
    noc_progress progress; /* asked while the file is written, and must not edit the scene; update NULL, the default:
                            * none */
    /* The part of the scene that is this tile's: objects of its file, and of what files that are no tile's hold, and of
     * lamps, ground and cars, what lies nearest to its extent (0 within it; of two that are as near the one that comes
     * first). Surfaces are cut along squares of 8 m. The report is that of its load. NULL, the default: all */
    const noc_tile *tile;
} noc_save_params;

/* Writes the scene as a built city. The file appears under its name when it is whole; one that was there is replaced
 * then. params may be NULL. NOC_ERR_ARGUMENT after reporting: the scene is not committed, or edits of it wait for a
 * commit. NOC_ERR_CANCELLED by progress, NOC_ERR_IO, NOC_ERR_MEMORY: there is no new file then.
 * Waits for a commit at work, and frames may be rendered meanwhile. */
NOC_API noc_status noc_scene_save(const noc_scene *scene, const char *path, const noc_save_params *params);

/* Is the file a built city? By its first bytes; false where it cannot be read. */
NOC_API bool noc_built_is(const char *path);

/* What a tile's file says of itself. */
typedef struct noc_tile_info {
    double extent[4];
    unsigned long long buildings, windows, lamps, triangles;
    char key[65]; /* "": none */
} noc_tile_info;

/* NOC_ERR_FORMAT: it is no built city, or was not saved as a tile; not reported where log is NULL. */
NOC_API noc_status noc_built_get_tile(const char *path, noc_log *log, noc_tile_info *info);

#define NOC_BUILT_SECTIONS 128

/* What a built city's file says of itself. */
typedef struct noc_built_info {
    unsigned version;         /* of the format */
    char writer[17];          /* version of the library that wrote it */
    unsigned long long bytes; /* of the file */
    size_t section_count;
    struct {
        char name[9];
        unsigned long long bytes;
    } sections[NOC_BUILT_SECTIONS]; /* as they lie in it */
} noc_built_info;

/* Reads the head of a built city alone: what it holds is not looked at. */
NOC_API noc_status noc_built_get_info(const char *path, noc_log *log, noc_built_info *info);

/* The recipe that it was saved with, in *text, which is the caller's to free(); NULL where there is none. */
NOC_API noc_status noc_built_get_recipe(const char *path, noc_log *log, char **text);

#ifdef __cplusplus
}
#endif
#endif
