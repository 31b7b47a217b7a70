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
    if ((user == strict_files && !is_projs_own(name)) || access != PROJ_OPEN_ACCESS_READ_ONLY || stat(name, &st) || !S_ISREG(st.st_mode))
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

static size_t on_write(PJ_CONTEXT *context, PROJ_FILE_HANDLE *f, const void *from, size_t size, void *user) { return 0; }

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
    static const PROJ_FILE_API files = { 1, on_open, on_read, on_write, on_seek, on_tell, on_close, on_exists, on_mkdir, on_unlink, on_rename };
    PJ_CONTEXT *context = proj_context_create();
    if (!context)
        return NULL;
    proj_log_func(context, NULL, ignore_message);
    proj_context_set_fileapi(context, &files, (void *)(strict ? strict_files : all_files));
    proj_context_set_enable_network(context, 0); /* grids that are not installed are not fetched */
    return context;
}

/* ---- what a definition names ---- */

/* Parameters of projections, ellipsoids, datums and units whose values are numbers or words of PROJ's. nadgrids is here for
 * "@null" alone, which web Mercator is written with. */
static bool is_plain(const char *key, size_t n) {
    static const char *const plain[] = {
        "proj", "zone", "south", "lat_0", "lon_0", "lat_1", "lon_1", "lat_2", "lon_2", "lat_3", "lon_3", "lat_ts", "lat_b", "lon_wrap",
        "lonc", "k", "k_0", "x_0", "y_0", "z_0", "a", "b", "rf", "f", "es", "e", "R", "R_A", "R_V", "R_a", "R_g", "R_h", "R_lat_a",
        "R_lat_g", "ellps", "datum", "units", "to_meter", "vunits", "vto_meter", "towgs84", "pm", "axis", "no_defs", "wktext", "over",
        "type", "alpha", "gamma", "no_uoff", "no_off", "h", "sweep", "tilt", "azi", "approx", "algo", "title", "o_proj", "o_lat_p",
        "o_lon_p", "o_alpha", "o_lon_c", "o_lat_c", "W", "M", "n", "m", "q", "theta", "geoc", "guam", "hyperbolic", "czech", "bf",
    };
    for (size_t i = 0; i < NOC_COUNT(plain); i++)
        if (strlen(plain[i]) == n && !memcmp(plain[i], key, n))
            return true;
    return false;
}

static bool is_null_grid(const char *value) {
    value += *value == '@';
    return !strncmp(value, "null", 4) && !isalnum((unsigned char)value[4]) && !strchr("_-./,", value[4] ? value[4] : ' ');
}

static bool say(char what[40], const char *text, size_t n) {
    snprintf(what, 40, "%.*s", (int)n, text);
    return true;
}

/* A parameter begins where + or a blank or a quote was: "+nadgrids=x", "proj=merc nadgrids=x". */
static bool begins_word(const char *text, const char *p) { return p == text || isspace((unsigned char)p[-1]) || strchr("+\"'", p[-1]); }

bool crs_text_names_file(const char *definition, char what[40]) {
    if (!strstr(definition, "proj=") && !strstr(definition, "init=")) /* elsewhere an = means nothing to PROJ */
        return false;
    for (const char *p = definition; *p; p++) {
        if (!isalpha((unsigned char)*p) || !begins_word(definition, p))
            continue;
        size_t n = 0;
        while (isalnum((unsigned char)p[n]) || p[n] == '_')
            n++;
        bool grid = n == 8 && !memcmp(p, "nadgrids", 8) && p[n] == '=' && is_null_grid(p + n + 1);
        bool step = p > definition && p[-1] == '+' && n == 4 && !memcmp(p, "step", 4);
        bool operation = n == 4 && !memcmp(p, "proj", 4) && (strstr(p + n, "=pipeline") == p + n || strstr(p + n, "gridshift") == p + n + 2);
        if (step || operation || (p[n] == '=' && !grid && !is_plain(p, n)))
            return say(what, p, n);
    }
    return false;
}

bool crs_names_file(PJ_CONTEXT *context, const PJ *crs, char what[40]) {
    static const char parameter[] = "PARAMETERFILE[";
    const char *wkt = proj_as_wkt(context, crs, PJ_WKT2_2019, NULL);
    if (!wkt)
        return say(what, "what cannot be written as WKT", 29);
    for (const char *p = wkt; (p = strstr(p, parameter)); p++) {
        const char *comma = strchr(p, ','), *quote = comma ? strchr(comma, '"') : NULL;
        if (!quote || !is_null_grid(quote + 1))
            return say(what, parameter, strlen(parameter) - 1);
    }
    return crs_text_names_file(wkt, what);
}

/* Is what is named behind a keyword of WKT, as in PARAMETERFILE["name","@null"], no grid? begin: what comes before the name. */
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
    return is_null_grid(p);
}

/* "+init=epsg:25832", as older programs write it: PROJ has these in its database. */
static bool is_epsg_init(const char *text) {
    static const char init[] = "+init=epsg:";
    text += strspn(text, " ");
    if (strncasecmp(text, init, strlen(init)))
        return false;
    text += strlen(init);
    return *text && !text[strspn(text, "0123456789")];
}

bool geo_crs_text_names_file(const char *text, char what[40]) {
    static const char file[] = "PARAMETERFILE", grids[] = "PROJ4_GRIDS", value[] = "\"value\"", dictionary[] = "DICT:";
    const char *begin = text + strspn(text, " \t\r\n");
    if (is_epsg_init(text))
        return false;
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
    if (!strncasecmp(begin, dictionary, strlen(dictionary)))
        return say(what, dictionary, strlen(dictionary) - 1);
    return crs_text_names_file(text, what);
}
