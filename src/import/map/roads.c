/* What OpenStreetMap's tags say of a road: wiki.openstreetmap.org, Key:highway, Key:oneway, Key:lanes, Key:maxspeed,
 * Key:lit, Key:access. */
#include "import/map/roads.h"

#include <math.h>
#include <stdlib.h>

#define MOST_SPEED 500 /* km/h */

static bool is(const char *value, const char *const *among) {
    for (; value && *among; among++)
        if (!strcmp(value, *among))
            return true;
    return false;
}

static const char *value_of(const lamp_tag *tags, size_t count, const char *key) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(tags[i].key, key) && tags[i].value && *tags[i].value)
            return tags[i].value;
    return NULL;
}

/* Is a key there with a value other than no? F is that of Geofabrik's Shapefiles. */
static bool has(const lamp_tag *tags, size_t count, const char *key) {
    const char *value = value_of(tags, count, key);
    return value && strcmp(value, "no") != 0 && strcmp(value, "F") != 0;
}

/* Shapefiles may have keys in capitals alone, and Geofabrik's call the tag fclass. */
static const char *highway_of(const lamp_tag *tags, size_t count) {
    static const char *const keys[] = { "highway", "fclass" };
    for (size_t k = 0; k < NOC_COUNT(keys); k++)
        for (size_t i = 0; i < count; i++)
            if (noc_ieq(tags[i].key, keys[k]) && tags[i].value && *tags[i].value)
                return tags[i].value;
    return NULL;
}

/* ---- what it is ---- */

static bool class_of(const char *value, geo_road *road) {
    road->highway = geo_highway_find(value);
    const geo_highway *highway = geo_highway_get(road->highway);
    if (!highway)
        return false;
    road->cls = highway->cls;
    road->motor = highway->motor;
    road->link = highway->link;
    return true;
}

/* The more special key decides. */
static bool shut_to_motors(const lamp_tag *tags, size_t count) {
    static const char *const keys[] = { "motorcar", "motor_vehicle", "vehicle", "access" };
    static const char *const shut[] = { "no", "private", "agricultural", "forestry", "delivery", "emergency", NULL };
    for (size_t i = 0; i < NOC_COUNT(keys); i++) {
        const char *value = value_of(tags, count, keys[i]);
        if (value)
            return is(value, shut);
    }
    return false;
}

/* ---- numbers ---- */

static int whole(const char *text, int least, int most) {
    char *end;
    long n = text ? strtol(text, &end, 10) : 0;
    return text && end != text && (!*end || *end == ';' || *end == '.') && n >= least && n <= most ? (int)n : 0;
}

/* km/h of "50", "30 mph", "walk", "DE:urban", "DE:zone30"; NaN where it tells none. */
static double speed_of(const char *text) {
    static const struct {
        const char *word;
        double speed;
    } words[] = { { "walk", 7 }, { "living_street", 7 }, { "urban", 50 } };
    if (!text)
        return NAN;
    const char *colon = strchr(text, ':'), *number = colon ? colon + 1 : text;
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(number, words[i].word))
            return words[i].speed;
    if (colon) /* DE:zone30, DE:zone:30 */
        number += strcspn(number, "0123456789");
    char *end;
    double n = *number >= '0' && *number <= '9' ? (double)strtol(number, &end, 10) : NAN;
    if (!(n > 0))
        return NAN;
    end += strspn(end, " ");
    n *= !strncmp(end, "mph", 3) ? 1.609344 : !strncmp(end, "knots", 5) ? 1.852 : 1;
    return n <= MOST_SPEED ? n : NAN;
}

static double width_of(const lamp_tag *tags, size_t count) {
    static const char *const keys[] = { "width:carriageway", "width", "est_width" };
    for (size_t i = 0; i < NOC_COUNT(keys); i++) {
        const char *text = value_of(tags, count, keys[i]);
        double metres;
        int times;
        if (text && lamp_quantity(text, LAMP_METRES, 1, '.', &metres, &times) && metres > 0 &&
            metres <= LAMP_MOST_METRES)
            return metres;
    }
    return NAN;
}

static int oneway_of(const lamp_tag *tags, size_t count, const geo_road *road) {
    /* F and T are Geofabrik's: from the line's first point, to it */
    static const char *const along[] = { "yes", "1", "true", "F", NULL }, *const against[] = { "-1", "reverse", "T",
                                                                                               NULL };
    const char *value = value_of(tags, count, "oneway");
    if (is(value, along))
        return 1;
    if (is(value, against))
        return -1;
    /* implied, where it is not said otherwise */
    return !value && (road->roundabout || (road->cls == GEO_ROAD_MOTORWAY && !road->link));
}

bool road_read(const lamp_tag *tags, size_t count, geo_road *road) {
    static const char *const rails[] = { "rail", "light_rail", "tram", "subway", "narrow_gauge", NULL };
    static const char *const rings[] = { "roundabout", "circular", NULL }, *const dark[] = { "no", "disused", NULL };
    const char *highway = highway_of(tags, count), *name = value_of(tags, count, "name");
    const char *lit = value_of(tags, count, "lit");
    *road = (geo_road){ .id = "", .name = name ? name : "", .width = NAN, .speed = NAN };
    if (has(tags, count, "area"))
        return false;
    if (!highway || !class_of(highway, road)) {
        if (!is(value_of(tags, count, "railway"), rails))
            return false;
        road->cls = GEO_ROAD_RAIL;
    }
    road->bridge = has(tags, count, "bridge");
    road->tunnel = has(tags, count, "tunnel") || has(tags, count, "covered");
    road->layer = whole(value_of(tags, count, "layer"), -GEO_ROAD_MOST_LAYER, GEO_ROAD_MOST_LAYER);
    if (road->cls == GEO_ROAD_RAIL)
        return true;
    road->roundabout = is(value_of(tags, count, "junction"), rings);
    road->motor = road->motor && !shut_to_motors(tags, count);
    road->lanes = whole(value_of(tags, count, "lanes"), 1, GEO_ROAD_MOST_LANES);
    road->lanes_forward = whole(value_of(tags, count, "lanes:forward"), 1, GEO_ROAD_MOST_LANES);
    road->lanes_backward = whole(value_of(tags, count, "lanes:backward"), 1, GEO_ROAD_MOST_LANES);
    road->oneway = oneway_of(tags, count, road);
    road->lit = !lit ? GEO_LIT_UNKNOWN : is(lit, dark) ? GEO_LIT_NO : GEO_LIT_YES;
    road->width = width_of(tags, count);
    road->speed = speed_of(value_of(tags, count, "maxspeed"));
    return true;
}

static bool is_water(const lamp_tag *tags, size_t count) {
    static const char *const ways[] = { "riverbank", "dock", "river", "canal", NULL };
    static const char *const uses[] = { "basin", "reservoir", NULL };
    const char *natural = value_of(tags, count, "natural");
    return (natural && !strcmp(natural, "water")) || is(value_of(tags, count, "waterway"), ways) ||
           is(value_of(tags, count, "landuse"), uses);
}

static bool is_green(const lamp_tag *tags, size_t count) {
    static const char *const uses[] = { "grass",   "meadow",   "village_green", "recreation_ground", "forest",
                                        "orchard", "cemetery", "allotments",    "flowerbed",         NULL };
    static const char *const natural[] = { "grassland", "wood", "scrub", "heath", NULL };
    static const char *const leisure[] = { "park", "garden", "golf_course", "common", NULL };
    return is(value_of(tags, count, "landuse"), uses) || is(value_of(tags, count, "natural"), natural) ||
           is(value_of(tags, count, "leisure"), leisure);
}

noc_class area_class(const lamp_tag *tags, size_t count) {
    static const char *const on_foot[] = { "pedestrian", "footway", "path", "cycleway", "steps", NULL };
    static const char *const under[] = { "underground", "multi-storey", NULL };
    const char *surface = value_of(tags, count, "area:highway"), *highway = value_of(tags, count, "highway");
    const char *amenity = value_of(tags, count, "amenity"), *place = value_of(tags, count, "place");
    if (has(tags, count, "tunnel") || has(tags, count, "covered") || has(tags, count, "intermittent"))
        return NOC_CLASS_OTHER;
    if (is_water(tags, count))
        return NOC_CLASS_WATER;
    if (surface)
        return is(surface, on_foot) ? NOC_CLASS_SIDEWALK : NOC_CLASS_ROAD;
    if (is(highway, on_foot) || (place && !strcmp(place, "square")))
        return NOC_CLASS_SIDEWALK;
    if (amenity && !strcmp(amenity, "parking") && !is(value_of(tags, count, "parking"), under))
        return NOC_CLASS_ROAD;
    return is_green(tags, count) ? NOC_CLASS_GREEN : NOC_CLASS_OTHER;
}
