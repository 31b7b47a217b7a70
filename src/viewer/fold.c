/* Names as a search compares them. */
#include "viewer/fold.h"

#include <stdlib.h>
#include <string.h>

/* Letters of Latin-1 from U+00C0 on, without their marks; 0: it is no letter of these. */
static const char plain[32] = "aaaaaaaceeeeiiiidnooooo\0ouuuuy\0\0";

static void add_letter(char *out, size_t *n, char c) {
    bool blank = c == ' ' && (!*n || out[*n - 1] == ' ');
    bool umlaut = c == 'e' && *n && strchr("aou", out[*n - 1]);
    if (!blank && !umlaut)
        out[(*n)++] = c;
}

/* "str" at the end of a word is "strasse". */
static void end_word(char *out, size_t *n) {
    if (*n >= 3 && !memcmp(out + *n - 3, "str", 3)) {
        memcpy(out + *n, "asse", 4);
        *n += 4;
    }
}

/* Bytes that a mark between words takes; 0: none is here. */
static size_t is_blank(const char *text) {
    if (*text == ' ' || *text == '-' || *text == '\t')
        return 1;
    bool dash = !strncmp(text, "\xe2\x80", 2) && (unsigned char)text[2] >= 0x90 && (unsigned char)text[2] <= 0x95;
    return dash ? 3 : 0;
}

char *fold_name(const char *text, bool whole) {
    char *out = malloc(3 * strlen(text) + 8);
    size_t n = 0;
    for (const char *p = text; out && *p;) {
        unsigned char c = (unsigned char)*p, next = (unsigned char)p[1];
        size_t blank = is_blank(p);
        if (blank) {
            end_word(out, &n);
            add_letter(out, &n, ' ');
            p += blank;
        } else if (c == '.' && n >= 3 && !memcmp(out + n - 3, "str", 3)) {
            end_word(out, &n);
            p++;
        } else if (c == 0xc3 && (next == 0x9f || (next >= 0x80 && plain[next & 0x1f]))) {
            add_letter(out, &n, next == 0x9f ? 's' : next == 0xbf ? 'y' : plain[next & 0x1f]);
            if (next == 0x9f)
                add_letter(out, &n, 's');
            p += 2;
        } else if (c == 0xcc && next == 0x88) { /* two dots over the letter before */
            p += 2;
        } else {
            add_letter(out, &n, (char)(c >= 'A' && c <= 'Z' ? c + 32 : c));
            p++;
        }
    }
    if (out && whole)
        end_word(out, &n);
    while (out && n && out[n - 1] == ' ')
        n--;
    if (out)
        out[n] = 0;
    return out;
}
