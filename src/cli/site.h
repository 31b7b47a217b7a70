/* A city whose light is queried: what `influence` and `measure` share. */
#ifndef NOC_CLI_SITE_H
#define NOC_CLI_SITE_H

#include "render.h"

/* What cli_site_open makes. cli_site_run destroys it. */
typedef struct cli_site {
    noc_log *log;
    noc_scene *scene;
    noc_scene_info info;
    noc_report *report;
    noc_device *device;
    noc_view *view;
    noc_camera camera;
} cli_site;

/* Defaults of the member `render`, and the tables of its options: those of a command with arguments `type`. */
#define CLI_SITE_DEFAULTS(of)                                                                                          \
    {                                                                                                                  \
        .command = &(of), .camera = noc_camera_default_params(), .exposure = "auto", .device = CLI_DEVICE,             \
        .render = noc_render_default_params(), .display = noc_display_default_params(),                                \
        .import = noc_import_default_params(), .builtin = noc_builtin_default_params()                                 \
    }
#define CLI_SITE_SETS(type)                                                                                            \
    { noc_device_options, offsetof(type, render.device), NULL }, { cli_camera_options, offsetof(type, render), NULL }, \
        { noc_camera_options, offsetof(type, render.camera), NULL },                                                   \
        { noc_render_options, offsetof(type, render.render), cli_of_pictures },                                        \
        { noc_import_options, offsetof(type, render.import), NULL },                                                   \
        { noc_city_options, offsetof(type, render.builtin.city), NULL },                                               \
        { noc_builtin_options, offsetof(type, render.builtin), NULL }, {                                               \
        cli_common_options, 0, NULL                                                                                    \
    }
#define CLI_SITE_NEEDED "which city? builtin:city is the built-in one" /* an error where there are no inputs */

/* Checks inputs, camera and device, and adds the inputs that options name. Reads no file but a recipe. Returns CLI_OK,
 * or an exit status after reporting. */
int cli_site_check(render_args *args);
/* Loads the inputs and makes a view of them, showing progress. `dark_windows`: all windows are switched off. `output`:
 * the file that will be written; one that the city is made of is an error. NULL: none. */
noc_status cli_site_open(cli_site *site, render_args *args, bool dark_windows, const char *output);
/* Prints the members of a JSON object, after others, that tell what figures rest on: lamps_left_out, assumed, inputs.
 */
void cli_site_json(const cli_site *site, const render_args *args);
/* Fills `site` with a log alone, calls `work`, which may open it, and destroys all that is in it. Tells on
 * standard error what was assumed, left out and guessed at. Returns the exit status, after reporting an interruption.
 */
int cli_site_run(cli_site *site, render_args *args, noc_status (*work)(void *job), void *job);

#endif
