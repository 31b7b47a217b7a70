/* core/list_mix.h: how a pixel's reservoir and its rays over a list (core/list_rays.h) share its light. */
#ifndef CORE_LIST_MIX_H
#define CORE_LIST_MIX_H

#include "core/dialect.h"

/* What of a pixel's light its reservoir of M = m shows, where the frames behind it are reused; its rays, of one frame's
 * M, show the rest. Both are unbiased, so any mixture is whose shares are fixed before either is drawn. M tells how
 * many frames stand behind the reservoir, whatever they found; its sample has the luminance of all of them, but one
 * light's colour. */
FN real list_reused(real m, f1 frame) {
    real past = max_(m - K(frame), K(0.0f));
    EXACT real share = past / (past + K(2.0f * frame));
    return share;
}

/* Returns true if less than two frames of `draws` candidates stand behind a reservoir of the frame before. */
FN mask list_is_fresh(real m, f1 draws) { return not_(m >= K(2.0f * draws)); }

#endif
