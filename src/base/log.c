#include "base/base.h"

#include <pthread.h>

struct noc_log {
    noc_log_params params;
    pthread_mutex_t lock;
    char last_error[1024];
    noc_status last_status;
};

noc_log *noc_log_create(const noc_log_params *params) {
    noc_log *log = noc_calloc(1, sizeof(*log));
    if (!log)
        return NULL;
    log->params = params ? *params : noc_log_default_params();
    pthread_mutex_init(&log->lock, NULL);
    return log;
}

void noc_log_destroy(noc_log *log) {
    if (!log)
        return;
    pthread_mutex_destroy(&log->lock);
    free(log);
}

const char *noc_log_last_error(const noc_log *log) { return log ? log->last_error : ""; }

void noc_log_copy_error(noc_log *log, char *text, size_t size) {
    if (text && size)
        *text = 0;
    if (!log || !text || !size)
        return;
    pthread_mutex_lock(&log->lock);
    noc_snprintf(text, size, "%s", log->last_error);
    pthread_mutex_unlock(&log->lock);
}

noc_status noc_log_last_status(const noc_log *log) { return log && log->last_status ? log->last_status : NOC_ERR_IO; }

const char *noc_status_text(noc_status status) {
    switch (status) {
    case NOC_OK: return "ok";
    case NOC_ERR_ARGUMENT: return "bad argument";
    case NOC_ERR_IO: return "input or output failed";
    case NOC_ERR_FORMAT: return "bad file";
    case NOC_ERR_MEMORY: return "out of memory";
    case NOC_ERR_UNSUPPORTED: return "not supported";
    case NOC_ERR_CANCELLED: return "cancelled";
    case NOC_ERR_LOST: return "device lost";
    }
    return "unknown status";
}

/* keep: it is the reason why a call fails, whatever its level. */
static void emit(noc_log *log, noc_log_level level, bool keep, const char *fmt, va_list ap) {
    if (!log || (level > log->params.level && !keep))
        return;
    char text[1024];
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    /* Text from files may hold control characters: none may reach a terminal. */
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = ' ';
    pthread_mutex_lock(&log->lock);
    if (keep)
        memcpy(log->last_error, text, sizeof(text));
    if (level <= log->params.level && log->params.message)
        log->params.message(log->params.user, level, text);
    pthread_mutex_unlock(&log->lock);
}

noc_status noc_error(noc_log *log, noc_status status, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    emit(log, NOC_LOG_ERROR, true, fmt, ap);
    va_end(ap);
    if (log) {
        pthread_mutex_lock(&log->lock);
        log->last_status = status;
        pthread_mutex_unlock(&log->lock);
    }
    return status;
}

noc_status noc_null(noc_log *log, const char *function) {
    return noc_error(log, NOC_ERR_ARGUMENT, "%s: a pointer that is needed is NULL", function);
}

noc_status noc_no_memory(noc_log *log, const char *where) {
    return noc_error(log, NOC_ERR_MEMORY, "%s: out of memory", where);
}

noc_status noc_cancelled(noc_log *log, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    emit(log, NOC_LOG_INFO, true, fmt, ap);
    va_end(ap);
    return NOC_ERR_CANCELLED;
}

#define NOC_LOG_FUNCTION(name, level)                                                                                  \
    void name(noc_log *log, const char *fmt, ...) {                                                                    \
        va_list ap;                                                                                                    \
        va_start(ap, fmt);                                                                                             \
        emit(log, level, false, fmt, ap);                                                                              \
        va_end(ap);                                                                                                    \
    }
NOC_LOG_FUNCTION(noc_warn, NOC_LOG_WARN)
NOC_LOG_FUNCTION(noc_info, NOC_LOG_INFO)
NOC_LOG_FUNCTION(noc_debug, NOC_LOG_DEBUG)
