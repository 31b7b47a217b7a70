/* Members of a CityGML file on several threads: whatever their number and the size of the pieces, the scene, the report
 * and the messages are those of one thread, which reads the file as a whole. */
#include "city_pieces.h"
#include "digest.h"
#include "import/citygml/citygml.h"
#include "../memory.h"
#include "../test.h"

#include <stdarg.h>
#include <unistd.h>

/* ---- files ---- */

static char path[] = "/tmp/noc-members-XXXXXX";
static NOC_ARRAY(char) text;

static void put(const char *fmt, ...) {
    char some[3000];
    va_list ap;
    va_start(ap, fmt);
    int n = vsnprintf(some, sizeof(some), fmt, ap);
    va_end(ap);
    assert_in_range(n, 0, sizeof(some) - 1);
    assert_true(array_append(&text, some, (size_t)n));
}

static void write_file(void) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_int_equal(fwrite(text.data, 1, text.len, f), text.len);
    fclose(f);
}

#define CRS "<g:Envelope srsName='EPSG:25832'/>"
static void begin(void) {
    text.len = 0;
    put("<?xml version='1.0' encoding='UTF-8'?>\n<!-- <a> -->\n<CityModel" NAMESPACES("2.0", GML31) " a='>'>\n");
    put("<g:boundedBy>" CRS "</g:boundedBy>\n");
}

/* A house of three walls and a roof, with more points each than a triangle has. */
static void house(int n, const char *more) {
    int x = 678000 + n % 20 * 30, y = 5404000 + n / 20 * 30;
    put("<cityObjectMember>\n<b:Building g:id='h%d'><g:name>House %d</g:name>%s", n, n, more);
    for (int i = 0; i < 3; i++) {
        int a = x + i * 5, b = a + 5;
        put("<b:boundedBy><b:WallSurface><b:lod2MultiSurface><g:MultiSurface><g:surfaceMember>"
            "<g:Polygon g:id='w%d-%d'><g:exterior><g:LinearRing><g:posList>%d %d 0 %d %d 0 %d %d 9 %d %d 11 %d %d 9 "
            "%d %d 0</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember></g:MultiSurface>"
            "</b:lod2MultiSurface></b:WallSurface></b:boundedBy>",
            n, i, a, y, b, y, b, y, a + 2, y, a, y, a, y);
    }
    put("</b:Building>\n</cityObjectMember>\n");
}

static void houses(int from, int to) {
    for (int i = from; i < to; i++)
        house(i, "");
}

static void end(void) {
    put("</CityModel>\n");
    write_file();
}

/* ---- loads ---- */

typedef struct outcome {
    noc_status status;
    uint64_t sum;
    double extent[6];
    size_t buildings, ahead;
    bool reached; /* the allocation that is refused */
    char said[6000];
} outcome;

static void note(void *user, noc_log_level level, const char *message) {
    outcome *o = user;
    size_t n = strlen(o->said);
    snprintf(o->said + n, sizeof(o->said) - n, "%d %s\n", level, message);
}

static uint64_t refuse_at; /* 0: no allocation */
static bool refuse_later;

static outcome load(int threads, size_t piece, noc_import_params params) {
    outcome o = { 0 };
    const char *paths[] = { path };
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_DEBUG, .message = note, .user = &o });
    noc_scene *scene = noc_scene_create(log);
    noc_report *report = NULL;
    params.threads = threads;
    cg_members_at_once = piece;
    size_t before = cg_members_ahead;
    if (refuse_at)
        noc_refuse_allocation(refuse_at, refuse_later);
    o.status = noc_scene_load(scene, paths, 1, &params, &report);
    o.reached = noc_allocations() >= refuse_at;
    noc_refuse_allocation(0, false);
    o.ahead = cg_members_ahead - before;
    o.sum = digest_of(scene, report);
    if (noc_report_file_count(report)) {
        const noc_report_file *f = noc_report_get_file(report, 0);
        memcpy(o.extent, f->extent_min, sizeof(f->extent_min));
        memcpy(o.extent + 3, f->extent_max, sizeof(f->extent_max));
        o.buildings = f->buildings;
    }
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return o;
}

static void assert_same(const outcome *a, const outcome *b) {
    assert_int_equal(a->status, b->status);
    assert_string_equal(a->said, b->said);
    assert_int_equal(a->buildings, b->buildings);
    assert_memory_equal(a->extent, b->extent, sizeof(a->extent));
    assert_true(a->sum == b->sum);
}

/* The outcome of one thread; ahead is the most of those by several, which what they meet first makes less. */
static outcome load_by_all_with(noc_import_params params) {
    static const size_t pieces[] = { 3000, 9000 };
    static const int threads[] = { 2, 5 };
    outcome one = load(1, 3000, params);
    assert_int_equal(one.ahead, 0);
    for (size_t i = 0; i < NOC_COUNT(pieces); i++)
        for (size_t k = 0; k < NOC_COUNT(threads); k++) {
            outcome o = load(threads[k], pieces[i], params);
            assert_same(&o, &one);
            one.ahead = NOC_MAX(one.ahead, o.ahead);
        }
    return one;
}

static noc_import_params plain(void) {
    noc_import_params p = noc_import_default_params();
    p.textures = true;
    p.infer_lamps = false;
    return p;
}

static outcome load_by_all(void) { return load_by_all_with(plain()); }

/* ---- tests ---- */

static void test_same(void **state) {
    (void)state;
    begin();
    houses(0, 200);
    end();
    outcome o = load_by_all();
    assert_int_equal(o.status, NOC_OK);
    assert_int_equal(o.buildings, 200);
    assert_in_range(o.ahead, 4, 100);
    noc_import_params box = plain(); /* in which some are */
    box.bbox = "678000,5404000,678100,5404100";
    o = load_by_all_with(box);
    assert_in_range(o.ahead, 4, 100);
}

/* What looks like tags and is none, lines of other systems, and what stands between members. */
static void test_marks(void **state) {
    (void)state;
    begin();
    for (int i = 0; i < 200; i++) {
        house(i, i % 9 ? ""
                       : "<!-- </b:Building></cityObjectMember> --><?a </cityObjectMember>?><g:description>"
                         "<![CDATA[</b:Building></cityObjectMember>]]></g:description><b:x a='/>' b=\"'>\"/>");
        put(i % 2 ? "\r\n\r <!-- between -->\r" : "<g:metaDataProperty/>");
    }
    put("<broken></borken>");
    end();
    outcome o = load_by_all();
    assert_int_equal(o.status, NOC_ERR_FORMAT);
    assert_in_range(o.ahead, 4, 100);
    /* four lines before the houses, and nine a pair of them: expat counts \r\n as one */
    char where[60];
    snprintf(where, sizeof(where), "%s:%d: mismatched tag", path, 5 + 100 * (3 + 3 + 3));
    if (!strstr(o.said, where))
        fail_msg("\"%s\" is not said: %s", where, o.said);
}

static void test_errors(void **state) {
    (void)state;
    static const char *const faults[] = { "<b:lod2MultiSurface></b:wrong>",
                                          "&unknown;",
                                          "<a b=1/>",
                                          "</cityObjectMember>",
                                          "\x01",
                                          "<!ENTITY a 'b'>",
                                          "<a",
                                          "<!--",
                                          "</CityModel>",
                                          "<a b='<'/>" };
    for (size_t i = 0; i < NOC_COUNT(faults); i++)
        for (int at = 100; at < 200; at += 99) {
            begin();
            houses(0, at);
            house(at, faults[i]);
            houses(at + 1, 205);
            end();
            outcome o = load_by_all();
            assert_int_equal(o.status, NOC_ERR_FORMAT);
        }
    begin(); /* cut */
    houses(0, 200);
    write_file();
    assert_int_equal(load_by_all().status, NOC_ERR_FORMAT);
}

#define LAMP_BODY SURFACES(POLYGON("i", "678000 5404000 5 678001 5404000 5 678001 5404001 5"))

/* What a piece cannot know of the others. */
static void test_of_one_another(void **state) {
    (void)state;
    static const char *const more[] = {
        /* surfaces of a house that comes later, and of one before */
        "<b:lod2MultiSurface><g:MultiSurface>" LINK("w190-1") "</g:MultiSurface></b:lod2MultiSurface>",
        "<b:lod2MultiSurface><g:MultiSurface>" LINK("w3-1") "</g:MultiSurface></b:lod2MultiSurface>",
        "<b:lod2MultiSurface><g:MultiSurface>" LINK("nowhere") "</g:MultiSurface></b:lod2MultiSurface>",
        /* a CRS that is new, one that is not understood, and ones that lie elsewhere */
        "<b:lod2MultiSurface><g:MultiSurface srsName='EPSG:31468'>" MEMBERS(
            POLYGON("p",
                    "4457000 5405000 0 4457009 5405000 0 4457009 5405009 0 4457000 5405009 0")) "</g:MultiSurface>"
                                                                                                "</b:lod2MultiSurface>",
        "<b:lod2MultiSurface><g:MultiSurface srsName='EPSG:4258'>" MEMBERS(
            POLYGON("p", "48.76 11.42 0 48.76 11.421 0 48.761 11.421 0")) "</g:MultiSurface></b:lod2MultiSurface>",
        "<b:lod2MultiSurface><g:MultiSurface srsName='nonsense'>" MEMBERS(
            POLYGON("p", "1 1 0 2 2 0 1 2 0")) "</g:MultiSurface></b:lod2MultiSurface>",
        /* what is counted */
        "<b:lod2MultiSurface>" SURFACES(POLYGON("q", "1 2 3")) "</b:lod2MultiSurface>",
        "<b:lod2MultiSurface>" SURFACES(POLYGON("q", "a b c")) "</b:lod2MultiSurface>",
        "<b:lod2MultiSurface>" SURFACES(POLYGON("q", "1e300 5 0 1e300 7 0 1e299 9 0")) "</b:lod2MultiSurface>",
        "<b:interiorRoom><b:Room/></b:interiorRoom>",
        "<b:outerBuildingInstallation><b:BuildingInstallation g:id='i'><b:function>street lamp</b:function>"
        "<b:lod2Geometry>" LAMP_BODY "</b:lod2Geometry></b:BuildingInstallation></b:outerBuildingInstallation>",
    };
    for (size_t i = 0; i < NOC_COUNT(more); i++) {
        begin();
        for (int n = 0; n < 200; n++)
            house(n, n % 50 == 40 ? more[i] : "");
        end();
        outcome o = load_by_all();
        if (o.status == NOC_OK && !o.ahead)
            fail_msg("nothing is read ahead of %s: %s", more[i], o.said);
        begin();
        for (int n = 0; n < 120; n++)
            house(n, more[i]);
        end();
        load_by_all();
    }
}

static void test_other_members(void **state) {
    (void)state;
    begin();
    for (int i = 0; i < 100; i++) {
        house(i, "");
        put(MEMBER("<f:CityFurniture g:id='f%d'><f:function>%d</f:function><f:lod1Geometry>" SURFACES(POLYGON(
                "f%d",
                "678000 5404000 0 678000.1 5404000 0 678000.1 5404000.1 5")) "</f:lod1Geometry></f:CityFurniture>"),
            i, i % 4 ? 1030 : 1150, i);
        put(MEMBER("<b:Building g:id='e%d'><b:class>kind %d</b:class></b:Building>"), i, i % 80);
        put(MEMBER("<x:unknown/>"));
    }
    put("<g:boundedBy><g:Envelope srsName='EPSG:25833'/></g:boundedBy>");
    houses(100, 140);
    end();
    outcome o = load_by_all();
    assert_int_equal(o.status, NOC_OK);
    begin(); /* as many kinds as are told apart, and more */
    for (int i = 0; i < 90; i++) {
        house(i, "");
        put(MEMBER("<b:Building g:id='e%d'><b:class>kind %d</b:class></b:Building>"), i, i);
    }
    houses(90, 500);
    end();
    o = load_by_all();
    assert_in_range(o.ahead, 1, 100);
}

/* Texts that are not cut. */
static void test_whole(void **state) {
    (void)state;
    text.len = 0;
    put("<!DOCTYPE CityModel>\n<CityModel" NAMESPACES("2.0", GML31) ">" CRS);
    houses(0, 200);
    end();
    outcome o = load_by_all();
    assert_int_equal(o.status, NOC_OK);
    begin();
    put("<gr:CityObjectGroup><gr:groupMember>"); /* all members within one */
    houses(0, 200);
    put("</gr:groupMember></gr:CityObjectGroup>");
    end();
    load_by_all();
    begin();
    houses(0, 200);
    end();
    size_t n = text.len;
    assert_true(array_reserve(&text, 2 * n + 2));
    for (size_t i = n; i-- > 0;) { /* UTF-16 with its mark */
        text.data[2 * i + 2] = text.data[i];
        text.data[2 * i + 3] = 0;
    }
    text.len = 2 * n + 2;
    memcpy(text.data, "\xff\xfe", 2);
    memcpy(memmem(text.data, text.len, "U\0T\0F\0-\0008", 9), "u\0t\0f\0-\0001", 9);
    write_file();
    load_by_all();
}

/* Looks, whose images are not there, and one that is of use. */
static void test_looks(void **state) {
    (void)state;
    begin();
    put("<app:appearanceMember xmlns:app='http://www.opengis.net/citygml/appearance/2.0'><app:Appearance>");
    for (int i = 0; i < 200; i += 10)
        put("<app:surfaceDataMember><app:X3DMaterial><app:diffuseColor>0.%d 0.5 0.5</app:diffuseColor>"
            "<app:target>#w%d-1</app:target></app:X3DMaterial></app:surfaceDataMember>"
            "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>none%d.png</app:imageURI><app:target "
            "uri='#w%d-2'><app:TexCoordList><app:textureCoordinates ring='#r%d'>0 0 1 0 1 1 0.5 1 0 1 0 0"
            "</app:textureCoordinates></app:TexCoordList></app:target></app:ParameterizedTexture>"
            "</app:surfaceDataMember>",
            i % 7, i, i % 30, i, i);
    put("</app:Appearance></app:appearanceMember>");
    for (int i = 0; i < 200; i++) {
        char more[800];
        snprintf(more, sizeof(more),
                 "<b:lod2MultiSurface><g:MultiSurface><g:surfaceMember><g:Polygon><g:exterior><g:LinearRing "
                 "g:id='r%d'><g:posList>678000 5404%d 0 678009 5404%d 0 678009 5404%d 9 678005 5404%d 12 678000 "
                 "5404%d 9 678000 5404%d 0</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>"
                 "</g:MultiSurface></b:lod2MultiSurface>",
                 i, i + 100, i + 100, i + 100, i + 100, i + 100, i + 100);
        house(i, more);
    }
    end();
    assert_int_equal(load_by_all().status, NOC_OK);
}

static bool ask(void *user, const char *what, double done) {
    (void)what;
    (void)done;
    return (*(int *)user)-- != 0;
}

static void test_cancelled(void **state) {
    (void)state;
    begin();
    houses(0, 200);
    end();
    for (int n = 0, left = -1; left < 0; n += 3) {
        noc_import_params p = plain();
        left = n;
        p.progress = (noc_progress){ ask, &left };
        outcome o = load(3, 3000, p);
        assert_int_equal(o.status, left < 0 ? NOC_ERR_CANCELLED : NOC_OK);
    }
}

/* Memory that is refused to any thread is one error, or changes nothing. */
static void test_refused_memory(void **state) {
    (void)state;
    begin();
    houses(0, 120);
    end();
    outcome whole = load(3, 3000, plain());
    for (int later = 0; later < 2; later++) {
        size_t refused = 0;
        bool reached = true;
        refuse_later = later;
        for (refuse_at = 1; reached; refuse_at += 1 + refuse_at / 16) {
            outcome o = load(3, 3000, plain());
            if (o.status == NOC_OK)
                assert_same(&o, &whole);
            else
                assert_int_equal(o.status, NOC_ERR_MEMORY);
            refused += o.status != NOC_OK;
            reached = o.reached;
        }
        refuse_at = 0;
        assert_true(refused > 20);
    }
}

static int make_file(void **state) {
    (void)state;
    int fd = mkstemp(path);
    return fd < 0 ? -1 : close(fd);
}

static int remove_file(void **state) {
    (void)state;
    array_free(&text);
    return unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same),           cmocka_unit_test(test_marks),
        cmocka_unit_test(test_errors),         cmocka_unit_test(test_of_one_another),
        cmocka_unit_test(test_other_members),  cmocka_unit_test(test_whole),
        cmocka_unit_test(test_looks),          cmocka_unit_test(test_cancelled),
        cmocka_unit_test(test_refused_memory),
    };
    return cmocka_run_group_tests_name("import/members", tests, make_file, remove_file);
}
