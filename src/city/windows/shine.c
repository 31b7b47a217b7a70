/* What is behind a window, and how it shines when it is lit. All of it is ours, as in the built-in city: no survey of
 * luminances of windows by use is known to us. */
#include "city/windows/parts.h"
#include "city/city.h"

/* Luminances, cd/m2, of rooms as they are seen through panes and curtains: those of builtin/wall.c. */
static const double levels[] = { 20, 26, 34, 45, 60, 85, 120, 170 };
enum { LEVELS = NOC_COUNT(levels) };

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
    double v = city_window_number(shared, 3), kelvin = params->kelvin, brightness = 1, spread = params->spread;
    bool screen = w->kind == NOC_WINDOW_FLAT && v < SCREENS;
    double level = levels[(int)(city_window_number(shared, 4) * LEVELS)];
    if (w->kind == NOC_WINDOW_SHOP)
        kelvin *= SHOP_KELVIN, level = levels[4 + (int)(city_window_number(shared, 4) * (LEVELS - 4))];
    else if (w->kind == NOC_WINDOW_OFFICE)
        kelvin *= OFFICE_KELVIN, level = levels[2 + (int)(city_window_number(shared, 4) * (LEVELS - 3))];
    else if (screen)
        kelvin *= SCREEN_KELVIN, level = levels[(int)(city_window_number(shared, 4) * 2)];
    /* the spread is that of the sum of three numbers, near a bell */
    double bell = city_window_number(shared, 5) + city_window_number(shared, 6) + city_window_number(shared, 7) - 1.5;
    kelvin *= 1 + spread * bell;
    brightness *= 0.8 + 0.4 * city_window_number(own, 8); /* curtains differ from window to window */
    noc_kelvin_rgb(NOC_CLAMP(kelvin, 1000, 20000), w->emission);
    for (int k = 0; k < 3; k++)
        w->emission[k] *= (float)(level * brightness);
}
