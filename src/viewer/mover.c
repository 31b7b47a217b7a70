#include "viewer/mover.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

_Static_assert((int)WIRE_ORBIT == NOC_NAVIGATE_ORBIT && (int)WIRE_WALK == NOC_NAVIGATE_WALK,
               "modes are those of the library");
_Static_assert((int)WIRE_FORWARD == NOC_KEY_FORWARD && (int)WIRE_SLOW == NOC_KEY_SLOW, "and so are keys");

static noc_status cast(void *user, const noc_ray *rays, size_t count, noc_hit *hits) {
    return noc_view_cast(((mover *)user)->view, rays, count, hits);
}

static noc_status place(const mover *m, const noc_camera_params *params, double aspect, noc_camera *camera) {
    bool far;
    return noc_scene_place_camera(world_scene(m->world), params, aspect, camera, &far);
}

noc_status mover_init(mover *m, viewer_world *world, const viewer_source *source, double aspect) {
    *m = (mover){ .world = world, .source = source };
    m->view = noc_view_create(world_device(world), world_scene(world));
    m->navigator = m->view ? noc_navigator_create(world_scene(world), cast, m) : NULL;
    noc_status status = m->navigator ? place(m, &source->camera, aspect, &m->camera) : NOC_ERR_MEMORY;
    status = status ? status : noc_navigator_set_mode(m->navigator, NOC_NAVIGATE_FLY);
    return status ? status : noc_navigator_set_camera(m->navigator, &m->camera);
}

void mover_finish(mover *m) {
    noc_navigator_destroy(m->navigator);
    noc_view_destroy(m->view);
    *m = (mover){ 0 };
}

static void step(mover *m, const noc_navigate_input *input, double now) {
    noc_camera before = m->camera;
    noc_navigator_input(m->navigator, input, &m->camera);
    if (memcmp(&before, &m->camera, sizeof(before)) && !noc_navigator_moves(m->navigator))
        *m->name = 0;
    m->stepped = now;
}

void mover_input(mover *m, const wire_input *in, double aspect, double now) {
    noc_navigate_input input = {
        .seconds = in->seconds, .keys = in->keys, .zoom = in->zoom, .at = { 0.5, 0.5 }, .aspect = aspect
    };
    memcpy(input.turn, in->turn, sizeof(input.turn));
    memcpy(input.pan, in->pan, sizeof(input.pan));
    if (in->has_at)
        memcpy(input.at, in->at, sizeof(input.at));
    step(m, &input, now);
}

bool mover_moves(const mover *m) { return noc_navigator_moves(m->navigator); }

bool mover_advance(mover *m, double aspect, double now) {
    if (!mover_moves(m))
        return false;
    noc_navigate_input input = { .seconds = fmax(0, now - m->stepped), .at = { 0.5, 0.5 }, .aspect = aspect };
    char name[sizeof(m->name)];
    memcpy(name, m->name, sizeof(name));
    step(m, &input, now);
    memcpy(m->name, name, sizeof(name)); /* it is on its way to that one */
    return true;
}

/* The camera of that name, of the recipe or found in the scene. */
static bool find(const mover *m, const char *name, noc_camera_params *params) {
    static const char *const found[] = { "street", "aerial", "overview", "own" };
    const noc_recipe_info *recipe = noc_recipe_get_info(m->source->recipe);
    for (size_t i = 0; i < recipe->camera_count; i++)
        if (!strcmp(name, recipe->cameras[i].name)) {
            *params = recipe->cameras[i].params;
            return true;
        }
    for (size_t i = 0; i < sizeof(found) / sizeof(*found); i++)
        if (!strcmp(name, found[i])) {
            *params = noc_camera_default_params();
            params->viewpoint = (noc_viewpoint)i;
            return true;
        }
    return false;
}

bool mover_go(mover *m, const wire_camera *to, double aspect, double now, char *why, size_t size) {
    noc_camera_params params;
    noc_camera camera = noc_camera_default();
    m->stepped = now;
    if (!to->name) { /* whose links and paths say where, are there at once */
        memcpy(camera.eye, to->eye, sizeof(camera.eye));
        memcpy(camera.target, to->target, sizeof(camera.target));
        camera.fov_deg = to->fov;
        *m->name = 0;
        snprintf(why, size, "the camera looks nowhere");
        bool there = !noc_navigator_set_camera(m->navigator, &camera);
        noc_navigator_camera(m->navigator, &m->camera);
        return there;
    }
    snprintf(why, size, "there is no such camera");
    if (!find(m, to->name, &params) || place(m, &params, aspect, &camera))
        return false;
    snprintf(m->name, sizeof(m->name), "%s", to->name);
    return !noc_navigator_go(m->navigator, &camera);
}

bool mover_jump(mover *m, const double at[2], double aspect, double now, char *why, size_t size) {
    m->stepped = now;
    *m->name = 0;
    snprintf(why, size, "nothing is there to go to");
    return noc_navigator_jump(m->navigator, at, aspect);
}

bool mover_navigate(mover *m, wire_mode mode, double speed, double now, char *why, size_t size) {
    m->stepped = now;
    noc_navigator_set_speed(m->navigator, speed);
    snprintf(why, size, "there is no place to stand here");
    bool done = (int)mode == (int)noc_navigator_mode(m->navigator) ||
                !noc_navigator_set_mode(m->navigator, (noc_navigate_mode)mode);
    noc_navigator_camera(m->navigator, &m->camera);
    return done;
}

json_t *mover_camera(const mover *m) {
    const noc_camera *c = &m->camera;
    return json_pack("{s:s,s:[fff],s:[fff],s:f}", "name", m->name, "eye", c->eye[0], c->eye[1], c->eye[2], "target",
                     c->target[0], c->target[1], c->target[2], "fov", c->fov_deg);
}

json_t *mover_navigation(const mover *m) {
    return json_pack("{s:s,s:f}", "mode", noc_navigate_mode_name(noc_navigator_mode(m->navigator)), "speed",
                     noc_navigator_speed(m->navigator));
}
