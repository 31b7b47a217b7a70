/* ask: questions of one client: who lights this, what is this lamp, all lights of the map. A thread beside the pictures
 * answers them one after the other, each better and better until it is good; none holds a picture up. */
#ifndef NOC_VIEWER_ASK_H
#define NOC_VIEWER_ASK_H

#include "viewer/inbox.h"
#include "viewer/outbox.h"
#include "viewer/viewer.h"
#include "viewer/wire.h"
#include "viewer/world.h"

typedef struct asker asker;

/* What a question is asked of: the picture that the client sees. */
typedef struct ask_view {
    noc_camera camera;
    int width, height;
    noc_render_params render; /* of its look: what lights beside the lamps */
} ask_view;

/* NULL: no memory, or no thread. */
asker *asker_create(const viewer_source *source, viewer_world *world, outbox *box, inbox *in);
void asker_destroy(asker *a); /* ends it and waits; NULL is allowed */
/* Takes a question; the oldest that waits is refused where there are too many. */
void asker_ask(asker *a, const wire_ask *ask, const ask_view *view);
void asker_cancel(asker *a, uint32_t id);
/* The rows of a question that was answered, as CSV with a head of names; free() it. NULL: it is not known any more. */
char *asker_csv(asker *a, uint32_t id);

#endif
