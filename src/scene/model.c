/* Models and their instances: meshes and lights in coordinates of their own, placed in the world. */
#include "scene/scene.h"

#include <math.h>

int noc_scene_add_model(noc_scene *scene, const char *name) {
    if (!scene) {
        noc_null(NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    noc_scene *to = noc_scene_adding(scene);
    if (!to)
        return -1;
    size_t models = scene->models.len + (to == scene ? 0 : to->models.len);
    if (models == UINT16_MAX) {
        noc_error(scene->log, NOC_ERR_UNSUPPORTED, "model %s: more than 65535 models in a scene",
                  name ? name : "unnamed");
        return -1;
    }
    noc_scene_model m = { .bounds_min = { INFINITY, INFINITY, INFINITY },
                          .bounds_max = { -INFINITY, -INFINITY, -INFINITY } };
    if (!noc_scene_keep_name(scene, name, &m.name))
        return -1;
    if (!array_push(&to->models, m)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    return (int)models + 1;
}

bool noc_transform_fits(const double in[12], double slack) {
    double c[3][3], square[3]; /* columns */
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++)
            c[k][i] = in[4 * i + k];
        square[k] = c[k][0] * c[k][0] + c[k][1] * c[k][1] + c[k][2] * c[k][2];
        if (!(fabs(in[4 * k + 3]) < 1e7 * slack))
            return false;
    }
    double scale = sqrt(square[0]), most = 1e-4 * slack * square[0], turn = 0;
    if (!(scale * slack >= 1e-3 && scale <= 1e3 * slack))
        return false;
    for (int k = 0; k < 3; k++) {
        const double *a = c[k], *b = c[(k + 1) % 3];
        if (!(fabs(square[k] - square[0]) <= 2 * most && fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) <= most))
            return false;
        turn += c[0][k] * (c[1][(k + 1) % 3] * c[2][(k + 2) % 3] - c[1][(k + 2) % 3] * c[2][(k + 1) % 3]);
    }
    return turn > 0;
}

static bool read_transform(const double in[12], float out[12]) {
    for (int i = 0; i < 12; i++)
        out[i] = (float)in[i];
    return noc_transform_fits(in, 1);
}

static const char bad_transform[] = "its transform is not a rotation, one scale in 0.001..1000 and a place within "
                                    "10 000 km of the origin";

int noc_scene_add_instance(noc_scene *scene, const noc_instance *instance) {
    if (!scene || !instance) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    noc_edit edit = { .kind = NOC_EDIT_ADD_INSTANCE,
                      .index = noc_slot_next(&scene->instance_slots, scene->instances.len),
                      .model = (uint32_t)instance->model };
    const char *wrong = noc_scene_model_of(scene, instance->model) ? NULL : "no such model";
    if (!wrong && !read_transform(instance->transform, edit.transform))
        wrong = bad_transform;
    if (wrong) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "instance of model %d: %s", instance->model, wrong);
        return -1;
    }
    if (!array_push(&scene->edits, edit)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    noc_slot_take(&scene->instance_slots);
    return (int)edit.index;
}

static const noc_scene_instance *instance_of(const noc_scene *scene, int index) {
    if (index < 0 || (size_t)index >= scene->instances.len || !scene->instances.data[index].model)
        return NULL;
    return &scene->instances.data[index];
}

/* The model of an instance that may be edited, 0 where there is none: a published one, or before the first commit one
 * that is staged. The i-th of those was staged as the i-th edit, or later. */
static uint32_t model_of(const noc_scene *scene, int index) {
    const noc_scene_instance *there = instance_of(scene, index);
    if (there)
        return there->model;
    if (scene->committed || index < 0 || (uint32_t)index >= scene->instance_slots.fresh)
        return 0;
    const noc_edit *e = scene->edits.data + index;
    while (e->kind != NOC_EDIT_ADD_INSTANCE || e->index != (uint32_t)index)
        e++;
    return e->model;
}

static noc_status stage(noc_scene *scene, int index, const char *wrong, noc_edit *edit) {
    edit->model = model_of(scene, index);
    if (!edit->model)
        wrong = "the scene has no such instance, or it is not committed yet";
    if (wrong)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "instance %d: %s", index, wrong);
    return array_push(&scene->edits, *edit) ? NOC_OK : noc_scene_out_of_memory(scene);
}

noc_status noc_scene_set_transform(noc_scene *scene, int instance, const double transform[12]) {
    if (!scene || !transform)
        return noc_null(scene ? scene->log : NULL, __func__);
    noc_edit edit = { .kind = NOC_EDIT_TRANSFORM, .index = (uint32_t)instance };
    bool good = read_transform(transform, edit.transform);
    return stage(scene, instance, good ? NULL : bad_transform, &edit);
}

noc_status noc_scene_remove_instance(noc_scene *scene, int instance) {
    if (!scene)
        return noc_null(NULL, __func__);
    return stage(scene, instance, NULL, &(noc_edit){ .kind = NOC_EDIT_REMOVE_INSTANCE, .index = (uint32_t)instance });
}

int noc_scene_instance_light(const noc_scene *scene, int instance, int light) {
    if (!scene) {
        noc_null(NULL, __func__);
        return -1;
    }
    noc_scene_lock_read(scene);
    const noc_scene_instance *i = instance_of(scene, instance);
    bool there = i && light >= 0 && (size_t)light < scene->models.data[i->model - 1].lights.len;
    int slot = there ? (int)i->lights[light] : -1;
    noc_scene_unlock_read(scene);
    if (!there)
        noc_error(scene->log, NOC_ERR_ARGUMENT, "instance %d: there is no light %d of it", instance, light);
    return slot;
}

static void turned(const float m[12], const float v[3], double scale, float out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (float)(((double)m[4 * k] * v[0] + (double)m[4 * k + 1] * v[1] + (double)m[4 * k + 2] * v[2]) * scale);
}

noc_light_record noc_light_placed(const noc_light_record *l, const float m[12]) {
    noc_light_record r = *l;
    double scale = sqrt((double)m[0] * m[0] + (double)m[4] * m[4] + (double)m[8] * m[8]);
    bool spot = l->kind == NOC_LIGHT_SPOT;
    for (int k = 0; k < 3; k++)
        r.p[k] = (float)((double)m[4 * k] * l->p[0] + (double)m[4 * k + 1] * l->p[1] + (double)m[4 * k + 2] * l->p[2] +
                         m[4 * k + 3]);
    turned(m, l->a, spot ? 1 / scale : 1, r.a); /* a spot's is its axis, and its b are no vector */
    if (!spot)
        turned(m, l->b, 1, r.b);
    r.radius = (float)(l->radius * scale);
    if (!noc_light_has_profile(l))
        r.area = (float)(l->area * scale * scale);
    return r;
}

void noc_join_instance_bounds(const noc_scene *scene, const noc_scene_instance *i, double lo[3], double hi[3]) {
    const noc_scene_model *model = &scene->models.data[i->model - 1];
    if (!(model->bounds_min[0] <= model->bounds_max[0]))
        return;
    for (int corner = 0; corner < 8; corner++)
        for (int k = 0; k < 3; k++) {
            const float *row = i->transform + 4 * k;
            double x = row[3];
            for (int j = 0; j < 3; j++)
                x += row[j] * (corner >> j & 1 ? model->bounds_max[j] : model->bounds_min[j]);
            lo[k] = NOC_MIN(lo[k], x);
            hi[k] = NOC_MAX(hi[k], x);
        }
}
