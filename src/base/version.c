#include <nocturne/nocturne.h>
#include "noc_config.h"

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)

const char *noc_version(void) { return NOC_VERSION; }

const char *noc_features(void) {
    return "embree " TEXT(NOC_EMBREE) ", "
#if NOC_HAVE_GDAL
           "gdal"
#else
           "no gdal (lamps from OSM, GeoJSON and CSV are not read)"
#endif
           ", "
#if NOC_HAVE_ASSIMP
           "assimp";
#else
           "no assimp (OBJ is not read)";
#endif
}
