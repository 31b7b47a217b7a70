/* Tables in UTF-16, as spreadsheets save "Unicode text": on their way to UTF-8. */
#include "import/lamps/utf16.h"

static bool is_text(unsigned char c) { return (c >= ' ' && c < 0x7f) || c == '\t' || c == '\r' || c == '\n'; }

/* Without a mark: Latin text, whose every other byte is 0. */
static bool looks_like(const unsigned char *p, size_t size, bool big) {
    enum { LOOKED_AT = 256 };
    size_t pairs = NOC_MIN(size, LOOKED_AT) / 2, text = 0;
    for (size_t i = 0; i < pairs; i++)
        text += !p[2 * i + !big] && is_text(p[2 * i + big]);
    return pairs >= 8 && 10 * text >= 9 * pairs;
}

utf16_order utf16_order_of(const char *head, size_t size) {
    const unsigned char *p = (const unsigned char *)head;
    if (size >= 2 && p[0] == 0xff && p[1] == 0xfe)
        return UTF16_LITTLE;
    if (size >= 2 && p[0] == 0xfe && p[1] == 0xff)
        return UTF16_BIG;
    return looks_like(p, size, false) ? UTF16_LITTLE : looks_like(p, size, true) ? UTF16_BIG : UTF16_NOT;
}

static char *put(char *out, unsigned c) {
    if (c < 0x80) {
        *out++ = (char)c;
        return out;
    }
    if (c >= 0x10000)
        *out++ = (char)(0xf0 | c >> 18);
    if (c >= 0x800)
        *out++ = (char)(c >= 0x10000 ? 0x80 | (c >> 12 & 63) : 0xe0 | c >> 12);
    *out++ = (char)(c >= 0x800 ? 0x80 | (c >> 6 & 63) : 0xc0 | c >> 6);
    *out++ = (char)(0x80 | (c & 63));
    return out;
}

size_t utf16_decode(utf16 *u, const char *in, size_t size, char *out) {
    char *to = out;
    for (size_t i = 0; i < size; i++) {
        unsigned char byte = (unsigned char)in[i];
        u->halved = !u->halved;
        if (u->halved) {
            u->half = byte;
            continue;
        }
        unsigned c = u->order == UTF16_BIG ? (unsigned)u->half << 8 | byte : (unsigned)byte << 8 | u->half;
        unsigned high = u->high;
        u->high = 0;
        if (high && c >= 0xdc00 && c < 0xe000)
            c = 0x10000 + ((high - 0xd800) << 10 | (c - 0xdc00));
        else if (high)
            to = put(to, 0xfffd);
        if (c >= 0xd800 && c < 0xdc00)
            u->high = c;
        else
            to = put(to, c >= 0xdc00 && c < 0xe000 ? 0xfffd : c);
    }
    return (size_t)(to - out);
}
