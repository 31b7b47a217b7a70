#include "viewer/client.h"
#include "viewer/wire.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Codes of RFC 6455, 7.4.1 */
enum { NO_TEXT = 1003, POLICY = 1008, TOO_BIG = 1009 };

struct client {
    struct lws *socket;
    outbox *box;
    session *session;
    double messages, bytes; /* that it may send now */
    double counted;         /* when those were counted */
    double spoke;           /* when the last one came */
    bool begun;
    uint64_t heard; /* bytes of the connection that were counted */
    double room;    /* bytes of it that may come */
    double since;   /* when that was counted; 0: never */
    double asked;   /* since when something waits for it to read; 0: nothing does */
    int closing;    /* the code that it is to be closed with; 0: it stays */
    char why[124];  /* as much as a close frame holds */
    size_t size;    /* of the message so far */
    char text[WIRE_TEXT];
};

client *client_create(struct lws *socket, double now, const session_setup *setup, void (*wake)(void *), void *user) {
    client *c = calloc(1, sizeof(*c));
    if (!c)
        return NULL;
    c->socket = socket;
    c->spoke = now;
    c->box = outbox_create(wake, user);
    c->session = c->box ? session_create(setup, c->box) : NULL;
    if (c->session)
        return c;
    outbox_destroy(c->box);
    free(c);
    return NULL;
}

void client_destroy(client *c) {
    session_destroy(c->session);
    outbox_destroy(c->box);
    free(c);
}

void client_leave(client *c) {
    c->socket = NULL;
    session_end(c->session);
}

void client_close(client *c, int code, const char *why) {
    if (c->closing)
        return;
    c->closing = code;
    snprintf(c->why, sizeof(c->why), "%s", why);
}

int client_closing(const client *c, const char **why) {
    if (why)
        *why = c->why;
    return c->closing;
}

struct lws *client_socket(const client *c) {
    return c->socket;
}
session *client_session(const client *c) { return c->session; }
outbox *client_outbox(const client *c) { return c->box; }

bool client_counts(client *c, size_t size, double now) {
    double spent = c->begun ? now - c->counted : CLIENT_AT_ONCE;
    c->begun = true;
    c->counted = now;
    c->messages += spent * CLIENT_MESSAGES;
    c->bytes += spent * CLIENT_BYTES;
    c->messages = c->messages < CLIENT_AT_ONCE * CLIENT_MESSAGES ? c->messages : CLIENT_AT_ONCE * CLIENT_MESSAGES;
    c->bytes = c->bytes < CLIENT_AT_ONCE * CLIENT_BYTES ? c->bytes : CLIENT_AT_ONCE * CLIENT_BYTES;
    c->messages -= 1;
    c->bytes -= (double)size;
    if (c->messages >= 0 && c->bytes >= 0)
        return true;
    client_close(c, POLICY, "too many messages, or bytes, in a second");
    return false;
}

static void take(client *c) {
    wire_message message;
    char why[sizeof(c->why)];
    bool read = wire_read(c->text, c->size, &message, why, sizeof(why));
    c->size = 0;
    if (!read)
        client_close(c, POLICY, why);
    else if (!session_take(c->session, &message))
        client_close(c, POLICY, "more messages wait than may");
}

void client_receive(client *c, const void *data, size_t size, bool binary, bool last, double now) {
    c->spoke = now;
    if (c->closing || !client_counts(c, size, now)) /* pieces count, so that empty ones are no way around it */
        return;
    if (binary) {
        client_close(c, NO_TEXT, "a binary message");
        return;
    }
    if (size > sizeof(c->text) - c->size) {
        client_close(c, TOO_BIG, "the message is too long");
        return;
    }
    memcpy(c->text + c->size, data, size);
    c->size += size;
    if (last)
        take(c);
}

double client_spoke(const client *c) { return c->spoke; }

bool client_heard(client *c, uint64_t bytes, double now) {
    /* a message of a byte has a head of six, and what came before it was looked at first is no flood */
    static const double rate = CLIENT_BYTES + 16.0 * CLIENT_MESSAGES, most = rate * (CLIENT_AT_ONCE + 1);
    c->room = c->since > 0 ? fmin(most, c->room + (now - c->since) * rate) : most;
    c->since = now;
    c->room -= (double)(bytes - c->heard);
    c->heard = bytes;
    return c->room >= 0;
}

void client_asked(client *c, double now) { c->asked = c->asked > 0 ? c->asked : now; }
void client_written(client *c, double now) { c->asked = outbox_pending(c->box) ? now : 0; }
bool client_stuck(const client *c, double now) { return c->asked > 0 && now - c->asked > CLIENT_SILENCE; }
