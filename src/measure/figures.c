/* What a set of readings says. */
#include "base/base.h"

#include <math.h>
#include <nocturne/measure.h>

const char *noc_response_name(noc_response response) {
    static const char *const names[NOC_RESPONSE_COUNT] = { "plane", "semicylinder", "cylinder", "hemisphere" };
    return (unsigned)response < NOC_RESPONSE_COUNT ? names[response] : "";
}

static int by_size(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* The smallest that has a share of them at or below it. */
static double quantile(const float *sorted, size_t count, double share) {
    size_t i = (size_t)ceil(share * (double)count);
    return sorted[NOC_MIN(i ? i - 1 : 0, count - 1)];
}

noc_status noc_lux_figures_of(const float *lux, const float *share, size_t count, noc_lux_figures *out, noc_log *log) {
    if (!out || (count && !lux))
        return noc_null(log, __func__);
    float *sorted = noc_alloc_large(count + 1, sizeof(*sorted));
    double sum = 0, shares = 0;
    size_t n = 0;
    if (!sorted)
        return noc_no_memory(log, "measure");
    for (size_t i = 0; i < count; i++) {
        if (isnan(lux[i]))
            continue;
        double weight = share ? share[i] : 1;
        sorted[n++] = lux[i];
        sum += lux[i] * weight;
        shares += weight;
    }
    *out = (noc_lux_figures){ 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN };
    if (n) {
        qsort(sorted, n, sizeof(*sorted), by_size);
        double mean = sum / shares;
        *out = (noc_lux_figures){ .readings = n,
                                  .least = sorted[0],
                                  .mean = mean,
                                  .most = sorted[n - 1],
                                  .uniformity = mean > 0 ? sorted[0] / mean : NAN,
                                  .low = quantile(sorted, n, 0.05),
                                  .median = quantile(sorted, n, 0.5),
                                  .high = quantile(sorted, n, 0.95) };
    }
    free(sorted);
    return NOC_OK;
}
