/* Making a lamp of what it is and where it stands: its lights, and its body.
 *
 * Bodies are made once a kind, in a frame of their own whose origin is the foot and whose x goes where the lamp faces,
 * and stand in the scene as often as there are lamps (scene/body.c). A kind is all that a body's shape depends on;
 * heights are rounded to 1 cm for it, and the foot, which is in the ground, makes up for that. */
#include "city/lamp.h"

#include <math.h>

/* Of more kinds than these each lamp has triangles of its own: a kind costs as much as those. */
enum { MOST_KINDS = 16384 };

/* All that the shape depends on; angle: where each head looks, radians from where the lamp faces. */
typedef struct lamp_kind {
    double height, radius, tilt, reach, wall[2];
    uint32_t fitting, light, pole, on_wall, own, heads;
    double angle[GEO_MAX_HEADS];
} lamp_kind;

/* Of a head, in the lamp's frame. */
typedef struct lamp_head {
    double at[3];     /* where it hangs */
    double light[3];  /* centre of its light */
    double axis[3];   /* where that shines */
    double along[3];  /* where its length goes */
    double street[2]; /* where it looks */
} lamp_head;

typedef struct builder {
    lamp_making of;
    const city_body *body; /* the user's; NULL: ours */
    lamp_kind kind;
    double foot[3]; /* of the kind's frame */
    lamp_shape shape;
} builder;

#define OFF_POLE 0.5 /* m that a head may hang off its pole's axis as if it hung on it */

/* By what stands there: bollards are low, lanterns stand on posts, others hang over a road or on a wall. */
static city_profile_kind profile_kind(const builder *b) {
    const lamp_fitting *f = b->of.fitting;
    if (f->kind == FITTING_FLOOD)
        return CITY_PROFILE_FLOOD;
    if (f->kind == FITTING_SPHERE)
        return f->height < CITY_BOLLARD_HEIGHT && !b->of.lamp->body_heads ? CITY_PROFILE_BOLLARD
                                                                          : CITY_PROFILE_POST_TOP;
    return b->of.placing->on_wall ? CITY_PROFILE_WALL : CITY_PROFILE_COBRA_HEAD;
}

/* Distance of the lamp's lights from its vertical axis, m. 0 for a modelled body, whose lights do not turn. */
static double off_axis(const builder *b) {
    if (b->of.lamp->body_heads)
        return 0;
    const double *light = b->body && b->body->whole ? b->body->light : NULL;
    return light ? hypot(light[0], light[1]) * b->of.fitting->height / light[2] : b->kind.reach;
}

/* Returns true if chance decides where the lamp faces and its light depends on that. Its profile was given. */
static bool is_by_chance(const builder *b) {
    const lamp_fitting *f = b->of.fitting;
    bool round = f->light != NOC_LIGHT_DISC || f->tilt == 0;
    if (f->profiled)
        round = f->tilt == 0 && city_profile_is_round(b->of.params->profiles, profile_kind(b), f->ruled.profile);
    return b->of.placing->by_chance && (!round || off_axis(b) > OFF_POLE);
}

/* ---- lights ---- */

static void tell(const builder *b, int index, const double position[3], const double towards[2]) {
    const lamp_fitting *f = b->of.fitting;
    const geo_lamp *lamp = b->of.lamp;
    const city_lamp_params *params = b->of.params;
    double foot = b->of.placing->foot[2], degrees = atan2(towards[0], towards[1]) * 180 / M_PI;
    if (lamp->body_heads && !site_ground(b->of.scene, lamp->xyz[0], lamp->xyz[1], &foot))
        foot = NAN;
    const city_lamp_light light = {
        .index = index,
        .height = position[2] - foot,
        .direction = degrees < 0 ? degrees + 360 : degrees,
        .by_chance = is_by_chance(b),
        .watts = f->watts,
        .profile = f->profiled ? city_profile_name(params->profiles, profile_kind(b), f->ruled.profile) : ""
    };
    params->told(params->dresser, &light);
}

/* towards: the way to the street, level. shown: by the lamp's body; else it has a shape of its own. */
static bool add_light(const builder *b, const double position[3], const double direction[3], const double towards[2],
                      bool shown) {
    const lamp_fitting *f = b->of.fitting;
    noc_light light = { .kind = f->light,
                        .radius = f->light == NOC_LIGHT_POINT ? 0 : f->radius,
                        .name = b->of.lamp->id,
                        .group = f->ruled.group,
                        .inferred = b->of.inferred };
    memcpy(light.position, position, sizeof(light.position));
    memcpy(light.direction, direction, sizeof(light.direction));
    memcpy(light.emission, f->emission, sizeof(light.emission));
    const double street[3] = { towards[0], towards[1], 0 };
    if (f->profiled && !city_profile_give(b->of.params->profiles, profile_kind(b), &f->ruled, street, &light))
        return false;
    int index = shown ? noc_scene_add_body_light(b->of.scene, &light) : noc_scene_add_light(b->of.scene, &light);
    if (index >= 0 && b->of.params->told)
        tell(b, index, position, towards);
    return index >= 0;
}

/* From the lamp's frame to the scene's. */
static void turn(const builder *b, const double v[2], double out[2]) {
    const double *facing = b->of.placing->facing;
    out[0] = facing[0] * v[0] - facing[1] * v[1];
    out[1] = facing[1] * v[0] + facing[0] * v[1];
}

static void place(const builder *b, const double p[3], double out[3]) {
    turn(b, p, out);
    for (int k = 0; k < 2; k++)
        out[k] += b->foot[k];
    out[2] = b->foot[2] + p[2];
}

static bool add_head_light(const builder *b, const lamp_head *h, bool shown) {
    double position[3], axis[3] = { 0, 0, h->axis[2] }, street[2];
    place(b, h->light, position);
    turn(b, h->axis, axis);
    turn(b, h->street, street);
    return add_light(b, position, axis, street, shown);
}

/* ---- the kind ---- */

static double foot_radius(const lamp_kind *k) { return NOC_CLAMP(.045 + .006 * k->height, .03, .2); }

static double top_radius(const lamp_kind *k) { return NOC_MIN(foot_radius(k) * .6, k->radius * .4); }

/* How far a head that hangs beside the pole must be off its axis, so that no part of the light lies in the pole, nor
 * over its foot, which is thicker. */
static double least_reach(const lamp_kind *k) { return k->radius + foot_radius(k) + .02; }

/* How far a head is off the pole's axis. A single lantern sits on top. */
static double reach(const lamp_kind *k, double arm) {
    if (!k->pole)
        return k->heads > 1 ? .35 : 0;
    if (k->fitting == FITTING_SPHERE)
        return k->heads > 1 ? k->radius + .25 : 0;
    double usual = k->fitting == FITTING_FLOOD ? .35 : NOC_CLAMP(.15 * k->height, .6, 1.5);
    return fmax(isfinite(arm) ? arm : usual, least_reach(k));
}

/* Which way a head looks: its own, where the lamp tells it of each; else they are spread evenly. */
static double head_angle(const builder *b, int head) {
    const geo_lamp *lamp = b->of.lamp;
    if (lamp->heading_count && !b->of.placing->on_wall)
        return ((double)lamp->heading[0] - (double)lamp->heading[head % lamp->heading_count]) * M_PI / 180;
    return 2 * M_PI * head / b->of.fitting->heads;
}

/* The wall in the lamp's frame, to the micrometre: what is beyond it is rounding. */
static void find_wall(const lamp_placing *p, double wall[2]) {
    double d[2] = { p->wall[0] - p->foot[0], p->wall[1] - p->foot[1] };
    wall[0] = round((p->facing[0] * d[0] + p->facing[1] * d[1]) * 1e6) / 1e6;
    wall[1] = round((p->facing[0] * d[1] - p->facing[1] * d[0]) * 1e6) / 1e6;
}

static void find_kind(builder *b) {
    const lamp_fitting *f = b->of.fitting;
    const lamp_placing *p = b->of.placing;
    lamp_kind *k = &b->kind;
    k->height = round(f->height * 100) / 100;
    k->radius = f->radius;
    k->tilt = f->tilt;
    k->fitting = f->kind;
    k->light = f->light;
    k->pole = !p->on_wall && b->of.lamp->mount != GEO_MOUNT_SUSPENDED;
    k->on_wall = p->on_wall;
    k->heads = (uint32_t)f->heads;
    k->reach = reach(k, f->ruled.arm);
    if (p->on_wall)
        find_wall(p, k->wall);
    for (int i = 0; i < f->heads; i++)
        k->angle[i] = head_angle(b, i);
    memcpy(b->foot, p->foot, sizeof(b->foot));
    b->foot[2] += f->height - k->height;
}

/* The axis of a head that faces (dx, dy). */
static void head_axis(double tilt, const double street[2], double axis[3]) {
    axis[0] = sin(tilt) * street[0];
    axis[1] = sin(tilt) * street[1];
    axis[2] = -cos(tilt);
}

/* Its light hangs at the lamp's height; a sphere wholly below its housing, which never lies before it. */
static lamp_head find_head(const builder *b, int i) {
    const lamp_kind *k = &b->kind;
    double dx = cos(k->angle[i]), dy = sin(k->angle[i]);
    lamp_head h = { .at = { k->reach * dx, k->reach * dy, k->height },
                    .along = { cos(k->tilt) * dx, cos(k->tilt) * dy, sin(k->tilt) },
                    .street = { dx, dy } };
    bool housed = k->fitting != FITTING_SPHERE && !b->body && !b->of.placing->crowded;
    double drop = housed && k->light == NOC_LIGHT_SPHERE ? k->radius : 0;
    head_axis(k->tilt, h.street, h.axis);
    for (int c = 0; c < 3; c++)
        h.light[c] = h.at[c] + drop * h.axis[c];
    return h;
}

/* ---- its shape ---- */

static void shape_lantern(builder *b, const lamp_head *h, const double root[3]) {
    const lamp_kind *k = &b->kind;
    double end[3] = { h->at[0], h->at[1], k->height - k->radius - .02 };
    if (root && (k->reach > 0 || !k->pole))
        shape_bar(&b->shape, root, end, .02);
}

static void shape_flood(builder *b, const lamp_head *h, const double face[3], const double root[3]) {
    double r = b->kind.radius, side[3] = { -h->street[1], h->street[0], 0 }, back[3];
    for (int k = 0; k < 3; k++)
        back[k] = h->at[k] - .14 * h->axis[k];
    shape_housing(&b->shape, face, h->axis, side, r * 1.3, r * 1.15, fmin(.13, .87 * r));
    if (root)
        shape_bar(&b->shape, root, back, .025);
}

/* root: where its arm begins; NULL: it has none. */
static void shape_head(builder *b, const lamp_head *h, const double root[3]) {
    const lamp_kind *kind = &b->kind;
    double gap = .01, r = kind->radius, face[3], neck[3];
    if (b->body) { /* the arm alone */
        if (root && hypot(h->at[0] - root[0], h->at[1] - root[1]) > .3)
            shape_bar(&b->shape, root, (double[]){ h->at[0], h->at[1], root[2] }, .03);
        return;
    }
    for (int k = 0; k < 3; k++) {
        face[k] = h->at[k] - gap * h->axis[k];
        neck[k] = h->at[k] - .3 * h->along[k] - .07 * h->axis[k];
    }
    if (kind->fitting == FITTING_SPHERE) {
        shape_lantern(b, h, root);
    } else if (kind->fitting == FITTING_FLOOD) {
        shape_flood(b, h, face, root);
    } else {
        shape_housing(&b->shape, face, h->axis, h->along, r * 1.9, r * 1.15, fmin(.12, .8 * r));
        if (root && kind->reach > .3)
            shape_bar(&b->shape, root, neck, .03);
    }
}

static void shape_heads(builder *b) {
    const lamp_kind *k = &b->kind;
    /* the top of the pole, or where the bracket leaves the wall */
    double root[3] = { k->wall[0], k->wall[1], k->height };
    if (k->on_wall)
        root[2] += .15;
    else if (k->fitting == FITTING_SPHERE)
        root[2] -= k->heads > 1 ? k->radius + .25 : 0;
    for (uint32_t i = 0; i < k->heads; i++) {
        lamp_head h = find_head(b, (int)i);
        shape_head(b, &h, k->pole || k->on_wall ? root : NULL);
    }
}

static void shape_post(builder *b) {
    const lamp_kind *k = &b->kind;
    double foot[3] = { 0, 0, -.1 }, top = k->height; /* into the ground */
    if (k->fitting == FITTING_SPHERE)
        top -= k->heads > 1 ? k->radius + .22 : k->radius + .005; /* under the globe, or above the roots of its arms */
    else
        top += .08;
    if (k->pole && top > foot[2] + .12)
        shape_pole(&b->shape, foot, top, foot_radius(k), top_radius(k));
}

static void make_shape(builder *b) {
    shape_post(b);
    shape_heads(b);
}

/* ---- its body ---- */

/* A model of the kind: its triangles, and the shapes of its lights. -1 after reporting. */
static int make_model(builder *b) {
    noc_scene *scene = b->of.scene;
    noc_light lights[GEO_MAX_HEADS];
    make_shape(b);
    if (b->shape.no_memory)
        return noc_scene_out_of_memory(scene) == NOC_OK ? 0 : -1;
    for (uint32_t i = 0; i < b->kind.heads; i++) {
        lamp_head h = find_head(b, (int)i);
        lights[i] = (noc_light){ .kind = (noc_light_kind)b->kind.light, .radius = b->kind.radius };
        memcpy(lights[i].position, h.light, sizeof(h.light));
        memcpy(lights[i].direction, h.axis, sizeof(h.axis));
    }
    noc_mesh mesh = { .vertex_count = b->shape.xyz.len / 3,
                      .positions = b->shape.xyz.data,
                      .triangle_count = b->shape.indices.len / 3,
                      .indices = b->shape.indices.data,
                      .material = shape_material(scene) };
    return mesh.material < 0
               ? -1
               : noc_scene_add_body_model(scene, mesh.triangle_count ? &mesh : NULL, lights, b->kind.heads);
}

/* The model of the kind, which is made where it is the first one of it. 0: there are too many; -1 after reporting. */
static int model_of(builder *b) {
    size_t size = offsetof(lamp_kind, angle) + b->kind.heads * sizeof(*b->kind.angle), kinds;
    int model = noc_body_kind(b->of.scene, &b->kind, size, &kinds);
    if (model || kinds >= MOST_KINDS)
        return model;
    model = make_model(b);
    return model > 0 && !noc_body_kind_add(b->of.scene, &b->kind, size, model) ? -1 : model;
}

static bool show_heads(const builder *b) {
    for (uint32_t i = 0; b->body && i < b->kind.heads; i++) {
        lamp_head h = find_head(b, (int)i);
        double at[3], axis[3] = { 0, 0, h.axis[2] }, street[2];
        place(b, h.at, at);
        turn(b, h.axis, axis);
        turn(b, h.street, street);
        if (!body_show_head(b->of.scene, b->body, at, axis, street))
            return false;
    }
    return true;
}

/* Returns how many lights there are. */
static int add_lights(const builder *b, bool shown) {
    int lights = 0;
    for (uint32_t i = 0; i < b->kind.heads; i++) {
        lamp_head h = find_head(b, (int)i);
        lights += add_head_light(b, &h, shown);
    }
    return lights;
}

/* The lamp as a body of its kind; 0 after reporting. */
static int add_body(builder *b, int model) {
    noc_scene *scene = b->of.scene;
    const double *facing = b->of.placing->facing;
    noc_scene_body body = { .model = (uint32_t)model,
                            .light = (uint32_t)scene->lights.len,
                            .p = { (float)b->foot[0], (float)b->foot[1], (float)b->foot[2] },
                            .facing = { (float)facing[0], (float)facing[1] } };
    int lights = add_lights(b, true);
    bool whole = lights == (int)b->kind.heads && show_heads(b);
    return whole && noc_scene_add_body(scene, &body) ? lights : 0;
}

/* The lamp with triangles and lights of its own; 0 after reporting. */
static int add_alone(builder *b) {
    if (!b->of.placing->crowded) /* else no more stands there than fits: each next lamp would meet all of it */
        make_shape(b);
    int lights = add_lights(b, false);
    bool shown = b->of.placing->crowded || show_heads(b);
    return shown && shape_add(&b->shape, b->of.scene, b->foot, b->of.placing->facing, b->of.lamp->id) ? lights : 0;
}

/* A whole body of the user's for each head. */
static int add_whole(const builder *b) {
    const lamp_fitting *f = b->of.fitting;
    int lights = 0;
    for (uint32_t i = 0; i < b->kind.heads; i++) {
        lamp_head h = find_head(b, (int)i);
        double light[3], axis[3] = { 0, 0, h.axis[2] }, street[2];
        turn(b, h.axis, axis);
        turn(b, h.street, street);
        lights += body_show_whole(b->of.scene, b->body, b->of.placing->foot, f->height, street, light) &&
                  add_light(b, light, axis, street, false);
    }
    return lights;
}

/* A lamp whose body is modelled: its lights alone, where the body has them. */
static int add_to_body(const builder *b) {
    const geo_lamp *lamp = b->of.lamp;
    int lights = 0;
    double axis[3];
    head_axis(b->of.fitting->tilt, b->of.placing->facing, axis);
    for (int i = 0; i < NOC_MIN(lamp->body_heads, GEO_BODY_HEADS); i++)
        lights += add_light(b, lamp->head[i], axis, b->of.placing->facing, false);
    return lights;
}

static int add_lamp(builder *b) {
    if (b->of.lamp->body_heads)
        return add_to_body(b);
    find_kind(b);
    const city_body *body = b->of.params->body;
    if (body && (b->kind.pole || !body->whole)) /* one with a pole hangs on no wall */
        b->body = body;
    b->kind.own = b->body != NULL;
    if (b->of.placing->crowded)
        return add_alone(b);
    if (b->body && b->body->whole)
        return add_whole(b);
    int model = model_of(b);
    return model < 0 ? 0 : model ? add_body(b, model) : add_alone(b);
}

int lamp_make(const lamp_making *m, geo_issues *issues) {
    builder b = { .of = *m };
    int lights = add_lamp(&b);
    if (!lights) /* the scene said why */
        geo_issue(issues, GEO_SKIPPED, "lamp that the scene refused", m->lamp->id);
    if (m->params->tally)
        m->params->tally->by_chance += lights && is_by_chance(&b);
    shape_free(&b.shape);
    return lights;
}
