/* The backends of this build, their devices, and which device is meant. */
#include "noc_config.h"
#include "render/backend.h"

#include <dirent.h>
#include <nocturne/option.h>
#include <unistd.h>

static const char *const names[NOC_BACKEND_COUNT] = { "embree", "vulkan", "auto" };
static const char *const kinds[NOC_DEVICE_KIND_COUNT] = { "processor", "software",   "other",
                                                          "virtual",   "integrated", "discrete" };

const char *noc_backend_name(noc_backend_id id) { return (unsigned)id < NOC_BACKEND_COUNT ? names[id] : "unknown"; }

const char *noc_device_kind_name(noc_device_kind kind) {
    return (unsigned)kind < NOC_DEVICE_KIND_COUNT ? kinds[kind] : "unknown";
}

const noc_backend *noc_backend_of(noc_backend_id id) {
    switch (id) {
    case NOC_BACKEND_EMBREE: return &noc_backend_embree;
#if NOC_HAVE_VULKAN
    case NOC_BACKEND_VULKAN: return &noc_backend_vulkan;
#endif
    default: return NULL;
    }
}

enum { MOST_DEVICES = 16 }; /* of a backend */
typedef struct device_list {
    noc_device_info devices[MOST_DEVICES];
    size_t count;
} device_list;

static void list_devices(noc_backend_id id, device_list *list) {
    const noc_backend *backend = noc_backend_of(id);
    noc_device_info *first = &list->devices[0];
    memset(first, 0, sizeof(*first));
    list->count = 1;
    if (!backend) {
        noc_snprintf(first->why, sizeof(first->why), "this build is without it (Meson option %s)",
                     noc_backend_name(id));
    } else if (!backend->devices) {
        first->usable = true;
        noc_processor_name(first->name, sizeof(first->name));
    } else {
        size_t count = backend->devices(list->devices, MOST_DEVICES);
        list->count = NOC_MIN(count, MOST_DEVICES);
    }
    for (size_t i = 0; i < list->count; i++) {
        list->devices[i].backend = id;
        list->devices[i].number = list->devices[i].name[0] ? (int)i : -1;
    }
}

size_t noc_devices(noc_device_info *devices, size_t capacity) {
    size_t count = 0;
    for (int id = 0; id < NOC_BACKEND_AUTO; id++) {
        device_list list;
        list_devices((noc_backend_id)id, &list);
        for (size_t i = 0; i < list.count; i++, count++)
            if (devices && count < capacity)
                devices[count] = list.devices[i];
    }
    return count;
}

/* Of usable devices the one of the greatest kind; NULL: none is usable. */
static const noc_device_info *best(const noc_device_info *list, size_t count) {
    const noc_device_info *found = NULL;
    for (size_t i = 0; i < count; i++)
        if (list[i].usable && (!found || list[i].kind > found->kind))
            found = &list[i];
    return found;
}

const noc_device_info *noc_best_gpu(const noc_device_info *list, size_t count) {
    const noc_device_info *found = best(list, count);
    return found && found->kind > NOC_DEVICE_SOFTWARE ? found : NULL;
}

/* Numbers are of a model, before what drivers say of themselves: not 256 of "llvmpipe (LLVM 15.0.6, 256 bits)". */
static bool in_name(const char *name, const char *part) {
    const char *at = strcasestr(name, part), *said = strstr(name, " (");
    return at && !(said && at > said && !part[strspn(part, "0123456789")]);
}

/* Returns the device of this number, of this name, or with this part in its name, usable ones before others. NULL:
 * none. *several: more than one that is usable. Greater numbers than devices can have are parts of names: 3060. */
static const noc_device_info *named(const noc_device_info *list, size_t count, const char *wanted, bool *several) {
    const noc_device_info *found = NULL;
    long long number = -1;
    bool numbered = *wanted >= '0' && *wanted <= '9' && noc_parse_int(wanted, &number) && number < MOST_DEVICES;
    *several = false;
    for (int part = 0; part < 2 && !found; part++)
        for (size_t i = 0; i < count; i++) {
            const char *name = list[i].name;
            if (numbered ? list[i].number != number : part ? !in_name(name, wanted) : strcasecmp(name, wanted))
                continue;
            *several |= found && found->usable && list[i].usable;
            if (!found || (list[i].usable && !found->usable))
                found = &list[i];
        }
    return found;
}

/* "0 llvmpipe, 1 NVIDIA L4 (no ray tracing)" */
static void list_names(const noc_device_info *list, size_t count, char *text, size_t size) {
    size_t at = 0;
    *text = 0;
    for (size_t i = 0; i < count && at < size; i++)
        at += (size_t)noc_snprintf(text + at, size - at, "%s%d %s%s%s%s", i ? ", " : "", list[i].number, list[i].name,
                                   list[i].usable ? "" : " (", list[i].why, list[i].usable ? "" : ")");
}

noc_status noc_choose_device(const noc_device_info *list, size_t count, const char *wanted, noc_device_info *info,
                             noc_log *log) {
    const char *backend = noc_backend_name(list->backend);
    char text[600];
    if (list->number < 0)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: %s", backend, list->why);
    bool several = false;
    if (wanted && !wanted[strspn(wanted, " ")])
        return noc_error(log, NOC_ERR_ARGUMENT, "device: is empty; pass a number or a part of a name");
    const noc_device_info *found = wanted ? named(list, count, wanted, &several) : best(list, count);
    list_names(list, count, text, sizeof(text));
    if (several)
        return noc_error(log, NOC_ERR_ARGUMENT, "device: \"%.60s\" is in several names, pass a number: %s", wanted,
                         text);
    if (!found && wanted)
        return noc_error(log, NOC_ERR_ARGUMENT, "device: \"%.60s\" is neither number nor part of a name; devices: %s",
                         wanted, text);
    if (!found)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: no usable device: %s", backend, text);
    if (!found->usable)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: %s is not usable: %s", backend, found->name, found->why);
    *info = *found;
    return NOC_OK;
}

/* Returns true if the system has the device file of a GPU. Where it has none, auto loads no Vulkan driver: those that
 * run on the processor take 20 ms and 100 MB of addresses. */
static bool has_gpu_file(void) {
    bool found = !access("/dev/nvidiactl", F_OK) || !access("/dev/dxg", F_OK);
    DIR *dri = found ? NULL : opendir("/dev/dri");
    for (const struct dirent *entry; dri && !found && (entry = readdir(dri));)
        found = !strncmp(entry->d_name, "renderD", 7);
    if (dri)
        closedir(dri);
    return found;
}

noc_status noc_device_find(const noc_device_params *params, noc_device_info *info, noc_log *log) {
    noc_device_params defaults = noc_device_default_params();
    params = params ? params : &defaults;
    if (!info)
        return noc_null(log, __func__);
    noc_status status = noc_option_check(noc_device_options(), params, "device", log);
    if (status)
        return status;
    if (params->device && params->backend == NOC_BACKEND_EMBREE)
        return noc_error(log, NOC_ERR_ARGUMENT, "device: \"%.60s\" is for vulkan; embree has the processor alone",
                         params->device);
    bool automatic = params->backend == NOC_BACKEND_AUTO && !params->device;
    noc_backend_id backend = params->backend == NOC_BACKEND_EMBREE || (automatic && !has_gpu_file())
                                 ? NOC_BACKEND_EMBREE
                                 : NOC_BACKEND_VULKAN;
    device_list list;
    list_devices(backend, &list);
    if (automatic && !noc_best_gpu(list.devices, list.count))
        list_devices(NOC_BACKEND_EMBREE, &list);
    return noc_choose_device(list.devices, list.count, params->device, info, log);
}
