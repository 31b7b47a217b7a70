/* serve: what its files share: the page by HTTP (http.c), the WebSocket (socket.c), and who may have either (guard.c).
 */
#ifndef NOC_VIEWER_SERVE_H
#define NOC_VIEWER_SERVE_H

#include "viewer/client.h"

#include <libwebsockets.h>

_Static_assert(OUTBOX_ROOM >= LWS_PRE, "libwebsockets writes before a message");

/* SERVE_HEADS: of requests, which libwebsockets reads at once. A connection has one from its begin on, so fewer may
 * wait: SERVE_ACCEPTED more can come before those that are closed for them are gone. */
enum { SERVE_CLIENTS = 64, SERVE_TOKEN = 128, SERVE_HEADS = 32, SERVE_ACCEPTED = 8 };
enum { SERVE_WAITING = SERVE_HEADS - SERVE_ACCEPTED };

typedef struct server {
    const viewer_params *params;
    session_setup setup;
    struct lws_context *context;
    struct lws_vhost *host;
    int listener, port;
    bool loopback;      /* the address is reached from this machine alone */
    bool ended, failed; /* it ends; the world could not be loaded */
    char token[SERVE_TOKEN + 1];
    char host_name[256];                /* of this machine */
    client *clients[2 * SERVE_CLIENTS]; /* those that have left are joined when they have ended; NULL where free */
    int connected, held;                /* clients; and with those that have left or are replaced */
    struct lws *waiting[SERVE_WAITING]; /* connections that are no clients, the one that was idle longest first */
    int waiting_count;
    lws_sorted_usec_list_t timer;
    atomic_bool lit; /* session_setup.lit; other threads write it, so it is apart from what this one reads */
} server;

double serve_now(void); /* s */
__attribute__((format(printf, 3, 4))) void serve_say(const server *s, noc_log_level level, const char *fmt, ...);

/* guard.c */
/* Listens at the address; NOC_ERR_IO after reporting. */
noc_status guard_listen(server *s);
bool guard_make_token(server *s);
void guard_link(const server *s, char *link, size_t size);
/* May who asks by these headers have anything? By Host, against names that are pointed at us (DNS rebinding). */
bool guard_host(const server *s, struct lws *socket);
/* Does more belong to its request than a head? */
bool guard_has_body(struct lws *socket);
/* May it have the WebSocket, if there is a place? 0, or a status of HTTP. */
int guard_upgrade(const server *s, struct lws *socket);
/* Are the texts equal? Takes as long wherever they differ. */
bool guard_same(const char *a, const char *b);

/* http.c: what lws tells of a connection that asks for files. */
int http_callback(struct lws *socket, enum lws_callback_reasons reason, void *user, void *in, size_t size);
typedef struct http_request {
    const unsigned char *data; /* what is left to be sent */
    size_t left;
} http_request;

#endif
