/* Configurations of an experiment. One entry of the spec may stand for several: an option with an array of values, or a
 * choice with "*", makes one of each. */
#include "lab/config.h"

static const noc_option config_rows[] = {
    { "frames", "Configuration", NOC_OPTION_INT, offsetof(lab_config, frames), 1, LAB_FRAMES, NULL, "", "" },
    { "seconds", "Configuration", NOC_OPTION_REAL, offsetof(lab_config, seconds), 0, 1e6, NULL, "s", "" },
    { NULL },
};
static const noc_option preset_rows[] = {
    NOC_OPTION_PRESET(lab_config, "Configuration"),
    { NULL },
};
static const noc_option *config_table(void) { return config_rows; }
static const noc_option *preset_table(void) { return preset_rows; }
static const char *const said_above[] = { "width", "height", "seed", "accumulate", NULL };
#define RENDER_OPTIONS                                                                                                 \
    { preset_table, 0, NULL }, { noc_render_options, offsetof(lab_config, params), said_above }
static const lab_options shared_options[] = { RENDER_OPTIONS, { NULL } },
                         config_options[] = { { config_table, 0, NULL }, RENDER_OPTIONS, { NULL } };
static const char *const named[] = { "name", NULL };

/* The option of an entry that stands for several of its values; NULL: it stands for itself. */
static noc_status several(const lab_spec *spec, const char *place, json_t *object, const noc_option **found) {
    const char *name;
    json_t *value;
    *found = NULL;
    json_object_foreach(object, name, value) {
        size_t offset;
        const noc_option *o = lab_option(config_options, name, &offset);
        bool star = json_is_string(value) && !strcmp(json_string_value(value), "*");
        if (!o || o->kind == NOC_OPTION_TEXT || !(star ? o->kind == NOC_OPTION_CHOICE : json_array_size(value) > 0))
            continue;
        if (*found)
            return lab_wrong(spec, place, "one option may have several values, not two");
        *found = o;
    }
    return NOC_OK;
}

/* The values meant: a new array; NULL where memory is refused. */
static json_t *values_of(const noc_option *option, json_t *value) {
    if (json_is_array(value))
        return json_incref(value);
    json_t *all = json_array();
    bool whole = all;
    for (const char *c = option->choices; whole && *c;) {
        size_t length = strcspn(c, "|");
        whole = !json_array_append_new(all, json_stringn(c, length));
        c += length + (c[length] == '|');
    }
    if (whole)
        return all;
    json_decref(all);
    return NULL;
}

/* "ris, *" and lists -> "ris, lists" */
static char *star_name(noc_arena *arena, const char *name, const char *value) {
    const char *star = strchr(name, '*');
    return star ? arena_format(arena, "%.*s%s%s", (int)(star - name), name, value, star + 1)
                : arena_format(arena, "%s, %s", name, value);
}

/* As the library writes it: 0.50 and 5e-1 are both 0.5. */
static char *value_text(noc_arena *arena, const noc_option *option, const lab_config *config) {
    size_t offset = 0;
    lab_option(config_options, option->name, &offset);
    char text[80];
    noc_option_get(option, (const char *)config + offset, text, sizeof(text));
    return arena_strdup(arena, text);
}

/* NULL after reporting that memory was refused. */
static lab_config *add(lab_spec *spec, const lab_config *shared, size_t entry, int choice) {
    lab_config *configs = noc_realloc(spec->configs, sizeof(lab_config) * (spec->config_count + 1));
    if (!configs) {
        lab_spec_no_memory(spec);
        return NULL;
    }
    spec->configs = configs;
    lab_config *config = &spec->configs[spec->config_count++];
    *config = *shared;
    config->frames = spec->frames;
    config->seconds = spec->seconds;
    config->entry = entry;
    config->choice = choice;
    return config;
}

/* Options of one object. Its preset comes before all others, wherever it stands: they win over it, as on the command
 * line. */
static noc_status read_options(lab_spec *spec, const char *place, json_t *object, const lab_options *options,
                               const char *const *others, lab_config *config) {
    json_t *preset = json_object_get(object, "preset");
    noc_status status = preset ? lab_set(spec, place, options, NULL, config, "preset", preset) : NOC_OK;
    if (!status && preset)
        noc_render_use_preset(&config->params, (noc_preset)config->preset);
    return status ? status : lab_set_all(spec, place, object, options, others, config);
}

/* Of members of an object that change nothing: in none of the configurations from first to before end, nor with the
 * other params, which may be NULL. */
static void warn_of_idle(const lab_spec *spec, const char *place, json_t *object, size_t first, size_t end,
                         const noc_render_params *other) {
    const noc_option *table = noc_render_options();
    const char *name;
    json_t *value;
    json_object_foreach(object, name, value) {
        char why[160] = "";
        size_t offset, i = first;
        const noc_option *o = lab_option(config_options, name, &offset);
        if (!o || !o->needs || (other && !noc_option_idle(o, table, other, why, sizeof(why))))
            continue;
        while (i < end && noc_option_idle(o, table, &spec->configs[i].params, why, sizeof(why)))
            i++;
        if (i == end)
            noc_warn(spec->log, "%s: %s: %s has no effect: %s", spec->path, place, name, why);
    }
}

void lab_warn_of_idle(const lab_spec *spec, json_t *root) {
    const noc_render_params *reference = &spec->reference.params;
    char place[64];
    warn_of_idle(spec, "options", json_object_get(root, "options"), 0, spec->config_count, reference);
    warn_of_idle(spec, "reference", json_object_get(root, "reference"), 0, 0, reference);
    for (size_t first = 0, end; first < spec->config_count; first = end) {
        size_t entry = spec->configs[first].entry;
        for (end = first; end < spec->config_count && spec->configs[end].entry == entry;)
            end++;
        noc_snprintf(place, sizeof(place), "configurations[%zu]", entry);
        warn_of_idle(spec, place, json_array_get(json_object_get(root, "configurations"), entry), first, end, NULL);
    }
}

noc_status lab_read_shared(lab_spec *spec, json_t *object, lab_config *shared) {
    return read_options(spec, "options", object, shared_options, NULL, shared);
}

/* Seconds alone decide where frames are not given beside them. */
static noc_status read_members(lab_spec *spec, const char *place, json_t *object, lab_config *config) {
    noc_status status = read_options(spec, place, object, config_options, named, config);
    if (!status && json_object_get(object, "seconds") && !json_object_get(object, "frames"))
        config->frames = config->seconds > 0 ? LAB_FRAMES : config->frames;
    return status;
}

/* One configuration of each value. */
static noc_status read_values(lab_spec *spec, const char *place, json_t *object, const lab_config *shared, size_t entry,
                              const noc_option *option, const char *name, json_t *values) {
    noc_status status =
        lab_too_many(spec, "", spec->config_count + json_array_size(values), LAB_ENTRIES, "configurations");
    size_t i;
    json_t *value;
    json_array_foreach(values, i, value) {
        lab_config *config = status ? NULL : add(spec, shared, entry, (int)i);
        if (status || !config)
            return status ? status : NOC_ERR_MEMORY;
        config->option = option;
        config->pattern = config->name = config->value = name;
        if (json_object_set(object, option->name, value))
            return lab_spec_no_memory(spec);
        status = read_members(spec, place, object, config);
        if (!status)
            config->value = value_text(&spec->arena, option, config);
        if (!status && config->value)
            config->name = star_name(&spec->arena, name, config->value);
        if (spec->arena.refused)
            return lab_spec_no_memory(spec);
    }
    return status;
}

noc_status lab_read_config(lab_spec *spec, const char *place, json_t *object, const lab_config *shared, size_t entry) {
    const char *name = NULL;
    const noc_option *option = NULL;
    noc_status status = json_is_object(object) ? several(spec, place, object, &option) : NOC_OK;
    if (!status && !option) {
        status = lab_too_many(spec, "", spec->config_count + 1, LAB_ENTRIES, "configurations");
        lab_config *config = status ? NULL : add(spec, shared, entry, -1);
        if (!config)
            return status ? status : NOC_ERR_MEMORY;
        status = read_members(spec, place, object, config);
        return status ? status : lab_read_name(spec, place, object, &config->name);
    }
    status = status ? status : lab_read_name(spec, place, object, &name);
    if (status)
        return status;
    json_t *values = values_of(option, json_object_get(object, option->name));
    status = values ? read_values(spec, place, object, shared, entry, option, name, values) : lab_spec_no_memory(spec);
    json_decref(values);
    return status;
}
