/* Files of meshes that tests write into a folder of their own, and what their reader makes of them. */
#ifndef NOC_TEST_MESH_FILE_H
#define NOC_TEST_MESH_FILE_H

#include "import/import.h"
#include "scene/scene.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../test.h"

typedef struct loaded {
    noc_log *log;
    noc_scene *scene;
    geo_issues *issues;
    noc_status status;
    char error[1024], warning[1024]; /* the last ones */
    int errors, warnings;
    const char *format;
} loaded;

static char folder[200];

static void on_message(void *user, noc_log_level level, const char *text) {
    loaded *l = user;
    snprintf(level == NOC_LOG_ERROR ? l->error : l->warning, sizeof(l->error), "%s", text);
    *(level == NOC_LOG_ERROR ? &l->errors : &l->warnings) += 1;
}

static noc_status as_it_is(void *ctx, double *xyz, size_t count) { return NOC_OK; }

static void write_file(const char *name, const void *data, size_t size) {
    char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    fclose(f);
}

static void load_with(loaded *l, const noc_reader *reader, const char *name, const noc_import_params *params,
                      const mesh_place *place) {
    *l = (loaded){ 0 };
    char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    l->log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message, .user = l });
    l->scene = noc_scene_create(l->log);
    l->issues = geo_issues_create();
    noc_stream *stream = noc_stream_open(path, l->log, NULL);
    l->status = stream ? reader->read_mesh(path, stream, params, l->scene, place, l->issues, &l->format) : NOC_ERR_IO;
    noc_stream_close(stream);
}

static void unload(loaded *l) {
    noc_scene_destroy(l->scene);
    geo_issues_destroy(l->issues);
    noc_log_destroy(l->log);
}

static int make_mesh_folder(void) {
    const char *tmp = getenv("TMPDIR");
    snprintf(folder, sizeof(folder), "%s/nocturne-mesh-%d", tmp && *tmp ? tmp : "/tmp", (int)getpid());
    return mkdir(folder, 0700);
}

static int remove_mesh_folder(const char *const *files, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char path[300];
        snprintf(path, sizeof(path), "%s/%s", folder, files[i]);
        unlink(path);
    }
    return rmdir(folder);
}

#endif
