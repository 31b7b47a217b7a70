/* What the files of a client's questions share. */
#ifndef NOC_VIEWER_ASK_PARTS_H
#define NOC_VIEWER_ASK_PARTS_H

#include "viewer/ask.h"

#include <pthread.h>
#include <stdatomic.h>

#define ASK_PAVEMENT 4.0 /* m beside a carriageway that belong to its street */

enum { ASK_WAITING = 8, ASK_KEPT = 8, ASK_ROWS = 40 };

typedef struct question {
    uint32_t id;
    wire_ask ask;
    ask_view view;
    char text[]; /* what ask.object, street or text points at */
} question;

struct asker {
    const viewer_source *source;
    viewer_world *world;
    outbox *box;
    inbox *in; /* of its session: where it is told to go */
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    question *waiting[ASK_WAITING];
    int count;
    struct {
        uint32_t id;
        char *csv;    /* NULL: none */
    } kept[ASK_KEPT]; /* answers, a ring */
    int next;
    bool ended;
    atomic_bool stopped; /* the question that is being answered is not wanted any more */
    bool busy;
    uint32_t now; /* its id */
    /* of its thread alone */
    noc_log *log;
    noc_view *ask_view; /* for rays and rankings */
    char wrong[256];    /* what was reported last */
};

/* An answer {"t": "answer", "id", "done"} to be filled. */
json_t *ask_begin(const question *q, double done);
void ask_send(asker *a, const question *q, json_t *answer);
void ask_refuse(asker *a, const question *q, const char *why);
bool ask_stopped(const asker *a);
void ask_keep(asker *a, uint32_t id, char *csv); /* takes it */
json_t *ask_place(const double place[3]);
/* {"name", "place"} in the CRS that the user speaks; NULL where the scene has none. */
json_t *ask_crs(const asker *a, const double place[3]);
json_t *ask_number(double value); /* null where it is not finite */

/* ask_rank.c: pixel and region */
void ask_pixel(asker *a, const question *q);
void ask_region(asker *a, const question *q);
/* ask_map.c: lights and a photograph */
void ask_align(asker *a, const question *q);
void ask_lights(asker *a, const question *q);
const char *ask_light_kind(const noc_light_info *light); /* as the map calls it */
bool ask_of_building(uint8_t cls);
/* ask_lamp.c */
void ask_lamp(asker *a, const question *q);
/* ask_find.c: search by name, and names of what a pointer is over */
void ask_find(asker *a, const question *q);
void ask_name(asker *a, const question *q);
/* The highest surface there; false: none. */
bool ask_top(asker *a, const double at[2], noc_hit *hit);
/* Name of the street that the surface is of; NULL: of none. */
const char *ask_street_of(const asker *a, const noc_hit *hit);

#endif
