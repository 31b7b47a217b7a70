#include "import/xml.h"

#define MOST_TAG                                                                                                       \
    (4 << 20) /* bytes of a tag with its attributes, or a comment: expat looks at all of it again with each chunk */

/* expat goes on after some allocations that it was refused, and then finds a fault in the file. */
static _Thread_local bool refused;

static void *xml_alloc(size_t size) {
    void *p = noc_alloc(size);
    refused = refused || !p;
    return p;
}

static void *xml_realloc(void *old, size_t size) {
    void *p = noc_realloc(old, size);
    refused = refused || !p;
    return p;
}

XML_Parser xml_create(const char *separator) {
    refused = false;
    return XML_ParserCreate_MM(NULL, &(XML_Memory_Handling_Suite){ xml_alloc, xml_realloc, free }, separator);
}

noc_status xml_read(XML_Parser xml, noc_stream *stream, noc_status (*after)(void *user), void *user, xml_fault *fault) {
    enum { CHUNK = 1 << 17 };
    XML_Index fed = 0, reached = 0;
    *fault = XML_FAULT_NONE;
    for (size_t got = 1; got;) {
        void *buffer = XML_GetBuffer(xml, CHUNK);
        noc_status status = buffer ? noc_stream_read(stream, buffer, CHUNK, &got) : NOC_OK;
        if (status)
            return status;
        bool parsed = buffer && XML_ParseBuffer(xml, (int)got, got == 0) == XML_STATUS_OK;
        if (buffer && (status = after(user)))
            return status;
        fed += (XML_Index)got;
        reached = NOC_MAX(reached, XML_GetCurrentByteIndex(xml)); /* -1 in a long comment before the root */
        if (refused || !buffer)
            *fault = XML_FAULT_MEMORY;
        else if (!parsed)
            *fault = XML_FAULT_TEXT;
        else if (fed - reached > MOST_TAG + CHUNK)
            *fault = XML_FAULT_TAG;
        if (*fault)
            return NOC_OK;
    }
    return NOC_OK;
}
