/* What --version prints of devices, and --backend and --device before the long work. */
#include "cli.h"

/* A line a device: the backend, the number that --device takes, kind, name and driver, and why it is not usable. */
void cli_print_devices(void) {
    noc_device_info devices[32];
    size_t count = noc_devices(devices, 32);
    char text[256];
    puts("devices:");
    for (size_t i = 0; i < count && i < 32; i++) {
        const noc_device_info *d = &devices[i];
        const char *backend = noc_backend_name(d->backend);
        if (d->number < 0) {
            printf("  %-6s none: %s\n", backend, noc_text_clean(text, sizeof(text), d->why));
            continue;
        }
        printf("  %-6s %d %s, %s", backend, d->number, noc_device_kind_name(d->kind),
               noc_text_clean(text, sizeof(text), d->name));
        if (*d->driver)
            printf(", %s", noc_text_clean(text, sizeof(text), d->driver));
        if (!d->usable)
            printf(": not usable: %s", noc_text_clean(text, sizeof(text), d->why));
        putchar('\n');
    }
}

int cli_check_device(const cli_command *command, const noc_device_params *device) {
    noc_device_info info;
    if (device->backend != NOC_BACKEND_VULKAN && !device->device)
        return CLI_OK; /* the processor is there, and what auto finds is usable */
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = cli_log_message });
    if (!log)
        cli_no_memory();
    noc_status status = noc_device_find(device, &info, log);
    noc_log_destroy(log);
    return status == NOC_ERR_ARGUMENT ? cli_read_on(command) : status ? CLI_FAILURE : CLI_OK;
}
