/* Noise of the reference itself: errors near it say nothing. Its first n of N frames are kept on the way; their mean is off from
 * the whole mean by a variance of s^2 (1/n - 1/N), and the whole mean from the truth by s^2 / N. */
#include "experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

experiment_noise experiment_measure_noise(const experiment_lab *lab, const noc_image *half, int half_frames) {
    experiment_noise noise = { NAN, NAN, NAN, NAN };
    noc_compare_params params = noc_compare_default_params();
    params.ceiling = lab->spec.ceiling;
    noc_comparison c;
    if (!half || noc_image_compare(half, lab->reference, &params, &c, lab->log))
        return noise;
    double share = (double)half_frames / (lab->spec.reference.frames - half_frames);
    return (experiment_noise){ share * c.dark.relmse, share * c.dark_clamped.relmse, share * c.all.relmse, share * c.all_clamped.relmse };
}

static char *beside(const char *reference) { return cli_format("%.*s.noise", (int)strlen(reference) - 4, reference); }

/* A few numbers that may be lost: where they cannot be written, the report does without them. */
void experiment_keep_noise(const char *reference, const experiment_noise *noise) {
    char *path = beside(reference), *temporary = cli_format("%s.%ld", path, (long)getpid());
    FILE *file = fopen(temporary, "w");
    bool kept = file && fprintf(file, "%.9g %.9g %.9g %.9g\n", noise->relmse, noise->clamped, noise->relmse_all, noise->clamped_all) > 0;
    if (file)
        kept = !fclose(file) && kept;
    if (!kept || rename(temporary, path))
        unlink(temporary);
    free(temporary);
    free(path);
}

experiment_noise experiment_read_noise(const char *reference) {
    experiment_noise n;
    char *path = beside(reference);
    FILE *file = fopen(path, "r");
    bool whole = file && fscanf(file, "%lf %lf %lf %lf", &n.relmse, &n.clamped, &n.relmse_all, &n.clamped_all) == 4;
    if (file)
        fclose(file);
    free(path);
    return whole ? n : (experiment_noise){ NAN, NAN, NAN, NAN };
}
