/* What surfaces on its way leave of a final ray's light. After the bridge. */

/* W of the sample that ray `slot` leads to, less what they take. */
float weakened(float w, uint slot) {
    if (HERE.weakens == 0u || (FRAME.flags & FRAME_FINAL_RAY) == 0u)
        return w;
    EXACT float rest = w * HERE.through.at[slot];
    return rest;
}
