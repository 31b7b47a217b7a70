/* lab: noise of the reference itself. */
#ifndef NOC_LAB_NOISE_H
#define NOC_LAB_NOISE_H

#include "lab/session.h"

/* Kept in a file beside the reference. */
void lab_keep_noise(const char *reference, const noc_lab_noise *noise);
noc_lab_noise lab_read_noise(const char *reference);
/* A sentence on pixels that are unlit in the reference, into text; false where no such pixel is. */
bool lab_tell_unlit(const lab_session *lab, size_t camera, char text[2 * LAB_TEXT]);

#endif
