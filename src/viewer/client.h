/* client: one connection: what it may send, and what waits to be sent to it. Used by the service thread alone, but for
 * its outbox. */
#ifndef NOC_VIEWER_CLIENT_H
#define NOC_VIEWER_CLIENT_H

#include "viewer/outbox.h"
#include "viewer/session.h"

/* What a client may send, from second to second and at once. A page sends some 60 inputs and 60 acknowledgements a
 * second. */
#define CLIENT_MESSAGES 400  /* a second */
#define CLIENT_BYTES 200000  /* a second */
#define CLIENT_AT_ONCE 3     /* seconds' worth of them */
#define CLIENT_SILENCE 20    /* s that it may not read */
#define CLIENT_IDLE 20       /* s without a message after which another may have its place */
#define CLIENT_REPLACED 4000 /* the code that it is closed with then */

typedef struct client client;
struct lws;

/* The client of that connection, with a session of its own, at that time. wake: something is to be sent, from any
 * thread. NULL: no memory. */
client *client_create(struct lws *socket, double now, const session_setup *setup, void (*wake)(void *), void *user);
/* After its session has ended, which this waits for. */
void client_destroy(client *c);
/* The connection is gone: asks the session to end, and does not wait. */
void client_leave(client *c);
/* The connection is to be closed with that code of RFC 6455, or CLIENT_REPLACED: another has its place. The first code
 * stays. why is copied. */
void client_close(client *c, int code, const char *why);
int client_closing(const client *c, const char **why); /* that code, 0 while it stays; why may be NULL */

struct lws *client_socket(const client *c); /* NULL once it has left */
session *client_session(const client *c);
outbox *client_outbox(const client *c);

/* A piece of a message; last: it is its end. What may not be sent closes the connection. */
void client_receive(client *c, const void *data, size_t size, bool binary, bool last, double now);

/* When its last message came, or it did: pongs and pings are none. */
double client_spoke(const client *c);

/* A piece of a message, or what else counts as one, has come. false: more than may, and the connection is to be
 * closed. */
bool client_counts(client *c, size_t size, double now);
/* So many bytes have come over its connection in all: those of pings and of heads of frames, too. false: more than may,
 * and it is to be closed. */
bool client_heard(client *c, uint64_t bytes, double now);

/* Called before and after each message to the client; and now and then: has it not read for too long? */
void client_asked(client *c, double now);
void client_written(client *c, double now);
bool client_stuck(const client *c, double now);

#endif
