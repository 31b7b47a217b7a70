/* A million windows, from a file to pictures and back to dark glass. They have a program of their own, so that the most
 * memory that it took is theirs. */
#include "scene/scene.h"
#include "../own_view.h"
#include "../test.h"

#include <nocturne/nocturne.h>

#include <math.h>
#include <sys/resource.h>

enum { SIDE = 55, BLOCKS = SIDE * SIDE, LEAST = 1000000, WIDTH = 64, HEIGHT = 36 };

/* Rows of blocks of 28 to 34 m by 18 m, 18 to 36 m high, those of bench/blocks.py, as CityJSON. */
static void write_blocks(const char *path) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs("{\"type\": \"CityJSON\", \"version\": \"1.1\", \"metadata\": {\"referenceSystem\": "
          "\"https://www.opengis.net/def/crs/EPSG/0/25832\"},\n\"transform\": {\"scale\": [1, 1, 1], \"translate\": "
          "[690000, 5330000, 500]},\n\"CityObjects\": {\n",
          f);
    for (int k = 0; k < BLOCKS; k++) {
        int v = 8 * k;
        fprintf(f, "%s\"b%d\": {\"type\": \"Building\", \"geometry\": [{\"type\": \"MultiSurface\", \"lod\": \"2\", ",
                k ? ",\n" : "", k);
        fprintf(f, "\"boundaries\": [");
        for (int i = 0; i < 4; i++)
            fprintf(f, "[[%d, %d, %d, %d]], ", v + i, v + (i + 1) % 4, v + 4 + (i + 1) % 4, v + 4 + i);
        fprintf(f, "[[%d, %d, %d, %d]]]}]}", v + 4, v + 5, v + 6, v + 7);
    }
    fputs("},\n\"vertices\": [\n", f);
    for (int k = 0; k < 8 * BLOCKS; k++) {
        int i = k / 8 % SIDE, j = k / 8 / SIDE, corner = k % 4;
        int x = 48 * i + (corner == 1 || corner == 2 ? 28 + 2 * ((i + j) % 4) : 0), y = 32 * j + (corner >= 2 ? 18 : 0);
        fprintf(f, "%s[%d, %d, %d]", k ? ",\n" : "", x, y, k % 8 < 4 ? 0 : 18 + 3 * ((7 * i + 3 * j) % 7));
    }
    fputs("]}\n", f);
    assert_int_equal(fclose(f), 0);
}

/* Mean luminance of a few frames, where no window is seen but by its light. */
static double mean(const noc_scene *scene, noc_view *view, noc_candidates candidates) {
    noc_render_params p = noc_render_default_params();
    noc_camera c;
    double sum = 0;
    int count = 0;
    p.width = WIDTH;
    p.height = HEIGHT;
    p.method = NOC_METHOD_RIS;
    p.candidates = candidates;
    p.sky = 0;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, (double)WIDTH / HEIGHT, &c), NOC_OK);
    noc_view_reset(view);
    for (int i = 0; i < 96; i++)
        assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    assert_non_null(image);
    assert_non_null(image->emitter);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const float *rgb = image->rgb + 3 * i;
        double l = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        assert_true(l >= 0 && l < 1000); /* no window is brighter than 200 */
        sum += image->emitter[i] ? 0 : l;
        count += !image->emitter[i];
    }
    noc_image_destroy(image);
    assert_true(count > WIDTH * HEIGHT / 4);
    return sum / count;
}

static void test_million(void **state) {
    (void)state;
    char path[] = "/tmp/nocturne-million-XXXXXX";
    const char *input = path;
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    write_blocks(path);
    noc_scene *scene = noc_scene_create(NULL);
    noc_import_params params = noc_import_default_params();
    params.infer_lamps = NOC_SWITCH_OFF; /* windows are all the light there is */
    noc_status status = noc_scene_load(scene, &input, 1, &params, NULL);
    unlink(path);
    assert_int_equal(status, NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_true(info.windows >= LEAST);
    assert_int_equal(info.lights, info.windows);
    assert_true(info.windows_lit > LEAST / 5 && info.windows_lit < LEAST / 2);

    double bytes = (double)(scene->facade_cells.len * sizeof(uint32_t) + scene->facades.len * sizeof(facade_record)) +
                   (double)(info.windows * (sizeof(noc_light_record) + sizeof(char *) + sizeof(noc_scene_window)));
    assert_int_equal(info.triangles_by_class[NOC_CLASS_WINDOW], 0);
    assert_true(bytes / (double)info.windows < 110);
    size_t lit = 0;
    for (size_t i = 0; i < scene->windows.len; i++) {
        const noc_light_record *l = &scene->lights.data[scene->windows.data[i].light];
        assert_true(l->area > 0.5f && l->radius > 0.5f);
        lit += l->e[1] > 0;
    }
    assert_int_equal(lit, info.windows_lit);

    noc_view *view = own_view(scene, 0, NULL);
    assert_non_null(view);
    double lists = mean(scene, view, NOC_CANDIDATES_LISTS);
    double tree = mean(scene, view, NOC_CANDIDATES_LIGHT_BVH);
    assert_true(lists > 0.1);
    assert_true(fabs(tree / lists - 1) < 0.05);

    noc_window_params dark = noc_window_default_params();
    dark.lit_windows = 0;
    assert_int_equal(noc_scene_set_windows(scene, &dark), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_true(mean(scene, view, NOC_CANDIDATES_LISTS) < 0.1 * lists);
    close_view(view);

    struct rusage used;
    assert_int_equal(getrusage(RUSAGE_SELF, &used), 0);
    if (!SANITIZED)
        assert_true(used.ru_maxrss < 500000);
    print_message("# %zu windows: %.1f s of processor time, %ld MB at most; pictures of %.3f and %.3f cd/m2\n",
                  info.windows, (double)used.ru_utime.tv_sec + 1e-6 * (double)used.ru_utime.tv_usec,
                  used.ru_maxrss / 1000, lists, tree);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_million) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
