/* nocturne devices: what can render here. And --backend and --device of other commands before the long work. */
#include "cli.h"

static int run(void *arguments);

static const cli_args defaults = { 0 };

const cli_command cli_devices = {
    "devices",
    "",
    "Lists what can render: the processor, and Vulkan devices.",
    "A line a device: the backend, the number that --device takes, kind, name and\n"
    "driver, and what keeps it from being used. Vulkan drivers are loaded for it.\n"
    "Example\n"
    "  nocturne devices\n",
    { { cli_common_options, 0, NULL } },
    sizeof(cli_args),
    &defaults,
    run,
};

static int run(void *arguments) {
    const cli_args *args = arguments;
    if (args->input_count)
        return cli_usage(&cli_devices, "devices takes no files");
    noc_device_info devices[32];
    size_t count = noc_devices(devices, 32);
    char text[256];
    for (size_t i = 0; i < count && i < 32; i++) {
        const noc_device_info *d = &devices[i];
        const char *backend = noc_backend_name(d->backend);
        if (d->number < 0) {
            printf("%-6s none: %s\n", backend, noc_text_clean(text, sizeof(text), d->why));
            continue;
        }
        printf("%-6s %d %s, %s", backend, d->number, noc_device_kind_name(d->kind),
               noc_text_clean(text, sizeof(text), d->name));
        if (*d->driver)
            printf(", %s", noc_text_clean(text, sizeof(text), d->driver));
        if (!d->usable)
            printf(": not usable: %s", noc_text_clean(text, sizeof(text), d->why));
        putchar('\n');
    }
    return cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
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
