/* nocturne influence --lamp: what is known of a lamp, and the region that it lights. */
#include "influence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The first light of that name, lamps before others; reports one that is not there. */
static noc_status find(const influence_job *job, size_t *light) {
    const char **names = cli_alloc((job->site.info.light_slots + 1) * sizeof(*names));
    size_t count = 0, other = SIZE_MAX;
    bool found = false;
    for (size_t i = 0; i < job->site.info.light_slots && !found; i++) {
        noc_light_info l;
        if (noc_scene_get_light(job->site.scene, i, &l) || l.removed || !l.light.name)
            continue;
        bool same = !strcmp(l.light.name, job->args->lamp);
        found = same && l.lamp;
        *light = i;
        other = same && other == SIZE_MAX ? i : other;
        if (l.lamp)
            names[count++] = l.light.name;
    }
    if (!found && other != SIZE_MAX)
        *light = other;
    found = found || other != SIZE_MAX;
    if (!found) {
        const char *nearest = noc_text_nearest(job->args->lamp, names, count);
        char near[64], first[64];
        cli_error("--lamp: no light is called \"%.60s\"%s%s%s", job->args->lamp,
                  nearest ? "; is it \""
                  : count ? "; the first lamp is \""
                          : "",
                  nearest ? noc_text_clean(near, sizeof(near), nearest)
                  : count ? noc_text_clean(first, sizeof(first), names[0])
                          : "",
                  nearest ? "\"?"
                  : count ? "\""
                          : "");
    }
    free(names);
    return found ? NOC_OK : NOC_ERR_ARGUMENT;
}

static void to_crs(const influence_job *job, const double local[3], double at[3]) {
    memcpy(at, local, 3 * sizeof(*at));
    if (*job->site.info.given_crs && noc_scene_from_local(job->site.scene, NULL, at))
        at[0] = at[1] = at[2] = NAN;
}

static void print_text(const char *heading, const char *text) {
    char clean[200];
    if (text && *text)
        printf("%-10s%s\n", heading, noc_text_clean(clean, sizeof(clean), text));
}

static void print_tags(const char *tags) {
    for (const char *p = tags; *p;) {
        size_t n = strcspn(p, "\n");
        char *one = cli_format("%.*s", (int)n, p);
        print_text(p == tags ? "tags" : "", one);
        free(one);
        p += n + (p[n] == '\n');
    }
}

static void print_lamp(const influence_job *job, const noc_reach *r, const noc_report_lamp *lamp) {
    double at[3];
    char a[64], b[32];
    to_crs(job, r->emitter.centre, at);
    snprintf(a, sizeof(a), "%.3f %.3f %.3f", cli_shown(at[0], 3), cli_shown(at[1], 3), cli_shown(at[2], 3));
    printf("%s: %s%s\n", *r->emitter.name ? r->emitter.name : "unnamed", noc_emitter_kind_name(r->emitter.kind),
           r->emitter.inferred ? ", inferred" : "");
    print_text("at", a);
    printf("%-10s%s lm of %s", "flux", cli_number(b, r->emitter.lumens),
           noc_text_many(a, r->emitter.light_count, "light"));
    if (isfinite(r->emitter.kelvin))
        printf(", %.0f K", r->emitter.kelvin);
    if (lamp && isfinite(lamp->watts))
        printf(", %g W", lamp->watts);
    putchar('\n');
    influence_print_maintenance(job);
    if (lamp && isfinite(lamp->height))
        printf("%-10s%.2f m\n", "height", lamp->height);
    print_text("profile", lamp ? lamp->profile : "");
    print_text("street", lamp ? lamp->street : "");
    print_text("file", lamp ? lamp->file : "");
    print_tags(lamp ? lamp->tags : "");
}

static void print_reach(const influence_job *job, const noc_reach *r, const noc_reach_object *objects, size_t count) {
    double at[3];
    char a[32], name[64];
    to_crs(job, r->most_place, at);
    printf("%-10s%s m2 get 1 lx or more of it; the most, %.4g lx, is at %.3f %.3f %.3f\n", "lights",
           cli_number(a, r->area), r->most, cli_shown(at[0], 3), cli_shown(at[1], 3), cli_shown(at[2], 3));
    if (r->far > 0) {
        to_crs(job, r->far_place, at);
        printf("%-10s%.1f m away 0.1 lx, at %.3f %.3f %.3f\n", "", r->far, cli_shown(at[0], 3), cli_shown(at[1], 3),
               cli_shown(at[2], 3));
    }
    printf("%-10s%.0f of %.0f lm meet surfaces of %s\n", "", r->met, r->emitter.lumens,
           noc_text_many((char[64]){ 0 }, r->objects, "object"));
    for (size_t i = 0; i < count; i++)
        printf("%10.1f lm %5.1f %%  %-12s %s\n", objects[i].lumens, 100 * objects[i].lumens / r->emitter.lumens,
               noc_class_name(objects[i].cls),
               *objects[i].name ? noc_text_clean(name, sizeof(name), objects[i].name) : "unnamed");
}

static void json_place(const influence_job *job, const char *name, const double local[3]) {
    double at[3];
    to_crs(job, local, at);
    printf(", \"%s\": [", name);
    for (int k = 0; k < 3; k++) {
        fputs(k ? ", " : "", stdout);
        cli_json_number(stdout, at[k]);
    }
    printf("]");
}

static void json_value(const char *name, double v) {
    printf(", \"%s\": ", name);
    cli_json_number(stdout, v);
}

static void print_json(const influence_job *job, const noc_reach *r, const noc_report_lamp *lamp,
                       const noc_reach_object *objects, size_t count) {
    printf("{\"nocturne\": \"%s\", \"lamp\": ", noc_version());
    cli_json_text(stdout, r->emitter.name);
    printf(", \"kind\": \"%s\", \"light\": %zu, \"lights\": %zu", noc_emitter_kind_name(r->emitter.kind),
           r->emitter.light, r->emitter.light_count);
    json_place(job, "at", r->emitter.centre);
    json_value("lumens", r->emitter.lumens);
    json_value("kelvin", round(r->emitter.kelvin));
    json_value("maintenance", job->site.info.maintenance);
    json_value("watts", lamp ? lamp->watts : NAN);
    json_value("height", lamp ? lamp->height : NAN);
    const char *const texts[][2] = { { "profile", lamp ? lamp->profile : "" },
                                     { "street", lamp ? lamp->street : "" },
                                     { "file", lamp ? lamp->file : "" } };
    for (int i = 0; i < 3; i++) {
        printf(", \"%s\": ", texts[i][0]);
        cli_json_text(stdout, texts[i][1]);
    }
    influence_json_tags(lamp ? lamp->tags : "");
    json_value("area_1lx", r->area);
    json_value("most_lux", r->most);
    json_place(job, "most_at", r->most_place);
    json_value("far_01lx", r->far);
    json_place(job, "far_at", r->far_place);
    json_value("met_lumens", r->met);
    cli_site_json(&job->site, &job->args->render);
    printf(",\n  \"objects\": [");
    for (size_t i = 0; i < count; i++) {
        printf("%s    {\"name\": ", i ? ",\n" : "\n");
        cli_json_text(stdout, objects[i].name);
        printf(", \"class\": \"%s\"", noc_class_name(objects[i].cls));
        json_value("lumens", objects[i].lumens);
        printf("}");
    }
    printf("\n]}\n");
}

noc_status influence_tell_lamp(influence_job *job) {
    size_t light = 0, found = 0, top = (size_t)job->args->top;
    noc_reach reach;
    noc_status status = find(job, &light);
    noc_reach_object *objects = cli_alloc(top * sizeof(*objects));
    status = status ? status : noc_view_reach(job->site.view, light, NULL, &reach, objects, top, &found);
    if (!status) {
        const noc_report_lamp *lamp = noc_report_find_lamp(job->site.report, reach.emitter.light);
        if (job->args->json) {
            print_json(job, &reach, lamp, objects, found);
        } else {
            print_lamp(job, &reach, lamp);
            print_reach(job, &reach, objects, found);
        }
    }
    free(objects);
    return status;
}
