/* What a backend on the CPU is made of: everything but the tracer. */
#ifndef NOC_CPU_BACKEND_H
#define NOC_CPU_BACKEND_H

#include "backend/cpu/tracer.h"
#include "render/backend.h"

/* See noc_backend for what each does. */
noc_status noc_cpu_device_create(const noc_tracer *tracer, const noc_device_params *params, noc_log *log,
                                 void **device);
void noc_cpu_device_destroy(void *device);
noc_status noc_cpu_world_create(void *device, const noc_scene *scene, void **world);
void noc_cpu_world_destroy(void *world);
noc_status noc_cpu_view_create(void *world, void **view);
void noc_cpu_view_destroy(void *view);
size_t noc_cpu_bytes_a_pixel(int reservoir_sets, uint32_t aovs);
noc_status noc_cpu_view_resize(void *view, int width, int height, int reservoir_sets);
noc_status noc_cpu_stage(void *view, const noc_frame *frame, const noc_stage *stage, const noc_progress *progress,
                         double from, double to);
noc_status noc_cpu_accumulate(void *view, const noc_frame *frame);
noc_status noc_cpu_read(void *view, noc_image *image);
noc_status noc_cpu_read_aov(void *view, noc_aov aov, float *value);
void noc_cpu_rows(void *view, const frame_camera *camera, const noc_frame_rows *rows);
void noc_cpu_run(void *device, size_t items, void (*fn)(void *ctx, size_t item, int worker), void *ctx);
void noc_cpu_stats(void *view, noc_frame_stats *stats);
void noc_cpu_light_stats(void *view, noc_light_stats *stats);
noc_status noc_cpu_influence(void *view, const noc_render_params *params, const struct noc_influence **volumes);
noc_status noc_cpu_cast(void *view, const noc_ray *rays, size_t count, noc_hit *hits);
noc_status noc_cpu_ask(void *view, const noc_render_params *params, bool tree, noc_asking *out);
void noc_cpu_clear(void *view, const noc_sight *sights, size_t count, float *clear);
void noc_cpu_record(void *view, bool on);
noc_status noc_cpu_replay(void *view, const noc_progress *progress, noc_trace_floor *floor);

/* All of a noc_backend but the creation of a device. */
#define NOC_CPU_BACKEND                                                                                                \
    .device_destroy = noc_cpu_device_destroy, .world_create = noc_cpu_world_create,                                    \
    .world_destroy = noc_cpu_world_destroy, .view_create = noc_cpu_view_create, .view_destroy = noc_cpu_view_destroy,  \
    .bytes_a_pixel = noc_cpu_bytes_a_pixel, .resize = noc_cpu_view_resize, .stage = noc_cpu_stage,                     \
    .accumulate = noc_cpu_accumulate, .read = noc_cpu_read, .aov = noc_cpu_read_aov, .rows = noc_cpu_rows,             \
    .run = noc_cpu_run, .stats = noc_cpu_stats, .light_stats = noc_cpu_light_stats, .influence = noc_cpu_influence,    \
    .cast = noc_cpu_cast, .ask = noc_cpu_ask, .clear = noc_cpu_clear, .record = noc_cpu_record,                        \
    .replay = noc_cpu_replay

#endif
