/* session: one client's pictures: its camera, its looks, its panes. A thread of its own renders, encodes and publishes;
 * other threads hand it messages. */
#ifndef NOC_VIEWER_SESSION_H
#define NOC_VIEWER_SESSION_H

#include "viewer/outbox.h"
#include "viewer/viewer.h"
#include "viewer/wire.h"
#include "viewer/look.h"
#include "viewer/world.h"

#include <stdatomic.h>

/* What sessions share. */
typedef struct session_setup {
    viewer_world *world;
    const viewer_source *source;
    noc_log *log;
    atomic_bool *lit; /* somebody has had a picture by the city's lights: their structures are there */
} session_setup;

typedef struct session session;

/* Publishes to the outbox, which outlasts it. NULL: no memory, or no thread. */
session *session_create(const session_setup *setup, outbox *box);
/* Takes a message, to be done in order; it is the session's then. false: more wait than may. */
bool session_take(session *s, wire_message *message);
void session_end(session *s);         /* asks it to end, and does not wait */
bool session_ended(const session *s); /* it has: the following do not wait */
void session_join(session *s);        /* ends it, and waits until its threads have ended */
void session_destroy(session *s);     /* the same, and frees it; NULL is allowed */

#endif
