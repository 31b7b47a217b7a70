#include "import/mesh/obj_library.h"
#include "import/import.h"

#include <math.h>

#define MOST_BYTES ((size_t)256 << 20)
#define LEAST_BYTES 16 /* of a shorter one, Assimp forgets the stream */

static char *load(obj_folder *folder, const char *name, size_t *size) {
    size_t stored;
    FILE *f = import_open_named(folder->path, name, folder->anywhere, &stored, &folder->why);
    if (f && stored > MOST_BYTES)
        folder->why = "is larger than 256 MB";
    char *data = f && stored <= MOST_BYTES ? noc_alloc_large(stored + LEAST_BYTES + 1, 1) : NULL;
    folder->refused = folder->refused || (!data && !folder->why);
    if (data) {
        *size = fread(data, 1, stored, f);
        while (*size < LEAST_BYTES)
            data[(*size)++] = '\n';
        data[*size] = 0;
    }
    if (f)
        fclose(f);
    return data;
}

/* Under the name itself, with its slashes turned, and as the file that its last part names. */
static char *find(obj_folder *folder, const char *name, size_t *size) {
    char *data = load(folder, name, size);
    if (data || folder->refused)
        return data;
    const char *why = folder->why; /* of the name as it is given */
    char *turned = noc_strdup(name);
    folder->refused = !turned;
    if (!turned)
        return NULL;
    for (char *p = turned; *p; p++)
        *p = *p == '\\' ? '/' : *p;
    const char *last = strrchr(turned, '/');
    data = load(folder, turned, size);
    if (!data && last)
        data = load(folder, last + 1, size);
    folder->why = why;
    free(turned);
    return data;
}

/* Each blank-separated name that can be opened, one text after the other; NULL if one cannot. */
static char *find_all(obj_folder *folder, char *names, size_t *size) {
    char *all = NULL, *rest = names, *name;
    *size = 0;
    while ((name = strtok_r(rest, " \t", &rest))) {
        size_t more;
        char *data = find(folder, name, &more), *longer = data ? noc_realloc(all, *size + more + 2) : NULL;
        if (!longer) {
            folder->refused = folder->refused || data;
            free(data);
            free(all);
            return NULL;
        }
        all = longer;
        memcpy(all + *size, data, more);
        free(data);
        *size += more;
        all[(*size)++] = '\n';
        all[*size] = 0;
    }
    return all;
}

/* How many numbers stand behind a keyword that Assimp reads; 0: it reads something else, -1: it reads none such. */
static int numbers_of(const char *word, size_t n) {
    static const struct {
        const char *word;
        int numbers;
    } known[] = {
        { "newmtl", 0 }, { "Ka", 3 }, { "Kd", 3 }, { "Ks", 3 }, { "Ke", 3 },    { "Tf", 3 },
        { "Ns", 1 },     { "Ni", 1 }, { "d", 1 },  { "Tr", 1 }, { "illum", 1 },
    };
    for (size_t i = 0; i < NOC_COUNT(known); i++)
        if (strlen(known[i].word) == n && !memcmp(known[i].word, word, n))
            return known[i].numbers;
    return -1;
}

static bool has_numbers(const char *p, const char *end, int count) {
    double x;
    for (int i = 0; i < count; i++)
        if (!(p = noc_scan_double(p, end, &x)) || !isfinite(x) || fabs(x) > 1e30)
            return false;
    return true;
}

static void plain_statements(char *data, size_t size, const char *name, geo_issues *issues) {
    size_t line = 1;
    for (char *p = data, *stop = data + size, *end; p < stop; p = end + (end < stop), line++) {
        char *newline = memchr(p, '\n', (size_t)(stop - p)), *word = p, *behind, id[200];
        end = newline ? newline : stop;
        while (word < end && (*word == ' ' || *word == '\t'))
            word++;
        for (behind = word; behind < end && *behind != ' ' && *behind != '\t' && *behind != '\r';)
            behind++;
        size_t n = (size_t)(behind - word);
        int numbers = numbers_of(word, n);
        bool texture = (n > 4 && !memcmp(word, "map_", 4)) || (n == 4 && !memcmp(word, "bump", 4));
        if (!n || *word == '#' || (numbers >= 0 && has_numbers(behind, end, numbers)))
            continue;
        snprintf(id, sizeof(id), "%.150s line %zu", name, line);
        if (texture)
            geo_issue(issues, GEO_GUESSED, "textures are not read, plain material", id);
        else if (numbers > 0)
            geo_issue(issues, GEO_SKIPPED, "material statement with a number that is none", id);
        memset(p, ' ', (size_t)(end - p));
    }
}

char *obj_open_library(obj_folder *folder, const char *name, size_t *size, geo_issues *issues) {
    char *trimmed = noc_strdup(name);
    folder->refused = folder->refused || !trimmed;
    if (!trimmed)
        return NULL;
    for (size_t n = strlen(trimmed); n && strchr(" \t\r", trimmed[n - 1]); n--)
        trimmed[n - 1] = 0;
    const char *begin = trimmed + strspn(trimmed, " \t\"");
    char *data = find(folder, begin, size);
    if (!data && strpbrk(begin, " \t")) {
        char *names = noc_strdup(begin);
        folder->refused = folder->refused || !names;
        data = names ? find_all(folder, names, size) : NULL;
        free(names);
    }
    if (data)
        plain_statements(data, *size, begin, issues);
    free(trimmed);
    return data;
}
