/* light/environment: what directions are drawn from of the map around a scene (core/environment.h). */
#ifndef NOC_LIGHT_ENVIRONMENT_H
#define NOC_LIGHT_ENVIRONMENT_H

#include "light/alias.h"

typedef struct noc_map_light {
    noc_alias *texels; /* by luminance times solid angle */
    float *sines;      /* [rows + 1] of the elevations of the rows' upper edges */
    size_t bytes;
} noc_map_light;

/* Of the scene's map, which it must have. NULL after reporting that memory was refused. */
noc_map_light *noc_map_light_create(const noc_scene *scene, noc_log *log);
void noc_map_light_destroy(noc_map_light *light); /* NULL is allowed */

#endif
