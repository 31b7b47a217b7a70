/* Heights that are none. */
#include "geo/geo.h"

#define LOWEST -1000.0 /* m; the shore of the Dead Sea lies at -430 m, 1,410 ft */
#define HIGHEST 30e3   /* m; Mount Everest has 29,032 ft */

bool geo_height_stands_for_none(double z) {
    static const double numbers[] = { -9999, -32768, -32767, -99999, -999, 9999, 99999 };
    for (size_t i = 0; i < NOC_COUNT(numbers); i++)
        if (z == numbers[i])
            return true;
    return false;
}

bool geo_height_is_none(double z) { return geo_height_stands_for_none(z) || !(z >= LOWEST && z <= HIGHEST); }
