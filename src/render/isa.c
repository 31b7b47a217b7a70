/* Instruction sets: which this processor has, and which one a frame's kernels are to use. */
#include "render/backend.h"

#include <stdio.h>

static const char *const names[NOC_ISA_COUNT] = { "auto", "scalar", "baseline", "avx2", "avx512" };

const char *noc_isa_name(noc_isa isa) { return (unsigned)isa < NOC_ISA_COUNT ? names[isa] : "unknown"; }

bool noc_isa_runs(noc_isa isa) {
#if defined(__x86_64__)
    __builtin_cpu_init();
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
    bool avx2 = false, avx512 = false;
#endif
    switch (isa) {
    case NOC_ISA_AUTO:
    case NOC_ISA_SCALAR:
    case NOC_ISA_BASELINE: return true;
    case NOC_ISA_AVX2: return avx2;
    case NOC_ISA_AVX512: return avx512;
    default: return false;
    }
}

/* "scalar, baseline and avx2", from the first level on. */
static void list_names(noc_isa first, bool all, char *text, size_t size) {
    noc_isa last = NOC_ISA_COUNT - 1;
    size_t at = 0;
    while (!all && !noc_isa_runs(last))
        last--;
    for (noc_isa i = first; i <= last && at < size; i++)
        at += (size_t)snprintf(text + at, size - at, "%s%s", names[i],
                               i == last       ? ""
                               : i + 1 == last ? (all ? " or " : " and ")
                                               : ", ");
}

noc_status noc_choose_isa(noc_isa asked, noc_isa *chosen, noc_log *log) {
    const char *from = "render: isa", *text = getenv(NOC_ISA_VARIABLE);
    char words[80];
    if (asked == NOC_ISA_AUTO && text && *text) {
        from = NOC_ISA_VARIABLE;
        for (asked = 0; asked < NOC_ISA_COUNT && strcmp(text, names[asked]); asked++)
            ;
        if (asked == NOC_ISA_COUNT) {
            list_names(NOC_ISA_AUTO, true, words, sizeof(words));
            return noc_error(log, NOC_ERR_ARGUMENT, "%s: \"%.60s\" is no instruction set, must be %s", from, text,
                             words);
        }
    }
    if ((unsigned)asked >= NOC_ISA_COUNT)
        return noc_error(log, NOC_ERR_ARGUMENT, "render: isa is %d, must be a noc_isa", (int)asked);
    if (!noc_isa_runs(asked)) {
        list_names(NOC_ISA_SCALAR, false, words, sizeof(words));
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: this processor has no %s, it runs %s", from, names[asked],
                         words);
    }
    for (*chosen = asked ? asked : NOC_ISA_COUNT - 1; !noc_isa_runs(*chosen);)
        --*chosen;
    return NOC_OK;
}

noc_isa noc_rows_isa(noc_isa asked) {
    noc_isa isa = NOC_ISA_BASELINE;
    return noc_choose_isa(asked, &isa, NULL) ? NOC_ISA_BASELINE : isa;
}
