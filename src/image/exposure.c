/* Exposure as photographers set it. */
#include "image/internal.h"

#include <math.h>

/* "f/2.8" or "2.8"; 0: none. */
static double f_number(const char *text) {
    double n = 0;
    return noc_parse_double(text + (strncmp(text, "f/", 2) ? 0 : 2), &n) && n > 0 ? n : 0;
}

/* "1/30" or "0.5" [s]; 0: none. */
static double shutter(char *text) {
    char *slash = strchr(text, '/');
    double over = 1, under = 1;
    if (slash)
        *slash = 0;
    bool good = noc_parse_double(text, &over) && (!slash || noc_parse_double(slash + 1, &under));
    return good && over > 0 && under > 0 ? over / under : 0;
}

/* "iso1600" or "1600"; 0: none. */
static double sensitivity(const char *text) {
    double s = 0;
    return noc_parse_double(text + (strncmp(text, "iso", 3) ? 0 : 3), &s) && s > 0 ? s : 0;
}

const char *noc_exposure_read(const char *text, double *ev100) {
    static const char wrong[] = "is neither EV100 of -30 to 30 nor f/2.8,1/30,iso1600";
    char words[80], *part[3], *at = words;
    double ev;
    if (!text || !ev100)
        return "is missing";
    if (noc_parse_double(text, &ev))
        return ev >= -30 && ev <= 30 ? (*ev100 = ev, NULL) : wrong;
    noc_snprintf(words, sizeof(words), "%s", text);
    for (int i = 0; i < 3; i++) {
        part[i] = at;
        at += strcspn(at, ",");
        if ((*at == ',') != (i < 2))
            return wrong;
        *at++ = 0;
    }
    double n = f_number(part[0]), t = shutter(part[1]), s = sensitivity(part[2]);
    ev = n > 0 && t > 0 && s > 0 ? log2(n * n / t) - log2(s / 100) : NAN;
    if (!(ev >= -30 && ev <= 30))
        return wrong;
    *ev100 = ev;
    return NULL;
}
