/* picture: TIFF files that are pictures, as textures beside a city model are. */
#ifndef NOC_IMPORT_PICTURE_H
#define NOC_IMPORT_PICTURE_H

#include <stdbool.h>

/* Is the file at path a TIFF of several samples a pixel? False where that cannot be told. */
bool picture_is_tiff(const char *path);

#endif
