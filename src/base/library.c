#include "base/library.h"
#include "base/base.h"

#include <dlfcn.h>

void library_load(const char *library, const char *const *names, size_t count, void *table, char why[LIBRARY_WHY]) {
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL), *found = handle;
    for (size_t i = 0; found && i < count; i++) {
        found = dlsym(handle, names[i]);
        memcpy((char *)table + i * sizeof(found), &found, sizeof(found));
    }
    *why = 0;
    if (!found) {
        const char *told = dlerror();
        noc_snprintf(why, LIBRARY_WHY, "%s", told ? told : "a function has no address");
    }
}
