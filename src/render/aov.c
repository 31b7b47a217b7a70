/* Views of the light sampling: which there are, what they need, and how they are to be shown. */
#include "render/backend.h"

#include <stdio.h>

static const char *const names[NOC_AOV_COUNT] = {
    [NOC_AOV_LIGHTS] = "lights",
    [NOC_AOV_DENSITY] = "density",
    [NOC_AOV_LIGHT] = "light",
    [NOC_AOV_WEIGHT] = "weight",
    [NOC_AOV_CONFIDENCE] = "confidence",
    [NOC_AOV_RAYS] = "rays",
    [NOC_AOV_VARIANCE] = "variance",
    [NOC_AOV_ERROR] = "error",
    [NOC_AOV_DEPTH] = "depth",
    [NOC_AOV_NORMAL] = "normal",
    [NOC_AOV_CLASS] = "class",
    [NOC_AOV_OBJECT] = "object",
    [NOC_AOV_GROUP] = "group",
    [NOC_AOV_PLACED] = "placed",
    [NOC_AOV_MOTION] = "motion",
    [NOC_AOV_LUMINANCE] = "luminance",
    [NOC_AOV_ILLUMINANCE] = "illuminance",
    [NOC_AOV_INFLUENTIAL] = "influential",
    [NOC_AOV_INFLUENTIAL_SHARE] = "influential-share",
    [NOC_AOV_RUNNER_UP] = "runner-up",
    [NOC_AOV_RUNNER_UP_SHARE] = "runner-up-share",
    [NOC_AOV_EXPECTED] = "expected",
};

const char *noc_aov_name(noc_aov aov) { return (unsigned)aov < NOC_AOV_COUNT ? names[aov] : "unknown"; }

int noc_aov_components(noc_aov aov) { return aov == NOC_AOV_NORMAL || aov == NOC_AOV_MOTION ? 3 : 1; }

static bool asks(const noc_render_params *p, noc_aov aov) { return p->aovs >> aov & 1; }

static bool has_query(const noc_render_params *p) {
    return (p->method == NOC_METHOD_RIS || p->method == NOC_METHOD_RESTIR) &&
           (p->candidates == NOC_CANDIDATES_INFLUENCE || p->candidates == NOC_CANDIDATES_LISTS);
}

noc_status noc_check_aovs(const noc_render_params *p, noc_log *log) {
    static const noc_aov of_reservoirs[] = { NOC_AOV_DENSITY, NOC_AOV_LIGHT, NOC_AOV_WEIGHT, NOC_AOV_CONFIDENCE };
    static const noc_aov of_light[] = { NOC_AOV_GROUP, NOC_AOV_PLACED, NOC_AOV_LUMINANCE, NOC_AOV_ILLUMINANCE };
    if (p->aovs >> NOC_AOV_COUNT)
        return noc_error(log, NOC_ERR_ARGUMENT, "render: aovs is 0x%x, must be bits 1 << noc_aov", p->aovs);
    if (asks(p, NOC_AOV_LIGHTS) && !has_query(p))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "render: view \"lights\": only ris and restir with candidates influence or lists ask for "
                         "the lights around a point");
    if (asks(p, NOC_AOV_EXPECTED) && !(has_query(p) && p->candidates == NOC_CANDIDATES_LISTS))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "render: view \"expected\": only ris and restir with candidates lists expect light of a list");
    for (size_t i = 0; i < NOC_COUNT(of_reservoirs); i++)
        if (asks(p, of_reservoirs[i]) && (p->method == NOC_METHOD_REFERENCE || p->method == NOC_METHOD_HEADLIGHT))
            return noc_error(log, NOC_ERR_ARGUMENT, "render: view \"%s\": the %s method chooses no light",
                             names[of_reservoirs[i]], p->method == NOC_METHOD_REFERENCE ? "reference" : "headlight");
    for (size_t i = 0; i < NOC_COUNT(of_light); i++)
        if (asks(p, of_light[i]) && p->method == NOC_METHOD_HEADLIGHT)
            return noc_error(log, NOC_ERR_ARGUMENT,
                             "render: view \"%s\": the headlight method has no light of the scene", names[of_light[i]]);
    for (noc_aov aov = NOC_AOV_VARIANCE; aov <= NOC_AOV_ERROR; aov++)
        if (asks(p, aov) && !p->accumulate)
            return noc_error(log, NOC_ERR_ARGUMENT, "render: view \"%s\": frames must be accumulated", names[aov]);
    return NOC_OK;
}

/* What one expects on a map of land use: grey roads, green plants, blue water, brown earth, red roofs. */
static const uint8_t class_colours[NOC_LABEL_COUNT][3] = {
    [NOC_CLASS_OTHER] = { 232, 184, 240 },    [NOC_CLASS_WALL] = { 232, 201, 160 },
    [NOC_CLASS_ROOF] = { 192, 57, 43 },       [NOC_CLASS_GROUND] = { 142, 90, 168 },
    [NOC_CLASS_CLOSURE] = { 61, 43, 122 },    [NOC_CLASS_WINDOW] = { 127, 227, 245 },
    [NOC_CLASS_DOOR] = { 230, 110, 0 },       [NOC_CLASS_INSTALLATION] = { 255, 143, 163 },
    [NOC_CLASS_TERRAIN] = { 139, 107, 74 },   [NOC_CLASS_ROAD] = { 150, 150, 150 },
    [NOC_CLASS_SIDEWALK] = { 205, 205, 205 }, [NOC_CLASS_GREEN] = { 111, 191, 74 },
    [NOC_CLASS_TREE] = { 31, 122, 51 },       [NOC_CLASS_WATER] = { 47, 111, 208 },
    [NOC_CLASS_BRIDGE] = { 63, 167, 155 },    [NOC_CLASS_FURNITURE] = { 200, 150, 0 },
    [NOC_CLASS_LAMP] = { 255, 241, 77 },      [NOC_CLASS_VEHICLE] = { 255, 30, 150 },
#define WALL(verdict) [NOC_CLASS_COUNT + NOC_WALL_##verdict - 1]
    WALL(TAKEN) = { 245, 214, 110 },          WALL(SMALL) = { 178, 150, 122 },
    WALL(TILTED) = { 214, 120, 84 },          WALL(PARTY) = { 122, 84, 74 },
    WALL(BARE) = { 120, 120, 140 },           WALL(OWN) = { 200, 226, 150 },
#undef WALL
};

static const char *const placed_names[NOC_PLACED_COUNT] = { "other lights", "mapped lamps", "inferred lamps" };
static const uint8_t placed_colours[NOC_PLACED_COUNT][3] = { { 120, 120, 140 }, { 127, 227, 245 }, { 230, 110, 0 } };

static const struct {
    const char *title, *unit;
    noc_channel_scale scale;
} kinds[NOC_AOV_COUNT] = {
    [NOC_AOV_LIGHTS] = { "influence volumes that hold the point", "lights", NOC_CHANNEL_LINEAR },
    [NOC_AOV_DENSITY] = { "expected candidates of the chosen light", "candidates", NOC_CHANNEL_LOG },
    [NOC_AOV_LIGHT] = { "chosen light: each its own colour", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_WEIGHT] = { "W of the reservoir (black: 0)", "", NOC_CHANNEL_LOG },
    [NOC_AOV_CONFIDENCE] = { "M of the reservoir [candidates]", "candidates", NOC_CHANNEL_LINEAR },
    [NOC_AOV_RAYS] = { "shadow rays a pixel", "rays", NOC_CHANNEL_LINEAR },
    [NOC_AOV_VARIANCE] = { "variance of a frame [(cd/m\xb2)\xb2]", "(cd/m2)^2", NOC_CHANNEL_LOG },
    [NOC_AOV_ERROR] = { "standard error of the mean, relative", "", NOC_CHANNEL_LOG },
    [NOC_AOV_DEPTH] = { "distance from the eye [m]", "m", NOC_CHANNEL_LOG },
    [NOC_AOV_NORMAL] = { "normal: red east, green north, blue up", "", NOC_CHANNEL_LINEAR },
    [NOC_AOV_CLASS] = { "semantic class", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_OBJECT] = { "object: each its own colour", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_GROUP] = { "group of lights that brings the most light", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_PLACED] = { "what brings the most light", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_MOTION] = { "where it was: red right, green down", "pixels", NOC_CHANNEL_LINEAR },
    [NOC_AOV_LUMINANCE] = { "luminance [cd/m\xb2]", "cd/m2", NOC_CHANNEL_LOG },
    [NOC_AOV_ILLUMINANCE] = { "illuminance [lx]", "lx", NOC_CHANNEL_LOG },
    [NOC_AOV_INFLUENTIAL] = { "light that brings the most: each its own colour", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_INFLUENTIAL_SHARE] = { "share of the light that brings the most", "", NOC_CHANNEL_LINEAR },
    [NOC_AOV_RUNNER_UP] = { "light that brings the second most: each its own colour", "", NOC_CHANNEL_LABELS },
    [NOC_AOV_RUNNER_UP_SHARE] = { "share of the light that brings the second most", "", NOC_CHANNEL_LINEAR },
    [NOC_AOV_EXPECTED] = { "luminance expected of the list [cd/m\xb2]", "cd/m2", NOC_CHANNEL_LOG },
};

noc_aov_info noc_aov_get_info(noc_aov aov) {
    if ((unsigned)aov >= NOC_AOV_COUNT)
        return (noc_aov_info){ .name = "", .unit = "", .title = "" };
    return (noc_aov_info){ names[aov], kinds[aov].unit, kinds[aov].title, kinds[aov].scale, noc_aov_components(aov) };
}

void noc_describe_aov(const noc_render_params *p, noc_aov aov, noc_channel *channel) {
    static const struct {
        const char *const *names;
        size_t count;
        const uint8_t (*colours)[3];
    } labels[NOC_AOV_COUNT] = {
        [NOC_AOV_CLASS] = { noc_label_names, NOC_LABEL_COUNT, class_colours },
        [NOC_AOV_PLACED] = { placed_names, NOC_PLACED_COUNT, placed_colours },
    };
    noc_aov_info info = noc_aov_get_info(aov);
    channel->name = info.name;
    channel->unit = info.unit;
    channel->scale = info.scale;
    channel->title = info.title;
    channel->labels = labels[aov].names;
    channel->label_count = labels[aov].count;
    channel->label_colours = labels[aov].colours;
    if (aov == NOC_AOV_LIGHTS && p->candidates == NOC_CANDIDATES_LISTS)
        channel->title = "entries of the tile list";
}
