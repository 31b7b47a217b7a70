#include "import/remote/remote.h"

#include <errno.h>
#include <sys/socket.h>

void remote_put(remote_record *r, const void *data, size_t size) {
    r->refused = !array_append(&r->bytes, data, size) || r->refused;
}

void remote_put_text(remote_record *r, const char *text) {
    uint32_t size = (uint32_t)NOC_MIN(strlen(text ? text : ""), (size_t)1 << 30);
    remote_put(r, &size, sizeof(size));
    remote_put(r, text ? text : "", size);
    remote_put(r, "", 1);
}

const void *remote_get_array(remote_record *r, uint64_t count, size_t item) {
    size_t left = r->bytes.len - r->pos;
    r->bad = r->bad || count > left / item;
    if (r->bad)
        return NULL;
    const void *at = r->bytes.data + r->pos;
    r->pos += (size_t)count * item;
    return at;
}

bool remote_get(remote_record *r, void *data, size_t size) {
    const void *at = remote_get_array(r, 1, size);
    if (at)
        memcpy(data, at, size);
    return at != NULL;
}

const char *remote_get_text(remote_record *r) {
    uint32_t size;
    const char *text = remote_get(r, &size, sizeof(size)) ? remote_get_array(r, (uint64_t)size + 1, 1) : NULL;
    if (text && memchr(text, 0, (size_t)size + 1) == text + size)
        return text;
    r->bad = true;
    return "";
}

bool remote_pass(int fd, void *data, size_t size, bool out) {
    for (char *p = data; size;) {
        ssize_t n = out ? send(fd, p, size, MSG_NOSIGNAL) : recv(fd, p, size, 0);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        p += n;
        size -= (size_t)n;
    }
    return true;
}

void remote_add(remote_record *batch, uint32_t kind, remote_record *r) {
    remote_head head = { kind, (uint32_t)((uint64_t)r->bytes.len >> 32), (uint32_t)r->bytes.len };
    remote_put(batch, &head, sizeof(head));
    remote_put(batch, r->bytes.data, r->bytes.len);
    batch->refused = batch->refused || r->refused;
    r->bytes.len = 0;
}

bool remote_send(int fd, remote_record *batch) {
    bool sent = remote_pass(fd, batch->bytes.data, batch->bytes.len, true);
    batch->bytes.len = 0;
    return sent;
}
