#include "geo/geo.h"

#include <math.h>

/* wiki.openstreetmap.org, Key:highway */
static const geo_highway highways[] = {
    { "motorway", GEO_ROAD_MOTORWAY, true, false },
    { "motorway_link", GEO_ROAD_MOTORWAY, true, true },
    { "trunk", GEO_ROAD_TRUNK, true, false },
    { "trunk_link", GEO_ROAD_TRUNK, true, true },
    { "primary", GEO_ROAD_PRIMARY, true, false },
    { "primary_link", GEO_ROAD_PRIMARY, true, true },
    { "secondary", GEO_ROAD_SECONDARY, true, false },
    { "secondary_link", GEO_ROAD_SECONDARY, true, true },
    { "tertiary", GEO_ROAD_TERTIARY, true, false },
    { "tertiary_link", GEO_ROAD_TERTIARY, true, true },
    { "residential", GEO_ROAD_MINOR, true, false },
    { "unclassified", GEO_ROAD_MINOR, true, false },
    { "road", GEO_ROAD_MINOR, true, false },
    { "living_street", GEO_ROAD_LIVING, true, false },
    { "service", GEO_ROAD_SERVICE, true, false },
    { "busway", GEO_ROAD_SERVICE, false, false },
    { "bus_guideway", GEO_ROAD_SERVICE, false, false },
    { "pedestrian", GEO_ROAD_PEDESTRIAN, false, false },
    { "footway", GEO_ROAD_PATH, false, false },
    { "cycleway", GEO_ROAD_PATH, false, false },
    { "path", GEO_ROAD_PATH, false, false },
    { "steps", GEO_ROAD_PATH, false, false },
    { "bridleway", GEO_ROAD_PATH, false, false },
    { "track", GEO_ROAD_TRACK, false, false },
};

const geo_highway *geo_highway_get(int number) {
    return number > 0 && (size_t)number <= NOC_COUNT(highways) ? &highways[number - 1] : NULL;
}

int geo_highway_find(const char *word) {
    for (size_t i = 0; i < NOC_COUNT(highways); i++)
        if (!strcmp(highways[i].word, word))
            return (int)i + 1;
    return 0;
}

/* Ours. Lanes are as wide as RASt 06 (FGSV, 2006) makes them in towns, 2.75 to 3.25 m, and on motorways 3.5 to 3.75 m;
 * carriageways of two ways and unmarked ones of its residential streets are some 5.5 m wide. */
static const struct {
    double lane, both_ways, one_way; /* m; the last two of a road that does not tell its lanes */
} usual[GEO_ROAD_CLASSES] = {
    [GEO_ROAD_MOTORWAY] = { 3.75, 15, 7.5 }, [GEO_ROAD_TRUNK] = { 3.5, 7, 7 },
    [GEO_ROAD_PRIMARY] = { 3.25, 6.5, 6.5 }, [GEO_ROAD_SECONDARY] = { 3.25, 6.5, 6.5 },
    [GEO_ROAD_TERTIARY] = { 3, 6, 4.5 },     [GEO_ROAD_MINOR] = { 2.75, 5.5, 4 },
    [GEO_ROAD_LIVING] = { 2.75, 5, 4 },      [GEO_ROAD_SERVICE] = { 2.75, 3.5, 3.5 },
    [GEO_ROAD_PEDESTRIAN] = { 2.75, 4, 4 },  [GEO_ROAD_PATH] = { 2, 2, 2 },
    [GEO_ROAD_TRACK] = { 2.75, 2.75, 2.75 }, [GEO_ROAD_RAIL] = { 3, 3, 3 },
};

double geo_road_width(const geo_road *road) {
    if (isfinite(road->width))
        return road->width;
    if (road->lanes > 0)
        return road->lanes * usual[road->cls].lane;
    return road->link          ? usual[road->cls].lane + 1
           : road->oneway != 0 ? usual[road->cls].one_way
                               : usual[road->cls].both_ways;
}

double geo_road_deck(const geo_road *road, const double xy[2], double *off) {
    double z = NAN;
    *off = INFINITY;
    for (size_t i = 0; i + 1 < road->point_count; i++) {
        const double *a = road->xyz + 3 * i, *b = a + 3;
        double d[2] = { b[0] - a[0], b[1] - a[1] }, length2 = d[0] * d[0] + d[1] * d[1];
        double t = length2 > 0 ? ((xy[0] - a[0]) * d[0] + (xy[1] - a[1]) * d[1]) / length2 : 0;
        t = NOC_CLAMP(t, 0, 1);
        double from = hypot(a[0] + t * d[0] - xy[0], a[1] + t * d[1] - xy[1]);
        if (from >= *off)
            continue;
        *off = from;
        z = road->deck ? road->deck[i] + t * (road->deck[i + 1] - road->deck[i]) : NAN;
    }
    return z;
}

double geo_road_length(const geo_road *road) {
    double sum = 0;
    for (size_t i = 0; i + 1 < road->point_count; i++)
        sum += hypot(road->xyz[3 * i + 3] - road->xyz[3 * i], road->xyz[3 * i + 4] - road->xyz[3 * i + 1]);
    return sum;
}
