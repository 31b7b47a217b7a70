/* import/xml: expat on a stream, for files of any content: memory that it is refused is told, and so is a tag that
 * would take more time than it is worth. */
#ifndef NOC_IMPORT_XML_H
#define NOC_IMPORT_XML_H

#include "import/import.h"

#include <expat.h>

typedef enum xml_fault {
    XML_FAULT_NONE,
    XML_FAULT_TEXT,   /* no XML, or handlers stopped the parser: XML_GetErrorCode says why */
    XML_FAULT_TAG,    /* a tag or comment of more than 4 MB */
    XML_FAULT_MEMORY, /* was refused */
} xml_fault;

/* separator: between a namespace and a name; NULL: namespaces are not looked at. NULL: memory was refused.
 * XML_ParserFree() it. */
XML_Parser xml_create(const char *separator);

/* How far a parser is. Zero-initialise. */
typedef struct xml_progress {
    XML_Index fed, reached; /* bytes */
} xml_progress;

/* Parses all of the stream, to the text's end. after: asked behind each piece, ends the reading by another status than
 * NOC_OK. Returns that, or the stream's own; *fault tells what else ended it, and nobody has been told of that. */
noc_status xml_read(XML_Parser xml, xml_progress *at, noc_stream *stream, noc_status (*after)(void *user), void *user,
                    xml_fault *fault);
/* The same of some bytes, which others may follow. */
noc_status xml_feed(XML_Parser xml, xml_progress *at, const char *data, size_t size, noc_status (*after)(void *user),
                    void *user, xml_fault *fault);

#endif
