#include "base/base.h"

#include <math.h>
#include <nocturne/text.h>

/* Names come from files and from the command line: none of their control characters may reach a terminal. */
const char *noc_text_clean(char *text, size_t size, const char *from) {
    if (!text || !size)
        return "";
    from = from ? from : "";
    size_t n = strlen(from);
    if (n < size)
        memmove(text, from, n + 1);
    else
        noc_snprintf(text, size, "%.*s...", (int)size - 4, from);
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = ' ';
    return text;
}

size_t noc_text_utf8(const char *text) {
    const unsigned char *s = (const unsigned char *)(text ? text : "");
    if (s[0] < 0x80)
        return 1;
    size_t n = s[0] >= 0xf5 ? 0 : s[0] >= 0xf0 ? 4 : s[0] >= 0xe0 ? 3 : s[0] >= 0xc2 ? 2 : 0;
    for (size_t i = 1; i < n; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    /* overlong forms, surrogates, beyond U+10FFFF */
    if ((s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf0 && s[1] < 0x90) ||
        (s[0] == 0xf4 && s[1] > 0x8f))
        return 0;
    return n;
}

/* What YAML takes for no printable character, or for the end of a line. */
static bool must_be_escaped(unsigned code) {
    return code < 32 || (code >= 127 && code < 160) || code == 0x2028 || code == 0x2029 || code == 0xfeff ||
           code == 0xfffe || code == 0xffff;
}

int noc_text_yaml(char *text, size_t size, const char *from) {
    size_t length = 0;
    const char *s = from ? from : "";
    char piece[16];
#define PUT(...)                                                                                                       \
    do {                                                                                                               \
        int n_ = noc_snprintf(piece, sizeof(piece), __VA_ARGS__);                                                      \
        for (int i_ = 0; i_ < n_; i_++, length++)                                                                      \
            if (length + 1 < size)                                                                                     \
                text[length] = piece[i_];                                                                              \
    } while (0)
    PUT("\"");
    while (*s) {
        const unsigned char *u = (const unsigned char *)s;
        size_t n = noc_text_utf8(s);
        unsigned code = n == 2   ? (u[0] & 31u) << 6 | (u[1] & 63u)
                        : n == 3 ? (u[0] & 15u) << 12 | (u[1] & 63u) << 6 | (u[2] & 63u)
                                 : u[0];
        if (n && must_be_escaped(code))
            PUT("\\u%04x", code);
        else
            PUT("%s%.*s", *s == '"' || *s == '\\' ? "\\" : "", n ? (int)n : 1, s);
        s += n ? n : 1;
    }
    PUT("\"");
#undef PUT
    if (size)
        text[NOC_MIN(length, size - 1)] = 0;
    return (int)length;
}

const char *noc_text_count(char text[32], uint64_t n) {
    if (!text)
        return "";
    char digits[24];
    int count = noc_snprintf(digits, sizeof(digits), "%llu", (unsigned long long)n);
    char *out = text;
    for (int i = 0; i < count; i++) {
        if (i && (count - i) % 3 == 0)
            *out++ = ',';
        *out++ = digits[i];
    }
    *out = 0;
    return text;
}

const char *noc_text_many(char text[64], uint64_t n, const char *noun) {
    if (!text)
        return "";
    char count[32];
    noc_snprintf(text, 64, "%s %.28s%s", noc_text_count(count, n), noun ? noun : "", n == 1 ? "" : "s");
    return text;
}

const char *noc_text_bytes(char text[32], uint64_t n) {
    if (!text)
        return "";
    static const char *const units[] = { "bytes", "kB", "MB", "GB", "TB" };
    double v = (double)n;
    size_t unit = 0;
    for (; v >= 999.5 && unit < 4; unit++)
        v /= 1000;
    noc_snprintf(text, 32, unit && v < 9.95 ? "%.1f %s" : "%.0f %s", v, n == 1 ? "byte" : units[unit]);
    return text;
}

const char *noc_text_seconds(char text[32], double s) {
    if (!text)
        return "";
    if (s < 9.995)
        noc_snprintf(text, 32, "%.2f s", s);
    else if (s < 99.5)
        noc_snprintf(text, 32, "%.1f s", s);
    else if (s < 3599.5)
        noc_snprintf(text, 32, "%d min %02d s", (int)(s + 0.5) / 60, (int)(s + 0.5) % 60);
    else
        noc_snprintf(text, 32, "%.0f h %02.0f min", floor(s / 3600), floor(fmod(s, 3600) / 60));
    return text;
}

/* Edits (insert, delete, replace, swap neighbours) between two short words; long ones count as far apart. */
static int distance(const char *a, const char *b) {
    enum { MAX = 40 };
    int rows[3][MAX + 1];
    size_t n = strlen(a), m = strlen(b);
    if (n > MAX || m > MAX)
        return (int)(n > m ? n : m);
    for (size_t j = 0; j <= m; j++)
        rows[0][j] = (int)j;
    for (size_t i = 1; i <= n; i++) {
        int *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = (int)i;
        for (size_t j = 1; j <= m; j++) {
            int best = above[j - 1] + (a[i - 1] != b[j - 1]);
            best = above[j] + 1 < best ? above[j] + 1 : best;
            best = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && above2[j - 2] + 1 < best)
                best = above2[j - 2] + 1;
            row[j] = best;
        }
    }
    return rows[n % 3][m];
}

const char *noc_text_nearest(const char *word, const char *const *words, size_t count) {
    if (!word || !words)
        return NULL;
    size_t length = strlen(word);
    const char *nearest = NULL;
    int least = length < 4 ? 2 : 3 + (int)length / 6;
    for (size_t i = 0; i < count; i++) {
        int d = distance(word, words[i]);
        /* A word that was only begun: --cand for --candidates. */
        if (length >= 3 && !strncmp(word, words[i], length))
            d = 1;
        if (d < least && d < (int)strlen(words[i])) {
            least = d;
            nearest = words[i];
        }
    }
    return nearest;
}

bool noc_text_numbers(const char *text, char separator, size_t count, double *out) {
    if (!text || !out)
        return false;
    for (size_t i = 0; i < count; i++) {
        char number[400];
        size_t n = strspn(text, "+-.0123456789eE");
        if (!n || n >= sizeof(number) || text[n] != (i + 1 < count ? separator : 0))
            return false;
        memcpy(number, text, n);
        number[n] = 0;
        if (!noc_parse_double(number, &out[i]))
            return false;
        text += n + 1;
    }
    return true;
}
