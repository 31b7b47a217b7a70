/* option: rows of the option tables as the page wants them, and what goes wrong as words. */
#ifndef NOC_VIEWER_OPTION_H
#define NOC_VIEWER_OPTION_H

#include <nocturne/nocturne.h>

#include <jansson.h>

/* Where the first error of a call goes, as text. */
typedef struct viewer_ear {
    char *text;
    size_t size;
} viewer_ear;
noc_log *viewer_listen(viewer_ear *ear); /* the caller's; NULL where there is no memory: then nothing is heard */

bool viewer_wrong(char *why, size_t size, const char *fmt, ...) NOC_PRINTF(3, 4); /* false */
bool viewer_among(const char *name, const char *const *names, size_t count);

/* noc_option_set with words for what is wrong. */
bool viewer_option_set(const noc_option *o, void *params, const char *value, char *why, size_t size);
/* As docs/viewer-protocol.md has an option; params hold its default. */
json_t *viewer_option_json(const noc_option *o, const void *params);

/* A linear colour, its greatest part full, as sRGB. */
void viewer_colour(const double rgb[3], unsigned char out[3]);

/* Latin-1 as UTF-8. */
const char *viewer_utf8(char *text, size_t size, const char *latin1);

#endif
