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
        return MAX;
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
