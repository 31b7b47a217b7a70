/* The words of lamps: column names and tag keys, light sources, fixtures, mounts, in the languages that open data about
 * street lamps comes in (English, German, Dutch, French, Spanish, Italian, Portuguese, Czech, Polish, Nordic). */
#include "import/lamps/tags.h"

#include <pthread.h>

/* Base letters of U+00C0..U+017F; '*' is a pair of letters, ' ' no letter. */
static const char base_letters[] = "aaaaaa*ceeeeiiiidnooooo ouuuuy**aaaaaa*ceeeeiiiidnooooo ouuuuy*y"
                                   "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiii**jjkkklllllll"
                                   "lllnnnnnnnnnoooooo**rrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzzs";

/* One code point of UTF-8; a byte that is not UTF-8 is taken as Latin-1, which old municipal tables still are. */
static unsigned next_code(const unsigned char **s) {
    const unsigned char *p = *s;
    *s = p + 1;
    if (p[0] >= 0xc2 && p[0] < 0xe0 && (p[1] & 0xc0) == 0x80) {
        *s = p + 2;
        return (p[0] & 31u) << 6 | (p[1] & 63u);
    }
    if (p[0] >= 0xe0 && p[0] < 0xf0 && (p[1] & 0xc0) == 0x80 && (p[2] & 0xc0) == 0x80) {
        *s = p + 3;
        return (p[0] & 15u) << 12 | (p[1] & 63u) << 6 | (p[2] & 63u);
    }
    return p[0];
}

static const char *fold_code(unsigned c, char one[2]) {
    one[1] = 0;
    if (c < 0x80) {
        bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z');
        one[0] = letter ? (char)(c >= 'A' && c <= 'Z' ? c + 32 : c) : 0;
        return one;
    }
    if (c < 0xc0 || c - 0xc0 >= sizeof(base_letters) - 1) {
        one[0] = 0;
        return one;
    }
    if (c == 0xc6 || c == 0xe6)
        return "ae";
    if (c == 0xdf)
        return "ss";
    if (c == 0xde || c == 0xfe)
        return "th";
    if (c == 0x132 || c == 0x133)
        return "ij";
    if (c == 0x152 || c == 0x153)
        return "oe";
    one[0] = base_letters[c - 0xc0] == ' ' ? 0 : base_letters[c - 0xc0];
    return one;
}

size_t lamp_fold(const char *text, bool blanks, char *out, size_t size) {
    size_t n = 0;
    bool gap = false;
    for (const unsigned char *p = (const unsigned char *)(text ? text : ""); *p && n + 3 < size;) {
        if ((*p >= 'a' && *p <= 'z') || (*p >= '0' && *p <= '9')) { /* nearly all of them, unless they are capitals */
            if (gap && blanks)
                out[n++] = ' ';
            gap = false;
            out[n++] = (char)*p++;
            continue;
        }
        char one[2];
        const char *s = fold_code(next_code(&p), one);
        if (!*s) {
            gap = n > 0;
            continue;
        }
        if (gap && blanks)
            out[n++] = ' ';
        gap = false;
        while (*s)
            out[n++] = *s++;
    }
    out[n] = 0;
    return n;
}

#define F(name) LAMP_FIELD_##name
/* key, field, rank, strength */
/* clang-format off */
static const lamp_column columns[] = {
    /* height of the light */
    { "lightheight", F(HEIGHT), 0, 2 }, { "lampheight", F(HEIGHT), 0, 2 }, { "luminaireheight", F(HEIGHT), 0, 2 },
    { "fixtureheight", F(HEIGHT), 0, 1 }, { "mountingheight", F(HEIGHT), 0, 1 }, { "mountheight", F(HEIGHT), 0, 1 },
    { "lichtpunthoogte", F(HEIGHT), 0, 2 }, { "lichtpunkthohe", F(HEIGHT), 0, 2 },
    { "lichtpunkthoehe", F(HEIGHT), 0, 2 },
    { "hauteurfeu", F(HEIGHT), 0, 2 }, { "hauteurdefeu", F(HEIGHT), 0, 2 }, { "hauteurlumiere", F(HEIGHT), 0, 2 },
    { "lyspunkthojde", F(HEIGHT), 0, 2 }, { "leuchtenhohe", F(HEIGHT), 0, 2 }, { "leuchtenhoehe", F(HEIGHT), 0, 2 },
    { "height", F(HEIGHT), 1, 0 }, { "heightm", F(HEIGHT), 1, 0 }, { "poleheight", F(HEIGHT), 1, 1 },
    { "poleht", F(HEIGHT), 1, 1 }, { "polelength", F(HEIGHT), 1, 1 }, { "columnheight", F(HEIGHT), 1, 1 },
    { "mastlengte", F(HEIGHT), 1, 1 }, { "masthoogte", F(HEIGHT), 1, 1 }, { "masthohe", F(HEIGHT), 1, 1 },
    { "masthoehe", F(HEIGHT), 1, 1 }, { "mastlange", F(HEIGHT), 1, 1 }, { "mastheight", F(HEIGHT), 1, 1 },
    { "lichtmasthoogte", F(HEIGHT), 1, 2 }, { "lichtmastlengte", F(HEIGHT), 1, 2 }, { "hauteurmat", F(HEIGHT), 1, 1 },
    { "hauteurcandelabre", F(HEIGHT), 1, 2 }, { "hauteursupport", F(HEIGHT), 1, 1 }, { "stozarvyska", F(HEIGHT), 1, 1 },
    { "vyskastozaru", F(HEIGHT), 1, 1 }, { "vyskasvitidla", F(HEIGHT), 0, 2 }, { "masthojde", F(HEIGHT), 1, 1 },
    { "hohe", F(HEIGHT), 1, 0 }, { "hoehe", F(HEIGHT), 1, 0 }, { "hoogte", F(HEIGHT), 1, 0 },
    { "hauteur", F(HEIGHT), 1, 0 },
    { "altura", F(HEIGHT), 1, 0 }, { "altezza", F(HEIGHT), 1, 0 }, { "vyska", F(HEIGHT), 1, 0 },
    { "wysokosc", F(HEIGHT), 1, 0 }, { "korkeus", F(HEIGHT), 1, 0 }, { "hojd", F(HEIGHT), 1, 0 },
    { "hoyde", F(HEIGHT), 1, 0 }, { "alturapunto", F(HEIGHT), 0, 1 }, { "alturabaculo", F(HEIGHT), 1, 1 },
    { "estheight", F(HEIGHT), 2, 0 },
    /* the way the head faces */
    { "lightdirection", F(DIRECTION), 0, 1 }, { "lampdirection", F(DIRECTION), 0, 1 },
    { "direction", F(DIRECTION), 1, 0 },
    { "armdirection", F(DIRECTION), 1, 1 }, { "azimuth", F(DIRECTION), 1, 0 }, { "bearing", F(DIRECTION), 1, 0 },
    { "orientation", F(DIRECTION), 2, 0 }, { "richting", F(DIRECTION), 1, 0 }, { "ausrichtung", F(DIRECTION), 1, 0 },
    /* heads */
    { "lightcount", F(COUNT), 0, 2 }, { "lampcount", F(COUNT), 0, 2 }, { "luminairecount", F(COUNT), 0, 2 },
    { "numberlights", F(COUNT), 0, 2 }, { "numlights", F(COUNT), 0, 2 }, { "numberoflights", F(COUNT), 0, 2 },
    { "nooflights", F(COUNT), 0, 2 }, { "nolights", F(COUNT), 0, 2 }, { "numberlamps", F(COUNT), 0, 2 },
    { "numlamps", F(COUNT), 0, 2 }, { "numberoflamps", F(COUNT), 0, 2 }, { "nooflamps", F(COUNT), 0, 2 },
    { "lampqty", F(COUNT), 0, 2 }, { "numberofluminaires", F(COUNT), 0, 2 }, { "luminaires", F(COUNT), 1, 1 },
    { "aantallampen", F(COUNT), 0, 2 }, { "aantalarmaturen", F(COUNT), 0, 2 }, { "anzahllampen", F(COUNT), 0, 2 },
    { "anzahlleuchten", F(COUNT), 0, 2 }, { "nblampes", F(COUNT), 0, 2 }, { "nbluminaires", F(COUNT), 0, 2 },
    { "nombrelampes", F(COUNT), 0, 2 }, { "numlamparas", F(COUNT), 0, 2 }, { "numluminarias", F(COUNT), 0, 2 },
    { "pocetsvitidel", F(COUNT), 0, 2 },
    /* luminous flux */
    { "lightlumen", F(LUMENS), 0, 2 }, { "lightlumens", F(LUMENS), 0, 2 }, { "lumen", F(LUMENS), 0, 2 },
    { "lumens", F(LUMENS), 0, 2 }, { "luminousflux", F(LUMENS), 0, 2 }, { "lightflux", F(LUMENS), 0, 2 },
    { "lightluminousflux", F(LUMENS), 0, 2 }, { "lumenoutput", F(LUMENS), 0, 2 }, { "initiallumens", F(LUMENS), 1, 2 },
    { "lichtstrom", F(LUMENS), 0, 2 }, { "lichtstroom", F(LUMENS), 0, 2 }, { "fluxlumineux", F(LUMENS), 0, 2 },
    { "flujoluminoso", F(LUMENS), 0, 2 }, { "flussoluminoso", F(LUMENS), 0, 2 }, { "fluxoluminoso", F(LUMENS), 0, 2 },
    { "svetelnytok", F(LUMENS), 0, 2 }, { "strumienswietlny", F(LUMENS), 0, 2 },
    /* electric power */
    { "wattage", F(WATTS), 0, 1 }, { "watt", F(WATTS), 0, 1 }, { "watts", F(WATTS), 0, 1 },
    { "lightwattage", F(WATTS), 0, 2 },
    { "lampwattage", F(WATTS), 0, 2 }, { "lightpower", F(WATTS), 0, 2 }, { "lamppower", F(WATTS), 0, 2 },
    { "lightwatts", F(WATTS), 0, 2 }, { "lampwatts", F(WATTS), 0, 2 }, { "bulbwattage", F(WATTS), 0, 2 },
    { "wattlamp", F(WATTS), 0, 2 }, { "lampvermogen", F(WATTS), 0, 2 }, { "vermogenlamp", F(WATTS), 0, 2 },
    { "lampenleistung", F(WATTS), 0, 2 }, { "leuchtenleistung", F(WATTS), 0, 2 }, { "puissancelampe", F(WATTS), 0, 2 },
    { "pwr", F(WATTS), 1, 0 }, { "lamppwr", F(WATTS), 0, 2 }, { "ledwattage", F(WATTS), 0, 2 },
    { "ledwatts", F(WATTS), 0, 2 },
    { "power", F(WATTS), 2, 0 }, { "powerw", F(WATTS), 1, 0 }, { "vermogen", F(WATTS), 1, 1 },
    { "leistung", F(WATTS), 1, 1 },
    { "systemleistung", F(WATTS), 1, 1 }, { "anschlussleistung", F(WATTS), 1, 1 }, { "puissance", F(WATTS), 1, 1 },
    { "potencia", F(WATTS), 1, 1 }, { "potenza", F(WATTS), 1, 1 }, { "prikon", F(WATTS), 1, 1 },
    { "teho", F(WATTS), 1, 1 },
    { "effekt", F(WATTS), 1, 1 }, { "moc", F(WATTS), 1, 1 },
    /* colour temperature */
    { "cct", F(KELVIN), 0, 1 }, { "colortemperature", F(KELVIN), 0, 2 }, { "colourtemperature", F(KELVIN), 0, 2 },
    { "colortemp", F(KELVIN), 0, 2 }, { "colourtemp", F(KELVIN), 0, 2 }, { "kelvin", F(KELVIN), 0, 2 },
    { "lightcct", F(KELVIN), 0, 2 }, { "lightkelvin", F(KELVIN), 0, 2 }, { "lighttemperature", F(KELVIN), 0, 2 },
    { "lightcolourtemperature", F(KELVIN), 0, 2 }, { "lightcolortemperature", F(KELVIN), 0, 2 },
    { "farbtemperatur", F(KELVIN), 0, 2 }, { "kleurtemperatuur", F(KELVIN), 0, 2 },
    { "temperaturecouleur", F(KELVIN), 0, 2 },
    { "temperaturedecouleur", F(KELVIN), 0, 2 }, { "temperaturacolor", F(KELVIN), 0, 2 },
    { "temperaturadecolor", F(KELVIN), 0, 2 }, { "temperaturacolore", F(KELVIN), 0, 2 },
    { "teplotachromaticnosti", F(KELVIN), 0, 2 },
    /* colour of the light; a bare "colour" is mostly the pole's, and believed only where it reads as kelvin */
    { "lightcolour", F(COLOUR), 0, 2 }, { "lightcolor", F(COLOUR), 0, 2 }, { "lampcolour", F(COLOUR), 0, 2 },
    { "lampcolor", F(COLOUR), 0, 2 }, { "lichtfarbe", F(COLOUR), 0, 2 }, { "lichtkleur", F(COLOUR), 0, 2 },
    { "couleurlumiere", F(COLOUR), 0, 2 }, { "colour", F(COLOUR), 9, 0 }, { "color", F(COLOUR), 9, 0 },
    /* light source and fixture */
    { "lightmethod", F(TYPE), 0, 2 }, { "lamptype", F(TYPE), 0, 2 }, { "lighttype", F(TYPE), 0, 2 },
    { "lightsource", F(TYPE), 1, 1 }, { "lightsourcetype", F(TYPE), 0, 2 }, { "bulbtype", F(TYPE), 0, 2 },
    { "lampentyp", F(TYPE), 0, 2 }, { "lampenart", F(TYPE), 0, 2 }, { "leuchtmittel", F(TYPE), 0, 2 },
    { "leuchtmitteltyp", F(TYPE), 0, 2 }, { "lampsoort", F(TYPE), 0, 2 }, { "soortlamp", F(TYPE), 0, 2 },
    { "lichtbron", F(TYPE), 0, 2 }, { "typelampe", F(TYPE), 0, 2 }, { "lampe", F(TYPE), 0, 2 },
    { "lamp", F(TYPE), 1, 2 },
    { "sourcelumineuse", F(TYPE), 0, 2 }, { "tipolampara", F(TYPE), 0, 2 }, { "lampara", F(TYPE), 0, 2 },
    { "tipolampada", F(TYPE), 0, 2 }, { "lampada", F(TYPE), 0, 2 }, { "typzrodlaswiatla", F(TYPE), 0, 2 },
    { "svetelnyzdroj", F(TYPE), 0, 2 }, { "technology", F(TYPE), 3, 0 }, { "technologie", F(TYPE), 3, 0 },
    { "fixturestyle", F(TYPE), 2, 1 }, { "fixturetype", F(TYPE), 2, 1 }, { "fixture", F(TYPE), 2, 0 },
    { "luminaire", F(TYPE), 2, 2 }, { "luminairetype", F(TYPE), 2, 2 }, { "leuchtentyp", F(TYPE), 2, 2 },
    { "leuchtentype", F(TYPE), 2, 2 }, { "leuchtenart", F(TYPE), 2, 2 }, { "leuchte", F(TYPE), 2, 2 },
    { "armatuur", F(TYPE), 2, 2 }, { "armatuurtype", F(TYPE), 2, 2 }, { "typearmatuur", F(TYPE), 2, 2 },
    { "typeluminaire", F(TYPE), 2, 2 }, { "luminaria", F(TYPE), 2, 2 }, { "tipoluminaria", F(TYPE), 2, 2 },
    { "svitidlo", F(TYPE), 2, 2 }, { "typsvitidla", F(TYPE), 2, 2 }, { "oprawa", F(TYPE), 2, 2 },
    { "valaisin", F(TYPE), 2, 2 },
    { "type", F(TYPE), 4, 0 }, { "typ", F(TYPE), 4, 0 }, { "lampmodel", F(TYPE), 3, 2 },
    { "lightmodel", F(TYPE), 3, 2 },
    /* what it hangs on */
    { "lampmount", F(MOUNT), 0, 2 }, { "lightmount", F(MOUNT), 1, 2 }, { "lampsupport", F(MOUNT), 0, 2 },
    { "support", F(MOUNT), 1, 0 }, { "mount", F(MOUNT), 1, 0 }, { "mounting", F(MOUNT), 1, 0 },
    { "mounttype", F(MOUNT), 1, 0 },
    { "mounted", F(MOUNT), 1, 0 }, { "supporttype", F(MOUNT), 1, 0 }, { "typesupport", F(MOUNT), 1, 0 },
    { "befestigung", F(MOUNT), 1, 0 }, { "aufhangung", F(MOUNT), 1, 0 }, { "ophanging", F(MOUNT), 1, 0 },
    { "ophangwijze", F(MOUNT), 1, 0 }, { "location", F(MOUNT), 3, 0 }, { "poletype", F(MOUNT), 3, 0 },
    /* still there? */
    { "status", F(STATUS), 0, 0 }, { "assetstatus", F(STATUS), 0, 0 }, { "operationalstatus", F(STATUS), 0, 0 },
    { "lampstatus", F(STATUS), 0, 2 }, { "lightstatus", F(STATUS), 0, 2 }, { "lifecyclestatus", F(STATUS), 0, 0 },
    { "betriebsstatus", F(STATUS), 0, 0 }, { "zustand", F(STATUS), 0, 0 }, { "objektstatus", F(STATUS), 0, 0 },
    { "leuchtenstatus", F(STATUS), 0, 2 }, { "lampenstatus", F(STATUS), 0, 2 }, { "statut", F(STATUS), 0, 0 },
    { "etatservice", F(STATUS), 0, 0 }, { "etatexploitation", F(STATUS), 0, 0 }, { "situacion", F(STATUS), 0, 0 },
    { "situacao", F(STATUS), 0, 0 }, { "provoznistav", F(STATUS), 0, 0 }, { "stan", F(STATUS), 0, 0 },
    { "tilstand", F(STATUS), 0, 0 }, { "driftstatus", F(STATUS), 0, 0 }, { "driftsstatus", F(STATUS), 0, 0 },
    { "tila", F(STATUS), 0, 0 }, { "levensfase", F(STATUS), 0, 0 },
    { "betriebszustand", F(STATUS), 0, 0 }, { "toestand", F(STATUS), 0, 0 }, { "etat", F(STATUS), 0, 0 },
    { "estado", F(STATUS), 0, 0 }, { "stato", F(STATUS), 0, 0 }, { "stav", F(STATUS), 0, 0 },
    /* identity */
    { "id", F(ID), 0, 0 }, { "osmid", F(ID), 0, 0 }, { "lampid", F(ID), 1, 2 }, { "lightid", F(ID), 1, 2 },
    { "streetlightid", F(ID), 1, 2 }, { "luminaireid", F(ID), 1, 2 }, { "facilityid", F(ID), 2, 0 },
    { "assetid", F(ID), 2, 0 }, { "lampnumber", F(ID), 2, 2 }, { "lampnummer", F(ID), 2, 2 },
    { "leuchtennummer", F(ID), 2, 2 }, { "leuchtennr", F(ID), 2, 2 }, { "lichtmastnummer", F(ID), 2, 2 },
    { "poleid", F(ID), 2, 0 }, { "polenumber", F(ID), 3, 0 }, { "mastid", F(ID), 2, 1 }, { "mastnummer", F(ID), 3, 1 },
    { "mastnr", F(ID), 3, 1 }, { "ref", F(ID), 3, 0 }, { "objectid", F(ID), 4, 0 }, { "fid", F(ID), 4, 0 },
    { "globalid", F(ID), 4, 0 }, { "gisid", F(ID), 4, 0 },
    /* height of the foot */
    { "ele", F(ELEVATION), 0, 0 }, { "elevation", F(ELEVATION), 0, 0 }, { "altitude", F(ELEVATION), 1, 0 },
    { "z", F(ELEVATION), 1, 0 }, { "zcoord", F(ELEVATION), 1, 0 },
    /* place, in tables */
    { "lon", F(LON), 0, 0 }, { "lng", F(LON), 0, 0 }, { "long", F(LON), 0, 0 }, { "longitude", F(LON), 0, 0 },
    { "longitud", F(LON), 0, 0 }, { "longitudine", F(LON), 0, 0 }, { "lengtegraad", F(LON), 0, 0 },
    { "langengrad", F(LON), 0, 0 }, { "laengengrad", F(LON), 0, 0 }, { "xlon", F(LON), 0, 0 },
    { "pointlon", F(LON), 0, 0 },
    { "lat", F(LAT), 0, 0 }, { "latitude", F(LAT), 0, 0 }, { "latitud", F(LAT), 0, 0 }, { "latitudine", F(LAT), 0, 0 },
    { "breedtegraad", F(LAT), 0, 0 }, { "breitengrad", F(LAT), 0, 0 }, { "ylat", F(LAT), 0, 0 },
    { "pointlat", F(LAT), 0, 0 },
    { "x", F(X), 0, 0 }, { "xcoord", F(X), 0, 0 }, { "coordx", F(X), 0, 0 }, { "xcoordinate", F(X), 0, 0 },
    { "easting", F(X), 0, 0 }, { "eastings", F(X), 0, 0 }, { "rechtswert", F(X), 0, 0 }, { "ostwert", F(X), 0, 0 },
    { "pointx", F(X), 0, 0 }, { "utmx", F(X), 1, 0 }, { "coordonneex", F(X), 0, 0 }, { "xcoordinaat", F(X), 0, 0 },
    { "y", F(Y), 0, 0 }, { "ycoord", F(Y), 0, 0 }, { "coordy", F(Y), 0, 0 }, { "ycoordinate", F(Y), 0, 0 },
    { "northing", F(Y), 0, 0 }, { "northings", F(Y), 0, 0 }, { "hochwert", F(Y), 0, 0 }, { "nordwert", F(Y), 0, 0 },
    { "pointy", F(Y), 0, 0 }, { "utmy", F(Y), 1, 0 }, { "coordonneey", F(Y), 0, 0 }, { "ycoordinaat", F(Y), 0, 0 },
    { "wkt", F(WKT), 0, 0 }, { "thegeom", F(WKT), 0, 0 }, { "geom", F(WKT), 0, 0 }, { "geometry", F(WKT), 0, 0 },
    { "geopoint", F(LAT_LON), 0, 0 }, { "geopoint2d", F(LAT_LON), 0, 0 }, { "latlon", F(LAT_LON), 0, 0 },
    { "latlong", F(LAT_LON), 0, 0 }, { "latlng", F(LAT_LON), 0, 0 },
};
/* clang-format on */
#undef F

static lamp_column sorted[NOC_COUNT(columns)];
static pthread_once_t sorted_once = PTHREAD_ONCE_INIT;

static int compare(const void *a, const void *b) {
    return strcmp(((const lamp_column *)a)->key, ((const lamp_column *)b)->key);
}

static void sort_columns(void) {
    memcpy(sorted, columns, sizeof(columns));
    qsort(sorted, NOC_COUNT(sorted), sizeof(sorted[0]), compare);
}

static const lamp_column *find_folded(const char *key) {
    return bsearch(&(lamp_column){ .key = key }, sorted, NOC_COUNT(sorted), sizeof(sorted[0]), compare);
}

/* "mountht", "polehgt": the word written out. NULL if it is none of these. */
static const lamp_column *find_height(const char *folded, size_t n) {
    char whole[80];
    size_t tail = n >= 3 && !strcmp(folded + n - 3, "hgt") ? 3 : n >= 2 && !strcmp(folded + n - 2, "ht") ? 2 : 0;
    if (!tail || n >= sizeof(whole) - sizeof("height"))
        return NULL;
    memcpy(whole, folded, n - tail);
    memcpy(whole + n - tail, "height", sizeof("height"));
    return find_folded(whole);
}

const lamp_column *lamp_column_find(const char *key) {
    static const char *const tails[] = { "description", "desc", "omschrijving", "bezeichnung",
                                         "naam",        "name", "code",         "txt" };
    pthread_once(&sorted_once, sort_columns);
    char folded[64];
    size_t n = strnlen(key, sizeof(folded) - 1);
    memcpy(folded, key, n);
    folded[n] = 0;
    const lamp_column *c = find_folded(folded);
    if (!c)
        c = find_height(folded, n);
    for (size_t i = 0; !c && i < NOC_COUNT(tails); i++) {
        size_t m = strlen(tails[i]);
        if (n > m && !strcmp(folded + n - m, tails[i])) {
            folded[n -= m] = 0;
            c = find_folded(folded);
            break;
        }
    }
    if (!c && n > 3 && folded[n - 1] >= '1' && folded[n - 1] <= '9') {
        folded[n - 1] = 0;
        c = find_folded(folded);
    }
    return c;
}

typedef struct word {
    const char *text;
    int value;
} word;

lamp_text lamp_text_of(const char *folded) {
    lamp_text t = { .folded = folded };
    for (const char *p = folded; *p; p++) {
        t.any |= lamp_bit(*p);
        t.first |= p == folded || p[-1] == ' ' ? lamp_bit(*p) : 0;
    }
    return t;
}

bool lamp_find_word(const lamp_text *text, const char *wanted) {
    bool suffix = *wanted == '*';
    wanted += suffix;
    size_t n = strlen(wanted);
    bool prefix = wanted[n - 1] == '*';
    n -= prefix;
    for (const char *p = text->folded; *p; p++)
        if (*p == *wanted && (suffix || p == text->folded || p[-1] == ' ') && !strncmp(p, wanted, n) &&
            (prefix || !p[n] || p[n] == ' '))
            return true;
    return false;
}

static int find_word(const char *folded, const word *words, size_t count) {
    lamp_text text = lamp_text_of(folded);
    for (size_t i = 0; i < count; i++)
        if (lamp_has_word(&text, words[i].text))
            return words[i].value;
    return -1;
}

/* "son70" as "son 70": watts are written behind codes, and no code has a number of two digits or more in it. */
static const char *part_watts(const char *folded, char *to, size_t size) {
    size_t n = 0;
    for (const char *p = folded; *p && n + 2 < size; p++) {
        bool begins =
            p > folded && *p >= '1' && *p <= '9' && p[1] >= '0' && p[1] <= '9' && p[-1] >= 'a' && p[-1] <= 'z';
        if (begins)
            to[n++] = ' ';
        to[n++] = *p;
    }
    to[n] = 0;
    return to;
}

int lamp_source_word(const char *folded) {
    /* beside plain words: names by Philips and Osram (SON, PL, CDM, CPO, HPL, QL, HQL, NAV, HQI), codes of ZVEI's LBS
     * (HST, HIT, TC) */
    static const word words[] = {
        { "led*", GEO_SOURCE_LED },
        { "light emitting diode", GEO_SOURCE_LED },
        { "diode*", GEO_SOURCE_LED },
        { "metal halide", GEO_SOURCE_METAL_HALIDE },
        { "metal hal*", GEO_SOURCE_METAL_HALIDE },
        { "mh", GEO_SOURCE_METAL_HALIDE },
        { "hqi*", GEO_SOURCE_METAL_HALIDE },
        { "cdm*", GEO_SOURCE_METAL_HALIDE },
        { "cdo*", GEO_SOURCE_METAL_HALIDE },
        { "cpo*", GEO_SOURCE_METAL_HALIDE },
        { "cosmopolis", GEO_SOURCE_METAL_HALIDE },
        { "halogenmetall*", GEO_SOURCE_METAL_HALIDE },
        { "metallhalogen*", GEO_SOURCE_METAL_HALIDE },
        { "metaalhalogen*", GEO_SOURCE_METAL_HALIDE },
        { "halogenur*", GEO_SOURCE_METAL_HALIDE },
        { "iodure*", GEO_SOURCE_METAL_HALIDE },
        { "alogenuri", GEO_SOURCE_METAL_HALIDE },
        { "hit", GEO_SOURCE_METAL_HALIDE },
        { "hie", GEO_SOURCE_METAL_HALIDE },
        { "halogenuros", GEO_SOURCE_METAL_HALIDE },
        { "halogenid*", GEO_SOURCE_METAL_HALIDE },
        { "hpi*", GEO_SOURCE_METAL_HALIDE },
        { "hps*", GEO_SOURCE_SODIUM },
        { "lps*", GEO_SOURCE_SODIUM },
        { "sodium", GEO_SOURCE_SODIUM },
        { "sodio", GEO_SOURCE_SODIUM },
        { "natrium*", GEO_SOURCE_SODIUM },
        { "son", GEO_SOURCE_SODIUM },
        { "sont", GEO_SOURCE_SODIUM },
        { "sox*", GEO_SOURCE_SODIUM },
        { "nav", GEO_SOURCE_SODIUM },
        { "shp", GEO_SOURCE_SODIUM },
        { "sbp", GEO_SOURCE_SODIUM },
        { "vsbp", GEO_SOURCE_SODIUM },
        { "sap", GEO_SOURCE_SODIUM },
        { "vsap", GEO_SOURCE_SODIUM },
        { "sodik*", GEO_SOURCE_SODIUM },
        { "sodov*", GEO_SOURCE_SODIUM },
        { "hogedruknatrium*", GEO_SOURCE_SODIUM },
        { "lagedruknatrium*", GEO_SOURCE_SODIUM },
        { "hst", GEO_SOURCE_SODIUM },
        { "hse", GEO_SOURCE_SODIUM },
        { "lst", GEO_SOURCE_SODIUM },
        { "mercury", GEO_SOURCE_MERCURY },
        { "mv", GEO_SOURCE_MERCURY },
        { "hme", GEO_SOURCE_MERCURY },
        { "hpl*", GEO_SOURCE_MERCURY },
        { "hql*", GEO_SOURCE_MERCURY },
        { "quecksilber*", GEO_SOURCE_MERCURY },
        { "kwik*", GEO_SOURCE_MERCURY },
        { "mercure", GEO_SOURCE_MERCURY },
        { "mercurio", GEO_SOURCE_MERCURY },
        { "vmcc", GEO_SOURCE_MERCURY },
        { "rtec*", GEO_SOURCE_MERCURY },
        { "rtut*", GEO_SOURCE_MERCURY },
        { "fluo*", GEO_SOURCE_FLUORESCENT },
        { "leuchtstoff*", GEO_SOURCE_FLUORESCENT },
        { "cfl", GEO_SOURCE_FLUORESCENT },
        { "pll", GEO_SOURCE_FLUORESCENT },
        { "tl", GEO_SOURCE_FLUORESCENT },
        { "pl", GEO_SOURCE_FLUORESCENT },
        { "plc", GEO_SOURCE_FLUORESCENT },
        { "pls", GEO_SOURCE_FLUORESCENT },
        { "plt", GEO_SOURCE_FLUORESCENT },
        { "tld", GEO_SOURCE_FLUORESCENT },
        { "tl5", GEO_SOURCE_FLUORESCENT },
        { "tl8", GEO_SOURCE_FLUORESCENT },
        { "tc", GEO_SOURCE_FLUORESCENT },
        { "ql", GEO_SOURCE_FLUORESCENT },
        { "induction", GEO_SOURCE_FLUORESCENT },
        { "inductie", GEO_SOURCE_FLUORESCENT },
        { "zarivk*", GEO_SOURCE_FLUORESCENT },
        { "incandescen*", GEO_SOURCE_INCANDESCENT },
        { "inc", GEO_SOURCE_INCANDESCENT },
        { "halogen*", GEO_SOURCE_INCANDESCENT },
        { "gluh*", GEO_SOURCE_INCANDESCENT },
        { "gloei*", GEO_SOURCE_INCANDESCENT },
        { "tungsten", GEO_SOURCE_INCANDESCENT },
        { "gas", GEO_SOURCE_GAS },
        { "gaslight*", GEO_SOURCE_GAS },
        { "gaslamp*", GEO_SOURCE_GAS },
        { "gasleucht*", GEO_SOURCE_GAS },
        { "gaslatern*", GEO_SOURCE_GAS },
        { "gaslantern*", GEO_SOURCE_GAS },
        { "gaz", GEO_SOURCE_GAS },
    };
    static const word low[] = {
        { "low pressure", 1 }, { "lps*", 1 },           { "sox*", 1 },         { "lst", 1 },
        { "sbp", 1 },          { "vsbp", 1 },           { "niederdruck*", 1 }, { "lagedruk*", 1 },
        { "lage druk", 1 },    { "basse pression", 1 }, { "baja presion", 1 }
    };
    char parted[300];
    folded = part_watts(folded, parted, sizeof(parted));
    int source = find_word(folded, words, NOC_COUNT(words));
    return source == GEO_SOURCE_SODIUM && find_word(folded, low, NOC_COUNT(low)) > 0 ? GEO_SOURCE_LOW_SODIUM : source;
}

int lamp_type_word(const char *folded) {
    static const word words[] = {
        { "flood*", GEO_LAMP_FLOOD },       { "spotlight*", GEO_LAMP_FLOOD },   { "projector", GEO_LAMP_FLOOD },
        { "projecteur", GEO_LAMP_FLOOD },   { "proyector", GEO_LAMP_FLOOD },    { "fluter", GEO_LAMP_FLOOD },
        { "strahler", GEO_LAMP_FLOOD },     { "schijnwerper", GEO_LAMP_FLOOD }, { "proiettore", GEO_LAMP_FLOOD },
        { "lantern*", GEO_LAMP_LANTERN },   { "posttop*", GEO_LAMP_LANTERN },   { "post top*", GEO_LAMP_LANTERN },
        { "globe*", GEO_LAMP_LANTERN },     { "acorn*", GEO_LAMP_LANTERN },     { "bollard*", GEO_LAMP_LANTERN },
        { "kugel*", GEO_LAMP_LANTERN },     { "kegel*", GEO_LAMP_LANTERN },     { "gaslight*", GEO_LAMP_LANTERN },
        { "gaslamp*", GEO_LAMP_LANTERN },   { "gas", GEO_LAMP_LANTERN },        { "gaslatern*", GEO_LAMP_LANTERN },
        { "gasleucht*", GEO_LAMP_LANTERN }, { "laterne*", GEO_LAMP_LANTERN },   { "aufsatz*", GEO_LAMP_LANTERN },
        { "lanterne*", GEO_LAMP_LANTERN },  { "boule", GEO_LAMP_LANTERN },      { "globo", GEO_LAMP_LANTERN },
        { "farol", GEO_LAMP_LANTERN },      { "fernandino", GEO_LAMP_LANTERN }, { "villa", GEO_LAMP_LANTERN },
        { "cobra*", GEO_LAMP_STREET },      { "shoebox", GEO_LAMP_STREET },     { "teardrop", GEO_LAMP_STREET },
        { "street", GEO_LAMP_STREET },
    };
    return find_word(folded, words, NOC_COUNT(words));
}

int lamp_mount_word(const char *folded) {
    static const word words[] = {
        { "suspended", GEO_MOUNT_SUSPENDED },
        { "suspension", GEO_MOUNT_SUSPENDED },
        { "ceiling", GEO_MOUNT_SUSPENDED },
        { "catenary", GEO_MOUNT_SUSPENDED },
        { "wire", GEO_MOUNT_SUSPENDED },
        { "cable", GEO_MOUNT_SUSPENDED },
        { "power lines", GEO_MOUNT_SUSPENDED },
        { "seil*", GEO_MOUNT_SUSPENDED },
        { "uberspann*", GEO_MOUNT_SUSPENDED },
        { "hang*", GEO_MOUNT_SUSPENDED },
        { "span*", GEO_MOUNT_SUSPENDED },
        { "overspann*", GEO_MOUNT_SUSPENDED },
        { "wall*", GEO_MOUNT_WALL },
        { "wand*", GEO_MOUNT_WALL },
        { "gevel*", GEO_MOUNT_WALL },
        { "facade", GEO_MOUNT_WALL },
        { "fassade*", GEO_MOUNT_WALL },
        { "mur", GEO_MOUNT_WALL },
        { "pared", GEO_MOUNT_WALL },
        { "parete", GEO_MOUNT_WALL },
        { "building", GEO_MOUNT_WALL },
        { "muur*", GEO_MOUNT_WALL },
        { "bracket", GEO_MOUNT_WALL },
        { "pole*", GEO_MOUNT_POLE },
        { "mast*", GEO_MOUNT_POLE },
        { "straight mast", GEO_MOUNT_POLE },
        { "bent mast", GEO_MOUNT_POLE },
        { "bent pole", GEO_MOUNT_POLE },
        { "candelabre", GEO_MOUNT_POLE },
        { "mat", GEO_MOUNT_POLE },
        { "upright", GEO_MOUNT_POLE },
        { "baculo", GEO_MOUNT_POLE },
        { "columna", GEO_MOUNT_POLE },
        { "palo", GEO_MOUNT_POLE },
        { "pedestal", GEO_MOUNT_POLE },
        { "ground", GEO_MOUNT_POLE },
        { "stozar", GEO_MOUNT_POLE },
    };
    return find_word(folded, words, NOC_COUNT(words));
}

bool lamp_inactive_word(const char *folded) {
    static const word words[] = {
        { "inactive", 1 },
        { "removed", 1 },
        { "retired", 1 },
        { "abandoned", 1 },
        { "disused", 1 },
        { "decommissioned", 1 },
        { "demolished", 1 },
        { "proposed", 1 },
        { "planned", 1 },
        { "out of service", 1 },
        { "out of order", 1 },
        { "not in service", 1 },
        { "not active", 1 },
        { "non operational", 1 },
        { "closed", 1 },
        { "dismantled", 1 },
        { "under construction", 1 },
        { "ausser betrieb", 1 },
        { "ausser dienst", 1 },
        { "nicht in betrieb", 1 },
        { "nicht aktiv", 1 },
        { "inaktiv*", 1 },
        { "stillgelegt*", 1 },
        { "demontiert*", 1 },
        { "ruckgebaut*", 1 },
        { "zuruckgebaut*", 1 },
        { "rueckgebaut*", 1 },
        { "ruckbau", 1 },
        { "abgebaut*", 1 },
        { "abgeschaltet*", 1 },
        { "abgerissen*", 1 },
        { "entfernt*", 1 },
        { "geplant*", 1 },
        { "in planung", 1 },
        { "im bau", 1 },
        { "buiten gebruik", 1 },
        { "buiten bedrijf", 1 },
        { "niet in gebruik", 1 },
        { "inactief", 1 },
        { "verwijderd*", 1 },
        { "vervallen", 1 },
        { "gesloopt*", 1 },
        { "ontmanteld*", 1 },
        { "gepland*", 1 },
        { "hors service", 1 },
        { "hors usage", 1 },
        { "hors exploitation", 1 },
        { "inactif*", 1 },
        { "supprime*", 1 },
        { "depose*", 1 },
        { "demonte*", 1 },
        { "abandonne*", 1 },
        { "en projet", 1 },
        { "projete*", 1 },
        { "fuera de servicio", 1 },
        { "fuera de uso", 1 },
        { "retirad*", 1 },
        { "baja", 1 },
        { "inactiv*", 1 },
        { "desmontad*", 1 },
        { "eliminad*", 1 },
        { "proyectad*", 1 },
        { "planificad*", 1 },
        { "fuori servizio", 1 },
        { "fuori uso", 1 },
        { "dismess*", 1 },
        { "rimoss*", 1 },
        { "demolit*", 1 },
        { "smontat*", 1 },
        { "inattiv*", 1 },
        { "non attiv*", 1 },
        { "in progetto", 1 },
        { "fora de servico", 1 },
        { "fora de uso", 1 },
        { "desativad*", 1 },
        { "desactivad*", 1 },
        { "inativ*", 1 },
        { "removid*", 1 },
        { "planead*", 1 },
        { "planejad*", 1 },
        { "mimo provoz", 1 },
        { "zrusen*", 1 },
        { "demontovan*", 1 },
        { "odstranen*", 1 },
        { "planovan*", 1 },
        { "neaktivni", 1 },
        { "nieczynn*", 1 },
        { "nieaktywn*", 1 },
        { "wylaczon*", 1 },
        { "zdemontowan*", 1 },
        { "usuniet*", 1 },
        { "planowan*", 1 },
        { "ur drift", 1 },
        { "ute av drift", 1 },
        { "ude af drift", 1 },
        { "nedlagt", 1 },
        { "fjernet", 1 },
        { "borttag*", 1 },
        { "avvecklad*", 1 },
        { "planlagt", 1 },
        { "planerad*", 1 },
        { "poistettu", 1 },
        { "purettu", 1 },
        { "suunniteltu", 1 },
    };
    return find_word(folded, words, NOC_COUNT(words)) > 0;
}

bool lamp_colour_word(const char *folded, double *kelvin, float rgb[3]) {
    /* "orange" and "yellow" street light is sodium light; whites are the lamp trade's */
    static const word whites[] = {
        { "warm white", 3000 },
        { "warmwhite", 3000 },
        { "warmweiss", 3000 },
        { "warm wit", 3000 },
        { "blanc chaud", 3000 },
        { "warm", 3000 },
        { "neutral white", 4000 },
        { "neutralweiss", 4000 },
        { "neutral", 4000 },
        { "cool white", 5000 },
        { "cold white", 5000 },
        { "kaltweiss", 5000 },
        { "tageslichtweiss", 6000 },
        { "daylight", 6000 },
        { "blanc froid", 5000 },
        { "cool", 5000 },
        { "cold", 5000 },
        { "white", 4000 },
        { "weiss", 4000 },
        { "wit", 4000 },
        { "blanc", 4000 },
        { "yellow", 2000 },
        { "orange", 2000 },
        { "amber", 2000 },
        { "gelb", 2000 },
        { "geel", 2000 },
        { "jaune", 2000 },
    };
    static const struct {
        const char *text, *hex;
    } colours[] = { { "red", "#ff0000" },    { "green", "#00ff00" },   { "blue", "#0000ff" },
                    { "cyan", "#00ffff" },   { "magenta", "#ff00ff" }, { "purple", "#8000ff" },
                    { "violet", "#8000ff" }, { "pink", "#ff6080" },    { "turquoise", "#40e0d0" } };
    int white = find_word(folded, whites, NOC_COUNT(whites));
    if (white > 0) {
        *kelvin = white;
        return true;
    }
    lamp_text text = lamp_text_of(folded);
    for (size_t i = 0; i < NOC_COUNT(colours); i++)
        if (lamp_has_word(&text, colours[i].text))
            return lamp_hex_colour(colours[i].hex, rgb);
    return false;
}
