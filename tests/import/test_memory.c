/* Memory that is refused to an import: every allocation of small ones, alone and with all later ones. Each ends in
 * NOC_ERR_MEMORY and one message, leaves no file, and, in `make asan`, no leak; or what is imported is the same without
 * it. */
#include "../files.h"
#include "../memory.h"
#include "digest.h"

#include "geo/geo.h"
#include "import/import.h"
#include "import/lamps/tags.h"
#include "import/load/load.h"
#include "import/remote/remote.h"
#include <nocturne/nocturne.h>

#include <malloc.h>
#include <math.h>
#include <sys/socket.h>
#include <sys/stat.h>

static char folder[200], scratch[220]; /* of inputs; TMPDIR, which must be empty after every import */

static const char *path_of(const char *name) {
    static char paths[4][500];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof(paths[0]), "%s/%s", folder, name);
    return path;
}

static const char *write_text(const char *name, const char *text) {
    FILE *f = fopen(path_of(name), "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, strlen(text), f), strlen(text));
    fclose(f);
    return name;
}

/* ---- imports ---- */

typedef struct import {
    const char *inputs[3]; /* files; NULL behind the last */
    const char *crs, *scene_crs, *lamps, *columns, *body, *car, *tracks;
    bool isolate, inspect, footprints, traffic;
    bool all; /* of the first 300 allocations every one; else of the first 40, and of later ones ever fewer */
} import;

static noc_log *log_;

static noc_status run(const import *in, uint64_t number, bool and_later, bool *reached, uint64_t *sum) {
    const char *paths[3];
    size_t count = 0;
    for (; count < 3 && in->inputs[count]; count++)
        paths[count] = path_of(in->inputs[count]);
    noc_import_params params = noc_import_default_params();
    params.crs = in->crs;
    params.scene_crs = in->scene_crs;
    params.isolate = in->isolate;
    params.footprints = in->footprints;
    params.lamp_body = in->body ? path_of(in->body) : NULL;
    params.cars.bodies = (noc_texts){ { in->car ? path_of(in->car) : NULL }, in->car != NULL };
    params.cars.body_length = 4;
    params.tracks = (noc_texts){ { in->tracks ? path_of(in->tracks) : NULL }, in->tracks != NULL };
    params.traffic = in->traffic ? NOC_SWITCH_ON : NOC_SWITCH_AUTO;
    if (in->lamps)
        params.lamps = (noc_texts){ .text = { path_of(in->lamps) }, .count = 1 };
    if (in->columns)
        params.lamp_columns = (noc_texts){ .text = { in->columns }, .count = 1 };
    noc_scene *scene = noc_scene_create(log_);
    noc_report *report = NULL;
    assert_non_null(scene);
    begin_refusal(number, and_later);
    noc_status status = load_inputs(scene, noc_readers, paths, count, &params, in->inspect, &report);
    *reached = end_refusal();
    *sum = digest_of(scene, report);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    assert_int_equal(files_in(scratch), 0);
    return status;
}

static void refuse_each(const char *what, const import *in) {
    uint64_t whole, sum, tried = 0, refused = 0;
    bool reached;
    run(in, UINT64_MAX, false, &reached, &whole); /* what is kept between imports is kept now */
    noc_status status = run(in, UINT64_MAX, false, &reached, &whole);
    if (status != NOC_OK)
        fail_msg("%s: status %d: %s", what, status, refusing.first_error);
    for (int later = 0; later < 2; later++) {
        reached = true;
        uint64_t dense = in->isolate || later ? 0 : in->all ? 300 : 40; /* the helper costs a process each time */
        for (uint64_t n = 1; reached; n += n < dense ? 1 : 1 + n / (in->isolate || is_quick() ? 4 : 10)) {
            status = run(in, n, later, &reached, &sum);
            if (status == NOC_OK)
                assert_unharmed(sum == whole, what);
            else
                assert_refused(status, what);
            tried++;
            refused += status != NOC_OK;
        }
    }
    assert_true(refused > tried / 2);
    print_message("# %s: %llu imports\n", what, (unsigned long long)tried);
}

static const char links[] =
    "<?xml version='1.0'?>"
    "<core:CityModel xmlns:core='http://www.opengis.net/citygml/2.0' "
    "xmlns:bldg='http://www.opengis.net/citygml/building/2.0' "
    "xmlns:frn='http://www.opengis.net/citygml/cityfurniture/2.0' "
    "xmlns:gen='http://www.opengis.net/citygml/generics/2.0' xmlns:gml='http://www.opengis.net/gml' "
    "xmlns:xlink='http://www.w3.org/1999/xlink'>"
#define MEMBER(xml) "<core:cityObjectMember>" xml "</core:cityObjectMember>"
#define POLYGON(id, list)                                                                                              \
    "<gml:surfaceMember><gml:Polygon gml:id='" id "'><gml:exterior><gml:LinearRing><gml:posList>" list                 \
    "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
#define BUILDING(id, inside)                                                                                           \
    MEMBER("<bldg:Building gml:id='" id "'><bldg:lod2MultiSurface><gml:MultiSurface>" inside                           \
           "</gml:MultiSurface></bldg:lod2MultiSurface></bldg:Building>")
    /* clang-format off */
    BUILDING("first", "<gml:surfaceMember xlink:href='#wall'/>"
             POLYGON("five", "0 0 0 9 0 0 9 0 5 5 0 9 0 0 5 0 0 0")) /* forwards */
    BUILDING("second", POLYGON("wall", "0 9 0 9 9 0 9 9 6 0 9 6 0 9 0"))
    BUILDING("third", "<gml:surfaceMember xlink:href='#wall'/>"
                      "<gml:surfaceMember xlink:href='#nowhere'/>" POLYGON("flat", "0 0 0 1 0 0 2 0 0 0 0 0"))
    MEMBER("<frn:CityFurniture gml:id='lamp'><gen:stringAttribute name='Leuchtmittel'>"
           "<gen:value>LED 30 W</gen:value></gen:stringAttribute><frn:function>1150</frn:function><frn:lod2Geometry>"
           "<gml:MultiSurface>" POLYGON("pole", "20 0 0 20.1 0 0 20.1 0 5 20 0 5 20 0 0")
           POLYGON("arm", "20 0 5 20 1.2 5 20 1.2 5.1 20 0 5.1 20 0 5") "</gml:MultiSurface></frn:lod2Geometry>"
                                                                        "</frn:CityFurniture>")
    "</core:CityModel>";

static const char strange[] =
    "<?xml version='1.0'?>"
    "<core:CityModel xmlns:core='http://www.opengis.net/citygml/2.0' "
    "xmlns:bldg='http://www.opengis.net/citygml/building/2.0' xmlns:gml='http://www.opengis.net/gml'><gml:boundedBy>"
    "<gml:Envelope srsName='our own system'/></gml:boundedBy>"
    BUILDING("only", POLYGON("wall", "690000 5330000 0 690009 5330000 0 690009 5330000 5 690000 5330000 5 690000 "
                                     "5330000 0")) "</core:CityModel>";
/* clang-format on */

/* In the extent of citygml/whole.gml. */
static const char trip[] = "<gpx><trk><trkseg><trkpt lat='48.09626' lon='11.55218'/><trkpt lat='48.09618' "
                           "lon='11.55567'/></trkseg></trk></gpx>";
static const char street[] = "<osm version='0.6'><node id='1' lat='48.09505' lon='11.55387'/><node id='2' "
                             "lat='48.09739' lon='11.55398'/><way id='3'><nd ref='1'/><nd ref='2'/><tag k='highway' "
                             "v='primary'/></way></osm>";

static void citygml(void **state) {
    refuse_each("CityGML", &(import){ { "citygml/whole.gml" }, .all = true });
    refuse_each("CityGML with appearances", &(import){ { "citygml/looks.gml" } });
    refuse_each("CityGML with references between objects", &(import){ { write_text("links.gml", links) } });
    refuse_each("CityGML, zip, another CRS", &(import){ { "citygml/old.zip" }, .scene_crs = "EPSG:25832" });
    refuse_each("CityGML with a CRS that is not understood",
                &(import){ { write_text("strange.gml", strange) }, .crs = "EPSG:25832" });
    refuse_each("CityGML, gzip, looked at", &(import){ { "citygml/whole.gml.gz" }, .inspect = true });
}

/* Two images whose files hold the same. */
static void images(void **state) {
    noc_image *image = noc_image_create(2, 2, NULL);
    assert_int_equal(noc_image_write(image, path_of("a.png"), NULL, NULL, NULL), NOC_OK);
    assert_int_equal(noc_image_write(image, path_of("b.png"), NULL, NULL, NULL), NOC_OK);
    noc_image_destroy(image);
#define CORNERS(x) x " 0 0 " x " 5 0 " x " 5 5 " x " 0 5 " x " 0 0"
#define TEXTURED(image, ring)                                                                                          \
    "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>" image "</app:imageURI>"                          \
    "<app:target uri='#w'><app:TexCoordList><app:textureCoordinates ring='#" ring "'>0 0 1 0 1 1 0 1 0 0"              \
    "</app:textureCoordinates></app:TexCoordList></app:target></app:ParameterizedTexture></app:surfaceDataMember>"
#define WALL(ring, x)                                                                                                  \
    "<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing gml:id='" ring                                      \
    "'><gml:posList>" CORNERS(x) "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
    write_text(
        "images.gml",
        "<core:CityModel xmlns:core='http://www.opengis.net/citygml/2.0' "
        "xmlns:bldg='http://www.opengis.net/citygml/building/2.0' "
        "xmlns:app='http://www.opengis.net/citygml/appearance/2.0' xmlns:gml='http://www.opengis.net/gml'>" BUILDING(
            "house", WALL("p", "0") WALL("q", "9")) "<app:appearanceMember><app:Appearance>" TEXTURED("a.png", "p")
            TEXTURED("b.png", "q") "</app:Appearance></app:appearanceMember></core:CityModel>");
    refuse_each("CityGML with images", &(import){ { "images.gml" } });
}

static void cityjson(void **state) {
    refuse_each("CityJSON", &(import){ { "cityjson/whole.json" }, .all = true });
    refuse_each("CityJSON with appearances", &(import){ { "cityjson/looks.json" } });
    refuse_each("CityJSONSeq with appearances", &(import){ { "cityjson/looks.jsonl" } });
    refuse_each("CityJSONSeq", &(import){ { "cityjson/lines.jsonl" }, .scene_crs = "EPSG:25832" });
}

static void gltf(void **state) {
    refuse_each("glTF", &(import){ { "gltf/embedded.gltf" }, .all = true });
    refuse_each("glTF with an image", &(import){ { "gltf/image.gltf" } });
    refuse_each("glTF with an image as text", &(import){ { "gltf/image-uri.gltf" } });
    write_text("library.gltf",
               "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": 0, \"children\": [1], "
               "\"name\": \"a name longer than sixteen letters\"}, "
               "{}],\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}], "
               "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126,"
               "\"count\": 3, \"type\": \"VEC3\"}], \"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], "
               "\"buffers\": [{\"byteLength\": 36, \"uri\": \"side%20by%20side.bin\"}]}");
    write_text("side by side.bin", "\x01\x01\x80?"
                                   "\x01\x01\x80?"
                                   "\x01\x01\x80?"
                                   "\x01\x01\x01\x40"
                                   "\x01\x01\x80?"
                                   "\x01\x01\x80?"
                                   "\x01\x01\x80?"
                                   "\x01\x01\x01\x40"
                                   "\x01\x01\x80?");
    refuse_each("glTF with its buffer beside it", &(import){ { "library.gltf" }, .crs = "EPSG:25832" });
}

static void ply(void **state) { refuse_each("PLY", &(import){ { "ply/text.ply" }, .crs = "EPSG:25832" }); }

static void obj(void **state) {
    write_text("house.obj",
               "mtllib house.mtl none.mtl\nv 0 0 0\nv 10 0 0\nv 10 0 8\nv 0 0 8\nv 5 0 12\nv 5 x 12\nusemtl wall\n"
               "f 1 2 3 5 4\nusemtl lamp\nf 1 3 2\nf 1 2 9\n");
    write_text("house.mtl", "newmtl wall\nKd 0.5 0.4 0.3\nnewmtl lamp\nKe 20 18 15\nmap_Kd none.png\n");
    refuse_each("OBJ", &(import){ { "house.obj" } });
    refuse_each("OBJ by the helper", &(import){ { "house.obj" }, .isolate = true });
    write_text("drawn.obj",
               "mtllib drawn.mtl\nv 0 0 0\nv 9 0 0\nv 9 9 0\nv 5 3 0\nv 0 9 0\nvt 0 0\nvt 1 0\nvt 1\nvt 0 1\n"
               "usemtl wall\nf 1/1 2/2 3/3 4/4 5/1\nf 1/1 2/2 5/9\n");
    write_text("drawn.mtl", "newmtl wall\nKd 1 1 1\nmap_Kd -s 2 2 png/rgb.png\n");
    refuse_each("OBJ with an image", &(import){ { "drawn.obj" } });
    refuse_each("OBJ with an image by the helper", &(import){ { "drawn.obj" }, .isolate = true });
}

static void lamps(void **state) {
    refuse_each("CSV", &(import){ { "csv/comma.csv" } });
    refuse_each("A body for lamps", &(import){ { "csv/comma.csv" }, .body = "gltf/embedded.gltf" });
    refuse_each("CSV with a CRS", &(import){ { "csv/semicolon.csv" }, .crs = "EPSG:31468" });
    write_text("kinds.csv", "x;y;art\n690110;5330110;Lichtmast mit Auslegerleuchte\n690150;5330110;Lichtmast\n"
                            "690180;5330110;\"Mast \"\"alt\"\"\"\n");
    refuse_each("CSV whose values tell", &(import){ { "kinds.csv" }, .crs = "EPSG:25832" });
    write_text("named.csv", "x,y,pow\n690110,5330110,50\n690150,5330110,70\n");
    refuse_each("CSV that is named, beside a city", &(import){ { "citygml/whole.gml" },
                                                               .lamps = "named.csv",
                                                               .columns = "watts=pow,x=x,y=y",
                                                               .crs = "EPSG:25832" });
    refuse_each("Overpass", &(import){ { "overpass/nodes.json" } });
    refuse_each("Roads of Overpass", &(import){ { "overpass/roads.json" } });
    refuse_each("Areas of Overpass", &(import){ { "overpass/areas.json" }, .footprints = true });
}

static const char car[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                          "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                          "0 0 0\n2 0 0\n2 4 1\n0 4 1\n3 0 1 2\n3 0 2 3\n";

/* Beside the city, which is no matter here. */
static const char timed[] =
    "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"track\":\"a\","
    "\"time\":\"1\",\"coordTimes\":[[1,2],[3,\"4\"]]},\"geometry\":{\"type\":\"MultiLineString\","
    "\"coordinates\":[[[11.5,48.1],[11.5,48.2]],[[11,48],[11,48.1]]]}},{\"type\":\"Feature\","
    "\"properties\":{\"track\":\"b\",\"time\":\"1\"},\"geometry\":{\"type\":\"Point\",\"coordinates\":"
    "[11.5,48.1]}},{\"type\":\"Feature\",\"properties\":{\"track\":\"b\",\"time\":\"2\"},\"geometry\":"
    "{\"type\":\"Point\",\"coordinates\":[11.5,48.2]}}]}";

static void maps(void **state) {
    if (!strstr(noc_features(), "gdal"))
        skip();
    refuse_each("GeoJSON", &(import){ { "geojson/plain.json" } });
    refuse_each("OpenStreetMap", &(import){ { "osm/lamps.osm" } });
    refuse_each("PBF", &(import){ { "pbf/lamps.pbf" } });
    refuse_each("GeoPackage", &(import){ { "gpkg/lamps.gpkg" } });
    refuse_each("Shapefile, zip", &(import){ { "shp/lamps.zip" } });
    refuse_each("Buildings of a map", &(import){ { "geojson/buildings.json" }, .footprints = true });
    refuse_each("Buildings of a map by the helper",
                &(import){ { "geojson/buildings.json" }, .footprints = true, .isolate = true });
    refuse_each("Roads of a map", &(import){ { "osm/roads.osm" } });
    refuse_each("Roads of a map by the helper", &(import){ { "geojson/roads.json" }, .isolate = true });
    refuse_each("Cars",
                &(import){ { "citygml/whole.gml", write_text("street.osm", street), write_text("trip.gpx", trip) },
                           .traffic = true });
    refuse_each("A body for cars",
                &(import){ { "citygml/whole.gml", write_text("trip.gpx", trip) }, .car = write_text("car.ply", car) });
    refuse_each("Tracks of a map", &(import){ { "citygml/whole.gml" }, .tracks = write_text("timed.json", timed) });
    refuse_each("Tracks of a map by the helper",
                &(import){ { "citygml/whole.gml" }, .tracks = write_text("timed.json", timed), .isolate = true });
    refuse_each("GeoTIFF", &(import){ { "terrain/floats.tif" } });
    refuse_each("GeoTIFF by the helper", &(import){ { "terrain/floats.tif" }, .isolate = true });
    refuse_each("GeoJSON by the helper", &(import){ { "geojson/plain.json" }, .isolate = true });
}

/* ---- coordinate systems ---- */

static noc_status use_crs(const char *from, const char *to) {
    noc_status status;
    geo_crs *a = geo_crs_create_plain(from, "file", log_, &status),
            *b = a ? geo_crs_create(to, NULL, log_, &status) : NULL;
    geo_transform *t = b ? geo_transform_create(a, b, log_, &status) : NULL;
    double p[3] = { 11, 48, 500 };
    if (t)
        assert_int_equal(geo_transform_points(t, p, 1), 0);
    geo_transform_destroy(t);
    geo_crs_destroy(b);
    geo_crs_destroy(a);
    return status;
}

static void coordinate_systems(void **state) {
    static const char *const froms[] = { "OGC:CRS84", "EPSG:4326", "+proj=longlat +ellps=GRS80", "WGS 84" };
    for (size_t i = 0; i < NOC_COUNT(froms); i++) {
        bool reached;
        assert_int_equal(use_crs(froms[i], "EPSG:25832"), NOC_OK);
        FOR_EACH_REFUSAL(reached) {
            begin_refusal(n, later);
            noc_status status = use_crs(froms[i], "EPSG:25832");
            reached = end_refusal();
            if (reached)
                assert_refused(status, froms[i]);
            else
                assert_int_equal(status, NOC_OK);
        }
    }
}

static void places_of_a_scene(void **state) {
    noc_scene *scene = noc_scene_create(log_);
    noc_import_params params = noc_import_default_params();
    assert_int_equal(noc_scene_load(scene, (const char *[]){ path_of("citygml/whole.gml") }, 1, &params, NULL), NOC_OK);
    double xyz[3] = { 0, 0, 0 };
    assert_int_equal(noc_scene_from_local(scene, "EPSG:4326", xyz), NOC_OK);
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        double p[3] = { 0, 0, 0 };
        begin_refusal(n, later);
        noc_status status = noc_scene_from_local(scene, "EPSG:4326", p);
        reached = end_refusal();
        if (reached)
            assert_refused(status, "from local");
        assert_true(p[0] == (reached ? 0 : xyz[0]));
    }
    noc_scene_destroy(scene);
}

/* ---- polygons ---- */

/* Round, with a round hole: so many points that crossings are looked for, and a tessellator is needed. */
static void polygons(void **state) {
    enum { POINTS = 120 };
    static double xyz[2 * POINTS * 3];
    const size_t sizes[2] = { POINTS, POINTS };
    for (int i = 0; i < 2 * POINTS; i++) {
        double angle = 2 * M_PI * i / POINTS * (i < POINTS ? 1 : -1), r = i < POINTS ? 20 : 10;
        xyz[3 * i] = r * cos(angle);
        xyz[3 * i + 1] = r * sin(angle);
    }
    const geo_polygon ring = { .cls = NOC_CLASS_ROOF, .id = "ring", .ring_count = 2, .ring_size = sizes, .xyz = xyz };
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        geo_triangles t = { 0 };
        geo_issues *issues = geo_issues_create();
        assert_non_null(issues);
        begin_refusal(n, later);
        bool made = geo_triangulate(&ring, &t, issues);
        reached = end_refusal();
        assert_true(made == !reached && t.no_memory == reached);
        assert_true(reached ? !t.indices.len : t.indices.len == 3 * 2 * POINTS);
        assert_int_equal(geo_issues_count(issues), 0); /* it is not the polygon's fault */
        geo_issues_destroy(issues);
        geo_triangles_free(&t);
    }
}

/* ---- the helper ---- */

/* What it is asked takes memory there. */
static void a_request(void **state) {
    noc_import_params params = noc_import_default_params();
    params.crs = "EPSG:25832";
    geo_sink sink = { .named_lamps = true };
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        int ends[2];
        remote_record batch = { 0 };
        remote_request request;
        assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
        begin_refusal(n, later);
        remote_ask(&batch, &noc_reader_mesh, "house.obj", &params, &sink);
        reached = end_refusal();
        assert_true(batch.refused == reached);
        array_free(&batch.bytes);
        batch = (remote_record){ 0 };
        remote_ask(&batch, &noc_reader_mesh, "house.obj", &params, &sink);
        assert_true(remote_send(ends[0], &batch));
        begin_refusal(n, later);
        bool received = remote_receive(ends[1], &request);
        bool short_of = end_refusal();
        assert_true(received == !short_of && request.texts.refused == short_of);
        assert_true(!received || (!strcmp(request.path, "house.obj") && !strcmp(request.params.crs, "EPSG:25832")));
        reached = reached || short_of;
        remote_request_free(&request);
        array_free(&batch.bytes);
        close(ends[0]);
        close(ends[1]);
    }
}

/* It has none for its answer, and says so as it ends. */
static void a_helper_without_memory(void **state) {
    const char *real = getenv("NOCTURNE_READER"), *fake = path_of("helper");
    char kept[500];
    snprintf(kept, sizeof(kept), "%s", real ? real : "");
    write_text("helper", "#!/bin/sh\nexit 3\n");
    assert_int_equal(chmod(path_of("helper"), 0700), 0);
    setenv("NOCTURNE_READER", fake, 1);
    write_text("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    bool reached;
    uint64_t sum;
    noc_status status = run(&(import){ { "bare.obj" }, .isolate = true }, UINT64_MAX, false, &reached, &sum);
    assert_refused(status, "helper");
    assert_non_null(strstr(refusing.first_error, "--max-memory"));
    setenv("NOCTURNE_READER", kept, 1);
}

typedef struct blanks {
    size_t left, pulled, in_use; /* in_use: when it began */
} blanks;

static size_t bytes_in_use(void) {
    struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static size_t pull_blanks(void *buffer, size_t size, void *user) {
    blanks *b = user;
    size_t aside = bytes_in_use() - b->in_use; /* nothing is kept of blanks */
    assert_in_range(aside, 2 * b->pulled, 3 * b->pulled + (4 << 20));
    size = b->left < size ? b->left : size;
    memset(buffer, ' ', size);
    b->left -= size;
    b->pulled += size;
    return size;
}

/* jansson does not look whether the text that it reads could grow; so what that can take, which is up to twice as much,
 * is set aside. What counts is what came, not the size of a file that may be compressed. */
static void json_has_memory_aside(void **state) {
    if (SANITIZED) /* which has a malloc of its own */
        skip();
    blanks b = { .left = 16 << 20, .in_use = bytes_in_use() };
    json_error_t error;
    assert_null(import_json_load(pull_blanks, &b, 0, &error)); /* no JSON in it */
    assert_int_equal(b.pulled, 16 << 20);
    assert_in_range(bytes_in_use() - b.in_use, 0, 1 << 16);
}

/* Reading goes on after a value that there was no memory to count; the next lamp may have the same one. */
static void values_that_are_not_understood(void **state) {
    (void)state;
    bool reached = true;
    for (uint64_t n = 1; reached; n++) {
        lamp_unread *u = lamp_unread_create();
        assert_non_null(u);
        begin_refusal(n, false);
        bool counted = lamp_unread_add(u, "source", "", "glow-worm", "a");
        reached = end_refusal();
        assert_true(counted != reached);
        assert_true(lamp_unread_add(u, "source", "", "glow-worm", "b"));
        assert_true(lamp_unread_add(u, "source", "", "will-o'-the-wisp", "c"));
        geo_issues *issues = geo_issues_create();
        lamp_unread_tell(u, issues);
        geo_issues_destroy(issues);
        lamp_unread_destroy(u);
    }
}

static int make_inputs(void **state) {
    char command[900];
    snprintf(folder, sizeof(folder), "/tmp/noc-memory-%ld", (long)getpid());
    snprintf(scratch, sizeof(scratch), "%s/tmp", folder);
    snprintf(command, sizeof(command), "mkdir -p %s && python3 %s/fuzz/seeds.py %s true -", scratch,
             getenv("NOC_SOURCE"), folder);
    setenv("TMPDIR", scratch, 1);
    log_ = counting_log();
    return system(command);
}

static int remove_inputs(void **state) {
    char command[900];
    snprintf(command, sizeof(command), "rm -rf %s", folder);
    noc_log_destroy(log_);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coordinate_systems),
        cmocka_unit_test(citygml),
        cmocka_unit_test(images),
        cmocka_unit_test(cityjson),
        cmocka_unit_test(gltf),
        cmocka_unit_test(ply),
        cmocka_unit_test(obj),
        cmocka_unit_test(lamps),
        cmocka_unit_test(values_that_are_not_understood),
        cmocka_unit_test(maps),
        cmocka_unit_test(places_of_a_scene),
        cmocka_unit_test(polygons),
        cmocka_unit_test(a_request),
        cmocka_unit_test(a_helper_without_memory),
        cmocka_unit_test(json_has_memory_aside),
    };
    return cmocka_run_group_tests(tests, make_inputs, remove_inputs);
}
