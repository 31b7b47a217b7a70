/* A city whose light is queried: what `influence` and `measure` share. */
#include "site.h"

#include <stdlib.h>

int cli_site_check(render_args *args) {
    int status = cli_choose_camera(args);
    if (status)
        return status;
    cli_add_named(&args->common, &args->import);
    return cli_check_city(args);
}

/* Switches all windows off. */
static noc_status darken_windows(noc_scene *scene, const noc_window_params *given) {
    noc_window_params windows = *given;
    windows.lit_windows = 0;
    noc_status status = noc_scene_set_windows(scene, &windows);
    return status ? status : noc_scene_commit(scene);
}

noc_status cli_site_open(cli_site *site, render_args *args, bool dark_windows, const char *output) {
    const noc_progress progress = { cli_load_progress, NULL };
    site->scene = noc_scene_create(site->log);
    noc_status status = cli_load_city(args, site->scene, &progress, &site->report);
    cli_progress_clear();
    if (!status && cli_check_sources(site->scene, output))
        status = NOC_ERR_ARGUMENT;
    if (!status && dark_windows)
        status = darken_windows(site->scene, &args->import.window);
    if (!status)
        status = noc_scene_place_camera(site->scene, &args->camera, (double)args->render.width / args->render.height,
                                        &site->camera, NULL);
    noc_scene_get_info(site->scene, &site->info);
    site->device = status ? NULL : noc_device_create(&args->device, site->log);
    site->view = site->device ? noc_view_create(site->device, site->scene) : NULL;
    return status || site->view ? status : NOC_ERR_MEMORY;
}

/* What the figures rest on, after them: on standard error, because tables for programs are on the other. */
static void tell_doubts(const cli_site *site, const render_args *args) {
    noc_report_totals totals;
    noc_report_get_totals(site->report, &totals);
    char *assumed = cli_assumed(totals.lamps_assumed, &args->import), *doubts = cli_doubts(site->report);
    if (*assumed)
        cli_error("assumed of lamps: %s", assumed);
    if (*doubts)
        cli_error("inputs: %s", doubts);
    free(assumed);
    free(doubts);
}

void cli_site_json(const cli_site *site, const render_args *args) {
    noc_report_totals t;
    noc_report_get_totals(site->report, &t);
    char *assumed = cli_assumed(t.lamps_assumed, &args->import), *doubts = cli_doubts(site->report);
    printf(", \"lamps_left_out\": %zu, \"assumed\": ", t.lamps_dropped);
    cli_json_text(stdout, assumed);
    printf(", \"inputs\": ");
    cli_json_text(stdout, doubts);
    free(assumed);
    free(doubts);
}

int cli_site_run(cli_site *site, render_args *args, noc_status (*work)(void *job), void *job) {
    cli_catch_signals();
    cli_nothing_to_keep(true);
    cli_progress_start(args->common.quiet);
    *site = (cli_site){ .log = cli_log_create(&args->common) };
    noc_status failed = work(job);
    cli_nothing_to_keep(false);
    if (!failed && !cli_interrupted() && !args->common.quiet)
        tell_doubts(site, args);
    noc_view_destroy(site->view);
    noc_device_destroy(site->device);
    noc_report_destroy(site->report);
    noc_scene_destroy(site->scene);
    noc_log_destroy(site->log);
    if (cli_interrupted()) {
        cli_error("interrupted");
        return CLI_INTERRUPTED + cli_interrupted();
    }
    return failed ? CLI_FAILURE : cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
}
