/* What all readers of lamps do with a feature once they have its tags and its place. */
#include "import/lamp_tags.h"

#include <math.h>

noc_status lamp_writer_crs(lamp_writer *w, const char *crs) {
    /* tuples come to us in easting northing order already: traditional GIS order, whatever the authority says */
    bool lat_first = false;
    return w->sink->crs(w->sink->ctx, crs ? crs : "", w->place, &lat_first);
}

static bool on_earth(double lon, double lat) { return fabs(lon) <= 180 && fabs(lat) <= 90; }

/* A lamp in use whose place is none. */
static noc_status lose(lamp_writer *w, const char *reason, const char *id) {
    geo_issue(w->sink->issues, false, reason, id);
    if (w->sink->lamps_lost)
        ++*w->sink->lamps_lost;
    w->lost++;
    return NOC_OK;
}

noc_status lamp_writer_point(lamp_writer *w, const lamp_tag *tags, size_t count, bool inventory, double x, double y, double z) {
    w->features++;
    lamp_verdict verdict = lamp_verdict_of(tags, count, inventory);
    if (verdict == LAMP_NONE)
        return NOC_OK;
    geo_lamp lamp = { .xyz = { x, y, isfinite(z) && z != 0 ? z : NAN } }; /* 0: written for want of a height */
    lamp_read(tags, count, &lamp, verdict == LAMP_ACTIVE ? w->sink->issues : NULL);
    if (!lamp_accept(verdict, lamp.id, w->sink->issues))
        return NOC_OK;
    if (!isfinite(x) || !isfinite(y))
        return lose(w, "lamp without a place", lamp.id);
    if (w->geographic && !on_earth(x, y)) {
        w->off_earth++;
        w->exchangeable += on_earth(y, x);
        return lose(w, "lamp whose longitude or latitude is out of range", lamp.id);
    }
    if (x == 0 && y == 0)
        return lose(w, "lamp at 0, 0: no place given", lamp.id);
    w->lamps++;
    return w->sink->lamp(w->sink->ctx, &lamp);
}

noc_status lamp_writer_end(lamp_writer *w) {
    if (w->off_earth > w->lamps && w->exchangeable == w->off_earth)
        return noc_error(w->sink->log, NOC_ERR_FORMAT,
                         "%s: its coordinates are no longitudes and latitudes; with the two exchanged all %zu are: exchange them in the "
                         "file", w->place, w->off_earth);
    if (w->off_earth > w->lamps)
        return noc_error(w->sink->log, NOC_ERR_FORMAT,
                         "%s: its coordinates are no longitudes and latitudes, and it names no other CRS; give one with --crs",
                         w->place);
    if (w->lost && !w->lamps)
        return NOC_OK; /* the importer says that none of its lamps is of use */
    if (!w->lamps && w->features)
        noc_warn(w->sink->log, "%s: none of its %zu features is a street lamp in use", w->place, w->features);
    else if (!w->lamps)
        noc_warn(w->sink->log, "%s: no tag and no column of it tells of street lamps", w->place);
    return NOC_OK;
}
