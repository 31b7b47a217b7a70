/* The user's own bodies, from OBJ, PLY and glTF: of lamps, with the place where they shine, and of cars (cars.c). */
#include "import/load/load.h"
#include "city/city.h"
#include "import/remote/remote.h"

#include <math.h>
#include <strings.h>

#define LIGHT "light" /* what marks that place */

typedef struct reading_body {
    importer *im;
    const char *path, *option, *what;
    double done;    /* for progress */
    noc_scene *own; /* what the file holds */
    geo_issues *issues;
} reading_body;

static noc_status as_they_are(void *ctx, double *xyz, size_t count) { return NOC_OK; }

static bool on_progress(void *ctx, double done) {
    const reading_body *b = ctx;
    importer *im = b->im;
    const noc_progress *progress = &im->params->progress;
    im->cancelled = im->cancelled || (progress->update && !progress->update(progress->user, b->what, b->done));
    return !im->cancelled;
}

/* import_listener.on_named */
static void note_named(void *user, const char *path) {
    const reading_body *b = user;
    noc_scene_add_source(b->im->scene, path, b->path);
}

static noc_status read_it(reading_body *b) {
    enum { HEAD = 4096 };
    const noc_import_params *params = b->im->params;
    const mesh_place place = { NULL, as_they_are };
    mesh_scene to = { .scene = b->own, .place = &place, .issues = b->issues };
    const mesh_parts parts = mesh_scene_parts(&to);
    char head[HEAD + 1] = "";
    size_t size = 0;
    noc_status status;
    noc_stream *stream = noc_stream_open(b->path, b->im->log, &status);
    if (!stream)
        return status;
    noc_stream_limit(stream, params);
    noc_stream_listen(stream, (import_listener){ note_named, b });
    for (size_t got = 1; !status && got && size < HEAD; size += got)
        status = noc_stream_read(stream, head + size, HEAD - size, &got);
    const noc_reader *reader = status ? NULL : find_reader(noc_readers, head, size);
    bool mesh = reader && reader->read_mesh;
    if (!status && !mesh)
        status = noc_error(b->im->log, NOC_ERR_FORMAT, "%s: %s is an OBJ, a PLY or a glTF", b->path, b->option);
    else if (!status && reader->missing)
        status = noc_error(b->im->log, NOC_ERR_UNSUPPORTED, "%s: this is %s, but %s", b->path, reader->name,
                           reader->missing);
    status = status ? status : noc_stream_rewind(stream);
    if (!status && reader->foreign && params->isolate && reader->foreign(head, size)) {
        geo_sink sink = { .ctx = b, .log = b->im->log, .issues = b->issues, .progress = on_progress };
        remote_result result = { 0 };
        status = remote_read(reader, b->path, params, &sink, &parts, noc_stream_listener(stream), &result);
    } else if (!status) {
        const char *format;
        status = reader->read_mesh(b->path, stream, params, b->own, &place, b->issues, &format);
    }
    noc_stream_close(stream);
    return status;
}

noc_scene *body_read(importer *im, const char *path, const char *option, const char *what, double done,
                     noc_status *status) {
    reading_body b = { .im = im,
                       .path = path,
                       .option = option,
                       .what = what,
                       .done = done,
                       .own = noc_scene_create(im->log),
                       .issues = geo_issues_create() };
    *status = b.own && b.issues ? NOC_OK : NOC_ERR_MEMORY;
    if (b.own && !b.issues)
        noc_no_memory(im->log, path);
    *status = *status ? *status : read_it(&b);
    if (!*status && b.own->no_memory)
        *status = NOC_ERR_MEMORY;
    if (!*status && geo_issues_refused(b.issues))
        *status = noc_no_memory(im->log, path);
    for (size_t i = 0; i < geo_issues_count(b.issues) && !*status; i++) {
        const char *reason, *examples;
        bool repaired;
        size_t count;
        if (!geo_issues_get(b.issues, i, &reason, &repaired, &count, &examples))
            *status = noc_no_memory(im->log, path);
        else if (geo_issues_kind(b.issues, i) != GEO_SPARED)
            noc_warn(im->log, "%s: %zu x %s", path, count, reason);
    }
    geo_issues_destroy(b.issues);
    if (!*status)
        return b.own;
    noc_scene_destroy(b.own);
    return NULL;
}

/* ---- lamps ---- */

/* The place of what is called "light": the middle of a mesh, else a light of the file. False: there is none. */
static bool find_light(const noc_scene *s, double at[3]) {
    for (size_t m = 0; m < s->meshes.len; m++) {
        const noc_scene_mesh *mesh = &s->meshes.data[m];
        double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
        if (!mesh->name || strcasecmp(mesh->name, LIGHT) != 0 || !mesh->triangle_count)
            continue;
        for (size_t i = 3 * mesh->first_triangle; i < 3 * (mesh->first_triangle + mesh->triangle_count); i++) {
            double p[3];
            city_body_corner(s, i, p);
            for (int k = 0; k < 3; k++) {
                lo[k] = NOC_MIN(lo[k], p[k]);
                hi[k] = NOC_MAX(hi[k], p[k]);
            }
        }
        for (int k = 0; k < 3; k++)
            at[k] = (lo[k] + hi[k]) / 2;
        return true;
    }
    for (int k = 0; k < 3 && s->lights.len; k++)
        at[k] = s->lights.data[0].p[k];
    return s->lights.len > 0;
}

#define LARGEST_HEAD 10 /* m from where it shines: our own word, as no head of a street lamp reaches 5 */

static double reach(const noc_scene *s, const noc_scene_mesh *mesh) {
    double most = 0, p[3];
    for (size_t i = 3 * mesh->first_triangle; i < 3 * (mesh->first_triangle + mesh->triangle_count); i++) {
        city_body_corner(s, i, p);
        most = fmax(most, sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
    }
    return most;
}

static noc_status make_model(importer *im, const noc_scene *from, const char *path, city_body *body) {
    const double as_it_is[12] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 };
    noc_scene *to = im->scene;
    bool any = false;
    double far = 0;
    noc_status status = NOC_OK;
    body->whole = find_light(from, body->light);
    if (body->whole && !(body->light[2] > 0.1))
        return noc_error(im->log, NOC_ERR_FORMAT,
                         "%s: its light lies %.3g m above its foot: a lamp stands on 0, and z is up (--obj-up)", path,
                         body->light[2]);
    body->model = noc_scene_add_model(to, "lamp");
    if (body->model < 0)
        return NOC_ERR_MEMORY;
    for (size_t m = 0; m < from->meshes.len && !status; m++) {
        const noc_scene_mesh *mesh = &from->meshes.data[m];
        if (!mesh->triangle_count || (mesh->name && !strcasecmp(mesh->name, LIGHT)))
            continue;
        int material = city_body_material(to, from, mesh->material, NOC_CLASS_LAMP);
        status = city_body_mesh(to, from, mesh, body->model, material, as_it_is);
        far = fmax(far, reach(from, mesh));
        any = true;
    }
    if (!status && !any)
        status = noc_error(im->log, NOC_ERR_FORMAT, "%s: the lamp's body has no triangles", path);
    if (!status && !body->whole && far > LARGEST_HEAD)
        noc_warn(
            im->log,
            "%s: the lamp's head reaches %.3g m from where it shines: it is in metres about 0,0,0, and a whole lamp "
            "marks its light by a part of that name",
            path, far);
    return status;
}

noc_status body_load(importer *im, const char *path, struct city_body *body) {
    noc_status status;
    noc_scene *own = body_read(im, path, "--lamp-body", "lamps", import_done(im, DONE_LAMPS, LAMPS_PLACED), &status);
    status = status ? status : make_model(im, own, path, body);
    noc_scene_destroy(own);
    return status;
}
