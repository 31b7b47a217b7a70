/* Those invocations of a work group for which something holds, in their order. After tile.glsl. */
shared uint bits_[2][(WORKERS + 31u) / 32u];
shared uint chosen_[WORKERS];
uint turn_ = 0u;

void compact_begin() {
    EACH_INDEX(i, 2u * ((WORKERS + 31u) / 32u)) bits_[i & 1u][i / 2u] = 0u;
    settle();
}

/* Sets how many there are before this one, and returns how many in all. 1 barrier; another one must come before the
 * next call. */
uint compact(bool on, out uint before) {
    uint sum = 0u;
    if (on)
        atomicOr(bits_[turn_][worker / 32u], 1u << (worker & 31u));
    settle();
    before = 0u;
    for (uint i = 0u; i < (WORKERS + 31u) / 32u; i++) {
        uint word = bits_[turn_][i];
        if (i == worker / 32u)
            before = sum + bitCount(word & ((1u << (worker & 31u)) - 1u));
        sum += bitCount(word);
    }
    turn_ = 1u - turn_;
    EACH_INDEX(i, (WORKERS + 31u) / 32u) bits_[turn_][i] = 0u;
    return sum;
}
