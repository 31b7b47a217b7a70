/* The many ways in which files name one and the same CRS. */
#include "geo/crs_spelling.h"

#include <ctype.h>
#include <stdio.h>

/* Registries whose codes PROJ knows. */
static const char *const authorities[] = { "EPSG", "ESRI", "OGC", "IGNF", "IAU_2015" };

/* Names that PROJ would take for something else (CH1903 is also the name of a geographic CRS) or does not know.
 * The urn:adv names are those of the German survey's GeoInfoDok, "Koordinatenreferenzsysteme". */
static const struct {
    const char *name, *crs;
} names[] = {
    { "CH1903", "EPSG:21781" },
    { "CH1903/LV03", "EPSG:21781" },
    { "CH1903_LV03", "EPSG:21781" },
    { "LV03", "EPSG:21781" },
    { "CH1903+", "EPSG:2056" },
    { "CH1903+/LV95", "EPSG:2056" },
    { "CH1903+_LV95", "EPSG:2056" },
    { "LV95", "EPSG:2056" },
    { "WGS84", "EPSG:4326" },
    { "CRS84", "OGC:CRS84" },
    { "RD", "EPSG:28992" },
    { "RDNew", "EPSG:28992" },
    { "S-JTSK", "EPSG:5514" },
    { "S-JTSK/KrovakEastNorth", "EPSG:5514" },
    { "ETRS89_UTM31", "EPSG:25831" },
    { "ETRS89_UTM32", "EPSG:25832" },
    { "ETRS89_UTM33", "EPSG:25833" },
    { "ETRS89_Lat-Lon", "EPSG:4258" },
    { "ETRS89_Lat-Lon-h", "EPSG:4258" },
    { "WGS84_Lat-Lon", "EPSG:4326" },
    { "WGS84_Lat-Lon-h", "EPSG:4326" },
    { "WGS84_UTM31", "EPSG:32631" },
    { "WGS84_UTM32", "EPSG:32632" },
    { "WGS84_UTM33", "EPSG:32633" },
    { "DE_DHDN_3GK2", "EPSG:31466" },
    { "DE_DHDN_3GK3", "EPSG:31467" },
    { "DE_DHDN_3GK4", "EPSG:31468" },
    { "DE_DHDN_3GK5", "EPSG:31469" },
    { "DE_DHDN_SoldnerBerlin", "EPSG:3068" },
    { "DE_42-83_3GK3", "EPSG:2397" },
    { "DE_42-83_3GK4", "EPSG:2398" },
    { "DE_42-83_3GK5", "EPSG:2399" },
    { "DE_PD-83_3GK3", "EPSG:3396" },
    { "DE_PD-83_3GK4", "EPSG:3397" },
    { "DE_RD-83_3GK4", "EPSG:3398" },
    { "DE_RD-83_3GK5", "EPSG:3399" },
};

/* "EPSG:25832"; false if the code is empty, too long, or not made of letters, digits, '_', '-' and '.'. */
static bool put(char out[48], const char *authority, const char *code, size_t code_size) {
    while (code_size && isspace((unsigned char)*code))
        code++, code_size--;
    while (code_size && isspace((unsigned char)code[code_size - 1]))
        code_size--;
    if (!code_size || code_size > 24)
        return false;
    bool digits = true;
    for (size_t i = 0; i < code_size; i++) {
        if (!isalnum((unsigned char)code[i]) && !strchr("_-.", code[i]))
            return false;
        digits = digits && isdigit((unsigned char)code[i]);
    }
    if (!digits && !strcmp(authority, "EPSG"))
        return false;
    if (!strcmp(authority, "EPSG") && code_size == 6 && !memcmp(code, "900913", 6))
        code = "3857", code_size = 4; /* an old nickname of web Mercator, never registered */
    snprintf(out, 48, "%s:%.*s", authority, (int)code_size, code);
    for (char *c = out; *c; c++)
        *c = (char)toupper((unsigned char)*c);
    size_t size = strlen(out);
    if (!strncmp(out, "OGC:", 4) && out[size - 1] == 'H') /* CRS84h: PROJ tells cases apart */
        out[size - 1] = 'h';
    return true;
}

static const char *authority_of(const char *text, size_t size) {
    for (size_t i = 0; i < NOC_COUNT(authorities); i++)
        if (strlen(authorities[i]) == size && !strncasecmp(text, authorities[i], size))
            return authorities[i];
    return NULL;
}

static bool lookup(const char *name, size_t size, char out[48]) {
    /* blanks never matter: "CH1903+ / LV95" */
    char packed[48];
    size_t n = 0;
    for (size_t i = 0; i < size; i++)
        if (!isspace((unsigned char)name[i])) {
            if (n + 1 >= sizeof(packed))
                return false;
            packed[n++] = name[i];
        }
    packed[n] = 0;
    for (size_t i = 0; i < NOC_COUNT(names); i++)
        if (noc_ieq(packed, names[i].name)) {
            snprintf(out, 48, "%s", names[i].crs);
            return true;
        }
    return false;
}

/* One component: fields between separators, of which one is an authority and the last that is not empty the code, as in
 * EPSG:6.12:25833, crs:EPSG::5783, def/crs/EPSG/0/6697. What comes before "crs" is a namespace
 * (urn:ogc:def:crs:EPSG::4326). */
static bool parse_component(const char *s, size_t size, char separator, char out[48]) {
    const char *authority = NULL, *code = NULL;
    size_t code_size = 0;
    for (const char *p = s, *end = s + size; p <= end;) {
        const char *stop = memchr(p, separator, (size_t)(end - p));
        if (!stop)
            stop = end;
        const char *a = authority_of(p, (size_t)(stop - p));
        if (a || (stop - p == 3 && !strncasecmp(p, "crs", 3))) {
            authority = a;
            code_size = 0;
        } else if (authority && stop > p) {
            code = p;
            code_size = (size_t)(stop - p);
        }
        p = stop + 1;
    }
    return authority && code_size && put(out, authority, code, code_size);
}

/* Components of a compound spelling one after the other; the first that parses is horizontal, the second vertical. */
static bool parse_components(const char *s, const char *between, char separator, crs_spelling *out) {
    bool found = false;
    for (;;) {
        size_t n = strcspn(s, between);
        char text[48];
        if (parse_component(s, n, separator, text)) {
            if (found) {
                memcpy(out->vertical, text, sizeof(text));
                return true;
            }
            memcpy(out->horizontal, text, sizeof(text));
            found = true;
        } else if (found && n) {
            /* "EPSG:25832+5783" */
            put(out->vertical, "EPSG", s, n);
        }
        if (!s[n])
            return found;
        s += n + 1;
    }
}

/* urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH*GCG2016: horizontal, height and geoid, between stars. Regional variants of a
 * datum end in "_" and a short name (DE_DHDN_3GK2_NW101): they are the same projection. */
static bool parse_adv(const char *s, crs_spelling *out) {
    size_t n = strcspn(s, "*");
    if (lookup(s, n, out->horizontal))
        return true;
    while (n && s[n - 1] != '_')
        n--;
    return n > 1 && lookup(s, n - 1, out->horizontal);
}

static bool starts(const char *s, const char *with) { return !strncasecmp(s, with, strlen(with)); }

static bool parse_url(const char *s, crs_spelling *out) {
    const char *hash = strchr(s, '#');
    if (hash) /* http://www.opengis.net/gml/srs/epsg.xml#4326 */
        return put(out->horizontal, "EPSG", hash + 1, strlen(hash + 1));
    const char *query = strchr(s, '?');
    if (query) /* .../def/crs-compound?1=http://...&2=http://... */
        return parse_components(query + 1, "&", '/', out);
    return parse_components(s, "&", '/', out);
}

bool crs_spelling_parse(const char *definition, crs_spelling *out) {
    *out = (crs_spelling){ 0 };
    char text[512];
    while (isspace((unsigned char)*definition))
        definition++;
    size_t n = strlen(definition);
    while (n && isspace((unsigned char)definition[n - 1]))
        n--;
    if (!n || n >= sizeof(text))
        return false;
    memcpy(text, definition, n);
    text[n] = 0;
    if (starts(text, "http://") || starts(text, "https://"))
        return parse_url(text, out);
    if (starts(text, "urn:adv:crs:"))
        return parse_adv(text + 12, out);
    if (starts(text, "urn:"))
        return parse_components(text, ",+", ':', out);
    if (strspn(text, "0123456789") == n)
        return put(out->horizontal, "EPSG", text, n);
    size_t word = strcspn(text, ": ");
    if (text[word] && authority_of(text, word)) {
        char *paren = strchr(text, '('); /* our own "EPSG:25832 (ETRS89 / UTM zone 32N)" */
        if (paren)
            *paren = 0;
        text[word] = ':';
        return parse_components(text, ",+;", ':', out);
    }
    return parse_adv(text, out);
}
