/* nocturne info of a luminaire's file. */
#include "info.h"

#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>

bool info_is_profile(const char *path) {
    static char head[1 << 14];
    struct stat st;
    bool file = !stat(path, &st) && S_ISREG(st.st_mode); /* a pipe would be waited for */
    FILE *f = file ? fopen(path, "rb") : NULL;
    size_t n = f ? fread(head, 1, sizeof(head), f) : 0;
    if (f)
        fclose(f);
    return n && noc_profile_probe(head, n);
}

static void print_text(const char *name, const char *text) {
    char clean[200];
    if (*text)
        printf("  %-11s %s\n", name, noc_text_clean(clean, sizeof(clean), text));
}

static void print_flux(const noc_profile_info *i) {
    printf("  %-11s %.0f lm", "flux", i->lumens);
    if (isnan(i->lamp_lumens)) {
        printf(", absolute: its lamps state none");
    } else {
        printf("; its lamps %.*f lm", i->lamp_lumens > 0 && i->lamp_lumens < 1 ? 3 : 0, i->lamp_lumens);
        if (!isnan(i->lor))
            printf(", light output ratio %.1f%% stated", 100 * i->lor);
        if (i->lamp_lumens > 0)
            printf(", %.1f%% found", 100 * i->lumens / i->lamp_lumens);
    }
    if (!isnan(i->flux_error) && !isnan(i->lor))
        printf(" (%+.1f%%)", 100 * i->flux_error);
    putchar('\n');
}

static void print_profile(const char *path, const noc_profile_info *i) {
    char name[400];
    printf("%s\n", noc_text_clean(name, sizeof(name), path));
    print_text("format", i->format);
    print_text("luminaire", i->name);
    print_text("made by", i->manufacturer);
    print_text("lamp", i->lamp);
    print_flux(i);
    if (i->watts > 0)
        printf("  %-11s %g W, %.1f lm/W\n", "power", i->watts, i->lumens / i->watts);
    if (i->kelvin > 0)
        printf("  %-11s %g K\n", "colour", i->kelvin);
    printf("  %-11s %.1f cd at C %g, gamma %g\n", "peak", i->peak, i->peak_c, i->peak_gamma);
    printf("  %-11s %d plane%s, C %g to %g; %d angles, gamma %g to %g\n", "grid", i->planes, i->planes == 1 ? "" : "s",
           i->c_min, i->c_max, i->gammas, i->gamma_min, i->gamma_max);
    printf("  %-11s %s; the street is at C %g\n", "symmetry", i->symmetry, i->street);
    if (i->lamp_sets > 1)
        printf("  %-11s %d, of which the first counts\n", "lamp sets", i->lamp_sets);
    printf("  %-11s %.2f%% of the light\n", "upward", 100 * i->upward);
    printf("  %-11s low %.0f, medium %.0f, high %.0f, very high %.0f lm\n", "forward", i->forward.low,
           i->forward.medium, i->forward.high, i->forward.very_high);
    printf("  %-11s low %.0f, medium %.0f, high %.0f, very high %.0f lm\n", "back", i->back.low, i->back.medium,
           i->back.high, i->back.very_high);
    printf("  %-11s low %.0f, high %.0f lm\n", "uplight", i->up_low, i->up_high);
    printf("  %-11s B%d U%d G%d\n", "BUG", i->bug[0], i->bug[1], i->bug[2]);
}

static void json_profile(const noc_profile_info *i) {
    const struct {
        const char *name, *text;
    } texts[] = { { "format", i->format },
                  { "luminaire", i->name },
                  { "manufacturer", i->manufacturer },
                  { "lamp", i->lamp },
                  { "symmetry", i->symmetry } };
    const struct {
        const char *name;
        double value;
    } numbers[] = { { "lumens", i->lumens },
                    { "lamp_lumens", i->lamp_lumens },
                    { "light_output_ratio", i->lor },
                    { "flux_error", i->flux_error },
                    { "watts", i->watts },
                    { "kelvin", i->kelvin > 0 ? i->kelvin : NAN },
                    { "peak_cd", i->peak },
                    { "peak_c", i->peak_c },
                    { "peak_gamma", i->peak_gamma },
                    { "planes", i->planes },
                    { "c_min", i->c_min },
                    { "c_max", i->c_max },
                    { "gammas", i->gammas },
                    { "gamma_min", i->gamma_min },
                    { "gamma_max", i->gamma_max },
                    { "street_c", i->street },
                    { "lamp_sets", i->lamp_sets },
                    { "upward", i->upward },
                    { "forward_low", i->forward.low },
                    { "forward_medium", i->forward.medium },
                    { "forward_high", i->forward.high },
                    { "forward_very_high", i->forward.very_high },
                    { "back_low", i->back.low },
                    { "back_medium", i->back.medium },
                    { "back_high", i->back.high },
                    { "back_very_high", i->back.very_high },
                    { "uplight_low", i->up_low },
                    { "uplight_high", i->up_high } };
    for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++) {
        printf(",\n    \"%s\": ", texts[k].name);
        cli_json_text(stdout, texts[k].text);
    }
    for (size_t k = 0; k < sizeof(numbers) / sizeof(*numbers); k++) {
        printf(",\n    \"%s\": ", numbers[k].name);
        cli_json_number(stdout, numbers[k].value);
    }
    printf(",\n    \"bug\": [%d, %d, %d]", i->bug[0], i->bug[1], i->bug[2]);
}

noc_status info_profile(const char *path, bool json, noc_log *log) {
    noc_profile *profile = NULL;
    noc_profile_info info;
    noc_status status = noc_profile_load(log, path, &profile);
    cli_progress_clear();
    if (!status)
        noc_profile_get_info(profile, &info);
    if (json) {
        fputs("  {\"path\": ", stdout);
        cli_json_text(stdout, path);
        if (status) {
            fputs(",\n    \"error\": ", stdout);
            cli_json_text(stdout, noc_log_last_error(log));
        } else {
            json_profile(&info);
        }
        putchar('}');
    } else if (!status) {
        print_profile(path, &info);
    }
    noc_profile_destroy(profile);
    return status;
}
