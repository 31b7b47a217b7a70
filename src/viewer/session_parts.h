/* What the files of a session share. */
#ifndef NOC_VIEWER_SESSION_PARTS_H
#define NOC_VIEWER_SESSION_PARTS_H

#include "viewer/ask.h"
#include "viewer/inbox.h"
#include "viewer/mover.h"
#include "viewer/out.h"
#include "viewer/pace.h"
#include "viewer/panes.h"
#include "viewer/session.h"

#include <stdatomic.h>

struct session {
    const session_setup *setup;
    outbox *box;
    inbox in;
    pthread_t thread;
    bool started, joined;
    atomic_bool over; /* its thread has ended */
    /* of its thread alone */
    mover mover;
    panes panes;
    pace pace;
    int width, height;       /* of a pane's picture; 0: not told yet */
    uint32_t input;          /* the newest message with a number that was done */
    double moved;            /* when something last changed */
    double sent[WIRE_PANES]; /* when a picture of a pane at rest went out last */
    int redraw;              /* 0, or 1 + panes_need: all panes are to be shown again */
    bool rested;             /* the last pictures are out: nothing is to be done */
    bool missed;             /* a pane at rest got none of them, for the client was slow to show its pictures */
    int resting;             /* level of the pictures at rest so far */
    uint64_t version, told;  /* of the world: that pictures show, that the page knows */
    uint32_t shown;          /* the newest input that a picture shows, if only one pane's */
    uint32_t notes;
    bool began;     /* a first picture was made */
    bool travels;   /* its camera is on its way, though the hand rests */
    bool behind;    /* messages took so long that a picture comes first, whatever else waits */
    bool told_less; /* something was set that the client has not been told */
    asker *asker;   /* NULL until it is asked */
    asker *namer;   /* of names, which wait for no ranking; NULL until it is asked */
};

double session_now(void);
double session_aspect(const session *s);
/* One message, in the session's thread. */
void session_do(session *s, const wire_message *message);
/* session_save.c: a pane as it is said again; and a file that the client asks for. false, with why: it gets none. */
out_view session_view(const session *s, int which);
bool session_save(session *s, const wire_message *message, char *why, size_t size);
void session_note(session *s, const char *level, const char *text);
void session_tell_welcome(session *s);
void session_tell_state(session *s);
/* Sees to it that a pane has a frame of its whole size, for its file. false: it was broken off. */
bool session_complete(session *s, int which);
/* Something has changed: panes have frames to render, those whose last one failed, too. */
void session_wake(session *s);
/* What pictures show has changed. */
void session_changed(session *s);
/* Does what is to be done next; seconds to wait until there is more to do, 0: at once. */
double session_step(session *s);

#endif
