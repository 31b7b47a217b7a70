/* assimp: the functions of Assimp that are called. Its library, and those that it needs, are loaded when an OBJ is
 * read. */
#ifndef NOC_IMPORT_MESH_ASSIMP_H
#define NOC_IMPORT_MESH_ASSIMP_H

#include "base/library.h"

#include <assimp/cimport.h>
#include <assimp/material.h>

/* clang-format off */
#define ASSIMP_FUNCTIONS(X)                                                                                            \
    X(aiGetErrorString) X(aiGetMaterialColor) X(aiGetMaterialFloatArray) X(aiGetMaterialIntegerArray)                  \
    X(aiGetMaterialString) X(aiImportFileEx) X(aiReleaseImport)
/* clang-format on */

typedef struct assimp_functions {
    ASSIMP_FUNCTIONS(LIBRARY_POINTER)
} assimp_functions;

extern assimp_functions assimp;

/* Loads the library, once a process. NULL, or why it cannot be loaded; `assimp` must not be called then. A process
 * whose files or memory are confined calls it before. */
const char *assimp_load(void);

#endif
