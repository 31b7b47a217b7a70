/* From the text of a region to what it is. */
#include "ask/ask.h"

static const struct {
    const char *word;
    noc_status (*fill)(const asked *a);
} kinds[] = {
    { "point", ask_point },   { "pixel", ask_pixel },   { "rect", ask_rect },
    { "object", ask_object }, { "street", ask_street }, { "polygon", ask_polygon },
};

static noc_status unknown(const char *text, size_t word, noc_log *log) {
    const char *words[NOC_COUNT(kinds)];
    char said[32], all[160] = "";
    noc_snprintf(said, sizeof(said), "%.*s", (int)NOC_MIN(word, sizeof(said) - 1), text);
    noc_text_clean(said, sizeof(said), said);
    for (size_t i = 0; i < NOC_COUNT(kinds); i++) {
        size_t n = strlen(all);
        words[i] = kinds[i].word;
        noc_snprintf(all + n, sizeof(all) - n, "%s%s:", i ? ", " : "", words[i]);
    }
    const char *nearest = noc_text_nearest(said, words, NOC_COUNT(kinds));
    return nearest ? noc_error(log, NOC_ERR_ARGUMENT, "region: no kind \"%s\"; is it %s: ?", said, nearest)
                   : noc_error(log, NOC_ERR_ARGUMENT, "region: \"%s\" does not begin with %s", said, all);
}

noc_region *noc_region_find(noc_view *view, const noc_scene *scene, const char *text, const noc_region_params *params,
                            noc_log *log) {
    const noc_region_params defaults = { 0 };
    if (!view || !scene || !text) {
        noc_null(log, __func__);
        return NULL;
    }
    const char *colon = strchr(text, ':');
    size_t word = colon ? (size_t)(colon - text) : strlen(text), kind = 0;
    while (kind < NOC_COUNT(kinds) && (strlen(kinds[kind].word) != word || strncmp(kinds[kind].word, text, word) != 0))
        kind++;
    if (kind == NOC_COUNT(kinds) || !colon) {
        unknown(text, word, log);
        return NULL;
    }
    noc_region *region = noc_region_create(log);
    asked a = { view, scene, params ? params : &defaults, log, colon + 1, region };
    if (region && kinds[kind].fill(&a) != NOC_OK) {
        noc_region_destroy(region);
        return NULL;
    }
    return region;
}
