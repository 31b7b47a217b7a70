/* records: the records of a table, field by field. */
#ifndef NOC_LAMP_RECORDS_H
#define NOC_LAMP_RECORDS_H

#include "import/import.h"
#include "import/lamps/utf16.h"

typedef struct csv {
    noc_stream *stream;
    noc_log *log;
    char separator;
    bool special[2][256]; /* bytes that are not just part of a field's text, outside quotes and within */
    char chunk[1 << 16];
    size_t len, pos;
    utf16 units;             /* of a table in UTF-16 */
    char raw[(1 << 15) - 8]; /* of it, before it is decoded */
    bool again;              /* the present record is the next one, too: a table without a header */
    size_t line;             /* where the present record began, from 1 */
    size_t next_line;
    NOC_ARRAY(char) text; /* fields of the record, each ended by a 0 */
    NOC_ARRAY(size_t) start;
    bool ended;
} csv;

/* Goes to the table's beginning, and finds its separator. */
noc_status csv_start(csv *c) NOC_MUST_USE;
/* Reads a record; at the end of the table leaves no fields. What is wrong is reported. */
noc_status csv_read(csv *c) NOC_MUST_USE;
static inline const char *csv_field(const csv *c, size_t i) { return c->text.data + c->start.data[i]; }
void csv_free(csv *c);
/* The separator of a first line; 0 if there is none. */
char csv_separator(const char *head, size_t size);

#endif
