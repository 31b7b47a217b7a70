/* Runs and their rows in memory. */
#include "lab/session.h"

#include <dirent.h>
#include <nocturne/scene.h>

lab_run *lab_find_run(const lab_session *lab, size_t camera, size_t config, int repetition) {
    const lab_spec *spec = lab->spec;
    return &lab->runs[(camera * (size_t)spec->repetitions + (size_t)repetition) * spec->config_count + config];
}

noc_render_params lab_params_of(const lab_session *lab, const lab_run *run) {
    noc_render_params p = lab->spec->configs[run->config].params;
    p.seed = lab->spec->seed + (uint32_t)run->repetition;
    p.accumulate = false; /* the mean is made here, so that one run gives both curves */
    if (lab->spec->light_view && !run->repetition)
        p.aovs |= 1u << NOC_AOV_LIGHT;
    return p;
}

lab_row *lab_row_of(const lab_session *lab, lab_run *run, int mode, int frame) {
    if (frame > run->room) {
        int room = NOC_MAX(frame, 2 * run->room);
        for (int m = 0; m < LAB_MODES; m++) {
            lab_row *rows = noc_realloc(run->rows[m], sizeof(lab_row) * (size_t)room);
            if (!rows) {
                noc_no_memory(lab->log, "rows");
                return NULL;
            }
            memset(rows + run->room, 0, sizeof(lab_row) * (size_t)(room - run->room));
            run->rows[m] = rows;
        }
        run->room = room;
    }
    run->count = NOC_MAX(run->count, frame);
    return &run->rows[mode][frame - 1];
}

char *lab_picture_path(const lab_session *lab, const char *key, int mode, int frame) {
    char *path =
        noc_format("%s/pictures/%s-%s%d.exr", lab->folder, key, mode == LAB_ACCUMULATED ? "mean" : "frame", frame);
    if (!path)
        noc_no_memory(lab->log, "pictures");
    return path;
}

char *lab_light_path(const lab_session *lab, const char *key, int frame) {
    char *path = noc_format("%s/pictures/%s-light%d.png", lab->folder, key, frame);
    if (!path)
        noc_no_memory(lab->log, "pictures");
    return path;
}

const char *lab_sheet_name(const lab_spec *spec, size_t camera, int frame, bool light, char text[LAB_TEXT]) {
    char slug[LAB_TEXT];
    const char *kind = light ? "light" : lab_shown_mode(spec, camera) == LAB_ACCUMULATED ? "mean" : "frame";
    noc_snprintf(text, LAB_TEXT, "%.300s-%s%d.png", lab_slug(spec, camera, slug), kind, frame);
    return text;
}

/* Returns true if files of such a name are written: tables, the report, and pictures by their frame. */
static bool is_written(const char *name) {
    static const char *const kinds[] = { "-mean", "-frame", "-light" };
    const char *dot = strrchr(name, '.');
    if (!strcmp(name, "report.md") || (!strncmp(name, "results", 7) && dot && !strcmp(dot, ".csv")))
        return true;
    for (size_t i = 0; i < NOC_COUNT(kinds) && dot && (!strcmp(dot, ".png") || !strcmp(dot, ".exr")); i++) {
        size_t length = strlen(kinds[i]);
        const char *number = dot;
        while (number > name && number[-1] >= '0' && number[-1] <= '9')
            number--;
        if (number < dot && number - name > (ptrdiff_t)length && !strncmp(number - length, kinds[i], length))
            return true;
    }
    return false;
}

static noc_status check_folder(const lab_session *lab, const char *folder) {
    DIR *dir = folder ? opendir(folder) : NULL;
    noc_status status = folder ? NOC_OK : noc_no_memory(lab->log, lab->folder);
    struct dirent *entry;
    while (!status && dir && (entry = readdir(dir))) {
        char *path = is_written(entry->d_name) ? noc_format("%s/%s", folder, entry->d_name) : NULL;
        const char *by, *source = path ? noc_scene_find_source(lab->scene, path, &by) : NULL;
        if (source)
            status = noc_error(lab->log, NOC_ERR_ARGUMENT,
                               "%s would be overwritten, and the scene is made of it (%s%s%s): choose another folder",
                               path, source, by ? ", named by " : "", by ? by : "");
        free(path);
    }
    if (dir)
        closedir(dir);
    return status;
}

noc_status lab_check_sources(const lab_session *lab) {
    char *pictures = noc_format("%s/pictures", lab->folder);
    noc_status status = check_folder(lab, pictures);
    status = status ? status : check_folder(lab, lab->folder);
    free(pictures);
    return status;
}

noc_backend_id lab_backend_of(const char *device) {
    size_t n = strlen(noc_backend_name(NOC_BACKEND_VULKAN));
    bool vulkan = !strncmp(device, noc_backend_name(NOC_BACKEND_VULKAN), n) && (!device[n] || device[n] == ',');
    return vulkan ? NOC_BACKEND_VULKAN : NOC_BACKEND_EMBREE;
}

void lab_note(const lab_session *lab, const char *fmt, ...) {
    char text[1024];
    if (!lab->params.note)
        return;
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    lab->params.note(lab->params.user, text);
}

bool lab_go_on(lab_session *lab, const noc_lab_progress *progress) {
    if (!lab->cancelled && lab->params.progress)
        lab->cancelled = !lab->params.progress(lab->params.user, progress);
    return !lab->cancelled;
}
