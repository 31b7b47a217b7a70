#include "import/map_parts.h"

#include <dirent.h>
#include <errno.h>
#include <sys/stat.h>

static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return noc_strndup(path, slash ? (size_t)(slash + 1 - path) : 0);
}

static noc_status check_part(const char *path, const char *folder, const char *part, bool anywhere, noc_log *log) {
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

noc_status map_check_shapefile(const char *path, bool anywhere, noc_log *log) {
    char *folder = folder_of(path);
    if (!folder)
        return noc_no_memory(log, path);
    const char *base = path + strlen(folder), *dot = strrchr(base, '.');
    size_t stem = dot ? (size_t)(dot - base) : strlen(base);
    DIR *dir = opendir(*folder ? folder : ".");
    noc_status status = dir ? NOC_OK : noc_error(log, NOC_ERR_IO, "%s: its folder cannot be read: %s", path, strerror(errno));
    struct dirent *entry;
    while (!status && dir && (entry = readdir(dir))) {
        if (strncasecmp(entry->d_name, base, stem) || !is_part(entry->d_name + NOC_MIN(stem, strlen(entry->d_name))))
            continue;
        char *part = noc_format("%s%s", folder, entry->d_name);
        status = part ? check_part(path, folder, part, anywhere, log) : noc_no_memory(log, path);
        free(part);
    }
    if (dir)
        closedir(dir);
    free(folder);
    return status;
}

/* ---- GeoPackage ---- */

static noc_status copy_file(const char *from, const char *to, noc_log *log) {
    const char *why;
    size_t size, got;
    FILE *in = import_open_named("", from, true, &size, &why), *out = in ? fopen(to, "wbx") : NULL;
    char *buffer = noc_alloc(1 << 18);
    bool good = in && out && buffer, refused = !buffer || (!in && !why);
    while (good && (got = fread(buffer, 1, 1 << 18, in)) > 0)
        good = fwrite(buffer, 1, got, out) == got;
    good = good && !ferror(in);
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
    return good ? NOC_OK : noc_error(log, NOC_ERR_IO, "%s: cannot be copied to %s, which its log needs: %s", from, to, in ? strerror(error) : why);
}

/* Into a new folder. */
static noc_status copy_itself(const char *path, noc_log *log, scratch_folder *folder) {
    noc_status status = scratch_make(folder, path, log);
    char *copy = status ? NULL : noc_format("%s/" MAP_COPY_NAME, folder->path);
    if (!status)
        status = copy ? copy_file(path, copy, log) : noc_no_memory(log, path);
    free(copy);
    return status;
}

noc_status map_copy_geopackage(const char *path, bool anywhere, noc_log *log, scratch_folder *folder) {
    static const char *const logs[] = { "-wal", "-journal" };
    char *beside = folder_of(path);
    noc_status status = beside ? NOC_OK : noc_no_memory(log, path);
    *folder = (scratch_folder){ .lock = -1 };
    for (size_t i = 0; i < NOC_COUNT(logs) && !status; i++) {
        struct stat st;
        char *part = noc_format("%s%s", path, logs[i]);
        bool there = part && !lstat(part, &st);
        status = !part ? noc_no_memory(log, path) : there ? check_part(path, beside, part, anywhere, log) : NOC_OK;
        if (there && !status && !stat(part, &st) && st.st_size > 0) {
            if (!folder->path)
                status = copy_itself(path, log, folder);
            char *copy = status ? NULL : noc_format("%s/" MAP_COPY_NAME "%s", folder->path, logs[i]);
            if (!status)
                status = copy ? copy_file(part, copy, log) : noc_no_memory(log, path);
            free(copy);
        }
        free(part);
    }
    free(beside);
    return status;
}
