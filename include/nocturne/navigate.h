/* nocturne/navigate.h: moving about in a scene: a camera that follows keys, pointer and time.
 *
 * A navigator turns what a hand does into a camera. It needs no renderer: it asks for rays through a callback, which is
 * noc_view_cast for who has a view. It moves in steps of 1/120 s and shows what lies between two of them, so a path
 * depends on the time that passes and hardly on how that is cut into frames. A camera that nothing moves any more is
 * the same to the bit.
 *
 * Modes. orbit turns about the place in the middle of the view. fly goes where one looks, through walls but not into
 * the ground. walk stands on the ground with its eye at 1.70 m: it steps on what is at most 0.40 m higher, climbs
 * slopes up to 50 degrees, slides along walls, and falls at 6 m/s at most. Cars, too, are walls to it, as long as it is
 * not in one, and where nothing is below it does not go.
 *
 * Threads: a navigator belongs to one thread at a time. */
#ifndef NOCTURNE_NAVIGATE_H
#define NOCTURNE_NAVIGATE_H

#include <nocturne/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum noc_navigate_mode {
    NOC_NAVIGATE_ORBIT,
    NOC_NAVIGATE_FLY,
    NOC_NAVIGATE_WALK,
    NOC_NAVIGATE_COUNT
} noc_navigate_mode;

NOC_API const char *noc_navigate_mode_name(noc_navigate_mode mode); /* "orbit" */

/* Keys that are down, as bits. */
typedef enum noc_navigate_key {
    NOC_KEY_FORWARD = 1,
    NOC_KEY_BACK = 2,
    NOC_KEY_LEFT = 4,
    NOC_KEY_RIGHT = 8,
    NOC_KEY_UP = 16,
    NOC_KEY_DOWN = 32,
    NOC_KEY_FAST = 64, /* times 4 */
    NOC_KEY_SLOW = 128 /* a quarter */
} noc_navigate_key;

/* What the hand did since the last input. Numbers that are not finite are taken as 0. */
typedef struct noc_navigate_input {
    double seconds; /* since then: 0 and more, what is over 1 is taken as 1 */
    uint32_t keys;  /* that are down: bits of noc_navigate_key */
    /* The pointer's way, in heights of the picture, to the right and down. turn: orbit: the scene follows it, half a
     * turn a height; fly, walk: the view turns to where it goes. pan: the scene follows it; walk: one steps aside */
    double turn[2], pan[2];
    double zoom;   /* steps, positive: nearer. Towards what is seen at `at`; walk: a narrower field of view */
    double at[2];  /* of the pointer: 0..1, from the left upper corner */
    double aspect; /* width / height of the picture; 0: 16 / 9 */
} noc_navigate_input;

typedef struct noc_navigator noc_navigator;

/* For a committed scene, which must outlive it. It is in orbit mode and looks as NOC_VIEWPOINT_OWN does. NULL after
 * reporting that there is no memory, or no such scene. */
NOC_API noc_navigator *noc_navigator_create(const noc_scene *scene, noc_cast_fn cast, void *user);
NOC_API void noc_navigator_destroy(noc_navigator *navigator); /* NULL is allowed */

/* Moves by what the hand did; *camera (may be NULL) is where it is then. Steps that are refused rays stand still, and
 * the callback's status is returned. */
NOC_API noc_status noc_navigator_input(noc_navigator *navigator, const noc_navigate_input *input, noc_camera *camera);
/* Is it on its way, so that the camera changes though the hand rests? */
NOC_API bool noc_navigator_moves(const noc_navigator *navigator);
NOC_API void noc_navigator_camera(const noc_navigator *navigator, noc_camera *camera);

/* Another mode, from where the camera is. orbit turns about what is in the middle of the view. walk needs a place to
 * stand: below, where the camera is not higher than 30 m, else in the middle of the view; beside it where that is in a
 * building or on water; it goes there as noc_navigator_go does. */
NOC_API noc_status noc_navigator_set_mode(noc_navigator *navigator, noc_navigate_mode mode);
NOC_API noc_navigate_mode noc_navigator_mode(const noc_navigator *navigator);
/* Speed of keys, m/s. 0, the default: orbit by the distance, fly by the height over what is below, walk 2 m/s. */
NOC_API noc_status noc_navigator_set_speed(noc_navigator *navigator, double speed);
NOC_API double noc_navigator_speed(const noc_navigator *navigator); /* that keys have now, m/s */

/* The camera is there at once. Its roll is lost. In walk mode one stands below it where that is 1 to 3 m; any other
 * camera is no walker's, and the mode is fly then. NOC_ERR_ARGUMENT: it looks nowhere. */
NOC_API noc_status noc_navigator_set_camera(noc_navigator *navigator, const noc_camera *camera);
/* Goes there on a camera path of half a second to two and a half, over what stands in between; modes as above. Keys and
 * pointer end it where it is, but in walk, which is on its feet only at the end. */
NOC_API noc_status noc_navigator_go(noc_navigator *navigator, const noc_camera *camera);
/* Goes to what is seen at `at` (as in noc_navigate_input): orbit turns about it and comes nearer; fly comes near; walk
 * stands on it, or before it where it is a wall. false: nothing is there, or there is no place to stand. */
NOC_API bool noc_navigator_jump(noc_navigator *navigator, const double at[2], double aspect);
/* Goes to where a place of the scene (local metres) is seen from about so many metres, with nothing in between: nearer
 * where there is no room. It keeps its direction as far as it can. It does not walk then. false: no place, or walls are
 * all around it. */
NOC_API bool noc_navigator_look(noc_navigator *navigator, const double place[3], double distance);

#ifdef __cplusplus
}
#endif
#endif
