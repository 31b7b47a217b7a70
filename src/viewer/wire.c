#include "viewer/wire.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const wire_modes[] = { "orbit", "fly", "walk", NULL };
const char *const wire_layouts[] = { "single", "divider", "methods", "difference", NULL };
static const char *const questions[] = { "pixel", "region", "lamp", "lights", "align", "find", "name", NULL };
static const char *const saves[] = { "png", "exr", "recipe", "csv", NULL };
static const char *const keys[] = { "forward", "back", "left", "right", "up", "down", "fast", "slow", NULL };

#define FAR 1e7        /* m, of a place */
#define MOST_IDS 1e9   /* of numbers that count */
#define TEXT_MOST 4096 /* bytes of a text */

/* A message that is being read. The first thing that is wrong with it is kept. */
typedef struct reading {
    const json_t *root;
    const char *kind;
    char *why;
    size_t why_size;
    bool wrong;
} reading;

__attribute__((format(printf, 2, 3))) static bool refuse(reading *r, const char *fmt, ...) {
    if (!r->wrong) {
        va_list ap;
        int n = snprintf(r->why, r->why_size, "%s: ", r->kind);
        va_start(ap, fmt);
        vsnprintf(r->why + n, r->why_size - (size_t)n, fmt, ap);
        va_end(ap);
    }
    r->wrong = true;
    return false;
}

static bool is_number(const json_t *value, double low, double high, double *out) {
    double number = json_is_number(value) ? json_number_value(value) : NAN;
    if (!(number >= low && number <= high))
        return false;
    *out = number;
    return true;
}

static bool numbers(const json_t *value, double low, double high, size_t count, double *out) {
    bool ok = json_array_size(value) == count;
    for (size_t i = 0; ok && i < count; i++)
        ok = is_number(json_array_get(value, i), low, high, &out[i]);
    return ok;
}

static void take_number(reading *r, const char *key, double low, double high, double *out) {
    if (!is_number(json_object_get(r->root, key), low, high, out))
        refuse(r, "%s is no number of %g to %g", key, low, high);
}

static bool take_flag(const reading *r, const char *key) { return json_is_true(json_object_get(r->root, key)); }

static bool has(const reading *r, const char *key) { return json_object_get(r->root, key) != NULL; }

static void take_numbers(reading *r, const char *key, double low, double high, size_t count, double *out) {
    if (!numbers(json_object_get(r->root, key), low, high, count, out))
        refuse(r, "%s is no list of %zu numbers of %g to %g", key, count, low, high);
}

/* A whole number. */
static void take_whole(reading *r, const char *key, double low, double high, double *out) {
    *out = low;
    if (!is_number(json_object_get(r->root, key), low, high, out) || *out != floor(*out))
        refuse(r, "%s is no whole number of %.0f to %.0f", key, low, high);
}

static int take_int(reading *r, const char *key, int low, int high) {
    double value;
    take_whole(r, key, low, high, &value);
    return (int)value;
}

static uint32_t take_count(reading *r, const char *key) {
    double value;
    take_whole(r, key, 0, MOST_IDS, &value);
    return (uint32_t)value;
}

/* Reads the number by which pictures acknowledge the message; 0: none. */
static uint32_t take_n(reading *r) { return has(r, "n") ? take_count(r, "n") : 0; }

static const char *text_of(const json_t *value) {
    const char *text = json_string_value(value);
    return text && json_string_length(value) <= TEXT_MOST && strlen(text) == json_string_length(value) ? text : NULL;
}

static const char *take_text(reading *r, const char *key) {
    const char *text = text_of(json_object_get(r->root, key));
    if (!text)
        refuse(r, "%s is no text of at most %d bytes", key, TEXT_MOST);
    return text ? text : "";
}

static int name_of(const char *text, const char *const *names) {
    for (int i = 0; text && names[i]; i++)
        if (!strcmp(text, names[i]))
            return i;
    return -1;
}

static int take_name(reading *r, const char *key, const char *const *names) {
    int found = name_of(json_string_value(json_object_get(r->root, key)), names);
    if (found < 0)
        refuse(r, "%s is none of those that there are", key);
    return found < 0 ? 0 : found;
}

static int take_pane(reading *r, int low) { return has(r, "pane") ? take_int(r, "pane", low, WIRE_PANES - 1) : 0; }

/* ---- by kind ---- */

static void read_hello(reading *r, wire_message *m) {
    m->hello.width = take_int(r, "width", 1, WIRE_SIDE);
    m->hello.height = take_int(r, "height", 1, WIRE_SIDE);
}

static void read_keys(reading *r, unsigned *out) {
    const json_t *list = json_object_get(r->root, "keys");
    if (list && (!json_is_array(list) || json_array_size(list) > 16))
        refuse(r, "keys is no list of keys");
    for (size_t i = 0; i < json_array_size(list) && !r->wrong; i++) {
        int key = name_of(json_string_value(json_array_get(list, i)), keys);
        if (key < 0)
            refuse(r, "keys has one that is not known");
        else
            *out |= 1u << key;
    }
}

static void read_input(reading *r, wire_message *m) {
    wire_input *in = &m->input;
    in->n = take_count(r, "n");
    if (has(r, "seconds")) {
        take_number(r, "seconds", 0, 1e6, &in->seconds); /* a page that slept */
        in->seconds = fmin(in->seconds, 1);
    }
    read_keys(r, &in->keys);
    if (has(r, "turn"))
        take_numbers(r, "turn", -100, 100, 2, in->turn);
    if (has(r, "pan"))
        take_numbers(r, "pan", -100, 100, 2, in->pan);
    if (has(r, "zoom"))
        take_number(r, "zoom", -1000, 1000, &in->zoom);
    in->has_at = has(r, "at");
    if (in->has_at)
        take_numbers(r, "at", -1, 2, 2, in->at);
}

static void read_navigate(reading *r, wire_message *m) {
    m->navigate.mode = (wire_mode)take_name(r, "mode", wire_modes);
    if (has(r, "speed"))
        take_number(r, "speed", 0, 1000, &m->navigate.speed);
}

/* false: it is none. */
static bool camera_of(const json_t *value, bool by_name, wire_camera *out) {
    const char *name = text_of(json_object_get(value, "name"));
    const json_t *eye = json_object_get(value, "eye"), *target = json_object_get(value, "target");
    out->name = name;
    if (by_name && !eye)
        return name;
    return numbers(eye, -FAR, FAR, 3, out->eye) && numbers(target, -FAR, FAR, 3, out->target) &&
           memcmp(out->eye, out->target, sizeof(out->eye)) &&
           is_number(json_object_get(value, "fov"), 1, 170, &out->fov);
}

static void read_camera(reading *r, wire_message *m) {
    m->camera.n = take_n(r);
    m->camera.still = take_flag(r, "still");
    if (!camera_of(r->root, true, &m->camera.to))
        refuse(r, "it has neither a name, nor eye, target and fov");
    if (has(r, "eye"))
        m->camera.to.name = NULL;
}

static void read_jump(reading *r, wire_message *m) {
    m->jump.n = take_n(r);
    m->jump.still = take_flag(r, "still");
    m->jump.pane = take_pane(r, 0);
    m->jump.has_place = has(r, "place");
    m->jump.distance = 25;
    if (has(r, "distance"))
        take_number(r, "distance", 1, 10000, &m->jump.distance);
    if (m->jump.has_place) {
        take_numbers(r, "place", -FAR, FAR, 3, m->jump.place);
        return;
    }
    take_number(r, "x", 0, 1, &m->jump.x);
    take_number(r, "y", 0, 1, &m->jump.y);
}

static void read_set(reading *r, wire_message *m) {
    m->set.n = take_n(r);
    m->set.pane = m->kind == WIRE_SET && has(r, "pane") ? take_pane(r, -1) : -1;
    m->set.name = take_text(r, "name");
    m->set.value = take_text(r, "value");
}

static void read_layout(reading *r, wire_message *m) {
    m->layout.n = take_n(r);
    m->layout.name = (wire_layout)take_name(r, "name", wire_layouts);
}

static void read_ack(reading *r, wire_message *m) {
    m->ack.pane = take_pane(r, 0);
    m->ack.n = take_count(r, "n");
}

static void read_watch(reading *r, wire_message *m) {
    const json_t *on = json_object_get(r->root, "on");
    if (!json_is_boolean(on))
        refuse(r, "on is neither true nor false");
    m->watch = json_is_true(on);
}

static void read_region(reading *r, wire_ask *ask) {
    const json_t *polygon = json_object_get(r->root, "polygon");
    size_t count = json_array_size(polygon);
    ask->has_rect = has(r, "rect");
    if (ask->has_rect) {
        take_numbers(r, "rect", -1, 2, 4, ask->rect);
    } else if (polygon) {
        if (count < 3 || count > WIRE_POINTS)
            refuse(r, "polygon has less than 3 or more than %d points", WIRE_POINTS);
        for (size_t i = 0; i < count && !r->wrong; i++)
            if (!numbers(json_array_get(polygon, i), -FAR, FAR, 2, ask->point[i]))
                refuse(r, "polygon has a point that is none");
        ask->points = (int)count;
    } else if (has(r, "street")) {
        ask->street = take_text(r, "street");
    } else {
        ask->object = take_text(r, "object");
    }
}

static void read_name(reading *r, wire_ask *ask) {
    ask->has_light = has(r, "light");
    ask->has_at = !ask->has_light && has(r, "at");
    if (ask->has_light)
        ask->light = take_count(r, "light");
    else if (ask->has_at)
        take_numbers(r, "at", -FAR, FAR, 2, ask->at);
    else if (has(r, "street"))
        ask->street = take_text(r, "street");
    else
        ask->object = take_text(r, "object");
}

static void read_pairs(reading *r, wire_ask *ask) {
    const json_t *pairs = json_object_get(r->root, "pairs");
    size_t count = json_array_size(pairs);
    if (count < 4 || count > WIRE_PAIRS)
        refuse(r, "pairs has less than 4 or more than %d", WIRE_PAIRS);
    for (size_t i = 0; i < count && !r->wrong; i++) {
        const json_t *pair = json_array_get(pairs, i);
        if (!numbers(json_object_get(pair, "photo"), -10, 10, 2, ask->photo[i]) ||
            !numbers(json_object_get(pair, "place"), -FAR, FAR, 3, ask->place[i]))
            refuse(r, "pairs has one that is none");
    }
    ask->pairs = (int)count;
    take_number(r, "aspect", 0.01, 100, &ask->aspect);
}

static void read_ask(reading *r, wire_message *m) {
    wire_ask *ask = &m->ask;
    ask->id = take_count(r, "id");
    ask->what = (wire_question)take_name(r, "what", questions);
    ask->pane = take_pane(r, 0);
    if (ask->what == WIRE_PIXEL) {
        take_number(r, "x", 0, 1, &ask->x);
        take_number(r, "y", 0, 1, &ask->y);
    } else if (ask->what == WIRE_REGION) {
        read_region(r, ask);
    } else if (ask->what == WIRE_LAMP) {
        ask->light = take_count(r, "light");
    } else if (ask->what == WIRE_LIGHTS) {
        ask->moving = take_flag(r, "moving");
    } else if (ask->what == WIRE_ALIGN) {
        read_pairs(r, ask);
    } else if (ask->what == WIRE_FIND) {
        ask->text = take_text(r, "text");
    } else if (ask->what == WIRE_NAME) {
        read_name(r, ask);
    }
}

static void read_cancel(reading *r, wire_message *m) { m->cancel = take_count(r, "id"); }

static void read_save(reading *r, wire_message *m) {
    const json_t *cameras = json_object_get(r->root, "cameras");
    size_t count = json_array_size(cameras);
    m->save.id = take_count(r, "id");
    m->save.what = (wire_save)take_name(r, "what", saves);
    m->save.pane = take_pane(r, 0);
    m->save.of = m->save.what == WIRE_CSV ? take_count(r, "of") : 0;
    if ((cameras && !json_is_array(cameras)) || count > WIRE_CAMERAS)
        refuse(r, "cameras is no list of at most %d", WIRE_CAMERAS);
    for (size_t i = 0; i < count && !r->wrong; i++)
        if (!camera_of(json_array_get(cameras, i), false, &m->save.camera[i]) || !m->save.camera[i].name)
            refuse(r, "cameras has one that is none");
    m->save.cameras = (int)count;
}

/* By wire_kind. */
static const struct {
    const char *name;
    void (*read)(reading *r, wire_message *m);
} kinds[] = {
    [WIRE_HELLO] = { "hello", read_hello },
    [WIRE_INPUT] = { "input", read_input },
    [WIRE_NAVIGATE] = { "navigate", read_navigate },
    [WIRE_CAMERA] = { "camera", read_camera },
    [WIRE_JUMP] = { "jump", read_jump },
    [WIRE_SET] = { "set", read_set },
    [WIRE_WORLD] = { "world", read_set },
    [WIRE_LAYOUT] = { "layout", read_layout },
    [WIRE_ACK] = { "ack", read_ack },
    [WIRE_WATCH] = { "watch", read_watch },
    [WIRE_ASK] = { "ask", read_ask },
    [WIRE_CANCEL] = { "cancel", read_cancel },
    [WIRE_SAVE] = { "save", read_save },
};

/* How deep its brackets go, so that the parser is not led deeper. */
static int depth(const char *text, size_t size) {
    int now = 0, most = 0;
    bool quoted = false;
    for (size_t i = 0; i < size; i++) {
        if (quoted && text[i] == '\\') {
            i++;
        } else if (text[i] == '"') {
            quoted = !quoted;
        } else if (!quoted) {
            now += (text[i] == '[' || text[i] == '{') - (text[i] == ']' || text[i] == '}');
            most = now > most ? now : most;
        }
    }
    return most;
}

bool wire_read(const char *text, size_t size, wire_message *message, char *why, size_t why_size) {
    *message = (wire_message){ 0 };
    reading r = { .kind = "message", .why = why, .why_size = why_size };
    if (size > WIRE_TEXT)
        return refuse(&r, "longer than %d bytes", WIRE_TEXT);
    if (depth(text, size) > WIRE_DEPTH)
        return refuse(&r, "deeper than %d", WIRE_DEPTH);
    r.root = message->root = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    if (!json_is_object(r.root)) {
        wire_free(message);
        return refuse(&r, "no JSON object");
    }
    const char *kind = json_string_value(json_object_get(r.root, "t"));
    size_t i = 0, count = sizeof(kinds) / sizeof(*kinds);
    while (i < count && (!kind || strcmp(kind, kinds[i].name)))
        i++;
    if (i == count) {
        refuse(&r, "t is no kind that is known");
    } else {
        r.kind = kinds[i].name;
        message->kind = (wire_kind)i;
        kinds[i].read(&r, message);
    }
    if (r.wrong)
        wire_free(message);
    return !r.wrong;
}

void wire_free(wire_message *message) {
    json_decref(message->root);
    message->root = NULL;
}

/* ---- what is sent ---- */

void wire_put_u32(unsigned char *out, uint32_t value) {
    for (int i = 0; i < 4; i++)
        out[i] = (unsigned char)(value >> 8 * i);
}

void wire_put_f32(unsigned char *out, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    wire_put_u32(out, bits);
}

void wire_write_head(const wire_head *head, unsigned char out[WIRE_HEAD]) {
    out[0] = (unsigned char)head->kind;
    out[1] = (unsigned char)head->pane;
    out[2] = head->png;
    out[3] = (unsigned char)head->flags;
    wire_put_u32(out + 4, head->number);
    wire_put_u32(out + 8, head->input);
    wire_put_u32(out + 12, (uint32_t)(head->width & 0xffff) | (uint32_t)head->height << 16);
    wire_put_u32(out + 16, head->frames);
    wire_put_f32(out + 20, head->error);
    wire_put_f32(out + 24, head->seconds);
    wire_put_u32(out + 28, head->name_size);
}

json_t *wire_begin(const char *kind) {
    json_t *message = json_object();
    json_object_set_new(message, "t", json_string(kind));
    return message;
}

char *wire_end(json_t *message) {
    char *text = message ? json_dumps(message, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(message);
    return text;
}

json_t *wire_text(const char *text) {
    json_t *value = json_string(text);
    if (value)
        return value;
    char *plain = strdup(text);
    for (char *c = plain; c && *c; c++)
        *c = *c & 0x80 ? '?' : *c;
    value = plain ? json_string(plain) : NULL;
    free(plain);
    return value;
}

char *wire_note(const char *level, const char *text) {
    json_t *message = wire_begin("note");
    json_object_set_new(message, "level", json_string(level));
    json_object_set_new(message, "text", wire_text(text));
    return wire_end(message);
}
