/* citygml.c: the CityGML reader. CityGML 1.0 and 2.0, and of 3.0 what shares their structure, by expat, in bounded
 * memory. */
#include "import/citygml/citygml.h"
#include "import/lamps/tags.h"

/* ---- probe ---- */

/* Skips what may stand before the root element. NULL where the head ends first. */
static const char *find_root(const char *s) {
    for (;;) {
        s = strchr(s, '<');
        if (!s)
            return NULL;
        const char *end;
        if (!strncmp(s, "<!--", 4))
            end = strstr(s + 4, "-->");
        else if (!strncmp(s, "<?", 2))
            end = strstr(s + 2, "?>");
        else if (!strncmp(s, "<!", 2))
            end = strchr(s, '>');
        else
            return s;
        if (!end)
            return NULL;
        s = end + 1;
    }
}

static bool probe_text(const char *head) {
    const char *root = find_root(head);
    if (!root)
        return strstr(head, "http://www.opengis.net/citygml/") != NULL;
    size_t length = strcspn(root + 1, " \t\r\n/>");
    const char *local = root + 1 + length;
    while (local > root + 1 && local[-1] != ':')
        local--;
    if (length - (size_t)(local - root - 1) == 9 && !strncmp(local, "CityModel", 9))
        return true;
    return strstr(root, "http://www.opengis.net/citygml/") != NULL;
}

static bool probe(const char *head, size_t size) {
    const unsigned char *bytes = (const unsigned char *)head;
    size_t start = size >= 3 && !memcmp(head, "\xef\xbb\xbf", 3) ? 3 : 0;
    bool wide = size >= 4 && ((bytes[0] == 0xff && bytes[1] == 0xfe) || (bytes[0] == 0xfe && bytes[1] == 0xff) ||
                              !bytes[0] || !bytes[1]);
    char text[(1 << 16) + 1]; /* probes take no memory, so that none is refused */
    size_t n = 0;
    for (size_t i = start; i < size && n + 1 < sizeof(text);
         i++) /* UTF-16: names are ASCII, so every other byte is 0 */
        if (!wide || (bytes[i] && bytes[i] < 0x80))
            text[n++] = head[i] ? head[i] : ' ';
    text[n] = 0;
    bool is_xml = text[strspn(text, " \t\r\n")] == '<';
    return is_xml && probe_text(text);
}

/* ---- passes ---- */

static void refuse_entities(void *user, const XML_Char *name, int is_parameter, const XML_Char *value, int length,
                            const XML_Char *base, const XML_Char *system, const XML_Char *public_id,
                            const XML_Char *notation) {
    cg_fail(user, NOC_ERR_FORMAT, "the document declares an entity (\"%s\"); such files are refused", name);
}

static noc_status xml_error(cg_parser *p, xml_fault fault) {
    enum XML_Error code = XML_GetErrorCode(p->xml);
    if (fault == XML_FAULT_MEMORY)
        return cg_no_memory(p);
    if (fault == XML_FAULT_TAG)
        return cg_fail(p, NOC_ERR_FORMAT, "a tag or comment of more than 4 MB, which is not read");
    if (code == XML_ERROR_UNKNOWN_ENCODING || code == XML_ERROR_INCORRECT_ENCODING)
        return cg_fail(p, NOC_ERR_UNSUPPORTED,
                       "character encoding that is not read; UTF-8, UTF-16, ISO-8859-1 and "
                       "US-ASCII are");
    if (code == XML_ERROR_NO_ELEMENTS || code == XML_ERROR_UNCLOSED_TOKEN)
        return cg_fail(p, NOC_ERR_FORMAT, "the file ends too early: is it cut? (%s)", XML_ErrorString(code));
    return cg_fail(p, NOC_ERR_FORMAT, "%s", XML_ErrorString(code));
}

noc_status cg_ask(void *user) {
    cg_parser *p = user;
    if (p->status)
        return p->status;
    return p->sink->progress(p->sink->ctx, cg_progress(p)) ? NOC_OK : NOC_ERR_CANCELLED;
}

noc_status cg_after(cg_parser *p, noc_status status, xml_fault fault) {
    if (status)
        return p->status = status;
    return fault ? xml_error(p, fault) : NOC_OK;
}

bool cg_open(cg_parser *p, const cg_handlers *handlers) {
    p->depth = p->skip = 0;
    p->in_polygon = p->in_ring = false;
    p->text = CG_TEXT_NONE;
    p->lines = 0;
    p->ordinal = p->deferred_next = p->deferred_kept = 0;
    if (!(p->xml = xml_create("\n")))
        return false;
    XML_SetUserData(p->xml, p);
    XML_SetElementHandler(p->xml, handlers->start, handlers->end);
    XML_SetCharacterDataHandler(p->xml, handlers->text);
    XML_SetEntityDeclHandler(p->xml, refuse_entities);
    return true;
}

noc_status cg_parse(cg_parser *p, int pass, const cg_handlers *handlers) {
    p->pass = pass;
    if (!cg_open(p, handlers))
        return p->status = noc_no_memory(p->sink->log, noc_stream_name(p->stream));
    if (pass == 1 && p->sink->sides) {
        cg_read_members(p, handlers);
    } else {
        xml_fault fault;
        noc_status status = xml_read(p->xml, &(xml_progress){ 0 }, p->stream, cg_ask, p, &fault);
        cg_after(p, status, fault);
    }
    if (!p->status && !p->version && pass)
        cg_fail(p, NOC_ERR_FORMAT, "no CityGML in this GML file");
    XML_ParserFree(p->xml);
    p->xml = NULL;
    return p->status;
}

static noc_status run_pass(cg_parser *p, int pass) {
    return cg_parse(p, pass, &(cg_handlers){ cg_start_element, cg_end_element, cg_characters });
}

cg_parser *cg_parser_create(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format) {
    cg_parser *p = noc_calloc(1, sizeof(*p));
    if (p)
        p->keys = lamp_keys_create(params);
    if (!p || !p->keys) {
        free(p);
        noc_no_memory(sink->log, noc_stream_name(stream));
        return NULL;
    }
    p->stream = stream;
    p->params = params;
    p->place = noc_stream_name(stream);
    p->sink = sink;
    p->max_lod = NOC_CLAMP(params->lod, 0, 4);
    p->format = format;
    p->sink_srs = CG_UNTOLD;
    p->pass = 1;
    return p;
}

void cg_parser_destroy(cg_parser *p) {
    if (!p)
        return;
    lamp_keys_destroy(p->keys);
    cg_names_free(&p->names);
    cg_object_free(&p->object);
    cg_store_free(&p->store);
    cg_looks_free(&p->looks);
    array_free(&p->selection.items);
    array_free(&p->selection.missing);
    array_free(&p->selection.shapes);
    array_free(&p->selection.bodies);
    array_free(&p->deferred);
    array_free(&p->xyz);
    array_free(&p->ring_id);
    array_free(&p->ring_uv);
    array_free(&p->rings);
    array_free(&p->terrain_id);
    array_free(&p->numbers.values);
    array_free(&p->out);
    array_free(&p->out_rings);
    array_free(&p->out_uv);
    arena_free(&p->persistent);
    free(p);
}

noc_status cg_parser_end(cg_parser *p) {
    noc_debug(p->sink->log, "%s: %zu polygons used, %zu given twice, %zu named again by xlinks or solids",
              noc_stream_name(p->stream), p->emitted, p->twins, p->dropped - p->twins);
    return p->status ? p->status : lamp_keys_report(p->keys, p->sink, noc_stream_name(p->stream), 0);
}

static noc_status read_citygml(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                               const char **format) {
    *format = "CityGML";
    cg_parser *p = cg_parser_create(stream, params, sink, format);
    if (!p)
        return NOC_ERR_MEMORY;
    noc_status status = cg_read_looks(p);
    if (!status)
        status = run_pass(p, 1);
    for (int pass = 2; pass <= 3 && !status && p->deferred.len; pass++) {
        noc_debug(sink->log, "%s: %zu objects refer to others; reading once more", noc_stream_name(stream),
                  p->deferred.len);
        if ((status = noc_stream_rewind(stream)))
            break;
        status = run_pass(p, pass);
        p->deferred.len = p->deferred_kept;
    }
    if (!status)
        status = cg_parser_end(p);
    cg_parser_destroy(p);
    return status;
}

const noc_reader noc_reader_citygml = {
    .name = "CityGML", .reads = NOC_READS_CITY, .probe = probe, .read = read_citygml
};
