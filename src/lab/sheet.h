/* lab: a contact sheet, a labelled panel a picture: its crop, or all of it above its insets. */
#ifndef NOC_LAB_SHEET_H
#define NOC_LAB_SHEET_H

#include "lab/session.h"

typedef struct lab_sheet {
    const lab_crop *crop;
    const lab_camera *camera;
    uint8_t *rgb;                                  /* owned */
    int width, height;                             /* px */
    int panel_width, panel_height, picture_height; /* without and with the label and the insets */
} lab_sheet;

/* name: of its file, for messages */
noc_status lab_start_sheet(lab_sheet *sheet, const lab_crop *crop, const lab_camera *camera, size_t panels,
                           const char *name, noc_log *log);
/* rgb: 8-bit, of a whole picture so wide; NULL: the label alone. */
void lab_add_panel(lab_sheet *sheet, size_t panel, const uint8_t *rgb, int width, const char *label);
const char *lab_inset_colour(int inset); /* "red" */

#endif
