/* The order of axes, by the first coordinates in a CRS. Geographic CRSs come in the order of their authority (latitude
 * first for EPSG:6697), however they are spelled. Projected ones come easting first: several of them are northing first
 * by the authority's book (EPSG:31466 to 31469, 31256), but files do not follow it. Where the first coordinates fit the
 * CRS's area of use only the other way round, or lie where the other inputs do only so (meeting.c), the other way it
 * is, and the report says so. */
#include "import/load/load.h"

#include <math.h>

#define AXIS_TRIES 16 /* polygons that are looked at before the order of axes is left as it is */

/* Is `zone` million metres of the easting the number of the UTM zone that the point lies in without them? Zones reach
 * over their edges a little. */
static bool is_zone_number(source_crs *s, double zone, double x, double y) {
    double p[2];
    return !geo_crs_is_geographic(s->crs) && zone >= 1 && zone <= 60 &&
           geo_crs_outside(s->crs, x - 1e6 * zone, y) == 0 && geo_crs_lonlat_near(s->crs, x - 1e6 * zone, y, p) &&
           fabs(floor((p[0] + 180) / 6) + 1 - zone) <= 1;
}

/* Swaps the axes, or takes the zone number off the easting (32 512 345 m instead of 512 345 m), if that is what brings
 * the point into the CRS's area of use. */
static noc_status decide(reading *r, source_crs *s, double x, double y, const char *id) {
    geo_issues *issues = r->in->issues;
    double zone = floor(x / 1e6);
    double given = geo_crs_outside(s->crs, x, y);
    if (given == 0) {
        s->axes_decided = true;
        noc_status status = meeting_exchanges(r, s->crs, x, y, &s->swap);
        if (status || !s->swap)
            return status;
        noc_warn(r->log, "%s: lies where the other inputs do only with latitude and longitude exchanged: done",
                 r->in->path);
        geo_issue(issues, GEO_GUESSED, "axes exchanged to meet the other inputs", id);
    } else if (geo_crs_outside(s->crs, y, x) == 0) {
        s->axes_decided = s->swap = true;
        noc_warn(r->log, "%s: the coordinates fit %s only with their axes exchanged: done", r->in->path,
                 geo_crs_name(s->crs));
        geo_issue(issues, GEO_GUESSED, "axes exchanged to fit the CRS", id);
    } else if (is_zone_number(s, zone, x, y)) {
        s->axes_decided = true;
        s->shift_x = -1e6 * zone;
        geo_issue(issues, GEO_REPAIRED, "zone number taken off the easting", id);
    } else {
        s->outside = given;
        s->opposite = geo_crs_outside(s->crs, -x, -y) == 0 || geo_crs_outside(s->crs, -y, -x) == 0;
        s->axes_decided = ++s->tries == AXIS_TRIES;
    }
    return NOC_OK;
}

noc_status axes_fix(reading *r, source_crs *s, double *xyz, size_t count, const char *id) {
    noc_status status = NOC_OK;
    for (size_t i = 0; s->crs && i < count && !s->axes_decided; i++)
        if (isfinite(xyz[3 * i]) && isfinite(xyz[3 * i + 1])) {
            const double *p = xyz + 3 * i;
            given_crs_fit(r, s, p[0], p[1]);
            status = decide(r, s, p[s->turned], p[!s->turned], id);
            break;
        }
    bool swap = s->swap != s->turned;
    if (!s->crs || (!swap && s->shift_x == 0))
        return status;
    for (size_t i = 0; i < count; i++) {
        double *p = xyz + 3 * i, x = p[0];
        if (swap) {
            p[0] = p[1];
            p[1] = x;
        }
        p[0] += s->shift_x;
    }
    return status;
}

bool axes_doubtful(const source_crs *s) { return s->tries && (!s->axes_decided || s->tries == AXIS_TRIES); }
