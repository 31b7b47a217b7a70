/* Between the frame of a scene and coordinates as users have them. */
#include "import/load/load.h"

/* By its definition, which is a user's word, or that of a file where `file` is set. */
static geo_crs *make_crs(const noc_scene *scene, const char *definition, const char *place, bool file,
                         noc_status *status) {
    geo_crs *crs = file ? geo_crs_create_plain(definition, place, scene->log, status)
                        : geo_crs_create(definition, place, scene->log, status);
    if (*status && *status != NOC_ERR_MEMORY)
        *status = NOC_ERR_ARGUMENT;
    return crs;
}

/* A copy of one that the scene has, or of one that its file tells. */
static geo_crs *scene_crs(const noc_scene *scene, const geo_crs *known, const char *kept, noc_status *status) {
    if (!known)
        return make_crs(scene, kept ? kept : scene->crs_name, "scene", scene->pages, status);
    geo_crs *crs = geo_crs_clone(known);
    *status = crs ? NOC_OK : noc_no_memory(scene->log, "CRS");
    return crs;
}

char *noc_scene_crs_wkt(const noc_scene *scene, const char *crs) {
    noc_status status = NOC_OK;
    if (!scene || (!crs && !scene->crs && !scene->crs_name))
        return NULL;
    bool given = scene->given_crs || scene->given_crs_kept;
    geo_crs *of = crs     ? make_crs(scene, crs, NULL, false, &status)
                  : given ? scene_crs(scene, scene->given_crs, scene->given_crs_kept, &status)
                          : scene_crs(scene, scene->crs, scene->crs_kept, &status);
    char *wkt = of ? geo_crs_wkt(of) : NULL;
    geo_crs_destroy(of);
    return wkt;
}

/* Between the frame of the scene's CRS (crs NULL: the one that the user speaks) and the scene's, in place. A point that
 * has no place there becomes NaN, and of a lone one that is an error. */
static noc_status convert(const noc_scene *scene, const char *crs, bool to_local, double *xyz, size_t count,
                          bool lone) {
    if (!scene->crs && !scene->crs_name)
        return scene->without_crs
                   ? noc_error(scene->log, NOC_ERR_ARGUMENT,
                               "%s names no CRS, so coordinates in %s have no place in the scene: say with "
                               "--crs which one it is in",
                               scene->without_crs, crs)
                   : noc_error(scene->log, NOC_ERR_ARGUMENT,
                               "the scene has no CRS, so coordinates in %s have no place in it", crs);
    noc_status status;
    geo_crs *user = crs ? make_crs(scene, crs, NULL, false, &status)
                        : scene_crs(scene, scene->given_crs, scene->given_crs_kept, &status);
    geo_crs *own = user ? scene_crs(scene, scene->crs, scene->crs_kept, &status) : NULL;
    geo_transform *t =
        user && own ? geo_transform_create(to_local ? user : own, to_local ? own : user, scene->log, &status) : NULL;
    const double x = lone ? xyz[0] : 0, y = lone ? xyz[1] : 0;
    if (t && geo_transform_points(t, xyz, count) && lone)
        status = noc_error(scene->log, NOC_ERR_ARGUMENT, "%.10g %.10g in %s has no place in %s", x, y,
                           geo_crs_name(to_local ? user : own), to_local ? "the scene's CRS" : geo_crs_name(user));
    geo_transform_destroy(t);
    geo_crs_destroy(user);
    geo_crs_destroy(own);
    return status;
}

static bool has_given_crs(const noc_scene *scene) { return scene->given_crs || scene->given_crs_kept; }

noc_status noc_scene_to_local(const noc_scene *scene, const char *crs, double xyz[3]) {
    if (!scene || !xyz)
        return NOC_ERR_ARGUMENT;
    double p[3] = { xyz[0], xyz[1], xyz[2] };
    noc_status status = crs || has_given_crs(scene) ? convert(scene, crs, true, p, 1, true) : NOC_OK;
    for (int k = 0; !status && k < 3; k++)
        xyz[k] = p[k] - scene->origin[k];
    return status;
}

noc_status noc_scene_to_local_all(const noc_scene *scene, const char *crs, double *xyz, size_t count) {
    if (!scene || !xyz)
        return NOC_ERR_ARGUMENT;
    noc_status status = crs || has_given_crs(scene) ? convert(scene, crs, true, xyz, count, false) : NOC_OK;
    for (size_t i = 0; !status && i < 3 * count; i++)
        xyz[i] -= scene->origin[i % 3];
    return status;
}

static noc_status from_local(const noc_scene *scene, const char *crs, double *xyz, size_t count, bool lone) {
    for (size_t i = 0; i < 3 * count; i++)
        xyz[i] += scene->origin[i % 3];
    return crs || has_given_crs(scene) ? convert(scene, crs, false, xyz, count, lone) : NOC_OK;
}

noc_status noc_scene_from_local(const noc_scene *scene, const char *crs, double xyz[3]) {
    if (!scene || !xyz)
        return NOC_ERR_ARGUMENT;
    double p[3] = { xyz[0], xyz[1], xyz[2] };
    noc_status status = from_local(scene, crs, p, 1, true);
    if (!status)
        memcpy(xyz, p, sizeof(p));
    return status;
}

noc_status noc_scene_from_local_all(const noc_scene *scene, const char *crs, double *xyz, size_t count) {
    return scene && xyz ? from_local(scene, crs, xyz, count, false) : NOC_ERR_ARGUMENT;
}
