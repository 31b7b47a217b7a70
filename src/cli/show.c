/* nocturne render --show: a view of how lights were sampled, or of what is seen, in the picture's place. */
#include "render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define A render_args
#define TEXT(n, f, u, h)                                                                                               \
    { n, "Mode", NOC_OPTION_TEXT, offsetof(A, f), 0, 0, NULL, u, h }

const noc_option *cli_show_options(void) {
    static const noc_option rows[] = {
        { "show", "Mode", NOC_OPTION_CHOICE, offsetof(A, show), 0, 0,
          "picture|lights|density|light|weight|confidence|rays|variance|error|depth|normal|class|object|group|placed|"
          "motion|luminance|illuminance|"
          "influential|influential-share|runner-up|runner-up-share|expected",
          "", "the picture, or in its place a view of light, sampling or surfaces" },
        TEXT("show-range", show_range, "LOW,HIGH", "ends of the view's colour bar; else found from its numbers"),
        { "show-scale", "Mode", NOC_OPTION_CHOICE, offsetof(A, range.scale), 0, 0, "auto|linear|log", "",
          "steps of the colour bar; auto: what suits the view" },
        TEXT("isolines", isolines, "LIST",
             "contours of a view: at 1,2,5 (at one: 5,), or N of them at round values; 0 = none"),
        { NULL },
    };
    return rows;
}

/* The option's choices are "picture" and then the views in their order. */
static noc_aov shown(const render_args *args) { return (noc_aov)(args->show - 1); }

/* Neither names nor directions. */
static bool has_bar(noc_aov aov) {
    noc_aov_info info = noc_aov_get_info(aov);
    return info.scale != NOC_CHANNEL_LABELS && info.components == 1;
}

/* LOW,HIGH of a bar that may begin at 0 where it is linear. */
static int parse_range(render_args *args) {
    double ends[2] = { 0, 0 };
    if (!args->show_range)
        return CLI_OK;
    if (!noc_text_numbers(args->show_range, ',', 2, ends) || !(ends[0] >= 0 && ends[0] < ends[1]))
        return cli_usage(args->command, "--show-range: \"%.60s\" is not LOW,HIGH, the lower one first",
                         args->show_range);
    bool logarithmic = args->range.scale == NOC_BAR_OF_CHANNEL ? noc_aov_get_info(shown(args)).scale == NOC_CHANNEL_LOG
                                                               : args->range.scale == NOC_BAR_LOG;
    if (logarithmic && !(ends[0] > 0))
        return cli_usage(args->command,
                         "--show-range: the bar of --show %s is logarithmic, and begins above 0; "
                         "--show-scale linear begins at 0",
                         noc_aov_name(shown(args)));
    args->range.low = ends[0];
    args->range.high = ends[1];
    return CLI_OK;
}

static int parse_isolines(render_args *args) {
    if (!args->isolines || noc_isolines_parse(args->isolines, &args->range.isolines))
        return CLI_OK;
    return cli_usage(args->command,
                     "--isolines: \"%.60s\" is neither rising values, 1,2,5, nor a number of lines, 0 to %d",
                     args->isolines, NOC_ISOLINES);
}

int cli_parse_show(render_args *args) {
    bool bar = args->show && has_bar(shown(args));
    const char *of_bars = args->show_range    ? "show-range"
                          : args->isolines    ? "isolines"
                          : args->range.scale ? "show-scale"
                                              : NULL;
    if (of_bars && !bar)
        return cli_usage(args->command, "--%s is for views that have a colour bar: --show illuminance, for one",
                         of_bars);
    if (!args->show)
        return CLI_OK;
    int status = parse_range(args);
    status = status ? status : parse_isolines(args);
    if (status)
        return status;
    bool still = args->command == &cli_render; /* in the viewer there are always more */
    bool of_many = shown(args) == NOC_AOV_VARIANCE || shown(args) == NOC_AOV_ERROR;
    if (still && of_many && args->frames < 2 && !(args->time > 0))
        return cli_usage(args->command, "--show %s needs two frames or more", noc_aov_name(shown(args)));
    args->render.aovs = 1u << shown(args);
    args->render.gloss = args->render.gloss && shown(args) != NOC_AOV_ILLUMINANCE;
    noc_log *log = cli_log_create(&args->common);
    noc_status checked = noc_render_check(&args->render, log);
    noc_log_destroy(log);
    return checked ? CLI_USAGE : CLI_OK;
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

/* Labels of a view's numbers, most frequent first; *count of them. v: n of the numbers, rising. */
static label *count_labels(const float *v, size_t n, size_t *count) {
    label *labels = cli_alloc((n + 1) * sizeof(*labels));
    *count = 0;
    for (size_t i = 0; i < n; i++) {
        if (!i || v[i] != v[i - 1])
            labels[(*count)++] = (label){ (size_t)v[i], 0 };
        labels[*count - 1].pixels++;
    }
    qsort(labels, *count, sizeof(*labels), compare_labels);
    return labels;
}

/* The numbers of a view that has one a pixel, rising. */
static float *sorted_numbers(const noc_channel *view, size_t *n) {
    size_t pixels = (size_t)view->width * (size_t)view->height;
    float *v = cli_alloc((pixels + 1) * sizeof(*v));
    *n = 0;
    for (size_t i = 0; i < pixels; i++)
        if (view->value[i] >= 0)
            v[(*n)++] = view->value[i];
    qsort(v, *n, sizeof(*v), compare_values);
    return v;
}

/* How a light is called: by its name where that is a lamp's id, else with its number, too. */
static char *light_text(const render_job *job, size_t light) {
    noc_light_info info;
    char text[40] = "";
    if (noc_scene_get_light(job->scene, light, &info) != NOC_OK || info.removed)
        return cli_format("light %zu", light);
    if (info.light.name)
        noc_text_clean(text, sizeof(text), info.light.name);
    if (info.lamp && strpbrk(text, "0123456789"))
        return cli_format("%s", text);
    return cli_format("%s %zu", *text ? text : info.lamp ? "lamp" : "light", light);
}

/* Names of the lights that are shown most, for the legend. */
static void name_lights(render_job *job) {
    enum { NAMED = 12 };
    size_t n, count;
    float *v = sorted_numbers(job->shown, &n);
    label *labels = count_labels(v, n, &count);
    job->label_count = count < NAMED ? count : NAMED;
    job->labels = cli_alloc((job->label_count + 1) * sizeof(*job->labels));
    job->label_numbers = cli_alloc((job->label_count + 1) * sizeof(*job->label_numbers));
    for (size_t i = 0; i < job->label_count; i++) {
        job->labels[i] = light_text(job, labels[i].number);
        job->label_numbers[i] = (uint32_t)labels[i].number;
    }
    free(labels);
    free(v);
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
    free(job->label_numbers);
    job->labels = NULL;
    job->label_numbers = NULL;
    job->label_count = 0;
}

noc_status cli_write_view(render_job *job, const noc_image_meta *meta) {
    cli_drop_view(job); /* of an animation's picture before */
    job->shown = noc_view_aov(job->view, shown(job->args));
    noc_aov aov = shown(job->args);
    bool lights = aov == NOC_AOV_INFLUENTIAL || aov == NOC_AOV_RUNNER_UP || aov == NOC_AOV_LIGHT;
    if (job->shown && (lights || aov == NOC_AOV_GROUP)) {
        (lights ? name_lights : name_groups)(job);
        job->shown->label_numbers = job->label_numbers;
        job->shown->labels = (const char *const *)job->labels;
        job->shown->label_count = job->label_count;
    }
    return job->shown ? noc_channel_write(job->shown, job->file, &job->args->range, meta, job->log) : NOC_ERR_MEMORY;
}

static const char *name_of(const render_job *job, size_t number) {
    for (size_t i = 0; job->label_numbers && i < job->label_count; i++)
        if (job->label_numbers[i] == number)
            return job->labels[i];
    if (!job->label_numbers && number < job->shown->label_count)
        return job->shown->labels[number];
    return shown(job->args) == NOC_AOV_OBJECT ? noc_scene_object_name(job->scene, number) : NULL;
}

/* What the largest of them are, by name, and their shares of all pixels. v: n of the numbers, rising. */
static void print_names(const render_job *job, const float *v, size_t n, size_t pixels) {
    enum { SHOWN = 20 };
    size_t count, told = 0;
    label *labels = count_labels(v, n, &count);
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
    float *v = sorted_numbers(view, &n);
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
