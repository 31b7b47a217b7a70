#include "geo/crs_proj.h"
#include "base/base.h"
#include "noc_config.h"

#include <pthread.h>

proj_functions proj;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static char why_not[LIBRARY_WHY + 32];

static void load(void) {
    static const char *const names[] = { PROJ_FUNCTIONS(LIBRARY_NAME) };
    char why[LIBRARY_WHY];
    library_load(NOC_PROJ_LIBRARY, names, NOC_COUNT(names), &proj, why);
    if (*why)
        noc_snprintf(why_not, sizeof(why_not), "PROJ cannot be loaded: %s", why);
}

const char *proj_load(void) {
    pthread_once(&once, load);
    return *why_not ? why_not : NULL;
}
