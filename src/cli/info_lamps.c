/* nocturne info --each-lamp: a line a lamp of the scene, with whether it was mapped or inferred. */
#include "info.h"

#include <stdlib.h>

static const char *kind_of(const noc_light *light) {
    return light->kind == NOC_LIGHT_SPHERE  ? "sphere"
           : light->kind == NOC_LIGHT_DISC  ? "disc"
           : light->kind == NOC_LIGHT_POINT ? "point"
                                            : "spot";
}

static void csv_text(const char *text) {
    putchar('"');
    for (const char *p = text ? text : ""; *p; p++) {
        if (*p == '"')
            putchar('"');
        putchar((unsigned char)*p < ' ' ? ' ' : *p);
    }
    putchar('"');
}

static void print_csv(const noc_light_info *light, const char *group, const double xyz[3]) {
    csv_text(light->light.name);
    printf(",%s,%.3f,%.3f,%.3f,%.6g,%s,", light->light.inferred ? "inferred" : "mapped", xyz[0], xyz[1], xyz[2],
           light->lumens, kind_of(&light->light));
    csv_text(group);
    putchar('\n');
}

static void print_json(const noc_light_info *light, const char *group, const double xyz[3], bool first) {
    fputs(first ? "\n    {\"name\": " : ",\n    {\"name\": ", stdout);
    cli_json_text(stdout, light->light.name ? light->light.name : "");
    printf(", \"placed\": \"%s\", \"x\": %.3f, \"y\": %.3f, \"z\": %.3f, \"lumens\": ",
           light->light.inferred ? "inferred" : "mapped", xyz[0], xyz[1], xyz[2]);
    cli_json_number(stdout, light->lumens);
    printf(", \"shape\": \"%s\", \"group\": ", kind_of(&light->light));
    cli_json_text(stdout, group);
    putchar('}');
}

noc_status info_lamps(const info_city *city, bool json) {
    noc_status status = NOC_OK;
    bool first = true;
    size_t count = noc_scene_groups(city->scene, NULL, 0);
    noc_group_info *groups = cli_alloc(count * sizeof(*groups));
    noc_scene_groups(city->scene, groups, count);
    fputs(json ? "[" : "name,placed,x,y,z,lumens,shape,group\n", stdout);
    for (size_t i = 0; i < city->info.light_slots && !status; i++) {
        noc_light_info light;
        status = noc_scene_get_light(city->scene, i, &light);
        if (status || !light.lamp)
            continue;
        double xyz[3] = { light.centre[0], light.centre[1], light.centre[2] };
        status = noc_scene_from_local(city->scene, NULL, xyz);
        if (json && !status)
            print_json(&light, groups[light.light.group].name, xyz, first);
        else if (!status)
            print_csv(&light, groups[light.light.group].name, xyz);
        first = false;
    }
    free(groups);
    if (json)
        putchar(']');
    return status;
}
