/* Members of the spec's objects: each is an option of a table, under the same name and the same rules as on the command
 * line. */
#include "lab/lab.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

int lab_wrong(const lab_spec *spec, const char *place, const char *fmt, ...) {
    char text[600];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    return cli_usage(&cli_experiment, "%.200s: %s%s%s", spec->path, place, *place ? ": " : "", text);
}

int lab_too_many(const lab_spec *spec, const char *place, size_t count, size_t most, const char *what) {
    return count > most ? lab_wrong(spec, place, "it asks for more than %zu %s", most, what) : CLI_OK;
}

void *lab_longer(void *array, size_t size) {
    array = realloc(array, size);
    if (!array)
        cli_no_memory();
    return array;
}

void *lab_keep(lab_spec *spec, void *memory) {
    spec->kept = lab_longer(spec->kept, sizeof(void *) * (spec->kept_count + 1));
    return spec->kept[spec->kept_count++] = memory;
}

const noc_option *lab_option(const cli_set *sets, const char *name, size_t *offset) {
    for (const cli_set *set = sets; set->table; set++) {
        for (const noc_option *o = set->table(); o->name; o++) {
            if (!strcmp(o->name, name) && !cli_hidden(set, o)) {
                *offset = set->offset;
                return o;
            }
        }
    }
    return NULL;
}

enum { FEW = 24 }; /* names that an error lists */

static int unknown(const lab_spec *spec, const char *place, const cli_set *sets, const char *const *others,
                   const char *name) {
    const char *words[2 * CLI_GIVEN] = { NULL };
    size_t count = 0;
    for (const cli_set *set = sets; set->table; set++)
        for (const noc_option *o = set->table(); o->name && count < CLI_GIVEN; o++)
            if (!cli_hidden(set, o))
                words[count++] = o->name;
            else if (!strcmp(o->name, name))
                return lab_wrong(spec, place, "%s: the spec says it for all pictures (size, seed, accumulate)", name);
    for (; others && *others && count < 2 * CLI_GIVEN; others++)
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
        at += (size_t)snprintf(all + at, sizeof(all) - at, "%s%s", i ? ", " : "", words[i]);
    return lab_wrong(spec, place, "no option \"%.60s\"; there are %s", name, all);
}

/* A value as it would be written on the command line; NULL where JSON has no such thing there. An array of a few
 * numbers is a list. */
static char *spell(const json_t *value) {
    switch (json_typeof(value)) {
    case JSON_STRING: return cli_format("%s", json_string_value(value));
    case JSON_TRUE: return cli_format("true");
    case JSON_FALSE: return cli_format("false");
    case JSON_INTEGER: return cli_format("%" JSON_INTEGER_FORMAT, json_integer_value(value));
    case JSON_REAL: return cli_format("%.17g", json_real_value(value));
    case JSON_ARRAY: break;
    default: return NULL;
    }
    char *text = cli_format("%s", "");
    size_t i;
    json_t *item;
    json_array_foreach((json_t *)value, i, item) {
        char *number = json_is_number(item) ? spell(item) : NULL;
        char *longer = number ? cli_format("%s%s%s", text, i ? "," : "", number) : NULL;
        free(text);
        free(number);
        if (!longer)
            return NULL;
        text = longer;
    }
    return text;
}

static void keep_message(void *user, noc_log_level level, const char *text) { snprintf(user, 256, "%s", text); }

int lab_set(lab_spec *spec, const char *place, const cli_set *sets, const char *const *others, void *params,
            const char *name, json_t *value) {
    size_t offset = 0;
    for (const char *const *other = others; other && *other; other++)
        if (!strcmp(*other, name))
            return CLI_OK;
    const noc_option *o = lab_option(sets, name, &offset);
    if (!o)
        return unknown(spec, place, sets, others, name);
    if (o->kind == NOC_OPTION_TEXTS && json_is_array(value)) { /* one after the other, as on a command line */
        int status = CLI_OK;
        for (size_t i = 0; i < json_array_size(value) && !status; i++) {
            json_t *item = json_array_get(value, i);
            status = json_is_string(item) ? lab_set(spec, place, sets, others, params, name, item)
                                          : lab_wrong(spec, place, "%s: an array of texts", name);
        }
        return status;
    }
    if (json_is_array(value) && o->kind == NOC_OPTION_TEXT && json_array_size(value) > LAB_NUMBERS)
        return lab_wrong(spec, place, "%s: it asks for more than %d numbers", name, LAB_NUMBERS);
    char *text = json_is_array(value) && o->kind != NOC_OPTION_TEXT ? NULL : spell(value);
    if (!text)
        return lab_wrong(spec, place, "%s: this cannot be its value", name);
    lab_keep(spec, text);
    char message[256] = "";
    noc_log *log = noc_log_create(&(noc_log_params){ .message = keep_message, .user = message });
    noc_status status = noc_option_set(o, (char *)params + offset, text, log);
    noc_log_destroy(log);
    return status ? lab_wrong(spec, place, "%s", message) : CLI_OK;
}

int lab_set_all(lab_spec *spec, const char *place, json_t *object, const cli_set *sets, const char *const *others,
                void *params) {
    if (!object)
        return CLI_OK;
    if (!json_is_object(object))
        return lab_wrong(spec, place, "this must be an object, {...}");
    const char *name;
    json_t *value;
    json_object_foreach(object, name, value) {
        int status = lab_set(spec, place, sets, others, params, name, value);
        if (status)
            return status;
    }
    return CLI_OK;
}

int lab_read_name(lab_spec *spec, const char *place, json_t *object, const char **name) {
    const char *text = json_string_value(json_object_get(object, "name"));
    if (!text || !*text)
        return lab_wrong(spec, place, "it needs a name");
    if (strlen(text) > 80)
        return lab_wrong(spec, place, "its name is longer than 80 bytes");
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            return lab_wrong(spec, place, "its name holds a control character");
    *name = lab_keep(spec, cli_format("%s", text));
    return CLI_OK;
}
