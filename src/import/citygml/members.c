/* members.c: members of a file on several threads.
 *
 * The text is cut between top-level members, where tags and comments tell that it may be, into pieces that threads
 * parse before their turn, each as if it stood behind the root's start tag. In its turn a piece's objects go to the
 * sink, in the text's order. What one piece cannot know of the others (a reference to another object, a lamp, a CRS
 * that is new, an error) makes it of no use: the parser of the whole text then reads it in its turn, which has seen all
 * but the pieces that were of use. So all comes out, and is said, as if one thread had read it. */
#include "import/citygml/citygml.h"
#include "import/lamps/tags.h"

#include <pthread.h>
#include <stdatomic.h>

size_t cg_members_at_once = (size_t)256 << 10;
atomic_size_t cg_members_ahead;

#define LARGEST ((size_t)16 << 20) /* of a piece: a text whose members are larger is not cut */
#define READ ((size_t)128 << 10)   /* bytes at once */
#define SLOTS 3                    /* pieces, a thread */
#define MOST_SKIPPED 64            /* pieces that are not tried behind some that were of no use */

/* ---- cuts ---- */

typedef struct cutter {
    noc_stream *stream;
    NOC_ARRAY(char) text; /* that was read, and is in no piece yet */
    size_t at, cut;       /* scanned so far; the last place between members, 0: none */
    uint32_t depth;       /* elements that are open */
    size_t head;          /* bytes to the end of the root's start tag; 0: not seen yet */
    bool ended, lost;     /* nothing more comes; nothing more can be cut */
} cutter;

typedef enum token { TOKEN_OTHER, TOKEN_START, TOKEN_EMPTY, TOKEN_END } token;

static const char *behind(const char *p, const char *end, const char *mark) {
    const char *found = memmem(p, (size_t)(end - p), mark, strlen(mark));
    return found ? found + strlen(mark) : NULL;
}

/* Behind the start tag at p: in its attributes '>' may stand. */
static const char *behind_tag(const char *p, const char *end) {
    for (; p < end && *p != '>'; p++)
        if ((*p == '"' || *p == '\'') && !(p = memchr(p + 1, *p, (size_t)(end - p - 1))))
            return NULL;
    return p < end ? p + 1 : NULL;
}

/* Behind what begins with '<' at p; NULL where its end is not there yet, or it is not known what it is. */
static const char *behind_token(cutter *c, const char *p, const char *end, token *is) {
    size_t have = (size_t)(end - p);
    *is = TOKEN_OTHER;
    if (have < 2)
        return NULL;
    if (p[1] == '?')
        return behind(p + 2, end, "?>");
    if (p[1] == '!') {
        if (have >= 4 && !memcmp(p, "<!--", 4))
            return behind(p + 4, end, "-->");
        if (have >= 9 && !memcmp(p, "<![CDATA[", 9))
            return behind(p + 9, end, "]]>");
        c->lost = c->lost || have >= 9; /* a document type */
        return NULL;
    }
    const char *last = p[1] == '/' ? behind(p, end, ">") : behind_tag(p, end);
    *is = p[1] == '/' ? TOKEN_END : last && last[-2] == '/' ? TOKEN_EMPTY : TOKEN_START;
    return last;
}

static void scan(cutter *c) {
    const char *begin = c->text.data, *end = begin + c->text.len, *p = begin + c->at, *next;
    token is;
    if (!c->at && c->text.len >= 2 && (!begin[0] || !begin[1] || (begin[0] & 0xfe) == 0xfe))
        c->lost = true; /* letters of two bytes */
    for (; !c->lost && (p = memchr(p, '<', (size_t)(end - p))); p = next) {
        if (!(next = behind_token(c, p, end, &is))) {
            c->at = (size_t)(p - begin);
            return;
        }
        c->depth += is == TOKEN_START;
        if (is == TOKEN_START && c->depth == 1 && !c->head)
            c->head = (size_t)(next - begin);
        c->lost = c->depth < 1 + (is == TOKEN_END) && is != TOKEN_OTHER; /* the root ends */
        c->depth -= is == TOKEN_END && c->depth;
        if (!c->lost && c->depth == 1 && (is == TOKEN_END || is == TOKEN_EMPTY))
            c->cut = (size_t)(next - begin);
    }
    c->at = c->text.len;
}

/* ---- pieces ---- */

typedef struct piece {
    enum { PIECE_FREE, PIECE_FULL, PIECE_BUSY, PIECE_DONE } state;
    char *text;
    size_t size, lines;
    bool last;  /* what comes behind it is in no piece */
    bool tried; /* ahead of its turn */
    bool good;  /* its side has all that comes of it */
    /* who reads it ahead, with what is known of the file; NULL: nobody did yet */
    cg_parser *parser;
    geo_sink *side;
    const char *format;
    cg_frame root;
    int version;
} piece;

typedef struct team {
    cg_parser *p; /* of the whole text */
    const cg_handlers *handlers;
    xml_progress at;
    cutter cutter;
    char *head; /* the text to the end of the root's start tag */
    size_t head_size;
    piece *pieces; /* a ring */
    size_t count, first, filled;
    size_t skip, skipped; /* pieces that are not tried now; as many were the last time */
    noc_pool *pool;       /* NULL: none was needed yet */
    noc_pool_task *task;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool ended, stop;
} team;

/* The next piece of the text, whole members or the last. */
static noc_status cut_piece(team *t, piece *out) {
    cutter *c = &t->cutter;
    while (c->cut < cg_members_at_once && !c->lost && !c->ended && c->text.len < LARGEST) {
        size_t got, room = NOC_MIN(READ, cg_members_at_once);
        if (!array_reserve(&c->text, c->text.len + room))
            return cg_no_memory(t->p);
        noc_status status = noc_stream_read(c->stream, c->text.data + c->text.len, room, &got);
        if (status)
            return t->p->status = status;
        c->ended = !got;
        c->text.len += got;
        scan(c);
    }
    out->last = !c->cut;
    out->size = c->cut ? c->cut : c->text.len;
    if (!t->head_size && c->head && !out->last) {
        if (!(t->head = noc_strndup(c->text.data, c->head)))
            return cg_no_memory(t->p);
        t->head_size = c->head;
    }
    NOC_ARRAY(char) rest = { 0 };
    if (!array_append(&rest, c->text.data + out->size, c->text.len - out->size))
        return cg_no_memory(t->p);
    out->text = c->text.data;
    memcpy(&c->text, &rest, sizeof(rest));
    c->at -= NOC_MIN(c->at, out->size);
    c->cut = 0;
    return NOC_OK;
}

/* ---- ahead of its turn ---- */

static size_t lines_of(const char *text, size_t size) {
    size_t lines = 0;
    for (size_t i = 0; i < size; i++)
        lines += text[i] == '\n';
    for (const char *p = text, *end = text + size; (p = memchr(p, '\r', (size_t)(end - p))); p++)
        lines += p + 1 == end || p[1] != '\n';
    return lines;
}

static noc_status status_of(void *parser) { return ((cg_parser *)parser)->status; }

static void read_ahead(const team *t, piece *m) {
    cg_parser *q = m->parser;
    xml_progress at = { 0 };
    xml_fault fault = XML_FAULT_MEMORY;
    cg_object_clear(&q->object);
    q->status = NOC_OK;
    q->object_open = false;
    q->emitted = q->dropped = q->twins = 0;
    q->sink_srs = CG_UNTOLD;
    m->good = false;
    if (!cg_open(q, t->handlers))
        return;
    q->pass = 1;
    xml_feed(q->xml, &at, t->head, t->head_size, status_of, q, &fault);
    if (!q->status && !fault && q->depth == 1 && !q->skip) {
        q->frames[0] = m->root;
        xml_feed(q->xml, &at, m->text, m->size, status_of, q, &fault);
    }
    XML_ParserFree(q->xml);
    q->xml = NULL;
    m->good = !q->status && !fault && q->depth == 1 && !q->skip && q->frames[0].srs == m->root.srs &&
              q->version == m->version && !geo_issues_refused(m->side->issues);
    if (m->good)
        m->lines = lines_of(m->text, m->size);
}

/* The oldest piece that nobody reads, which is the caller's then. NULL: there is none. Under the lock. */
static piece *claim(team *t) {
    for (size_t i = 0; i < t->filled; i++) {
        piece *m = &t->pieces[(t->first + i) % t->count];
        if (m->state != PIECE_FULL)
            continue;
        m->state = PIECE_BUSY;
        return m;
    }
    return NULL;
}

/* Called, and returns, under the lock. */
static void read_claimed(team *t, piece *m) {
    pthread_mutex_unlock(&t->lock);
    read_ahead(t, m);
    pthread_mutex_lock(&t->lock);
    m->state = PIECE_DONE;
    pthread_cond_broadcast(&t->changed);
}

static void work(void *ctx, size_t item, int worker) {
    (void)item;
    (void)worker;
    team *t = ctx;
    pthread_mutex_lock(&t->lock);
    while (!t->stop) {
        piece *m = claim(t);
        if (m)
            read_claimed(t, m);
        else
            pthread_cond_wait(&t->changed, &t->lock);
    }
    pthread_mutex_unlock(&t->lock);
}

/* ---- in its turn ---- */

/* Gives the piece one who reads ahead, where there can be one now. */
static bool equip(team *t, piece *m) {
    const cg_parser *p = t->p;
    if (!m->side && !(m->side = p->sink->sides->create(p->sink->ctx)))
        return false;
    cg_parser *q = m->parser;
    if (!q) {
        if (!(q = noc_calloc(1, sizeof(*q))))
            return false;
        if (!(q->keys = lamp_keys_create(p->params))) {
            free(q);
            return false;
        }
        m->parser = q;
        q->ahead = true;
        q->stream = p->stream;
        q->place = p->place;
        q->params = p->params;
        q->max_lod = p->max_lod;
        q->sink = m->side;
        q->format = &m->format;
        q->looks = (cg_looks){ .all = p->looks.all,
                               .rings = p->looks.rings,
                               .uv = p->looks.uv,
                               .by_ring = p->looks.by_ring,
                               .by_target = p->looks.by_target };
    }
    memcpy(q->srs, p->srs, sizeof(q->srs));
    q->srs_count = p->srs_count;
    q->version = m->version = p->version;
    m->root = p->frames[0];
    return true;
}

/* Threads are there once they are of use. */
static void hire(team *t) {
    if (t->pool || !(t->pool = noc_pool_create(t->p->sink->sides->threads)))
        return;
    size_t others = (size_t)noc_pool_threads(t->pool) - 1;
    t->task = others ? noc_pool_start(t->pool, others, work, t) : NULL;
}

static noc_status fill(team *t) {
    piece *m = &t->pieces[(t->first + t->filled) % t->count];
    noc_status status = cut_piece(t, m);
    if (status)
        return status;
    bool between = t->p->depth == 1 && !t->p->skip && t->p->frames[0].name.code == CG_MODEL && t->head_size;
    bool ahead = between && !m->last && !t->skip && equip(t, m);
    t->skip -= t->skip > 0;
    t->ended = m->last;
    if ((m->tried = ahead))
        hire(t);
    pthread_mutex_lock(&t->lock);
    m->state = ahead ? PIECE_FULL : PIECE_DONE;
    t->filled++;
    pthread_cond_broadcast(&t->changed);
    pthread_mutex_unlock(&t->lock);
    return NOC_OK;
}

/* Was it read with what is known of the file now? */
static bool still_holds(const cg_parser *p, const piece *m) {
    const cg_parser *q = m->parser;
    size_t kinds = m->good ? cg_kinds_told(q) : 0;
    return m->good && m->root.srs == p->frames[0].srs && m->version == p->version &&
           (q->srs_count > 0) == (p->srs_count > 0) && (!kinds || cg_kinds_told(p) + kinds <= CG_MAX_KINDS);
}

static void take_ahead(team *t, piece *m) {
    cg_parser *p = t->p;
    const cg_parser *q = m->parser;
    p->ordinal += q->ordinal;
    p->emitted += q->emitted;
    p->dropped += q->dropped;
    p->twins += q->twins;
    p->lines += m->lines;
    cg_stop(p, p->sink->sides->take(p->sink->ctx, m->side));
    if (!p->status)
        p->status = cg_ask(p);
    t->skipped = 0;
    cg_members_ahead++;
}

static void take_in_turn(team *t, piece *m) {
    cg_parser *p = t->p;
    xml_fault fault;
    if (m->tried) {
        p->sink->sides->forget(m->side);
        t->skip = t->skipped = NOC_MIN(2 * t->skipped + 1, (size_t)MOST_SKIPPED);
    }
    noc_status status = xml_feed(p->xml, &t->at, m->text, m->size, cg_ask, p, &fault);
    if (!status && !fault && m->last)
        status = xml_read(p->xml, &t->at, p->stream, cg_ask, p, &fault);
    cg_after(p, status, fault);
}

static void take(team *t) {
    piece *m = &t->pieces[t->first];
    if (m->tried && still_holds(t->p, m))
        take_ahead(t, m);
    else
        take_in_turn(t, m);
    free(m->text);
    m->text = NULL;
    pthread_mutex_lock(&t->lock);
    m->state = PIECE_FREE;
    t->first = (t->first + 1) % t->count;
    t->filled--;
    pthread_mutex_unlock(&t->lock);
}

/* The oldest piece is taken as soon as it is read; until then the calling thread cuts others, and reads ahead itself.
 */
static void run(team *t) {
    const cg_parser *p = t->p;
    while (!p->status && (t->filled || !t->ended)) {
        pthread_mutex_lock(&t->lock);
        bool done = t->filled && t->pieces[t->first].state == PIECE_DONE, room = t->filled < t->count && !t->ended;
        piece *m = done || room ? NULL : claim(t);
        if (m)
            read_claimed(t, m);
        else if (!done && !room)
            pthread_cond_wait(&t->changed, &t->lock);
        pthread_mutex_unlock(&t->lock);
        if (done)
            take(t);
        else if (room)
            fill(t);
    }
}

static void dismiss(team *t) {
    pthread_mutex_lock(&t->lock);
    t->stop = true;
    pthread_cond_broadcast(&t->changed);
    pthread_mutex_unlock(&t->lock);
    if (t->task)
        noc_pool_wait(t->pool, t->task);
    noc_pool_destroy(t->pool);
    for (size_t i = 0; i < t->count; i++) {
        piece *m = &t->pieces[i];
        if (m->parser) /* what it has of the whole text's is not its own */
            m->parser->looks = (cg_looks){ .pairs = m->parser->looks.pairs };
        cg_parser_destroy(m->parser);
        if (m->side)
            t->p->sink->sides->destroy(m->side);
        free(m->text);
    }
    pthread_cond_destroy(&t->changed);
    pthread_mutex_destroy(&t->lock);
    free(t->pieces);
    free(t->head);
    array_free(&t->cutter.text);
}

noc_status cg_read_members(cg_parser *p, const cg_handlers *handlers) {
    team t = { .p = p,
               .handlers = handlers,
               .cutter = { .stream = p->stream },
               .count = SLOTS * (size_t)p->sink->sides->threads };
    t.pieces = noc_calloc(t.count, sizeof(*t.pieces));
    if (!t.pieces)
        return cg_no_memory(p);
    pthread_mutex_init(&t.lock, NULL);
    pthread_cond_init(&t.changed, NULL);
    run(&t);
    dismiss(&t);
    return p->status;
}
