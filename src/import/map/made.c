/* Files that GDAL makes in memory, from where they are written as all outputs are. */
#include "import/map/made.h"

#if NOC_HAVE_GDAL

#include "base/output.h"

#include <stdatomic.h>

/* What GDAL says of a failure. */
typedef struct complaint {
    char text[200];
} complaint;

static void CPL_STDCALL on_error(CPLErr level, CPLErrorNum code, const char *text) {
    complaint *c = gdal.CPLGetErrorHandlerUserData();
    if (level >= CE_Failure && !*c->text)
        noc_snprintf(c->text, sizeof(c->text), "%s", text);
    (void)code;
}

static noc_status write_out(const char *name, const char *path, noc_log *log) {
    vsi_l_offset size = 0;
    const GByte *bytes = gdal.VSIGetMemFileBuffer(name, &size, FALSE);
    output o;
    noc_status status = bytes ? output_open(&o, path, log) : noc_no_memory(log, path);
    if (status)
        return status;
    bool written = fwrite(bytes, 1, size, o.file) == size;
    return output_close(&o, written ? NOC_OK : output_failed(&o, log), log);
}

noc_status map_write_made(const map_made *m, const void *of, const char *path, noc_log *log) {
    static atomic_uint number;
    char name[64];
    complaint said = { "" };
    noc_snprintf(name, sizeof(name), "/vsimem/nocturne/made%u%s", atomic_fetch_add(&number, 1), m->ending);
    gdal.OGRRegisterAll();
    gdal.CPLPushErrorHandlerEx(on_error, &said);
    gdal.CPLSetThreadLocalConfigOption(m->option, m->value);
    noc_status status = m->make(of, name) ? write_out(name, path, log)
                                          : noc_error(log, NOC_ERR_IO, "%s: GDAL cannot make a %s of it: %s", path,
                                                      m->format, *said.text ? said.text : "it does not say why");
    gdal.VSIUnlink(name);
    gdal.CPLSetThreadLocalConfigOption(m->option, NULL);
    gdal.CPLPopErrorHandler();
    gdal.CPLErrorReset();
    return status;
}

#endif
