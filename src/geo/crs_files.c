#include "geo/crs_files.h"
#include "geo/geo.h"

#include <ctype.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- what PROJ opens ---- */

static const char strict_files[] = "strict", all_files[] = "all"; /* told apart by address */

static bool is_projs_own(const char *name) {
    const char *slash = strrchr(name, '/'), *base = slash ? slash + 1 : name;
    return !strcmp(base, "proj.db") || !strcmp(base, "proj.ini");
}

static PROJ_FILE_HANDLE *on_open(PJ_CONTEXT *context, const char *name, PROJ_OPEN_ACCESS access, void *user) {
    struct stat st;
    if ((user == strict_files && !is_projs_own(name)) || access != PROJ_OPEN_ACCESS_READ_ONLY || stat(name, &st) ||
        !S_ISREG(st.st_mode))
        return NULL;
    int fd = open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    FILE *f = fd >= 0 ? fdopen(fd, "rb") : NULL;
    if (!f && fd >= 0)
        close(fd);
    return (PROJ_FILE_HANDLE *)f;
}

static size_t on_read(PJ_CONTEXT *context, PROJ_FILE_HANDLE *f, void *to, size_t size, void *user) {
    return fread(to, 1, size, (FILE *)f);
}

static size_t on_write(PJ_CONTEXT *context, PROJ_FILE_HANDLE *f, const void *from, size_t size, void *user) {
    return 0;
}

static int on_seek(PJ_CONTEXT *context, PROJ_FILE_HANDLE *f, long long offset, int whence, void *user) {
    return fseeko((FILE *)f, (off_t)offset, whence) == 0;
}

static unsigned long long on_tell(PJ_CONTEXT *context, PROJ_FILE_HANDLE *f, void *user) {
    return (unsigned long long)ftello((FILE *)f);
}

static void on_close(PJ_CONTEXT *context, PROJ_FILE_HANDLE *f, void *user) { fclose((FILE *)f); }

static int on_exists(PJ_CONTEXT *context, const char *name, void *user) {
    struct stat st;
    return !stat(name, &st);
}

static int on_mkdir(PJ_CONTEXT *context, const char *name, void *user) { return 0; }
static int on_unlink(PJ_CONTEXT *context, const char *name, void *user) { return 0; }
static int on_rename(PJ_CONTEXT *context, const char *from, const char *to, void *user) { return 0; }

static void ignore_message(void *user, int level, const char *text) {
    (void)user, (void)level, (void)text; /* what matters becomes our own errors */
}

PJ_CONTEXT *crs_context_create(bool strict) {
    static const PROJ_FILE_API files = { 1,        on_open,   on_read,  on_write,  on_seek,  on_tell,
                                         on_close, on_exists, on_mkdir, on_unlink, on_rename };
    PJ_CONTEXT *context = proj.proj_context_create();
    if (!context)
        return NULL;
    proj.proj_log_func(context, NULL, ignore_message);
    proj.proj_context_set_fileapi(context, &files, (void *)(strict ? strict_files : all_files));
    proj.proj_context_set_enable_network(context, 0); /* grids that are not installed are not fetched */
    return context;
}

/* ---- what a definition names ---- */

/* Parameters of projections, ellipsoids, datums and units whose values are numbers or words of PROJ's. nadgrids is here
 * for
 * "@null" alone, which web Mercator is written with. */
static bool is_plain(const char *key, size_t n) {
    static const char *const plain[] = {
        "proj",    "zone",    "south",      "lat_0",    "lon_0",  "lat_1",  "lon_1", "lat_2",    "lon_2",  "lat_3",
        "lon_3",   "lat_ts",  "lat_b",      "lon_wrap", "lonc",   "k",      "k_0",   "x_0",      "y_0",    "z_0",
        "a",       "b",       "rf",         "f",        "es",     "e",      "R",     "R_A",      "R_V",    "R_a",
        "R_g",     "R_h",     "R_lat_a",    "R_lat_g",  "ellps",  "datum",  "units", "to_meter", "vunits", "vto_meter",
        "towgs84", "pm",      "axis",       "no_defs",  "wktext", "over",   "type",  "alpha",    "gamma",  "no_uoff",
        "no_off",  "h",       "sweep",      "tilt",     "azi",    "approx", "algo",  "title",    "o_proj", "o_lat_p",
        "o_lon_p", "o_alpha", "o_lon_c",    "o_lat_c",  "W",      "M",      "n",     "m",        "q",      "theta",
        "geoc",    "guam",    "hyperbolic", "czech",    "bf",
    };
    for (size_t i = 0; i < NOC_COUNT(plain); i++)
        if (strlen(plain[i]) == n && !memcmp(plain[i], key, n))
            return true;
    return false;
}

static bool say(char what[40], const char *text, size_t n) {
    snprintf(what, 40, "%.*s", (int)n, text);
    return true;
}

/* What parts words for PROJ, or did in some version; more is taken for a blank than any takes. */
static bool is_blank(char c) { return c && ((unsigned char)c <= ' ' || c == 127 || c == ';' || c == '\\'); }

static const char *skip_blanks(const char *p) {
    while (is_blank(*p))
        p++;
    return p;
}

/* Behind "@null" or "null"; NULL where the value is another. */
static const char *behind_null(const char *value) {
    value += *value == '@';
    return strncmp(value, "null", 4) ? NULL : value + 4;
}

/* Is a parameter's value no grid? A comma begins another one, with or without blanks before it. */
static bool is_null_value(const char *value) {
    const char *end = behind_null(value);
    return end && (!*end || is_blank(*end)) && *skip_blanks(end) != ',';
}

/* And a text of WKT that ends in a quote? Two of them are one that belongs to the text. */
static bool is_null_text(const char *text) {
    const char *end = behind_null(text);
    return end && end[0] == '"' && end[1] != '"';
}

/* A parameter begins where + or a blank or a quote was: "+nadgrids=x", "proj=merc nadgrids=x". */
static bool begins_word(const char *text, const char *p) {
    return p == text || is_blank(p[-1]) || strchr("+\"'", p[-1]);
}

static size_t word_length(const char *p) {
    size_t n = 0;
    while (isalnum((unsigned char)p[n]) || p[n] == '_')
        n++;
    return n;
}

static bool is_word(const char *p, size_t n, const char *word) { return strlen(word) == n && !memcmp(p, word, n); }

/* The value behind a key of n letters; NULL: there is no =. PROJ takes the blanks around it away, and every + behind a
 * blank. */
static const char *value_of(const char *key, size_t n) {
    const char *p = skip_blanks(key + n);
    if (*p != '=')
        return NULL;
    p++;
    while (is_blank(*p) || *p == '+')
        p++;
    return p;
}

/* Methods of WKT and PROJJSON that are PROJ's by name: their parameters' names become its text, whatever they hold. */
static const char *projs_method(const char *text) {
    for (const char *p = text; (p = strcasestr(p, "PROJ")); p++)
        if (p > text && (p[-1] == '"' || p[-1] == '\x9c') && (is_blank(p[4]) || p[4] == '-'))
            return p;
    return NULL;
}

/* Does the text hold parameters of PROJ's? Elsewhere an = means nothing to it. */
static bool has_parameters(const char *text) {
    for (const char *p = text; (p = strpbrk(p, "pi")); p++)
        if ((!strncmp(p, "proj", 4) || !strncmp(p, "init", 4)) && value_of(p, 4))
            return true;
    return false;
}

bool crs_text_names_file(const char *definition, char what[40]) {
    const char *method = projs_method(definition);
    if (method)
        return say(what, method, strcspn(method, "\""));
    if (!has_parameters(definition))
        return false;
    for (const char *p = definition; *p; p++) {
        if (!isalpha((unsigned char)*p) || !begins_word(definition, p))
            continue;
        size_t n = word_length(p);
        const char *value = value_of(p, n);
        bool step = p > definition && p[-1] == '+' && is_word(p, n, "step");
        bool grid = value && is_word(p, n, "nadgrids") && is_null_value(value);
        bool operation = value && is_word(p, n, "proj") &&
                         (!strncmp(value, "pipeline", 8) || strstr(value, "gridshift") == value + 1);
        if (step || operation || (value && !grid && !is_plain(p, n)))
            return say(what, p, n);
    }
    return false;
}

bool crs_names_file(PJ_CONTEXT *context, const PJ *crs, char what[40]) {
    static const char parameter[] = "PARAMETERFILE[";
    const char *wkt = proj.proj_as_wkt(context, crs, PJ_WKT2_2019, NULL);
    if (!wkt)
        return say(what, "what cannot be written as WKT", 29);
    for (const char *p = wkt; (p = strstr(p, parameter)); p++) {
        const char *comma = strchr(p, ','), *quote = comma ? strchr(comma, '"') : NULL;
        if (!quote || !is_null_text(quote + 1))
            return say(what, parameter, strlen(parameter) - 1);
    }
    return crs_text_names_file(wkt, what);
}

/* Is what is named behind a keyword of WKT, as in PARAMETERFILE["name","@null"], no grid? begin: what comes before the
 * name. */
static bool is_null_behind(const char *p, const char *begin, bool named) {
    size_t n = strlen(begin);
    if (strncmp(p, begin, n))
        return false;
    p += n;
    if (named) {
        p += strcspn(p, "\",");
        if (strncmp(p, "\",\"", 3))
            return false;
        p += 3;
    }
    return is_null_text(p);
}

/* "DICT:FILE,CODE", which GDAL looks for in a file, wherever a word may begin: a prefix may stand before it. */
static bool names_dictionary(const char *text) {
    static const char dictionary[] = "DICT:";
    for (const char *p = text; (p = strcasestr(p, dictionary)); p++)
        if ((p == text || !isalnum((unsigned char)p[-1])) && strchr(p, ','))
            return true;
    return false;
}

bool geo_crs_text_names_file(const char *text, char what[40]) {
    static const char file[] = "PARAMETERFILE", grids[] = "PROJ4_GRIDS", value[] = "\"value\"", esri[] = "ESRI::";
    const char *begin = skip_blanks(text);
    while (!strncasecmp(begin, esri, strlen(esri))) /* GDAL leaves it out */
        begin = skip_blanks(begin + strlen(esri));
    if (names_dictionary(text))
        return say(what, "DICT", 4);
    for (const char *p = text; (p = strcasestr(p, file)); p += strlen(file))
        if (!is_null_behind(p + strlen(file), "[\"", true))
            return say(what, file, strlen(file));
    for (const char *p = text; (p = strcasestr(p, grids)); p += strlen(grids))
        if (!is_null_behind(p + strlen(grids), "\",\"", false))
            return say(what, grids, strlen(grids));
    if (*begin == '{' && strchr(text, '\\'))
        return say(what, "an escape in PROJJSON", 21);
    for (const char *p = *begin == '{' ? text : ""; (p = strstr(p, value)); p++) { /* that of a parameter is a number */
        const char *q = p + strlen(value);
        q += strspn(q, " \t\r\n:");
        if (*q == '"')
            return say(what, q, strcspn(q + 1, "\"") + 2);
    }
    return crs_text_names_file(text, what);
}
