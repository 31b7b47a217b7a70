/* One wall with one image, as each format tells it: all give the same picture, the right way up. */
#include "looks.h"

#include "../own_view.h"

enum { SIDE = 32 };

/* Seen from +x, so that y goes to the right. */
static const char gml[] =
    GML_WALL("<app:ParameterizedTexture><app:imageURI>one.png</app:imageURI><app:target uri='#p'><app:TexCoordList>"
             "<app:textureCoordinates ring='#r'>0 0 1 0 1 1 0 1 0 0</app:textureCoordinates></app:TexCoordList>"
             "</app:target></app:ParameterizedTexture>");
static const char city_json[] =
    "{\"type\":\"CityJSON\",\"version\":\"2.0\",\"transform\":{\"scale\":[1,1,1],\"translate\":[0,0,0]},"
    "\"appearance\":{\"textures\":[{\"type\":\"PNG\",\"image\":\"one.png\"}],\"vertices-texture\":[[0,0],[1,0],[1,1],"
    "[0,1]]},\"CityObjects\":{\"b\":{\"type\":\"Building\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"2\","
    "\"boundaries\":[[[0,1,2,3]]],\"semantics\":{\"surfaces\":[{\"type\":\"WallSurface\"}],\"values\":[0]},"
    "\"texture\":{\"t\":{\"values\":[[[0,0,1,2,3]]]}}}]}},\"vertices\":[[0,0,0],[0,5,0],[0,5,5],[0,0,5]]}";
/* y is up, and z to the south */
#define OBJ(vertices, face) "mtllib one.mtl\n" vertices "usemtl a\n" face
#define QUAD                                                                                                           \
    OBJ("v 0 0 0\nv 0 0 -5\nv 0 5 -5\nv 0 5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 0\n",                            \
        "f 1/1/1 2/2/1 3/3/1 4/4/1\n")
#define PENTAGON                                                                                                       \
    OBJ("v 0 0 0\nvt 0 0\nv 0 0 -5\nvt 1 0\nv 0 2.5 -5\nvt 1 .5\nv 0 5 -5\nvt 1 1\nv 0 5 0\nvt 0 1\n",                 \
        "f -5/-5 -4/-4 -3/-3 -2/-2 -1/-1\n")
#define HALVES                                                                                                         \
    OBJ("v 0 0 0\nv 0 0 -5\nv 0 5 -5\nv 0 5 0\n  vt 0 0 0 # c\nvt +2 0\nvt 2 2\nvt 0 \\\n2\n", "f 1/1 2/2 3/3 4/4\n")
#define PLACES "0 0 0  0 0 -5  0 5 -5  0 5 0  0 1 1 1 1 0 0 0" /* then those in the image */
#define GLTF(image, more)                                                                                              \
    "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{"         \
    "\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":0,\"mode\":6}]}],\"materials\":[{\"pbrMetallicRoughness\":{"        \
    "\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0" more "}}}],\"textures\":[{\"source\":0}],\"images\":["    \
    "{" image "}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"             \
    "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}],\"bufferViews\":[{\"buffer\":0,"         \
    "\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},{\"buffer\":0,\"byteOffset\":80,"           \
    "\"byteLength\":%zu}],\"buffers\":[{%s\"byteLength\":%zu}]}"

/* A copy of the scene's wall without gloss, which formats have or have not, by one lamp of 10 lx. */
static noc_image *picture(const char *name, bool isolate) {
    noc_import_params params = looks_params(true);
    params.isolate = isolate;
    noc_report *report;
    noc_scene *s = load_by(name, &params, &report);
    if (s->textures.len != 1)
        fail_msg("%s has %zu images", name, s->textures.len);
    noc_report_destroy(report);
    const noc_scene_mesh *wall = wall_number(s, 0);
    noc_material m = s->materials.data[wall->material];
    m.f0 = 0;
    m.roughness = 1;
    assert_int_equal(noc_scene_set_material(s, wall->material, &m), NOC_OK);
    const float *low = s->positions.data + 3 * (size_t)wall->first_vertex;
    double centre[3] = { low[0], low[1] + 2.5, low[2] + 2.5 };
    noc_light far = { .kind = NOC_LIGHT_POINT,
                      .position = { centre[0] + 1000, centre[1], centre[2] },
                      .emission = { 1e7f, 1e7f, 1e7f } };
    assert_true(noc_scene_add_light(s, &far) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    noc_camera camera = noc_camera_default();
    noc_render_params p = noc_render_default_params();
    memcpy(camera.eye, centre, sizeof(centre));
    memcpy(camera.target, centre, sizeof(centre));
    camera.eye[0] += 6;
    camera.fov_deg = 35;
    p.width = p.height = SIDE;
    p.sky = 0;
    assert_int_equal(noc_view_render(view, &camera, &p, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    close_view(view);
    noc_scene_destroy(s);
    return image;
}

static void expect_same(const char *what, noc_image *image, const noc_image *first) {
    const float *at = image->rgb;
    /* the image's halves are 0.9 and 0.02, by 10 lx: white at the top left */
    const double want[4] = { 0.9, 0.02, 0.02, 0.02 };
    for (int i = 0; i < 4; i++) {
        double got = at[3 * ((i / 2 ? SIDE - 6 : 5) * SIDE + (i % 2 ? SIDE - 6 : 5))] * M_PI / 10;
        if (fabs(got - want[i]) > 0.04)
            fail_msg("%s: %g in corner %d, not %g", what, got, i, want[i]);
    }
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        if (fabsf(at[i] - first->rgb[i]) > 1e-3f * (at[i] + first->rgb[i]) + 1e-4f)
            fail_msg("%s: pixel %d,%d is %g, not %g", what, i / 3 % SIDE, i / 3 / SIDE, at[i], first->rgb[i]);
    if (image != first)
        noc_image_destroy(image);
}

static char *base64(const unsigned char *data, size_t n) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = noc_alloc(n * 2 + 5), *to = text;
    for (size_t i = 0; i < n; i += 3) {
        uint32_t v = (uint32_t)data[i] << 16 | (i + 1 < n ? (uint32_t)data[i + 1] << 8 : 0) |
                     (i + 2 < n ? (uint32_t)data[i + 2] : 0);
        for (int k = 0; k < 4; k++)
            *to++ = i + (size_t)k > n ? '=' : digits[v >> (18 - 6 * k) & 63];
    }
    *to = 0;
    return text;
}

/* Vertices, places in the image, and the image's own bytes. */
static unsigned char *buffer(const char *image, size_t *size, size_t *image_size) {
    FILE *f = fopen(in_folder(image), "rb");
    assert_non_null(f);
    unsigned char *bytes = noc_calloc(4096, 1);
    float number;
    const char *from = PLACES;
    for (int i = 0, n; i < 20; i++, from += n) {
        assert_int_equal(sscanf(from, "%f%n", &number, &n), 1);
        memcpy(bytes + 4 * i, &number, sizeof(number));
    }
    *image_size = fread(bytes + 80, 1, 4000, f);
    *size = 80 + *image_size;
    fclose(f);
    return bytes;
}

static void write_glb(const char *name, const char *json, const unsigned char *bytes, size_t size) {
    size_t text = (strlen(json) + 3) & ~(size_t)3, chunk = (size + 3) & ~(size_t)3, all = 28 + text + chunk;
    unsigned char *glb = noc_calloc(all, 1);
    const uint32_t head[] = { 0x46546c67, 2, (uint32_t)all, (uint32_t)text, 0x4e4f534a },
                   second[] = { (uint32_t)chunk, 0x004e4942 };
    memcpy(glb, head, sizeof(head));
    memset(glb + 20, ' ', text);
    memcpy(glb + 20, json, strlen(json));
    memcpy(glb + 20 + text, second, sizeof(second));
    memcpy(glb + 28 + text, bytes, size);
    write_bytes(name, glb, all);
    free(glb);
}

static void test_formats(void **state) {
    (void)state;
    write_image("one.png");
    write_file("one.gml", gml);
    write_file("one.json", city_json);
    noc_image *first = picture("one.gml", false);
    expect_same("CityGML", first, first);
    expect_same("CityJSON", picture("one.json", false), first);
    static const char *const objs[] = { QUAD, PENTAGON, HALVES };
    static const char *const mtls[] = {
        "newmtl a\nKd 0 0 0\nmap_Kd one.png\n", "newmtl a\nKd 1 1 1\nmap_Kd -clamp off -bm 1 \"one.png\"  \n",
        "newmtl b\nmap_Kd none.png\nnewmtl a\nKd 1 1 1\nmap_Kd -s .5 .5 1 -o 0 0 .\\one.png\n"
    };
    for (size_t i = 0; i < NOC_COUNT(objs); i++)
        for (int isolate = 0; isolate < 2; isolate++) {
            write_file("one.obj", objs[i]);
            write_file("one.mtl", mtls[i]);
            expect_same("OBJ", picture("one.obj", isolate), first);
        }
    noc_image_destroy(first);
}

static void test_gltf(void **state) {
    (void)state;
    size_t size, image_size;
    write_image("one.png");
    write_image("o n.png");
    write_file("one.gml", gml);
    unsigned char *bytes = buffer("one.png", &size, &image_size);
    char *all = base64(bytes, size), *alone = base64(bytes + 80, image_size);
    char *uri = noc_format("\"uri\":\"data:application/octet-stream;base64,%s\",", all);
    noc_image *first = picture("one.gml", false);
    char *json = noc_format(GLTF("\"bufferView\":2,\"mimeType\":\"image/png\"", ""), image_size, "", size);
    write_glb("one.glb", json, bytes, size);
    expect_same("GLB", picture("one.glb", false), first);
    free(json);
    json = noc_format(GLTF("\"uri\":\"o%%20n.png\"", ""), image_size, uri, size);
    write_file("one.gltf", json);
    expect_same("glTF and a file", picture("one.gltf", false), first);
    free(json);
    json = noc_format(GLTF("\"uri\":\"data:image/png;base64,%s\"", ""), alone, image_size, uri, size);
    write_file("one.gltf", json);
    expect_same("glTF and a data URI", picture("one.gltf", false), first);
    free(json);
    /* turned by 90 degrees counter-clockwise and back by the places: u' = v, v' = 1 - u of what the file tells */
    float turned[8];
    for (int i = 0; i < 4; i++) {
        float uv[2];
        memcpy(uv, bytes + 48 + 8 * i, sizeof(uv));
        turned[2 * i] = (1 - uv[1]) / 2;
        turned[2 * i + 1] = uv[0];
    }
    memcpy(bytes + 48, turned, sizeof(turned));
    free(all);
    free(uri);
    all = base64(bytes, size);
    uri = noc_format("\"uri\":\"data:application/octet-stream;base64,%s\",", all);
    json = noc_format(GLTF("\"uri\":\"one.png\"", ",\"extensions\":{\"KHR_texture_transform\":{\"rotation\":"
                                                  "1.5707963267948966,\"scale\":[2,1],\"offset\":[0,1]}}"),
                      image_size, uri, size);
    write_file("one.gltf", json);
    expect_same("glTF with a transform", picture("one.gltf", false), first);
    free(json);
    free(uri);
    free(all);
    free(alone);
    free(bytes);
    noc_image_destroy(first);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_formats), cmocka_unit_test(test_gltf) };
    return run_looks(tests, NOC_COUNT(tests));
}
