/* What the helper is asked: written by the library, read by the helper. */
#include "import/load/load.h"
#include "import/remote/remote.h"

#include <nocturne/option.h>
#include <unistd.h>

/* ---- the library's side ---- */

static void ask_options(const noc_import_params *params, remote_record *batch, remote_record *one) {
    for (const noc_option *o = noc_import_options(); o->name; o++) {
        if (o->kind == NOC_OPTION_TEXTS) {
            const noc_texts *texts = (const noc_texts *)((const char *)params + o->offset);
            for (size_t i = 0; i < texts->count; i++) {
                remote_put_text(one, o->name);
                remote_put_text(one, texts->text[i]);
                remote_add(batch, REMOTE_OPTION, one);
            }
            continue;
        }
        size_t n = (size_t)noc_option_get(o, params, NULL, 0);
        char *value = noc_alloc(n + 1);
        batch->refused = batch->refused || !value;
        if (!value)
            return;
        noc_option_get(o, params, value, n + 1);
        if (n) {
            remote_put_text(one, o->name);
            remote_put_text(one, value);
            remote_add(batch, REMOTE_OPTION, one);
        }
        free(value);
    }
}

/* A reader needs what they ask, whatever for. */
static void ask_conditions(const noc_condition *conditions, size_t count, remote_record *batch, remote_record *one) {
    for (size_t i = 0; i < count; i++) {
        remote_put_text(one, conditions[i].key);
        remote_put_text(one, conditions[i].test);
        remote_add(batch, REMOTE_CONDITION, one);
    }
}

void remote_ask(remote_record *batch, const noc_reader *reader, const char *path, const noc_import_params *params,
                const geo_sink *sink) {
    remote_record one = { 0 };
    remote_put_text(&one, reader->name);
    remote_add(batch, REMOTE_READER, &one);
    remote_put_text(&one, path);
    remote_add(batch, REMOTE_PATH, &one);
    ask_options(params, batch, &one);
    for (size_t i = 0; i < params->luminaire_count; i++)
        ask_conditions(params->luminaires[i].conditions, params->luminaires[i].condition_count, batch, &one);
    for (size_t i = 0; i < params->group_count; i++)
        ask_conditions(params->groups[i].conditions, params->groups[i].condition_count, batch, &one);
    remote_asked asked = { (int32_t)getpid(),       (uint32_t)import_threads(params, OBJ_THREADS),
                           sink->named_lamps,       sink->inspect,
                           sink->footprint != NULL, sink->road != NULL,
                           sink->named_tracks,      params->each_lamp,
                           sink->given_metres,      sink->given_degrees };
    remote_put(&one, &asked, sizeof(asked));
    remote_add(batch, REMOTE_SINK, &one);
    remote_add(batch, REMOTE_GO, &one);
    array_free(&one.bytes);
}

/* ---- the helper's side ---- */

static void set_option(remote_request *q, const char *name, const char *value) {
    const char *kept = arena_strdup(&q->texts, value);
    for (const noc_option *o = noc_import_options(); o->name && kept; o++)
        if (!strcmp(o->name, name))
            noc_option_set(o, &q->params, kept, NULL);
}

static bool take(remote_request *q, uint32_t kind, remote_record *r) {
    if (kind == REMOTE_READER) {
        const char *name = remote_get_text(r);
        for (const noc_reader *const *reader = noc_readers; *reader; reader++)
            if (!strcmp((*reader)->name, name))
                q->reader = *reader;
    } else if (kind == REMOTE_PATH) {
        q->path = arena_strdup(&q->texts, remote_get_text(r));
    } else if (kind == REMOTE_OPTION) {
        const char *name = remote_get_text(r), *value = remote_get_text(r);
        if (!r->bad)
            set_option(q, name, value);
    } else if (kind == REMOTE_CONDITION) {
        noc_condition c = { .key = arena_strdup(&q->texts, remote_get_text(r)) };
        c.test = arena_strdup(&q->texts, remote_get_text(r));
        r->bad = r->bad || noc_condition_check(&c, NULL);
        q->texts.refused = !array_push(&q->conditions, c) || q->texts.refused;
    } else if (kind == REMOTE_SINK) {
        unsigned char flags[sizeof(q->sink)];
        bool whole = remote_get(r, flags, sizeof(flags)) && flags[offsetof(remote_asked, named_lamps)] <= 1 &&
                     flags[offsetof(remote_asked, inspect)] <= 1 && flags[offsetof(remote_asked, footprints)] <= 1 &&
                     flags[offsetof(remote_asked, roads)] <= 1 && flags[offsetof(remote_asked, named_tracks)] <= 1 &&
                     flags[offsetof(remote_asked, each_lamp)] <= 1 &&
                     flags[offsetof(remote_asked, given_metres)] <= 1 &&
                     flags[offsetof(remote_asked, given_degrees)] <= 1;
        if (whole)
            memcpy(&q->sink, flags, sizeof(flags));
        q->params.threads = (int)NOC_CLAMP(q->sink.threads, 1, OBJ_THREADS);
        r->bad = !whole;
    }
    return !r->bad && !q->texts.refused;
}

void remote_request_free(remote_request *q) {
    array_free(&q->conditions);
    arena_free(&q->texts);
}

bool remote_receive(int fd, remote_request *q) {
    *q = (remote_request){ .params = noc_import_default_params() };
    for (;;) {
        remote_head head;
        remote_record r = { 0 };
        if (!remote_pass(fd, &head, sizeof(head), false) || head.size_high || head.size_low > REMOTE_REQUEST_MOST)
            return false;
        if (!array_reserve(&r.bytes, (size_t)head.size_low)) {
            q->texts.refused = true;
            return false;
        }
        r.bytes.len = head.size_low;
        bool good = remote_pass(fd, r.bytes.data, r.bytes.len, false) && take(q, head.kind, &r);
        array_free(&r.bytes);
        if (!good || head.kind == REMOTE_GO) {
            q->rule = noc_luminaire_default_rule();
            q->rule.conditions = q->conditions.data;
            q->rule.condition_count = q->conditions.len;
            q->params.each_lamp = q->sink.each_lamp;
            q->params.luminaires = &q->rule;
            q->params.luminaire_count = q->conditions.len > 0;
            return good && q->reader && q->path;
        }
    }
}
