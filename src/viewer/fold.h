/* fold: names as a search compares them. */
#ifndef NOC_VIEWER_FOLD_H
#define NOC_VIEWER_FOLD_H

#include <stdbool.h>

/* Without case and without marks on Latin letters: a hyphen is a blank, ß is ss, ae and ä are a, "str." and a word's
 * end "str" are "strasse". whole: it is a name; else a part of one is being typed, whose last word may go on. free()
 * it. NULL: no memory. */
char *fold_name(const char *text, bool whole);

#endif
