/* The camera of a photograph, from a table of its points. */
#include "import/import.h"
#include "scene/scene.h"

#include <errno.h>
#include <fcntl.h>
#include <nocturne/text.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 10000, LINE = 512 };

typedef struct photo {
    const noc_scene *scene;
    const char *path, *crs;
    noc_camera_point *points;
    noc_photo_info info;
    int line;
} photo;

static noc_status wrong(const photo *p, const char *what) {
    return noc_error(p->scene->log, NOC_ERR_FORMAT, "%s:%d: %s", p->path, p->line, what);
}

static noc_status take_size(photo *p, const double size[2]) {
    if (!(size[0] >= 1 && size[0] <= 1e6 && size[1] >= 1 && size[1] <= 1e6))
        return wrong(p, "the first row is the photograph's width and height in pixels");
    p->info.width = (int)size[0];
    p->info.height = (int)size[1];
    return NOC_OK;
}

static noc_status take_row(photo *p, const char *text) {
    double v[5];
    if (!p->info.width)
        return noc_text_numbers(text, ',', 2, v)
                   ? take_size(p, v)
                   : wrong(p, "the first row is the photograph's width and height in pixels, \"4000,3000\"");
    if (!noc_text_numbers(text, ',', 5, v))
        return wrong(p, "a row is px,py,x,y,z: a pixel of the photograph, and the place that it shows");
    if (p->info.points == MOST)
        return wrong(p, "there are more than 10000 points");
    noc_camera_point *point = &p->points[p->info.points++];
    *point = (noc_camera_point){ .xyz = { v[2], v[3], v[4] }, .pixel = { v[0], v[1] } };
    bool local = !p->crs && !p->scene->crs_name;
    return local ? NOC_OK : noc_scene_to_local(p->scene, p->crs && strcmp(p->crs, "scene") ? p->crs : NULL, point->xyz);
}

/* Rows of numbers; empty ones, and those that begin with a letter or #, say nothing. */
static noc_status read_rows(photo *p, FILE *file) {
    char text[LINE];
    noc_status status = NOC_OK;
    while (!status && fgets(text, sizeof(text), file)) {
        p->line++;
        size_t length = strcspn(text, "\r\n"), blank = strspn(text, " \t");
        if (length == sizeof(text) - 1)
            return wrong(p, "the row is too long");
        text[length] = 0;
        bool letter = (text[blank] | 32) >= 'a' && (text[blank] | 32) <= 'z';
        if (text[blank] && text[blank] != '#' && !letter)
            status = take_row(p, text);
    }
    if (!status && ferror(file))
        status = noc_error(p->scene->log, NOC_ERR_IO, "%s: it cannot be read", p->path);
    return status;
}

/* Waits for nobody who would write it, as of a pipe. */
static noc_status open_table(const photo *p, FILE **file) {
    struct stat st;
    int fd = open(p->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool regular = fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode);
    *file = regular ? fdopen(fd, "r") : NULL;
    if (*file)
        return NOC_OK;
    noc_status status = noc_error(p->scene->log, NOC_ERR_IO, "%s: it cannot be opened: %s", p->path,
                                  fd < 0 || regular ? strerror(errno) : "not a regular file");
    if (fd >= 0)
        close(fd);
    return status;
}

noc_status noc_scene_photo_camera(const noc_scene *scene, const char *path, const char *crs, noc_camera *camera,
                                  noc_photo_info *info) {
    if (!scene || !path || !camera)
        return noc_null(scene ? scene->log : NULL, __func__);
    photo p = { .scene = scene, .path = path, .crs = crs };
    p.points = noc_alloc(MOST * sizeof(*p.points));
    if (!p.points)
        return noc_no_memory(scene->log, "camera of a photograph");
    FILE *file;
    noc_status status = open_table(&p, &file);
    status = status ? status : read_rows(&p, file);
    if (file)
        fclose(file);
    if (!status)
        status = noc_camera_align(p.points, p.info.points, p.info.width, p.info.height, NULL, camera, &p.info.residual,
                                  scene->log);
    free(p.points);
    if (!status && info)
        *info = p.info;
    return status;
}
