/* Cars: their tracks are kept until all that they lie on is in. */
#include "import/load/load.h"
#include "city/traffic/traffic.h"

noc_status track_keep(importer *im, input *in, size_t index, const geo_track *track) {
    pending_track p = { .track = *track, .input = index };
    size_t points = 0;
    in->file.tracks++;
    if (im->inspect || im->params->traffic == NOC_SWITCH_OFF)
        return NOC_OK;
    for (size_t i = 0; i < track->part_count; i++)
        points += track->part_size[i];
    size_t *sizes = arena_alloc(&im->names, track->part_count * sizeof(*sizes));
    double *xyz = arena_alloc(&im->names, 3 * points * sizeof(*xyz));
    double *seconds = track->seconds ? arena_alloc(&im->names, points * sizeof(*seconds)) : NULL;
    p.track.id = arena_strdup(&im->names, track->id);
    if (!sizes || !xyz || (track->seconds && !seconds) || !p.track.id)
        return noc_no_memory(im->log, in->path);
    memcpy(sizes, track->part_size, track->part_count * sizeof(*sizes));
    memcpy(xyz, track->xyz, 3 * points * sizeof(*xyz));
    if (seconds)
        memcpy(seconds, track->seconds, points * sizeof(*seconds));
    p.track.part_size = sizes;
    p.track.xyz = xyz;
    p.track.seconds = seconds;
    if (!array_push(&im->tracks, p))
        return noc_no_memory(im->log, in->path);
    return take_kept(im, in);
}

/* The user's own. */
static noc_status add_bodies(importer *im, city_traffic *traffic) {
    const noc_texts *bodies = &im->params->cars.bodies;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < bodies->count && !status; i++) {
        noc_scene *from = body_read(im, bodies->text[i], "--car-body", "cars", 0, &status);
        status = status ? status : city_traffic_body(traffic, from, bodies->text[i]);
        noc_scene_destroy(from);
    }
    return status;
}

noc_status traffic_add(importer *im) {
    size_t roads = im->params->traffic == NOC_SWITCH_ON ? im->roads.len : 0, cars;
    if (!im->tracks.len && !roads) {
        if (im->params->cars.bodies.count)
            noc_warn(im->log, "--car-body: the inputs hold no tracks of cars, and cars along roads are asked for by "
                              "--traffic");
        return NOC_OK;
    }
    size_t left = 0;
    city_traffic *traffic = city_traffic_create(im->scene, &im->params->cars);
    noc_status status = traffic ? add_bodies(im, traffic) : NOC_ERR_MEMORY;
    for (size_t i = 0; i < im->tracks.len && !status; i++) {
        const pending_track *p = &im->tracks.data[i];
        status = city_traffic_follow(traffic, &p->track, im->inputs[p->input].issues, &cars);
        im->inputs[p->input].file.cars += cars;
        left += !cars;
        if (i % 256 == 0 && !import_progress(im, &im->inputs[p->input], im->bytes_before))
            status = NOC_ERR_CANCELLED;
    }
    if (!status && roads)
        status = city_traffic_roads(traffic, im->roads.data, roads, &im->params->progress, &im->report->road_cars);
    city_traffic_destroy(traffic);
    if (!status && left)
        noc_warn(im->log, "%zu of %zu tracks of cars %s left out: outside of the city, without ground, or too short",
                 left, im->tracks.len, left == 1 ? "is" : "are");
    if (!status && im->scene->cars.len)
        noc_info(im->log, "%zu cars, %zu of them along roads of maps", im->scene->cars.len, im->report->road_cars);
    return status;
}
