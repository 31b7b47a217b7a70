/* Storeys that city models tell: their median height is asked whether heights are metres. */
#include "../told.h"

#include "base/base.h"
#include <nocturne/nocturne.h>

#include <stdio.h>
#include <unistd.h>

/* Ten buildings, each a wall of so many metres with so many storeys. */
static size_t write_citygml(char *at, size_t size, double height, const char *storeys) {
    size_t n = (size_t)snprintf(at, size,
                                "<CityModel xmlns='http://www.opengis.net/citygml/2.0' "
                                "xmlns:b='http://www.opengis.net/citygml/building/2.0' "
                                "xmlns:g='http://www.opengis.net/gml'>");
    for (int i = 0; i < 10; i++)
        n +=
            (size_t)snprintf(at + n, size - n,
                             "<cityObjectMember><b:Building><b:storeysAboveGround>%s</b:storeysAboveGround>"
                             "<b:lod1MultiSurface><g:MultiSurface><g:surfaceMember><g:Polygon><g:exterior>"
                             "<g:LinearRing><g:posList srsName='EPSG:25832'>%d 5330000 0 %d 5330000 0 %d 5330000 %g "
                             "%d 5330000 %g %d 5330000 0</g:posList></g:LinearRing></g:exterior></g:Polygon>"
                             "</g:surfaceMember></g:MultiSurface></b:lod1MultiSurface></b:Building></cityObjectMember>",
                             storeys, 690000 + 20 * i, 690009 + 20 * i, 690009 + 20 * i, height, 690000 + 20 * i,
                             height, 690000 + 20 * i);
    return n + (size_t)snprintf(at + n, size - n, "</CityModel>");
}

static size_t write_cityjson(char *at, size_t size, double height, const char *storeys) {
    size_t n = (size_t)snprintf(at, size,
                                "{\"type\":\"CityJSON\",\"version\":\"1.0\",\"metadata\":{\"referenceSystem\":"
                                "\"EPSG:25832\"},\"CityObjects\":{");
    for (int i = 0; i < 10; i++)
        n +=
            (size_t)snprintf(at + n, size - n,
                             "%s\"b%d\":{\"type\":\"Building\",\"attributes\":{\"storeysAboveGround\":%s},\"geometry\":"
                             "[{\"type\":\"MultiSurface\",\"lod\":1,\"boundaries\":[[[%d,%d,%d,%d]]]}]}",
                             i ? "," : "", i, storeys, 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3);
    n += (size_t)snprintf(at + n, size - n, "},\"vertices\":[");
    for (int i = 0; i < 40; i++)
        n += (size_t)snprintf(at + n, size - n, "%s[%d,5330000,%g]", i ? "," : "",
                              690000 + 20 * (i / 4) + 9 * (i % 4 == 1 || i % 4 == 2), i % 4 > 1 ? height : 0);
    return n + (size_t)snprintf(at + n, size - n, "]}");
}

static void test_storeys(void **state) {
    static const struct {
        double height;
        const char *storeys, *told; /* NULL: nothing */
    } rows[] = {
        { 12, "4", NULL },
        { 40, "4",
          "the median height of a building's storey, of 10, is 10 m, which is hardly one: are heights in feet?" },
        { 40, "9999", NULL }, /* stands for none */
        { 40, "1", NULL },    /* a hall */
    };
    (void)state;
    for (size_t i = 0; i < 2 * NOC_COUNT(rows); i++) {
        static char text[20000];
        char path[] = "/tmp/noc-storeys-XXXXXX";
        double height = rows[i / 2].height;
        size_t n = i % 2 ? write_citygml(text, sizeof(text), height, rows[i / 2].storeys)
                         : write_cityjson(text, sizeof(text), height, rows[i / 2].storeys);
        int fd = mkstemp(path);
        assert_true(fd >= 0 && write(fd, text, n) == (ssize_t)n && !close(fd));
        noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
        noc_scene *s = noc_scene_create(log);
        const char *inputs[] = { path };
        noc_import_params params = noc_import_default_params();
        params.infer_lamps = NOC_SWITCH_OFF;
        *told = 0;
        assert_int_equal(noc_scene_load(s, inputs, 1, &params, NULL), NOC_OK);
        if ((strstr(told, "storey") != NULL) != (rows[i / 2].told != NULL) ||
            (rows[i / 2].told && !strstr(told, rows[i / 2].told)))
            fail_msg("%g m, %s storeys: %s", height, rows[i / 2].storeys, told);
        noc_scene_destroy(s);
        noc_log_destroy(log);
        unlink(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_storeys),
    };
    return cmocka_run_group_tests_name("import/storeys", tests, NULL, NULL);
}
