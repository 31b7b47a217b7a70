/* Vertical rays against the scene, for standing lamps and cameras on it. */
#include "scene/scene.h"

void noc_ground_free(struct noc_ground *ground) { free(ground); }
