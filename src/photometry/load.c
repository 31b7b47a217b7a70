/* Files of profiles: one table, told apart by content. */
#include "photometry/photometry.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_BYTES = 64 << 20 };

static const photometry_format *const formats[] = { &photometry_ies, &photometry_eulumdat };

/* NULL: none looks like it. */
static const photometry_format *find_format(const void *head, size_t size) {
    for (size_t i = 0; i < NOC_COUNT(formats); i++)
        if (formats[i]->probe(head, size))
            return formats[i];
    return NULL;
}

bool noc_profile_probe(const void *head, size_t size) { return head && find_format(head, size); }

noc_status noc_profile_read(noc_log *log, const void *data, size_t size, const char *name, noc_profile **profile) {
    if (!data || !name || !profile)
        return noc_null(log, __func__);
    *profile = NULL;
    const photometry_format *format = find_format(data, size);
    if (!format)
        return noc_error(log, NOC_ERR_FORMAT, "%s: neither an IES LM-63 nor an EULUMDAT file", name);
    photometry_text t = { data, (const char *)data + size, name, log, 0 };
    noc_profile *p = photometry_new(log, name, "");
    noc_status status = p ? format->read(&t, p) : NOC_ERR_MEMORY;
    if (!status && p->texts.refused)
        status = noc_no_memory(log, name);
    if (status)
        noc_profile_destroy(p);
    else
        *profile = p;
    return status;
}

static noc_status read_file(noc_log *log, int fd, const char *path, noc_profile **profile) {
    struct stat st;
    if (fstat(fd, &st) || !S_ISREG(st.st_mode))
        return noc_error(log, NOC_ERR_IO, "%s: not a regular file", path);
    if (st.st_size > MOST_BYTES)
        return noc_error(log, NOC_ERR_FORMAT, "%s: too large for a luminaire's file", path);
    size_t size = (size_t)st.st_size, got = 0;
    char *data = noc_alloc(size + 1);
    if (!data)
        return noc_no_memory(log, path);
    for (ssize_t n = 1; got < size && n > 0; got += (size_t)NOC_MAX(n, 0)) {
        n = read(fd, data + got, size - got);
        if (n < 0) {
            free(data);
            return noc_error(log, NOC_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
        }
    }
    data[got] = 0;
    noc_status status = noc_profile_read(log, data, got, path, profile);
    free(data);
    return status;
}

noc_status noc_profile_load(noc_log *log, const char *path, noc_profile **profile) {
    if (!path || !profile)
        return noc_null(log, __func__);
    *profile = NULL;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe without a writer must not block */
    if (fd < 0)
        return noc_error(log, NOC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    noc_status status = read_file(log, fd, path, profile);
    close(fd);
    return status;
}
