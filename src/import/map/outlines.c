#include "import/map/outlines.h"
#include "import/use.h"

#include <math.h>

#define MOST_METRES 1000
#define MOST_LEVELS 250

int outline_verdict(const lamp_tag *tags, size_t count) {
    int verdict = -1;
    for (size_t i = 0; i < count; i++) {
        if (!strcmp(tags[i].key, "building:part") && verdict < 0)
            return 0; /* lies in the outline of a building */
        if (!strcmp(tags[i].key, "building"))
            verdict = strcmp(tags[i].value, "no") && *tags[i].value ? 1 : 0;
    }
    for (size_t i = 0; i < count && verdict > 0; i++) /* it has no walls above the ground */
        if (!strcmp(tags[i].key, "location") && !strcmp(tags[i].value, "underground"))
            verdict = 0;
    return verdict;
}

bool outline_layer(const char *name) {
    static const char *const words[] = { "building", "footprint", "gebaeude", "gebaude", "batiment", "edific",
                                         "pand",     "bygning",   "byggnad",  "rakennu", "budova",   "budynki" };
    char folded[200];
    lamp_fold(name, false, folded, sizeof(folded));
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (strstr(folded, words[i]))
            return true;
    return false;
}

/* Returns true if no unit stands behind it. */
static bool is_number(const char *text) {
    double value;
    return noc_parse_double(text, &value);
}

enum { WHOLE, FROM, LEVELS, FROM_LEVEL, ROOF, KEYS };

static void read_one(const lamp_tag *tag, int what, double *out) {
    double value;
    int times;
    bool levels = what == LEVELS || what == FROM_LEVEL;
    bool told =
        levels ? noc_parse_double(tag->value, &value) : lamp_quantity(tag->value, LAMP_METRES, 1, '.', &value, &times);
    if (told && isnan(*out) && value >= 0 && value <= (levels ? MOST_LEVELS : MOST_METRES))
        *out = value;
}

/* What the first of the keys that tell it says. */
static noc_building_use use_of(const lamp_tag *tags, size_t count) {
    static const char *const keys[] = { "building", "buildinguse", "use",          "usage",
                                        "function", "nutzung",     "gebruiksdoel", "amenity" };
    noc_building_use use = NOC_USE_UNKNOWN;
    for (size_t k = 0; k < NOC_COUNT(keys) && use == NOC_USE_UNKNOWN; k++)
        for (size_t i = 0; i < count && use == NOC_USE_UNKNOWN; i++) {
            char folded[64];
            lamp_fold(tags[i].key, false, folded, sizeof(folded));
            if (!strcmp(folded, keys[k]))
                use = building_use_told(keys[k], tags[i].value);
        }
    return use;
}

void outline_read(const lamp_tag *tags, size_t count, geo_footprint *footprint) {
    static const char *const keys[KEYS][8] = {
        [WHOLE] = { "height", "buildingheight", "measuredheight", "estheight", "hoehe", "hauteur", "altura",
                    "bldgheight" },
        [FROM] = { "minheight", "buildingminheight" },
        [LEVELS] = { "buildinglevels", "levels", "storeys", "stories", "numfloors", "floors", "nbetages", "geschosse" },
        [FROM_LEVEL] = { "buildingminlevel", "minlevel" },
        [ROOF] = { "roofheight", "buildingroofheight" },
    };
    double value[KEYS] = { NAN, NAN, NAN, NAN, NAN };
    bool bare = false;
    for (size_t i = 0; i < count; i++) {
        char folded[64];
        lamp_fold(tags[i].key, false, folded, sizeof(folded));
        for (int what = 0; what < KEYS; what++)
            for (size_t k = 0; k < NOC_COUNT(keys[what]) && keys[what][k]; k++)
                if (!strcmp(folded, keys[what][k])) {
                    bare = what == WHOLE && isnan(value[WHOLE]) ? is_number(tags[i].value) : bare;
                    read_one(&tags[i], what, &value[what]);
                }
    }
    footprint->height = value[WHOLE];
    footprint->bare = bare;
    footprint->min_height = value[FROM];
    footprint->levels = value[LEVELS];
    footprint->min_level = value[FROM_LEVEL];
    footprint->roof_height = value[ROOF];
    footprint->use = use_of(tags, count);
}
