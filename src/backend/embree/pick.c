/* Which kernels this machine runs. */
#include "backend/embree/kernels.h"

const kernels *noc_pick_kernels(noc_path path) {
    if (path == NOC_PATH_SCALAR)
        return &noc_kernels_scalar;
#if defined(__x86_64__)
    __builtin_cpu_init();
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl"))
        return &noc_kernels_avx512;
    if (avx2)
        return &noc_kernels_avx2;
#endif
    return &noc_kernels_baseline;
}
