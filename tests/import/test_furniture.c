/* Street lamps of CityGML 2.0 and 3.0, with a body of their own and with one of a library: light and body stand where
 * the file has them. */
#include "city_pieces.h"
#include "../test.h"

#include "scene/scene.h"
#include <nocturne/nocturne.h>

#include <math.h>
#include <stdio.h>
#include <unistd.h>

/* A post of 12 cm and 8 m, an arm of 1.6 m along x, and a head under its end, from z on: boxes. */
static char *box(char *at, const double lo[3], const double hi[3]) {
    static const int side[6][4] = { { 2, 3, 1, 0 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                    { 1, 3, 7, 5 }, { 3, 2, 6, 7 }, { 2, 0, 4, 6 } };
    for (int s = 0; s < 6; s++) {
        at += sprintf(at, "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>");
        for (int k = 0; k < 5; k++) {
            int c = side[s][k % 4];
            at += sprintf(at, "%.3f %.3f %.3f ", c & 1 ? hi[0] : lo[0], c & 2 ? hi[1] : lo[1], c & 4 ? hi[2] : lo[2]);
        }
        at += sprintf(at, "</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>");
    }
    return at;
}

static void write_body(char *at, double x, double y, double z) {
    at = box(at, (double[]){ x - .06, y - .06, z }, (double[]){ x + .06, y + .06, z + 8 });
    at = box(at, (double[]){ x, y - .04, z + 7.8 }, (double[]){ x + 1.6, y + .04, z + 7.9 });
    box(at, (double[]){ x + 1.4, y - .15, z + 7.7 }, (double[]){ x + 2, y + .15, z + 7.85 });
}

enum { LAMPS = 3 };
#define EAST 678000.0
#define NORTH 5403000.0
#define GROUND 370.0

/* What a version calls a piece. */
typedef struct version {
    const char *number, *gml, *body, *library, *geometry;
} version;
static const version versions[] = {
    { "2.0", GML31, "f:lod2Geometry", "f:lod2ImplicitRepresentation", "relativeGMLGeometry" },
    { "3.0", GML32, "lod2MultiSurface", "lod2ImplicitRepresentation", "relativeGeometry" },
};

/* One with a body of its own; one with a library's, turned by 90 degrees about its post; one that points to that
 * library's, by half a turn. */
static char *write_city(const version *v) {
    char own[9000], library[9000];
    write_body(own, EAST, NORTH, GROUND);
    write_body(library, 0, 0, 0);
    return noc_format(
        "<CityModel xmlns='http://www.opengis.net/citygml/%1$s' xmlns:g='%2$s' "
        "xmlns:f='http://www.opengis.net/citygml/cityfurniture/%1$s' xmlns:x='http://www.w3.org/1999/xlink'>"
        "<g:boundedBy><g:Envelope srsName='EPSG:25832' srsDimension='3'>"
        "<g:lowerCorner>677990 5402990 370</g:lowerCorner>"
        "<g:upperCorner>678050 5403010 380</g:upperCorner></g:Envelope></g:boundedBy>"
        "<cityObjectMember><f:CityFurniture g:id='own'><f:class>1000</f:class><f:function>1150</f:function>"
        "<%3$s><g:MultiSurface>%6$s</g:MultiSurface></%3$s></f:CityFurniture></cityObjectMember>"
        "<cityObjectMember><f:CityFurniture g:id='turned'><f:class>1000</f:class><f:function>1150</f:function>"
        "<%4$s><ImplicitGeometry><transformationMatrix>0 -1 0 0 1 0 0 0 0 0 1 0 0 0 0 1</transformationMatrix>"
        "<%5$s><g:MultiSurface g:id='shape'>%7$s</g:MultiSurface></%5$s>"
        "<referencePoint><g:Point><g:pos>678020 5403000 370</g:pos></g:Point></referencePoint>"
        "</ImplicitGeometry></%4$s>"
        "</f:CityFurniture></cityObjectMember>"
        "<cityObjectMember><f:CityFurniture g:id='linked'><f:class>1000</f:class><f:function>1150</f:function>"
        "<%4$s><ImplicitGeometry><transformationMatrix>-1 0 0 0 0 -1 0 0 0 0 1 0 0 0 0 1</transformationMatrix>"
        "<%5$s x:href='#shape'/>"
        "<referencePoint><g:Point><g:pos>678040 5403000 370</g:pos></g:Point></referencePoint>"
        "</ImplicitGeometry></%4$s>"
        "</f:CityFurniture></cityObjectMember></CityModel>",
        v->number, v->gml, v->body, v->library, v->geometry, own, library);
}

/* Bounds of the meshes of that name, in the file's coordinates. */
static void bounds_of(const noc_scene *s, const char *name, double lo[3], double hi[3]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (size_t m = 0; m < s->meshes.len; m++) {
        const noc_scene_mesh *mesh = &s->meshes.data[m];
        if (!mesh->name || strcmp(mesh->name, name) || s->materials.data[mesh->material].cls != NOC_CLASS_LAMP ||
            s->triangle_light.data[mesh->first_triangle] != NOC_NO_LIGHT)
            continue;
        for (size_t i = 3 * (size_t)mesh->first_triangle; i < 3 * ((size_t)mesh->first_triangle + mesh->triangle_count);
             i++)
            for (int k = 0; k < 3; k++) {
                double x = (double)s->positions.data[3 * (size_t)s->indices.data[i] + (size_t)k] + s->origin[k];
                lo[k] = fmin(lo[k], x);
                hi[k] = fmax(hi[k], x);
            }
    }
}

static void light_and_body(void **state) {
    static const struct {
        const char *name;
        double head[3];      /* the middle of its underside */
        double lo[3], hi[3]; /* of the body */
    } expected[LAMPS] = {
        { "own",
          { EAST + 1.7, NORTH, GROUND + 7.7 },
          { EAST - .06, NORTH - .15, GROUND },
          { EAST + 2, NORTH + .15, GROUND + 8 } },
        { "turned",
          { EAST + 20, NORTH + 1.7, GROUND + 7.7 },
          { EAST + 19.85, NORTH - .06, GROUND },
          { EAST + 20.15, NORTH + 2, GROUND + 8 } },
        { "linked",
          { EAST + 38.3, NORTH, GROUND + 7.7 },
          { EAST + 38, NORTH - .15, GROUND },
          { EAST + 40.06, NORTH + .15, GROUND + 8 } },
    };
    (void)state;
    for (size_t v = 0; v < NOC_COUNT(versions); v++) {
        char path[] = "/tmp/noc-furniture-XXXXXX", *text = write_city(&versions[v]);
        int fd = mkstemp(path);
        assert_true(text && fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text) && !close(fd));
        free(text);
        noc_scene *s = noc_scene_create(NULL);
        const char *inputs[] = { path };
        noc_report *report;
        assert_int_equal(noc_scene_load(s, inputs, 1, NULL, &report), NOC_OK);
        const noc_report_file *file = noc_report_get_file(report, 0);
        assert_true(file->lamps == LAMPS && file->lights == LAMPS && s->lights.len == LAMPS);
        assert_int_equal(file->polygons_by_class[NOC_CLASS_LAMP], LAMPS * 3 * 6);
        for (size_t i = 0; i < LAMPS; i++) {
            double lo[3], hi[3];
            size_t l = 0;
            while (l < LAMPS && strcmp(s->light_names.data[l], expected[i].name))
                l++;
            assert_true(l < LAMPS);
            const noc_light_record *r = &s->lights.data[l];
            assert_int_equal(r->kind, NOC_LIGHT_DISC);
            assert_false(r->flags & NOC_LIGHT_INFERRED);
            for (int k = 0; k < 2; k++)
                assert_float_equal(r->p[k] + s->origin[k], expected[i].head[k], .05);
            double below = expected[i].head[2] - (r->p[2] + s->origin[2]);
            assert_true(below > 0 && below < .1);
            bounds_of(s, expected[i].name, lo, hi);
            for (int k = 0; k < 3; k++) {
                assert_float_equal(lo[k], expected[i].lo[k], 2e-3);
                assert_float_equal(hi[k], expected[i].hi[k], 2e-3);
            }
        }
        noc_report_destroy(report);
        noc_scene_destroy(s);
        unlink(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_and_body),
    };
    return cmocka_run_group_tests_name("import/furniture", tests, NULL, NULL);
}
