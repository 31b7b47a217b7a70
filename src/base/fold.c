/* Names as a search compares them. */
#include "base/base.h"

#include <nocturne/text.h>

/* Letters of Latin-1 from U+00C0 on, without their marks; 0: it is no letter of these. */
static const char plain[32] = "aaaaaaaceeeeiiiidnooooo\0ouuuuy\0\0";

/* The same of Latin Extended-A, U+0100 to U+017F. */
static const char extended[128] = "aaaaaaccccccccdd"
                                  "ddeeeeeeeeeegggg"
                                  "gggghhhhiiiiiiii"
                                  "ii\0\0jjkkklllllll"
                                  "lllnnnnnn\0\0\0oooo"
                                  "oooorrrrrrssssss"
                                  "ssttttttuuuuuuuu"
                                  "uuuuwwyyyzzzzzzs";

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

/* The plain letter that a letter of two bytes is; 0: it is none of these. */
static char plain_of(unsigned char c, unsigned char next) {
    if (c == 0xc3 && next >= 0x80)
        return next == 0xbf ? 'y' : plain[next & 0x1f];
    bool is_extended = (c == 0xc4 || c == 0xc5) && next >= 0x80 && next <= 0xbf;
    return is_extended ? extended[(c - 0xc4) * 64 + next - 0x80] : 0;
}

/* Is it a mark over or under the letter before, U+0300 to U+036F? */
static bool is_mark(unsigned char c, unsigned char next) {
    return (c == 0xcc && next >= 0x80) || (c == 0xcd && next >= 0x80 && next <= 0xaf);
}

char *noc_text_fold(const char *text, bool whole) {
    if (!text)
        return NULL;
    char *out = noc_alloc(3 * strlen(text) + 8);
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
        } else if (c == 0xc3 && next == 0x9f) {
            add_letter(out, &n, 's');
            add_letter(out, &n, 's');
            p += 2;
        } else if (plain_of(c, next)) {
            add_letter(out, &n, plain_of(c, next));
            p += 2;
        } else if (is_mark(c, next)) {
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
