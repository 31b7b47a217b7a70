/* Who may have anything, and where it is listened. */
#include "viewer/serve.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

static bool is_loopback_v4(struct in_addr address) { return ntohl(address.s_addr) >> 24 == 127; }

static bool is_loopback(const struct sockaddr *address) {
    if (address->sa_family == AF_INET)
        return is_loopback_v4(((const struct sockaddr_in *)(const void *)address)->sin_addr);
    return IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)(const void *)address)->sin6_addr);
}

static int port_of(const struct sockaddr *address) {
    return ntohs(address->sa_family == AF_INET ? ((const struct sockaddr_in *)(const void *)address)->sin_port
                                               : ((const struct sockaddr_in6 *)(const void *)address)->sin6_port);
}

/* A socket that listens there; -1, with errno. */
static int listen_at(const struct addrinfo *at) {
    int fd = socket(at->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0), on = 1;
    if (fd < 0)
        return -1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    if (!bind(fd, at->ai_addr, at->ai_addrlen) && !listen(fd, 32))
        return fd;
    int why = errno;
    close(fd);
    errno = why;
    return -1;
}

noc_status guard_listen(server *s) {
    const char *address = s->params->address;
    struct addrinfo hints = { .ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE | AI_NUMERICSERV }, *found = NULL;
    char port[16];
    snprintf(port, sizeof(port), "%d", s->params->port);
    int wrong = getaddrinfo(address, port, &hints, &found);
    if (wrong) {
        serve_say(s, NOC_LOG_ERROR, "--address: \"%.80s\" is no address of this machine: %s", address,
                  gai_strerror(wrong));
        return NOC_ERR_IO;
    }
    s->listener = listen_at(found);
    s->loopback = is_loopback(found->ai_addr);
    int why = errno;
    freeaddrinfo(found);
    if (s->listener < 0) {
        serve_say(s, NOC_LOG_ERROR, "cannot listen at %.80s, port %d: %s%s", address, s->params->port, strerror(why),
                  why == EADDRINUSE ? "; --port 0 takes one that is free" : "");
        return NOC_ERR_IO;
    }
    struct sockaddr_storage name;
    socklen_t size = sizeof(name);
    if (!getsockname(s->listener, (struct sockaddr *)&name, &size))
        s->port = port_of((struct sockaddr *)&name);
    if (gethostname(s->host_name, sizeof(s->host_name) - 1))
        *s->host_name = 0;
    return NOC_OK;
}

bool guard_make_token(server *s) {
    static const char digits[] = "0123456789abcdef";
    unsigned char bytes[16];
    if (s->params->token) {
        snprintf(s->token, sizeof(s->token), "%s", s->params->token);
        return true;
    }
    for (size_t got = 0; got < sizeof(bytes);) {
        ssize_t n = getrandom(bytes + got, sizeof(bytes) - got, 0);
        if (n < 0 && errno != EINTR)
            return false;
        got += n > 0 ? (size_t)n : 0;
    }
    for (size_t i = 0; i < sizeof(bytes); i++) {
        s->token[2 * i] = digits[bytes[i] >> 4];
        s->token[2 * i + 1] = digits[bytes[i] & 15];
    }
    s->token[2 * sizeof(bytes)] = 0;
    return true;
}

void guard_link(const server *s, char *link, size_t size) {
    const char *address = s->params->address;
    bool any = !strcmp(address, "0.0.0.0") || !strcmp(address, "::");
    const char *name = any && *s->host_name ? s->host_name : address;
    bool v6 = strchr(name, ':') != NULL;
    snprintf(link, size, "http://%s%s%s:%d/#token=%s", v6 ? "[" : "", name, v6 ? "]" : "", s->port, s->token);
}

bool guard_same(const char *a, const char *b) {
    size_t n = strlen(a), m = strlen(b);
    unsigned char differ = n != m;
    for (size_t i = 0; i < m; i++)
        differ |= (unsigned char)(a[n ? i % n : 0] ^ b[i]);
    return !differ;
}

/* The name in "NAME", "NAME:PORT", "[ADDRESS]:PORT", without the brackets. */
static bool name_in(const char *host, char *name, size_t size, bool *v6) {
    *v6 = *host == '[';
    const char *from = host + *v6, *end = strchr(from, *v6 ? ']' : ':');
    size_t n = end ? (size_t)(end - from) : strlen(from);
    if (!n || n >= size || (*v6 && !end))
        return false;
    memcpy(name, from, n);
    name[n] = 0;
    const char *rest = end ? end + *v6 : from + n;
    return !*rest || (*rest == ':' && rest[1] && strspn(rest + 1, "0123456789") == strlen(rest + 1));
}

/* A name can be pointed at any machine by who owns it; a number, and "localhost", cannot. */
static bool is_ours(const server *s, const char *host) {
    char name[256];
    bool v6;
    struct in6_addr six;
    struct in_addr four;
    if (!name_in(host, name, sizeof(name), &v6))
        return false;
    if (v6)
        return inet_pton(AF_INET6, name, &six) == 1 && (!s->loopback || IN6_IS_ADDR_LOOPBACK(&six));
    if (inet_pton(AF_INET, name, &four) == 1)
        return !s->loopback || is_loopback_v4(four);
    if (!strcasecmp(name, "localhost") || !strcasecmp(name, s->params->address))
        return true;
    return !s->loopback && *s->host_name && !strcasecmp(name, s->host_name);
}

bool guard_host(const server *s, struct lws *socket) {
    char host[300];
    int n = lws_hdr_copy(socket, host, sizeof(host), WSI_TOKEN_HOST);
    return n > 0 && strlen(host) == (size_t)n && is_ours(s, host);
}

/* A page of another site may open a WebSocket to us: it is the browser that says from where. */
static bool same_origin(struct lws *socket) {
    char host[300], origin[320];
    int n = lws_hdr_copy(socket, origin, sizeof(origin), WSI_TOKEN_ORIGIN);
    if (n <= 0 || lws_hdr_copy(socket, host, sizeof(host), WSI_TOKEN_HOST) <= 0)
        return false;
    const char *from = !strncasecmp(origin, "http://", 7)    ? origin + 7
                       : !strncasecmp(origin, "https://", 8) ? origin + 8
                                                             : "";
    return strlen(origin) == (size_t)n && !strcasecmp(from, host);
}

bool guard_has_body(struct lws *socket) {
    return lws_hdr_total_length(socket, WSI_TOKEN_HTTP_CONTENT_LENGTH) ||
           lws_hdr_total_length(socket, WSI_TOKEN_HTTP_TRANSFER_ENCODING);
}

int guard_upgrade(const server *s, struct lws *socket) {
    char text[SERVE_TOKEN + 2];
    if (guard_has_body(socket))
        return HTTP_STATUS_BAD_REQUEST;
    if (lws_hdr_copy(socket, text, sizeof(text), WSI_TOKEN_GET_URI) <= 0 || strcmp(text, "/ws"))
        return HTTP_STATUS_NOT_FOUND;
    if (!guard_host(s, socket) || !same_origin(socket))
        return HTTP_STATUS_FORBIDDEN;
    const char *token = lws_get_urlarg_by_name(socket, "token=", text, sizeof(text));
    if (!token || !guard_same(s->token, token))
        return HTTP_STATUS_FORBIDDEN;
    if (lws_hdr_copy(socket, text, sizeof(text), WSI_TOKEN_PROTOCOL) <= 0 || strcmp(text, "nocturne-1"))
        return HTTP_STATUS_BAD_REQUEST;
    return 0;
}
