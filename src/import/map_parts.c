#include "import/map_parts.h"

#include <dirent.h>
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

const char *map_temporary_folder(void) {
    const char *folder = getenv("TMPDIR");
    return folder && *folder ? folder : "/tmp";
}

static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? noc_format("%.*s", (int)(slash + 1 - path), path) : noc_strdup("");
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
    const char *base = path + strlen(folder), *dot = strrchr(base, '.');
    size_t stem = dot ? (size_t)(dot - base) : strlen(base);
    DIR *dir = opendir(*folder ? folder : ".");
    noc_status status = dir ? NOC_OK : noc_error(log, NOC_ERR_IO, "%s: its folder cannot be read: %s", path, strerror(errno));
    struct dirent *entry;
    while (!status && dir && (entry = readdir(dir))) {
        if (strncasecmp(entry->d_name, base, stem) || !is_part(entry->d_name + NOC_MIN(stem, strlen(entry->d_name))))
            continue;
        char *part = noc_format("%s%s", folder, entry->d_name);
        status = check_part(path, folder, part, anywhere, log);
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
    bool good = in && out;
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
    return good ? NOC_OK : noc_error(log, NOC_ERR_IO, "%s: cannot be copied to %s, which its log needs: %s", from, to, in ? strerror(error) : why);
}

noc_status map_copy_geopackage(const char *path, bool anywhere, noc_log *log, char **folder) {
    static const char *const logs[] = { "-wal", "-journal" };
    char *beside = folder_of(path);
    noc_status status = NOC_OK;
    *folder = NULL;
    for (size_t i = 0; i < NOC_COUNT(logs) && !status; i++) {
        struct stat st;
        char *part = noc_format("%s%s", path, logs[i]);
        bool there = !lstat(part, &st);
        status = there ? check_part(path, beside, part, anywhere, log) : NOC_OK;
        if (there && !status && !stat(part, &st) && st.st_size > 0) {
            bool first = !*folder;
            if (first)
                *folder = noc_format("%s/nocturne-XXXXXX", map_temporary_folder());
            if (first && !mkdtemp(*folder)) {
                status = noc_error(log, NOC_ERR_IO, "%s: no folder for a copy in %s: %s", path, map_temporary_folder(), strerror(errno));
                free(*folder);
                *folder = NULL;
            }
            char *copy = noc_format("%s/" MAP_COPY_NAME, *folder ? *folder : ""), *copied_log = noc_format("%s%s", copy, logs[i]);
            if (!status && first)
                status = copy_file(path, copy, log);
            if (!status)
                status = copy_file(part, copied_log, log);
            free(copy);
            free(copied_log);
        }
        free(part);
    }
    free(beside);
    return status;
}

void map_remove_copy(const char *folder) {
    static const char *const endings[] = { "", "-wal", "-shm", "-journal" };
    if (!folder)
        return;
    for (size_t i = 0; i < NOC_COUNT(endings); i++) {
        char *path = noc_format("%s/" MAP_COPY_NAME "%s", folder, endings[i]);
        unlink(path);
        free(path);
    }
    rmdir(folder);
}
