/* cut: the part of a scene that is a tile's (noc_save_params.tile). */
#ifndef NOC_IMPORT_BUILT_CUT_H
#define NOC_IMPORT_BUILT_CUT_H

#include "import/built/built.h"
#include "scene/join.h"

#include <nocturne/built.h>

/* cut.c: the tile's part, and its report. Both are to be given to built_cut_free, after an
 * error, too. */
noc_status built_cut(const noc_scene *s, const noc_report *report, const noc_tile *tile, noc_scene **out,
                     noc_report **told);
void built_cut_free(noc_scene *cut, noc_report *told);

typedef enum cut_file { CUT_COMMON, CUT_OWN, CUT_OTHERS } cut_file;
/* Whose a file is: no tile's, this one's, another's. */
cut_file built_cut_file(const noc_tile *tile, const char *path);

/* cut_report.c: what the report tells of the part. taken: of each window of the whole, lights: of each lamp's light.
 * NULL: no memory. */
noc_report *built_cut_report(const noc_scene *part, const noc_scene *whole, const noc_report *report,
                             const noc_tile *tile, const bool *taken, const bool *lights);
/* The section "tile" of a built city. */
void built_write_tile(noct_writer *w, const noc_scene *part, const noc_report *told, const noc_tile *tile);

#endif
