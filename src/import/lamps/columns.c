/* Folding of text, and the names of columns and tag keys about lamps in the languages that open data comes in (English,
 * German, Dutch, French, Spanish, Italian, Portuguese, Czech, Polish, Nordic). */
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
    { "height", F(HEIGHT), 1, 0 }, { "poleheight", F(HEIGHT), 1, 1 },
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
    { "lightmethod", F(TYPE), 0, 2 }, { "lightlamptype", F(TYPE), 0, 2 }, { "lightlamp", F(TYPE), 0, 2 },
    { "lamptype", F(TYPE), 0, 2 }, { "lighttype", F(TYPE), 0, 2 },
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
