#include "import/map/gdal.h"

#if NOC_HAVE_GDAL

#include "base/base.h"

#include <pthread.h>

gdal_functions gdal;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static char why_not[LIBRARY_WHY];

static void load(void) {
    static const char *const names[] = { GDAL_FUNCTIONS(LIBRARY_NAME) };
    library_load(NOC_GDAL_LIBRARY, names, NOC_COUNT(names), &gdal, why_not);
}

const char *gdal_load(void) {
    pthread_once(&once, load);
    return *why_not ? why_not : NULL;
}

#else

const char *gdal_load(void) { return "this build is without GDAL"; }

#endif
