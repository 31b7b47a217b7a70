/* Rules for lamps, and groups of lights, as people read them. */
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* "city.yaml:12" of a longer path. */
static const char *short_place(const char *place) {
    const char *slash = strrchr(place, '/');
    return slash ? slash + 1 : place;
}

static void append(char **text, const char *more) {
    char *joined = cli_format("%s%s%s", *text ? *text : "", *text ? ", " : "", more);
    free(*text);
    *text = joined;
}

char *cli_rules(const noc_report *report) {
    const noc_report_rule *rule;
    char *text = NULL, a[32];
    for (size_t i = 0; (rule = noc_report_get_rule(report, i)); i++) {
        char *one = cli_format("%s %s", short_place(rule->place), noc_text_count(a, rule->lamps));
        append(&text, one);
        free(one);
    }
    return text ? text : cli_format("none");
}

/* "out", "x 0.5", "recoloured": what differs from how its lights are made. */
static char *state_of(const noc_group_info *g) {
    bool coloured = g->colour[0] > 0 || g->colour[1] > 0 || g->colour[2] > 0;
    bool grey = g->scale[0] == g->scale[1] && g->scale[1] == g->scale[2];
    if (g->scale[0] <= 0 && grey)
        return cli_format("out");
    char *scale = !grey              ? cli_format(", x %g %g %g", g->scale[0], g->scale[1], g->scale[2])
                  : g->scale[0] != 1 ? cli_format(", x %g", g->scale[0])
                                     : cli_format("%s", "");
    char flux[32];
    char *text = cli_format("%s klm%s%s", cli_number(flux, g->lumens / 1e3), scale, coloured ? ", recoloured" : "");
    free(scale);
    return text;
}

static void add_group(char **text, const noc_group_info *g, const char *name) {
    char *state = state_of(g), a[32];
    char *one = cli_format("%s %s (%s)", name, noc_text_count(a, g->lights), state);
    append(text, one);
    free(state);
    free(one);
}

char *cli_groups(const noc_report *report) {
    const noc_group_info *g, *none = noc_report_get_group(report, 0);
    char *text = NULL;
    for (size_t i = 1; (g = noc_report_get_group(report, i)); i++)
        if (g->lights)
            add_group(&text, g, *g->name ? g->name : "unnamed");
    if (text && none->lights)
        add_group(&text, none, "others");
    return text ? text : cli_format("none");
}

void cli_print_lights(const char *rules, const char *groups, const noc_report *report) {
    char *matched = cli_rules(report), *lit = cli_groups(report);
    if (noc_report_get_rule(report, 0))
        printf("%s%s\n", rules, matched);
    if (strcmp(lit, "none"))
        printf("%s%s\n", groups, lit);
    free(matched);
    free(lit);
}
