/* Luminaires' files, IES and EULUMDAT: what is read has intensities that are finite and not negative, zones that add up
 * to its flux, and a table that sends one lumen. */
#include "fuzz.h"

#include "photometry/photometry.h"

#include <math.h>

static void use(const noc_profile *p, noc_log *log, int *errors) {
    noc_profile_info i;
    photometry_table t;
    noc_profile_get_info(p, &i);
    FUZZ_REQUIRE(i.lumens > 0 && i.peak > 0 && i.c_count > 0 && i.gamma_count > 1 && *i.format);
    double sum = i.forward.low + i.forward.medium + i.forward.high + i.forward.very_high + i.back.low + i.back.medium +
                 i.back.high + i.back.very_high + i.up_low + i.up_high;
    double whole = noc_profile_flux(p, 0, 180, NAN);
    FUZZ_REQUIRE(fabs(sum - whole) <= 1e-6 * (whole + i.peak));
    for (int k = 0; k < i.c_count * i.gamma_count; k++)
        FUZZ_REQUIRE(i.cd[k] >= 0 && i.cd[k] <= i.peak);
    double at = noc_profile_intensity(p, i.peak_c, i.peak_gamma);
    if (!p->own.cd.len) /* at the poles of types A and B there are many */
        FUZZ_REQUIRE(fabs(at - i.peak) <= 1e-9 * i.peak);
    *errors = 0;
    noc_status status = photometry_table_make(&t, p, log);
    FUZZ_REQUIRE(*errors == (status != NOC_OK));
    if (!status)
        for (size_t k = 0; k < t.cells.len; k++)
            FUZZ_REQUIRE(t.cells.data[k] >= 0 && t.cells.data[k] <= t.peak && isfinite(t.peak));
    photometry_table_free(&t);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    noc_profile *p = NULL;
    uint8_t *copy = malloc(size + 1); /* its own, so that a byte behind it is seen */
    memcpy(copy, data, size);
    copy[size] = 0;
    fuzz_memory(data, size);
    noc_status status = noc_profile_read(log, copy, size, "fuzz", &p);
    FUZZ_REQUIRE((errors != 0) == (status != NOC_OK) && errors <= 1 && !status == (p != NULL));
    if (p)
        use(p, log, &errors);
    fuzz_memory_back();
    noc_profile_destroy(p);
    free(copy);
    noc_log_destroy(log);
    return 0;
}
