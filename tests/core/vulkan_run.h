/* The least of Vulkan that runs one compute shader over one buffer, for tests. */
#ifndef TESTS_VULKAN_RUN_H
#define TESTS_VULKAN_RUN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct vulkan_run {
    char device[256]; /* its name */
    bool software;    /* runs on the CPU: flushes nothing */
    bool validated;   /* the validation layer is there and on */
    int messages;     /* warnings and errors it has printed so far */
    char why[256];    /* what went wrong, when something did */
    struct vulkan_state *state;
} vulkan_run;

/* Opens the device of this number. False, with run->why set, where there is none such; run needs no closing then. */
bool vulkan_open(vulkan_run *run, uint32_t device);
/* Runs main() of a shader in groups x 1 x 1 work groups; binding 0 is a storage buffer whose contents (out_bytes) are
 * those of out, before and afterwards, push its push constants. False with run->why set on failure. */
bool vulkan_compute(vulkan_run *run, const uint32_t *spirv, size_t spirv_bytes, const void *push, uint32_t push_bytes,
                    uint32_t groups, void *out, size_t out_bytes);
void vulkan_close(vulkan_run *run);

#endif
