/* Which kernels this machine runs. */
#include "backend/cpu/kernels.h"

static const kernels *const tables[NOC_ISA_COUNT] = {
    [NOC_ISA_SCALAR] = &noc_kernels_scalar,
    [NOC_ISA_BASELINE] = &noc_kernels_baseline,
#if defined(__x86_64__)
    [NOC_ISA_AVX2] = &noc_kernels_avx2,
    [NOC_ISA_AVX512] = &noc_kernels_avx512,
#endif
};

int noc_runnable_kernels(const kernels *out[NOC_MAX_KERNELS]) {
    int n = 0;
    for (noc_isa isa = NOC_ISA_SCALAR; isa < NOC_ISA_COUNT; isa++)
        if (noc_isa_runs(isa))
            out[n++] = tables[isa];
    return n;
}

const kernels *noc_pick_kernels(noc_isa isa) {
    noc_isa chosen = NOC_ISA_SCALAR;
    noc_choose_isa(isa, &chosen, NULL);
    return tables[chosen];
}
