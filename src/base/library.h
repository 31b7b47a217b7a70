/* library: a library that is loaded where it is first needed. Loading PROJ, GDAL or Assimp takes longer than all else
 * that a start does, and most runs need none of them.
 *
 * A table of its functions is a struct of pointers, made of a list X(function) X(function) ... by LIBRARY_POINTER, and
 * their names by LIBRARY_NAME. */
#ifndef NOC_BASE_LIBRARY_H
#define NOC_BASE_LIBRARY_H

#include <stddef.h>

#define LIBRARY_POINTER(function) __typeof__(function) *function;
#define LIBRARY_NAME(function) #function,

enum { LIBRARY_WHY = 300 }; /* bytes of why a library cannot be loaded */

/* Fills the table with the `count` functions of these names. Leaves why empty, or says there why it cannot; the table
 * must not be used then. */
void library_load(const char *library, const char *const *names, size_t count, void *table, char why[LIBRARY_WHY]);

#endif
