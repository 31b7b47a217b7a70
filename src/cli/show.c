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
    if (args->show_range && (!cli_parse_numbers(args->show_range, ',', 2, ends) || !(ends[0] >= 0 && ends[0] < ends[1])))
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

noc_status cli_write_view(render_job *job, const noc_image_meta *meta) {
    job->view = noc_renderer_aov(job->renderer, shown(job->args));
    return job->view ? noc_channel_write(job->view, job->args->output, &job->args->range, meta, job->log) : NOC_ERR_MEMORY;
}

static int compare_values(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Figures of the numbers, for the summary. */
void cli_print_view(const render_job *job) {
    const noc_channel *view = job->view;
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
        printf("  view      %s: %s different ones, none in %.1f%% of the pixels\n", view->name, cli_count(text, different),
               100.0 * (double)(pixels - n) / (double)pixels);
    else
        printf("  view      %s: median %.4g, 1%% of the values under %.4g and over %.4g; none in %.1f%% of the pixels\n",
               view->name,
               (double)v[n / 2], (double)v[n / 100], (double)v[n - 1 - n / 100], 100.0 * (double)(pixels - n) / (double)pixels);
    free(v);
}
