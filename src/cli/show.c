/* nocturne render --show: a view of how lights were sampled, or of what is seen, in the picture's place. */
#include "render.h"

#include <stdlib.h>
#include <string.h>

/* The option's choices are "picture" and then the views in their order. */
static noc_aov shown(const render_args *args) { return (noc_aov)(args->show - 1); }

int cli_parse_show(render_args *args) {
    bool names = args->show && (shown(args) == NOC_AOV_LIGHT || shown(args) >= NOC_AOV_NORMAL); /* and directions */
    if (args->show_range && (!args->show || names))
        return cli_usage(&cli_render, "--show-range is for views that have a colour bar: --show lights, for one");
    if (!args->show)
        return CLI_OK;
    double ends[2] = { 0, 0 };
    if (args->show_range && (!noc_text_numbers(args->show_range, ',', 2, ends) || !(ends[0] >= 0 && ends[0] < ends[1])))
        return cli_usage(&cli_render, "--show-range: \"%.60s\" is not LOW,HIGH, the lower one first", args->show_range);
    args->range = (noc_channel_params){ ends[0], ends[1] };
    if ((shown(args) == NOC_AOV_VARIANCE || shown(args) == NOC_AOV_ERROR) && args->frames < 2 && !(args->time > 0))
        return cli_usage(&cli_render, "--show %s needs two frames or more", noc_aov_name(shown(args)));
    args->render.aovs = 1u << shown(args);
    noc_log *log = cli_log_create(&args->common);
    noc_status status = noc_render_check(&args->render, log);
    noc_log_destroy(log);
    return status ? CLI_USAGE : CLI_OK;
}

/* Names of the scene's groups, for the legend. */
static void name_groups(render_job *job) {
    size_t count = noc_scene_groups(job->scene, NULL, 0);
    noc_group_info *groups = cli_alloc(count * sizeof(*groups));
    noc_scene_groups(job->scene, groups, count);
    job->labels = cli_alloc(count * sizeof(*job->labels));
    for (size_t i = 0; i < count; i++) {
        char text[48];
        job->labels[i] = cli_format("%s", i ? noc_text_clean(text, sizeof(text), groups[i].name) : "others");
    }
    job->label_count = count;
    free(groups);
}

void cli_drop_view(render_job *job) {
    noc_channel_destroy(job->shown);
    job->shown = NULL;
    for (size_t i = 0; i < job->label_count; i++)
        free(job->labels[i]);
    free(job->labels);
    job->labels = NULL;
    job->label_count = 0;
}

noc_status cli_write_view(render_job *job, const noc_image_meta *meta) {
    cli_drop_view(job); /* of an animation's picture before */
    job->shown = noc_view_aov(job->view, shown(job->args));
    if (job->shown && shown(job->args) == NOC_AOV_GROUP) {
        name_groups(job);
        job->shown->labels = (const char *const *)job->labels;
        job->shown->label_count = job->label_count;
    }
    return job->shown ? noc_channel_write(job->shown, job->file, &job->args->range, meta, job->log) : NOC_ERR_MEMORY;
}

static int compare_values(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* A number of a view that is a name, and how many pixels have it. */
typedef struct label {
    size_t number, pixels;
} label;

static int compare_labels(const void *a, const void *b) {
    const label *x = a, *y = b;
    return x->pixels != y->pixels ? (x->pixels < y->pixels ? 1 : -1)
                                  : (x->number > y->number) - (x->number < y->number);
}

static const char *name_of(const render_job *job, size_t number) {
    if (number < job->shown->label_count)
        return job->shown->labels[number];
    return shown(job->args) == NOC_AOV_OBJECT ? noc_scene_object_name(job->scene, number) : NULL;
}

/* What the largest of them are, by name, and their shares of all pixels. v: n of the numbers, rising. */
static void print_names(const render_job *job, const float *v, size_t n, size_t pixels) {
    enum { SHOWN = 20 };
    label *labels = cli_alloc((n + 1) * sizeof(*labels));
    size_t count = 0, told = 0;
    for (size_t i = 0; i < n; i++) {
        if (!i || v[i] != v[i - 1])
            labels[count++] = (label){ (size_t)v[i], 0 };
        labels[count - 1].pixels++;
    }
    qsort(labels, count, sizeof(*labels), compare_labels);
    for (size_t i = 0; i < count && told < SHOWN; i++) {
        const char *name = name_of(job, labels[i].number);
        char text[48];
        if (name && *name)
            printf("%s%zu %s %.1f%%",
                   !told      ? "            "
                   : told % 4 ? ", "
                              : ",\n            ",
                   labels[i].number, noc_text_clean(text, sizeof(text), name),
                   100.0 * (double)labels[i].pixels / (double)pixels);
        told += name && *name;
    }
    if (told)
        putchar('\n');
    free(labels);
}

void cli_print_view_kind(const render_job *job, bool numbers) {
    const noc_channel *view = job->shown;
    printf("the view %s ", view->name);
    if (!numbers)
        puts("in colours, with a legend");
    else if (view->components > 1)
        puts("as vectors");
    else
        printf("as numbers%s%s\n",
               *view->unit                         ? " of unit "
               : view->scale == NOC_CHANNEL_LABELS ? " that stand for names"
                                                   : "",
               view->unit);
}

/* Figures of the numbers, for the summary. */
void cli_print_view(const render_job *job) {
    const noc_channel *view = job->shown;
    size_t pixels = (size_t)view->width * (size_t)view->height, n = 0, different = 0;
    if (view->components > 1) {
        printf("  view      %s\n", view->title);
        return;
    }
    float *v = cli_alloc(pixels * sizeof(*v));
    for (size_t i = 0; i < pixels; i++)
        if (view->value[i] >= 0)
            v[n++] = view->value[i];
    qsort(v, n, sizeof(*v), compare_values);
    for (size_t i = 0; i < n; i++)
        different += !i || v[i] != v[i - 1];
    char text[32];
    if (!n)
        printf("  view      %s: no pixel has a value\n", view->name);
    else if (view->scale == NOC_CHANNEL_LABELS)
        printf("  view      %s: %s different ones, none in %.1f%% of the pixels\n", view->name,
               noc_text_count(text, different), 100.0 * (double)(pixels - n) / (double)pixels);
    else
        printf(
            "  view      %s: median %.4g, 1%% of the values under %.4g and over %.4g; none in %.1f%% of the pixels\n",
            view->name, (double)v[n / 2], (double)v[n / 100], (double)v[n - 1 - n / 100],
            100.0 * (double)(pixels - n) / (double)pixels);
    if (view->scale == NOC_CHANNEL_LABELS)
        print_names(job, v, n, pixels);
    free(v);
}
