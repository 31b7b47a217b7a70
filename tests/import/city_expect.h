/* What tests of CityGML text read and expect. */
#ifndef NOC_CITY_EXPECT_H
#define NOC_CITY_EXPECT_H

#include "city_sink.h"

static city_sink sink;

static inline int start(void **state) {
    (void)state;
    city_clear(&sink);
    sink.lat_first = false;
    sink.stop_at = 0;
    return 0;
}

static inline int finish(void **state) {
    (void)state;
    city_clear(&sink);
    return 0;
}

static inline noc_status read_text(const char *text, int lod) {
    return city_read_bytes(&sink, text, strlen(text), lod);
}

/* Reads and expects the polygons of exactly these ids, in order, separated by blanks. */
static inline void expect(const char *text, int lod, const char *ids) {
    assert_int_equal(read_text(text, lod), NOC_OK);
    NOC_ARRAY(char) seen = { 0 };
    for (size_t i = 0; i < sink.polygons.len; i++) {
        if (i)
            assert_true(array_push(&seen, ' '));
        assert_true(array_append(&seen, sink.polygons.data[i].id, strlen(sink.polygons.data[i].id)));
    }
    assert_true(array_push(&seen, 0));
    assert_string_equal(seen.data, ids);
    array_free(&seen);
}

static inline void refuse(const char *text, noc_status status, const char *cause) {
    assert_int_equal(read_text(text, 3), status);
    const char *error = noc_log_last_error(sink.sink.log);
    if (!strstr(error, cause))
        fail_msg("\"%s\" does not say \"%s\"", error, cause);
}

#endif
