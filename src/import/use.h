/* use: what a building is for, by the codes and words that models and maps say it with. */
#ifndef NOC_IMPORT_USE_H
#define NOC_IMPORT_USE_H

#include "base/base.h"

#include <nocturne/scene.h>

/* key: "class", "function", "usage" of a city model, whose codes differ, or any key of a map. NOC_USE_UNKNOWN where the
 * value is in no list, or says no more than that it is a building. */
noc_building_use building_use_told(const char *key, const char *value);

#endif
