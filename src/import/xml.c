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

enum { CHUNK = 1 << 17 };

/* Of a piece that was parsed. */
static xml_fault fault_of(XML_Parser xml, xml_progress *at, size_t size, bool parsed) {
    at->fed += (XML_Index)size;
    at->reached = NOC_MAX(at->reached, XML_GetCurrentByteIndex(xml)); /* -1 in a long comment before the root */
    if (refused)
        return XML_FAULT_MEMORY;
    if (!parsed)
        return XML_FAULT_TEXT;
    return at->fed - at->reached > MOST_TAG + CHUNK ? XML_FAULT_TAG : XML_FAULT_NONE;
}

noc_status xml_feed(XML_Parser xml, xml_progress *at, const char *data, size_t size, noc_status (*after)(void *user),
                    void *user, xml_fault *fault) {
    *fault = XML_FAULT_NONE;
    for (size_t n; size && !*fault; data += n, size -= n) {
        n = NOC_MIN(size, (size_t)CHUNK);
        bool parsed = XML_Parse(xml, data, (int)n, false) == XML_STATUS_OK;
        noc_status status = after(user);
        if (status)
            return status;
        *fault = fault_of(xml, at, n, parsed);
    }
    return NOC_OK;
}

noc_status xml_read(XML_Parser xml, xml_progress *at, noc_stream *stream, noc_status (*after)(void *user), void *user,
                    xml_fault *fault) {
    *fault = XML_FAULT_NONE;
    for (size_t got = 1; got && !*fault;) {
        void *buffer = XML_GetBuffer(xml, CHUNK);
        if (!buffer) {
            *fault = XML_FAULT_MEMORY;
            return NOC_OK;
        }
        noc_status status = noc_stream_read(stream, buffer, CHUNK, &got);
        if (status)
            return status;
        bool parsed = XML_ParseBuffer(xml, (int)got, got == 0) == XML_STATUS_OK;
        if ((status = after(user)))
            return status;
        *fault = fault_of(xml, at, got, parsed);
    }
    return NOC_OK;
}
