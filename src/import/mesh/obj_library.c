#include "import/mesh/obj_library.h"

#include <math.h>

#define LEAST_BYTES 16 /* of a shorter one, Assimp forgets the stream */
_Static_assert(LEAST_BYTES < IMPORT_TAIL, "a short one is made longer where it lies");

static char *load(obj_folder *folder, const char *name, size_t *size) {
    char *data =
        import_read_named(folder->path, name, folder->anywhere, IMPORT_NAMED, folder->listener, size, &folder->why);
    folder->refused = folder->refused || (!data && !folder->why);
    while (data && *size < LEAST_BYTES)
        data[(*size)++] = '\n';
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

void obj_images_free(obj_images *images) {
    for (size_t i = 0; i < images->list.len; i++)
        free(images->list.data[i].name);
    array_free(&images->list);
    map_free(&images->of);
}

static const char *word_end(const char *p, const char *end) {
    while (p < end && !strchr(" \t\r", *p))
        p++;
    return p;
}

static const char *next_word(const char *p, const char *end) {
    while (p < end && strchr(" \t\r", *p) && *p)
        p++;
    return p;
}

/* The options before the name of an image (MTL, "Options for texture map statements"); returns where that begins. */
static const char *texture_options(const char *p, const char *end, obj_image *image) {
    static const struct {
        const char *word;
        int arguments; /* -1: up to three numbers */
    } known[] = { { "-blendu", 1 }, { "-blendv", 1 },  { "-bm", 1 },  { "-boost", 1 }, { "-cc", 1 },
                  { "-clamp", 1 },  { "-imfchan", 1 }, { "-mm", 2 },  { "-o", -1 },    { "-s", -1 },
                  { "-t", -1 },     { "-texres", 1 },  { "-type", 1 } };
    for (p = next_word(p, end); p < end && *p == '-';) {
        const char *word = p, *next = word_end(p, end);
        size_t n = (size_t)(next - word), k = 0;
        while (k < NOC_COUNT(known) && (strlen(known[k].word) != n || memcmp(known[k].word, word, n)))
            k++;
        if (k == NOC_COUNT(known))
            return p; /* a name that begins so */
        p = next_word(next, end);
        for (int i = 0; i < 3 && known[k].arguments < 0; i++) {
            double x;
            const char *behind = noc_scan_double(p, word_end(p, end), &x);
            if (!behind || behind != word_end(p, end) || !(fabs(x) < 1e6))
                break;
            if (i < 2 && (word[1] == 's' || word[1] == 'o'))
                (word[1] == 's' ? image->scale : image->offset)[i] = x;
            p = next_word(behind, end);
        }
        for (int i = 0; i < known[k].arguments; i++) {
            if (!strcmp(known[k].word, "-clamp"))
                image->clamp = (size_t)(word_end(p, end) - p) == 2 && !memcmp(p, "on", 2);
            p = next_word(word_end(p, end), end);
        }
    }
    return p;
}

/* What stands behind a keyword, without blanks and quotes around it. NULL: no memory. */
static char *text_behind(const char *p, const char *end) {
    p = next_word(p, end);
    while (end > p && strchr(" \t\r", end[-1]))
        end--;
    bool quoted = end - p >= 2 && *p == '"' && end[-1] == '"';
    return noc_strndup(p + quoted, (size_t)(end - p) - 2 * quoted);
}

/* false: no memory. */
static bool add_image(obj_images *images, const char *material, const char *p, const char *end) {
    obj_image image = { .scale = { 1, 1 } };
    image.name = text_behind(texture_options(p, end, &image), end);
    for (char *c = image.name; c && *c; c++)
        *c = *c == '\\' ? '/' : *c;
    bool named = image.name && *image.name;
    if (named && map_put(&images->of, material, images->list.len, NULL) && array_push(&images->list, image))
        return true;
    bool memory = image.name && !named;
    free(image.name);
    return memory;
}

/* Passes the image of a texture statement to the listener. false: no memory. */
static bool note_texture(const obj_folder *folder, const char *p, const char *end) {
    obj_image image = { .scale = { 1, 1 } };
    char *name = folder->listener ? text_behind(texture_options(p, end, &image), end) : NULL;
    for (char *c = name; c && *c; c++)
        *c = *c == '\\' ? '/' : *c;
    bool memory = !folder->listener || (name && (!*name || import_note_named(folder->listener, folder->path, name)));
    free(name);
    return memory;
}

/* false: no memory. */
static bool plain_statements(char *data, size_t size, const char *name, obj_images *images, const obj_folder *folder,
                             geo_issues *issues) {
    size_t line = 1;
    char *material = NULL;
    bool memory = true;
    for (char *p = data, *stop = data + size, *end; p < stop && memory; p = end + (end < stop), line++) {
        char *newline = memchr(p, '\n', (size_t)(stop - p)), *word = p, *behind, id[200];
        end = newline ? newline : stop;
        while (word < end && (*word == ' ' || *word == '\t'))
            word++;
        for (behind = word; behind < end && *behind != ' ' && *behind != '\t' && *behind != '\r';)
            behind++;
        size_t n = (size_t)(behind - word);
        int numbers = numbers_of(word, n);
        bool texture = (n > 4 && !memcmp(word, "map_", 4)) || (n == 4 && !memcmp(word, "bump", 4));
        bool diffuse = n == 6 && !memcmp(word, "map_Kd", 6);
        if (n == 6 && !memcmp(word, "newmtl", 6) && images) {
            free(material);
            memory = (material = text_behind(behind, end)) != NULL;
        }
        if (texture)
            memory = memory && note_texture(folder, behind, end);
        if (memory && diffuse && images && material)
            memory = add_image(images, material, behind, end);
        if (!n || *word == '#' || (numbers >= 0 && has_numbers(behind, end, numbers)))
            continue;
        snprintf(id, sizeof(id), "%.150s line %zu", name, line);
        if (texture && !diffuse && folder->textures)
            geo_issue(issues, GEO_GUESSED, "texture of another thing than the diffuse colour, which is not read", id);
        else if (numbers > 0)
            geo_issue(issues, GEO_SKIPPED, "material statement with a number that is none", id);
        memset(p, ' ', (size_t)(end - p));
    }
    free(material);
    return memory;
}

char *obj_open_library(obj_folder *folder, const char *name, size_t *size, obj_images *images, geo_issues *issues) {
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
    if (data && !plain_statements(data, *size, begin, images, folder, issues)) {
        folder->refused = true;
        free(data);
        data = NULL;
    }
    if (!data && !folder->refused && !folder->missing) {
        folder->missing = noc_format("%s%s cannot be read: %s", *begin == '/' ? "" : folder->path, begin, folder->why);
        folder->refused = !folder->missing;
    }
    free(trimmed);
    return data;
}
