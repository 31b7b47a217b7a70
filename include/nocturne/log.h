/* nocturne/log.h: status codes, the log, and how errors reach the embedding program.
 *
 * Every function that can fail returns a noc_status (or NULL / a negative index) and reports the reason exactly once
 * through the noc_log it was given, at level NOC_LOG_ERROR, with the file and the place in it where there is one.
 * The library prints nothing: what it has to say goes to the log's callback, and nowhere without one.
 * NULL for a noc_log drops the messages; NULL for a struct of params stands for its defaults; NULL for anything else
 * that a call needs is NOC_ERR_ARGUMENT, or whatever the function returns for an error. A noc_log may be used from
 * several threads at once; its callback is called with a lock held, one message at a time. So the callback must not
 * call anything that logs to the same noc_log: that would wait for the lock for ever. */
#ifndef NOCTURNE_LOG_H
#define NOCTURNE_LOG_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define NOC_API __attribute__((visibility("default")))
#define NOC_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define NOC_API
#define NOC_PRINTF(f, a)
#endif

/* Defaults are lists of set(field, value), stated once for both languages. Each noc_X_default_params() gives a
 * noc_X_params whose address may be taken: in C it is a compound literal (fit for initialisers), in C++ a constant that
 * lasts. */
#define NOC_DEFAULT_IN_C(field, value) .field = value,
#ifdef __cplusplus
#define NOC_DEFAULT_IN_CXX(field, value) field = value;
#define NOC_DEFAULT_PARAMS(params, function, list)                                                                     \
    extern "C++" inline const params &function() {                                                                     \
        struct defaults : params {                                                                                     \
            defaults() : params() { list(NOC_DEFAULT_IN_CXX) }                                                         \
        };                                                                                                             \
        static const defaults value;                                                                                   \
        return value;                                                                                                  \
    }
#endif

typedef enum noc_status {
    NOC_OK = 0,
    NOC_ERR_ARGUMENT, /* a parameter is out of its documented range */
    NOC_ERR_IO,       /* a file cannot be opened, read or written */
    NOC_ERR_FORMAT,   /* a file is not what it says, or is damaged */
    /* memory was refused, or a limit of it reached; what was half made is freed, what was there before stays */
    NOC_ERR_MEMORY,
    NOC_ERR_UNSUPPORTED, /* this build lacks the part, or the format has a feature that is not read */
    NOC_ERR_CANCELLED,   /* the progress callback asked to stop */
    NOC_ERR_LOST,        /* the device was lost, by its driver or its cable; a new noc_device is needed */
} noc_status;

typedef enum noc_log_level { NOC_LOG_ERROR, NOC_LOG_WARN, NOC_LOG_INFO, NOC_LOG_DEBUG } noc_log_level;

typedef struct noc_log noc_log;

typedef struct noc_log_params {
    noc_log_level level;                                                /* messages above this level are dropped */
    void (*message)(void *user, noc_log_level level, const char *text); /* one line a message; NULL: none are told */
    void *user;
} noc_log_params;

#define NOC_LOG_DEFAULTS(set) set(level, NOC_LOG_WARN)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_log_params, noc_log_default_params, NOC_LOG_DEFAULTS)
#else
#define noc_log_default_params() ((noc_log_params){ NOC_LOG_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* NULL params means the defaults: no callback, so that noc_log_last_error alone tells. Returns NULL only when memory is
 * refused. */
NOC_API noc_log *noc_log_create(const noc_log_params *params);
NOC_API void noc_log_destroy(noc_log *log); /* NULL is allowed */
/* Text of the last error reported to this log, "" if none; valid until the next error. A call that its progress
 * callback cancelled leaves one too, though its message is of level NOC_LOG_INFO. Not for use while other threads log.
 */
NOC_API const char *noc_log_last_error(const noc_log *log);
/* Copies that text, cut to size bytes with its end; other threads may log meanwhile. */
NOC_API void noc_log_copy_error(noc_log *log, char *text, size_t size);
NOC_API const char *noc_status_text(noc_status status);

/* Progress of long work. done runs from 0 to 1; return false to cancel. Called from the thread that started the work.
 */
typedef struct noc_progress {
    bool (*update)(void *user, const char *what, double done);
    void *user;
} noc_progress;

#ifdef __cplusplus
}
#endif
#endif
