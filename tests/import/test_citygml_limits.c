/* CityGML: how much of one file is read. */
#include "city_expect.h"
#include "city_pieces.h"
#include "import/citygml/citygml.h"

/* 33 million numbers of a polygon, 64 CRSs of a file, 4 MB in a tag. */
static void test_limits(void **state) {
    (void)state;
    const size_t most = cg_most_numbers;
    assert_int_equal(most, 1 << 25);
    for (int over = 0; over < 2; over++) {
        cg_most_numbers = 15 - (size_t)over; /* a square's five corners have 15 */
        expect(MODEL(MEMBER(BUILDING("B", LOD_SURFACES("2", SQUARE("s", "1", "3"))))), 3, over ? "" : "s");
        assert_int_equal(city_issue(&sink, "polygon with too many points"), over);
    }
    cg_most_numbers = most;
    char *text = noc_alloc((size_t)6 << 20);
    for (int count = 64; count < 66; count++) {
        size_t n = (size_t)sprintf(text, "%s",
                                   "<CityModel xmlns='http://www.opengis.net/citygml/2.0' "
                                   "xmlns:b='http://www.opengis.net/citygml/building/2.0' "
                                   "xmlns:g='http://www.opengis.net/gml'>");
        for (int i = 0; i < count; i++)
            n += (size_t)sprintf(text + n,
                                 "<cityObjectMember><b:Building><b:lod1MultiSurface><g:MultiSurface srsName='EPSG:%d'>"
                                 "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>0 0 0 1 0 0 1 1 0 0 "
                                 "0 0</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>"
                                 "</g:MultiSurface></b:lod1MultiSurface></b:Building></cityObjectMember>",
                                 25800 + i);
        sprintf(text + n, "</CityModel>");
        if (count == 64)
            assert_int_equal(read_text(text, 3), NOC_OK);
        else
            refuse(text, NOC_ERR_FORMAT, "more than 64 coordinate reference systems in one file");
    }
    for (int large = 0; large < 2; large++) {
        size_t n = (size_t)sprintf(text, "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:x='x' x:a='");
        size_t bytes = large ? (size_t)5 << 20 : (size_t)3 << 20;
        memset(text + n, 'a', bytes);
        sprintf(text + n + bytes, "'/>");
        if (large)
            refuse(text, NOC_ERR_FORMAT, "a tag or comment of more than 4 MB, which is not read");
        else
            assert_int_equal(read_text(text, 3), NOC_OK);
    }
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test_setup_teardown(test_limits, start, finish) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
