/* Members of the spec's objects: each is an option of a table, under the same name and the same rules as on the command
 * line. */
#include "lab/member.h"

#include <math.h>

noc_status lab_wrong(const lab_spec *spec, const char *place, const char *fmt, ...) {
    char text[600];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    return noc_error(spec->log, NOC_ERR_FORMAT, "%.200s: %s%s%s", spec->path, place, *place ? ": " : "", text);
}

noc_status lab_too_many(const lab_spec *spec, const char *place, size_t count, size_t most, const char *what) {
    return count > most ? lab_wrong(spec, place, "it asks for more than %zu %s", most, what) : NOC_OK;
}

noc_status lab_spec_no_memory(const lab_spec *spec) { return noc_no_memory(spec->log, spec->path); }

const noc_option *lab_option(const lab_options *options, const char *name, size_t *offset) {
    for (; options->table; options++)
        for (const noc_option *o = options->table(); o->name; o++)
            if (!strcmp(o->name, name) && !lab_among(options->hidden, o->name)) {
                *offset = options->offset;
                return o;
            }
    return NULL;
}

enum { FEW = 24, MOST = 200 }; /* names that an error lists, and that are looked at */

static noc_status unknown(const lab_spec *spec, const char *place, const lab_options *options,
                          const char *const *others, const char *name) {
    const char *words[MOST] = { NULL };
    size_t count = 0;
    for (; options->table; options++)
        for (const noc_option *o = options->table(); o->name && count < MOST; o++)
            if (!lab_among(options->hidden, o->name))
                words[count++] = o->name;
            else if (!strcmp(o->name, name))
                return lab_wrong(spec, place, "%s: the spec says it for all pictures (size, seed, accumulate)", name);
    for (; others && *others && count < MOST; others++)
        words[count++] = *others;
    const char *nearest = noc_text_nearest(name, words, count);
    if (nearest)
        return lab_wrong(spec, place, "no option \"%.60s\"; is it \"%s\"?", name, nearest);
    if (count > FEW)
        return lab_wrong(spec, place,
                         "no option \"%.60s\"; 'nocturne help render' and docs/experiments.md tell which there are",
                         name);
    char all[400];
    for (size_t i = 0, at = 0; i < count && at < sizeof(all); i++)
        at += (size_t)noc_snprintf(all + at, sizeof(all) - at, "%s%s", i ? ", " : "", words[i]);
    return lab_wrong(spec, place, "no option \"%.60s\"; there are %s", name, all);
}

/* A value as it would be written on the command line, in the spec's arena; NULL where JSON has no such thing there, and
 * where memory is refused, which the arena knows. An array of a few numbers is a list. */
static char *spell(noc_arena *arena, const json_t *value) {
    switch (json_typeof(value)) {
    case JSON_STRING: return arena_strdup(arena, json_string_value(value));
    case JSON_TRUE: return arena_strdup(arena, "true");
    case JSON_FALSE: return arena_strdup(arena, "false");
    case JSON_INTEGER: return arena_format(arena, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    case JSON_REAL: return arena_format(arena, "%.17g", json_real_value(value));
    case JSON_ARRAY: break;
    default: return NULL;
    }
    char text[LAB_NUMBERS * 32] = "";
    size_t i, at = 0;
    json_t *item;
    json_array_foreach((json_t *)value, i, item) {
        if (!json_is_number(item))
            return NULL;
        const char *comma = i ? "," : "";
        if (json_is_integer(item))
            at += (size_t)noc_snprintf(text + at, sizeof(text) - at, "%s%" JSON_INTEGER_FORMAT, comma,
                                       json_integer_value(item));
        else
            at += (size_t)noc_snprintf(text + at, sizeof(text) - at, "%s%.17g", comma, json_real_value(item));
    }
    return arena_strdup(arena, text);
}

static void keep_message(void *user, noc_log_level level, const char *text) { noc_snprintf(user, 256, "%s", text); }

noc_status lab_set(lab_spec *spec, const char *place, const lab_options *options, const char *const *others,
                   void *params, const char *name, json_t *value) {
    size_t offset = 0;
    if (lab_among(others, name))
        return NOC_OK;
    const noc_option *o = lab_option(options, name, &offset);
    if (!o)
        return unknown(spec, place, options, others, name);
    if (o->kind == NOC_OPTION_TEXTS && json_is_array(value)) { /* one after the other, as on a command line */
        noc_status status = NOC_OK;
        for (size_t i = 0; i < json_array_size(value) && !status; i++) {
            json_t *item = json_array_get(value, i);
            status = json_is_string(item) ? lab_set(spec, place, options, others, params, name, item)
                                          : lab_wrong(spec, place, "%s: an array of texts", name);
        }
        return status;
    }
    if (json_is_array(value) && o->kind == NOC_OPTION_TEXT && json_array_size(value) > LAB_NUMBERS)
        return lab_wrong(spec, place, "%s: it asks for more than %d numbers", name, LAB_NUMBERS);
    char *text = json_is_array(value) && o->kind != NOC_OPTION_TEXT ? NULL : spell(&spec->arena, value);
    if (spec->arena.refused)
        return lab_spec_no_memory(spec);
    if (!text)
        return lab_wrong(spec, place, "%s: this cannot be its value", name);
    char message[256] = "";
    noc_log *log = noc_log_create(&(noc_log_params){ .message = keep_message, .user = message });
    if (!log)
        return lab_spec_no_memory(spec);
    noc_status status = noc_option_set(o, (char *)params + offset, text, log);
    noc_log_destroy(log);
    return status ? lab_wrong(spec, place, "%s", message) : NOC_OK;
}

noc_status lab_set_all(lab_spec *spec, const char *place, json_t *object, const lab_options *options,
                       const char *const *others, void *params) {
    if (!object)
        return NOC_OK;
    if (!json_is_object(object))
        return lab_wrong(spec, place, "this must be an object, {...}");
    const char *name;
    json_t *value;
    json_object_foreach(object, name, value) {
        noc_status status = lab_set(spec, place, options, others, params, name, value);
        if (status)
            return status;
    }
    return NOC_OK;
}

noc_status lab_read_name(lab_spec *spec, const char *place, json_t *object, const char **name) {
    const char *text = json_string_value(json_object_get(object, "name"));
    if (!text || !*text)
        return lab_wrong(spec, place, "it needs a name");
    if (strlen(text) > LAB_NAME)
        return lab_wrong(spec, place, "its name is longer than %d bytes", LAB_NAME);
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            return lab_wrong(spec, place, "its name holds a control character");
    *name = arena_strdup(&spec->arena, text);
    return *name ? NOC_OK : lab_spec_no_memory(spec);
}

bool lab_read_box(const char *text, int width, int height, int box[4]) {
    double v[4];
    bool right = noc_text_numbers(text, ',', 4, v);
    for (int i = 0; right && i < 4; i++) {
        right = v[i] == floor(v[i]) && v[i] >= (i > 1) && v[i] <= NOC_IMAGE_MAX_SIDE;
        box[i] = right ? (int)v[i] : 0;
    }
    return right && box[0] + box[2] <= width && box[1] + box[3] <= height;
}
