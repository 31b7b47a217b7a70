/* built: a scene with its report in one file, and out of it. noct/noct.h is the file, scene/keep.h what a scene keeps.
 */
#ifndef NOC_IMPORT_BUILT_H
#define NOC_IMPORT_BUILT_H

#include "import/load/load.h"
#include "noct/noct.h"

/* A number for all that must be the same where a file is written and where it is read. */
uint64_t built_layout(void);
/* Into an empty scene and the importer's report. */
noc_status built_read(importer *im, const char *path);

/* What a scene as a whole is told, but for its classes: where it lies, camera, maintenance, rain, time. Into an empty
 * one. false: memory was refused. */
bool built_copy_head(const noc_scene *from, noc_scene *to) NOC_MUST_USE;

/* inputs.c: the first of the inputs that is a built city, and was named; NULL: none is. */
const char *built_find(const importer *im);
/* Reads all of them, where they are of that kind. path: the first that is. */
noc_status built_load(importer *im, const char *path);

/* join.c: built_read of several, which become one scene. */
noc_status built_read_all(importer *im, const char *const *paths, size_t count);

/* report.c */
void built_write_report(noct_writer *w, const noc_report *report);
noc_status built_read_report(noct_file *f, noc_report *report);
/* Adds all that `from` tells; taken: of each window of its scene, whether it is among those of the scene that `to` is
 * of. false: memory was refused. */
bool built_join_report(noc_report *to, const noc_report *from, const bool *taken, size_t windows) NOC_MUST_USE;
/* A number for what a report's file is kept as. */
uint64_t built_report_layout(void);

#endif
