/* Files of the page, packed into the program by tools/pack-page.py: nothing else is served. */
#ifndef NOC_VIEWER_PAGE_H
#define NOC_VIEWER_PAGE_H

#include <stddef.h>

typedef struct page_file {
    const char *name, *type; /* "index.html", "text/html; charset=utf-8" */
    const unsigned char *data;
    size_t size;
} page_file;

extern const page_file page_files[]; /* ended by one without a name */

#endif
