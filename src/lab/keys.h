/* lab: names for all that a figure depends on. */
#ifndef NOC_LAB_KEYS_H
#define NOC_LAB_KEYS_H

#include "lab/session.h"

void lab_name_machine(lab_session *lab); /* machine and build, once the device is known */
void lab_name_device(const lab_session *lab, char text[LAB_DEVICE]);
void lab_name_reference(lab_session *lab);               /* once scene and cameras are there */
void lab_name_run(const lab_session *lab, lab_run *run); /* once the reference has its name */

#endif
