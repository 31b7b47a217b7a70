/* What is behind a window, and how it shines when it is lit. docs/defaults.md has where the luminances come from: no
 * survey of luminances of windows by use is known to us. */
#include "city/windows/parts.h"
#include "city/city.h"

/* Luminances, cd/m2, of rooms as they are seen through panes: eighths of log-normal distributions. Exposure tables
 * (ANSI PH2.7) have homes at EV 5 to 7, 4 to 16 cd/m2, shops and offices at EV 7 to 8, 16 to 32. */
enum { LEVELS = 8 };
static const double levels[NOC_WINDOW_KIND_COUNT][LEVELS] = {
    [NOC_WINDOW_FLAT] = { 4.8, 7.5, 9.9, 12.5, 15.6, 19.7, 26, 41 },    /* median 14, sigma .7 */
    [NOC_WINDOW_OFFICE] = { 11.6, 16, 19.6, 23.1, 27, 32, 39, 54 },     /* median 25, sigma .5 */
    [NOC_WINDOW_SHOP] = { 16.3, 22.5, 27.4, 32.4, 37.9, 44.7, 55, 75 }, /* median 35, sigma .5 */
};
/* A screen alone. */
#define SCREEN_LEAST 1.0
#define SCREEN_MOST 5.0
/* What curtains and blinds let through, the denser ones more often; so many lit flats have them drawn. With them flats
 * have a median of 6 cd/m2. */
#define CURTAIN_LEAST 0.1
#define CURTAIN_MOST 0.4
#define CURTAINS 0.5

/* Shares of buildings: shop fronts where there is a storey above them; offices in high and in wide buildings. */
#define SHOPS 0.35
#define SHOPS_FROM 6.5 /* m high */
#define OFFICES_HIGH 0.5
#define OFFICES_WIDE 0.4
#define OFFICES_ELSE 0.06
#define HIGH 24.0 /* m */
#define WIDE 45.0 /* m */
/* Of an office's windows so many follow their storey; of a flat's so many the one beside them. */
#define WITH_STOREY 0.85
#define WITH_NEIGHBOUR 0.5
/* Of flats so many are lit by a screen alone. */
#define SCREENS 0.06
/* Colour temperatures over that of flats. */
#define OFFICE_KELVIN 1.4
#define SHOP_KELVIN 1.2
#define SCREEN_KELVIN 2.6

uint64_t city_window_hash(uint64_t a, uint64_t b) {
    uint64_t h = a + 0x9e3779b97f4a7c15u * (b + 1); /* splitmix64 */
    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
    h = (h ^ h >> 27) * 0x94d049bb133111ebu;
    return h ^ h >> 31;
}

double city_window_number(uint64_t hash, uint64_t salt) {
    return (double)(city_window_hash(hash, salt) >> 11) * 0x1p-53;
}

double city_window_luminance(noc_window_kind kind, double u) { return levels[kind][(int)(u * LEVELS)]; }
double city_window_screen(double u) { return SCREEN_LEAST + u * (SCREEN_MOST - SCREEN_LEAST); }
double city_window_curtain(double u) { return CURTAIN_LEAST + u * u * (CURTAIN_MOST - CURTAIN_LEAST); }

building_use city_building_use(const char *id, noc_building_use told, double height, double width) {
    building_use use = { .hash = city_window_hash(noc_hash_text(id), 0) };
    double offices = height >= HIGH ? OFFICES_HIGH : width >= WIDE ? OFFICES_WIDE : OFFICES_ELSE;
    use.offices = city_window_number(use.hash, 1) < offices;
    use.shops = height >= SHOPS_FROM && city_window_number(use.hash, 2) < SHOPS;
    if (told != NOC_USE_UNKNOWN) {
        use.shops = told == NOC_USE_SHOPS || (told == NOC_USE_MIXED && height >= SHOPS_FROM) ||
                    (told == NOC_USE_OFFICES && use.shops);
        use.offices = told == NOC_USE_OFFICES || told == NOC_USE_SHOPS;
        use.dark = told == NOC_USE_DARK;
        use.bare = told == NOC_USE_BARE;
    }
    return use;
}

void city_window_shine(city_window *w, const building_use *use, uint64_t floor, uint64_t pair,
                       const noc_window_params *params) {
    uint64_t own = city_window_hash(w->hash, NOC_WINDOW_SEED), shared = own;
    if (w->kind == NOC_WINDOW_OFFICE && city_window_number(own, 1) < WITH_STOREY)
        shared = city_window_hash(floor, NOC_WINDOW_SEED);
    else if (w->kind != NOC_WINDOW_OFFICE &&
             city_window_number(city_window_hash(pair, NOC_WINDOW_SEED), 1) < WITH_NEIGHBOUR)
        shared = city_window_hash(pair, NOC_WINDOW_SEED);
    w->level = use->dark ? 1 : (float)city_window_number(shared, 2); /* no share is above 1 */
    double v = city_window_number(shared, 3), kelvin = params->kelvin, spread = params->spread;
    bool screen = w->kind == NOC_WINDOW_FLAT && v < SCREENS;
    double level = screen ? city_window_screen(city_window_number(shared, 4))
                          : city_window_luminance(w->kind, city_window_number(shared, 4));
    if (w->kind == NOC_WINDOW_SHOP)
        kelvin *= SHOP_KELVIN;
    else if (w->kind == NOC_WINDOW_OFFICE)
        kelvin *= OFFICE_KELVIN;
    else if (screen)
        kelvin *= SCREEN_KELVIN;
    /* the spread is that of the sum of three numbers, near a bell */
    double bell = city_window_number(shared, 5) + city_window_number(shared, 6) + city_window_number(shared, 7) - 1.5;
    kelvin *= 1 + spread * bell;
    /* each window has its own curtain, and what stands behind it */
    double own_number = city_window_number(own, 8);
    if (w->kind != NOC_WINDOW_FLAT)
        level *= 0.8 + 0.4 * own_number;
    else if (own_number < CURTAINS)
        level *= city_window_curtain(own_number / CURTAINS);
    noc_kelvin_rgb(NOC_CLAMP(kelvin, 1000, 20000), w->emission);
    for (int k = 0; k < 3; k++)
        w->emission[k] *= (float)level;
}
