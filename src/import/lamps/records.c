/* Records of a table: commas, semicolons, tabs or bars between fields, quotes as in RFC 4180, UTF-8, UTF-16 or
 * Windows-1252, which Latin-1 is a part of. */
#include "import/lamps/records.h"

#include <nocturne/text.h>

#define MAX_FIELD (1 << 20)
#define MAX_FIELDS 4096

/* The next piece; len 0: there is none. */
static noc_status fill(csv *c) {
    c->pos = c->len = 0;
    if (!c->units.order)
        return noc_stream_read(c->stream, c->chunk, sizeof(c->chunk), &c->len);
    noc_status status = NOC_OK;
    for (size_t got = 1; got && !c->len && !status;) {
        status = noc_stream_read(c->stream, c->raw, sizeof(c->raw), &got);
        c->len = status ? 0 : utf16_decode(&c->units, c->raw, got, c->chunk);
    }
    return status;
}

/* The first piece, which tells whether there are two bytes a character. */
static noc_status first_piece(csv *c) {
    size_t got;
    noc_status status = noc_stream_rewind(c->stream);
    if (!status)
        status = noc_stream_read(c->stream, c->raw, sizeof(c->raw), &got);
    c->pos = c->len = 0;
    c->next_line = 1;
    c->again = false;
    if (status)
        return status;
    c->units = (utf16){ .order = utf16_order_of(c->raw, got) };
    if (c->units.order)
        c->len = utf16_decode(&c->units, c->raw, got, c->chunk);
    else
        memcpy(c->chunk, c->raw, c->len = got);
    c->pos = c->len >= 3 && !memcmp(c->chunk, "\xef\xbb\xbf", 3) ? 3 : 0;
    return NOC_OK;
}

/* Next byte, -1 at the end, -2 on an error that was reported. */
static int next_byte(csv *c, noc_status *status) {
    if (c->pos == c->len) {
        *status = fill(c);
        if (*status || !c->len) {
            c->len = 0;
            return *status ? -2 : -1;
        }
    }
    return (unsigned char)c->chunk[c->pos++];
}

/* How many of the next bytes are a field's text and nothing else; 0 where the next one must be looked at, or read. */
static size_t plain_run(const csv *c, bool quoted) {
    const bool *special = c->special[quoted];
    size_t end = c->pos;
    while (end < c->len && !special[(unsigned char)c->chunk[end]])
        end++;
    return end - c->pos;
}

static noc_status bad(csv *c, const char *cause) {
    return noc_error(c->log, NOC_ERR_FORMAT, "%s:%zu: %s", noc_stream_name(c->stream), c->line, cause);
}

static noc_status no_memory(csv *c) { return noc_no_memory(c->log, noc_stream_name(c->stream)); }

static bool is_utf8(const char *s) {
    for (size_t n; *s; s += n)
        if (!(n = (unsigned char)*s < 0x80 ? 1 : noc_text_utf8(s)))
            return false;
    return true;
}

/* Makes UTF-8 of the last field, which ends with a 0, where it is Windows-1252. */
static bool make_utf8(csv *c, size_t field) {
    static const uint16_t at_80[32] = { 0x20ac, 0x81,   0x201a, 0x192,  0x201e, 0x2026, 0x2020, 0x2021,
                                        0x2c6,  0x2030, 0x160,  0x2039, 0x152,  0x8d,   0x17d,  0x8f,
                                        0x90,   0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                        0x2dc,  0x2122, 0x161,  0x203a, 0x153,  0x9d,   0x17e,  0x178 };
    if (is_utf8(c->text.data + field))
        return true;
    size_t size = c->text.len - field;
    char *from = noc_alloc(size);
    bool memory = from != NULL;
    if (memory)
        memcpy(from, c->text.data + field, size);
    c->text.len = field;
    for (size_t i = 0; i < size && memory; i++) {
        unsigned u = (unsigned char)from[i];
        u = u >= 0x80 && u < 0xa0 ? at_80[u - 0x80] : u;
        const char bytes[3] = { (char)(0xe0 | u >> 12), (char)(0x80 | (u >> 6 & 63)), (char)(0x80 | (u & 63)) };
        const char two[2] = { (char)(0xc0 | u >> 6), bytes[2] }, one = (char)u;
        memory = u < 0x80    ? array_push(&c->text, one)
                 : u < 0x800 ? array_append(&c->text, two, 2)
                             : array_append(&c->text, bytes, 3);
    }
    free(from);
    return memory;
}

noc_status csv_read(csv *c) {
    noc_status status = NOC_OK;
    if (c->again) {
        c->again = false;
        return NOC_OK;
    }
    c->text.len = c->start.len = 0;
    c->line = c->next_line;
    bool quoted = false, was_quoted = false;
    for (size_t field = 0;;) {
        size_t run = plain_run(c, quoted);
        if (run) {
            if (c->text.len - field + run > MAX_FIELD + 1)
                return bad(c, "a field longer than 1 MB");
            if (!array_append(&c->text, c->chunk + c->pos, run))
                return no_memory(c);
            c->pos += run;
            was_quoted = false;
            continue;
        }
        int ch = next_byte(c, &status);
        if (ch == -2)
            return status;
        if (ch == -1 && quoted)
            return bad(c, "a quote is not closed before the end of the file");
        if (ch == -1 && !c->start.len && c->text.len == 0)
            return NOC_OK;
        if (ch == 0)
            return bad(c, "a zero byte: this is no text");
        if (ch == '\n')
            c->next_line++;
        bool end_record = ch == -1 || (ch == '\n' && !quoted);
        if (quoted && ch == '"') {
            quoted = false; /* a second one, at once, is a quote in the text */
            was_quoted = true;
            continue;
        }
        if (!quoted && ch == '"' && (c->text.len == field || was_quoted)) {
            if (was_quoted && !array_push(&c->text, '"'))
                return no_memory(c);
            quoted = true;
            was_quoted = false;
            continue;
        }
        was_quoted = false;
        if (!end_record && (quoted || ch != c->separator)) {
            if (c->text.len - field > MAX_FIELD)
                return bad(c, "a field longer than 1 MB");
            if (!array_push(&c->text, (char)ch))
                return no_memory(c);
            continue;
        }
        if (end_record && c->text.len > field && c->text.data[c->text.len - 1] == '\r')
            c->text.len--;
        if (c->start.len == MAX_FIELDS)
            return bad(c, "more than 4096 columns");
        if (!array_push(&c->text, '\0') || !make_utf8(c, field) || !array_push(&c->start, field))
            return no_memory(c);
        field = c->text.len;
        if (end_record)
            return NOC_OK;
    }
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

/* The separator that is found most often in the first line, outside quotes; 0 if there is none. Beside others a comma
 * between digits is a decimal sign. */
char csv_separator(const char *head, size_t size) {
    static const char separators[] = ",;\t|";
    size_t count[4] = { 0 }, signs = 0;
    bool quoted = false;
    for (size_t i = 0; i < size && head[i] && (quoted || head[i] != '\n'); i++) {
        const char *s = strchr(separators, head[i]);
        quoted ^= head[i] == '"';
        if (!s || quoted)
            continue;
        count[s - separators]++;
        signs += *s == ',' && i && i + 1 < size && is_digit(head[i - 1]) && is_digit(head[i + 1]);
    }
    count[0] -= count[1] || count[2] || count[3] ? signs : 0;
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (count[i] > count[best])
            best = i;
    return count[best] ? separators[best] : 0;
}

noc_status csv_start(csv *c) {
    noc_status status = first_piece(c);
    if (status)
        return status;
    c->separator = csv_separator(c->chunk + c->pos, c->len - c->pos);
    for (int quoted = 0; quoted < 2; quoted++) {
        memset(c->special[quoted], 0, sizeof(c->special[quoted]));
        c->special[quoted][0] = c->special[quoted]['\n'] = c->special[quoted]['"'] = true;
    }
    c->special[0][(unsigned char)c->separator] = true;
    return NOC_OK;
}

void csv_free(csv *c) {
    array_free(&c->text);
    array_free(&c->start);
    free(c);
}
