/* In place of the viewer, where the build has no libwebsockets. */
#include "viewer/viewer.h"

noc_status viewer_run(const viewer_source *source, const viewer_params *params, noc_log *log) {
    (void)source, (void)params, (void)log;
    return NOC_ERR_UNSUPPORTED;
}

const char *viewer_features(void) { return "no libwebsockets (nocturne view is not there)"; }
