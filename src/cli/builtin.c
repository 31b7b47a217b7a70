/* Inputs: built-in scenes, which are "builtin:" and a name, and what is said of lamps. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

#define BUILTIN "builtin:"

const char *cli_builtin(const char *input) {
    return strncmp(input, BUILTIN, strlen(BUILTIN)) ? NULL : input + strlen(BUILTIN);
}

static void add_texts(cli_args *args, const noc_texts *texts) {
    for (size_t i = 0; i < texts->count; i++) {
        bool there = false;
        for (size_t k = 0; k < args->input_count && !there; k++)
            there = !strcmp(args->inputs[k], texts->text[i]);
        if (!there)
            args->inputs[args->input_count++] = texts->text[i];
    }
}

void cli_add_named(cli_args *args, const noc_import_params *import) {
    size_t most = args->input_count + import->lamps.count + import->tracks.count;
    const char **inputs = cli_alloc(sizeof(char *) * (most + 1));
    memcpy(inputs, args->inputs, sizeof(char *) * args->input_count);
    free(args->inputs);
    args->inputs = inputs;
    add_texts(args, &import->lamps);
    add_texts(args, &import->tracks);
}

/* By noc_lamp_default; without an option: unit is what is taken. */
static const struct {
    const char *option, *what, *unit;
} lamp_defaults[NOC_LAMP_DEFAULT_COUNT] = {
    [NOC_LAMP_HEIGHT] = { "lamp-height", "height", "m" },
    [NOC_LAMP_FLUX] = { "lamp-lumens", "flux", "lm each, 500 at most below 1.5 m" },
    [NOC_LAMP_COLOUR] = { "lamp-kelvin", "colour", "K" },
    [NOC_LAMP_DIRECTION] = { NULL, "direction", "by chance" },
    [NOC_LAMP_EFFICACY] = { NULL, "source beside their watts", "80 lm/W (efficacy of rules)" },
};

void cli_note_chosen(const cli_args *args, noc_import_params *import) {
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++)
        if (lamp_defaults[i].option && cli_given(args, lamp_defaults[i].option))
            import->lamp_chosen |= 1u << i;
}

void cli_print_sky(const char *heading, double sky) {
    char a[64];
    if (sky > 0)
        printf("%s%s cd/m2 at the zenith, %.2f mag/arcsec2\n", heading, cli_number(a, sky), noc_sky_sqm(sky));
    else
        printf("%sdark\n", heading);
}

void cli_print_windows(const char *heading, const noc_window_counts *c) {
    char a[64], b[32];
    double area = 0;
    const char *before = "; walls without: ";
    for (int v = 0; v < NOC_WALL_VERDICT_COUNT; v++)
        area += c->area[v];
    if (!(area > 0) && !c->windows)
        return;
    printf("%s%s, %s lit", heading, noc_text_many(a, c->windows, "window"), noc_text_count(b, c->lit));
    if (area > 0) /* of a built-in scene nobody measures the walls */
        printf(", %.1f on 100 m2 of wall, %.1f lit", 100 * (double)c->windows / area, 100 * (double)c->lit / area);
    for (int v = NOC_WALL_SMALL; v < NOC_WALL_OWN; v++)
        if (c->walls[v]) {
            printf("%s%s %s", before, noc_text_count(a, c->walls[v]), noc_wall_verdict_name((noc_wall_verdict)v));
            before = ", ";
        }
    putchar('\n');
    size_t told = 0;
    for (int u = NOC_USE_UNKNOWN + 1; u < NOC_USE_COUNT; u++)
        told += c->buildings[u];
    before = "buildings by use: ";
    for (int u = 0; told && u < NOC_USE_COUNT; u++)
        if (c->buildings[u]) {
            if (*before == 'b')
                printf("%*s", (int)strlen(heading), "");
            printf("%s%s %s", before, noc_text_count(a, c->buildings[u]), noc_building_use_name((noc_building_use)u));
            before = ", ";
        }
    if (told)
        putchar('\n');
    if (c->own)
        printf("%*s%s of them are the model's own\n", (int)strlen(heading), "", noc_text_count(a, c->own));
}

char *cli_assumed(const size_t assumed[NOC_LAMP_DEFAULT_COUNT], const noc_import_params *import) {
    const double values[NOC_LAMP_DEFAULT_COUNT] = { import->lamp_height, import->lamp_lumens, import->lamp_kelvin };
    char a[32], value[96];
    char *text = cli_format("%s", "");
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++) {
        if (!assumed[i])
            continue;
        if (lamp_defaults[i].option)
            snprintf(value, sizeof(value), "%.10g %s (--%s)", values[i], lamp_defaults[i].unit,
                     lamp_defaults[i].option);
        else
            snprintf(value, sizeof(value), "%s", lamp_defaults[i].unit);
        char *before = text;
        text = cli_format("%s%s%s without %s: %s", before, *before ? ", " : "", noc_text_count(a, assumed[i]),
                          lamp_defaults[i].what, value);
        free(before);
    }
    return text;
}

void cli_print_assumed(const char *heading, const size_t assumed[NOC_LAMP_DEFAULT_COUNT],
                       const noc_import_params *import) {
    char *text = cli_assumed(assumed, import);
    if (*text)
        printf("%s%s\n", heading, text);
    free(text);
}
