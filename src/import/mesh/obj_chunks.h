/* obj_chunks: the text of an OBJ in chunks that threads read side by side. What they read is taken in the text's order,
 * so that it is the same for any number of threads. */
#ifndef NOC_IMPORT_OBJ_CHUNKS_H
#define NOC_IMPORT_OBJ_CHUNKS_H

#include "base/base.h"

/* Whole statements. */
typedef struct obj_chunk {
    char *begin, *end;
    size_t line;         /* its first, from 1 (obj_plain_materials counts them) */
    size_t vertices, uv; /* before it (obj_text_read) */
} obj_chunk;

/* Zero-initialise. */
typedef struct obj_chunks {
    NOC_ARRAY(obj_chunk) list;
    NOC_ARRAY(char *) asked; /* lines of mtllib and usemtl (obj_plain_materials) */
    char *stop;              /* where the text ends */
    noc_pool *pool;
    size_t slots; /* chunks that are read before the first of them is taken */
} obj_chunks;

/* Cuts a text, which stays the caller's, for so many threads. false: no memory. */
bool obj_chunks_cut(obj_chunks *c, char *data, size_t size, int threads);
/* read: on any thread, into the slot's scratch, which nobody else has. take: after it, in the chunks' order, on the
 * calling thread; false ends it all. */
bool obj_chunks_each(obj_chunks *c, void (*read)(void *ctx, const obj_chunk *chunk, size_t slot),
                     bool (*take)(void *ctx, obj_chunk *chunk, size_t slot), void *ctx);
void obj_chunks_free(obj_chunks *c);

#endif
