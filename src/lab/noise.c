/* Noise of the reference itself: errors near it say nothing. Its first n of N frames are kept on the way; their mean is
 * off from the whole mean by a variance of s^2 (1/n - 1/N), and the whole mean from the truth by s^2 / N. The standard
 * error of its mean luminance, which bias is judged by, is that of the means of equal parts of its frames. */
#include "lab/lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of pixels that see no emitter, and of all. */
void lab_add_batch(lab_batches *b, const noc_image *image, int frames) {
    double sum[2] = { 0, 0 }, pixels[2] = { 0, 0 };
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
        const float *p = image->rgb + 3 * i;
        double y = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        for (int all = image->emitter && image->emitter[i]; all < 2; all++) {
            sum[all] += y;
            pixels[all]++;
        }
    }
    b->count++;
    b->frames[b->count] = frames;
    for (int all = 0; all < 2; all++)
        b->mean[all][b->count] = pixels[all] > 0 ? sum[all] / pixels[all] : NAN;
}

/* Standard error of the last mean, as a share of it: the parts' own means follow from the running ones. */
static double mean_error(const lab_batches *b, int all) {
    double whole = b->mean[all][b->count], squares = 0;
    if (b->count < 2 || !(whole > 0))
        return NAN;
    int frames = b->frames[b->count];
    for (int i = 1; i <= b->count; i++) {
        int n = b->frames[i] - b->frames[i - 1];
        double before = i > 1 ? b->frames[i - 1] * b->mean[all][i - 1] : 0,
               own = (b->frames[i] * b->mean[all][i] - before) / n;
        squares += n * (own - whole) * (own - whole);
    }
    return sqrt(squares / (b->count - 1) / frames) / whole;
}

lab_noise lab_measure_noise(const lab_session *lab, const noc_image *half, int half_frames,
                            const lab_batches *batches) {
    lab_noise noise = { NAN, NAN, NAN, NAN, mean_error(batches, 0), mean_error(batches, 1) };
    noc_compare_params params = noc_compare_default_params();
    params.ceiling = lab->spec.ceiling;
    noc_comparison c;
    if (!half || noc_image_compare(half, lab->reference, &params, &c, lab->log))
        return noise;
    double share = (double)half_frames / (lab->spec.reference.frames - half_frames);
    return (lab_noise){ share * c.dark.relmse,
                        share * c.dark_clamped.relmse,
                        share * c.all.relmse,
                        share * c.all_clamped.relmse,
                        noise.mean,
                        noise.mean_all };
}

static char *beside(const char *reference) { return cli_format("%.*s.noise", (int)strlen(reference) - 4, reference); }

/* A few numbers that may be lost: where they cannot be written, the report does without them. */
void lab_keep_noise(const char *reference, const lab_noise *noise) {
    char *path = beside(reference), *temporary = cli_format("%s.%ld", path, (long)getpid());
    FILE *file = fopen(temporary, "wx");
    bool kept = file && fprintf(file, "%.9g %.9g %.9g %.9g %.9g %.9g\n", noise->relmse, noise->clamped,
                                noise->relmse_all, noise->clamped_all, noise->mean, noise->mean_all) > 0;
    if (file)
        kept = !fclose(file) && kept;
    if (!kept || rename(temporary, path))
        unlink(temporary);
    free(temporary);
    free(path);
}

lab_noise lab_read_noise(const char *reference) {
    lab_noise n;
    char *path = beside(reference);
    FILE *file = access(path, F_OK) ? NULL : cli_open(path);
    bool whole = file && fscanf(file, "%lf %lf %lf %lf %lf %lf", &n.relmse, &n.clamped, &n.relmse_all, &n.clamped_all,
                                &n.mean, &n.mean_all) == 6;
    if (file)
        fclose(file);
    free(path);
    return whole ? n : (lab_noise){ NAN, NAN, NAN, NAN, NAN, NAN };
}

#define LEAST_SHARE 0.01 /* of relMSE: less is not worth a word */

/* Pixels that are 0 in the reference and lit in a picture, by the row that they make most of the error of. */
char *lab_unlit(const lab_session *lab, size_t camera) {
    const lab_spec *spec = &lab->spec;
    const lab_run *runs = lab_find_run(lab, camera, 0, 0);
    int pixels = spec->all_pixels ? COL_UNLIT_ALL : COL_UNLIT,
        part = spec->all_pixels ? COL_RELMSE_UNLIT_ALL : COL_RELMSE_UNLIT;
    const noc_render_params *reference = &spec->reference.params;
    bool lists = reference->method == NOC_METHOD_RIS && reference->candidates == NOC_CANDIDATES_LISTS;
    struct {
        double pixels, share;
        const char *name;
        int mode, frame;
    } most = { .share = 0 };
    for (size_t i = 0; i < (size_t)spec->repetitions * spec->config_count; i++)
        for (int mode = 0; mode < LAB_MODES; mode++)
            for (int frame = 1; frame <= runs[i].count; frame++) {
                const lab_row *row = &runs[i].rows[mode][frame - 1];
                double share = row->values[part] / row->values[spec->all_pixels ? COL_RELMSE_ALL : COL_RELMSE];
                /* of a black reference it is infinite: told by itself */
                if (!row->done || !(share > most.share && isfinite(share)))
                    continue;
                most.share = share;
                most.pixels = row->values[pixels];
                most.name = spec->configs[runs[i].config].name;
                most.mode = mode;
                most.frame = frame;
            }
    char many[64];
    if (!most.name || most.share < LEAST_SHARE)
        return NULL;
    return cli_format("unlit in the reference: %s that a picture lights are %.3g %% of its relMSE (%s, %s %d, where "
                      "their share is largest). More frames of the reference%s may light them.",
                      noc_text_many(many, (uint64_t)most.pixels, "pixel"), 100 * most.share, most.name,
                      most.mode == LAB_ACCUMULATED ? "mean of" : "frame", most.frame,
                      lists ? "" : ", or one of ris over lists,");
}
