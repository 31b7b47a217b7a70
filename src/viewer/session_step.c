/* Which picture is made next: the newest input first, then rest. */
#include "viewer/session_parts.h"

#include <math.h>

#define BUDGET 0.05       /* s: a moving picture of all panes */
#define RESTS_AFTER 0.25  /* s without a change */
#define LOSSLESS_AFTER 3  /* s of rest */
#define MOST_PIXELS 2.5e6 /* of all panes of a client */
#define IDLE 0.25         /* s between looks at the world, where nothing is to be done */

static bool goes_on(void *user, const char *what, double done) {
    (void)what, (void)done;
    session *s = user;
    return !inbox_ended(&s->in) && (s->behind || !inbox_hurries(&s->in));
}

/* A frame that shows an input which was in none before it comes to its end, so that there are pictures however fast
 * inputs come. One that only shows a camera on its way, or cars, makes place. */
static bool goes_on_moving(void *user, const char *what, double done) {
    (void)what, (void)done;
    session *s = user;
    return !inbox_ended(&s->in) && (s->behind || s->input != s->shown || !inbox_hurries(&s->in));
}

static void full_size(const session *s, int *w, int *h) {
    double pixels = (double)s->width * s->height * s->panes.count, scale = 1;
    if (pixels > MOST_PIXELS)
        scale = sqrt(MOST_PIXELS / pixels);
    *w = (int)fmax(1, floor(s->width * scale));
    *h = (int)fmax(1, floor(s->height * scale));
}

void session_wake(session *s) {
    s->rested = false;
    for (int i = 0; i < s->panes.count; i++)
        s->panes.pane[i].failed = false;
}

void session_changed(session *s) {
    s->panes.change++;
    s->moved = session_now();
    session_wake(s);
}

/* One frame of a pane at that level. false: it was dropped, or failed, which is told. */
static bool render(session *s, int which, int level, bool rests) {
    int w, h;
    full_size(s, &w, &h);
    pace_size(level, w, h, &w, &h);
    noc_progress progress = { rests ? goes_on : goes_on_moving, s };
    noc_status status = panes_render(&s->panes, which, &s->mover.camera, w, h, rests, &progress);
    if (status && status != NOC_ERR_CANCELLED) {
        char why[300];
        noc_log_copy_error(s->panes.log, why, sizeof(why));
        session_note(s, "error", *why ? why : noc_status_text(status));
        s->panes.pane[which].failed = true; /* until something changes: the next one would fail, too */
        s->told_less = true;
    }
    return !status;
}

static bool not_ended(void *user, const char *what, double done) {
    (void)what, (void)done;
    session *s = user;
    return !inbox_ended(&s->in);
}

bool session_complete(session *s, int which) {
    const pane *p = &s->panes.pane[which];
    int w, h;
    full_size(s, &w, &h);
    noc_image *image = noc_view_image(p->view); /* none, where a frame of another size was broken off */
    bool whole = image && image->width == w && image->height == h && p->shown == s->panes.change;
    noc_image_destroy(image);
    noc_progress progress = { not_ended, s };
    return whole || !panes_render(&s->panes, which, &s->mover.camera, w, h, true, &progress);
}

static void publish(session *s, int which, bool moves, bool lossless) {
    double now = session_now();
    panes_picture what = { moves, lossless, s->input, now, &s->mover.camera };
    noc_bar *first = &s->panes.pane[0].bar, before = *first;
    noc_status status = panes_publish(&s->panes, which, &what);
    s->told_less = s->told_less || first->low != before.low || first->high != before.high; /* the command has it */
    if (status && status != NOC_ERR_CANCELLED)
        session_note(s, "error", "there is no memory for a picture");
    s->sent[which] = now;
}

/* The first picture of all: the structures of the lights may take a while. */
static void show_headlight(session *s) {
    int w, h;
    full_size(s, &w, &h);
    pace_size(pace_coarsest(w, h, 1), w, h, &w, &h);
    if (atomic_load(s->setup->lit) || s->panes.pane[0].look.show)
        return;
    double exposure = s->panes.exposure;
    if (!panes_headlight(&s->panes, &s->mover.camera, w, h, &(noc_progress){ not_ended, s }))
        publish(s, 0, true, false);
    s->panes.exposure = exposure; /* it has one of its own */
}

/* Returns true if the pane has no picture until something changes; a difference has none without those it is of. */
static bool has_failed(const session *s, int which) {
    const pane *p = s->panes.pane;
    return p[which].failed || (!p[which].view && (p[0].failed || p[1].failed));
}

/* While it moves: each pane that does not show the newest yet, at the resolution that the time allows. */
static double step_moving(session *s) {
    double spent = 0, now = session_now();
    int done = 0, w, h;
    full_size(s, &w, &h);
    int coarsest = pace_coarsest(w, h, s->panes.count);
    s->pace.level = s->pace.level < coarsest ? s->pace.level : coarsest;
    s->resting = s->pace.level;
    for (int i = 0; i < s->panes.count; i++) {
        pane *p = &s->panes.pane[i];
        if (p->shown == s->panes.change || has_failed(s, i) || !panes_watched(&s->panes, i, now))
            continue;
        double start = session_now();
        if (p->view && !render(s, i, s->pace.level, false)) {
            if (p->failed)
                continue;
            return 0;
        }
        p->shown = s->panes.change;
        publish(s, i, true, false);
        atomic_store(s->setup->lit, true);
        s->shown = s->input;
        spent += session_now() - start;
        done++;
    }
    if (done)
        pace_after(&s->pace, spent / done * s->panes.count, BUDGET, coarsest);
    return done ? 0 : s->moved + RESTS_AFTER - now;
}

/* Has the pane what it is to have at rest? */
static bool is_done(const session *s, int which) {
    const pane *p = &s->panes.pane[which];
    return p->look.frames && !p->calm && p->stats.frames >= (uint64_t)p->look.frames;
}

/* The first pictures at rest are finer and finer, and the whole ones become more and more exact. */
static double step_resting(session *s) {
    double now = session_now();
    bool first = s->resting > 0, all_done = true, any = false;
    if (first)
        s->resting = s->resting > 2 ? s->resting - 2 : 0;
    for (int i = 0; i < s->panes.count; i++) {
        pane *p = &s->panes.pane[i];
        if (!panes_watched(&s->panes, i, now)) {
            s->missed = true;
            continue;
        }
        any = true;
        if (has_failed(s, i))
            continue;
        bool full = !first && !s->resting;
        bool as_it_is = s->redraw == 1 + PANES_PUBLISH && p->shown == s->panes.change;
        if (p->view && !as_it_is && (s->redraw || !(full && is_done(s, i))) && !render(s, i, s->resting, true)) {
            if (p->failed)
                continue;
            return 0;
        }
        bool done = p->view ? full && is_done(s, i) : all_done;
        all_done = all_done && done;
        now = session_now();
        double rested = now - s->moved;
        if (first || done || s->redraw || now - s->sent[i] > pace_rest(rested))
            publish(s, i, false, done || (rested > LOSSLESS_AFTER && !as_it_is));
    }
    s->redraw = any ? 0 : s->redraw;
    s->rested = any && all_done;
    return any ? 0 : IDLE;
}

/* Does anybody look at its pictures? */
static bool is_watched(session *s) {
    bool watched = false;
    for (int i = 0; i < s->panes.count && s->width && !inbox_hidden(&s->in); i++)
        watched = watched || panes_watched(&s->panes, i, session_now());
    return watched;
}

/* Once all panes are shown again, each gets a picture of what is set now. */
static void catch_up(session *s) {
    bool watched = s->missed;
    for (int i = 0; i < s->panes.count && watched; i++)
        watched = panes_watched(&s->panes, i, session_now());
    if (!watched)
        return;
    s->missed = s->rested = false;
    s->redraw = 1 + PANES_FRAME;
}

double session_step(session *s) {
    if (is_watched(s))
        world_look(s->setup->world);
    uint64_t version = world_version(s->setup->world);
    if (version != s->version) {
        s->version = version;
        session_changed(s);
    }
    if (mover_advance(&s->mover, session_aspect(s), session_now())) {
        session_changed(s);
        s->travels = true;
    } else if (s->travels) {
        s->travels = false;
        s->told_less = true;
    }
    uint64_t told = world_told(s->setup->world);
    if (told != s->told) {
        s->told = told;
        session_tell_state(s);
    }
    if (s->width && !s->began) {
        s->began = true;
        show_headlight(s);
    }
    catch_up(s);
    if (!s->width || inbox_hidden(&s->in) || s->rested)
        return IDLE;
    return session_now() - s->moved < RESTS_AFTER ? step_moving(s) : step_resting(s);
}
