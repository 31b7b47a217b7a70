/* How cars shine: two headlamps and two tail lamps, discs before the body. */
#include "city/traffic/traffic.h"

#include <math.h>

#define LAMP_CLEAR 0.02 /* m before the body */

/* The passing beam, turned over for driving on the left. */
int traffic_beam(noc_scene *scene, noc_driving_side side) {
    noc_profile *right = NULL, *left = NULL;
    if (noc_profile_builtin(NULL, "low-beam", &right)) { /* there is one of that name, so it is memory */
        noc_scene_out_of_memory(scene);
        return 0;
    }
    int number = 0;
    if (side == NOC_DRIVE_RIGHT) {
        number = noc_scene_add_profile(scene, right);
    } else {
        noc_profile_info info;
        noc_profile_get_info(right, &info);
        size_t row = (size_t)info.gamma_count;
        double *cd = noc_alloc((size_t)info.c_count * row * sizeof(*cd));
        for (int i = 0; i < info.c_count && cd; i++) /* C 0 is to the right, C 180 to the left */
            memcpy(cd + (size_t)i * row, info.cd + (size_t)((3 * info.c_count / 2 - i) % info.c_count) * row,
                   row * sizeof(*cd));
        const noc_profile_params p = { "low-beam", info.c_count, info.gamma_count, info.c, info.gamma, cd, 0 };
        if (!cd || noc_profile_create(NULL, &p, &left))
            noc_scene_out_of_memory(scene);
        else
            number = noc_scene_add_profile(scene, left);
        free(cd);
    }
    noc_profile_destroy(right);
    noc_profile_destroy(left);
    return NOC_MAX(number, 0);
}

bool traffic_lamps(noc_scene *scene, int model, const traffic_lamp_places *at, const noc_traffic_params *p, int beam,
                   double kelvin) {
    float white[3];
    bool good = true;
    /* a Lambertian disc of I cd is of I / area cd/m2; of red its Rec.709 primary, whose luminance is 0.2126 */
    const float red = (float)(p->tail_lamp / (M_PI * TRAFFIC_LAMP_RADIUS * TRAFFIC_LAMP_RADIUS) / .2126);
    int group = noc_scene_group_named(scene, "cars");
    noc_kelvin_rgb(kelvin, white);
    for (int side = 0; side < 2 && good; side++) {
        const double *front = at->head[side], *rear = at->tail[side];
        noc_light head = { .kind = NOC_LIGHT_DISC,
                           .position = { front[0] + LAMP_CLEAR, front[1], front[2] },
                           .direction = { 1, 0, 0 },
                           .radius = TRAFFIC_LAMP_RADIUS,
                           .name = "headlamp",
                           .model = model,
                           .group = group,
                           .profile = beam,
                           .c0 = { 0, -1, 0 } };
        noc_light tail = { .kind = NOC_LIGHT_DISC,
                           .position = { rear[0] - LAMP_CLEAR, rear[1], rear[2] },
                           .direction = { -1, 0, 0 },
                           .radius = TRAFFIC_LAMP_RADIUS,
                           .emission = { red, 0, 0 },
                           .name = "tail lamp",
                           .model = model,
                           .group = group };
        for (int k = 0; k < 3; k++)
            head.emission[k] = (float)p->headlamp * white[k];
        good = (p->headlamp <= 0 || noc_scene_add_light(scene, &head) >= 0) &&
               (p->tail_lamp <= 0 || noc_scene_add_light(scene, &tail) >= 0);
    }
    return good;
}
