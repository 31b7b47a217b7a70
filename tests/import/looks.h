/* looks: files with images and colours in a folder of their own, what a load makes of them, and what it tells. Images
 * are 2 x 2 pixels, white at the top left, all else black: no turn or mirror of it is itself. */
#ifndef NOC_TEST_LOOKS_H
#define NOC_TEST_LOOKS_H

#include "../test.h"

#include "base/base.h"
#include "scene/scene.h"

#include <nocturne/image.h>
#include <nocturne/import.h>

#include <math.h>
#include <sys/stat.h>

static char folder[] = "/tmp/nocturne-looks-XXXXXX";
#include "../folder.h"

static inline void write_bytes(const char *name, const void *bytes, size_t size) {
    FILE *f = fopen(in_folder(name), "wb");
    assert_non_null(f);
    assert_true(fwrite(bytes, 1, size, f) == size && !fclose(f));
}

/* A wall 5 m wide along y and high, at x = 0, whose polygon is p and whose ring is r, with an appearance. */
#define GML_WALL(surface_data)                                                                                         \
    "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:gml='http://www.opengis.net/gml' "                    \
    "xmlns:app='http://www.opengis.net/citygml/appearance/2.0' "                                                       \
    "xmlns:bldg='http://www.opengis.net/citygml/building/2.0'><cityObjectMember><bldg:Building gml:id='b'>"            \
    "<bldg:boundedBy><bldg:WallSurface><bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember><gml:Polygon "      \
    "gml:id='p'><gml:exterior><gml:LinearRing gml:id='r'><gml:posList srsDimension='3'>0 0 0 0 5 0 0 5 5 0 0 5 0 0 0"  \
    "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember></gml:MultiSurface>"              \
    "</bldg:lod2MultiSurface></bldg:WallSurface></bldg:boundedBy></bldg:Building></cityObjectMember>"                  \
    "<app:appearanceMember><app:Appearance><app:surfaceDataMember>" surface_data "</app:surfaceDataMember>"            \
    "</app:Appearance></app:appearanceMember></CityModel>"

static inline void write_image(const char *name) {
    noc_image *image = noc_image_create(2, 2, NULL);
    noc_display_params linear = noc_display_default_params();
    image->rgb[0] = image->rgb[1] = image->rgb[2] = 1e6f;
    linear.auto_exposure = false;
    linear.tonemap = NOC_TONEMAP_LINEAR;
    linear.ev100 = 0;
    linear.white_kelvin = 0;
    assert_int_equal(noc_image_write(image, in_folder(name), &linear, NULL, NULL), NOC_OK);
    noc_image_destroy(image);
}

static inline noc_import_params looks_params(bool textures) {
    noc_import_params p = noc_import_default_params();
    p.textures = textures;
    p.windows = NOC_SWITCH_OFF;
    p.infer_lamps = NOC_SWITCH_OFF;
    return p;
}

static inline noc_scene *load_by(const char *name, const noc_import_params *p, noc_report **report) {
    noc_log *log = noc_log_create(NULL);
    const char *paths[] = { in_folder(name) };
    noc_scene *scene = noc_scene_create(log);
    if (noc_scene_load(scene, paths, 1, p, report) != NOC_OK)
        fail_msg("%s", noc_log_last_error(log));
    scene->log = NULL;
    noc_log_destroy(log);
    return scene;
}

static inline noc_scene *load(const char *name, bool textures, noc_report **report) {
    const noc_import_params p = looks_params(textures);
    return load_by(name, &p, report);
}

/* How often the report's file has such a line. */
static inline size_t told(const noc_report *report, const char *reason) {
    const noc_report_file *f = noc_report_get_file(report, 0);
    for (size_t i = 0; i < f->line_count; i++)
        if (strstr(f->lines[i].reason, reason))
            return f->lines[i].count;
    return 0;
}

/* The scene's origin lies where it will: walls, and what meshes without classes have for them, are counted from the
 * one at the least x. */
static inline const noc_scene_mesh *wall_number(const noc_scene *s, int number) {
    float least = INFINITY;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < s->meshes.len; i++) {
            const noc_scene_mesh *m = &s->meshes.data[i];
            noc_class cls = s->materials.data[m->material].cls;
            if (cls != NOC_CLASS_WALL && cls != NOC_CLASS_OTHER)
                continue;
            for (size_t v = m->first_vertex; v < noc_mesh_end_vertex(s, i); v++)
                if (!pass)
                    least = fminf(least, s->positions.data[3 * v]);
                else if (s->positions.data[3 * v] == least + (float)number)
                    return m;
        }
    fail_msg("there is no wall %d", number);
    return NULL;
}

static inline const noc_material *wall_material(const noc_scene *s, int number) {
    return &s->materials.data[wall_number(s, number)->material];
}

/* Is the wall in an image whose u goes along y, and v upwards? */
static inline void expect_upright(const noc_scene *s, int number) {
    const noc_scene_mesh *wall = wall_number(s, number);
    assert_true(wall->uv != 0);
    for (size_t v = 0; v < 4; v++) {
        const float *xyz = s->positions.data + 3 * (wall->first_vertex + v), *uv = s->uv.data + 2 * (wall->uv - 1 + v);
        const float *low = s->positions.data + 3 * (size_t)wall->first_vertex;
        assert_true(uv[0] == (xyz[1] > low[1]) && uv[1] == (xyz[2] > low[2]));
    }
}

static inline int run_looks(const struct CMUnitTest *tests, size_t count) {
    char command[96];
    assert_non_null(mkdtemp(folder));
    int failed = _cmocka_run_group_tests("looks", tests, count, NULL, NULL);
    snprintf(command, sizeof(command), "rm -r %s", folder);
    return system(command) ? 1 : failed;
}

#endif
