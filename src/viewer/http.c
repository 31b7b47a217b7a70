/* The page's files by HTTP: those that are packed into the program, by their names, and nothing else. */
#include "viewer/page.h"
#include "viewer/serve.h"

#include <stdio.h>
#include <string.h>

enum { PIECE = 16384, HEADERS = 2048 };

static const page_file *find(const char *path) {
    const char *name = *path == '/' && !path[1] ? "index.html" : *path == '/' ? path + 1 : "";
    for (const page_file *file = page_files; file->name; file++)
        if (!strcmp(file->name, name))
            return file;
    return NULL;
}

static bool add(struct lws *socket, const char *name, const char *value, unsigned char **at, unsigned char *end) {
    return !lws_add_http_header_by_name(socket, (const unsigned char *)name, (const unsigned char *)value,
                                        (int)strlen(value), at, end);
}

/* What a browser may do with the page. Its socket is named for browsers that do not count one as 'self'. */
static bool add_rules(struct lws *socket, unsigned char **at, unsigned char *end) {
    char host[300], rules[640];
    if (lws_hdr_copy(socket, host, sizeof(host), WSI_TOKEN_HOST) <= 0)
        return false;
    snprintf(rules, sizeof(rules),
             "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
             "connect-src 'self' ws://%s; manifest-src 'self'; base-uri 'none'; form-action 'none'; "
             "frame-ancestors 'none'",
             host);
    return add(socket, "content-security-policy:", rules, at, end) &&
           add(socket, "x-content-type-options:", "nosniff", at, end) &&
           add(socket, "cache-control:", "no-store", at, end) &&
           add(socket, "referrer-policy:", "no-referrer", at, end) &&
           add(socket, "cross-origin-opener-policy:", "same-origin", at, end) &&
           add(socket, "cross-origin-resource-policy:", "same-origin", at, end);
}

/* -1: the connection is to be closed. */
static int begin(struct lws *socket, http_request *request, const page_file *file) {
    unsigned char buffer[LWS_PRE + HEADERS], *from = buffer + LWS_PRE, *at = from, *end = buffer + sizeof(buffer) - 1;
    if (lws_add_http_common_headers(socket, HTTP_STATUS_OK, file->type, file->size, &at, end) ||
        !add_rules(socket, &at, end) || lws_finalize_write_http_header(socket, from, &at, end))
        return -1;
    *request = (http_request){ file->data, file->size };
    lws_callback_on_writable(socket);
    return 0;
}

static int next(struct lws *socket, http_request *request) {
    unsigned char buffer[LWS_PRE + PIECE];
    size_t n = request->left < PIECE ? request->left : PIECE;
    if (!request->data)
        return 0;
    memcpy(buffer + LWS_PRE, request->data, n);
    bool last = n == request->left;
    if (lws_write(socket, buffer + LWS_PRE, n, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) != (int)n)
        return -1;
    request->data += n;
    request->left -= n;
    if (!last)
        lws_callback_on_writable(socket);
    else
        request->data = NULL;
    return last && lws_http_transaction_completed(socket) ? -1 : 0;
}

/* A status without a body to speak of. */
static int say(struct lws *socket, unsigned status) {
    return lws_return_http_status(socket, status, NULL) || lws_http_transaction_completed(socket) ? -1 : 0;
}

int http_callback(struct lws *socket, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    const server *s = lws_context_user(lws_get_context(socket));
    if (reason == LWS_CALLBACK_HTTP_WRITEABLE)
        return next(socket, user);
    if (!lws_hdr_total_length(socket, WSI_TOKEN_GET_URI))
        return say(socket, HTTP_STATUS_METHOD_NOT_ALLOWED);
    if (guard_has_body(socket)) /* which would be read as the next request */
        return say(socket, HTTP_STATUS_BAD_REQUEST), -1;
    if (!guard_host(s, socket))
        return say(socket, HTTP_STATUS_FORBIDDEN);
    const page_file *file = find(in);
    return file ? begin(socket, user, file) : say(socket, HTTP_STATUS_NOT_FOUND);
}
