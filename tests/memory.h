/* Refusing allocations one after the other: each has to end in NOC_ERR_MEMORY and one message, or change nothing. */
#ifndef NOC_TEST_MEMORY_H
#define NOC_TEST_MEMORY_H

#include "test.h"

#include "base/base.h"

typedef struct refusal {
    uint64_t number;
    bool and_later;
    int errors; /* told since it began */
    char first_error[256];
} refusal;

static refusal refusing;

static void count_error(void *user, noc_log_level level, const char *text) {
    if (level == NOC_LOG_ERROR && !refusing.errors++)
        snprintf(refusing.first_error, sizeof(refusing.first_error), "%s", text);
}

static inline noc_log *counting_log(void) {
    noc_log_params params = noc_log_default_params();
    params.message = count_error;
    return noc_log_create(&params);
}

static inline void begin_refusal(uint64_t number, bool and_later) {
    refusing = (refusal){ .number = number, .and_later = and_later };
    noc_refuse_allocation(number, and_later);
}

/* Whether as many were asked for. */
static inline bool end_refusal(void) {
    bool reached = noc_allocations() >= refusing.number;
    noc_refuse_allocation(0, false);
    return reached;
}

/* Each for a while, then ever fewer: where work goes on and on, it asks from the same places. */
static inline uint64_t next_refusal(uint64_t number) { return number + 1 + (number > 60 ? number / 8 : 0); }

#define FOR_EACH_REFUSAL(reached)                                                                                      \
    for (int later = 0; later < 2; later++)                                                                            \
        for (uint64_t n = ((reached) = true, 1); (reached); n = next_refusal(n))

/* Each, where something is asked for once and late, as by a frame's passes. */
#define FOR_EVERY_REFUSAL(reached)                                                                                     \
    for (int later = 0; later < 2; later++)                                                                            \
        for (uint64_t n = ((reached) = true, 1); (reached); n++)

/* What a call said that met a refusal: memory, once. */
static inline void assert_refused(noc_status status, const char *what) {
    if (status != NOC_ERR_MEMORY || refusing.errors != 1 || !strstr(refusing.first_error, "memory"))
        fail_msg("%s, allocation %llu%s: status %d, %d errors, \"%s\"", what, (unsigned long long)refusing.number,
                 refusing.and_later ? " and later" : "", status, refusing.errors, refusing.first_error);
}

static inline void assert_unharmed(bool same, const char *what) {
    if (!same || refusing.errors)
        fail_msg("%s, allocation %llu%s: passed, but %s", what, (unsigned long long)refusing.number,
                 refusing.and_later ? " and later" : "", same ? refusing.first_error : "it is not the same");
}

#endif
