/* How surfaces look where their file says it: colours and images. A file's looks are numbered as it is read, its
 * surfaces are kept apart by them, and the scene gets a material for each. Images are read last, when it is known how
 * many must share the memory for them. */
#include "import/load/load.h"

#include "image/pixels.h"
#include "noct/noct.h"

#include <math.h>

#define MOST_LOOKS 1000000       /* of a file */
#define KEPT_BYTES (256u << 20)  /* of all files that are kept until their pixels are read; others are read twice */
#define PIXELS_AT_ONCE 100000000 /* of images that are read at the same time, but for the last of them */

/* ---- a file's ---- */

/* The folder of a file, with a slash at its end, or "": so many bytes of its path. */
static size_t folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

/* Where the image lies, in the reading's texts; NULL where it is of no use, which is counted, or memory was refused. */
static const char *find_image(reading *r, const char *name, bool *lost) {
    char *named = arena_strdup(&r->look_texts, name);
    for (char *c = named; c && *c; c++)
        *c = *c == '\\' ? '/' : *c;
    const char *folder = arena_strndup(&r->look_texts, r->in->path, folder_length(r->in->path));
    char *path = named && folder ? arena_format(&r->look_texts, "%s%s", *named == '/' ? "" : folder, named) : NULL;
    if (!path)
        return NULL;
    const char *trouble = import_named_trouble(folder, path, r->im->params->allow_outside);
    if (!trouble)
        return path;
    *lost = true;
    if (r->side)
        return NULL; /* counted in its turn */
    bool outside = strstr(trouble, "outside") != NULL;
    geo_issue(r->in->issues, GEO_GUESSED, outside ? "image outside of the file's folder" : "image that is not there",
              name);
    return NULL;
}

noc_status look_number(reading *r, const geo_appearance *appearance, uint32_t *number) {
    surface_look look = { .as = *appearance };
    bool lost = false;
    *number = 0;
    if (appearance->image && *appearance->image)
        look.image = find_image(r, appearance->image, &lost);
    if (r->look_texts.refused)
        return noc_no_memory(r->log, r->in->path);
    if (r->side && (lost || r->looks.len == MOST_LOOKS))
        return NOC_ERR_UNSUPPORTED;
    look.as.image = NULL;
    if (!look.image && !look.as.coloured && !look.as.name && !(look.as.transmittance > 0))
        return NOC_OK;
    if (look.as.name && !(look.as.name = arena_strdup(&r->look_texts, look.as.name)))
        return noc_no_memory(r->log, r->in->path);
    if (r->looks.len == MOST_LOOKS) {
        geo_issue(r->in->issues, GEO_GUESSED, "appearance beyond the first million", "");
        return NOC_OK;
    }
    if (!array_push(&r->first_group, 0) || !array_push(&r->looks, look))
        return noc_no_memory(r->log, r->in->path);
    *number = (uint32_t)r->looks.len;
    return NOC_OK;
}

geo_triangles *look_triangles(reading *r, uint32_t look, noc_class cls) {
    uint32_t *first = &r->first_group.data[look - 1];
    for (uint32_t g = *first; g; g = r->groups.data[g - 1].next)
        if (r->groups.data[g - 1].cls == cls)
            return &r->groups.data[g - 1].triangles;
    if (r->group_count == r->groups.len && !array_push(&r->groups, (look_group){ 0 }))
        return NULL;
    look_group *group = &r->groups.data[r->group_count++];
    group->look = look;
    group->cls = cls;
    group->next = *first;
    *first = (uint32_t)r->group_count;
    return &group->triangles;
}

void look_end_object(reading *r) {
    for (size_t i = 0; i < r->group_count; i++)
        r->first_group.data[r->groups.data[i].look - 1] = 0;
    r->group_count = 0;
}

void look_free(reading *r) {
    for (size_t i = 0; i < r->groups.len; i++)
        geo_triangles_free(&r->groups.data[i].triangles);
    array_free(&r->groups);
    array_free(&r->looks);
    array_free(&r->first_group);
    arena_free(&r->look_texts);
}

/* ---- the scene's ---- */

/* The number of the image, whose file `in` is if it is new. data: of one that lies in `in`. false: no memory. */
static bool number_image(importer *im, const input *in, const char *path, noc_wrap wrap, uint8_t cutoff,
                         const uint8_t *data, size_t size, uint64_t *number) {
    char *key = noc_format("%d %d %s%s", (int)wrap, cutoff, data ? "in " : "", path);
    bool ok = key && true;
    if (ok && !map_get(&im->image_numbers, key, number)) {
        scene_image image = {
            .path = arena_strdup(&im->names, path), .wrap = wrap, .cutoff = cutoff, .input = (size_t)(in - im->inputs)
        };
        *number = im->images.len;
        ok = image.path && array_reserve(&im->images, im->images.len + 1) &&
             map_put(&im->image_numbers, key, *number, NULL) && (!data || (image.data = noc_alloc_large(size, 1)));
        if (ok && data) {
            memcpy(image.data, data, size);
            image.bytes = size;
            im->image_bytes += size;
        }
        if (ok)
            im->images.data[im->images.len++] = image;
    }
    free(key);
    return ok;
}

/* Classes whose light is behind glass keep to it: what a file calls a window's colour is what it is drawn with. Behind
 * a window is a room, which models do not have: no light goes through it. */
static noc_material material_of(noc_class cls, const geo_appearance *as) {
    noc_material m = noc_class_material(cls);
    if (as->coloured)
        memcpy(m.albedo, as->albedo, sizeof(m.albedo));
    if (as->f0 >= 0)
        m.f0 = as->f0;
    if (as->roughness >= 0)
        m.roughness = as->roughness;
    m.transmittance = cls == NOC_CLASS_WINDOW || noc_material_shines(&m) ? 0 : as->transmittance;
    return m;
}

noc_status look_material(importer *im, const input *in, noc_class cls, const surface_look *look, int *material) {
    const geo_appearance *as = &look->as;
    uint64_t image = 0, found;
    if (look->image && !number_image(im, in, look->image, as->wrap, 0, NULL, 0, &image))
        return noc_no_memory(im->log, in->path);
    char *key = noc_format("%d %lld %d %.9g %.9g %.9g %.9g %.9g %.9g %s", (int)cls, look->image ? (long long)image : -1,
                           as->coloured, as->albedo[0], as->albedo[1], as->albedo[2], as->f0, as->roughness,
                           as->transmittance, as->name ? as->name : "");
    if (!key)
        return noc_no_memory(im->log, in->path);
    noc_status status = NOC_OK;
    if (map_get(&im->looks, key, &found)) {
        *material = (int)found;
    } else {
        noc_material m = material_of(cls, as);
        *material = noc_scene_add_material(im->scene, &m);
        if (*material < 0)
            status = NOC_ERR_UNSUPPORTED; /* said by the scene */
        else if (as->name && noc_scene_name_material(im->scene, *material, as->name))
            status = NOC_ERR_MEMORY;
        else if (!map_put(&im->looks, key, (uint64_t)*material, NULL) ||
                 (look->image && !array_push(&im->image_uses, (image_use){ *material, (uint32_t)image, { 1, 1, 1 } })))
            status = noc_no_memory(im->log, in->path);
    }
    free(key);
    return status;
}

noc_status look_mesh_image(void *ctx, int material, const mesh_image *image) {
    reading *r = ctx;
    importer *im = r->im;
    bool lost;
    const char *path = image->data ? image->name : find_image(r, image->name, &lost);
    uint64_t number;
    if (r->look_texts.refused)
        return noc_no_memory(r->log, r->in->path);
    if (!path || im->inspect)
        return NOC_OK;
    noc_status status = image->data ? take_affords(im, r->in, image->size) : NOC_OK;
    if (status)
        return status;
    image_use use = { .material = material };
    memcpy(use.albedo, image->albedo, sizeof(use.albedo));
    if (!number_image(im, r->in, path, image->wrap, image->cutoff, image->data, image->size, &number))
        return noc_no_memory(r->log, r->in->path);
    use.image = (uint32_t)number;
    return array_push(&im->image_uses, use) ? NOC_OK : noc_no_memory(r->log, r->in->path);
}

void look_images_free(importer *im) {
    for (size_t i = 0; i < im->images.len; i++)
        free(im->images.data[i].data);
    array_free(&im->images);
    array_free(&im->image_uses);
}

/* ---- images ---- */

/* The whole file into *data, where it is not kept: *read is what the caller frees. NOC_ERR_FORMAT with *why where it is
 * of no use. */
static noc_status read_bytes(const importer *im, const scene_image *image, uint8_t **read, const uint8_t **data,
                             size_t *size, const char **why) {
    const char *from = im->inputs[image->input].path, *name = image->path;
    size_t length = folder_length(from);
    char *folder = noc_strndup(from, length);
    *read = NULL;
    *why = NULL;
    *data = image->data;
    *size = image->bytes;
    if (image->data) {
        free(folder);
        return NOC_OK;
    }
    if (!strncmp(name, from, length))
        name += length;
    if (folder)
        *data = *read = import_read_named(folder, name, im->params->allow_outside, IMPORT_NAMED, NULL, size, why);
    free(folder);
    return *read ? NOC_OK : *why ? NOC_ERR_FORMAT : NOC_ERR_MEMORY;
}

/* One image of several that are read at once. */
typedef struct image_job {
    importer *im;
    scene_image *image;
    bool whole; /* its pixels too; else its size */
    pixel_bytes pixels;
    noc_status status;
} image_job;

/* Is there room to keep so many bytes? */
static bool keep(importer *im, size_t size) {
    if (atomic_fetch_add(&im->images_kept, size) + size <= KEPT_BYTES)
        return true;
    atomic_fetch_sub(&im->images_kept, size);
    return false;
}

static void run_job(void *ctx, size_t item, int worker) {
    image_job *job = (image_job *)ctx + item;
    scene_image *image = job->image;
    const char *why;
    uint8_t *read;
    const uint8_t *data;
    size_t size;
    (void)worker;
    job->status = read_bytes(job->im, image, &read, &data, &size, &why);
    if (!job->status && job->whole) {
        job->status = pixels_read(data, size, image->path, image->cutoff, NULL, &job->pixels);
    } else if (!job->status) {
        job->status = pixels_size(data, size, image->path, NULL, &image->width, &image->height);
        image->sum = noct_sum(data, size);
        image->bytes = size;
    }
    if (job->status == NOC_ERR_UNSUPPORTED)
        image->reason = "image of a format that is not read (PNG and JPEG are)";
    else if (job->status == NOC_ERR_FORMAT)
        image->reason = why ? why : "broken image";
    else if (!job->status && job->pixels.damaged)
        image->reason = "damaged image";
    if (read && !job->status && !job->whole && keep(job->im, size))
        image->data = read;
    else
        free(read);
}

/* Only memory that is refused is a failure. */
static noc_status failure_of(const importer *im, const image_job *job) {
    return job->status == NOC_ERR_MEMORY ? noc_no_memory(im->log, job->image->path) : NOC_OK;
}

/* Of all images, which are of no use where theirs stays 0. */
static noc_status read_sizes(importer *im, noc_pool *pool, image_job *jobs) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < im->images.len; i++)
        jobs[i] = (image_job){ .im = im, .image = &im->images.data[i] };
    noc_pool_run(pool, im->images.len, run_job, jobs);
    for (size_t i = 0; i < im->images.len && !status; i++) {
        status = failure_of(im, &jobs[i]);
        if (jobs[i].status)
            im->images.data[i].width = im->images.data[i].height = 0;
    }
    return status;
}

/* Do both files hold the same? */
static noc_status compare(const importer *im, const scene_image *a, const scene_image *b, bool *same) {
    uint8_t *read_a, *read_b = NULL;
    const uint8_t *of_a, *of_b;
    size_t bytes_a, bytes_b;
    const char *why;
    noc_status status = read_bytes(im, a, &read_a, &of_a, &bytes_a, &why);
    if (!status)
        status = read_bytes(im, b, &read_b, &of_b, &bytes_b, &why);
    *same = !status && bytes_a == bytes_b && !memcmp(of_a, of_b, bytes_a);
    free(read_a);
    free(read_b);
    return status == NOC_ERR_MEMORY ? noc_no_memory(im->log, a->path) : NOC_OK;
}

/* Images are often given once for each building: those whose files hold the same become one texture. */
static noc_status find_alike(importer *im) {
    noc_map first = { 0 };
    noc_status status = NOC_OK;
    for (size_t i = 0; i < im->images.len && !status; i++) {
        scene_image *image = &im->images.data[i];
        uint64_t before;
        bool same = false;
        char *key = image->width ? noc_format("%d %d %llu %llx", (int)image->wrap, image->cutoff,
                                              (unsigned long long)image->bytes, (unsigned long long)image->sum)
                                 : NULL;
        if (!image->width)
            continue;
        if (!key)
            status = noc_no_memory(im->log, image->path);
        else if (map_get(&first, key, &before))
            status = compare(im, &im->images.data[before], image, &same);
        else if (!map_put(&first, key, i, NULL))
            status = noc_no_memory(im->log, image->path);
        if (same) {
            image->like = (uint32_t)before + 1;
            free(image->data);
            image->data = NULL;
        }
        free(key);
    }
    map_free(&first);
    return status;
}

/* Those that are like one before it take no more memory. */
static double bytes_of(const scene_image *i) {
    int width = NOC_MAX(i->width >> i->leave_out, 1), height = NOC_MAX(i->height >> i->leave_out, 1);
    return i->width && !i->like ? (double)noc_texture_words(width, height) * sizeof(uint32_t) : 0;
}

double look_least_pixels = 1e8;
#define PIXELS_A_BYTE 100.0 /* a photograph has 5 to 20, an even colour as PNG some hundreds */

/* Images of one colour take next to no bytes, and seconds to read: those beyond what all may have are of no use. */
static void limit_pixels(importer *im) {
    double most = look_least_pixels, sum = 0;
    for (size_t i = 0; i < im->images.len; i++)
        most += im->images.data[i].like ? 0 : PIXELS_A_BYTE * (double)im->images.data[i].bytes;
    for (size_t i = 0; i < im->images.len; i++) {
        scene_image *image = &im->images.data[i];
        double pixels = image->like ? 0 : (double)image->width * image->height;
        sum += pixels;
        if (sum <= most)
            continue;
        sum -= pixels;
        image->width = image->height = 0;
        image->reason = "image beyond the pixels that images of so few bytes may have";
    }
}

/* Leaves finest levels out until all fit: of the largest first, so that none is finer than it need be. */
static void fit(importer *im) {
    double most = im->params->texture_memory * 1e6, sum = 0, largest = 0;
    for (size_t i = 0; i < im->images.len; i++)
        sum += bytes_of(&im->images.data[i]);
    while (sum > most) {
        largest = 0;
        for (size_t i = 0; i < im->images.len; i++)
            largest = NOC_MAX(largest, bytes_of(&im->images.data[i]));
        if (largest <= (TEXTURE_HEAD + 1) * sizeof(uint32_t))
            return;
        for (size_t i = 0; i < im->images.len && sum > most; i++) {
            scene_image *image = &im->images.data[i];
            double had = bytes_of(image);
            if (had <= largest / 2 || had <= (TEXTURE_HEAD + 1) * sizeof(uint32_t))
                continue;
            im->report->images_reduced += !image->leave_out;
            image->leave_out++;
            sum += bytes_of(image) - had;
        }
    }
}

/* As many from `first` on as are read at once; returns the next one. */
static size_t some(const importer *im, size_t first) {
    double sum = 0;
    for (; first < im->images.len && sum < PIXELS_AT_ONCE; first++)
        if (!im->images.data[first].like)
            sum += (double)im->images.data[first].width * im->images.data[first].height;
    return first;
}

static noc_status add_image(importer *im, image_job *job) {
    scene_image *image = job->image;
    noc_status status = failure_of(im, job);
    if (status || job->status)
        return status;
    noc_texture texture = { .width = job->pixels.width,
                            .height = job->pixels.height,
                            .rgb = job->pixels.rgb,
                            .holes = job->pixels.holes,
                            .wrap = image->wrap,
                            .leave_out = image->leave_out };
    image->texture = noc_scene_add_texture(im->scene, &texture);
    if (image->texture < 0) /* said by the scene */
        return im->scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
    return NOC_OK;
}

static noc_status read_pixels(importer *im, noc_pool *pool, image_job *jobs) {
    noc_status status = NOC_OK;
    const noc_progress *progress = &im->params->progress;
    for (size_t first = 0, end; first < im->images.len && !status; first = end) {
        size_t count = 0;
        end = some(im, first);
        for (size_t i = first; i < end; i++)
            if (im->images.data[i].width && !im->images.data[i].like)
                jobs[count++] = (image_job){ .im = im, .image = &im->images.data[i], .whole = true };
        noc_pool_run(pool, count, run_job, jobs);
        for (size_t i = 0; i < count; i++) {
            if (!status)
                status = add_image(im, &jobs[i]);
            free(jobs[i].pixels.rgb);
            free(jobs[i].pixels.holes);
            free(jobs[i].image->data);
            jobs[i].image->data = NULL;
        }
        if (!status && progress->update && !progress->update(progress->user, "images", 0.9))
            status = NOC_ERR_CANCELLED;
    }
    return status;
}

/* Those that are like others have what became of them; counts what was read, and what is of no use. */
static void count_images(importer *im) {
    for (size_t i = 0; i < im->images.len; i++) {
        scene_image *image = &im->images.data[i];
        if (image->like) {
            const scene_image *first = &im->images.data[image->like - 1];
            image->texture = first->texture;
            image->reason = first->reason;
            im->report->images_reduced += first->leave_out > 0;
        }
        im->inputs[image->input].file.images += image->texture > 0;
        if (image->reason)
            geo_issue(im->inputs[image->input].issues, GEO_GUESSED, image->reason, image->path);
    }
}

/* Surfaces have the colours of their images; where one is of no use, those that the file gives them besides. */
static noc_status use_images(importer *im) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < im->image_uses.len && !status; i++) {
        const image_use *use = &im->image_uses.data[i];
        noc_material m = *noc_scene_material_at(im->scene, use->material);
        if (!(m.texture = im->images.data[use->image].texture))
            continue;
        memcpy(m.albedo, use->albedo, sizeof(m.albedo));
        status = noc_scene_set_material(im->scene, use->material, &m);
    }
    return status;
}

noc_status look_read_images(importer *im) {
    if (!im->images.len)
        return NOC_OK;
    noc_pool *pool = noc_pool_create(im->params->threads);
    image_job *jobs = noc_calloc(im->images.len, sizeof(*jobs));
    noc_status status = pool && jobs ? NOC_OK : noc_no_memory(im->log, "import");
    if (!status)
        status = read_sizes(im, pool, jobs);
    if (!status)
        status = find_alike(im);
    if (!status) {
        limit_pixels(im);
        fit(im);
    }
    if (!status)
        status = read_pixels(im, pool, jobs);
    if (!status)
        count_images(im);
    if (!status)
        status = use_images(im);
    free(jobs);
    if (pool)
        noc_pool_destroy(pool);
    return status;
}
