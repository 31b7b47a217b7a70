/* JSON and XML: what comes out is well-formed again. */
#include "mutate.h"

#include <jansson.h>
#include <stdio.h>

/* ---- JSON ---- */

/* A value in its array or object. */
typedef struct place {
    json_t *in;
    size_t index;
    const char *key; /* NULL: of an array */
} place;
typedef struct places {
    NOC_ARRAY(place) list;
} places;

static void collect(json_t *v, places *all) {
    const char *key;
    json_t *child;
    size_t i;
    if (all->list.len > 20000)
        return;
    json_array_foreach(v, i, child) {
        FUZZ_REQUIRE(array_push(&all->list, (place){ v, i, NULL }));
        collect(child, all);
    }
    json_object_foreach(v, key, child) {
        FUZZ_REQUIRE(array_push(&all->list, (place){ v, 0, key }));
        collect(child, all);
    }
}

static json_t *value_at(place p) { return p.key ? json_object_get(p.in, p.key) : json_array_get(p.in, p.index); }

static json_t *some_text(const char *text, size_t size, uint32_t *random) {
    fuzz_bytes now = { 0 };
    mutate_raw((fuzz_part){ (const uint8_t *)text, size }, size + 32, random, &now);
    for (size_t i = 0; i < now.len; i++)
        if (now.data[i] > 126 || !now.data[i])
            now.data[i] = '?';
    json_t *s = json_stringn((const char *)now.data, now.len);
    array_free(&now);
    return s;
}

static json_t *plain_value(uint32_t *random) {
    switch (mutate_random(random, 9)) {
    case 0: return json_null();
    case 1: return json_true();
    case 2: return json_integer(0);
    case 3: return json_integer(-1);
    case 4: return json_real(1e300);
    case 5: return json_string("");
    case 6: return json_array();
    case 7: return json_object();
    default: return json_integer((json_int_t)1 << mutate_random(random, 63));
    }
}

static json_t *changed_value(const json_t *v, uint32_t *random) {
    char text[64];
    if (json_is_string(v))
        return some_text(json_string_value(v), json_string_length(v), random);
    if (!json_is_number(v))
        return plain_value(random);
    snprintf(text, sizeof(text), "%.17g", json_number_value(v));
    mutate_number(text, strlen(text), random, text);
    json_t *changed = json_loads(text, JSON_DECODE_ANY, NULL);
    return changed ? changed : plain_value(random);
}

static void change_json(json_t *root, uint32_t *random) {
    places all = { 0 };
    collect(root, &all);
    if (all.list.len) {
        uint32_t n = (uint32_t)all.list.len;
        place p = all.list.data[mutate_random(random, n)], q = all.list.data[mutate_random(random, n)];
        char *key = noc_strdup(p.key);
        json_t *v = value_at(p), *other = value_at(q);
        switch (mutate_random(random, 8)) {
        case 0: key ? json_object_del(p.in, key) : json_array_remove(p.in, p.index); break;
        case 1: /* once more, or often; fails for objects */
            for (uint32_t times = mutate_random(random, 4) ? 1 : mutate_random(random, 80); times > 0; times--)
                json_array_insert_new(p.in, p.index, json_deep_copy(v));
            break;
        case 2:
            if (key && q.key)
                json_object_set_new(p.in, q.key, json_deep_copy(v)); /* under another's name too */
            break;
        case 3: {
            json_t *copy = json_deep_copy(other); /* before: it may hold p */
            key ? json_object_set_new(p.in, key, copy) : json_array_set_new(p.in, p.index, copy);
            break;
        }
        default: {
            json_t *now = mutate_random(random, 4) ? changed_value(v, random) : plain_value(random);
            key ? json_object_set_new(p.in, key, now) : json_array_set_new(p.in, p.index, now);
        }
        }
        free(key);
    }
    array_free(&all.list);
}

bool mutate_json(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    if (!in.size || !memchr("{[ \t\r\n", in.data[0], 6))
        return false;
    json_t *root = json_loadb((const char *)in.data, in.size, 0, NULL);
    if (!root)
        return false;
    (void)most;
    for (uint32_t i = 1 + mutate_random(random, 3); i > 0; i--)
        change_json(root, random);
    char *text = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(15));
    json_decref(root);
    if (!text)
        return false;
    FUZZ_REQUIRE(array_append(out, (uint8_t *)text, strlen(text)));
    free(text);
    return true;
}

/* ---- XML ---- */

typedef struct xml_token {
    enum { XML_OPEN, XML_CLOSE, XML_ALONE, XML_TEXT, XML_OTHER } kind;
    size_t from, to, match; /* match: the token that closes an opening one */
} xml_token;
typedef struct xml_tokens {
    NOC_ARRAY(xml_token) list;
    NOC_ARRAY(size_t) open;
} xml_tokens;

/* False where tags are not nested. */
static bool read_tokens(fuzz_part in, xml_tokens *t) {
    for (size_t at = 0; at < in.size;) {
        xml_token token = { XML_TEXT, at, at, 0 };
        const uint8_t *end = memchr(in.data + at, in.data[at] == '<' ? '>' : '<', in.size - at);
        if (in.data[at] == '<') {
            if (!end || end - in.data < (ptrdiff_t)at + 2)
                return false;
            token.to = (size_t)(end - in.data) + 1;
            bool other = in.data[at + 1] == '!' || in.data[at + 1] == '?', close = in.data[at + 1] == '/';
            token.kind = other ? XML_OTHER : close ? XML_CLOSE : end[-1] == '/' ? XML_ALONE : XML_OPEN;
        } else {
            token.to = end ? (size_t)(end - in.data) : in.size;
        }
        token.match = t->list.len;
        if (token.kind == XML_CLOSE) {
            if (!t->open.len)
                return false;
            t->list.data[t->open.data[--t->open.len]].match = t->list.len;
        }
        if (token.kind == XML_OPEN)
            FUZZ_REQUIRE(array_push(&t->open, t->list.len));
        FUZZ_REQUIRE(array_push(&t->list, token));
        at = token.to;
    }
    return t->list.len > 2 && !t->open.len;
}

/* A random token that is an element's first, other than the root; or text. */
static const xml_token *some_token(const xml_tokens *t, bool text, uint32_t *random) {
    size_t n = t->list.len, at = mutate_random(random, (uint32_t)n);
    bool root = true;
    for (size_t i = 0; i < n; i++, at = (at + 1) % n) {
        const xml_token *k = &t->list.data[at];
        root = k->match + 1 >= n - 1;
        if (text ? k->kind == XML_TEXT : (k->kind == XML_OPEN || k->kind == XML_ALONE) && !root)
            return k;
    }
    return NULL;
}

static fuzz_part span(fuzz_part in, const xml_tokens *t, const xml_token *k) {
    return (fuzz_part){ in.data + k->from, t->list.data[k->match].to - k->from };
}

/* A value in quotes inside a tag, or a text; another in its place. */
static fuzz_part some_value(fuzz_part in, const xml_tokens *t, uint32_t *random) {
    const xml_token *k = some_token(t, mutate_random(random, 2), random);
    if (!k)
        return (fuzz_part){ in.data, 0 };
    fuzz_part all = { in.data + k->from, k->to - k->from };
    if (k->kind == XML_TEXT)
        return all;
    const uint8_t *from = memchr(all.data, '"', all.size), *end = all.data + all.size;
    for (uint32_t skip = mutate_random(random, 4); from && skip > 0; skip--) {
        const uint8_t *close = memchr(from + 1, '"', (size_t)(end - from - 1));
        const uint8_t *next = close ? memchr(close + 1, '"', (size_t)(end - close - 1)) : NULL;
        if (!next)
            break;
        from = next;
    }
    const uint8_t *close = from ? memchr(from + 1, '"', (size_t)(end - from - 1)) : NULL;
    return close ? (fuzz_part){ from + 1, (size_t)(close - from - 1) } : (fuzz_part){ in.data, 0 };
}

static void changed_text(fuzz_part old, fuzz_part other, uint32_t *random, fuzz_bytes *out) {
    size_t at = out->len;
    uint32_t what = mutate_random(random, 4);
    if (what == 0)
        FUZZ_REQUIRE(array_append(out, other.data, other.size));
    else if (what < 3 && old.size)
        mutate_lines(old, 2 * old.size, random, out);
    if (out->len == at)
        mutate_raw(old, old.size + 32, random, out);
    for (; at < out->len; at++)
        if (strchr("<>&\"", out->data[at]) || (out->data[at] < 32 && !strchr("\t\r\n", out->data[at])))
            out->data[at] = '_';
}

/* An element within itself, and that within itself. */
static void nest(fuzz_part in, const xml_tokens *t, const xml_token *a, uint32_t *random, fuzz_bytes *out) {
    const xml_token *close = &t->list.data[a->match];
    uint32_t times = 1u << mutate_random(random, 10);
    for (uint32_t i = 0; i < times; i++)
        FUZZ_REQUIRE(array_append(out, in.data + a->from, a->to - a->from));
    FUZZ_REQUIRE(array_append(out, in.data + a->to, close->from - a->to));
    for (uint32_t i = 0; i < times; i++)
        FUZZ_REQUIRE(array_append(out, in.data + close->from, close->to - close->from));
}

static bool change_xml(fuzz_part in, const xml_tokens *t, uint32_t *random, fuzz_bytes *out) {
    fuzz_part old, now = { 0 };
    fuzz_bytes text = { 0 };
    uint32_t what = mutate_random(random, 9), times = 1;
    const xml_token *a = some_token(t, false, random), *b = some_token(t, false, random);
    if (what < 4) {
        old = some_value(in, t, random);
        if (!old.size)
            return false;
        changed_text(old, some_value(in, t, random), random, &text);
        now = (fuzz_part){ text.data, text.len };
    } else if (!a || !b) {
        return false;
    } else {
        old = span(in, t, a);
        now = what == 5 ? span(in, t, b) : old; /* another element in its place; once or more again; none */
        times = what == 4 ? 0 : what == 6 ? 2 + mutate_random(random, 3) : 1;
        if (what == 8 && a->kind == XML_OPEN) {
            nest(in, t, a, random, &text);
            now = (fuzz_part){ text.data, text.len };
        } else if (what == 7) { /* another one before it */
            fuzz_part s = span(in, t, b);
            FUZZ_REQUIRE(array_append(&text, s.data, s.size));
            FUZZ_REQUIRE(array_append(&text, old.data, old.size));
            now = (fuzz_part){ text.data, text.len };
        }
    }
    size_t before = (size_t)(old.data - in.data);
    FUZZ_REQUIRE(array_append(out, in.data, before));
    for (; times > 0; times--)
        FUZZ_REQUIRE(array_append(out, now.data, now.size));
    FUZZ_REQUIRE(array_append(out, in.data + before + old.size, in.size - before - old.size));
    array_free(&text);
    return true;
}

bool mutate_xml(fuzz_part in, size_t most, uint32_t *random, fuzz_bytes *out) {
    xml_tokens t = { 0 };
    (void)most;
    bool is = in.size > 8 && memchr("<\xef \n", in.data[0], 4) && read_tokens(in, &t),
         done = is && change_xml(in, &t, random, out);
    array_free(&t.list);
    array_free(&t.open);
    return done;
}
