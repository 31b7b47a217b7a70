/* The reference method (core/reference.h) in a band of the picture: luminances of chunks, then entries, in its
 * scratch. */
#include "core/reference.h"
#include "core/shading.h"
#include "surfaces.glsl"

uint chunks() { return (HERE.light_count + REFERENCE_CHUNK - 1u) / REFERENCE_CHUNK; }

uint pixel_; /* in the band */
uint entries_;

light light_of_all(uint i) { return light_load(i); }
bool light_shines(uint i) {
    light_record l = HERE.lights.at[i];
    return l.e[0] > 0.0 || l.e[1] > 0.0 || l.e[2] > 0.0;
}
void sum_put(uint chunk, float x) { HERE.scratch.at[chunk * HERE.slots + pixel_] = floatBitsToUint(x); }
float sum_load(uint chunk) { return uintBitsToFloat(HERE.scratch.at[chunk * HERE.slots + pixel_]); }

/* How many entries a pixel has; then the words of entry i: its light and its weight. */
uint count_word() { return chunks() * HERE.slots + pixel_; }
uint entry_word(uint i, uint word) { return (chunks() + 1u + 2u * i + word) * HERE.slots + pixel_; }
void entry_put(bool on, uint light, float w) {
    if (!on || entries_ >= FRAME.rays)
        return;
    HERE.scratch.at[entry_word(entries_, 0u)] = light;
    HERE.scratch.at[entry_word(entries_, 1u)] = floatBitsToUint(w);
    entries_++;
}
