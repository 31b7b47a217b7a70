/* What each lamp of a scene is made of, for the report: where params ask for it, as lamps are stood. */
#include "city/city.h"
#include "import/load/load.h"

/* Lamps that follow one another mostly say the same. NULL: memory was refused. */
static const char *kept(importer *im, const char *text, const char *last) {
    text = text ? text : "";
    return last && !strcmp(text, last) ? last : arena_strdup(&im->report->arena, text);
}

static const noc_report_lamp *last_lamp(const importer *im) {
    static const noc_report_lamp none;
    return im->report->lamps.len ? &im->report->lamps.data[im->report->lamps.len - 1] : &none;
}

void each_lamp_begin(importer *im, const input *in, lamp_roads roads, const geo_lamp *lamp, const char *matched,
                     unsigned said) {
    const noc_report_lamp *last = last_lamp(im);
    const geo_highway *highway = roads.beside ? geo_highway_get(roads.beside->highway) : NULL;
    im->lamp_now = (noc_report_lamp){ .file = kept(im, in ? in->path : NULL, last->file),
                                      .street = kept(im, roads.street ? roads.street->name : NULL, last->street),
                                      .road = kept(im, highway ? highway->word : NULL, last->road),
                                      .rules = kept(im, matched, last->rules),
                                      .tags = kept(im, lamp->tags, last->tags) };
    for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++) {
        bool chosen =
            !in && (what == NOC_LAMP_HEIGHT || what == NOC_LAMP_FLUX) && !(said >> what & 1); /* by the road */
        if (chosen || city_lamp_assumes(lamp, (noc_lamp_default)what))
            im->lamp_now.assumed |= 1u << what;
    }
}

void each_lamp_light(void *user, const city_lamp_light *light) {
    importer *im = user;
    noc_report_lamp l = im->lamp_now;
    l.light = (size_t)light->index;
    l.profile = kept(im, light->profile, last_lamp(im)->profile);
    l.height = light->height;
    l.direction = light->direction;
    l.watts = light->watts;
    l.assumed |= light->by_chance ? 1u << NOC_LAMP_DIRECTION : 0;
    if (!l.file || !l.street || !l.road || !l.rules || !l.tags || !l.profile || !array_push(&im->report->lamps, l))
        noc_scene_out_of_memory(im->scene);
}
