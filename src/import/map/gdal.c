#include "import/map/gdal.h"
#include "base/base.h"

#if NOC_HAVE_GDAL

#include <dlfcn.h>
#include <pthread.h>
#include <stddef.h>
#include <string.h>

gdal_functions gdal;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static char why_not[300];

static void load(void) {
    static const struct {
        const char *name;
        size_t at;
    } functions[] = {
#define GDAL_FUNCTION(name) { #name, offsetof(gdal_functions, name) },
        GDAL_FUNCTIONS(GDAL_FUNCTION)
#undef GDAL_FUNCTION
    };
    void *library = dlopen(NOC_GDAL_LIBRARY, RTLD_NOW | RTLD_LOCAL), *found = library;
    for (size_t i = 0; found && i < sizeof(functions) / sizeof(*functions); i++) {
        found = dlsym(library, functions[i].name);
        memcpy((char *)&gdal + functions[i].at, &found, sizeof(found));
    }
    const char *why = found ? NULL : dlerror();
    if (!found)
        noc_snprintf(why_not, sizeof(why_not), "%s", why ? why : NOC_GDAL_LIBRARY " lacks a function");
}

const char *gdal_load(void) {
    pthread_once(&once, load);
    return *why_not ? why_not : NULL;
}

#else

const char *gdal_load(void) { return "this build is without GDAL"; }

#endif
