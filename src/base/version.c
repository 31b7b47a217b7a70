#include <nocturne/nocturne.h>
#include "noc_config.h"

const char *noc_version(void) { return NOC_VERSION; }

const char *noc_features(void) {
    return "embree " NOC_EMBREE_VERSION ", "
#if NOC_HAVE_GDAL
           "gdal " NOC_GDAL_VERSION
#else
           "no gdal (lamps from OSM and GeoJSON are not read)"
#endif
           ", "
#if NOC_HAVE_ASSIMP
           "assimp " NOC_ASSIMP_VERSION;
#else
           "no assimp (OBJ is not read)";
#endif
}
