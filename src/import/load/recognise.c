/* Which reader reads an input: its beginning tells, never its name. */
#include "import/load/load.h"
#include "import/picture.h"

#define HEAD_SIZE 65536

/* Reads as much of the head as there is, then a 0. */
static noc_status read_head(noc_stream *stream, char *head, size_t *size) {
    *size = 0;
    for (;;) {
        size_t got;
        noc_status status = noc_stream_read(stream, head + *size, HEAD_SIZE - *size, &got);
        if (status)
            return status;
        *size += got;
        if (!got || *size == HEAD_SIZE) {
            head[*size] = 0;
            return NOC_OK;
        }
    }
}

/* A file that no probe knows: a table whose columns the user must explain? */
static const noc_reader *find_named(const noc_reader *const *readers, const char *head, size_t size) {
    for (; *readers; readers++)
        if ((*readers)->probe_named && (*readers)->probe_named(head, size))
            return *readers;
    return NULL;
}

static noc_status refuse(noc_log *log, const char *name, const noc_reader *const *readers, const char *head,
                         size_t size) {
    const char *stranger = stranger_told(head);
    if (stranger)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: %s", name, stranger);
    char names[300] = ""; /* "CityGML, OBJ, ..." */
    for (size_t i = 0, n = 0; readers[i] && n < sizeof(names); i++)
        n += (size_t)noc_snprintf(names + n, sizeof(names) - n, "%s%s", i ? ", " : "", readers[i]->name);
    const char *offer =
        find_named(readers, head, size)
            ? ". If it is a table of lamps, say so with --lamps, and with --lamp-columns lon=A,lat=B where they are"
            : "";
    return noc_error(log, NOC_ERR_FORMAT, "%s: in none of the formats that are read (%s)%s", name, names, offer);
}

/* Which reader reads it; NULL where none does. */
static noc_status find_for(importer *im, input *in, const noc_reader *const *readers, noc_stream *stream, char *head,
                           noc_log *log) {
    size_t size = 0;
    noc_status status = read_head(stream, head, &size);
    if (status)
        return status;
    const char *name = noc_stream_name(stream);
    in->bytes = noc_stream_size(stream);
    in->reader = find_reader(readers, head, size);
    if (!in->reader && (in->named_lamps || in->named_tracks))
        in->reader = find_named(readers, head, size);
    in->remote = in->reader && in->reader->foreign && im->params->isolate && in->reader->foreign(head, size);
    in->without_crs = in->reader && (in->reader->reads == NOC_READS_MESH ||
                                     (in->reader->without_crs && in->reader->without_crs(head, size)));
    if (!size)
        return noc_error(log, NOC_ERR_FORMAT, "%s: the file is empty", name);
    if (!in->reader)
        return refuse(log, name, readers, head, size);
    if (in->named_lamps && in->reader->reads != NOC_READS_LAMPS)
        return noc_error(log, NOC_ERR_FORMAT, "%s: this is %s, and --lamps is for tables and maps of points", name,
                         in->reader->name);
    if (in->named_tracks && in->reader->reads != NOC_READS_TRACKS && in->reader->reads != NOC_READS_LAMPS)
        return noc_error(log, NOC_ERR_FORMAT, "%s: this is %s, and --tracks is for GPX, tables and maps of lines", name,
                         in->reader->name);
    if (in->reader->missing)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: this is %s, but %s", name, in->reader->name,
                         in->reader->missing);
    return NOC_OK;
}

noc_status recognise_input(importer *im, input *in, const noc_reader *const *readers) {
    if (!strncmp(in->path, BUILTIN, strlen(BUILTIN)))
        return in->named_lamps    ? noc_error(im->log, NOC_ERR_ARGUMENT, "lamps: %s is no file of lamps", in->path)
               : in->named_tracks ? noc_error(im->log, NOC_ERR_ARGUMENT, "tracks: %s is no file of tracks", in->path)
                                  : NOC_OK;
    noc_log *log = in->folder ? NULL : im->log; /* a folder may hold anything */
    noc_status status;
    noc_stream *stream = noc_stream_open(in->path, log, &status);
    char *head = stream ? noc_alloc(HEAD_SIZE + 1) : NULL;
    if (stream) {
        noc_stream_limit(stream, im->params);
        status = head ? find_for(im, in, readers, stream, head, log) : noc_no_memory(log, in->path);
    }
    free(head);
    noc_stream_close(stream);
    in->left_out = in->folder && (status ? status != NOC_ERR_MEMORY : picture_is_tiff(in->path));
    if (in->left_out)
        return NOC_OK;
    return status == NOC_ERR_MEMORY && in->folder ? noc_no_memory(im->log, in->path) : status;
}

noc_status recognise_told(const importer *im) {
    enum { SHOWN = 3 };
    for (size_t i = 0, end; i < im->input_count; i = end) {
        const char *folder = im->inputs[i].folder, *names[SHOWN];
        size_t left = 0;
        for (end = i; end < im->input_count && im->inputs[end].folder == folder; end++)
            if (im->inputs[end].left_out && left++ < SHOWN)
                names[left - 1] = im->inputs[end].path + strlen(folder);
        if (!folder || !left)
            continue;
        char shown[400] = "";
        for (size_t k = 0, n = 0; k < NOC_MIN(left, SHOWN); k++)
            n += (size_t)noc_snprintf(shown + n, sizeof(shown) - n, "%s%.100s", k ? ", " : "",
                                      names[k] + (*names[k] == '/'));
        if (left == end - i)
            return noc_error(im->log, NOC_ERR_FORMAT, "%s: no file of this folder is in a format that is read (%s%s)",
                             folder, shown, left > SHOWN ? ", ..." : "");
        noc_info(im->log, "%s: %zu of %zu files of the folder are in no format that is read, and left out: %s%s",
                 folder, left, end - i, shown, left > SHOWN ? ", ..." : "");
    }
    return NOC_OK;
}
