/* Candidates that blocks of pixels share (core/presampled.h): what core's functions read. */
#include "core/presampled.h"

uint row_; /* of HERE.samples: the first one of the subset */
uint lane_;

presample presample_load(int i) {
    uint r = row_ + uint(i), l = lane_;
    presample e;
    e.x = vec3(HERE.samples.at[r].x[0][l], HERE.samples.at[r].x[1][l], HERE.samples.at[r].x[2][l]);
    e.normal = vec3(HERE.samples.at[r].normal[0][l], HERE.samples.at[r].normal[1][l], HERE.samples.at[r].normal[2][l]);
    e.shine = vec3(HERE.samples.at[r].shine[0][l], HERE.samples.at[r].shine[1][l], HERE.samples.at[r].shine[2][l]);
    e.bare = HERE.samples.at[r].bare[l];
    e.sided = HERE.samples.at[r].sided[l];
    e.close2 = HERE.samples.at[r].close2[l];
    e.radius = HERE.samples.at[r].radius[l];
    return e;
}

void presample_put(uint row, uint l, presample e) {
    for (int k = 0; k < 3; k++) {
        HERE.samples.at[row].x[k][l] = e.x[k];
        HERE.samples.at[row].normal[k][l] = e.normal[k];
        HERE.samples.at[row].shine[k][l] = e.shine[k];
    }
    HERE.samples.at[row].bare[l] = e.bare;
    HERE.samples.at[row].sided[l] = e.sided;
    HERE.samples.at[row].close2[l] = e.close2;
    HERE.samples.at[row].radius[l] = e.radius;
}

float presample_inverse(int i) { return HERE.samples.at[row_ + uint(i)].inverse[lane_]; }
presample_pick presample_pick_load(uint i) {
    uint r = row_ + i, l = lane_;
    return presample_pick(HERE.samples.at[r].light[l], HERE.samples.at[r].place[l], HERE.samples.at[r].inverse[l]);
}
/* Shaders have no room for the sums of a pixel's weights: they use ris_presampled_twice. */
void weighed_store(int i, float s) {}
float weighed_load(int i) { return 0.0; }
float weighed_at(uint i) { return 0.0; }
