/* Looks: the option tables of renders and displays, and a few rows of the viewer's own. */
#include "viewer/look.h"

#include "viewer/option.h"
#include "viewer/words.h"

#include <stdlib.h>
#include <string.h>

enum { FRAMES = 256, TEXT = 30 * NOC_ISOLINES };

#define L look
static const noc_option own_options[] = {
    NOC_OPTION_PRESET(L, "Estimator"),
    { "frames", "Picture", NOC_OPTION_INT, offsetof(L, frames), 0, 1e6, NULL, "",
      "frames that are averaged, then the picture rests; 0 = without end" },
    { "smooth", "Display", NOC_OPTION_BOOL, offsetof(L, smooth), 0, 1, NULL, "",
      "moving pictures are calm: for the eye alone, not in figures or files" },
    { "show-scale", "Mode", NOC_OPTION_CHOICE, offsetof(L, channel.scale), 0, 0, "auto|linear|log", "",
      "steps of the colour bar; auto: as suits the numbers" }, /* by noc_bar_scale */
    { NULL },
};

/* What has no row in a table of the library: the mode, and what says two fields at once. */
typedef enum extra { EXTRA_SHOW, EXTRA_RANGE, EXTRA_ISOLINES, EXTRA_EXPOSURE, EXTRA_COUNT } extra;
static const struct {
    const char *name, *group, *kind, *unit, *help;
} extras[EXTRA_COUNT] = {
    [EXTRA_SHOW] = { "show", "Mode", "choice", "", "what is shown: the picture, or numbers of its pixels in colours" },
    [EXTRA_RANGE] = { "show-range", "Mode", "text", "LOW,HIGH",
                      "ends of the colour bar, or auto: found from the numbers" },
    [EXTRA_ISOLINES] = { "isolines", "Mode", "text", "LIST",
                         "lines at values, 5,7.5,10 (one: 5,), or N of them at round ones; 0 = none" },
    [EXTRA_EXPOSURE] = { "exposure", "Display", "text", "EV",
                         "auto, EV100 of -30 to 30 (one more is half as bright), or f/2.8,1/30,iso1600" },
};

typedef struct table {
    const noc_option *rows;
    size_t offset; /* of their struct in a look */
} table;

enum { TABLES = 3 };
static void list_tables(table out[TABLES]) {
    out[0] = (table){ own_options, 0 };
    out[1] = (table){ noc_display_options(), offsetof(look, display) };
    out[2] = (table){ noc_render_options(), offsetof(look, render) };
}

/* The page says the size, and exposure says both of its fields. */
static bool hidden(const noc_option *o) {
    static const char *const names[] = { "width", "height", "auto-exposure", "ev100" };
    return viewer_among(o->name, names, sizeof(names) / sizeof(*names));
}

static const noc_option *find(const char *name, table *of) {
    table tables[TABLES];
    list_tables(tables);
    for (int i = 0; i < TABLES; i++)
        for (const noc_option *o = tables[i].rows; o->name; o++)
            if (!strcmp(o->name, name) && !hidden(o)) {
                *of = tables[i];
                return o;
            }
    return NULL;
}

static int find_extra(const char *name) {
    for (int i = 0; i < EXTRA_COUNT; i++)
        if (!strcmp(extras[i].name, name))
            return i;
    return -1;
}

/* ---- beginning ---- */

static int differences(const noc_render_params *a, const noc_render_params *b) {
    int count = 0;
    for (const noc_option *o = noc_render_options(); o->name; o++)
        count += memcmp((const char *)a + o->offset, (const char *)b + o->offset, noc_option_size(o)) != 0;
    return count;
}

look look_default(const viewer_source *source) {
    look l = { .render = source->render,
               .display = source->display,
               .channel = source->channel,
               .show = source->show,
               .smooth = true,
               .frames = FRAMES };
    int fewest = -1;
    for (int preset = NOC_PRESET_STILL; preset <= NOC_PRESET_QUICK; preset++) {
        noc_render_params p = source->render;
        noc_render_use_preset(&p, (noc_preset)preset);
        int count = differences(&p, &source->render);
        if (fewest < 0 || count < fewest) {
            fewest = count;
            l.preset = preset;
        }
    }
    return l;
}

/* ---- values ---- */

static int get_extra(const look *l, extra which, char *text, size_t size) {
    static const noc_option number = { "", "", NOC_OPTION_REAL, 0, -1e30, 1e30, NULL, "", "" };
    char low[40], high[40];
    switch (which) {
    case EXTRA_SHOW: return snprintf(text, size, "%s", l->show ? noc_aov_name((noc_aov)(l->show - 1)) : "picture");
    case EXTRA_EXPOSURE:
        if (l->display.auto_exposure)
            return snprintf(text, size, "auto");
        return noc_option_get(&number, &l->display.ev100, text, size);
    case EXTRA_ISOLINES: return noc_isolines_text(&l->channel.isolines, text, size);
    default: break;
    }
    if (!(l->channel.low < l->channel.high))
        return snprintf(text, size, "auto");
    noc_option_get(&number, &l->channel.low, low, sizeof(low));
    noc_option_get(&number, &l->channel.high, high, sizeof(high));
    return snprintf(text, size, "%s,%s", low, high);
}

int look_get(const look *l, const char *name, char *text, size_t size) {
    table of;
    int which = find_extra(name);
    const noc_option *o = which < 0 ? find(name, &of) : NULL;
    if (which >= 0)
        return get_extra(l, (extra)which, text, size);
    return o ? noc_option_get(o, (const char *)l + of.offset, text, size) : -1;
}

static bool set_show(look *l, const char *value, char *why, size_t size) {
    if (!strcmp(value, "picture")) {
        l->show = 0;
        return true;
    }
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (!strcmp(value, noc_aov_name((noc_aov)aov))) {
            l->show = 1 + aov;
            l->channel.low = l->channel.high = 0; /* numbers of another kind */
            l->channel.scale = NOC_BAR_OF_CHANNEL;
            return true;
        }
    return viewer_wrong(why, size, "show: there is no mode \"%.60s\"", value);
}

static bool set_extra(look *l, extra which, const char *value, char *why, size_t size) {
    double ends[2] = { 0, 0 }, ev100;
    const char *wrong;
    bool automatic = !strcmp(value, "auto");
    switch (which) {
    case EXTRA_SHOW: return set_show(l, value, why, size);
    case EXTRA_EXPOSURE:
        l->display.auto_exposure = automatic;
        if (automatic)
            return true;
        wrong = noc_exposure_read(value, &ev100);
        if (wrong)
            return viewer_wrong(why, size, "exposure: \"%.60s\" %s nor auto", value, wrong);
        l->display.ev100 = ev100;
        return true;
    case EXTRA_ISOLINES:
        return noc_isolines_parse(value, &l->channel.isolines) ||
               viewer_wrong(why, size,
                            "isolines: \"%.60s\" is neither rising values, 1,2,5, nor a number of lines, 0 to %d",
                            value, NOC_ISOLINES);
    default: break;
    }
    if (!automatic && (!noc_text_numbers(value, ',', 2, ends) || !(ends[0] >= 0 && ends[0] < ends[1])))
        return viewer_wrong(why, size, "show-range: \"%.60s\" is neither auto nor LOW,HIGH, the lower one first",
                            value);
    l->channel.low = ends[0];
    l->channel.high = ends[1];
    return true;
}

noc_render_params look_params(const look *l, int width, int height) {
    noc_render_params p = l->render;
    p.width = width;
    p.height = height;
    p.aovs = l->show ? 1u << (l->show - 1) : 0;
    p.gloss = p.gloss && p.aovs != 1u << NOC_AOV_ILLUMINANCE;
    return p;
}

static bool set(look *l, const char *name, const char *value, char *why, size_t size) {
    table of;
    int which = find_extra(name);
    if (which >= 0)
        return set_extra(l, (extra)which, value, why, size);
    const noc_option *o = find(name, &of);
    if (!o)
        return viewer_wrong(why, size, "there is no option \"%.60s\" of a picture", name);
    if (!viewer_option_set(o, (char *)l + of.offset, value, why, size))
        return false;
    if (o == own_options) /* the preset, whose estimator is what is set */
        noc_render_use_preset(&l->render, (noc_preset)l->preset);
    return true;
}

bool look_has_bar(const look *l) {
    noc_aov_info info = noc_aov_get_info((noc_aov)(l->show - 1));
    return l->show && info.scale != NOC_CHANNEL_LABELS && info.components == 1;
}

/* The end that a logarithmic bar cannot have. */
static bool begins_at_nothing(const look *l) {
    noc_aov_info info = noc_aov_get_info((noc_aov)(l->show - 1));
    bool logarithmic =
        l->channel.scale == NOC_BAR_OF_CHANNEL ? info.scale == NOC_CHANNEL_LOG : l->channel.scale == NOC_BAR_LOG;
    return look_has_bar(l) && logarithmic && l->channel.low < l->channel.high && !(l->channel.low > 0);
}

bool look_set(look *l, const char *name, const char *value, char *why, size_t size) {
    look next = *l;
    if (!set(&next, name, value, why, size))
        return false;
    if (begins_at_nothing(&next))
        return viewer_wrong(why, size, "show-range: a logarithmic bar begins above 0");
    viewer_ear ear = { why, size };
    noc_render_params p = look_params(&next, 64, 64);
    noc_log *log = viewer_listen(&ear);
    noc_status status = noc_render_check(&p, log);
    noc_log_destroy(log);
    if (!status)
        *l = next;
    return !status;
}

/* ---- as JSON ---- */

static json_t *choices_of_show(void) {
    json_t *list = json_pack("[s]", "picture");
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        json_array_append_new(list, json_string(noc_aov_name((noc_aov)aov)));
    return list;
}

static void add_extra(json_t *list, const look *begin, extra which) {
    char value[TEXT];
    get_extra(begin, which, value, sizeof(value));
    json_t *row = json_pack("{ss ss ss ss ss ss}", "name", extras[which].name, "group", extras[which].group, "kind",
                            extras[which].kind, "unit", extras[which].unit, "help", extras[which].help, "value", value);
    if (which == EXTRA_SHOW)
        json_object_set_new(row, "choices", choices_of_show());
    json_array_append_new(list, row);
}

json_t *look_schema(const look *begin) {
    table tables[TABLES];
    json_t *list = json_array();
    list_tables(tables);
    for (int which = 0; which < EXTRA_COUNT; which++)
        add_extra(list, begin, (extra)which);
    for (int i = 0; i < TABLES; i++)
        for (const noc_option *o = tables[i].rows; o->name; o++)
            if (!hidden(o))
                json_array_append_new(list, viewer_option_json(o, (const char *)begin + tables[i].offset));
    return list;
}

json_t *look_modes(void) {
    json_t *list = json_pack("[{ss ss ss sb}]", "name", "picture", "text", "the picture, as a camera takes it", "unit",
                             "", "range", 0);
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        noc_aov_info info = noc_aov_get_info((noc_aov)aov);
        bool range = info.scale != NOC_CHANNEL_LABELS && info.components == 1;
        char text[200];
        json_array_append_new(list, json_pack("{ss ss ss sb}", "name", info.name, "text",
                                              viewer_utf8(text, sizeof(text), info.title), "unit", info.unit, "range",
                                              range));
    }
    return list;
}

json_t *look_values(const look *l) {
    table tables[TABLES];
    char text[TEXT];
    json_t *values = json_object();
    list_tables(tables);
    for (int which = 0; which < EXTRA_COUNT; which++) {
        get_extra(l, (extra)which, text, sizeof(text));
        json_object_set_new(values, extras[which].name, json_string(text));
    }
    for (int i = 0; i < TABLES; i++)
        for (const noc_option *o = tables[i].rows; o->name; o++)
            if (!hidden(o)) {
                noc_option_get(o, (const char *)l + tables[i].offset, text, sizeof(text));
                json_object_set_new(values, o->name, json_string(text));
            }
    return values;
}

static bool of_map(const noc_option *o) { return !strncmp(o->name, "environment-", 12); }

json_t *look_idle(const look *l, bool has_map) {
    static const char *const of_bars[] = { "show-range", "show-scale", "isolines", NULL };
    json_t *idle = json_object();
    char why[200];
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        if (of_map(o) && !has_map)
            json_object_set_new(idle, o->name, json_string("there is no map around the city (--environment FILE)"));
        else if (!hidden(o) && noc_option_idle(o, noc_render_options(), &l->render, why, sizeof(why)))
            json_object_set_new(idle, o->name, json_string(why));
    }
    for (const noc_option *o = noc_display_options(); o->name; o++) {
        if (l->show && !hidden(o))
            json_object_set_new(idle, o->name, json_string("numbers in colours have no exposure and no tone map"));
        else if (!hidden(o) && noc_option_idle(o, noc_display_options(), &l->display, why, sizeof(why)))
            json_object_set_new(idle, o->name, json_string(why));
    }
    if (l->show)
        json_object_set_new(idle, "smooth", json_string("numbers in colours are not smoothed"));
    if (l->show)
        json_object_set_new(idle, "exposure", json_string("numbers in colours have no exposure and no tone map"));
    for (const char *const *name = of_bars; *name && !look_has_bar(l); name++)
        json_object_set_new(idle, *name, json_string("what is shown has no colour bar"));
    if (!l->render.accumulate)
        json_object_set_new(idle, "frames", json_string("it needs accumulate true, not false"));
    return idle;
}

/* ---- as words ---- */

/* What `nocturne render` begins with: its defaults, the preset, and the recipe, whose options win over that. */
static void begin_render(const noc_recipe *recipe, int preset, noc_render_params *render, noc_display_params *display) {
    const noc_option *said;
    *render = noc_render_default_params();
    *display = noc_display_default_params();
    noc_render_use_preset(render, (noc_preset)preset);
    for (size_t i = 0; (said = noc_recipe_option(recipe, i)); i++) {
        for (const noc_option *o = noc_render_options(); o->name; o++)
            if (o == said)
                noc_recipe_set(recipe, o, render, NULL);
        for (const noc_option *o = noc_display_options(); o->name; o++)
            if (o == said)
                noc_recipe_set(recipe, o, display, NULL);
    }
}

static void add_mode(words *list, const look *l) {
    char text[TEXT];
    if (!l->show)
        return;
    words_add(list, "--show");
    words_add(list, noc_aov_name((noc_aov)(l->show - 1)));
    get_extra(l, EXTRA_RANGE, text, sizeof(text));
    if (!look_has_bar(l))
        return;
    if (strcmp(text, "auto")) {
        words_add(list, "--show-range");
        words_add(list, text);
    }
    if (l->channel.scale != NOC_BAR_OF_CHANNEL) {
        words_add(list, "--show-scale");
        words_add(list, l->channel.scale == NOC_BAR_LOG ? "log" : "linear");
    }
    get_extra(l, EXTRA_ISOLINES, text, sizeof(text));
    if (strcmp(text, "0")) {
        words_add(list, "--isolines");
        words_add(list, text);
    }
}

char **look_words(const look *l, const noc_recipe *recipe, bool has_map, size_t *count) {
    words list = { 0 };
    char text[100];
    noc_render_params render;
    noc_display_params display;
    const noc_recipe_info *info = noc_recipe_get_info(recipe);
    int preset = info->has_preset ? (int)info->preset : NOC_PRESET_STILL;
    add_mode(&list, l);
    if (l->preset != preset) {
        words_option(&list, own_options, l, NULL);
        preset = l->preset;
    }
    begin_render(recipe, preset, &render, &display);
    for (const noc_option *o = noc_render_options(); o->name; o++)
        if (!hidden(o) && (has_map || !of_map(o)))
            words_option(&list, o, &l->render, &render);
    for (const noc_option *o = noc_display_options(); o->name && !l->show; o++)
        if (!hidden(o))
            words_option(&list, o, &l->display, &display);
    bool same = l->display.auto_exposure == display.auto_exposure &&
                (l->display.auto_exposure || l->display.ev100 == display.ev100);
    if (!l->show && !same) {
        get_extra(l, EXTRA_EXPOSURE, text, sizeof(text));
        words_add(&list, "--exposure");
        words_add(&list, text);
    }
    return words_take(&list, count);
}
