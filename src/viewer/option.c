/* Rows of the option tables as JSON, and errors as words. */
#include "viewer/option.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void hear(void *user, noc_log_level level, const char *text) {
    const viewer_ear *ear = user;
    if (level == NOC_LOG_ERROR)
        snprintf(ear->text, ear->size, "%s", text);
}

noc_log *viewer_listen(viewer_ear *ear) {
    return noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = hear, .user = ear });
}

bool viewer_wrong(char *why, size_t size, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, size, fmt, ap);
    va_end(ap);
    return false;
}

static unsigned char srgb8(double v) {
    double s = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
    return (unsigned char)lrint(255 * fmin(1, fmax(0, s)));
}

void viewer_colour(const double rgb[3], unsigned char out[3]) {
    double most = fmax(rgb[0], fmax(rgb[1], rgb[2]));
    for (int k = 0; k < 3; k++)
        out[k] = most > 0 ? srgb8(rgb[k] / most) : 0;
}

bool viewer_among(const char *name, const char *const *names, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(name, names[i]))
            return true;
    return false;
}

bool viewer_option_set(const noc_option *o, void *params, const char *value, char *why, size_t size) {
    viewer_ear ear = { why, size };
    noc_log *log = viewer_listen(&ear);
    noc_status status = noc_option_set(o, params, value, log);
    noc_log_destroy(log);
    return !status;
}

static const char *kind_name(noc_option_kind kind) {
    switch (kind) {
    case NOC_OPTION_BOOL: return "bool";
    case NOC_OPTION_SWITCH: return "switch";
    case NOC_OPTION_INT:
    case NOC_OPTION_UINT: return "int";
    case NOC_OPTION_REAL: return "real";
    case NOC_OPTION_CHOICE: return "choice";
    default: return "text";
    }
}

json_t *viewer_option_json(const noc_option *o, const void *params) {
    char value[200];
    noc_option_get(o, params, value, sizeof(value));
    json_t *row = json_pack("{ss ss ss ss ss ss}", "name", o->name, "group", o->group, "kind", kind_name(o->kind),
                            "unit", o->unit, "help", o->help, "value", value);
    if (o->kind == NOC_OPTION_INT || o->kind == NOC_OPTION_UINT || o->kind == NOC_OPTION_REAL) {
        json_object_set_new(row, "min", json_real(o->min));
        json_object_set_new(row, "max", json_real(o->max));
    }
    json_t *choices = o->choices ? json_array() : NULL;
    for (const char *c = o->choices; c && *c;) {
        size_t n = strcspn(c, "|");
        json_array_append_new(choices, json_stringn(c, n));
        c += n + (c[n] == '|');
    }
    if (choices)
        json_object_set_new(row, "choices", choices);
    if (o->needs)
        json_object_set_new(row, "needs", json_string(o->needs));
    return row;
}

const char *viewer_utf8(char *text, size_t size, const char *latin1) {
    size_t n = 0;
    for (const unsigned char *c = (const unsigned char *)latin1; *c && n + 2 < size; c++) {
        if (*c >= 0x80)
            text[n++] = (char)(0xc0 | *c >> 6);
        text[n++] = (char)(*c < 0x80 ? *c : 0x80 | (*c & 0x3f));
    }
    text[n] = 0;
    return text;
}
