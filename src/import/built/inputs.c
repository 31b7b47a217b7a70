/* Inputs that are built cities: no others are read with them. */
#include "import/built/built.h"

/* Is the input a built city? Those that a folder holds are none. */
static bool is_built(const input *in) { return in->is_file && !in->folder && noct_is(in->path); }

const char *built_find(const importer *im) {
    for (size_t i = 0; i < im->input_count; i++)
        if (is_built(&im->inputs[i]))
            return im->inputs[i].path;
    return NULL;
}

/* One that is given twice would be there twice. */
static noc_status check_once(const importer *im) {
    noc_map seen = { 0 };
    noc_status status = NOC_OK;
    for (size_t i = 0; i < im->input_count && !status; i++) {
        const input *in = &im->inputs[i];
        char key[48];
        bool fresh;
        noc_snprintf(key, sizeof(key), "%llx %llx", (unsigned long long)in->device, (unsigned long long)in->inode);
        if (!map_put(&seen, key, i, &fresh))
            status = noc_no_memory(im->log, in->path);
        else if (!fresh)
            status = noc_error(im->log, NOC_ERR_ARGUMENT, "%s: is given twice", in->path);
    }
    map_free(&seen);
    return status;
}

static noc_status read_all_built(importer *im) {
    const char **paths = noc_calloc(im->input_count, sizeof(*paths));
    if (!paths)
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < im->input_count; i++)
        paths[i] = im->inputs[i].path;
    noc_status status = built_read_all(im, paths, im->input_count);
    free(paths);
    return status;
}

noc_status built_load(importer *im, const char *path) {
    const noc_scene *s = im->scene;
    for (size_t i = 0; i < im->input_count; i++)
        if (!is_built(&im->inputs[i]))
            return noc_error(im->log, NOC_ERR_ARGUMENT,
                             "%s: is a built city, and %s is none: build that together with the others", path,
                             im->inputs[i].path);
    if (s->meshes.len || s->lights.len || s->materials.len || s->models.len || s->edits.len || s->crs_name)
        return noc_error(im->log, NOC_ERR_ARGUMENT, "%s: is a built city, and the scene has something in it already",
                         path);
    if (im->input_count == 1)
        return built_read(im, path);
    noc_status status = check_once(im);
    return status ? status : read_all_built(im);
}
