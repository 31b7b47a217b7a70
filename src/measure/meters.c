/* Meters at points. Lights are chosen for tiles of 16 x 16 receivers; a tile here has meters that stand near each
 * other, each as often as there is room. */
#include "measure/readings.h"

#include <math.h>

enum { TILE = 16, TILE_AREA = TILE * TILE, TILES = BLOCK_AREA / TILE_AREA, TILES_X = BLOCK_PIXELS / TILE };
#define NEAR 16.0 /* m */

/* The meters of one block. */
typedef struct meter_block {
    const measuring *by;
    const noc_meter *meters; /* the first of them */
    size_t count;
    uint32_t seed;
    uint32_t of[BLOCK_AREA], turn[BLOCK_AREA], turns[BLOCK_AREA]; /* a pixel: which meter, and which of its pixels */
    tally tallies[BLOCK_AREA];
    int width, height;
} meter_block;

static double length(const double v[3]) { return hypot(hypot(v[0], v[1]), v[2]); }

noc_status meters_check(const noc_meter *meters, size_t count, noc_log *log) {
    for (size_t i = 0; i < count; i++) {
        const noc_meter *m = &meters[i];
        bool turned = m->response == NOC_RESPONSE_PLANE || m->response == NOC_RESPONSE_SEMICYLINDER;
        double l = m->response == NOC_RESPONSE_PLANE ? length(m->normal) : hypot(m->normal[0], m->normal[1]);
        if ((unsigned)m->response >= NOC_RESPONSE_COUNT)
            return noc_error(log, NOC_ERR_ARGUMENT, "measure: meter %zu has no response %d", i, (int)m->response);
        for (int k = 0; k < 3; k++)
            if (!(fabs(m->place[k]) < 1e7))
                return noc_error(log, NOC_ERR_ARGUMENT, "measure: meter %zu stands nowhere, or beyond 10 000 km", i);
        if (turned && !(l > 0 && isfinite(l)))
            return noc_error(log, NOC_ERR_ARGUMENT, "measure: meter %zu faces nowhere", i);
    }
    return NOC_OK;
}

/* The mean over a curved surface of the illuminance on its parts is what a meter of that shape reads. So its normals
 * are those of such a surface, evenly (semicylinder: azimuths within 90 degrees; cylinder: all; hemisphere: solid
 * angle). */
static void facing(const noc_meter *m, uint32_t key, uint32_t i, double out[3]) {
    double at[2], l = length(m->normal), azimuth = atan2(m->normal[1], m->normal[0]);
    spread_2d(key, i, at);
    if (m->response == NOC_RESPONSE_PLANE) {
        for (int k = 0; k < 3; k++)
            out[k] = m->normal[k] / l;
        return;
    }
    bool half = m->response == NOC_RESPONSE_SEMICYLINDER;
    double turn = half ? azimuth + (at[0] - 0.5) * M_PI : 2 * M_PI * at[0];
    double z = m->response == NOC_RESPONSE_HEMISPHERE ? at[1] : 0, r = sqrt(1 - z * z);
    out[0] = r * cos(turn);
    out[1] = r * sin(turn);
    out[2] = z;
}

static noc_status place(void *user, uint32_t frame, noc_receiver *receivers, bool *some) {
    const meter_block *b = user;
    size_t area = (size_t)b->width * (size_t)b->height;
    for (size_t i = 0; i < area; i++) {
        receivers[i] = (noc_receiver){ .material = NO_SURFACE };
        if (b->of[i] == NO_READING)
            continue;
        const noc_meter *m = &b->meters[b->of[i]];
        double n[3];
        facing(m, mix(b->seed, b->of[i]), frame * b->turns[i] + b->turn[i], n);
        receivers[i] = meter_receiver(b->by, m->place, n);
        *some = true;
    }
    return NOC_OK;
}

/* So many of the meters from the first one on share a tile. */
static size_t neighbours(const noc_meter *meters, size_t count) {
    size_t n = 1;
    for (; n < count && n < TILE_AREA; n++) {
        double d[3];
        for (int k = 0; k < 3; k++)
            d[k] = meters[n].place[k] - meters[0].place[k];
        if (!(length(d) <= NEAR))
            break;
    }
    return n;
}

static void fill_tile(meter_block *b, int tile, size_t first, size_t count) {
    uint32_t turns = (uint32_t)(TILE_AREA / count);
    for (uint32_t i = 0; i < TILE_AREA; i++) {
        int x = tile % TILES_X * TILE + (int)i % TILE, y = tile / TILES_X * TILE + (int)i / TILE;
        size_t at = (size_t)y * BLOCK_PIXELS + (size_t)x;
        bool used = i < turns * count;
        b->of[at] = used ? (uint32_t)first + i % (uint32_t)count : NO_READING;
        b->turn[at] = i / (uint32_t)count;
        b->turns[at] = turns;
    }
}

/* Takes as many meters as fill the block's tiles. */
static void fill(meter_block *b, const noc_meter *meters, size_t count) {
    uint32_t bits[6];
    int tiles = 0;
    b->meters = meters;
    b->count = 0;
    memset(b->of, 0xff, sizeof(b->of));
    for (; tiles < TILES && b->count < count; tiles++) {
        size_t n = neighbours(meters + b->count, count - b->count);
        fill_tile(b, tiles, b->count, n);
        b->count += n;
    }
    b->width = BLOCK_PIXELS;
    b->height = (tiles + TILES_X - 1) / TILES_X * TILE;
    memcpy(bits, meters->place, sizeof(bits));
    for (int k = 0; k < 6; k++)
        b->seed = mix(b->seed, bits[k]);
}

static noc_status read_block(measuring *m, meter_block *b, noc_reading *readings) {
    block of = { .width = b->width,
                 .height = b->height,
                 .seed = b->seed,
                 .of = b->of,
                 .count = b->count,
                 .tallies = b->tallies,
                 .place = place,
                 .user = b };
    noc_status status = measure_block(m, &of);
    for (size_t i = 0; i < b->count && !status; i++) {
        readings[i] = reading_of(&b->tallies[i], of.frames);
        status = note_reading(m, &readings[i]);
    }
    return status;
}

noc_status measure_meters(measuring *m, const noc_meter *meters, size_t count, uint32_t seed, noc_reading *readings) {
    meter_block *b = noc_alloc(sizeof(*b));
    noc_status status = b ? NOC_OK : noc_no_memory(m->view->log, "measure");
    for (size_t done = 0; done < count && !status; done += b->count) {
        b->by = m;
        b->seed = seed;
        fill(b, meters + done, count - done);
        m->from = (double)done / (double)count;
        m->to = (double)(done + b->count) / (double)count;
        status = read_block(m, b, readings + done);
    }
    free(b);
    return status;
}

noc_status noc_measure_points(noc_view *view, const noc_meter *meters, size_t count, const noc_measure_params *params,
                              const noc_progress *progress, noc_reading *readings, noc_measure_info *info) {
    if (!view || (count && (!meters || !readings)))
        return noc_null(view ? view->log : NULL, __func__);
    measuring m;
    noc_status status = measuring_begin(&m, view, params, progress);
    status = status ? status : meters_check(meters, count, view->log);
    status = status ? status : measure_meters(&m, meters, count, m.render.seed, readings);
    measuring_end(&m, info);
    return status;
}
