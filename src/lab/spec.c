/* What a spec asks for, and what its parts are called. */
#include "lab/spec.h"

void noc_lab_spec_destroy(noc_lab_spec *spec) {
    if (!spec)
        return;
    for (size_t i = 0; i < spec->scene_count; i++)
        noc_recipe_destroy(spec->scenes[i].recipe);
    free(spec->scenes);
    free(spec->absent);
    free(spec->cameras);
    free(spec->configs);
    arena_free(&spec->arena);
    free(spec);
}

noc_render_params noc_lab_render_params(int width, int height) {
    noc_render_params params = noc_render_default_params();
    params.width = width;
    params.height = height;
    params.sky = 0;
    params.jitter = false;
    return params;
}

void noc_lab_spec_get_info(const noc_lab_spec *spec, noc_lab_spec_info *info) {
    if (!info)
        return;
    *info = (noc_lab_spec_info){ .name = "", .title = "" };
    if (spec)
        *info = (noc_lab_spec_info){ spec->name,         spec->title,        spec->width,
                                     spec->height,       spec->repetitions,  spec->scene_count,
                                     spec->camera_count, spec->config_count, spec->device };
}

noc_status noc_lab_spec_get_camera(const noc_lab_spec *spec, size_t index, noc_lab_camera_info *info) {
    if (!spec || !info || index >= spec->camera_count)
        return NOC_ERR_ARGUMENT;
    const lab_camera *camera = &spec->cameras[index];
    *info = (noc_lab_camera_info){ camera->name, spec->scenes[camera->scene].name, camera->frames };
    return NOC_OK;
}

noc_status noc_lab_spec_get_config(const noc_lab_spec *spec, size_t index, noc_lab_config_info *info) {
    if (!spec || !info || index >= spec->config_count)
        return NOC_ERR_ARGUMENT;
    const lab_config *config = &spec->configs[index];
    *info = (noc_lab_config_info){ config->name, &config->params, config->frames, config->seconds };
    return NOC_OK;
}

bool lab_among(const char *const *names, const char *name) {
    for (; names && *names; names++)
        if (!strcmp(*names, name))
            return true;
    return false;
}

/* Of a camera that moves the last frame alone is measured. */
bool lab_has_mode(const lab_spec *spec, size_t camera, int mode) {
    if (spec->cameras[camera].frames)
        return mode == LAB_ALONE;
    return spec->accumulate == mode || spec->accumulate == LAB_MODES;
}

int lab_frames(const lab_spec *spec, size_t camera, size_t config) {
    return spec->cameras[camera].frames ? spec->cameras[camera].frames : spec->configs[config].frames;
}

static bool among(const int *frames, size_t count, int frame) {
    for (size_t i = 0; i < count; i++)
        if (frames[i] == frame)
            return true;
    return false;
}

bool lab_measures(const lab_spec *spec, size_t camera, size_t config, int frame) {
    int last = lab_frames(spec, camera, config);
    if (spec->cameras[camera].frames || frame == last)
        return frame == last;
    if (among(spec->measured, spec->measured_count, frame))
        return true;
    if (spec->measured_count || !(spec->configs[config].seconds > 0))
        return !spec->measured_count;
    /* Thousands of frames fit into some seconds: their distance rises by an eighth. */
    int next = 1;
    while (next < frame)
        next += next < 16 ? 1 : next / 8;
    return next == frame;
}

bool lab_shows(const lab_spec *spec, size_t camera, int frame) {
    int motion = spec->cameras[camera].frames;
    return motion ? frame == motion : among(spec->shown, spec->shown_count, frame);
}

int lab_shown_mode(const lab_spec *spec, size_t camera) {
    return !spec->cameras[camera].frames && spec->accumulate == LAB_ACCUMULATED ? LAB_ACCUMULATED : LAB_ALONE;
}

const char *lab_view_name(const lab_spec *spec, size_t camera, char text[LAB_TEXT]) {
    noc_snprintf(text, LAB_TEXT, "%s, %s", spec->scenes[spec->cameras[camera].scene].name, spec->cameras[camera].name);
    return text;
}

/* Letters and digits stay, the rest becomes dashes. Numbers keep apart names that differ in other characters alone. */
const char *lab_slug(const lab_spec *spec, size_t camera, char text[LAB_TEXT]) {
    int number = noc_snprintf(text, LAB_TEXT, "%zu-", camera + 1);
    noc_snprintf(text + number, LAB_TEXT - (size_t)number, "%s-%s", spec->scenes[spec->cameras[camera].scene].name,
                 spec->cameras[camera].name);
    for (char *c = text + number; *c; c++)
        if (*c >= 'A' && *c <= 'Z')
            *c = (char)(*c - 'A' + 'a');
        else if (!(*c >= 'a' && *c <= 'z') && !(*c >= '0' && *c <= '9'))
            *c = '-';
    return text;
}

const char *lab_row_name(const lab_spec *spec, size_t config, char text[LAB_TEXT]) {
    const lab_config *c = &spec->configs[config];
    if (c->choice < 0) {
        noc_snprintf(text, LAB_TEXT, "%s", c->name);
        return text;
    }
    /* The entry's name without the value's place and what joins it; with it in the middle, where the rest would not
     * read. */
    const char *name = c->pattern, *star = strchr(name, '*'), *after = star ? star + 1 : "";
    size_t before = star ? (size_t)(star - name) : strlen(name);
    while (before && strchr(", =", name[before - 1]))
        before--;
    if (before) {
        noc_snprintf(text, LAB_TEXT, "%.*s", *after ? LAB_TEXT : (int)before, name);
        return text;
    }
    after += strspn(after, ", =");
    noc_snprintf(text, LAB_TEXT, "%s", *after ? after : c->option->name);
    return text;
}

const char *lab_figure(const lab_spec *spec, char text[LAB_TEXT]) {
    const char *pixels = spec->all_pixels ? "all pixels" : "pixels that see no emitter";
    if (spec->figure == LAB_CLAMPED)
        noc_snprintf(text, LAB_TEXT, "relMSE clamped to %g cd/m\302\262, %s", spec->ceiling, pixels);
    else
        noc_snprintf(text, LAB_TEXT, "%s, %s", spec->figure == LAB_RELMSE ? "relMSE" : "RMSE-8 (0 to 255)", pixels);
    return text;
}
