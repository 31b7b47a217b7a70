/* Runs the inputs: all are opened and recognised before any is read; then cities, meshes and lamps, in an order that
 * lets the city settle the place. Lamps are stood on the ground at the end. */
#include "import/load/load.h"
#include "import/built/built.h"
#include "import/remote/remote.h"
#include "city/city.h"
#include "import/lamps/tags.h"

#include <math.h>
#include <sys/stat.h>
#include <nocturne/option.h>

#define MOST_THREADS 1024

#define FAR_AWAY 20e3 /* m between a mesh and the rest of the scene that are worth a warning */

/* Bounds of all that is in the scene so far, waiting lamps among it. Empty: lo > hi. */
static void bounds_so_far(const importer *im, double lo[2], double hi[2]) {
    for (int k = 0; k < 2; k++) {
        lo[k] = im->scene->bounds_min[k];
        hi[k] = im->scene->bounds_max[k];
        for (size_t i = 0; i < im->lamps.len; i++) {
            lo[k] = NOC_MIN(lo[k], im->lamps.data[i].lamp.xyz[k]);
            hi[k] = NOC_MAX(hi[k], im->lamps.data[i].lamp.xyz[k]);
        }
    }
}

static void warn_if_far(reading *r, const double lo[2], const double hi[2], size_t first_float) {
    importer *im = r->im;
    double a[2] = { INFINITY, INFINITY }, b[2] = { -INFINITY, -INFINITY }, gap = 0;
    for (size_t i = first_float; i + 2 < im->scene->positions.len; i += 3)
        for (size_t k = 0; k < 2; k++) {
            double x = (double)im->scene->positions.data[i + k];
            a[k] = NOC_MIN(a[k], x);
            b[k] = NOC_MAX(b[k], x);
        }
    for (int k = 0; k < 2; k++)
        gap = NOC_MAX(gap, NOC_MAX(a[k] - hi[k], lo[k] - b[k]));
    bool far = lo[0] <= hi[0] && a[0] <= b[0] && gap > FAR_AWAY;
    im->far_said = im->far_said || far;
    if (far)
        noc_warn(im->log, "%s: lies %.0f km from the rest of the scene: %s", r->in->path, gap / 1000,
                 r->mesh_from_origin ? "if its coordinates are those of a CRS, say with --crs which one"
                                     : "are its coordinates in the CRS that --crs says?");
}

/* With the input's own CRS, where the user gives it. */
static noc_import_params params_of(const reading *r) {
    noc_import_params params = *r->im->params;
    params.crs = given_crs_of(r->im, r->in);
    return params;
}

/* In the helper, or here. The sink is where progress is asked, and of maps where all goes. */
static noc_status read_remote(reading *r, const noc_stream *stream, geo_sink *sink, const mesh_place *place,
                              remote_result *result) {
    importer *im = r->im;
    input *in = r->in;
    mesh_scene to = { .scene = im->scene, .place = place, .issues = in->issues };
    const mesh_parts parts = mesh_scene_parts(&to);
    const noc_import_params params = params_of(r);
    noc_status status =
        remote_read(in->reader, in->path, &params, sink, place ? &parts : NULL, noc_stream_listener(stream), result);
    pthread_mutex_lock(&im->lock);
    if (*result->format)
        in->file.format = arena_strdup(&im->report->arena, result->format);
    bool refused = im->report->arena.refused;
    pthread_mutex_unlock(&im->lock);
    return !status && refused ? noc_no_memory(r->log, in->path) : status;
}

static noc_status read_mesh(reading *r, noc_stream *stream, remote_result *result) {
    importer *im = r->im;
    input *in = r->in;
    noc_status status = place_mesh(r);
    if (status)
        return status;
    size_t triangles = im->scene->indices.len / 3, floats = im->scene->positions.len, meshes = im->scene->meshes.len;
    size_t lights = im->scene->lights.len;
    const mesh_place place = { r, place_mesh_points, im->params->textures ? look_mesh_image : NULL };
    double lo[2], hi[2];
    bounds_so_far(im, lo, hi);
    geo_sink sink = sink_create(r);
    status = in->remote
                 ? read_remote(r, stream, &sink, &place, result)
                 : in->reader->read_mesh(in->path, stream, im->params, im->scene, &place, in->issues, &in->file.format);
    if (!status)
        warn_if_far(r, lo, hi, floats);
    in->file.triangles = im->scene->indices.len / 3 - triangles;
    in->file.objects = im->scene->meshes.len - meshes;
    in->file.lights = im->scene->lights.len - lights;
    luminaires_take(im, in, lights, meshes);
    for (size_t i = meshes; i < im->scene->meshes.len; i++) {
        const noc_scene_mesh *m = &im->scene->meshes.data[i];
        const float *e = im->scene->materials.data[m->material].emission;
        /* of a light that is counted */
        bool shape = m->triangle_count && im->scene->triangle_light.data[m->first_triangle] != NOC_NO_LIGHT;
        if (shape)
            continue;
        if (e[0] > 0 || e[1] > 0 || e[2] > 0)
            in->file.lights += m->triangle_count;
    }
    return status;
}

/* The streets of the built-in city are roads, for cars. */
static noc_status keep_streets(importer *im, const input *in) {
    const noc_city_params defaults = noc_city_default_params();
    const noc_city_params *params = im->params->builtin ? &im->params->builtin->city : &defaults;
    geo_road street;
    for (size_t i = 0; city_builtin_street(params, i, &im->names, &street); i++)
        if (!array_push(&im->roads, street))
            return noc_no_memory(im->log, in->path);
    return im->names.refused ? noc_no_memory(im->log, in->path) : NOC_OK;
}

/* Of names such as "Street 1", whose id is "street 1". */
static bool add_street(importer *im, const geo_road *street, const char *word, const char *of) {
    char name[32];
    noc_snprintf(name, sizeof(name), "%s %s", word, of);
    return noc_scene_add_street(im->scene, &(noc_scene_street){ name, street->id, (float)street->width, 0, 0 },
                                street->xyz, street->point_count);
}

/* They can be asked for by their names, too, and so can the road around the city. */
static noc_status name_streets(importer *im, const input *in) {
    static const char *const sides[] = { "West", "South", "East", "North" };
    const noc_city_params defaults = noc_city_default_params();
    const noc_city_params *params = im->params->builtin ? &im->params->builtin->city : &defaults;
    geo_road street;
    for (size_t i = 0; city_builtin_street(params, i, &im->names, &street); i++)
        if (!add_street(im, &street, "Street", strchr(street.id, ' ') + 1))
            return NOC_ERR_MEMORY;
    for (int i = 0; i < 4 && city_builtin_ring(params, i, &im->names, &street); i++)
        if (!add_street(im, &street, "Ring", sides[i]))
            return NOC_ERR_MEMORY;
    return im->names.refused ? noc_no_memory(im->log, in->path) : NOC_OK;
}

/* Lights from number `first` on that are of the group "lamps": of a built-in city one a lamp. */
static size_t count_lamps(const noc_scene *scene, size_t first) {
    int group = noc_scene_find_group(scene, "lamps");
    size_t count = 0;
    for (size_t i = first; group > 0 && i < scene->lights.len; i++)
        count += noc_light_group(&scene->lights.data[i]) == (uint32_t)group;
    return count;
}

static noc_status read_builtin(importer *im, input *in) {
    double start = noc_wall_seconds();
    size_t triangles = im->scene->indices.len / 3, lights = im->scene->lights.len, windows = im->scene->windows.len;
    const char *name = in->path + strlen(BUILTIN);
    const noc_progress *progress = &im->params->progress;
    char what[60];
    noc_snprintf(what, sizeof(what), "building %.40s", name);
    if (progress->update && !progress->update(progress->user, what, 0))
        return NOC_ERR_CANCELLED;
    noc_status status = city_add_builtin(im->scene, name, im->params->builtin, im->params->windows != NOC_SWITCH_OFF);
    status = status ? status : windows_of_builtin(im, in, windows);
    if (!status && !strcmp(name, "city"))
        status = name_streets(im, in);
    if (!status && !strcmp(name, "city") && im->params->traffic == NOC_SWITCH_ON)
        status = keep_streets(im, in);
    in->file.format = "built-in scene";
    in->file.seconds = noc_wall_seconds() - start;
    in->file.triangles = im->scene->indices.len / 3 - triangles;
    in->file.lights = im->scene->lights.len - lights;
    in->file.lamps_mapped = count_lamps(im->scene, lights);
    return status;
}

/* What a reader gives that is no mesh. */
static noc_status read_objects(reading *r, noc_stream *stream, remote_result *result) {
    geo_sink sink = sink_create(r);
    struct look_ahead *ahead = r->im->placed ? NULL : ahead_create(r, &sink);
    if (!r->im->placed && !ahead)
        return noc_no_memory(r->log, r->in->path);
    const noc_import_params params = params_of(r);
    noc_status status = r->in->remote ? read_remote(r, stream, &sink, NULL, result)
                                      : r->in->reader->read(stream, &params, &sink, &r->in->file.format);
    if (ahead && status != NOC_ERR_MEMORY) { /* after an error too: the report holds what came before it */
        if (status) {                        /* it is told, and no other */
            r->log = NULL;
            sink_hand_over(r, &(load_part){ .kind = PART_QUIET });
        }
        noc_status released = ahead_release(ahead);
        status = status ? status : released;
    }
    if (!status)
        status = sink_flush(r); /* of a reader that gives no objects */
    ahead_destroy(ahead);
    return status;
}

noc_status read_file(reading *r) {
    input *in = r->in;
    double start = noc_wall_seconds();
    noc_status status;
    noc_stream *stream = noc_stream_open(in->path, r->log, &status);
    if (!stream)
        return status;
    noc_stream_limit(stream, r->im->params);
    noc_stream_listen(stream, sources_listener(r));
    if (r->queue) {
        noc_stream_budget(stream)->claim = queue_claim;
        noc_stream_budget(stream)->claimant = r->queue;
    }
    size_t unread = noc_stream_unread(stream);
    for (size_t i = 0; i < unread; i++)
        geo_issue(in->issues, GEO_SKIPPED, "file of the archive, like the one that is read", "");
    if (unread)
        noc_warn(r->log, "%s: the archive holds %zu more file%s like it, which %s not read: unpack it to read all",
                 noc_stream_name(stream), unread, unread == 1 ? "" : "s", unread == 1 ? "is" : "are");
    remote_result result = { 0 };
    in->file.format = in->reader->name;
    status = in->reader->read_mesh ? read_mesh(r, stream, &result) : read_objects(r, stream, &result);
    if (r->stopped)
        status = NOC_ERR_CANCELLED;
    place_finish_file(r, status == NOC_OK);
    if (!status && (in->remote ? result.trailing : noc_stream_trailing(stream))) {
        noc_warn(r->log, "%s: bytes after the gzip data are ignored", in->path);
        geo_issue(in->issues, GEO_SKIPPED, "bytes after the gzip data", "");
    }
    in->file.bytes = in->bytes;
    in->file.bytes_read = in->remote ? result.bytes_read : noc_stream_read_bytes(stream);
    in->file.seconds = noc_wall_seconds() - start;
    noc_stream_close(stream);
    return status;
}

static noc_status read_input(importer *im, size_t index) {
    input *in = &im->inputs[index];
    taking t = take_start(im, in);
    reading r = { .im = im, .in = in, .index = index, .log = im->log };
    r.sides = sides_of((int)import_threads(im->params, SIZE_MAX));
    noc_status status = in->reader ? read_file(&r) : read_builtin(im, in);
    reading_free(&r);
    return take_finish(&t, status);
}

/* Built-in scenes are local, so they come first. A mesh in a CRS may settle the place; one that names none counts from
 * the origin that the others settle. */
enum { BUILT_IN, CITIES, MESHES_IN_CRS, LAMPS, MESHES, STAGES };
static int stage(const importer *im, const input *in) {
    if (!in->reader)
        return BUILT_IN;
    if (in->reader->reads != NOC_READS_MESH)
        return in->reader->reads == NOC_READS_CITY ? CITIES : LAMPS;
    return given_crs_of(im, in) ? MESHES_IN_CRS : MESHES;
}

size_t import_threads(const noc_import_params *params, size_t items) {
    int cores = !params ? 1 : params->threads ? params->threads : noc_processors();
    return NOC_MIN(items, (size_t)NOC_CLAMP(cores, 1, MOST_THREADS));
}

/* One by one, or, where the order of their parts alone matters, several at once. */
static noc_status read_inputs(importer *im, const size_t *inputs, size_t count, bool at_once) {
    size_t threads = import_threads(im->params, count);
    if (at_once && threads > 1) {
        noc_pool *pool = noc_pool_create((int)threads + 1);
        if (!pool)
            return noc_no_memory(im->log, "import");
        bool others = noc_pool_threads(pool) > 1;
        noc_status status = others ? read_at_once(im, inputs, count, pool) : NOC_OK;
        noc_pool_destroy(pool);
        if (others)
            return status;
    }
    noc_status status = NOC_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = read_input(im, inputs[i]);
    return status;
}

static bool column_there(void *ctx, const char *name) {
    const importer *im = ctx;
    for (size_t i = 0; i < im->input_count; i++)
        for (size_t k = 0; k < im->inputs[i].file.column_count; k++)
            if (lamp_same_key(im->inputs[i].file.columns[k].name, name))
                return true;
    return false;
}

/* Only one of them could be read, and nothing says which. */
static noc_status check_one_column(importer *im, const noc_report_file *file) {
    for (size_t i = 0; i < file->column_count; i++)
        for (size_t k = 0; k < i && file->columns[i].mapped; k++)
            if (file->columns[k].mapped && *file->columns[k].field &&
                !strcmp(file->columns[i].field, file->columns[k].field))
                return noc_error(im->log, NOC_ERR_ARGUMENT,
                                 "%s: lamp-columns: both \"%.60s\" and \"%.60s\" are mapped to %s: leave one out",
                                 file->path, file->columns[k].name, file->columns[i].name, file->columns[i].field);
    return NOC_OK;
}

/* A column that is mapped and nowhere there is a mistake of the user's: with what there is, for a line of text. */
static noc_status check_columns(importer *im) {
    for (size_t i = 0; i < im->input_count; i++) {
        noc_status status = check_one_column(im, &im->inputs[i].file);
        if (status)
            return status;
    }
    char *missing, there[400] = "";
    noc_status status = lamp_mapping_missing(im->params, column_there, im, im->log, &missing);
    for (size_t i = 0, n = 0; missing && i < im->input_count; i++)
        for (size_t k = 0; k < im->inputs[i].file.column_count && n < 300; k++)
            n += (size_t)noc_snprintf(there + n, sizeof(there) - n, "%s%.40s", n ? ", " : "",
                                      im->inputs[i].file.columns[k].name);
    if (missing && im->inspect)
        noc_warn(im->log, "%s: lamp-columns: there is no column or tag \"%.60s\"", im->inputs[0].path, missing);
    else if (missing)
        status = noc_error(im->log, NOC_ERR_ARGUMENT, "lamp-columns: no input has a column or tag \"%.60s\"%s%s",
                           missing, *there ? "; there are " : "", there);
    free(missing);
    return status;
}

static noc_status run(importer *im, const noc_reader *const *readers) {
    for (size_t i = 0; i < im->input_count; i++) {
        noc_status status = recognise_input(im, &im->inputs[i], readers);
        if (status)
            return status;
        im->inputs[i].repeated = !im->inputs[i].left_out && repeat_file(im, i);
        bool read = !im->inputs[i].repeated && !im->inputs[i].left_out;
        im->bytes_total += read ? (double)im->inputs[i].bytes : 0;
        if (!im->inputs[i].left_out)
            noc_scene_add_source(im->scene, im->inputs[i].path, NULL);
    }
    noc_status status = recognise_told(im);
    if (!status)
        status = given_crs_take(im);
    if (!status)
        status = height_unit_take(im);
    if (status)
        return status;
    size_t *inputs = noc_calloc(im->input_count, sizeof(*inputs));
    status = inputs ? NOC_OK : noc_no_memory(im->log, "import");
    for (int s = 0; s < STAGES && !status; s++) {
        size_t count = 0;
        for (size_t i = 0; i < im->input_count; i++)
            if (!im->inputs[i].repeated && !im->inputs[i].left_out && stage(im, &im->inputs[i]) == s)
                inputs[count++] = i;
        status = read_inputs(im, inputs, count, s == CITIES);
        if (s == BUILT_IN)
            im->first_mesh = im->scene->meshes.len;
    }
    free(inputs);
    if (!status)
        status = check_columns(im);
    if (!status)
        status = units_check(im);
    if (!status)
        status = faces_check(im);
    if (!status)
        given_crs_warn(im);
    if (!status && im->box.on && !im->scene->indices.len && !im->lamps.len && !im->roads.len)
        status =
            noc_error(im->log, NOC_ERR_ARGUMENT, "bbox: nothing of the inputs lies in %.10g,%.10g,%.10g,%.10g of %s",
                      im->box.lo[0], im->box.lo[1], im->box.hi[0], im->box.hi[1],
                      im->box.crs                 ? geo_crs_name(im->box.crs)
                      : im->scene->given_crs_name ? im->scene->given_crs_name
                      : im->scene_crs             ? geo_crs_name(im->scene_crs)
                                                  : "their local metres");
    if (status)
        return status;
    if (!im->inspect)
        return finish_city(im);
    status = strays_drop(im);
    return status ? status : windows_add(im);
}

static bool among(const char *path, const char *const *paths, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (same_file(paths[i], path))
            return true;
    return false;
}

static bool among_inputs(const importer *im, const char *path) {
    for (size_t i = 0; i < im->files.files.len; i++)
        if (same_file(im->files.files.data[i].path, path))
            return true;
    return false;
}

/* What tells two files apart, asked once: a city may come in thousands of them. */
static void know_file(input *in) {
    struct stat st;
    in->is_file = !stat(in->path, &st) && S_ISREG(st.st_mode);
    if (!in->is_file)
        return;
    in->device = (uint64_t)st.st_dev;
    in->inode = (uint64_t)st.st_ino;
    in->size = (uint64_t)st.st_size;
}

/* The inputs are the paths, or what they stand for, and the files of lamps and of tracks that are not among them. */
static noc_status list_inputs(importer *im, const char *const *paths, size_t path_count) {
    const noc_texts *lamps = &im->params->lamps, *tracks = &im->params->tracks;
    noc_status status = expand_inputs(paths, path_count, im->log, &im->files);
    if (status)
        return status;
    size_t count = im->files.files.len, with_lamps = count + lamps->count, all = with_lamps + tracks->count;
    im->inputs = noc_calloc(all + 1, sizeof(*im->inputs));
    if (!im->inputs)
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < all; i++) {
        expanded_file file = { NULL, NULL };
        if (i < count)
            file = im->files.files.data[i];
        else
            file.path = i < with_lamps ? lamps->text[i - count] : tracks->text[i - with_lamps];
        if (i >= count && (im->inspect || among_inputs(im, file.path)))
            continue;
        if (i >= count && (i < with_lamps ? among(file.path, lamps->text, i - count)
                                          : among(file.path, tracks->text, i - with_lamps)))
            continue;
        const char *path = arena_strdup(&im->report->arena, file.path);
        input *in = &im->inputs[im->input_count++];
        *in = (input){ .path = path,
                       .folder = file.folder,
                       .file = { .path = path },
                       .issues = geo_issues_create(),
                       .found = geo_issues_create() };
        if (!path || !in->issues || !in->found)
            return noc_no_memory(im->log, "import");
        in->named_lamps = among(path, lamps->text, lamps->count);
        in->named_tracks = among(path, tracks->text, tracks->count);
        know_file(in);
    }
    return NOC_OK;
}

/* The meshes of each file; those of a map's buildings are chosen as wholes. */
static noc_status keep_parts(importer *im) {
    noc_report *report = im->report;
    bool ok = true;
    for (uint32_t i = 0; ok && i < im->input_count; i++) {
        const input *in = &im->inputs[i];
        report_part part = { (uint32_t)in->first_mesh, (uint32_t)in->end_mesh, i, false, 0, 0 };
        ok = !in->started || part.first == part.end || array_push(&report->parts, part);
    }
    for (size_t i = 0; ok && i < im->buildings.len; i++) {
        const taken_building *b = &im->buildings.data[i];
        report_part part = { b->first, b->end, (uint32_t)b->input, true, b->first, b->end };
        bool inside = b->first >= im->inputs[b->input].first_mesh && b->end <= im->inputs[b->input].end_mesh;
        ok = inside || array_push(&report->parts, part);
    }
    return ok ? NOC_OK : noc_no_memory(im->log, "import");
}

/* Of each input, from its number to that of its file in the report. */
static void number_files(importer *im) {
    noc_report *report = im->report;
    uint32_t *number = report ? noc_calloc(im->input_count + 1, sizeof(*number)) : NULL;
    for (size_t i = 0; number && i < im->input_count; i++)
        number[i + 1] = number[i] + im->inputs[i].started;
    for (size_t i = 0; number && i < report->panes.len; i++)
        report->panes.data[i].file = number[report->panes.data[i].file];
    for (size_t i = 0; number && i < report->parts.len; i++)
        report->parts.data[i].file = number[report->parts.data[i].file];
    for (size_t i = 0; number && i < report->mapped.len; i++)
        report->mapped.data[i].file = number[report->mapped.data[i].file];
    if (!number && report)
        report->panes.len = report->parts.len = report->mapped.len = 0;
    free(number);
}

/* alone: of built cities, to which CRSs and boxes are words of its past. */
static noc_status check_params(const noc_import_params *params, bool alone, noc_log *log) {
    noc_status status = noc_option_check(noc_import_options(), params, "import", log);
    if (!status && (params->threads < 0 || params->threads > MOST_THREADS))
        status =
            noc_error(log, NOC_ERR_ARGUMENT, "import: threads is %d, must be in 0..%d", params->threads, MOST_THREADS);
    if (!status)
        status = lamp_mapping_check(params, log);
    if (!status)
        status = windows_check(params, log);
    if (!status && !alone)
        status = height_unit_check(params, log);
    return status || alone ? status : given_crs_check(params, log);
}

noc_status load_inputs(noc_scene *scene, const noc_reader *const *readers, const char *const *paths, size_t path_count,
                       const noc_import_params *params, bool inspect, noc_report **report) {
    const noc_import_params defaults = noc_import_default_params();
    if (report)
        *report = NULL;
    if (!scene)
        return NOC_ERR_ARGUMENT;
    for (size_t i = 0; i < path_count; i++)
        if (!paths || !paths[i])
            return noc_null(scene->log, "noc_scene_load");
    if (!params)
        params = &defaults;
    bool alone = path_count > 0;
    for (size_t i = 0; i < path_count; i++)
        alone = alone && noct_is(paths[i]);
    noc_status status = check_params(params, alone, scene->log);
    if (status)
        return status;
    if (!path_count && !params->lamps.count && !params->tracks.count)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "import: no input");
    if (scene->committed)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "import: the scene is committed");
    importer im = { .log = scene->log,
                    .scene = scene,
                    .params = params,
                    .memory = import_budget_of(params).memory,
                    .inspect = inspect,
                    .lock = PTHREAD_MUTEX_INITIALIZER };
    status = alone ? NOC_OK : box_read(params, scene->log, &im.box);
    if (!status && params->environment && !inspect)
        status = finish_environment(scene, params->environment);
    if (status) {
        box_free(&im.box);
        return status;
    }
    im.report = report_create();
    status = im.report ? list_inputs(&im, paths, path_count) : noc_no_memory(scene->log, "import");
    const char *built = status ? NULL : built_find(&im);
    sources_note_given(&im, paths, path_count, built);
    if (built)
        status = built_load(&im, built);
    else if (!status)
        status = luminaires_start(&im);
    scene->maintenance = built || status ? scene->maintenance : params->maintenance;
    if (!status && !built)
        status = run(&im, readers);
    if (!status)
        status = built ? luminaires_say(&im) : luminaires_finish(&im);
    if (scene->no_memory)
        status = NOC_ERR_MEMORY; /* some go on without what the scene refused */
    if (!status && !inspect && !built)
        status = look_read_images(&im);
    if (!status && !inspect)
        status = finish_materials(scene, params);
    if (!status && scene->sources.refused)
        status = noc_no_memory(scene->log, "import");
    if (!status && scene->ground_work.cut)
        noc_warn(scene->log,
                 "so many triangles lie over one another that %zu vertical rays ended early: what stands on the ground "
                 "there may have a wrong height or place",
                 scene->ground_work.cut);
    if (!status && !inspect)
        status = noc_scene_commit(scene);
    if (!status && !inspect)
        status = report_groups(im.report, scene);
    if (status == NOC_ERR_CANCELLED)
        noc_cancelled(scene->log, "import: cancelled");
    if (!status && !built && !inspect)
        status = keep_parts(&im);
    if (!built)
        number_files(&im);
    for (size_t i = 0; i < im.input_count; i++) {
        if (inspect)
            im.inputs[i].file.lamps_dropped = im.inputs[i].lamps_lost;
        if (im.inputs[i].started && !report_add(im.report, &im.inputs[i].file, im.inputs[i].issues) && !status)
            status = noc_no_memory(scene->log, im.inputs[i].path);
        geo_issues_destroy(im.inputs[i].issues);
        geo_issues_destroy(im.inputs[i].found);
        place_forget(&im.inputs[i]);
        units_forget(&im.inputs[i]);
        array_free(&im.inputs[i].lamps_seen);
    }
    if (!status && params->strict)
        status = report_strict(im.report, params, scene->log);
    free(im.inputs);
    expanded_free(&im.files);
    box_free(&im.box);
    take_destroy(&im);
    luminaires_free(im.luminaires);
    city_profiles_destroy(im.profiles);
    if (report)
        *report = im.report;
    else
        noc_report_destroy(im.report);
    return status;
}

noc_status noc_scene_load(noc_scene *scene, const char *const *paths, size_t path_count,
                          const noc_import_params *params, noc_report **report) {
    return load_inputs(scene, noc_readers, paths, path_count, params, false, report);
}

noc_status noc_inspect(noc_log *log, const char *path, const noc_import_params *params, noc_report **report) {
    noc_scene *scene = noc_scene_create(log);
    if (report)
        *report = NULL;
    if (!scene)
        return noc_no_memory(log, "scene");
    noc_status status = load_inputs(scene, noc_readers, &path, 1, params, true, report);
    noc_scene_destroy(scene);
    return status;
}
