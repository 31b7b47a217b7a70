/* text.c: numbers straight from character data, which expat hands over in pieces of its own choosing. */
#include "import/citygml/citygml.h"

static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

/* Plain decimals of up to 19 digits: exact where the digits fit 2^53 and the power of ten is exact as well (the
 * quotient of two exact numbers is correctly rounded). NULL: anything else, for the slow way. */
static const char *scan_plain(const char *s, const char *end, double *out) {
    static const double pow10[] = { 1,    1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };
    const char *start = s;
    bool negative = *s == '-';
    s += negative || *s == '+';
    uint64_t v = 0;
    const char *first = s, *dot = NULL;
    for (; s < end; s++) {
        unsigned digit = (unsigned)(unsigned char)*s - '0';
        if (digit < 10)
            v = v * 10 + digit;
        else if (*s == '.' && !dot)
            dot = s;
        else
            break;
    }
    ptrdiff_t digits = s - first - (dot != NULL), decimals = dot ? s - dot - 1 : 0;
    if (digits < 1 || digits > 19 || v > (uint64_t)1 << 53 || decimals > 22 || s - start >= 64)
        return NULL;
    double d = (double)v / pow10[decimals];
    *out = negative ? -d : d;
    return s;
}

void cg_numbers_begin(cg_numbers *n, char decimal, char cs, char ts) {
    n->values.len = 0;
    n->token_len = 0;
    n->bad = n->many = n->after_cs = false;
    n->decimal = decimal;
    n->cs = cs;
    n->ts = ts;
    n->tuple = n->in_tuple = 0;
}

size_t cg_most_numbers = (size_t)1 << 25;

static void push(cg_numbers *n, double value) {
    if (n->values.len >= cg_most_numbers)
        n->many = true;
    else if (!array_push(&n->values, value))
        n->refused = true;
    n->in_tuple++;
}

/* The token is complete. */
static void end_token(cg_numbers *n) {
    double value;
    if (!n->token_len)
        return;
    n->token[n->token_len] = 0;
    if (noc_parse_double(n->token, &value))
        push(n, value);
    else
        n->bad = true;
    n->token_len = 0;
}

static void add_to_token(cg_numbers *n, char c) {
    if (n->token_len < sizeof(n->token) - 1)
        n->token[n->token_len++] = c;
    else
        n->bad = true; /* no number is that long */
}

static void end_tuple(cg_numbers *n) {
    if (!n->in_tuple)
        return;
    if (!n->tuple)
        n->tuple = n->in_tuple;
    else if (n->tuple != n->in_tuple)
        n->bad = true;
    n->in_tuple = 0;
}

/* Lists separated by blanks: the whole token is there unless it touches the end of the piece. */
static void add_list(cg_numbers *n, const char *s, const char *end) {
    while (s < end) {
        if (n->token_len == 0) {
            while (s < end && is_blank(*s))
                s++;
            double value;
            const char *stop = s < end ? scan_plain(s, end, &value) : NULL;
            if (stop && stop < end && is_blank(*stop)) {
                push(n, value);
                s = stop + 1;
                continue;
            }
        }
        for (; s < end && !is_blank(*s); s++)
            add_to_token(n, *s);
        if (s < end)
            end_token(n);
    }
}

/* gml:coordinates: separators of one's own choice, and blanks besides. */
static void add_tuples(cg_numbers *n, const char *s, const char *end) {
    for (; s < end; s++) {
        bool blank = is_blank(*s), tuple_ends = *s == n->ts || (blank && is_blank(n->ts));
        if (tuple_ends || *s == n->cs || blank) {
            end_token(n);
            if (tuple_ends && !(blank && n->after_cs)) /* "1, 2" is one tuple */
                end_tuple(n);
            n->after_cs = *s == n->cs || (blank && n->after_cs);
        } else {
            n->after_cs = false;
            add_to_token(n, *s == n->decimal ? '.' : *s);
        }
    }
}

void cg_numbers_add(cg_numbers *n, const char *text, size_t size) {
    if (n->bad || n->many)
        return;
    if (n->ts)
        add_tuples(n, text, text + size);
    else
        add_list(n, text, text + size);
}

void cg_numbers_end(cg_numbers *n) {
    end_token(n);
    if (n->ts)
        end_tuple(n);
}
