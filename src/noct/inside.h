/* noct, inside: what its writer and its reader share. */
#ifndef NOC_NOCT_INSIDE_H
#define NOC_NOCT_INSIDE_H

#include "noct/noct.h"

/* What tells a file apart, and one that was changed as text or lost its high bits. */
static const uint8_t noct_magic[8] = { 0x89, 'N', 'O', 'C', 'T', '\r', '\n', 0x1a };
#define NOCT_ORDER 0x01020304u
#define NOCT_ALIGN 64u
#define NOCT_BLOCK ((size_t)1 << 20)
#define NOCT_NAMES "names"

_Static_assert(sizeof(noct_head) == 64 && sizeof(noct_entry) == 32, "the head's page is full of entries");

#endif
