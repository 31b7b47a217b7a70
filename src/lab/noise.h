/* lab: noise of the reference itself, and who rendered it. */
#ifndef NOC_LAB_NOISE_H
#define NOC_LAB_NOISE_H

#include "lab/session.h"

/* Kept in a file beside the reference. A file without a device is of a version that had embree alone. */
void lab_keep_truth(const char *reference, const lab_truth *truth);
void lab_read_truth(const char *reference, lab_truth *truth);
/* A sentence on pixels that are unlit in the reference, into text; false where no such pixel is. */
bool lab_tell_unlit(const lab_session *lab, size_t camera, char text[2 * LAB_TEXT]);

#endif
