/* Files that a client asks for: the picture of a pane, the view as a recipe, the table of a question. */
#include "viewer/session_parts.h"

#include "viewer/out.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

out_view session_view(const session *s, int which) {
    const pane *of = &s->panes.pane[which];
    return (out_view){ .source = s->setup->source,
                       .world = s->setup->world,
                       .look = &of->look,
                       .camera = &s->mover.camera,
                       .width = s->width ? s->width : 1280,
                       .height = s->height ? s->height : 720,
                       .frames = of->stats.frames,
                       .bar = &of->bar };
}

/* false: there is no memory to send it. */
static bool send_file(session *s, uint32_t id, const char *name, uint64_t frames, const void *data, size_t size) {
    size_t length = strlen(name);
    unsigned char *message = malloc(OUTBOX_ROOM + WIRE_HEAD + length + size), *at = message;
    if (!message)
        return false;
    at += OUTBOX_ROOM;
    wire_head head = { .kind = WIRE_IS_FILE, .number = id, .frames = (uint32_t)frames, .name_size = (uint32_t)length };
    wire_write_head(&head, at);
    memcpy(at + WIRE_HEAD, name, length);
    memcpy(at + WIRE_HEAD + length, data, size);
    outbox_binary(s->box, id, message, WIRE_HEAD + length + size);
    return true;
}

static bool save_picture(session *s, uint32_t id, int which, bool exr, char *why, size_t size) {
    unsigned char *data;
    size_t bytes;
    noc_view *of = which >= 0 && which < s->panes.count ? s->panes.pane[which].view : NULL;
    snprintf(why, size, "that pane has no picture of its own");
    if (!of || !s->width || !session_complete(s, which))
        return false;
    out_view view = session_view(s, which);
    view.width = s->panes.pane[which].width;
    view.height = s->panes.pane[which].height;
    if (!out_picture(&view, of, exr, &data, &bytes, why, size))
        return false;
    snprintf(why, size, "there is no memory to send the picture");
    bool sent = send_file(s, id, exr ? "night.exr" : "night.png", view.frames, data, bytes);
    free(data);
    return sent;
}

static bool save_recipe(session *s, const wire_message *m, char *why, size_t size) {
    out_bookmark bookmarks[WIRE_CAMERAS];
    for (int i = 0; i < m->save.cameras; i++) {
        const wire_camera *c = &m->save.camera[i];
        out_bookmark *b = &bookmarks[i];
        *b = (out_bookmark){ c->name, noc_camera_default() };
        memcpy(b->camera.eye, c->eye, sizeof(c->eye));
        memcpy(b->camera.target, c->target, sizeof(c->target));
        b->camera.fov_deg = c->fov;
    }
    out_view view = session_view(s, 0);
    char *text = out_recipe(&view, bookmarks, (size_t)m->save.cameras, why, size);
    if (!text)
        return false;
    snprintf(why, size, "there is no memory to send the recipe");
    bool sent = send_file(s, m->save.id, "view.yaml", 0, text, strlen(text));
    free(text);
    return sent;
}

static bool save_table(session *s, const wire_message *m, char *why, size_t size) {
    char *csv = s->asker ? asker_csv(s->asker, m->save.of) : NULL;
    snprintf(why, size, "that question has no table, or it is long ago");
    bool sent = csv && send_file(s, m->save.id, "lights.csv", 0, csv, strlen(csv));
    free(csv);
    return sent;
}

bool session_save(session *s, const wire_message *m, char *why, size_t size) {
    switch (m->save.what) {
    case WIRE_PNG: return save_picture(s, m->save.id, m->save.pane, false, why, size);
    case WIRE_EXR: return save_picture(s, m->save.id, m->save.pane, true, why, size);
    case WIRE_RECIPE: return save_recipe(s, m, why, size);
    case WIRE_CSV: return save_table(s, m, why, size);
    }
    return false;
}
