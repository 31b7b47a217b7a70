#include "import/map/parts.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <sys/stat.h>
#include <unistd.h>

static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return noc_strndup(path, slash ? (size_t)(slash + 1 - path) : 0);
}

static noc_status check_part(const char *path, const char *folder, const char *part, bool anywhere,
                             const import_listener *listener, noc_log *log) {
    if (!import_note_named(listener, "", part))
        return noc_no_memory(log, path);
    const char *why = import_named_trouble(folder, part, anywhere);
    return why ? noc_error(log, NOC_ERR_IO, "%s: its part %s cannot be read: %s", path, part, why) : NOC_OK;
}

/* ---- Shapefile ---- */

/* The parts that GDAL looks for, in whatever case. */
static bool is_part(const char *ending) {
    static const char *const endings[] = { ".shx", ".dbf", ".prj", ".cpg", ".qix", ".sbn", ".sbx", ".idm", ".ind" };
    for (size_t i = 0; i < NOC_COUNT(endings); i++)
        if (noc_ieq(ending, endings[i]))
            return true;
    return false;
}

noc_status map_check_shapefile(const char *path, bool anywhere, const import_listener *listener, noc_log *log) {
    char *folder = folder_of(path);
    if (!folder)
        return noc_no_memory(log, path);
    const char *base = path + strlen(folder), *dot = strrchr(base, '.');
    size_t stem = dot ? (size_t)(dot - base) : strlen(base);
    DIR *dir = opendir(*folder ? folder : ".");
    noc_status status =
        dir ? NOC_OK : noc_error(log, NOC_ERR_IO, "%s: its folder cannot be read: %s", path, strerror(errno));
    struct dirent *entry;
    while (!status && dir && (entry = readdir(dir))) {
        if (strncasecmp(entry->d_name, base, stem) || !is_part(entry->d_name + NOC_MIN(stem, strlen(entry->d_name))))
            continue;
        char *part = noc_format("%s%s", folder, entry->d_name);
        status = part ? check_part(path, folder, part, anywhere, listener, log) : noc_no_memory(log, path);
        free(part);
    }
    if (dir)
        closedir(dir);
    free(folder);
    return status;
}

noc_status map_check_told(const char *path, noc_log *log) {
    static const char *const endings[] = { ".prj", ".PRJ", ".cpg", ".CPG" };
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    int stem = (int)(dot ? (size_t)(dot - path) : strlen(path));
    noc_status status = NOC_OK;
    for (size_t i = 0; i < NOC_COUNT(endings) && !status; i++) {
        char *part = noc_format("%.*s%s", stem, path, endings[i]), piece[4096];
        if (!part)
            return noc_no_memory(log, path);
        FILE *file = fopen(part, "rbe");
        bool good = file || errno == ENOENT;
        while (file && fread(piece, 1, sizeof(piece), file) == sizeof(piece))
            ;
        if (!good || (file && ferror(file)))
            status = noc_error(log, NOC_ERR_IO, "%s: its part %s cannot be read: %s", path, part, strerror(errno));
        if (file)
            fclose(file);
        free(part);
    }
    return status;
}

#if NOC_HAVE_GDAL
/* Reads the first bytes of the part with that ending, in one case or the other. */
static bool read_head(const char *path, const char *const endings[2], uint8_t *head, size_t size) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    size_t n = 0;
    for (int i = 0; i < 2 && !n; i++) {
        char *part = noc_format("%.*s%s", (int)(dot ? (size_t)(dot - path) : strlen(path)), path, endings[i]);
        VSILFILE *f = part ? gdal.VSIFOpenL(part, "rb") : NULL;
        n = f ? gdal.VSIFReadL(head, 1, size, f) : 0;
        if (f)
            gdal.VSIFCloseL(f);
        free(part);
    }
    return n == size;
}

void map_count_shapefile(const char *path, char *text, size_t size) {
    uint8_t dbf[8], shx[28];
    *text = 0;
    if (!read_head(path, (const char *[]){ ".dbf", ".DBF" }, dbf, sizeof(dbf)) ||
        !read_head(path, (const char *[]){ ".shx", ".SHX" }, shx, sizeof(shx)))
        return;
    uint32_t rows = dbf[4] | (uint32_t)dbf[5] << 8 | (uint32_t)dbf[6] << 16 | (uint32_t)dbf[7] << 24;
    uint32_t words = (uint32_t)shx[24] << 24 | (uint32_t)shx[25] << 16 | (uint32_t)shx[26] << 8 | shx[27];
    uint32_t shapes = words > 50 ? (words - 50) / 4 : 0; /* words of two bytes: a head of 50, and 4 a shape */
    if (rows != shapes)
        snprintf(text, size, "%" PRIu32 " rows, %" PRIu32 " shapes", rows, shapes);
}
#endif

/* ---- GeoPackage ---- */

enum { COPY_BLOCK = 1 << 18 };

/* The next piece of a file that is no hole, from *begin on: false where none is left. File systems that tell of none
 * have one piece. */
static bool next_piece(int fd, off_t size, off_t *begin, off_t *end) {
    off_t data = *begin < size ? lseek(fd, *begin, SEEK_DATA) : -1;
    if (data < 0 && (*begin >= size || errno == ENXIO))
        return false;
    off_t hole = data < 0 ? -1 : lseek(fd, data, SEEK_HOLE);
    *begin = data < 0 ? *begin : data;
    *end = hole < 0 ? size : hole;
    return true;
}

/* Holes stay holes: whoever makes the file decides how large it seems. *copied grows by the bytes that are none. */
static noc_status copy_pieces(FILE *in, FILE *out, size_t size, char *buffer, const import_budget *budget,
                              double *copied, const char *name, noc_log *log, bool *good) {
    off_t begin = 0, end;
    while (*good && next_piece(fileno(in), (off_t)size, &begin, &end)) {
        *copied += (double)(end - begin);
        noc_status status = import_affords(budget, *copied, name, "its copy, which its log needs,", log);
        if (status)
            return status;
        *good = !fseeko(in, begin, SEEK_SET) && !fseeko(out, begin, SEEK_SET);
        for (size_t got; *good && begin < end; begin += (off_t)got) {
            got = fread(buffer, 1, NOC_MIN((size_t)(end - begin), (size_t)COPY_BLOCK), in);
            *good = got && fwrite(buffer, 1, got, out) == got;
        }
    }
    *good = *good && !fflush(out) && !ftruncate(fileno(out), (off_t)size);
    return NOC_OK;
}

static noc_status copy_file(const char *from, const char *to, const import_budget *budget, double *copied,
                            noc_log *log) {
    const char *why;
    size_t size;
    FILE *in = import_open_named("", from, true, &size, &why), *out = in ? fopen(to, "wbx") : NULL;
    char *buffer = noc_alloc(COPY_BLOCK);
    bool good = in && out && buffer, refused = !buffer || (!in && !why);
    noc_status status = good ? copy_pieces(in, out, size, buffer, budget, copied, from, log, &good) : NOC_OK;
    int error = errno;
    if (in)
        fclose(in);
    if (out && fclose(out) && good) {
        error = errno;
        good = false;
    }
    free(buffer);
    if (refused)
        return noc_no_memory(log, from);
    if (status || good)
        return status;
    return noc_error(log, NOC_ERR_IO, "%s: cannot be copied to %s, which its log needs: %s", from, to,
                     in ? strerror(error) : why);
}

/* Into a new folder. */
static noc_status copy_itself(const char *path, const import_budget *budget, double *copied, noc_log *log,
                              scratch_folder *folder) {
    noc_status status = scratch_make(folder, path, log);
    char *copy = status ? NULL : noc_format("%s/" MAP_COPY_NAME, folder->path);
    if (!status)
        status = copy ? copy_file(path, copy, budget, copied, log) : noc_no_memory(log, path);
    free(copy);
    return status;
}

noc_status map_copy_geopackage(const char *path, bool anywhere, const import_budget *budget,
                               const import_listener *listener, noc_log *log, scratch_folder *folder) {
    static const char *const logs[] = { "-wal", "-journal" };
    const import_budget memory = { .memory = budget->memory };
    double copied = 0;
    char *beside = folder_of(path);
    noc_status status = beside ? NOC_OK : noc_no_memory(log, path);
    *folder = (scratch_folder){ .lock = -1 };
    for (size_t i = 0; i < NOC_COUNT(logs) && !status; i++) {
        struct stat st;
        char *part = noc_format("%s%s", path, logs[i]);
        bool there = part && !lstat(part, &st);
        status = !part   ? noc_no_memory(log, path)
                 : there ? check_part(path, beside, part, anywhere, listener, log)
                         : NOC_OK;
        if (there && !status && !stat(part, &st) && st.st_size > 0) {
            if (!folder->path)
                status = copy_itself(path, &memory, &copied, log, folder);
            char *copy = status ? NULL : noc_format("%s/" MAP_COPY_NAME "%s", folder->path, logs[i]);
            if (!status)
                status = copy ? copy_file(part, copy, &memory, &copied, log) : noc_no_memory(log, path);
            free(copy);
        }
        free(part);
    }
    free(beside);
    return status;
}
