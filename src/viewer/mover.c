#include "viewer/mover.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FARTHEST 1e6 /* m from the scene's origin: beyond that places are no city's, and floats too coarse */
#define NEAREST 1e-3 /* m from eye to target */

_Static_assert((int)WIRE_ORBIT == NOC_NAVIGATE_ORBIT && (int)WIRE_WALK == NOC_NAVIGATE_WALK,
               "modes are those of the library");
_Static_assert((int)WIRE_FORWARD == NOC_KEY_FORWARD && (int)WIRE_SLOW == NOC_KEY_SLOW, "and so are keys");

static noc_status cast(void *user, const noc_ray *rays, size_t count, noc_hit *hits) {
    return noc_view_cast(((mover *)user)->view, rays, count, hits);
}

/* In the order of noc_viewpoint. */
static const char *const found[] = { "street", "aerial", "overview", "own" };
enum { FOUND = sizeof(found) / sizeof(*found) };

static noc_status place(const mover *m, const noc_camera_params *params, double aspect, noc_camera *camera) {
    bool far;
    return noc_scene_place_camera(world_scene(m->world), params, aspect, camera, &far);
}

noc_status mover_init(mover *m, viewer_world *world, const viewer_source *source, double aspect) {
    *m = (mover){ .world = world, .source = source };
    size_t cameras = noc_recipe_get_info(source->recipe)->camera_count + FOUND;
    m->named = calloc(cameras, sizeof(*m->named));
    m->view = noc_view_create(world_device(world), world_scene(world));
    m->navigator = m->view && m->named ? noc_navigator_create(world_scene(world), cast, m) : NULL;
    noc_status status = m->navigator ? place(m, &source->camera, aspect, &m->camera) : NOC_ERR_MEMORY;
    status = status ? status : noc_navigator_set_mode(m->navigator, NOC_NAVIGATE_FLY);
    return status ? status : noc_navigator_set_camera(m->navigator, &m->camera);
}

void mover_finish(mover *m) {
    noc_navigator_destroy(m->navigator);
    noc_view_destroy(m->view);
    free(m->named);
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

void mover_arrive(mover *m, double aspect, double now) {
    char name[sizeof(m->name)];
    memcpy(name, m->name, sizeof(name));
    for (int i = 0; i < 10 && mover_moves(m); i++)
        step(m, &(noc_navigate_input){ .seconds = 1, .at = { 0.5, 0.5 }, .aspect = aspect }, now);
    memcpy(m->name, name, sizeof(name));
}

/* The camera of that name, of the recipe or found in the scene. It stays the same until the aspect is another one,
 * whatever is set of the lights. */
static bool find(mover *m, const char *name, double aspect, noc_camera *camera) {
    const noc_recipe_info *recipe = noc_recipe_get_info(m->source->recipe);
    noc_camera_params params = noc_camera_default_params();
    size_t at = 0;
    while (at < recipe->camera_count && strcmp(name, recipe->cameras[at].name))
        at++;
    if (at < recipe->camera_count)
        params = recipe->cameras[at].params;
    for (size_t i = 0; i < FOUND && at == recipe->camera_count + i; i++) {
        at += strcmp(name, found[i]) != 0;
        params.viewpoint = (noc_viewpoint)i;
    }
    if (at == recipe->camera_count + FOUND)
        return false;
    mover_named *named = &m->named[at];
    if (named->aspect != aspect) {
        named->aspect = aspect;
        named->there = !place(m, &params, aspect, &named->camera);
    }
    *camera = named->camera;
    return named->there;
}

static bool can_be(const noc_camera *c) {
    double along = 0;
    for (int k = 0; k < 3; k++) {
        along = hypot(along, c->target[k] - c->eye[k]);
        if (!(fabs(c->eye[k]) <= FARTHEST && fabs(c->target[k]) <= FARTHEST))
            return false;
    }
    return along >= NEAREST;
}

bool mover_go(mover *m, const wire_camera *to, double aspect, double now, char *why, size_t size) {
    noc_camera camera = noc_camera_default();
    m->stepped = now;
    if (!to->name) { /* whose links and paths say where, are there at once */
        memcpy(camera.eye, to->eye, sizeof(camera.eye));
        memcpy(camera.target, to->target, sizeof(camera.target));
        camera.fov_deg = to->fov;
        snprintf(why, size, "the camera looks nowhere, or is more than 1000 km away");
        if (!can_be(&camera))
            return false;
        *m->name = 0;
        bool there = !noc_navigator_set_camera(m->navigator, &camera);
        noc_navigator_camera(m->navigator, &m->camera);
        return there;
    }
    snprintf(why, size, "there is no such camera");
    if (!find(m, to->name, aspect, &camera))
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

bool mover_look(mover *m, const double place[3], double distance, double now, char *why, size_t size) {
    m->stepped = now;
    *m->name = 0;
    snprintf(why, size, "that place is seen from nowhere near");
    return noc_navigator_look(m->navigator, place, distance);
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
