/* Noise of the reference and its device as they are kept beside it, and what it lacks. */
#include "lab/noise.h"
#include "lab/file.h"

#include <math.h>
#include <unistd.h>

static char *beside(const char *reference) { return noc_format("%.*s.noise", (int)strlen(reference) - 4, reference); }

/* A line of numbers and one of the device. They may be lost: where they cannot be written, the report does without. */
void lab_keep_truth(const char *reference, const lab_truth *truth) {
    const noc_lab_noise *n = &truth->noise;
    char *path = beside(reference);
    output file;
    if (path && !output_open(&file, path, NULL)) {
        noc_fprintf(file.file, "%.9g %.9g %.9g %.9g %.9g %.9g\n%s\n", n->relmse, n->relmse_clamped, n->relmse_all,
                    n->relmse_clamped_all, n->mean, n->mean_all, truth->device);
        (void)output_close(&file, NOC_OK, NULL);
    }
    free(path);
}

void lab_read_truth(const char *reference, lab_truth *truth) {
    double v[6];
    int read = 0;
    char text[256 + LAB_DEVICE], *path = beside(reference), *rest = text;
    FILE *file = path && !access(path, F_OK) ? lab_open_file(path, NULL) : NULL;
    size_t n = file ? fread(text, 1, sizeof(text) - 1, file) : 0;
    text[n] = 0;
    char *numbers = strtok_r(rest, "\n", &rest), *device = numbers ? strtok_r(NULL, "\n", &rest) : NULL;
    for (char *word; read < 6 && numbers && (word = strtok_r(numbers, " ", &numbers)); read++)
        if (!lab_parse_number(word, &v[read]))
            break;
    if (file)
        fclose(file);
    free(path);
    truth->noise = read == 6 ? (noc_lab_noise){ v[0], v[1], v[2], v[3], v[4], v[5] }
                             : (noc_lab_noise){ NAN, NAN, NAN, NAN, NAN, NAN };
    noc_snprintf(truth->device, LAB_DEVICE, "%s", device ? device : noc_backend_name(NOC_BACKEND_EMBREE));
}

#define LEAST_SHARE 0.01 /* of relMSE: less is not worth a word */

/* Pixels that are 0 in the reference and lit in a picture, by the row that they make most of the error of. */
bool lab_tell_unlit(const lab_session *lab, size_t camera, char text[2 * LAB_TEXT]) {
    const lab_spec *spec = lab->spec;
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
        return false;
    noc_snprintf(text, 2 * LAB_TEXT,
                 "unlit in the reference: %s that a picture lights are %.3g %% of its relMSE (%s, %s %d, where "
                 "their share is largest). More frames of the reference%s may light them.",
                 noc_text_many(many, (uint64_t)most.pixels, "pixel"), 100 * most.share, most.name,
                 most.mode == LAB_ACCUMULATED ? "mean of" : "frame", most.frame,
                 lists ? "" : ", or one of ris over lists,");
    return true;
}
