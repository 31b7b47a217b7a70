/* outbox: what goes to one client. It cannot grow: of pictures it holds the newest of each pane, of texts that say the
 * same again the newest, and it breaks where a client makes it hold too much. Any thread may fill it. */
#ifndef NOC_VIEWER_OUTBOX_H
#define NOC_VIEWER_OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes before the data of a message, which are the socket's to write to. */
enum { OUTBOX_ROOM = 32 };

typedef struct outbox outbox;

/* What a text is about: a newer one about the same takes its place. */
typedef enum outbox_about { OUTBOX_LOADING, OUTBOX_WELCOME, OUTBOX_STATE, OUTBOX_ANSWER, OUTBOX_NOTE } outbox_about;

/* wake: something is to be sent; from any thread. NULL: no memory. */
outbox *outbox_create(void (*wake)(void *user), void *user);
void outbox_destroy(outbox *box);

/* Takes the text, of malloc; NULL, for no memory, breaks the outbox. id: of the question, or the note's. */
void outbox_text(outbox *box, outbox_about about, uint32_t id, char *text);
/* Takes a binary message of malloc, which begins OUTBOX_ROOM bytes behind data; size is without them. */
void outbox_binary(outbox *box, uint32_t id, unsigned char *data, size_t size);
/* The same of a pane's picture with that number, and the text that goes before it. One that was not sent yet is
 * overtaken. */
void outbox_picture(outbox *box, int pane, uint32_t number, unsigned char *data, size_t size, char *stats);

/* The picture was shown. */
void outbox_shown(outbox *box, int pane, uint32_t number);
/* Is a picture of that pane still waiting to be sent? For how long is one on its way that was not shown, s? */
bool outbox_holds(outbox *box, int pane);
double outbox_waits(outbox *box, int pane, double now);

typedef struct outbox_message {
    unsigned char *data; /* free() it; the message begins OUTBOX_ROOM bytes behind */
    size_t size;
    bool text;
} outbox_message;
/* The next to be sent; false: there is none now. */
bool outbox_take(outbox *box, double now, outbox_message *message);
bool outbox_pending(outbox *box); /* would it give one? */
bool outbox_broken(outbox *box);  /* the client is to be closed */

#endif
