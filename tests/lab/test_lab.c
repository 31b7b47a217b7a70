/* The laboratory from C: one configuration against a reference, and a spec's runs, which are the same figures. */
#include "../comma_locale.h"
#include "../files.h"

#include "base/base.h"

#include <glob.h>
#include <math.h>
#include <nocturne/nocturne.h>

#define SPEC                                                                                                           \
    "{ \"scene\": { \"name\": \"one\", \"inputs\": [\"builtin:single\"] }, \"cameras\": [ { \"name\": \"own\" } ],"    \
    "  \"size\": \"24x16\", \"frames\": 3, \"repetitions\": 2, \"reference\": { \"rays\": 8, \"frames\": 4 },"         \
    "  \"configurations\": [ { \"name\": \"is\", \"method\": \"is\" },"                                                \
    "                        { \"name\": \"ris\", \"method\": \"ris\", \"candidates\": \"uniform\" } ] }"

enum { WIDTH = 24, HEIGHT = 16, FRAMES = 3 };

static char folder[] = "/tmp/nocturne-lab-XXXXXX";
static int errors, warnings;
static char last[1024];

static void on_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    errors += level == NOC_LOG_ERROR;
    warnings += level == NOC_LOG_WARN;
    snprintf(last, sizeof(last), "%s", text);
}

static noc_log *fresh_log(void) {
    errors = warnings = 0;
    *last = 0;
    return noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
}

static int make_folder(void **state) {
    (void)state;
    return !mkdtemp(folder);
}

static int remove_folder(void **state) {
    char command[200];
    (void)state;
    snprintf(command, sizeof(command), "rm -rf '%s'", folder);
    return system(command);
}

static noc_lab_spec *parse(const char *text, noc_log *log) {
    noc_lab_spec *spec;
    assert_int_equal(noc_lab_spec_parse(text, "somewhere/single.json", &spec, log), NOC_OK);
    return spec;
}

/* In a folder of that name. */
static noc_status open_lab(const noc_lab_spec *spec, const char *name, noc_lab_params params, noc_lab **lab,
                           noc_log *log) {
    char path[200], cache[200];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    snprintf(cache, sizeof(cache), "%s/cache", folder);
    params.folder = path;
    params.cache = cache;
    return noc_lab_create(spec, &params, lab, log);
}

static int column(const char *name) {
    for (int i = 0; noc_lab_columns()[i]; i++)
        if (!strcmp(noc_lab_columns()[i], name))
            return i;
    fail_msg("no column %s", name);
    return -1;
}

static double value(const noc_lab_row *row, const char *name) { return row->values[column(name)]; }

static void assert_errors(const noc_lab_row *row, const noc_comparison *c) {
    assert_true(value(row, "rmse8") == c->dark.rmse8);
    assert_true(value(row, "relmse") == c->dark.relmse && c->dark.relmse > 0);
    assert_true(value(row, "relmse_clamped") == c->dark_clamped.relmse);
    assert_true(value(row, "bias_all") == c->all.bias);
    assert_true(c->all.rmse > 0);
}

/* What the program's table says in that column, of a row that begins so. */
static bool program_says(const char *path, const char *begin, const char *name, char text[40]) {
    char line[4000], head[4000];
    FILE *file = fopen(path, "r");
    bool found = file && fgets(head, sizeof(head), file);
    assert_true(found);
    for (found = false; !found && fgets(line, sizeof(line), file);)
        found = !strncmp(line, begin, strlen(begin));
    fclose(file);
    char *h = head, *l = line, *title, *field;
    while (found && (title = strsep(&h, ",\n")) && (field = strsep(&l, ",\n")))
        if (!strcmp(title, name)) {
            snprintf(text, 40, "%s", field);
            return true;
        }
    return false;
}

/* The same spec by the program, where it is built: the same figures. */
static void compare_with_program(const char *config, const noc_lab_frame *frame) {
    const char *build = getenv("NOC_BUILD");
    char command[1000], begin[80], path[200], said[40], mine[40];
    snprintf(path, sizeof(path), "%s/nocturne", build ? build : "");
    if (access(path, X_OK)) {
        print_message("# the program is not there: not compared with it\n");
        return;
    }
    snprintf(
        command, sizeof(command),
        "cd '%s' && { [ -e program ] || { printf '%%s' '%s' >single.json && '%s' experiment single.json -q -o program "
        "--cache program-cache; }; }",
        folder, SPEC, path);
    assert_int_equal(system(command), 0);
    snprintf(path, sizeof(path), "%s/program/results.csv", folder);
    for (int mean = 0; mean < 2; mean++) {
        const noc_comparison *c = mean ? &frame->mean : &frame->alone;
        snprintf(begin, sizeof(begin), "one,own,%s,1,%s,%d,", config, mean ? "accumulated" : "alone", frame->frame);
        noc_snprintf(mine, sizeof(mine), "%.9g", c->dark.relmse);
        assert_true(program_says(path, begin, "relmse", said));
        assert_string_equal(said, mine);
        noc_snprintf(mine, sizeof(mine), "%.9g", c->all.rmse8);
        assert_true(program_says(path, begin, "rmse8_all", said));
        assert_string_equal(said, mine);
    }
}

/* Figures from C are those of the same spec, row by row. */
static void test_same_figures(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    noc_scene *scene = noc_scene_create(log);
    noc_device *device = noc_device_create(NULL, log);
    noc_camera camera;
    assert_int_equal(noc_scene_add_builtin(scene, "single", NULL), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, (double)WIDTH / HEIGHT, &camera), NOC_OK);

    noc_render_params render = noc_lab_render_params(WIDTH, HEIGHT);
    render.method = NOC_METHOD_REFERENCE;
    render.rays = 8;
    render.seed = 4711;
    noc_lab_reference_params truth = noc_lab_reference_default_params();
    truth.frames = 4;
    noc_image *reference;
    noc_lab_noise noise;
    assert_int_equal(noc_lab_reference(device, scene, &camera, &render, &truth, &reference, &noise, log), NOC_OK);
    assert_true(noise.relmse > 0 && noise.mean > 0);

    noc_lab_spec *spec = parse(SPEC, log);
    noc_lab *lab;
    noc_lab_row row;
    assert_int_equal(open_lab(spec, "same", noc_lab_default_params(), &lab, log), NOC_OK);
    assert_int_equal(noc_lab_run(lab), NOC_OK);
    assert_int_equal(noc_lab_write_report(lab), NOC_OK);
    noc_lab_state told;
    noc_lab_get_state(lab, &told);
    assert_true(told.rows == 2 * 2 * FRAMES * 2 && told.rows_made == told.rows);

    const noc_method methods[] = { NOC_METHOD_IS, NOC_METHOD_RIS };
    const char *const names[] = { "is", "ris" };
    for (size_t i = 0; i < 2; i++) {
        noc_lab_frame frames[FRAMES];
        noc_lab_measure_params params = noc_lab_measure_default_params();
        size_t count;
        params.frames = FRAMES;
        render = noc_lab_render_params(WIDTH, HEIGHT);
        render.method = methods[i];
        render.candidates = i ? NOC_CANDIDATES_UNIFORM : render.candidates;
        assert_int_equal(noc_lab_measure(device, scene, &camera, &render, reference, &params, frames, &count, log),
                         NOC_OK);
        assert_int_equal(count, FRAMES);
        size_t compared = 0;
        for (size_t r = 0; noc_lab_get_row(lab, r, &row); r++) {
            const noc_lab_frame *f = &frames[row.frame - 1];
            if (strcmp(row.configuration, names[i]) || row.repetition > 1)
                continue;
            assert_errors(&row, row.mean ? &f->mean : &f->alone);
            assert_true(value(&row, "rays_shadow") == (double)f->stats.rays_shadow);
            compared++;
        }
        assert_int_equal(compared, 2 * FRAMES);
        assert_true(frames[0].cpu_total == frames[0].stats.cpu_seconds && frames[0].cpu_total > 0);
        assert_true(frames[2].wall_total > frames[1].wall_total);
        assert_true(frames[0].alone.dark.relmse == frames[0].mean.dark.relmse);
        compare_with_program(names[i], &frames[FRAMES - 1]);
    }
    static const char *const written[] = { "report.md",           "summary.md",      "results.csv",
                                           "errors.svg",          "frame-times.svg", "1-one-own-mean-cpu.svg",
                                           "1-one-own-frame1.png" };
    for (size_t i = 0; i < NOC_COUNT(written); i++) {
        char path[200];
        snprintf(path, sizeof(path), "%s/same/%s", folder, written[i]);
        if (access(path, R_OK))
            fail_msg("%s is not there", written[i]);
    }
    assert_int_equal(errors + warnings, 0);
    noc_lab_destroy(lab);
    noc_lab_spec_destroy(spec);
    noc_image_destroy(reference);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

static bool stop_at_half(void *user, const char *what, double done) {
    (void)what;
    *(double *)user = done;
    return done < 0.5;
}

/* Ends by itself, by time, and by what makes no sense. */
static void test_measure_ends(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    noc_scene *scene = noc_scene_create(log);
    noc_device *device = noc_device_create(NULL, log);
    noc_camera camera;
    noc_lab_frame frames[100];
    size_t count;
    double done = 0;
    assert_int_equal(noc_scene_add_builtin(scene, "single", NULL), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1, &camera), NOC_OK);
    noc_render_params render = noc_lab_render_params(8, 8);
    noc_image *reference;
    assert_int_equal(noc_lab_reference(device, scene, &camera, &render, NULL, &reference, NULL, log), NOC_OK);

    noc_lab_measure_params params = noc_lab_measure_default_params();
    params.frames = 4;
    params.progress = (noc_progress){ stop_at_half, &done };
    assert_int_equal(noc_lab_measure(device, scene, &camera, &render, reference, &params, frames, &count, log),
                     NOC_ERR_CANCELLED);
    assert_in_range(count, 1, 2); /* asked at the end of the second frame, or before the third */
    assert_int_equal(errors, 0);
    params = noc_lab_measure_default_params();
    params.frames = 100;
    params.seconds = 1e-9;
    assert_int_equal(noc_lab_measure(device, scene, &camera, NULL, reference, &params, frames, &count, log), NOC_OK);
    assert_int_equal(count, 1);
    params.frames = 0;
    assert_int_equal(noc_lab_measure(device, scene, &camera, NULL, reference, &params, frames, &count, log),
                     NOC_ERR_ARGUMENT);
    params.frames = 1;
    render.width = 9;
    assert_int_equal(noc_lab_measure(device, scene, &camera, &render, reference, &params, frames, &count, log),
                     NOC_ERR_ARGUMENT);
    assert_int_equal(errors, 2);
    assert_non_null(strstr(last, "8 x 8"));

    noc_image *none;
    noc_lab_reference_params making = noc_lab_reference_default_params();
    making.progress = params.progress = (noc_progress){ stop_at_half, &done };
    assert_int_equal(noc_lab_reference(device, scene, &camera, &render, &making, &none, NULL, log), NOC_ERR_CANCELLED);
    assert_null(none);
    noc_image_destroy(reference);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

static void test_spec(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    noc_lab_spec *spec = parse(SPEC, log);
    noc_lab_spec_info info;
    noc_lab_camera_info camera;
    noc_lab_config_info config;
    noc_lab_spec_get_info(spec, &info);
    assert_string_equal(info.name, "single");
    assert_string_equal(info.title, "single");
    assert_true(info.width == WIDTH && info.height == HEIGHT && info.repetitions == 2);
    assert_true(info.scenes == 1 && info.cameras == 1 && info.configurations == 2);
    assert_int_equal(noc_lab_spec_get_camera(spec, 0, &camera), NOC_OK);
    assert_string_equal(camera.scene, "one");
    assert_true(!strcmp(camera.name, "own") && camera.motion == 0);
    assert_int_equal(noc_lab_spec_get_camera(spec, 1, &camera), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_lab_spec_get_config(spec, 1, &config), NOC_OK);
    assert_true(config.render->method == NOC_METHOD_RIS && config.render->candidates == NOC_CANDIDATES_UNIFORM);
    assert_true(config.render->width == WIDTH && !config.render->jitter && config.render->sky == 0);
    assert_true(config.frames == FRAMES && config.seconds == 0);
    assert_int_equal(noc_lab_spec_get_config(spec, 2, &config), NOC_ERR_ARGUMENT);
    noc_lab_spec_destroy(spec);

    static const struct {
        const char *text, *said;
        noc_status status;
    } wrong[] = {
        { "", "a/b.json:1:", NOC_ERR_FORMAT },
        { "[]", "a/b.json: a spec is one object", NOC_ERR_FORMAT },
        { "{ \"frame\": 3 }", "a/b.json: no option \"frame\"; is it \"frames\"?", NOC_ERR_FORMAT },
        { "{ \"scene\": { \"name\": \"x\", \"inputs\": [\"c.gml\"] }, \"configurations\": [{}] }",
          "a/c.gml: No such file", NOC_ERR_IO },
    };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        errors = 0;
        assert_int_equal(noc_lab_spec_parse(wrong[i].text, "a/b.json", &spec, log), wrong[i].status);
        assert_null(spec);
        assert_int_equal(errors, 1);
        if (!strstr(last, wrong[i].said))
            fail_msg("\"%s\" does not say \"%s\"", last, wrong[i].said);
    }
    noc_log_destroy(log);
}

static void write_text(const char *path, const char *text) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
}

/* The error of the last row of a spec whose scene is this. */
static double error_of(const char *scene, const char *name, noc_log *log) {
    char text[1000], place[200];
    snprintf(text, sizeof(text),
             "{ \"scene\": { \"name\": \"one\", %s }, \"cameras\": [ { \"name\": \"own\" } ], \"size\": \"16x12\","
             "  \"frames\": 1, \"repetitions\": 1, \"reference\": { \"rays\": 4, \"frames\": 2 },"
             "  \"configurations\": [ { \"name\": \"is\", \"method\": \"is\" } ] }",
             scene);
    snprintf(place, sizeof(place), "%s/a.json", folder);
    noc_lab_spec *spec;
    noc_lab *lab;
    noc_lab_row row;
    double error = -1;
    if (noc_lab_spec_parse(text, place, &spec, log))
        fail_msg("%s", last);
    assert_int_equal(open_lab(spec, name, noc_lab_default_params(), &lab, log), NOC_OK);
    assert_int_equal(noc_lab_run(lab), NOC_OK);
    for (size_t r = 0; noc_lab_get_row(lab, r, &row); r++)
        error = value(&row, "rmse8_all");
    noc_lab_destroy(lab);
    noc_lab_spec_destroy(spec);
    return error;
}

/* A recipe in a spec is its inputs and its options; the spec's own options win. */
static void test_recipe(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    char path[200];
    snprintf(path, sizeof(path), "%s/town.yaml", folder);
    write_text(path, "nocturne: 1\ninputs: [builtin:mess]\nlights: 40\nscene-seed: 5\nsky: 1\n");
    double direct = error_of("\"inputs\": [\"builtin:mess\"], \"lights\": 40, \"scene-seed\": 5", "direct", log);
    double other = error_of("\"inputs\": [\"builtin:mess\"], \"lights\": 9, \"scene-seed\": 5", "other", log);
    assert_true(direct > 0 && other != direct);
    assert_true(error_of("\"inputs\": [\"town.yaml\"]", "recipe", log) == direct);
    assert_true(error_of("\"inputs\": [\"town.yaml\"], \"lights\": 9", "wins", log) == other);
    assert_int_equal(errors, 0);

    noc_lab_spec *spec;
    snprintf(path, sizeof(path), "%s/a.json", folder);
    const char *twice = "{ \"scene\": { \"name\": \"x\", \"inputs\": [\"town.yaml\", \"town.yaml\"] }, "
                        "\"configurations\": [{}] }";
    assert_int_equal(noc_lab_spec_parse(twice, path, &spec, log), NOC_ERR_FORMAT);
    assert_non_null(strstr(last, "a second recipe"));
    noc_log_destroy(log);
}

typedef struct watch {
    int frames, most; /* of them the end is asked for */
    int stages, notes;
} watch;

static bool watch_progress(void *user, const noc_lab_progress *p) {
    watch *w = user;
    w->stages |= 1 << p->stage;
    assert_true(p->done >= 0 && p->done <= 1);
    assert_true(p->what ? *p->what : p->stage == NOC_LAB_LOADING && p->done == 1);
    w->frames += p->stage == NOC_LAB_MEASURING && p->done == 0;
    return !(p->stage == NOC_LAB_MEASURING && p->done >= 0.5 && w->most);
}

static void watch_note(void *user, const char *text) {
    assert_non_null(strstr(text, "one, own: "));
    ((watch *)user)->notes++;
}

/* Cancelled in the middle, gone on with by another, which makes what is left and no more. */
static void test_going_on(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    noc_lab_spec *spec = parse(SPEC, log);
    noc_lab *lab, *other;
    noc_lab_state told;
    noc_lab_row row;
    watch w = { .most = 1 };
    noc_lab_params params = { .progress = watch_progress, .note = watch_note, .user = &w };
    assert_int_equal(open_lab(spec, "on", params, &lab, log), NOC_OK);
    assert_int_equal(noc_lab_run(lab), NOC_ERR_CANCELLED);
    assert_int_equal(errors, 0);
    assert_true(w.stages >= 1 << NOC_LAB_MEASURING && w.notes > 0);
    noc_lab_get_state(lab, &told);
    size_t before = told.rows, all = 2 * 2 * FRAMES * 2;
    assert_true(before > 0 && before < all);
    assert_int_equal(noc_lab_write_report(lab), NOC_ERR_ARGUMENT);
    assert_int_equal(open_lab(spec, "on", params, &other, log), NOC_ERR_IO); /* the folder is taken */
    assert_null(other);
    assert_non_null(strstr(last, "another experiment is writing there"));
    noc_lab_destroy(lab);

    w.most = 0;
    assert_int_equal(open_lab(spec, "on", params, &lab, log), NOC_OK);
    assert_int_equal(noc_lab_run(lab), NOC_OK);
    noc_lab_get_state(lab, &told);
    assert_true(told.rows == all && told.rows_made == all - before);
    assert_int_equal(noc_lab_run(lab), NOC_OK); /* once more: there is nothing to do */
    noc_lab_get_state(lab, &told);
    assert_true(told.rows_made == all - before);
    size_t rows = 0;
    while (noc_lab_get_row(lab, rows, &row))
        rows++;
    assert_int_equal(rows, all);
    noc_lab_destroy(lab);
    noc_lab_spec_destroy(spec);
    noc_log_destroy(log);
}

/* Of all that an experiment shows. */
static double sum_of_pictures(const char *name) {
    char pattern[200];
    double sum = 0;
    glob_t found;
    snprintf(pattern, sizeof(pattern), "%s/%s/pictures/*.exr", folder, name);
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        bool linear;
        noc_image *image = noc_image_read(found.gl_pathv[i], NULL, &linear);
        assert_non_null(image);
        for (int k = 0; k < 3 * image->width * image->height; k++)
            sum += image->rgb[k];
        noc_image_destroy(image);
    }
    globfree(&found);
    return sum;
}

/* A map around the scene, named as seen from the spec's folder: it lights the reference and what is measured. */
static void test_map(void **state) {
    (void)state;
    char text[2000], path[200];
    noc_log *log = fresh_log();
    noc_lab_spec *spec;
    noc_lab *lab;
    double mean[2] = { 0 };
    snprintf(text, sizeof(text), "%s", SPEC);
    char *at = strstr(text, "\"inputs\"");
    const char *rest = strstr(SPEC, "\"inputs\"");
    snprintf(at, sizeof(text) - (size_t)(at - text), "\"environment\": \"map.exr\", %s", rest);
    char *end = strstr(text, "\"size\"");
    rest = strstr(SPEC, "\"size\"");
    snprintf(end, sizeof(text) - (size_t)(end - text), "\"options\": { \"environment-light\": true }, %s", rest);
    snprintf(path, sizeof(path), "%s/map.json", folder);
    assert_int_equal(noc_lab_spec_parse(text, path, &spec, log), NOC_ERR_IO);
    assert_non_null(strstr(last, "map.exr"));
    for (int bright = 0; bright < 2; bright++) {
        noc_image *map = noc_image_create(16, 8, NULL);
        for (int i = 0; i < 3 * 16 * 8; i++)
            map->rgb[i] = bright ? 50 : 1e-3f;
        snprintf(path, sizeof(path), "%s/map.exr", folder);
        assert_int_equal(noc_image_write(map, path, NULL, NULL, log), NOC_OK);
        noc_image_destroy(map);
        snprintf(path, sizeof(path), "%s/map.json", folder);
        assert_int_equal(noc_lab_spec_parse(text, path, &spec, log), NOC_OK);
        assert_int_equal(open_lab(spec, bright ? "bright" : "dim", noc_lab_default_params(), &lab, log), NOC_OK);
        assert_int_equal(noc_lab_run(lab), NOC_OK);
        mean[bright] = sum_of_pictures(bright ? "bright" : "dim");
        noc_lab_destroy(lab);
        noc_lab_spec_destroy(spec);
    }
    assert_int_equal(warnings, 0);
    assert_true(mean[1] > 2 * mean[0]);
    noc_log_destroy(log);
}

/* A host that writes decimals with a comma gets the same table, and reads it again. */
static void test_locale(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    noc_lab_spec *spec = parse(SPEC, log);
    noc_lab *lab;
    noc_lab_state told;
    REQUIRE_COMMA_LOCALE(folder);
    for (int again = 0; again < 2; again++) {
        assert_int_equal(open_lab(spec, "locale", noc_lab_default_params(), &lab, log), NOC_OK);
        assert_int_equal(noc_lab_run(lab), NOC_OK);
        assert_int_equal(noc_lab_write_report(lab), NOC_OK);
        noc_lab_get_state(lab, &told);
        assert_int_equal(told.rows_made, again ? 0 : 2 * 2 * FRAMES * 2);
        noc_lab_destroy(lab);
    }
    setlocale(LC_ALL, "C");
    char command[300];
    snprintf(command, sizeof(command), "! grep -qE 'points=\"[0-9]+,[0-9]+,' '%s'/locale/*.svg", folder);
    assert_int_equal(system(command), 0);
    noc_lab_spec_destroy(spec);
    noc_log_destroy(log);
}

/* Parts of a spec in one folder, and who may be there with whom. */
static void test_parts(void **state) {
    (void)state;
    noc_log *log = fresh_log();
    noc_lab_spec *spec = parse(SPEC, log);
    noc_lab *one, *two, *other;
    noc_lab_params first = { .part = 1, .parts = 2 }, second = { .part = 2, .parts = 2 },
                   none = { .part = 3, .parts = 2 };
    noc_lab_state told;
    char path[200], cache[200];
    bool joined = true;
    snprintf(path, sizeof(path), "%s/parts", folder);
    snprintf(cache, sizeof(cache), "%s/cache", folder);
    assert_int_equal(open_lab(spec, "parts", none, &other, log), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(last, "part 3 of 2 does not exist"));
    assert_int_equal(open_lab(spec, "parts", (noc_lab_params){ .parts = 2 }, &other, log), NOC_ERR_ARGUMENT);
    assert_int_equal(open_lab(spec, "parts", first, &one, log), NOC_OK);
    assert_int_equal(open_lab(spec, "parts", second, &two, log), NOC_OK);
    assert_int_equal(open_lab(spec, "parts", first, &other, log), NOC_ERR_IO);
    assert_non_null(strstr(last, "another process is part 1 of 2 there"));
    assert_int_equal(open_lab(spec, "parts", (noc_lab_params){ 0 }, &other, log), NOC_ERR_IO);
    assert_non_null(strstr(last, "another experiment is writing there"));
    errors = 0;
    assert_int_equal(noc_lab_run(two), NOC_OK);
    noc_lab_get_state(two, &told);
    assert_int_equal(told.rows_made, 2 * FRAMES * 2);
    assert_int_equal(noc_lab_write_report(two), NOC_ERR_ARGUMENT); /* of all runs */
    noc_lab_destroy(two);
    errors = 0;
    second.folder = path, second.cache = cache;
    assert_int_equal(noc_lab_join(spec, &second, &joined, log), NOC_OK); /* the first part lives */
    assert_false(joined);
    noc_lab_destroy(one);
    assert_int_equal(noc_lab_join(spec, &second, &joined, log), NOC_OK); /* it has made nothing */
    assert_false(joined);
    assert_int_equal(open_lab(spec, "parts", first, &one, log), NOC_OK);
    assert_int_equal(noc_lab_run(one), NOC_OK);
    noc_lab_destroy(one);
    assert_int_equal(noc_lab_join(spec, &second, &joined, log), NOC_OK);
    assert_true(joined);
    assert_int_equal(noc_lab_join(spec, &second, &joined, log), NOC_OK); /* it is done */
    assert_true(joined);
    assert_int_equal(open_lab(spec, "parts", (noc_lab_params){ 0 }, &other, log), NOC_OK);
    assert_int_equal(noc_lab_run(other), NOC_OK);
    noc_lab_get_state(other, &told);
    assert_true(told.rows == 2 * 2 * FRAMES * 2 && !told.rows_made && !errors && !warnings);
    noc_lab_destroy(other);
    noc_lab_spec_destroy(spec);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_figures), cmocka_unit_test(test_measure_ends), cmocka_unit_test(test_spec),
        cmocka_unit_test(test_recipe),       cmocka_unit_test(test_going_on),     cmocka_unit_test(test_locale),
        cmocka_unit_test(test_map),          cmocka_unit_test(test_parts),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
