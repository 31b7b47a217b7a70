/* One light, one detailed object: a ribbed knot on a plinth before a curved backdrop, by one square lamp. Hardly a
 * pixel of it sees the whole light, and nothing can be gained by choosing among lights. */
#include "city/builtin/kit.h"

/* A floor that turns up into a wall, y from the front (v = 0) to the wall's top. */
static vec3 backdrop(const void *shape, double u, double v) {
    const double front = -9, bend = 3.2, wall = 9, flat = bend - front, arc = 4, s = v * (flat + arc + wall);
    double x = 24 * (u - 0.5);
    if (s < flat)
        return v3(x, front + s, 0);
    if (s < flat + arc) {
        double turn = 0.25 * (s - flat) / arc;
        return v3(x, bend + 2.5 * town_sin(turn), 2.5 * (1 - town_cos(turn)));
    }
    return v3(x, bend + 2.5, 2.5 + s - flat - arc);
}

/* A square lamp of half edge h that looks from p at a place, in a frame behind it. */
static void lamp(kit *k, vec3 p, vec3 at, double h, double luminance) {
    vec3 look = unit(sub(at, p)), right = scale(unit(cross(look, v3(0, 0, 1))), h),
         up = cross(unit(right), scale(look, h));
    vec3 corner = sub(sub(p, right), scale(up, -1));
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                    .position = { corner.x, corner.y, corner.z },
                    .edge_u = { 2 * right.x, 2 * right.y, 2 * right.z },
                    .edge_v = { -2 * up.x, -2 * up.y, -2 * up.z },
                    .emission = { (float)(1.10 * luminance), (float)luminance, (float)(0.82 * luminance) },
                    .name = "lamp" };
    kit_light(k, &l);
    k->origin = p;
    k->axis[0] = scale(right, 1.08);
    k->axis[1] = scale(up, 1.08);
    k->axis[2] = look;
    kit_box(k, v3(-1, -1, -0.14), v3(1, 1, -0.01));
    kit_place(k, v3(0, 0, 0), 0, 1);
}

noc_status scene_single(noc_scene *scene, const noc_builtin_params *params, bool windows) {
    static const double plinth[][2] = { { 0, 0 },       { 1.25, 0 },    { 1.25, 0.12 }, { 1.08, 0.2 },  { 0.98, 0.26 },
                                        { 0.98, 0.62 }, { 1.06, 0.68 }, { 1.16, 0.74 }, { 1.16, 0.84 }, { 0, 0.84 } };
    kit k = kit_start(scene);
    kit_patch(&k, 2, 200, backdrop, NULL);
    kit_flush(&k, kit_material(&k, .55f, .54f, .52f, 0, 1), "backdrop");
    kit_turned(&k, 96, (int)NOC_COUNT(plinth) - 1, &(kit_lathe){ .profile = plinth, .count = (int)NOC_COUNT(plinth) });
    kit_flush(&k, kit_material(&k, .26f, .27f, .30f, .04f, .45f), "plinth");
    k.origin = v3(0, 0, 2.33); /* upright: the knot's axis lies level, a little to the side */
    k.axis[0] = v3(0.94, 0.3, 0);
    k.axis[1] = v3(0, 0, 0.987);
    k.axis[2] = v3(0.3, -0.94, 0);
    kit_knotted(&k, 720, 64,
                &(kit_knot){ .p = 2, .q = 3, .lobes = 5, .twist = 7, .ribs = 96, .ring = 0.42, .tube = 0.2 });
    kit_flush(&k, kit_material(&k, .52f, .30f, .14f, .04f, .35f), "knot");
    kit_place(&k, v3(0, 0, 0), 0, 1);
    lamp(&k, v3(-3.6, -3.0, 5.6), v3(0, 0, 1.9), 0.55, 2600);
    kit_flush(&k, kit_material(&k, .06f, .06f, .06f, .04f, .5f), "lamp/frame");
    kit_camera(&k, v3(1.1, -7.4, 2.7), v3(0, 0, 1.95), 36);
    return kit_finish(&k);
}
