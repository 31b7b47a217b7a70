/* nocturne info --each-lamp: a line a lamp of the scene, with whether it was mapped or inferred. */
#include "info.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *kind_of(const noc_light *light) {
    return light->kind == NOC_LIGHT_SPHERE  ? "sphere"
           : light->kind == NOC_LIGHT_DISC  ? "disc"
           : light->kind == NOC_LIGHT_POINT ? "point"
                                            : "spot";
}

/* A lamp's line: of CSV, or a JSON object. */
static const char *const columns[] = { "name",   "placed", "x",       "y",      "z",    "lumens", "shape",  "group",
                                       "kelvin", "watts",  "profile", "street", "road", "rule",   "height", "direction",
                                       "tilt",   "file",   "assumed", "lon",    "lat",  "crs",    "tags" };

enum { COLUMNS = sizeof(columns) / sizeof(*columns) };

typedef struct line {
    bool json;
    size_t column;
} line;

static void begin_value(line *l) {
    if (l->json)
        printf("%s\"%s\": ", l->column ? ", " : "{", columns[l->column]);
    else if (l->column)
        putchar(',');
    l->column++;
}

static void put_text(line *l, const char *text) {
    begin_value(l);
    if (l->json) {
        cli_json_text(stdout, text ? text : "");
        return;
    }
    putchar('"');
    if (text && *text && strchr("=+-@", *text)) /* spreadsheets run it else: an apostrophe makes it text to them */
        putchar('\'');
    for (const char *p = text ? text : ""; *p; p++) {
        if (*p == '"')
            putchar('"');
        putchar((unsigned char)*p < ' ' ? ' ' : *p);
    }
    putchar('"');
}

/* A tag a line becomes "key=value; key=value". */
static void put_tags(line *l, const char *tags) {
    char text[4096];
    size_t n = 0;
    for (const char *p = tags ? tags : ""; *p && n + 3 < sizeof(text); p++) {
        if (*p == '\n')
            text[n++] = ';';
        text[n++] = *p == '\n' ? ' ' : *p;
    }
    text[n] = 0;
    put_text(l, text);
}

static void put_word(line *l, const char *word) {
    begin_value(l);
    printf(l->json ? "\"%s\"" : "%s", word);
}

/* The same digits in both: decimals behind the point, or with -1 six in all. NaN: nothing, or null. */
static void put_number(line *l, double value, int decimals) {
    begin_value(l);
    if (!isfinite(value))
        fputs(l->json ? "null" : "", stdout);
    else if (decimals < 0)
        printf("%.6g", value);
    else
        printf("%.*f", decimals, cli_shown(value, decimals));
}

/* What the report does not tell, of built cities and scenes: what the scene does. */
static noc_report_lamp told_by_scene(const noc_scene *scene, const noc_light_info *light) {
    const double *d = light->light.direction, *at = light->centre;
    double ground;
    return (noc_report_lamp){ .height = noc_scene_ground(scene, at[0], at[1], &ground) ? at[2] - ground : NAN,
                              .direction = hypot(d[0], d[1]) > 1e-3 ? atan2(d[0], d[1]) * 180 / M_PI : NAN,
                              .watts = NAN };
}

static void put_lamp(line *l, const noc_light_info *light, const noc_report_lamp *told, const char *group,
                     const char *crs, const double at[6]) {
    static const char *const defaults[NOC_LAMP_DEFAULT_COUNT] = { [NOC_LAMP_HEIGHT] = "height",
                                                                  [NOC_LAMP_FLUX] = "lumens",
                                                                  [NOC_LAMP_COLOUR] = "kelvin",
                                                                  [NOC_LAMP_DIRECTION] = "direction",
                                                                  [NOC_LAMP_EFFICACY] = "efficacy" };
    const double *d = light->light.direction;
    char assumed[60] = "";
    for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++) {
        size_t n = strlen(assumed);
        if (told->assumed >> what & 1)
            snprintf(assumed + n, sizeof(assumed) - n, "%s%s", n ? "; " : "", defaults[what]);
    }
    double direction = fmod(told->direction + 360.05, 360) - .05; /* 359.97 is 0.0, too */
    put_text(l, light->light.name);
    put_word(l, light->light.inferred ? "inferred" : "mapped");
    for (int k = 0; k < 3; k++)
        put_number(l, at[k], 3);
    put_number(l, light->lumens, -1);
    put_word(l, kind_of(&light->light));
    put_text(l, group);
    put_number(l, noc_rgb_kelvin(light->light.emission), 0);
    put_number(l, told->watts, -1);
    put_text(l, told->profile);
    put_text(l, told->street);
    put_text(l, told->road);
    put_text(l, told->rules);
    put_number(l, told->height, 2);
    put_number(l, fabs(direction), 1);
    put_number(l, d[0] != 0 || d[1] != 0 || d[2] != 0 ? atan2(hypot(d[0], d[1]), -d[2]) * 180 / M_PI : NAN, 1);
    put_text(l, told->file);
    put_text(l, assumed);
    put_number(l, at[3], 7);
    put_number(l, at[4], 7);
    put_text(l, crs);
    put_tags(l, told->tags);
    fputs(l->json ? "}" : "\n", stdout);
}

/* The lamps' places: of each 3 numbers in the scene's CRS and 3 in WGS 84, which are NaN where there is none. */
static noc_status places(const info_city *city, const size_t *lights, size_t count, double *at) {
    double *xyz = cli_alloc((count + 1) * 3 * sizeof(*xyz));
    noc_status status = NOC_OK;
    for (int wgs84 = 0; wgs84 < 2 && !status; wgs84++) {
        for (size_t i = 0; i < count && !status; i++) {
            noc_light_info light;
            status = noc_scene_get_light(city->scene, lights[i], &light);
            memcpy(xyz + 3 * i, light.centre, sizeof(light.centre));
        }
        bool none = wgs84 && !*city->info.given_crs;
        if (!status && !none)
            status = noc_scene_from_local_all(city->scene, wgs84 ? "EPSG:4326" : NULL, xyz, count);
        for (size_t i = 0; i < 3 * count && !status; i++)
            at[i / 3 * 6 + i % 3 + (wgs84 ? 3 : 0)] = none ? NAN : xyz[i];
    }
    free(xyz);
    return status;
}

static noc_status print_lamps(const info_city *city, bool json, const size_t *lights, size_t count, const double *at) {
    size_t group_count = noc_scene_groups(city->scene, NULL, 0), next = 0;
    noc_group_info *groups = cli_alloc(group_count * sizeof(*groups));
    noc_status status = NOC_OK;
    noc_scene_groups(city->scene, groups, group_count);
    for (size_t i = 0; i < count && !status; i++) {
        const noc_report_lamp *told;
        noc_light_info light;
        status = noc_scene_get_light(city->scene, lights[i], &light);
        while ((told = noc_report_get_lamp(city->report, next)) && told->light < lights[i])
            next++;
        const noc_report_lamp other = told_by_scene(city->scene, &light);
        told = told && told->light == lights[i] ? told : &other;
        if (json)
            fputs(i ? ",\n    " : "\n    ", stdout);
        if (!status)
            put_lamp(&(line){ .json = json }, &light, told, groups[light.light.group].name, city->info.given_crs,
                     at + 6 * i);
    }
    free(groups);
    return status;
}

noc_status info_lamps(const info_city *city, bool json) {
    size_t slots = city->info.light_slots, count = 0;
    size_t *lights = cli_alloc((slots + 1) * sizeof(*lights));
    noc_status status = NOC_OK;
    for (size_t i = 0; i < slots && !status; i++) {
        noc_light_info light;
        status = noc_scene_get_light(city->scene, i, &light);
        if (!status && light.lamp)
            lights[count++] = i;
    }
    double *at = cli_alloc((count + 1) * 6 * sizeof(*at));
    status = status ? status : places(city, lights, count, at);
    for (size_t i = 0; i < COLUMNS && !json; i++)
        printf("%s%s", columns[i], i + 1 < COLUMNS ? "," : "\n");
    fputs(json ? "[" : "", stdout);
    status = status ? status : print_lamps(city, json, lights, count, at);
    free(at);
    free(lights);
    if (json)
        putchar(']');
    return status;
}
