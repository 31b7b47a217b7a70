/* What rules say of lamps, and which group a light is of. Rules and groups ask what files tell, never what an earlier
 * rule has made of it. */
#include "city/city.h"
#include "import/lamps/conditions.h"
#include "import/load/load.h"

#include <math.h>
#include <nocturne/option.h>
#include <nocturne/text.h>

#define MOST_PLACES 2000 /* bytes of the places of rules that a report tells of a lamp */

struct luminaires {
    lamp_conditions *conditions; /* NULL: there are no rules and no groups */
    int *profile;                /* of each rule: geo_fitting.profile */
    int *group;                  /* of the scene, of each of params */
    noc_report_rule *matched;    /* in the report's arena */
    size_t fileless;             /* lamps that are to have the flux of a file, and have none */
};

/* Those that lights are of which no group takes, by their class; a group that is called so and asks nothing says how
 * that one begins. */
static const struct { const char *cls, *group; } own_groups[] = { { "lamp", "lamps" }, { "window", "windows" } };

static bool is_own_group(const noc_group_rule *g) {
    bool own = !strcmp(g->name, "cars"); /* of built-in scenes */
    for (size_t i = 0; i < NOC_COUNT(own_groups); i++)
        own = own || !strcmp(g->name, own_groups[i].group);
    return own && !g->condition_count;
}

/* ---- what is given ---- */

/* Fields that say nothing are not looked at. */
static noc_status check_fields(const noc_option *table, const void *params, size_t size, const char *place,
                               noc_log *log) {
    union {
        noc_luminaire_rule rule;
        noc_group_rule group;
    } said;
    memcpy(&said, params, size);
    for (const noc_option *o = table; o->name; o++) {
        double *real = (double *)((char *)&said + o->offset);
        int *whole = (int *)((char *)&said + o->offset);
        if (o->kind == NOC_OPTION_REAL && isnan(*real))
            *real = o->min;
        if (o->kind == NOC_OPTION_INT && !*whole)
            *whole = (int)o->min;
    }
    return noc_option_check(table, &said, place, log);
}

static noc_status check_colour(const char *colour, const char *place, noc_log *log) {
    float rgb[3];
    char shown[60];
    if (!colour || (lamp_hex_colour(colour, rgb) && rgb[0] + rgb[1] + rgb[2] > 0))
        return NOC_OK;
    return noc_error(log, NOC_ERR_ARGUMENT, "%s: colour \"%s\" is no #rrggbb, or it is black", place,
                     noc_text_clean(shown, sizeof(shown), colour));
}

static noc_status check_rules(const noc_import_params *p, noc_log *log) {
    char text[40];
    noc_map names = { 0 };
    noc_status status = NOC_OK;
    for (size_t i = 0; i < p->luminaire_count && !status; i++) {
        const noc_luminaire_rule *r = &p->luminaires[i];
        const char *place = lamp_rule_place(r->place, "rule", i, text);
        status = check_fields(noc_luminaire_options(), r, sizeof(*r), place, log);
        status = status ? status : check_colour(r->colour, place, log);
    }
    for (size_t i = 0; i < p->group_count && !status; i++) {
        const noc_group_rule *g = &p->groups[i];
        const char *place = lamp_rule_place(g->place, "group", i, text);
        status = check_fields(noc_group_options(), g, sizeof(*g), place, log);
        status = status ? status : check_colour(g->colour, place, log);
        if (!status && (!g->name || !*g->name))
            status = noc_error(log, NOC_ERR_ARGUMENT, "%s: it has no name", place);
        bool fresh = true;
        if (!status && !map_put(&names, g->name, i, &fresh))
            status = noc_no_memory(log, place);
        if (!fresh)
            status = noc_error(log, NOC_ERR_ARGUMENT, "%s: there are two groups %.60s", place, g->name);
    }
    map_free(&names);
    return status;
}

/* The number of the profile that a rule names; *profile is 0 where it names none. */
static noc_status find_profile(importer *im, const noc_luminaire_rule *r, const char *place, int *profile) {
    const char *name = r->profile ? r->profile : "", *slash = strrchr(name, '/'), *why = NULL;
    *profile = !strcmp(name, "none") ? GEO_NO_PROFILE : city_profiles_builtin(name);
    if (*profile || !*name)
        return NOC_OK;
    char *path = noc_format("%s%s", r->profile_base && *name != '/' ? r->profile_base : "", name);
    if (!path)
        return noc_no_memory(im->log, place);
    noc_scene_add_source(im->scene, path, place);
    if (!im->profiles) {
        free(path);
        return NOC_OK;
    }
    if (r->profile_base)
        why = import_named_trouble(r->profile_base, path, im->params->allow_outside);
    noc_status status = NOC_OK;
    if (why)
        status = noc_error(im->log, NOC_ERR_IO, "%s: profile %.300s: %s%s", place, name, why,
                           slash || strchr(name, '.') ? "" : ", and no built-in one is called so");
    else
        status = city_profiles_read(im->profiles, path, slash ? slash + 1 : name, profile);
    free(path);
    return status;
}

static noc_status add_groups(importer *im) {
    const noc_import_params *p = im->params;
    for (size_t i = 0; i < p->group_count; i++) {
        im->luminaires->group[i] = noc_scene_group_named(im->scene, p->groups[i].name);
        if (!im->luminaires->group[i])
            return im->scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED; /* said */
    }
    return NOC_OK;
}

noc_status luminaires_start(importer *im) {
    const noc_import_params *p = im->params;
    noc_status status = check_rules(p, im->log);
    if (!status && p->profiles)
        im->profiles = city_profiles_create(im->scene, p->lamp_profile, &status);
    luminaires *l = status ? NULL : noc_calloc(1, sizeof(*l));
    if (!status && !l)
        status = noc_no_memory(im->log, "rules");
    if (status)
        return status;
    im->luminaires = l;
    l->conditions = lamp_conditions_create(p, im->log, &status);
    if (status)
        return status;
    l->profile = noc_calloc(p->luminaire_count + 1, sizeof(*l->profile));
    l->group = noc_calloc(p->group_count + 1, sizeof(*l->group));
    l->matched = arena_alloc(&im->report->arena, (p->luminaire_count + 1) * sizeof(*l->matched));
    if (!l->profile || !l->group || !l->matched)
        return noc_no_memory(im->log, "rules");
    char text[40];
    for (size_t i = 0; i < p->luminaire_count && !status; i++) {
        const char *place = lamp_rule_place(p->luminaires[i].place, "rule", i, text);
        l->matched[i].place = arena_strdup(&im->report->arena, place);
        status = l->matched[i].place ? find_profile(im, &p->luminaires[i], place, &l->profile[i])
                                     : noc_no_memory(im->log, "rules");
    }
    im->report->rules = l->matched;
    im->report->rule_count = p->luminaire_count;
    return status ? status : add_groups(im);
}

void luminaires_free(luminaires *l) {
    if (!l)
        return;
    lamp_conditions_destroy(l->conditions);
    free(l->profile);
    free(l->group);
    free(l);
}

bool luminaires_ask_roads(const importer *im) { return lamp_conditions_ask_roads(im->luminaires->conditions); }

/* ---- lamps ---- */

/* The flux as a rule says it, or as it was told before all rules. */
static void apply_flux(const noc_luminaire_rule *r, const geo_lamp *told, geo_lamp *lamp, geo_fitting *f) {
    if (r->flux) {
        lamp->lumens = told->lumens;
        lamp->watts = told->watts;
        f->flux = r->flux;
    }
    if (isfinite(r->watts)) {
        lamp->watts = r->watts;
        lamp->lumens = NAN;
    }
    lamp->lumens = isfinite(r->lumens) ? r->lumens : lamp->lumens;
    if (!r->flux && (isfinite(r->watts) || isfinite(r->lumens)))
        f->flux = NOC_FLUX_ANY;
}

static void apply(const noc_luminaire_rule *r, int profile, const geo_lamp *told, geo_lamp *lamp, geo_fitting *f) {
    if (r->source)
        lamp->source = (int)r->source;
    if (r->type)
        lamp->type = (int)r->type - NOC_LAMP_STREET + GEO_LAMP_STREET;
    if (r->mount)
        lamp->mount = (int)r->mount - NOC_LAMP_POLE + GEO_MOUNT_POLE;
    apply_flux(r, told, lamp, f);
    if (isfinite(r->kelvin)) {
        lamp->kelvin = r->kelvin;
        lamp->rgb[0] = lamp->rgb[1] = lamp->rgb[2] = -1;
    }
    if (r->colour)
        lamp_hex_colour(r->colour, lamp->rgb);
    lamp->height = isfinite(r->height) ? r->height : lamp->height;
    lamp->count = r->heads ? r->heads : lamp->count;
    f->efficacy = isfinite(r->efficacy) ? r->efficacy : f->efficacy;
    f->shape = r->shape ? r->shape : f->shape;
    f->radius = isfinite(r->radius) ? r->radius : f->radius;
    f->tilt = isfinite(r->tilt) ? r->tilt : f->tilt;
    f->arm = isfinite(r->arm) ? r->arm : f->arm;
    f->turn = isfinite(r->turn) ? r->turn : f->turn;
    f->profile = profile ? profile : f->profile;
}

int luminaires_group(importer *im, const lamp_subject *of) {
    const luminaires *l = im->luminaires;
    for (size_t i = 0; i < im->params->group_count; i++)
        if (!is_own_group(&im->params->groups[i]) && lamp_group_holds(l->conditions, i, of))
            return l->group[i];
    for (size_t i = 0; i < NOC_COUNT(own_groups); i++)
        if (!strcmp(own_groups[i].cls, of->cls))
            return noc_scene_group_named(im->scene, own_groups[i].group);
    return 0;
}

static const char *highway_word(const geo_road *road) {
    const geo_highway *highway = road ? geo_highway_get(road->highway) : NULL;
    return highway ? highway->word : NULL;
}

void luminaires_dress(importer *im, const input *in, lamp_roads roads, geo_lamp *lamp, geo_fitting *fitting) {
    luminaires *l = im->luminaires;
    if (!in)
        lamp_conditions_none(l->conditions, lamp);
    const geo_lamp told = *lamp;
    const lamp_subject of = { .lamp = &told,
                              .cls = "lamp",
                              .file = in ? in->path : NULL,
                              .street = roads.street ? roads.street->name : NULL,
                              .road = highway_word(roads.beside),
                              .inferred = !in };
    char places[MOST_PLACES] = "";
    size_t n = 0;
    unsigned said = 0;
    *fitting = geo_no_fitting();
    for (size_t i = 0; i < im->params->luminaire_count; i++) {
        const noc_luminaire_rule *r = &im->params->luminaires[i];
        if (!lamp_rule_holds(l->conditions, i, &of))
            continue;
        l->matched[i].lamps++;
        apply(r, l->profile[i], &told, lamp, fitting);
        said |= isfinite(r->height) ? 1u << NOC_LAMP_HEIGHT : 0;
        said |= r->flux == NOC_FLUX_FILE || isfinite(r->lumens) || isfinite(r->watts) ? 1u << NOC_LAMP_FLUX : 0;
        if (im->params->each_lamp && n < sizeof(places) - 1)
            n += (size_t)noc_snprintf(places + n, sizeof(places) - n, "%s%s", n ? "; " : "", l->matched[i].place);
    }
    fitting->group = luminaires_group(im, &of);
    city_profiles_file(im->profiles, fitting);
    l->fileless += fitting->flux == NOC_FLUX_FILE && im->profiles && isnan(fitting->file_lumens);
    lamp->fitting = fitting;
    if (im->params->each_lamp && !im->inspect)
        each_lamp_begin(im, in, roads, lamp, places, said);
}

void luminaires_see(importer *im, input *in, geo_lamp *lamp) {
    geo_fitting fitting;
    luminaires_dress(im, in, (lamp_roads){ 0 }, lamp, &fitting);
    report_assumed(&in->file, lamp);
    lamp->fitting = NULL;
}

void luminaires_dress_inferred(void *im, geo_lamp *lamp, geo_fitting *fitting) {
    luminaires_dress(im, NULL, road_lamps_near(im, lamp->xyz), lamp, fitting);
}

/* Lights of an input that is no city: those from there on, and triangles of meshes. */
void luminaires_take(importer *im, const input *in, size_t first_light, size_t first_mesh) {
    noc_scene *s = im->scene;
    const lamp_subject of = { .cls = "other", .file = in->path };
    int group = im->params->group_count ? luminaires_group(im, &of) : 0;
    for (size_t i = first_light; group && i < s->lights.len; i++)
        if (!noc_light_group(&s->lights.data[i]))
            s->lights.data[i].flags |= (uint32_t)group << NOC_LIGHT_GROUP;
    for (size_t i = first_mesh; group && i < s->meshes.len; i++)
        if (!s->meshes.data[i].group)
            s->meshes.data[i].group = (uint16_t)group;
}

/* ---- once all is there ---- */

static noc_status start_group(importer *im, const noc_group_rule *g, int group) {
    float scale = g->on ? (float)g->scale : 0, rgb[3];
    noc_status status = NOC_OK;
    if (scale != 1)
        status = noc_scene_set_group(im->scene, group, (float[]){ scale, scale, scale });
    bool coloured = g->colour ? lamp_hex_colour(g->colour, rgb) : isfinite(g->kelvin) != 0;
    if (coloured && !g->colour)
        noc_kelvin_rgb(g->kelvin, rgb);
    return status || !coloured ? status : noc_scene_colour_group(im->scene, group, rgb);
}

/* "main, lamps, windows" */
static void tell_groups(const noc_scene *s, char *text, size_t size) {
    size_t n = 0;
    noc_snprintf(text, size, "none");
    for (size_t i = 0; i < s->groups.len && n < size; i++)
        if (s->groups.data[i].name)
            n += (size_t)noc_snprintf(text + n, size - n, "%s%.40s", n ? ", " : "", s->groups.data[i].name);
}

static noc_status say_group(importer *im, const char *text) {
    const char *equals = strchr(text, '=');
    char name[80] = "", there[300];
    if (equals && (size_t)(equals - text) < sizeof(name))
        noc_snprintf(name, sizeof(name), "%.*s", (int)(equals - text), text);
    if (!*name)
        return noc_error(im->log, NOC_ERR_ARGUMENT, "group: \"%.60s\" is not NAME=STATE", text);
    int group = noc_scene_find_group(im->scene, name);
    tell_groups(im->scene, there, sizeof(there));
    return group
               ? noc_scene_say_group(im->scene, group, equals + 1)
               : noc_error(im->log, NOC_ERR_ARGUMENT, "group: there is no group %s; the scene's are: %s", name, there);
}

noc_status luminaires_say(importer *im) {
    const noc_texts *states = &im->params->group_states;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < states->count && !status; i++)
        status = say_group(im, states->text[i]);
    return status;
}

/* Of a rule that matches no lamp: what its author may have meant of roads. */
static void warn_idle(const importer *im, size_t rule) {
    const noc_luminaire_rule *r = &im->params->luminaires[rule];
    const lamp_conditions *c = im->luminaires->conditions;
    const char *why = "";
    char shown[60], tag[200] = "";
    bool asks = false, meant = false, there = false;
    for (size_t i = 0; i < r->condition_count; i++)
        asks = asks || !strcmp(r->conditions[i].key, "road");
    for (int i = 1; geo_highway_get(i); i++) {
        size_t by_tag = lamp_rule_means_road(c, rule, geo_highway_get(i)->word, true);
        if (by_tag && !*tag)
            noc_snprintf(tag, sizeof(tag), ": %.20s is asked of its own tags, and a road's kind is asked by road: %s",
                         r->conditions[by_tag - 1].key,
                         noc_text_clean(shown, sizeof(shown), r->conditions[by_tag - 1].test));
        meant = meant || lamp_rule_means_road(c, rule, geo_highway_get(i)->word, false);
    }
    for (size_t i = 0; i < im->roads.len && !there; i++)
        there = lamp_rule_means_road(c, rule, highway_word(&im->roads.data[i]), false) > 0;
    if (asks && !meant)
        why = ": road is one of OpenStreetMap's words for the nearest road (residential, primary, ...), and a column "
              "of that name is asked by tag:road";
    else if (asks && !im->roads.len)
        why = ": the inputs hold no roads, which maps have";
    else if (asks && !there)
        why = ": no road of the inputs is of that kind";
    noc_warn(im->log, "%s: the rule matches no lamp%s%s", im->luminaires->matched[rule].place, tag, *tag ? "" : why);
}

noc_status luminaires_finish(importer *im) {
    const noc_import_params *p = im->params;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < p->luminaire_count && !im->inspect; i++)
        if (!im->luminaires->matched[i].lamps)
            warn_idle(im, i);
    if (im->luminaires->fileless)
        noc_warn(im->log, "rules: \"lumens: file\" of %zu lamp%s whose profile is no file: their flux is their own",
                 im->luminaires->fileless, im->luminaires->fileless == 1 ? "" : "s");
    for (size_t i = 0; i < p->group_count && !status; i++)
        status = start_group(im, &p->groups[i], im->luminaires->group[i]);
    return status ? status : luminaires_say(im);
}

/* What a state says. */
typedef struct group_state {
    bool scaled, coloured, own;
    float scale, rgb[3];
} group_state;

static bool read_word(const char *text, size_t n, group_state *state) {
    char word[40] = "";
    double x = NAN;
    if (n < sizeof(word))
        noc_snprintf(word, sizeof(word), "%.*s", (int)n, text);
    size_t length = strlen(word);
    bool kelvin = length > 1 && (word[length - 1] == 'K' || word[length - 1] == 'k');
    if (kelvin)
        word[length - 1] = 0;
    bool number = noc_parse_double(word, &x), on = noc_ieq(word, "on"), off = noc_ieq(word, "off");
    if (kelvin && number && x >= 1000 && x <= 25000) {
        noc_kelvin_rgb(x, state->rgb);
        state->coloured = true;
    } else if (!kelvin && (on || off || (number && x >= 0 && x <= 1e6))) {
        state->scale = on ? 1 : off ? 0 : (float)x;
        state->scaled = true;
    } else if (noc_ieq(word, "own")) {
        state->own = true;
    } else if (*word == '#' && lamp_hex_colour(word, state->rgb) && state->rgb[0] + state->rgb[1] + state->rgb[2] > 0) {
        state->coloured = true;
    } else {
        return false;
    }
    return true;
}

static noc_status read_state(const char *text, group_state *state, noc_log *log) {
    for (const char *s = text;; s++) {
        size_t n = strcspn(s, ",");
        if (!read_word(s, n, state))
            return noc_error(log, NOC_ERR_ARGUMENT,
                             "group: \"%.60s\" is no state: off, on, a factor (0.3), a colour (2200K, #ffb060) or own",
                             text);
        s += n;
        if (!*s)
            return NOC_OK;
    }
}

noc_status noc_group_state_check(const char *text, noc_log *log) {
    return text ? read_state(text, &(group_state){ 0 }, log) : noc_null(log, __func__);
}

noc_status noc_scene_say_group(noc_scene *scene, int group, const char *text) {
    group_state state = { 0 };
    if (!scene || !text)
        return noc_null(scene ? scene->log : NULL, __func__);
    noc_status status = read_state(text, &state, scene->log);
    if (!status && state.scaled)
        status = noc_scene_set_group(scene, group, (float[]){ state.scale, state.scale, state.scale });
    if (!status && (state.coloured || state.own))
        status = noc_scene_colour_group(scene, group, state.coloured ? state.rgb : NULL);
    return status;
}
