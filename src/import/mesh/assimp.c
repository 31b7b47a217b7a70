#include "noc_config.h"

#if NOC_HAVE_ASSIMP

#include "base/base.h"
#include "import/mesh/assimp.h"

#include <pthread.h>

assimp_functions assimp;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static char why_not[LIBRARY_WHY];

static void load(void) {
    static const char *const names[] = { ASSIMP_FUNCTIONS(LIBRARY_NAME) };
    library_load(NOC_ASSIMP_LIBRARY, names, NOC_COUNT(names), &assimp, why_not);
}

const char *assimp_load(void) {
    pthread_once(&once, load);
    return *why_not ? why_not : NULL;
}

#endif
