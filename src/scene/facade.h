/* scene/facade: windows that lie in walls, in the cells of a grid, and have no triangles (core/facade.h). */
#ifndef NOC_SCENE_FACADE_H
#define NOC_SCENE_FACADE_H

#include "scene/scene.h"

/* Before the first commit: a grid of cells on walls of a mesh, without a window in it yet. */
typedef struct noc_facade {
    double origin[3];       /* local metres: corner of column 0, row 0 */
    double along[3], up[3]; /* from one column and one row to the next, at a right angle */
    uint32_t columns, rows; /* at least 1 each */
    int material, mesh;     /* material: of the windows */
} noc_facade;
/* Its number + 1; 0: no memory, reported. */
uint32_t noc_scene_add_facade(noc_scene *s, const noc_facade *facade);
/* Is there room for a window, a parallelogram: is it within the grid, in cells that have none? */
bool noc_scene_facade_takes(const noc_scene *s, uint32_t facade, const noc_light *shape);
/* The facade that a triangle is of, NULL: none. */
static inline const noc_facade_record *noc_scene_facade_of(const noc_scene *s, size_t triangle) {
    uint32_t number = triangle < s->triangle_facade.len ? s->triangle_facade.data[triangle] : 0;
    return number ? &s->facades.data[number - 1] : NULL;
}
/* The window's light that covers a place on such a triangle, or NOC_NO_LIGHT. */
uint32_t noc_facade_light(const noc_scene *s, const noc_facade_record *facade, const float p[3]);
/* Writes a window's light into the cells that it reaches over; noc_scene_add_window does. */
void noc_facade_put(noc_scene *s, uint32_t facade, uint32_t light);
/* At most so many windows does a mesh's removal take away, and takes them away. */
size_t noc_facade_windows(const noc_scene *s, const noc_scene_mesh *m);
void noc_facades_remove(noc_scene *s, const noc_scene_mesh *m, noc_changes *c);

#endif
