#include "viewer/outbox.h"
#include "viewer/wire.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define MOST_ITEMS 64          /* texts and files */
#define MOST_BYTES (64u << 20) /* of them */

typedef struct item {
    struct item *next;
    int about; /* outbox_about; -1: binary */
    uint32_t id;
    outbox_message message;
} item;

typedef struct held {
    outbox_message picture, stats; /* data is NULL where there is none */
    uint32_t number;
    bool flying; /* picture `flown` was sent and is not acknowledged */
    uint32_t flown;
    double since;
} held;

struct outbox {
    pthread_mutex_t mutex;
    void (*wake)(void *user);
    void *user;
    item *first;
    int items;
    size_t bytes;
    held panes[WIRE_PANES];
    int turn; /* the pane that is looked at first */
    bool broken;
};

outbox *outbox_create(void (*wake)(void *user), void *user) {
    outbox *box = calloc(1, sizeof(*box));
    if (!box)
        return NULL;
    pthread_mutex_init(&box->mutex, NULL);
    box->wake = wake;
    box->user = user;
    return box;
}

void outbox_destroy(outbox *box) {
    if (!box)
        return;
    while (box->first) {
        item *gone = box->first;
        box->first = gone->next;
        free(gone->message.data);
        free(gone);
    }
    for (int i = 0; i < WIRE_PANES; i++) {
        free(box->panes[i].picture.data);
        free(box->panes[i].stats.data);
    }
    pthread_mutex_destroy(&box->mutex);
    free(box);
}

/* With room before it. Takes the text. */
static outbox_message of_text(char *text) {
    size_t size = text ? strlen(text) : 0;
    outbox_message message = { text ? malloc(OUTBOX_ROOM + size + 1) : NULL, size, true };
    if (message.data)
        memcpy(message.data + OUTBOX_ROOM, text, size + 1);
    free(text);
    return message;
}

/* Under the lock. */
static item *find(outbox *box, int about, uint32_t id) {
    for (item *i = box->first; i; i = i->next)
        if (i->about == about && i->id == id)
            return i;
    item *added = calloc(1, sizeof(*added));
    item **end = &box->first;
    while (*end)
        end = &(*end)->next;
    if (added) {
        *added = (item){ .about = about, .id = id };
        *end = added;
        box->items++;
    }
    return added;
}

static void put(outbox *box, int about, uint32_t id, outbox_message message) {
    pthread_mutex_lock(&box->mutex);
    item *to = message.data ? find(box, about, id) : NULL;
    if (to) {
        box->bytes += message.size - to->message.size;
        free(to->message.data);
        to->message = message;
    } else {
        free(message.data);
    }
    box->broken = box->broken || !to || box->items > MOST_ITEMS || box->bytes > MOST_BYTES;
    pthread_mutex_unlock(&box->mutex);
    box->wake(box->user);
}

void outbox_text(outbox *box, outbox_about about, uint32_t id, char *text) { put(box, (int)about, id, of_text(text)); }

void outbox_binary(outbox *box, uint32_t id, unsigned char *data, size_t size) {
    put(box, -1, id, (outbox_message){ data, size, false });
}

void outbox_picture(outbox *box, int pane, uint32_t number, unsigned char *data, size_t size, char *stats) {
    outbox_message before = of_text(stats);
    pthread_mutex_lock(&box->mutex);
    held *h = &box->panes[pane];
    free(h->picture.data);
    free(h->stats.data);
    h->picture = (outbox_message){ data, size, false };
    h->stats = before;
    h->number = number;
    box->broken = box->broken || !data || !before.data;
    pthread_mutex_unlock(&box->mutex);
    box->wake(box->user);
}

void outbox_shown(outbox *box, int pane, uint32_t number) {
    pthread_mutex_lock(&box->mutex);
    held *h = &box->panes[pane];
    if (h->flying && h->flown == number)
        h->flying = false;
    bool more = h->picture.data && !h->flying;
    pthread_mutex_unlock(&box->mutex);
    if (more)
        box->wake(box->user);
}

bool outbox_holds(outbox *box, int pane) {
    pthread_mutex_lock(&box->mutex);
    bool holds = box->panes[pane].picture.data;
    pthread_mutex_unlock(&box->mutex);
    return holds;
}

double outbox_waits(outbox *box, int pane, double now) {
    pthread_mutex_lock(&box->mutex);
    double waits = box->panes[pane].flying ? now - box->panes[pane].since : 0;
    pthread_mutex_unlock(&box->mutex);
    return waits;
}

/* Under the lock: the pane whose picture, or text before it, is next; NULL: none. A picture follows its text at once.
 */
static held *next_pane(outbox *box) {
    for (int i = 0; i < WIRE_PANES; i++)
        if (box->panes[i].picture.data && !box->panes[i].stats.data && !box->panes[i].flying)
            return &box->panes[i];
    for (int i = 0; i < WIRE_PANES; i++) {
        held *h = &box->panes[(box->turn + i) % WIRE_PANES];
        if (h->picture.data && !h->flying)
            return h;
    }
    return NULL;
}

bool outbox_take(outbox *box, double now, outbox_message *message) {
    pthread_mutex_lock(&box->mutex);
    item *first = box->first;
    held *h = first ? NULL : next_pane(box);
    if (first) {
        *message = first->message;
        box->first = first->next;
        box->items--;
        box->bytes -= message->size;
        free(first);
    } else if (h && h->stats.data) {
        *message = h->stats;
        h->stats.data = NULL;
    } else if (h) {
        *message = h->picture;
        h->picture.data = NULL;
        h->flying = true;
        h->flown = h->number;
        h->since = now;
        box->turn = (int)(h - box->panes) + 1;
    }
    pthread_mutex_unlock(&box->mutex);
    return first || h;
}

bool outbox_pending(outbox *box) {
    pthread_mutex_lock(&box->mutex);
    bool pending = box->first || next_pane(box);
    pthread_mutex_unlock(&box->mutex);
    return pending;
}

bool outbox_broken(outbox *box) {
    pthread_mutex_lock(&box->mutex);
    bool broken = box->broken;
    pthread_mutex_unlock(&box->mutex);
    return broken;
}
