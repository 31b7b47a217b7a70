/* Rules of a recipe: luminaires, and groups of lights. What may be said are the rows of noc_luminaire_options and
 * noc_group_options, beside `match`. */
#include "recipe/recipe.h"

typedef struct taken {
    recipe_file *file;
    const char *what; /* "a luminaire" */
    const noc_option *rows;
    void *params; /* that the rows are of */
    noc_condition *conditions;
    size_t count;
} taken;

/* A scalar, or a list of patterns of which one is enough. */
static noc_status take_condition(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    recipe_file *f = t->file;
    noc_arena *arena = &f->recipe->arena;
    const char **texts;
    size_t count;
    if (value->type == YAML_MAPPING_NODE)
        return recipe_wrong(f, value, "match %.60s is one value, or a list of patterns", recipe_text(key));
    noc_status status = recipe_texts(f, value, recipe_text(key), &texts, &count);
    if (!status && !count)
        status = recipe_wrong(f, value, "match %.60s is an empty list", recipe_text(key));
    if (status)
        return status;
    noc_condition *c = &t->conditions[t->count++];
    c->key = arena_strdup(arena, recipe_text(key));
    size_t length = 1;
    for (size_t i = 0; i < count; i++)
        length += strlen(texts[i]) + 1;
    char *test = arena_alloc(arena, length), *at = test;
    for (size_t i = 0; i < count && test; i++)
        at += noc_snprintf(at, length - (size_t)(at - test), "%s%s", i ? "|" : "", texts[i]);
    c->test = test;
    return c->key && test ? recipe_said(f, value, noc_condition_check(c, f->listener)) : noc_no_memory(f->log, f->path);
}

static noc_status take_match(taken *t, yaml_node_t *value) {
    bool map = value->type == YAML_MAPPING_NODE;
    size_t pairs = map ? (size_t)(value->data.mapping.pairs.top - value->data.mapping.pairs.start) : 0;
    t->conditions = arena_alloc(&t->file->recipe->arena, (pairs + 1) * sizeof(*t->conditions));
    return t->conditions ? recipe_each(t->file, value, "match", take_condition, t)
                         : noc_no_memory(t->file->log, t->file->path);
}

static noc_status take_key(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    const char *name = recipe_text(key), *words[32];
    size_t count = 0;
    if (!strcmp(name, "match"))
        return take_match(t, value);
    words[count++] = "match";
    for (const noc_option *o = t->rows; o->name; o++) {
        bool again = o[1].name && !strcmp(o[1].name, o->name); /* a word, or else what the next row takes */
        const char *text = recipe_text(value);
        if (strcmp(name, o->name) || (again && !(text && !noc_option_set(o, t->params, text, NULL)))) {
            if (!again)
                words[count++] = o->name;
            continue;
        }
        return recipe_option(t->file, o, value, t->params);
    }
    return recipe_unknown(t->file, key, t->what, words, count);
}

static char *place_of(recipe_file *f, const yaml_node_t *node) {
    return arena_format(&f->recipe->arena, "%.400s:%zu", f->path, node->start_mark.line + 1);
}

noc_status recipe_take_luminaires(recipe_file *f, yaml_node_t *list) {
    if (list->type != YAML_SEQUENCE_NODE)
        return recipe_wrong(f, list, "luminaires is a list of rules");
    noc_status status = NOC_OK;
    for (const int *i = list->data.sequence.items.start; i < list->data.sequence.items.top && !status; i++) {
        yaml_node_t *node = recipe_node(f, *i);
        noc_luminaire_rule rule = noc_luminaire_default_rule();
        taken t = { .file = f, .what = "a luminaire", .rows = noc_luminaire_options(), .params = &rule };
        status = recipe_each(f, node, "a luminaire", take_key, &t);
        if (status)
            break;
        rule.conditions = t.conditions;
        rule.condition_count = t.count;
        rule.place = place_of(f, node);
        rule.profile_base = recipe_path(f, "");
        if (!rule.place || !rule.profile_base || !array_push(&f->recipe->luminaires, rule))
            status = noc_no_memory(f->log, f->path);
    }
    return status;
}

static noc_status take_group(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    recipe_file *f = ctx;
    noc_group_rule group = noc_group_default_rule();
    taken t = { .file = f, .what = "a group", .rows = noc_group_options(), .params = &group };
    noc_status status = recipe_each(f, value, "a group", take_key, &t);
    if (status)
        return status;
    if (strpbrk(recipe_text(key), "=,"))
        return recipe_wrong(f, key, "the name of a group has no = and no comma");
    group.name = arena_strdup(&f->recipe->arena, recipe_text(key));
    group.conditions = t.conditions;
    group.condition_count = t.count;
    group.place = place_of(f, key);
    return group.name && group.place && array_push(&f->recipe->groups, group) ? NOC_OK : noc_no_memory(f->log, f->path);
}

noc_status recipe_take_groups(recipe_file *f, yaml_node_t *map) { return recipe_each(f, map, "groups", take_group, f); }
