/* What a client's messages do, and what is told of it. */
#include "viewer/session_parts.h"

#include "viewer/out.h"

#include <stdlib.h>
#include <string.h>

void session_note(session *s, const char *level, const char *text) {
    outbox_text(s->box, OUTBOX_NOTE, s->notes++ % 8, wire_note(level, text));
}

/* The line that renders what the first pane shows. */
static json_t *command_of(session *s) {
    out_view view = session_view(s, 0);
    char *line = out_command(&view);
    json_t *text = line ? wire_text(line) : NULL;
    free(line);
    return text;
}

static json_t *state_of(session *s, json_t *m) {
    json_object_set_new(m, "input", json_integer(s->input));
    json_object_set_new(m, "command", command_of(s));
    json_object_set_new(m, "camera", mover_camera(&s->mover));
    json_object_set_new(m, "navigate", mover_navigation(&s->mover));
    json_object_set_new(m, "layout", json_string(wire_layouts[s->panes.layout]));
    json_object_set_new(m, "panes", panes_state(&s->panes));
    json_object_set_new(m, "world", world_state(s->setup->world));
    return m;
}

void session_tell_state(session *s) {
    outbox_text(s->box, OUTBOX_STATE, 0, wire_end(state_of(s, wire_begin("state"))));
}

static bool in_recipe(const noc_recipe_info *recipe, const char *name) {
    for (size_t i = 0; i < recipe->camera_count; i++)
        if (!strcmp(recipe->cameras[i].name, name))
            return true;
    return false;
}

/* Cameras that it can go to by name: the recipe's, then those of other names that are found in the scene. */
static json_t *cameras(const session *s) {
    static const char *const found[] = { "own", "street", "aerial", "overview" };
    const noc_recipe_info *recipe = noc_recipe_get_info(s->setup->source->recipe);
    json_t *list = json_array();
    for (size_t i = 0; i < recipe->camera_count; i++)
        json_array_append_new(list, wire_text(recipe->cameras[i].name));
    for (size_t i = 0; i < sizeof(found) / sizeof(*found); i++)
        if (!in_recipe(recipe, found[i]))
            json_array_append_new(list, json_string(found[i]));
    return list;
}

static json_t *scene_of(const session *s) {
    noc_scene_info info;
    noc_scene_get_info(world_scene(s->setup->world), &info);
    const noc_recipe_info *recipe = noc_recipe_get_info(s->setup->source->recipe);
    const char *name = *recipe->name ? recipe->name : s->setup->source->said_count ? s->setup->source->said[0] : "";
    const double *lo = info.bounds_min, *hi = info.bounds_max;
    json_t *m = json_object();
    json_object_set_new(m, "name", wire_text(name));
    json_object_set_new(m, "crs", wire_text(info.given_crs));
    json_object_set_new(m, "bounds", json_pack("[[fff],[fff]]", lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]));
    json_object_set_new(m, "triangles", json_integer((json_int_t)info.triangles));
    json_object_set_new(m, "lights", json_integer((json_int_t)info.lights));
    json_object_set_new(m, "windows", json_integer((json_int_t)info.windows));
    json_object_set_new(m, "cars", json_integer((json_int_t)info.cars));
    return m;
}

/* "vulkan, NVIDIA GeForce RTX 3060" */
static json_t *device_of(const session *s) {
    const noc_device_info *device = noc_device_get_info(world_device(s->setup->world));
    char text[300];
    snprintf(text, sizeof(text), "%s, %s", noc_backend_name(device->backend), device->name);
    return wire_text(text);
}

void session_tell_welcome(session *s) {
    json_t *m = wire_begin("welcome"), *schema = json_object();
    json_object_set_new(schema, "look", look_schema(&s->panes.pane[0].look));
    json_object_set_new(schema, "world", world_schema(s->setup->world));
    json_object_set_new(schema, "modes", look_modes());
    json_object_set_new(m, "schema", schema);
    json_object_set_new(m, "cameras", cameras(s));
    json_object_set_new(m, "scene", scene_of(s));
    json_object_set_new(m, "device", device_of(s));
    json_object_set_new(m, "state", state_of(s, json_object()));
    outbox_text(s->box, OUTBOX_WELCOME, 0, wire_end(m));
}

double session_aspect(const session *s) { return s->width && s->height ? (double)s->width / s->height : 16.0 / 9; }

/* Pictures from now on show the message of that number; 0: it has none. */
static void number(session *s, uint32_t n) { s->input = n ? n : s->input; }

static void do_input(session *s, const wire_input *input) {
    number(s, input->n);
    mover_input(&s->mover, input, session_aspect(s), session_now());
    session_changed(s);
}

static void told(session *s, bool done, const char *why) {
    if (!done)
        session_note(s, "error", why);
    session_changed(s);
    s->told_less = true;
}

/* The same of a way that it goes. */
static void went(session *s, bool goes, bool still, const char *why) {
    if (goes && still)
        mover_arrive(&s->mover, session_aspect(s), session_now());
    told(s, goes, why);
}

static void do_jump(session *s, const wire_message *m) {
    const double at[2] = { m->jump.x, m->jump.y }, now = session_now();
    char why[256] = "";
    number(s, m->jump.n);
    bool goes = m->jump.has_place ? mover_look(&s->mover, m->jump.place, m->jump.distance, now, why, sizeof(why))
                                  : mover_jump(&s->mover, at, session_aspect(s), now, why, sizeof(why));
    went(s, goes, m->jump.still, why);
}

/* What only shows otherwise is shown so at once, and its mean goes on. */
static void do_set(session *s, const wire_message *m) {
    char why[256] = "";
    panes_need need;
    number(s, m->set.n);
    if (!panes_set(&s->panes, m->set.pane, m->set.name, m->set.value, &need, why, sizeof(why)))
        session_note(s, "error", why);
    if (need == PANES_ANEW)
        session_changed(s);
    s->redraw = s->redraw > (int)need + 1 ? s->redraw : (int)need + 1;
    session_wake(s);
    s->told_less = true;
}

static void do_world(session *s, const wire_message *m) {
    char why[256] = "";
    number(s, m->set.n);
    told(s, world_set(s->setup->world, m->set.name, m->set.value, why, sizeof(why)), why);
}

static void do_layout(session *s, const wire_message *m) {
    number(s, m->layout.n);
    told(s, !panes_set_layout(&s->panes, m->layout.name), "there is no memory for these panes");
}

static void do_ask(session *s, const wire_ask *ask) {
    const pane *of = &s->panes.pane[ask->pane < s->panes.count ? ask->pane : 0];
    ask_view view = { s->mover.camera, s->width ? s->width : 1280, s->height ? s->height : 720, of->look.render };
    asker **one = ask->what == WIRE_FIND || ask->what == WIRE_NAME ? &s->namer : &s->asker;
    if (!*one)
        *one = asker_create(s->setup->source, s->setup->world, s->box, &s->in);
    if (*one)
        asker_ask(*one, ask, &view);
    else
        session_note(s, "error", "there is no memory for questions");
}

void session_do(session *s, const wire_message *m) {
    char why[256] = "";
    double now = session_now();
    switch (m->kind) {
    case WIRE_HELLO:
        s->width = m->hello.width;
        s->height = m->hello.height;
        s->told_less = true; /* the command line has the size */
        session_changed(s);
        break;
    case WIRE_INPUT: do_input(s, &m->input); break;
    case WIRE_NAVIGATE:
        told(s, mover_navigate(&s->mover, m->navigate.mode, m->navigate.speed, now, why, sizeof(why)), why);
        break;
    case WIRE_CAMERA:
        number(s, m->camera.n);
        went(s, mover_go(&s->mover, &m->camera.to, session_aspect(s), now, why, sizeof(why)), m->camera.still, why);
        break;
    case WIRE_JUMP: do_jump(s, m); break;
    case WIRE_SET: do_set(s, m); break;
    case WIRE_WORLD: do_world(s, m); break;
    case WIRE_LAYOUT: do_layout(s, m); break;
    case WIRE_ASK: do_ask(s, &m->ask); break;
    case WIRE_CANCEL:
        if (s->asker)
            asker_cancel(s->asker, m->cancel);
        if (s->namer)
            asker_cancel(s->namer, m->cancel);
        break;
    case WIRE_SAVE:
        if (!session_save(s, m, why, sizeof(why)))
            session_note(s, "error", why);
        break;
    default: break;
    }
}
