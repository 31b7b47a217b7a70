/* Draws a subset, a work group each. Samples whose target is always evaluated go last, so each is ranked: by bits of
 * the plain ones in shared memory and the sums of the words before. draw_sample is the includer's. */
#define MOST_WORDS 512 /* of 32 samples: 16 * 1024 candidates */
layout(local_size_x = 256) in;
shared uint plain_[MOST_WORDS];
shared uint before_[MOST_WORDS + 1];

void main() {
    uint n = HERE.subset_rows * BLOCK, subset = gl_WorkGroupID.x, t = gl_LocalInvocationID.x;
    uint key = presample_key(FRAME.seed, subset, FRAME.index, 0u), words = (n + 31u) / 32u;
    for (uint w = t; w < words; w += 256u)
        plain_[w] = 0u;
    barrier();
    for (uint i = t; i < n; i += 256u)
        if (presample_plain(light_load(draw_sample(key, i, n).light)))
            atomicOr(plain_[i / 32u], 1u << (i & 31u));
    barrier();
    for (uint w = t; w <= words; w += 256u) {
        uint sum = 0u;
        for (uint k = 0u; k < w; k++)
            sum += bitCount(plain_[k]);
        before_[w] = sum;
    }
    barrier();
    for (uint i = t; i < n; i += 256u) {
        presample_pick k = draw_sample(key, i, n);
        uint word = plain_[i / 32u], bit = 1u << (i & 31u);
        uint before = before_[i / 32u] + bitCount(word & (bit - 1u));
        uint rank = presample_rank((word & bit) != 0u, i, before, before_[words]);
        uint at = presample_turned(key, rank), row = subset * HERE.subset_rows + at / BLOCK, l = at % BLOCK;
        presample_put(row, l, presample_of(light_load(k.light), unit_low(k.place), unit_high(k.place)));
        HERE.samples.at[row].light[l] = k.light;
        HERE.samples.at[row].place[l] = k.place;
        HERE.samples.at[row].inverse[l] = k.inverse;
    }
}
