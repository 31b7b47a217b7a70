/* nocturne/text.h: numbers as people read them, and what people write. The program, the laboratory's reports, and
 * programs that offer the option tables (nocturne/option.h) speak alike by these.
 *
 * Nothing here depends on the locale, and nothing but noc_text_save allocates. NULL where a text is needed reads as "".
 */
#ifndef NOCTURNE_TEXT_H
#define NOCTURNE_TEXT_H

#include <nocturne/log.h>

#ifdef __cplusplus
extern "C" {
#endif

/* These write into text and return it. */
NOC_API const char *noc_text_count(char text[32], uint64_t n);                  /* 1234567 -> "1,234,567" */
NOC_API const char *noc_text_many(char text[64], uint64_t n, const char *noun); /* "1 light", "1,234 lights" */
NOC_API const char *noc_text_bytes(char text[32], uint64_t n);                  /* "4.1 MB" */
NOC_API const char *noc_text_seconds(char text[32], double s);                  /* "0.42 s", "2 min 05 s" */
/* A copy of from in size bytes, cut short where it is longer: control characters become blanks, for names from files
 * may hold some, and none may reach a terminal. text may be from itself. */
NOC_API const char *noc_text_clean(char *text, size_t size, const char *from);

/* Bytes of the UTF-8 character that text begins with; 0: it begins with none. Of an empty text 1. */
NOC_API size_t noc_text_utf8(const char *text);
/* In double quotes, as YAML reads it where it is UTF-8. Like snprintf: the length that all of it takes. */
NOC_API int noc_text_yaml(char *text, size_t size, const char *from);

/* Which of the words was meant, by a mistake or two in its letters or by its beginning. NULL: none is near. */
NOC_API const char *noc_text_nearest(const char *word, const char *const *words, size_t count);

/* A name as a search compares it: without case and without marks on Latin letters. A hyphen is a blank, ß is ss, ae and
 * ä are a, "str." and a word's end "str" are "strasse". whole: it is a name; else a part of one is being typed, whose
 * last word may go on. free() it. NULL: no memory, or no text. */
NOC_API char *noc_text_fold(const char *text, bool whole);
/* Exactly count finite decimal numbers with the separator between them, such as "1.5,-3,2e3", and nothing else. */
NOC_API bool noc_text_numbers(const char *text, char separator, size_t count, double *out);

/* Writes size bytes into a file that has its name only when it is complete and on the disk: until then what was there
 * stays. It keeps the permissions of the file that it replaces, and a symbolic link to it. NOC_ERR_IO or
 * NOC_ERR_MEMORY after reporting to the log, and nothing is left; NOC_ERR_ARGUMENT without a path or text. */
NOC_API noc_status noc_text_save(const char *path, const char *text, size_t size, noc_log *log);

#ifdef __cplusplus
}
#endif
#endif
