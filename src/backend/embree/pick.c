/* Which kernels this machine runs. */
#include "backend/embree/kernels.h"

int noc_runnable_kernels(const kernels *out[NOC_MAX_KERNELS]) {
    int n = 0;
    out[n++] = &noc_kernels_scalar;
    out[n++] = &noc_kernels_baseline;
#if defined(__x86_64__)
    __builtin_cpu_init();
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    if (avx2)
        out[n++] = &noc_kernels_avx2;
    if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
        out[n++] = &noc_kernels_avx512;
#endif
    return n;
}

const kernels *noc_pick_kernels(noc_path path) {
    const kernels *all[NOC_MAX_KERNELS];
    int n = noc_runnable_kernels(all);
    return path == NOC_PATH_SCALAR ? all[0] : all[n - 1];
}
