/* Serves the page, and pictures over WebSockets. All of libwebsockets is called by one thread, that of viewer_run;
 * others wake it. */
#include "viewer/serve.h"

#include <linux/tcp.h>
#include <malloc.h>
#include <netinet/in.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define LARGE (1 << 20) /* bytes: buffers of pictures */
#define CLOSE_S 2       /* s that a connection which is to be closed has to read what was sent */
#define LOOK_US 100000  /* how often it looks whether it is to end, and after clients */

#define TEXT_OF(x) #x
#define NUMBER(x) TEXT_OF(x)
const char *viewer_features(void) {
    return "libwebsockets " NUMBER(LWS_LIBRARY_VERSION_MAJOR) "." NUMBER(LWS_LIBRARY_VERSION_MINOR) "." NUMBER(
        LWS_LIBRARY_VERSION_PATCH);
}

double serve_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void serve_say(const server *s, noc_log_level level, const char *fmt, ...) {
    char text[512];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    s->params->say(s->params->user, level, text);
}

/* ---- clients ---- */

static void wake(void *user) { lws_cancel_service(((server *)user)->context); }

/* Those that have left, and whose sessions have ended. */
static void collect(server *s) {
    bool gone = false;
    for (int i = 0; i < 2 * SERVE_CLIENTS; i++) {
        client *c = s->clients[i];
        if (c && !client_socket(c) && session_ended(client_session(c))) {
            client_destroy(c);
            s->clients[i] = NULL;
            s->held--;
            gone = true;
        }
    }
#ifdef __GLIBC__
    if (gone)
        malloc_trim(0); /* what they had was in arenas of threads that have ended */
#endif
    (void)gone;
}

static client *enter(server *s, struct lws *socket) {
    int i = 0;
    while (i < 2 * SERVE_CLIENTS && s->clients[i])
        i++;
    if (i == 2 * SERVE_CLIENTS)
        return NULL;
    s->clients[i] = client_create(socket, serve_now(), &s->setup, wake, s);
    s->connected += s->clients[i] != NULL;
    s->held += s->clients[i] != NULL;
    return s->clients[i];
}

/* Closes a connection with the code of its client once what lws holds for it is sent: closed at once, with -1 from a
 * callback, it would end without a close frame where a message is still on its way. One that does not read is not
 * waited for. */
static void close_soon(struct lws *socket) {
    lws_callback_on_writable(socket);
    lws_set_timeout(socket, PENDING_TIMEOUT_USER_OK, CLOSE_S);
}

/* Where all places are taken: closes the client that was idle longest, and its place is free at once. */
static void make_room(server *s) {
    client *idle = NULL;
    double before = serve_now() - CLIENT_IDLE;
    for (int i = 0; s->connected == s->params->clients && i < 2 * SERVE_CLIENTS; i++) {
        client *c = s->clients[i];
        if (c && client_socket(c) && !client_closing(c, NULL) && client_spoke(c) < before) {
            before = client_spoke(c);
            idle = c;
        }
    }
    if (!idle)
        return;
    client_close(idle, CLIENT_REPLACED, "another has this place: nothing was done here for a while");
    s->connected--;
    close_soon(client_socket(idle));
}

/* Bytes that came over a connection. */
static uint64_t heard(struct lws *socket) {
    struct tcp_info info = { 0 };
    socklen_t size = sizeof(info);
    return getsockopt(lws_get_socket_fd(socket), IPPROTO_TCP, TCP_INFO, &info, &size) ? 0 : info.tcpi_bytes_received;
}

static void attend(server *s) {
    double now = serve_now();
    for (int i = 0; i < 2 * SERVE_CLIENTS; i++) {
        client *c = s->clients[i];
        struct lws *socket = c ? client_socket(c) : NULL;
        if (!socket)
            continue;
        if (outbox_broken(client_outbox(c)) || client_stuck(c, now) || !client_heard(c, heard(socket), now)) {
            lws_set_timeout(socket, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
        } else if (outbox_pending(client_outbox(c))) {
            client_asked(c, now);
            lws_callback_on_writable(socket);
        }
    }
    collect(s);
}

/* Sends that code and reason as a close frame, and closes: what the callback of a writable connection returns then. */
static int close_with(struct lws *socket, int code, const char *why) {
    unsigned char text[124];
    int n = snprintf((char *)text, sizeof(text), "%s", why);
    lws_close_reason(socket, (enum lws_close_status)code, text, n < (int)sizeof(text) ? (size_t)n : sizeof(text) - 1);
    return -1;
}

static int send_next(struct lws *socket, client *c) {
    outbox_message message;
    const char *why;
    int code = client_closing(c, &why);
    if (code)
        return close_with(socket, code, why);
    if (!outbox_take(client_outbox(c), serve_now(), &message))
        return 0;
    int sent =
        lws_write(socket, message.data + OUTBOX_ROOM, message.size, message.text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY);
    free(message.data);
    client_written(c, serve_now());
    if (outbox_pending(client_outbox(c)))
        lws_callback_on_writable(socket);
    return sent < (int)message.size ? -1 : 0;
}

static int receive(struct lws *socket, client *c, const void *in, size_t size) {
    bool closing = client_closing(c, NULL);
    bool last = lws_is_final_fragment(socket) && !lws_remaining_packet_payload(socket);
    client_receive(c, in, size, lws_frame_is_binary(socket), last, serve_now());
    if (!closing && client_closing(c, NULL))
        close_soon(socket);
    return 0;
}

/* One that was asked for or not: it counts as a message. */
static int receive_pong(struct lws *socket, client *c, size_t size) {
    bool closing = client_closing(c, NULL);
    if (!client_counts(c, size, serve_now()) && !closing)
        close_soon(socket);
    return 0;
}

/* ---- what libwebsockets tells ---- */

/* What it keeps for a connection. */
typedef struct connection {
    http_request request;
    client *client;
} connection;

static int refuse_upgrade(server *s, struct lws *socket, const char *to) {
    int status = to && !strcasecmp(to, "websocket") ? guard_upgrade(s, socket) : HTTP_STATUS_BAD_REQUEST;
    if (!status)
        make_room(s);
    if (!status && (s->connected >= s->params->clients || s->held >= 2 * s->params->clients))
        status = HTTP_STATUS_SERVICE_UNAVAILABLE;
    if (!status)
        return 0;
    lws_return_http_status(socket, (unsigned)status, NULL);
    return 1;
}

static void forget_waiting(server *s, const struct lws *socket) {
    int kept = 0;
    for (int i = 0; i < s->waiting_count; i++)
        if (s->waiting[i] != socket)
            s->waiting[kept++] = s->waiting[i];
    s->waiting_count = kept;
}

/* It has just done something. Where too many wait, the one that was idle longest is closed. */
static void note_waiting(server *s, struct lws *socket) {
    forget_waiting(s, socket);
    if (s->waiting_count == SERVE_WAITING) {
        lws_set_timeout(s->waiting[0], PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
        forget_waiting(s, s->waiting[0]);
    }
    s->waiting[s->waiting_count++] = socket;
}

/* Connections that wait for us; beyond what it can hold they are closed. What is sent goes at once: a small message
 * would hold up the next one until the other side has said that it came, 40 ms later. */
static int accept_all(server *s) {
    int on = 1;
    for (int i = 0; i < SERVE_ACCEPTED; i++) {
        int fd = accept4(s->listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (fd < 0)
            break;
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
        struct lws *socket = lws_adopt_socket_vhost(s->host, fd);
        if (socket)
            note_waiting(s, socket);
    }
    return 0;
}

static int callback(struct lws *socket, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    server *s = lws_context_user(lws_get_context(socket));
    connection *c = user;
    switch (reason) {
    case LWS_CALLBACK_RAW_RX_FILE: return accept_all(s);
    case LWS_CALLBACK_HTTP:
    case LWS_CALLBACK_HTTP_WRITEABLE:
        note_waiting(s, socket);
        return http_callback(socket, reason, &c->request, in, size);
    case LWS_CALLBACK_WSI_DESTROY: forget_waiting(s, socket); return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE: return refuse_upgrade(s, socket, in);
    case LWS_CALLBACK_ESTABLISHED: forget_waiting(s, socket); return (c->client = enter(s, socket)) ? 0 : -1;
    case LWS_CALLBACK_RECEIVE: return c->client ? receive(socket, c->client, in, size) : -1;
    case LWS_CALLBACK_RECEIVE_PONG: return c->client ? receive_pong(socket, c->client, size) : -1;
    case LWS_CALLBACK_SERVER_WRITEABLE: return c->client ? send_next(socket, c->client) : -1;
    case LWS_CALLBACK_CLOSED:
        if (c->client) {
            client_leave(c->client);
            s->connected -= client_closing(c->client, NULL) != CLIENT_REPLACED;
        }
        c->client = NULL;
        return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: attend(s); return 0;
    /* Files, scripts and the like that lws could serve by itself: none. */
    default: return 0;
    }
}

static void on_timer(lws_sorted_usec_list_t *timer) {
    server *s = lws_container_of(timer, server, timer);
    s->failed = s->failed || world_failed(s->setup.world);
    s->ended = s->ended || s->failed || s->params->ended(s->params->user);
    attend(s);
    lws_sul_schedule(s->context, 0, &s->timer, on_timer, LOOK_US);
    if (s->ended)
        lws_cancel_service(s->context);
}

static bool start(server *s) {
    static const struct lws_protocols protocols[] = {
        { "http", callback, sizeof(connection), 4096, 0, NULL, 0 },
        { "nocturne-1", callback, sizeof(connection), 4096, 0, NULL, 0 },
        { NULL, NULL, 0, 0, 0, NULL, 0 },
    };
    /* A connection that says nothing for so long is asked, and closed when it says nothing to that. */
    static const lws_retry_bo_t alive = { .secs_since_valid_ping = 20, .secs_since_valid_hangup = 40 };
    lws_set_log_level(0, NULL);
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = protocols,
        .user = s,
        .options =
            LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8 | LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS,
        .fd_limit_per_thread = 2 * SERVE_CLIENTS + 2 * SERVE_HEADS,
        .max_http_header_pool = SERVE_HEADS,
        .max_http_header_data = 4096,
        .timeout_secs = 10,
        .keepalive_timeout = 10,
        .retry_and_idle_policy = &alive,
        .vhost_name = "nocturne",
        .gid = (gid_t)-1,
        .uid = (uid_t)-1,
    };
    s->context = lws_create_context(&info);
    s->host = s->context ? lws_create_vhost(s->context, &info) : NULL;
    lws_sock_file_fd_type fd = { .filefd = s->listener };
    if (!s->host || !lws_adopt_descriptor_vhost(s->host, LWS_ADOPT_RAW_FILE_DESC, fd, "http", NULL))
        return false;
    lws_sul_schedule(s->context, 0, &s->timer, on_timer, LOOK_US);
    return true;
}

/* Sessions first: their threads wake the context. */
static void stop(server *s) {
    for (int i = 0; i < 2 * SERVE_CLIENTS; i++)
        if (s->clients[i])
            session_end(client_session(s->clients[i]));
    for (int i = 0; i < 2 * SERVE_CLIENTS; i++)
        if (s->clients[i])
            session_join(client_session(s->clients[i]));
    if (s->context)
        lws_context_destroy(s->context);
    for (int i = 0; i < 2 * SERVE_CLIENTS; i++)
        if (s->clients[i])
            client_destroy(s->clients[i]);
}

static void tell_link(const server *s) {
    char link[512];
    guard_link(s, link, sizeof(link));
    if (!s->loopback)
        serve_say(s, NOC_LOG_WARN,
                  "others can reach %.80s: the link is all that keeps them out, and nothing is encrypted",
                  s->params->address);
    s->params->listening(s->params->user, link);
}

noc_status viewer_run(const viewer_source *source, const viewer_params *params, noc_log *log) {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, LARGE); /* and it stays: what is large goes back when it is freed */
#endif
    server *s = calloc(1, sizeof(*s));
    if (!s)
        return NOC_ERR_MEMORY;
    s->params = params;
    s->listener = -1;
    noc_status status = guard_listen(s);
    if (!status && !guard_make_token(s))
        status = NOC_ERR_IO;
    s->setup = (session_setup){ .source = source, .log = log, .lit = &s->lit };
    s->setup.world = status ? NULL : world_create(source, log);
    if (!status && (!s->setup.world || !start(s)))
        status = NOC_ERR_MEMORY;
    if (!status)
        tell_link(s);
    while (!status && !s->ended && lws_service(s->context, 0) >= 0)
        continue;
    status = s->failed ? NOC_ERR_FORMAT : status;
    stop(s);
    world_destroy(s->setup.world);
    free(s);
    return status;
}
