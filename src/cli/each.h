/* each: build of many tiles. each_look.c: what is known of inputs before they are built; each.c: what is built. */
#ifndef NOC_CLI_EACH_H
#define NOC_CLI_EACH_H

#include "cli.h"

typedef struct each_input {
    const char *path;
    const char *name; /* of a tile: the file's, without folder and ending; NULL: it is common to all */
    double extent[4]; /* of a tile, in the CRS of all */
    bool broken;      /* told, and no tile is made of it */
    uint64_t sum;     /* of its bytes */
} each_input;

typedef struct each_place {
    const char *crs;  /* of all tiles, for noc_import_params.scene_crs; NULL: none */
    noc_scene *scene; /* empty, in that CRS: it takes coordinates there */
} each_place;

/* Of a build. */
typedef struct each_build {
    const cli_args *args;
    const noc_import_params *import;
    noc_log *log;
    const char *folder, *recipe;
    uint64_t options; /* a number for all that the tiles are built with */
    double halo;
    cli_part part;
    each_input *inputs;
    size_t count, tiles; /* tiles: the first ones of the inputs, by name */
    double widest;       /* m, a tile's width */
    each_place place;
} each_build;

/* each_look.c: fills inputs of paths: which of them are tiles, and where these lie. What was found is kept in the
 * folder, so that parts share the work. CLI_OK, or an exit status after reporting; CLI_OK too where some are broken. */
int each_look(each_build *b, const char *const *paths, size_t count);
uint64_t each_sum_file(uint64_t sum, const char *path); /* of one that is not there nothing */
uint64_t each_sum_text(uint64_t sum, const char *text); /* with its end; NULL is told from "" */

/* each.c: the tiles of this part, and in the end the index. An exit status. */
int each_run(each_build *b);

#endif
