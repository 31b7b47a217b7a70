/* The smallest use of the library: a city at night into a PNG. README.md tells where pkg-config finds it.
 *   cc minimal.c $(pkg-config --cflags --libs nocturne) -o minimal && ./minimal night.png */
#include <nocturne/nocturne.h>
#include <stdio.h>

static void tell(void *user, noc_log_level level, const char *text) { fprintf(stderr, "%s\n", text); }

static noc_status draw(noc_scene *scene, noc_log *log, const char *path) {
    noc_render_params params = noc_render_default_params();
    params.width = 320;
    params.height = 180;

    noc_camera camera;
    noc_status status = noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, (double)params.width / params.height, &camera);
    if (status)
        return status;
    noc_device *device = noc_device_create(&noc_device_default_params(), log);
    noc_view *view = noc_view_create(device, scene);
    if (!view)
        status = NOC_ERR_MEMORY;
    for (int frame = 0; frame < 8 && !status; frame++)
        status = noc_view_render(view, &camera, &params, NULL);

    noc_image *image = status ? NULL : noc_view_image(view);
    if (image)
        status = noc_image_write(image, path, &noc_display_default_params(), NULL, log);
    noc_image_destroy(image);
    noc_view_destroy(view);
    noc_device_destroy(device);
    return status;
}

int main(int argc, char **argv) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = tell });
    noc_scene *scene = noc_scene_create(log);
    noc_city_params city = noc_city_default_params();
    city.size = 150;

    /* For real cities: noc_scene_load(scene, paths, count, &import_params, NULL), which also commits. */
    noc_status status = noc_scene_add_city(scene, &city);
    if (!status)
        status = noc_scene_commit(scene);
    if (!status)
        status = draw(scene, log, argc > 1 ? argv[1] : "minimal.png");

    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return status ? 1 : 0;
}
