#include "render.h"

#include <math.h>
#include <string.h>

int cli_choose_camera(render_args *args) {
    const noc_recipe_camera *camera = cli_recipe_camera(&args->common, args->camera_name);
    static const char *const others[] = { "view", "eye", "target", "camera-crs", "photo-points" };
    if (args->camera_name && !args->common.recipe)
        return cli_usage(args->command, "--camera is for a recipe among the inputs");
    if (args->camera_name && !camera) {
        const noc_recipe_info *recipe = noc_recipe_get_info(args->common.recipe);
        const char *names[64];
        size_t count = recipe->camera_count < 64 ? recipe->camera_count : 64;
        for (size_t i = 0; i < count; i++)
            names[i] = recipe->cameras[i].name;
        const char *nearest = noc_text_nearest(args->camera_name, names, count);
        return cli_usage(args->command, "--camera: %.200s has no camera \"%.60s\"%s%.60s%s", recipe->path,
                         args->camera_name, nearest ? "; is it " : "", nearest ? nearest : "", nearest ? "?" : "");
    }
    for (size_t i = 0; i < sizeof(others) / sizeof(*others); i++) {
        if (!cli_given(&args->common, others[i]))
            continue;
        if (args->camera_name)
            return cli_usage(args->command, "--camera and --%s exclude each other", others[i]);
        return CLI_OK;
    }
    double fov = args->camera.fov;
    if (camera)
        args->camera = camera->params;
    if (camera && cli_given(&args->common, "fov"))
        args->camera.fov = fov;
    return CLI_OK;
}

/* All that can be wrong with it before the scene is there. */
int cli_check_camera(const render_args *args) {
    const noc_camera_params *c = &args->camera;
    double eye[3], target[3];
    if (c->eye && !noc_text_numbers(c->eye, ',', 3, eye))
        return cli_usage(args->command, "--eye: \"%.60s\" is not X,Y,Z", c->eye);
    if (c->target && !noc_text_numbers(c->target, ',', 3, target))
        return cli_usage(args->command, "--target: \"%.60s\" is not X,Y,Z", c->target);
    if (!c->eye != !c->target)
        return cli_usage(args->command, "--%s needs --%s too", c->eye ? "eye" : "target", c->eye ? "target" : "eye");
    if (c->eye && cli_given(&args->common, "view"))
        return cli_usage(args->command, "--view and --eye exclude each other");
    if (c->photo_points && (c->eye || c->fov > 0 || cli_given(&args->common, "view")))
        return cli_usage(args->command, "--photo-points and --%s exclude each other",
                         c->eye       ? "eye"
                         : c->fov > 0 ? "fov"
                                      : "view");
    if (c->crs && !c->eye && !c->photo_points)
        return cli_usage(args->command, "--camera-crs is for --eye and --target, and for --photo-points");
    if (!c->eye)
        return CLI_OK;
    /* Local coordinates go as far as the library's cameras; those of a CRS may have a zone before them. */
    double limit = c->crs ? 1e9 : 1e7;
    for (int k = 0; k < 3; k++)
        if (!(fabs(eye[k]) < limit && fabs(target[k]) < limit))
            return cli_usage(args->command, "--%s: \"%.60s\" is more than %g km away",
                             fabs(eye[k]) < limit ? "target" : "eye", fabs(eye[k]) < limit ? c->target : c->eye,
                             limit / 1000);
    if (!memcmp(eye, target, sizeof(eye)))
        return cli_usage(args->command, "--eye and --target are the same place");
    return CLI_OK;
}

void cli_tell_photo(const render_args *args, const noc_scene *scene) {
    const noc_camera_params *c = &args->camera;
    noc_photo_info info;
    noc_camera camera;
    if (!c->photo_points || args->common.quiet ||
        noc_scene_photo_camera(scene, c->photo_points, c->crs, &camera, &info))
        return;
    cli_error(
        "camera of a photograph: %zu points, %.1f of its pixels off on average; eye %.2f,%.2f,%.2f, field of view "
        "%.1f degrees",
        info.points, info.residual, camera.eye[0], camera.eye[1], camera.eye[2], camera.fov_deg);
}
