/* Codes and words for what buildings are for. docs/windows.md names the lists. */
#include "import/use.h"

#include <stdlib.h>
#include <string.h>

#define FLATS NOC_USE_FLATS
#define MIXED NOC_USE_MIXED
#define OFFICES NOC_USE_OFFICES
#define SHOPS NOC_USE_SHOPS
#define DARK NOC_USE_DARK
#define BARE NOC_USE_BARE

typedef struct code_range {
    int from, to; /* both of them */
    noc_building_use use;
} code_range;

/* ALKIS, AX_Gebaeude.gebaeudefunktion, "31001_" before it (AdV, GeoInfoDok 6.0). What comes first wins. */
static const code_range alkis[] = {
    { 1313, 1313, BARE },  { 1110, 1131, MIXED }, { 1000, 1399, FLATS },   { 2020, 2040, OFFICES },
    { 2060, 2060, DARK },  { 2070, 2075, FLATS }, { 2010, 2056, SHOPS },   { 2080, 2083, SHOPS },
    { 2090, 2094, DARK },  { 2140, 2143, BARE },  { 2160, 2160, OFFICES }, { 2100, 2199, DARK },
    { 2210, 2220, BARE },  { 2310, 2320, MIXED }, { 2400, 2459, DARK },    { 2460, 2465, BARE },
    { 2500, 2699, BARE },  { 2700, 2799, BARE },  { 3031, 3048, DARK },    { 3080, 3082, DARK },
    { 3060, 3066, FLATS }, { 3100, 3100, MIXED }, { 3000, 3079, OFFICES }, { 3090, 3099, OFFICES },
    { 3200, 3289, DARK },
};

/* CityGML 2.0, annex C.1: function and usage of _AbstractBuilding (SIG3D). */
static const code_range sig3d[] = {
    { 1050, 1050, MIXED },   { 1080, 1080, MIXED },   { 1030, 1040, FLATS }, { 1070, 1070, BARE },
    { 1000, 1110, FLATS },   { 1120, 1140, OFFICES }, { 1150, 1200, SHOPS }, { 1210, 1230, FLATS },
    { 1240, 1250, SHOPS },   { 1260, 1300, DARK },    { 1340, 1340, SHOPS }, { 1360, 1370, BARE },
    { 1380, 1380, OFFICES }, { 1420, 1450, BARE },    { 1310, 1600, DARK },  { 1610, 1650, BARE },
    { 1660, 1860, BARE },    { 1910, 1920, FLATS },   { 1870, 1950, BARE },  { 2130, 2160, DARK },
    { 2200, 2290, DARK },    { 2340, 2370, FLATS },   { 2390, 2390, FLATS }, { 2430, 2430, BARE },
    { 2450, 2470, DARK },    { 1960, 2530, OFFICES }, { 2540, 2699, DARK },
};

/* The same annex: class of _AbstractBuilding. */
static const code_range sig3d_class[] = {
    { 1000, 1000, FLATS }, { 1010, 1010, BARE },    { 1020, 1020, OFFICES }, { 1030, 1040, SHOPS },
    { 1050, 1080, DARK },  { 1090, 1090, BARE },    { 1100, 1100, OFFICES }, { 1110, 1110, BARE },
    { 1120, 1120, FLATS }, { 1130, 1140, OFFICES }, { 1150, 1150, BARE },    { 1160, 1170, DARK },
};

/* PLATEAU: Building_usage, and of Building_class those without walls. */
static const code_range plateau[] = {
    { 401, 401, OFFICES }, { 402, 402, SHOPS },   { 403, 403, FLATS }, { 404, 404, SHOPS }, { 411, 412, FLATS },
    { 413, 415, MIXED },   { 421, 422, OFFICES }, { 431, 431, DARK },  { 441, 441, DARK },  { 451, 452, BARE },
};

static noc_building_use in_ranges(const code_range *ranges, size_t count, long code) {
    for (size_t i = 0; i < count; i++)
        if (code >= ranges[i].from && code <= ranges[i].to)
            return ranges[i].use;
    return NOC_USE_UNKNOWN;
}

/* Whole values, in small letters: OpenStreetMap (wiki, Key:building), INSPIRE CurrentUseValue, the Dutch register of
 * buildings (BAG, gebruiksdoel). */
static const struct {
    const char *words; /* a blank before and behind each */
    noc_building_use use;
} words[] = {
    { " apartments house detached residential semidetached_house terrace bungalow dormitory hotel hostel farm cabin "
      "allotment_house houseboat static_caravan annexe tower_block individualresidence collectiveresidence "
      "twodwellings morethantwodwellings residenceforcommunities woonfunctie logiesfunctie nursing_home ",
      FLATS },
    { " mixed_use mixed mixed_residential ", MIXED },
    { " office offices commercial government civic public university hospital college school kindergarten fire_station "
      "police townhall commerceandservices publicservices kantoorfunctie onderwijsfunctie gezondheidszorgfunctie "
      "train_station ",
      OFFICES },
    { " retail supermarket kiosk shop mall department_store restaurant pub trade winkelfunctie ", SHOPS },
    { " church chapel cathedral mosque temple synagogue monastery shrine religious place_of_worship museum theatre "
      "sports_hall sports_centre stadium grandstand riding_hall industrial factory manufacture hangar transportation "
      "castle bijeenkomstfunctie sportfunctie industriefunctie ",
      DARK },
    { " garage garages carport shed hut barn stable sty cowshed greenhouse glasshouse roof warehouse storage "
      "storage_tank silo water_tower parking bunker ruins construction service transformer_tower toilets "
      "farm_auxiliary boathouse digester tent pavilion agriculture agricultural ancillary ",
      BARE },
};

/* Parts of German words, as models that are made by hand have them; what comes first wins. */
static const struct {
    const char *part;
    noc_building_use use;
} stems[] = {
    { "garage", BARE },        { "gartenhaus", BARE },   { "scheune", BARE },      { "schuppen", BARE },
    { " stall", BARE },        { "carport", BARE },      { "gewaechshaus", BARE }, { "kirche", DARK },
    { "kapelle", DARK },       { "werkstatt", DARK },    { "fabrik", DARK },       { "kaufhaus", SHOPS },
    { "einzelhandel", SHOPS }, { "gaststaette", SHOPS }, { "buero", OFFICES },     { "b\xc3\xbcro", OFFICES },
    { "verwaltung", OFFICES }, { "schule", OFFICES },    { "wohn", FLATS },        { "reihenhaus", FLATS },
};

noc_building_use building_use_told(const char *key, const char *value) {
    char small[100];
    const char *from = strrchr(value, '/'); /* codes may be addresses: .../CurrentUseValue/office */
    from = from ? from + 1 : value;
    size_t n = 0;
    small[n++] = ' ';
    for (; *from && n < sizeof(small) - 2; from++)
        small[n++] = *from >= 'A' && *from <= 'Z' ? (char)(*from + 32) : *from;
    small[n] = 0;
    const char *scheme = strchr(small + 1, '_');
    char *end;
    long code = strtol(scheme ? scheme + 1 : small + 1, &end, 10);
    if (n > 1 && !*end && end > small + 1) {
        bool cls = !strcmp(key, "class");
        if (scheme)
            return !strncmp(small + 1, "31001_", 6) ? in_ranges(alkis, NOC_COUNT(alkis), code)
                   : small[1] == '5'                ? BARE /* structures that are no buildings */
                                                    : NOC_USE_UNKNOWN;
        if (cls)
            return code == 3003 || code == 3004 ? BARE : in_ranges(sig3d_class, NOC_COUNT(sig3d_class), code);
        if (code < 1000)
            return in_ranges(plateau, NOC_COUNT(plateau), code);
        return code % 10 ? NOC_USE_UNKNOWN : in_ranges(sig3d, NOC_COUNT(sig3d), code);
    }
    for (size_t i = 0; i < NOC_COUNT(stems); i++)
        if (strstr(small, stems[i].part))
            return stems[i].use;
    small[n++] = ' ';
    small[n] = 0;
    for (size_t i = 0; i < NOC_COUNT(words) && n > 2 && !strchr(small + 1, ','); i++)
        if (strstr(words[i].words, small))
            return words[i].use;
    return NOC_USE_UNKNOWN;
}
