/* nocturne info --each-lamp: a line a lamp of the scene, with whether it was mapped or inferred. */
#include "info.h"

static const char *kind_of(const noc_light *light) {
    return light->kind == NOC_LIGHT_SPHERE  ? "sphere"
           : light->kind == NOC_LIGHT_DISC  ? "disc"
           : light->kind == NOC_LIGHT_POINT ? "point"
                                            : "spot";
}

static bool is_lamp(const noc_light_info *light) {
    bool flat = light->light.kind == NOC_LIGHT_TRIANGLE || light->light.kind == NOC_LIGHT_PARALLELOGRAM;
    return !light->removed && !flat && !light->light.moving;
}

static void print_csv(const noc_light_info *light, const double xyz[3]) {
    putchar('"');
    for (const char *p = light->light.name ? light->light.name : ""; *p; p++) {
        if (*p == '"')
            putchar('"');
        putchar((unsigned char)*p < ' ' ? ' ' : *p);
    }
    printf("\",%s,%.3f,%.3f,%.3f,%.6g,%s\n", light->light.inferred ? "inferred" : "mapped", xyz[0], xyz[1], xyz[2],
           light->lumens, kind_of(&light->light));
}

static void print_json(const noc_light_info *light, const double xyz[3], bool first) {
    fputs(first ? "\n    {\"name\": " : ",\n    {\"name\": ", stdout);
    cli_json_text(stdout, light->light.name ? light->light.name : "");
    printf(", \"placed\": \"%s\", \"x\": %.3f, \"y\": %.3f, \"z\": %.3f, \"lumens\": ",
           light->light.inferred ? "inferred" : "mapped", xyz[0], xyz[1], xyz[2]);
    cli_json_number(stdout, light->lumens);
    printf(", \"shape\": \"%s\"}", kind_of(&light->light));
}

noc_status info_lamps(const info_city *city, bool json) {
    noc_status status = NOC_OK;
    bool first = true;
    fputs(json ? "[" : "name,placed,x,y,z,lumens,shape\n", stdout);
    for (size_t i = 0; i < city->info.light_slots && !status; i++) {
        noc_light_info light;
        status = noc_scene_get_light(city->scene, i, &light);
        if (status || !is_lamp(&light))
            continue;
        double xyz[3] = { light.centre[0], light.centre[1], light.centre[2] };
        status = noc_scene_from_local(city->scene, NULL, xyz);
        if (json && !status)
            print_json(&light, xyz, first);
        else if (!status)
            print_csv(&light, xyz);
        first = false;
    }
    if (json)
        putchar(']');
    return status;
}
