#include "import/picture.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLES_PER_PIXEL = 277, SHORT = 3, ENTRY = 12 };

/* An unsigned number of `size` bytes, the highest first if `big`. */
static uint32_t number(const unsigned char *p, int size, bool big) {
    uint32_t value = 0;
    for (int i = 0; i < size; i++)
        value = value << 8 | p[big ? i : size - 1 - i];
    return value;
}

static bool has_samples(FILE *file) {
    unsigned char head[8], entry[ENTRY];
    if (fread(head, 1, 8, file) != 8)
        return false;
    bool big = !memcmp(head, "MM\0*", 4);
    if ((!big && memcmp(head, "II*\0", 4) != 0) || fseek(file, (long)number(head + 4, 4, big), SEEK_SET) != 0 ||
        fread(head, 1, 2, file) != 2)
        return false;
    for (uint32_t left = number(head, 2, big); left && fread(entry, 1, ENTRY, file) == ENTRY; left--)
        if (number(entry, 2, big) == SAMPLES_PER_PIXEL)
            return number(entry + 2, 2, big) == SHORT && number(entry + 8, 2, big) > 1;
    return false;
}

bool picture_is_tiff(const char *path) {
    FILE *file = fopen(path, "rb");
    bool is = file && has_samples(file);
    if (file)
        fclose(file);
    return is;
}
