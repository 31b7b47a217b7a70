/* What is set becomes staged edits of the scene: each by the table of edits, none of them builds anything anew. */
#include "viewer/world_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Those that rain makes wet, as a load with --wet does. */
const noc_class world_rained[] = { NOC_CLASS_ROAD, NOC_CLASS_SIDEWALK, NOC_CLASS_TERRAIN, NOC_CLASS_GROUND };

static bool is_rained(const viewer_world *w, int cls) {
    for (int i = 0; i < WORLD_RAINED && w->import.wet && !w->rain_fixed; i++)
        if ((int)world_rained[i] == cls)
            return true;
    return false;
}

static bool same_look(const noc_material *a, const noc_material *b) {
    return !memcmp(a->albedo, b->albedo, sizeof(a->albedo)) && a->f0 == b->f0 && a->roughness == b->roughness &&
           a->texture == b->texture;
}

/* Each material of the class as inputs have it. */
static noc_status uncover(viewer_world *w, int cls) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < w->info.materials && !status; i++) {
        noc_material now;
        if ((int)w->materials[i].cls != cls || noc_scene_get_material(w->scene, (int)i, &now, NULL))
            continue;
        if (!same_look(&now, &w->materials[i]))
            status = noc_scene_set_material(w->scene, (int)i, &w->materials[i]);
    }
    return status;
}

/* Those that a recipe names stand over their class, as they do in a load. */
static noc_status uncover_named(viewer_world *w, int cls) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < w->info.materials && !status; i++)
        if (w->named[i] && (int)w->materials[i].cls == cls)
            status = noc_scene_set_material(w->scene, (int)i, &w->materials[i]);
    return status;
}

static noc_status stage_class(viewer_world *w, int cls) {
    class_look *c = &w->classes[cls];
    noc_material m = c->is;
    bool cover = is_rained(w, cls) || !same_look(&c->is, &c->was);
    if (is_rained(w, cls))
        m = noc_material_wet(&m);
    noc_status status = NOC_OK;
    if (cover)
        status = noc_scene_set_class_material(w->scene, (noc_class)cls, &m);
    if (cover && !status)
        status = uncover_named(w, cls);
    if (!cover && c->covered)
        status = uncover(w, cls);
    if (!status) {
        c->covered = cover;
        c->dirty = false;
    }
    return status;
}

static noc_status stage_group(viewer_world *w, group *g) {
    char text[80], scale[40] = "off";
    if (g->is.on)
        snprintf(scale, sizeof(scale), "%.17g", g->is.scale);
    snprintf(text, sizeof(text), "%s%s%s", scale, g->recoloured ? "," : "", g->recoloured ? g->is.colour : "");
    noc_status status = noc_scene_say_group(w->scene, g->index, text);
    if (!status)
        g->dirty = g->recoloured = false;
    return status;
}

/* The cars stand where they were while they are out of sight: nobody sees them drive. */
static noc_status stage_cars(viewer_world *w) {
    noc_status status = NOC_OK;
    if (!w->info.cars)
        return NOC_OK;
    if (w->own.traffic && w->dirty & (DIRTY_TIME | DIRTY_TRAFFIC))
        status = noc_scene_set_time(w->scene, w->import.cars.time);
    if (!status && w->dirty & DIRTY_TRAFFIC)
        status = noc_scene_show_cars(w->scene, w->own.traffic);
    return status;
}

noc_status world_stage(viewer_world *w) {
    noc_status status = NOC_OK;
    if (w->dirty & DIRTY_WINDOWS)
        status = noc_scene_set_windows(w->scene, &w->import.window);
    status = status ? status : stage_cars(w);
    for (size_t i = 0; i < w->group_count && !status; i++)
        if (w->groups[i].dirty)
            status = stage_group(w, &w->groups[i]);
    for (int c = 0; c < NOC_CLASS_COUNT && !status; c++)
        if (w->classes[c].dirty)
            status = stage_class(w, c);
    w->dirty = 0;
    return status;
}
