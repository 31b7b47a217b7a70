/* crs_proj: the functions of PROJ that are called. Its library, and the forty that it needs, are loaded when a CRS is
 * read. */
#ifndef NOC_GEO_CRS_PROJ_H
#define NOC_GEO_CRS_PROJ_H

#include "base/library.h"

#include <proj.h>

/* clang-format off */
#define PROJ_FUNCTIONS(X)                                                                                              \
    X(proj_as_wkt) X(proj_clone) X(proj_context_create) X(proj_context_destroy) X(proj_context_get_database_metadata)  \
    X(proj_context_set_enable_network) X(proj_context_set_fileapi) X(proj_coord)                                       \
    X(proj_coordoperation_has_ballpark_transformation) X(proj_create) X(proj_create_crs_to_crs_from_pj)                \
    X(proj_create_from_database) X(proj_crs_get_coordinate_system) X(proj_crs_get_geodetic_crs)                        \
    X(proj_crs_get_sub_crs) X(proj_cs_get_axis_info) X(proj_destroy) X(proj_ellipsoid_get_parameters)                  \
    X(proj_errno_reset) X(proj_get_area_of_use) X(proj_get_ellipsoid) X(proj_get_id_auth_name) X(proj_get_id_code)     \
    X(proj_get_name) X(proj_get_prime_meridian) X(proj_get_source_crs) X(proj_get_type)                                \
    X(proj_is_equivalent_to_with_ctx) X(proj_log_func) X(proj_prime_meridian_get_parameters) X(proj_trans)             \
    X(proj_trans_generic) X(proj_trans_get_last_used_operation)
/* clang-format on */

typedef struct proj_functions {
    PROJ_FUNCTIONS(LIBRARY_POINTER)
} proj_functions;

extern proj_functions proj;

/* Loads the library, once a process. NULL, or "PROJ cannot be loaded: ..."; `proj` must not be called then. */
const char *proj_load(void);

#endif
