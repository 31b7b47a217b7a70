/* utf16: text of two bytes a character, which tables may be in. */
#ifndef NOC_LAMP_UTF16_H
#define NOC_LAMP_UTF16_H

#include "base/base.h"

typedef enum utf16_order { UTF16_NOT, UTF16_LITTLE, UTF16_BIG } utf16_order;

/* By a byte order mark, or by Latin text without one. */
utf16_order utf16_order_of(const char *head, size_t size);

/* Between two pieces of a text. */
typedef struct utf16 {
    utf16_order order;
    bool halved; /* half is the first byte of two */
    unsigned char half;
    unsigned high; /* the first half of a pair; 0: none */
} utf16;

/* Decodes a piece of any size into out, which has room for 3 bytes for each two of it and 6 more; a mark is a character
 * like others. Returns how many bytes. What is no character becomes U+FFFD. */
size_t utf16_decode(utf16 *u, const char *in, size_t size, char *out);

#endif
