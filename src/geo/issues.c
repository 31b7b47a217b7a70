/* Reasons why features were skipped, repaired or guessed at, counted, with the ids of the first few. */
#include "geo/geo.h"

#define EXAMPLES 5

struct line {
    const char *reason;
    geo_issue_kind kind;
    size_t count;
    int example_count;
    const char *examples[EXAMPLES];
    char *joined; /* made on request */
};

struct geo_issues {
    NOC_ARRAY(struct line) lines;
    noc_arena names;
};

geo_issues *geo_issues_create(void) { return noc_calloc(1, sizeof(geo_issues)); }

bool geo_issues_refused(const geo_issues *issues) { return issues->names.refused; }

void geo_issues_clear(geo_issues *issues) {
    for (size_t i = 0; i < issues->lines.len; i++)
        free(issues->lines.data[i].joined);
    array_free(&issues->lines);
    arena_free(&issues->names);
}

void geo_issues_destroy(geo_issues *issues) {
    if (!issues)
        return;
    geo_issues_clear(issues);
    free(issues);
}

size_t geo_issues_like(const geo_issues *issues, const char *text) {
    size_t count = 0;
    for (size_t i = 0; i < issues->lines.len; i++)
        count += strstr(issues->lines.data[i].reason, text) != NULL;
    return count;
}

/* There are a few dozen reasons at most, and those in use come first: a linear search. NULL where memory is refused. */
static struct line *find_line(geo_issues *issues, geo_issue_kind kind, const char *reason) {
    for (size_t i = 0; i < issues->lines.len; i++) {
        struct line *l = &issues->lines.data[i];
        if (l->kind == kind && !strcmp(l->reason, reason))
            return l;
    }
    struct line line = { .reason = arena_strdup(&issues->names, reason), .kind = kind };
    if (!line.reason || !array_push(&issues->lines, line)) {
        issues->names.refused = true;
        return NULL;
    }
    return &issues->lines.data[issues->lines.len - 1];
}

void geo_issue(geo_issues *issues, geo_issue_kind kind, const char *reason, const char *id) {
    if (!issues)
        return;
    struct line *l = find_line(issues, kind, reason);
    if (!l)
        return;
    l->count++;
    if (!id || !*id || l->example_count == EXAMPLES)
        return;
    for (int i = 0; i < l->example_count; i++)
        if (!strcmp(l->examples[i], id))
            return;
    const char *example = arena_strdup(&issues->names, id);
    if (!example)
        return;
    l->examples[l->example_count++] = example;
    free(l->joined);
    l->joined = NULL;
}

void geo_issues_add(geo_issues *issues, geo_issue_kind kind, const char *reason, size_t count, const char *examples) {
    if (!issues || !count)
        return;
    geo_issue(issues, kind, reason, examples);
    struct line *l = find_line(issues, kind, reason);
    if (l)
        l->count += count - 1;
}

void geo_issues_merge(geo_issues *issues, const geo_issues *others) {
    issues->names.refused = issues->names.refused || others->names.refused;
    for (size_t i = 0; i < others->lines.len; i++) {
        const struct line *from = &others->lines.data[i];
        struct line *to = find_line(issues, from->kind, from->reason);
        size_t before = to ? to->count : 0;
        for (int k = 0; k < from->example_count; k++)
            geo_issue(issues, from->kind, from->reason, from->examples[k]);
        if (to)
            to->count = before + from->count;
    }
}

geo_issue_kind geo_issues_kind(const geo_issues *issues, size_t i) { return issues->lines.data[i].kind; }

size_t geo_issues_count(const geo_issues *issues) { return issues ? issues->lines.len : 0; }

bool geo_issues_get(const geo_issues *issues, size_t i, const char **reason, bool *repaired, size_t *count,
                    const char **examples) {
    struct line *l = &issues->lines.data[i];
    *reason = l->reason;
    *repaired = l->kind == GEO_REPAIRED || l->kind == GEO_GUESSED;
    *count = l->count;
    if (!l->joined) {
        size_t size = 1;
        for (int k = 0; k < l->example_count; k++)
            size += strlen(l->examples[k]) + 2;
        char *p = l->joined = noc_alloc(size);
        if (!p)
            return false;
        *p = 0;
        for (int k = 0; k < l->example_count; k++)
            p = stpcpy(stpcpy(p, k ? ", " : ""), l->examples[k]);
    }
    *examples = l->joined;
    return true;
}
