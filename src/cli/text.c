#include "cli.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *program = "nocturne";

void cli_called(const char *name) { program = name && *name ? name : program; }

const char *cli_program(void) { return program; }

char *cli_ids(const char *list, size_t count, size_t width) {
    enum { LISTED = 5 }; /* by the library: fewer are all there are */
    size_t shown = 0, listed = 0, end = 0;
    for (const char *at = list; *at; listed++) {
        size_t n = strcspn(at, ",");
        if (shown == listed && (!shown || (size_t)(at - list) + n <= width)) {
            end = (size_t)(at - list) + n;
            shown++;
        }
        at += n;
        at += strspn(at, ", ");
    }
    char more[64] = "", number[32];
    if (count > shown && (shown < listed || listed == LISTED))
        snprintf(more, sizeof(more), " and %s more", noc_text_count(number, count - shown));
    char *text = cli_format("%.*s%s", (int)end, list, more);
    noc_text_clean(text, strlen(text) + 1, text);
    return text;
}

static void vreport(const char *prefix, const char *fmt, va_list ap) {
    char text[1024], clean[1024];
    vsnprintf(text, sizeof(text), fmt, ap);
    cli_progress_clear();
    fprintf(stderr, "nocturne: %s%s\n", prefix, noc_text_clean(clean, sizeof(clean), text));
}

void cli_error(const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    vreport("", fmt, ap);
    va_end(ap);
}

int cli_read_on(const cli_command *command) {
    fprintf(stderr, "Try 'nocturne help%s%s'.\n", command ? " " : "", command ? command->name : "");
    return CLI_USAGE;
}

int cli_usage(const cli_command *command, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    vreport("", fmt, ap);
    va_end(ap);
    return cli_read_on(command);
}

void cli_log_message(void *user, noc_log_level level, const char *text) {
    cli_progress_clear();
    fprintf(stderr, "nocturne: %s%s\n", level == NOC_LOG_WARN ? "warning: " : "", text);
}

void cli_no_memory(void) {
    cli_error("out of memory");
    exit(CLI_FAILURE);
}

noc_log_level cli_log_level(const cli_args *args) {
    return args->quiet ? NOC_LOG_ERROR : args->verbose ? NOC_LOG_DEBUG : NOC_LOG_WARN;
}

noc_log *cli_log_create(const cli_args *args) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = cli_log_level(args), .message = cli_log_message });
    if (!log)
        cli_no_memory();
    return log;
}

const char *cli_number(char text[32], double v) {
    if (v >= 999.95 && v < 1e15)
        return noc_text_count(text, (uint64_t)round(v));
    snprintf(text, 32, "%.4g", v);
    return text;
}

void *cli_alloc(size_t size) {
    void *p = calloc(1, size ? size : 1);
    if (!p)
        cli_no_memory();
    return p;
}

double cli_auto_ev100(const noc_image *image) {
    double ev100 = noc_image_auto_ev100(image);
    if (ev100 != ev100)
        cli_no_memory();
    return ev100;
}

char *cli_format(const char *fmt, ...) {
    va_list ap, again;
    va_start(ap, fmt);
    va_copy(again, ap);
    int n = vsnprintf(NULL, 0, fmt, ap);
    char *text = cli_alloc((size_t)n + 1);
    vsnprintf(text, (size_t)n + 1, fmt, again);
    va_end(again);
    va_end(ap);
    return text;
}

uint64_t cli_sum(uint64_t sum, const void *data, size_t size) { /* FNV-1a */
    const unsigned char *bytes = data;
    sum = sum ? sum : 0xcbf29ce484222325u;
    for (size_t i = 0; i < size; i++)
        sum = (sum ^ bytes[i]) * 0x100000001b3u;
    return sum ? sum : 1;
}

void cli_json_text(FILE *out, const char *text) {
    fputc('"', out);
    for (const unsigned char *s = (const unsigned char *)(text ? text : ""); *s;) {
        size_t n = noc_text_utf8((const char *)s);
        if (!n) {
            fputs("\\ufffd", out);
            s++;
        } else if (*s < 32 || *s == '"' || *s == '\\' || *s == 127) {
            fprintf(out, "\\u%04x", *s++);
        } else {
            fwrite(s, 1, n, out);
            s += n;
        }
    }
    fputc('"', out);
}

const char *cli_not_utf8(const char *text) {
    const unsigned char *s = (const unsigned char *)text;
    for (size_t n; *s; s += n)
        if (!(n = noc_text_utf8((const char *)s)))
            return (const char *)s;
    return NULL;
}

void cli_yaml_text(FILE *out, const char *text) {
    size_t size = (size_t)noc_text_yaml(NULL, 0, text) + 1;
    char *quoted = cli_alloc(size);
    noc_text_yaml(quoted, size, text);
    fputs(quoted, out);
    free(quoted);
}

void cli_json_number(FILE *out, double v) {
    if (isfinite(v))
        fprintf(out, "%.15g", v);
    else
        fputs("null", out);
}

bool cli_flush(FILE *out) {
    errno = 0;
    if (!fflush(out) && !ferror(out))
        return true;
    cli_error("standard output: %s", errno ? strerror(errno) : "cannot be written");
    return false;
}
