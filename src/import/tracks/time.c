#include "import/tracks/tracks.h"

#include <math.h>
#include <stdio.h>

/* Days since 1970 of the proleptic Gregorian calendar. */
static double days(int year, int month, int day) {
    year -= month <= 2;
    int era = (year >= 0 ? year : year - 399) / 400, of_era = year - 400 * era;
    int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return 146097.0 * era + 365 * of_era + of_era / 4 - of_era / 100 + of_year - 719468;
}

double track_time(const char *text) {
    int year, month, day, hour, minute, used = 0, off_hours, off_minutes;
    double second;
    if (noc_parse_double(text, &second))
        return second;
    text += strspn(text, " \t\r\n");
    if (sscanf(text, "%4d-%2d-%2d%*1[Tt ]%2d:%2d:%n", &year, &month, &day, &hour, &minute, &used) != 5 || !used)
        return NAN;
    const char *rest = noc_scan_double(text + used, text + used + strspn(text + used, "0123456789."), &second);
    bool good = rest && month >= 1 && month <= 12 && day >= 1 && day <= 31 && hour >= 0 && hour <= 24 && minute >= 0 &&
                minute < 60 && second >= 0 && second < 61;
    if (!good)
        return NAN;
    double seconds = 86400 * days(year, month, day) + 3600 * hour + 60 * minute + second;
    if ((*rest == '+' || *rest == '-') && sscanf(rest + 1, "%2d:%2d", &off_hours, &off_minutes) == 2)
        seconds -= (*rest == '-' ? -60 : 60) * (60 * off_hours + off_minutes);
    return seconds;
}
