/* inbox: messages of a client that its session has not done yet, in their order. Inputs of the same keys become one,
 * and of cameras that follow each other the newest is left, so that what is behind catches up at once. */
#ifndef NOC_VIEWER_INBOX_H
#define NOC_VIEWER_INBOX_H

#include "viewer/wire.h"

#include <pthread.h>

enum { INBOX_MOST = 1024 };

typedef struct inbox {
    pthread_mutex_t mutex;
    pthread_cond_t changed; /* also by who wakes its reader for other things */
    wire_message *waiting[INBOX_MOST];
    int count;
    unsigned wakes; /* so many times it was woken */
    bool ended, hidden;
} inbox;

void inbox_init(inbox *in);
void inbox_finish(inbox *in);
/* Takes the message. false: more wait than may, or there is no memory. */
bool inbox_put(inbox *in, wire_message *message);
/* The first one, which is the caller's to wire_free and free; NULL: there is none. */
wire_message *inbox_get(inbox *in);
/* Does one wait that a picture in work should not hold up, or does nobody look at it? */
bool inbox_hurries(inbox *in);
void inbox_end(inbox *in);
bool inbox_ended(inbox *in);
bool inbox_hidden(inbox *in);
void inbox_wake(inbox *in);
/* Waits until a message comes, it is woken since it had been `wakes` times, or so many seconds have passed. */
unsigned inbox_wait(inbox *in, unsigned wakes, double seconds);

#endif
