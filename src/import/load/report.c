#include "import/load/load.h"
#include "city/city.h"

noc_report *report_create(void) { return noc_calloc(1, sizeof(noc_report)); }

const char *noc_lamp_source_name(noc_lamp_source source) {
    static const char *const names[NOC_SOURCE_COUNT] = {
        [NOC_SOURCE_UNKNOWN] = "unknown",
        [NOC_SOURCE_LED] = "LED",
        [NOC_SOURCE_SODIUM] = "sodium",
        [NOC_SOURCE_MERCURY] = "mercury",
        [NOC_SOURCE_METAL_HALIDE] = "metal halide",
        [NOC_SOURCE_FLUORESCENT] = "fluorescent",
        [NOC_SOURCE_INCANDESCENT] = "incandescent",
        [NOC_SOURCE_GAS] = "gas",
        [NOC_SOURCE_LOW_SODIUM] = "low-pressure sodium",
    };
    return (unsigned)source < NOC_SOURCE_COUNT ? names[source] : "unknown";
}

size_t noc_report_file_count(const noc_report *report) { return report ? report->files.len : 0; }

const noc_report_file *noc_report_get_file(const noc_report *report, size_t index) {
    return report && index < report->files.len ? &report->files.data[index] : NULL;
}

const noc_group_info *noc_report_get_group(const noc_report *report, size_t index) {
    return report && index < report->group_count ? &report->groups[index] : NULL;
}

const noc_report_rule *noc_report_get_rule(const noc_report *report, size_t index) {
    return report && index < report->rule_count ? &report->rules[index] : NULL;
}

const noc_report_lamp *noc_report_get_lamp(const noc_report *report, size_t index) {
    return report && index < report->lamps.len ? &report->lamps.data[index] : NULL;
}

/* Lamps lie in the order of their lights. */
const noc_report_lamp *noc_report_find_lamp(const noc_report *report, size_t light) {
    size_t lo = 0, hi = report ? report->lamps.len : 0;
    while (lo < hi) {
        size_t middle = (lo + hi) / 2;
        if (report->lamps.data[middle].light < light)
            lo = middle + 1;
        else
            hi = middle;
    }
    const noc_report_lamp *l = noc_report_get_lamp(report, lo);
    return l && l->light == light ? l : NULL;
}

void noc_report_destroy(noc_report *report) {
    if (!report)
        return;
    array_free(&report->lamps);
    array_free(&report->files);
    array_free(&report->panes);
    array_free(&report->parts);
    array_free(&report->mapped);
    arena_free(&report->arena);
    free(report);
}

bool report_pane(noc_report *report, size_t file, bool counts) {
    report_panes *last = report->panes.len ? &report->panes.data[report->panes.len - 1] : NULL;
    if (last && last->file == file && last->counts == counts) {
        last->panes++;
        return true;
    }
    return array_push(&report->panes, ((report_panes){ (uint32_t)file, counts, 1 }));
}

noc_status report_groups(noc_report *report, const noc_scene *scene) {
    size_t count = noc_scene_groups(scene, NULL, 0);
    noc_group_info *groups = arena_alloc(&report->arena, count * sizeof(*groups));
    if (!groups)
        return noc_no_memory(scene->log, "groups");
    noc_scene_groups(scene, groups, count);
    for (size_t i = 0; i < count; i++) {
        groups[i].name = arena_strdup(&report->arena, groups[i].name); /* the scene's go with it */
        if (!groups[i].name)
            return noc_no_memory(scene->log, "groups");
    }
    report->groups = groups;
    report->group_count = count;
    return NOC_OK;
}

noc_status noc_report_follow(noc_report *report, const noc_scene *scene) {
    if (!report || !scene)
        return noc_null(scene ? scene->log : NULL, __func__);
    noc_scene_lock_read(scene);
    for (size_t i = 0; i < report->files.len && report->panes.len; i++)
        report->files.data[i].windows.lit = 0;
    for (size_t i = 0, w = 0; i < report->panes.len; i++) {
        const report_panes *p = &report->panes.data[i];
        for (size_t end = w + p->panes; w < end && w < scene->windows.len; w++) {
            noc_light_record r = noc_light_made(scene, scene->windows.data[w].light);
            bool lit = !scene->windows.data[w].removed && (r.e[0] > 0 || r.e[1] > 0 || r.e[2] > 0);
            if (p->file < report->files.len)
                report->files.data[p->file].windows.lit += p->counts && lit;
        }
    }
    noc_scene_unlock_read(scene);
    return report_groups(report, scene);
}

static void add_windows(noc_window_counts *to, const noc_window_counts *from) {
    to->windows += from->windows;
    to->own += from->own;
    to->lit += from->lit;
    for (int u = 0; u < NOC_USE_COUNT; u++)
        to->buildings[u] += from->buildings[u];
    for (int v = 0; v < NOC_WALL_VERDICT_COUNT; v++) {
        to->walls[v] += from->walls[v];
        to->area[v] += from->area[v];
    }
}

void noc_report_get_totals(const noc_report *report, noc_report_totals *totals) {
    if (!totals)
        return;
    *totals = (noc_report_totals){ .lamps_inferred = report ? report->lamps_inferred : 0,
                                   .cars = report ? report->road_cars : 0,
                                   .road_cars = report ? report->road_cars : 0,
                                   .roads_drawn = report ? report->roads_drawn : 0 };
    totals->images_reduced = report ? report->images_reduced : 0;
    if (report)
        memcpy(totals->profiles, report->profiles, sizeof(totals->profiles));
    for (size_t i = 0; i < noc_report_file_count(report); i++) {
        const noc_report_file *f = &report->files.data[i];
        totals->objects += f->objects;
        totals->buildings += f->buildings;
        totals->bytes_read += f->bytes_read;
        totals->images += f->images;
        totals->lamps_mapped += f->lamps_mapped;
        totals->lamps_moved += f->lamps_moved;
        totals->lamps_dropped += f->lamps_dropped;
        totals->lamps_repeated += f->lamps_repeated;
        totals->objects_repeated += f->objects_repeated;
        totals->tracks += f->tracks;
        totals->cars += f->cars;
        for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++)
            totals->lamps_assumed[what] += f->lamps_assumed[what];
        add_windows(&totals->windows, &f->windows);
        for (size_t k = 0; k < f->line_count; k++)
            *(!f->lines[k].repaired  ? &totals->skipped
              : f->lines[k].lossless ? &totals->repaired
                                     : &totals->guessed) += f->lines[k].count;
    }
}

void report_assumed(noc_report_file *file, const geo_lamp *lamp) {
    for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++)
        file->lamps_assumed[what] += city_lamp_assumes(lamp, (noc_lamp_default)what);
}

/* What strict says of the lamps that the program makes up, wholly or in part. Returns how many guesses that are. */
static size_t guesses_at_lamps(const noc_report *report, const noc_import_params *params, char *text, size_t size) {
    const struct {
        const char *what, *option;
        double value;
    } of[NOC_LAMP_DEFAULT_COUNT] = {
        [NOC_LAMP_HEIGHT] = { "height", "lamp-height", params->lamp_height },
        [NOC_LAMP_FLUX] = { "flux", "lamp-lumens", params->lamp_lumens },
        [NOC_LAMP_COLOUR] = { "colour", "lamp-kelvin", params->lamp_kelvin },
    };
    noc_report_totals t;
    size_t guesses = 0, n = 0;
    noc_report_get_totals(report, &t);
    for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++) {
        if (!t.lamps_assumed[what] || params->lamp_chosen >> what & 1)
            continue;
        guesses += t.lamps_assumed[what];
        if (!of[what].option) {
            n += (size_t)noc_snprintf(text + n, size - n, "; %zu x lamp %s", t.lamps_assumed[what],
                                      what == NOC_LAMP_DIRECTION
                                          ? "facing by chance"
                                          : "with watts and no source (a rule's efficacy counts)");
            continue;
        }
        n += (size_t)noc_snprintf(text + n, size - n, "; %zu x lamp without %s (--%s %g takes that)",
                                  t.lamps_assumed[what], of[what].what, of[what].option, of[what].value);
    }
    if (t.lamps_inferred && params->infer_lamps != NOC_SWITCH_ON) {
        guesses += t.lamps_inferred;
        noc_snprintf(text + n, size - n,
                     "; %s, %zu placed by a rule (--lamps FILE gives some, --infer-lamps takes these, "
                     "--no-infer-lamps leaves %s dark)",
                     t.lamps_mapped ? "lit streets without lamps" : "no lamps in the inputs", t.lamps_inferred,
                     t.lamps_mapped ? "them" : "the city");
    }
    return guesses;
}

/* Adds a cause with all of its ids or with none, for a part of an id cannot be searched for. False, and nothing is
 * added, where there is no room. */
static bool put_cause(char *text, size_t size, size_t *used, const char *path, const noc_report_line *l) {
    for (int ids = *l->examples != 0; ids >= 0; ids--) {
        int n = noc_snprintf(text + *used, size - *used, ids ? "; %s: %zu x %s (%s)" : "; %s: %zu x %s", path, l->count,
                             l->reason, l->examples);
        if (n >= 0 && *used + (size_t)n < size) {
            *used += (size_t)n;
            return true;
        }
        text[*used] = 0;
    }
    return false;
}

noc_status report_strict(const noc_report *report, const noc_import_params *params, noc_log *log) {
    enum { SHOWN = 8 };
    size_t skipped = 0, guessed = 0, lines = 0, shown = 0, n = 0;
    char causes[920] = "", lamps[580] = "";
    size_t guesses = guesses_at_lamps(report, params, lamps, sizeof(lamps));
    size_t room = sizeof(causes) - strlen(lamps); /* a message is cut somewhere */
    for (size_t i = 0; i < report->files.len; i++)
        for (size_t k = 0; k < report->files.data[i].line_count; k++) {
            const noc_report_file *f = &report->files.data[i];
            const noc_report_line *l = &f->lines[k];
            if (l->lossless)
                continue;
            *(l->repaired ? &guessed : &skipped) += l->count;
            lines++;
            shown += shown < SHOWN && put_cause(causes, room, &n, f->path, l);
        }
    if (!lines && !guesses)
        return NOC_OK;
    char more[40] = "";
    if (lines > shown)
        noc_snprintf(more, sizeof(more), "; and %zu more", lines - shown);
    return noc_error(log, NOC_ERR_FORMAT, "--strict: features left out: %zu, guessed at: %zu%s%s%s", skipped,
                     guessed + guesses, lamps, causes, more);
}

static const char *keep(noc_report *report, const char *text) { return arena_strdup(&report->arena, text ? text : ""); }

bool report_add(noc_report *report, const noc_report_file *file, const geo_issues *issues) {
    noc_report_file f = *file;
    f.path = keep(report, f.path);
    f.format = keep(report, f.format);
    f.crs = keep(report, f.crs);
    f.crs_given = keep(report, f.crs_given);
    f.height_unit_by = keep(report, f.height_unit_by);
    /* the columns are in the arena already */
    f.line_count = geo_issues_count(issues);
    noc_report_line *lines = arena_alloc(&report->arena, f.line_count * sizeof(*lines));
    for (size_t i = 0; i < f.line_count && lines; i++) {
        if (!geo_issues_get(issues, i, &lines[i].reason, &lines[i].repaired, &lines[i].count, &lines[i].examples))
            return false;
        geo_issue_kind kind = geo_issues_kind(issues, i);
        lines[i].lossless = kind == GEO_REPAIRED || kind == GEO_SPARED;
        lines[i].reason = keep(report, lines[i].reason);
        lines[i].examples = keep(report, lines[i].examples);
    }
    f.lines = lines;
    return !report->arena.refused && !geo_issues_refused(issues) && array_push(&report->files, f);
}
