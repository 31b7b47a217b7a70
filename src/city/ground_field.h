/* ground_field: the grid that a ground of our own is made on. ground_plane.c fills it from the city, ground_survey.c
 * draws it through places whose height is known. */
#ifndef NOC_CITY_GROUND_FIELD_H
#define NOC_CITY_GROUND_FIELD_H

#include "city/city.h"

typedef struct ground_field {
    int nx, ny;
    double min[2], step[2];
    float *height; /* nx * ny; unknown: NaN. At the middles of cells; the mesh runs through them */
    float *street; /* lowest street in the cell, or beside it where it has none; INFINITY */
    float *foot;   /* mean of the feet in the cell; NaN where it has none */
    float *away;   /* m to the nearest cell that the city tells the height of; INFINITY where it tells none */
    bool *fixed;
    double *scratch; /* 2 * nx * ny, of whoever is at work */
    size_t points;   /* of triangles that were looked at */
} ground_field;

/* Height of the mesh at (x, y). */
double field_height(const ground_field *f, double x, double y);
void field_measure(ground_field *f); /* fills away */
double field_distance(const ground_field *f, double x, double y);
/* Moves the field so that it runs through the points (3 doubles each; those without a height are passed over) and, more
 * softly, along the feet of the buildings. Streets stay uncovered. */
void field_follow(ground_field *f, const double *points, size_t count);

#endif
