/* Messages to the viewer, as strangers send them, through its inbox: lines of the input are messages one after the
 * other. */
#include "fuzz.h"

#include "viewer/inbox.h"

#include <math.h>

static bool all_within(const double *v, int count, double most) {
    for (int i = 0; i < count; i++)
        if (!(fabs(v[i]) <= most))
            return false;
    return true;
}

static void check_camera(const wire_camera *c) {
    FUZZ_REQUIRE(c->name || (all_within(c->eye, 3, 1e7) && all_within(c->target, 3, 1e7) && c->fov >= 1 &&
                             c->fov <= 170 && memcmp(c->eye, c->target, sizeof(c->eye))));
}

static void check_ask(const wire_ask *a) {
    FUZZ_REQUIRE(a->pane >= 0 && a->pane < WIRE_PANES);
    FUZZ_REQUIRE(a->x >= 0 && a->x <= 1 && a->y >= 0 && a->y <= 1);
    FUZZ_REQUIRE(all_within(a->rect, 4, 2) && a->points <= WIRE_POINTS && a->pairs <= WIRE_PAIRS);
    FUZZ_REQUIRE(a->what != WIRE_REGION || a->has_rect || a->points >= 3 || a->object || a->street);
    FUZZ_REQUIRE(a->what != WIRE_FIND || (a->text && strlen(a->text) <= 4096));
    FUZZ_REQUIRE(a->what != WIRE_NAME || a->has_light || a->has_at || a->object || a->street);
    FUZZ_REQUIRE(all_within(a->at, 2, 1e7));
    FUZZ_REQUIRE(a->what != WIRE_ALIGN || (a->pairs >= 4 && a->aspect >= 0.01 && a->aspect <= 100));
    for (int i = 0; i < a->points; i++)
        FUZZ_REQUIRE(all_within(a->point[i], 2, 1e7));
    for (int i = 0; i < a->pairs; i++)
        FUZZ_REQUIRE(all_within(a->photo[i], 2, 10) && all_within(a->place[i], 3, 1e7));
}

/* What a session relies on. */
static void check(const wire_message *m) {
    const wire_input *in = &m->input;
    switch (m->kind) {
    case WIRE_HELLO:
        FUZZ_REQUIRE(m->hello.width >= 1 && m->hello.width <= WIRE_SIDE);
        FUZZ_REQUIRE(m->hello.height >= 1 && m->hello.height <= WIRE_SIDE);
        break;
    case WIRE_INPUT: /* of at most so many that became one */
        FUZZ_REQUIRE(in->seconds >= 0 && in->seconds <= 1e6 && in->keys < 256 && all_within(in->at, 2, 2));
        FUZZ_REQUIRE(all_within(in->turn, 2, 1e8) && all_within(in->pan, 2, 1e8) && fabs(in->zoom) <= 1e9);
        break;
    case WIRE_NAVIGATE:
        FUZZ_REQUIRE(m->navigate.mode <= WIRE_WALK && m->navigate.speed >= 0 && m->navigate.speed <= 1000);
        break;
    case WIRE_CAMERA: check_camera(&m->camera.to); break;
    case WIRE_JUMP:
        FUZZ_REQUIRE(m->jump.pane < WIRE_PANES && m->jump.x >= 0 && m->jump.x <= 1);
        FUZZ_REQUIRE(all_within(m->jump.place, 3, 1e7) && m->jump.distance >= 1 && m->jump.distance <= 10000);
        break;
    case WIRE_SET:
    case WIRE_WORLD:
        FUZZ_REQUIRE(m->set.pane >= -1 && m->set.pane < WIRE_PANES && m->set.name && m->set.value);
        FUZZ_REQUIRE(strlen(m->set.name) <= 4096 && strlen(m->set.value) <= 4096);
        break;
    case WIRE_LAYOUT: FUZZ_REQUIRE(m->layout.name <= WIRE_DIFFERENCE); break;
    case WIRE_ASK: check_ask(&m->ask); break;
    case WIRE_SAVE:
        FUZZ_REQUIRE(m->save.what <= WIRE_CSV && m->save.pane < WIRE_PANES && m->save.cameras <= WIRE_CAMERAS);
        for (int i = 0; i < m->save.cameras; i++)
            check_camera(&m->save.camera[i]);
        break;
    case WIRE_ACK:
    case WIRE_WATCH: FUZZ_REQUIRE(false); break; /* an inbox keeps none of these */
    case WIRE_CANCEL: break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    inbox in;
    char why[128];
    inbox_init(&in);
    for (size_t at = 0, n; at < size; at += n + 1) {
        const uint8_t *end = memchr(data + at, '\n', size - at);
        n = end ? (size_t)(end - data) - at : size - at;
        char *exact = noc_alloc(n ? n : 1); /* its own block, so that a read beyond it is seen */
        FUZZ_REQUIRE(exact);
        memcpy(exact, data + at, n);
        wire_message message;
        *why = 0;
        if (wire_read(exact, n, &message, why, sizeof(why)))
            inbox_put(&in, &message);
        else
            FUZZ_REQUIRE(*why && strlen(why) < sizeof(why) && !message.root);
        free(exact);
    }
    for (wire_message *m; (m = inbox_get(&in));) {
        check(m);
        wire_free(m);
        free(m);
    }
    inbox_finish(&in);
    return 0;
}
