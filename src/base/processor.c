/* The processor's name, and how much of it is ours. */
#include "base/base.h"

#include <sched.h>
#include <stdio.h>
#include <unistd.h>

void noc_processor_name(char *text, size_t size) {
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    noc_snprintf(text, size, "unknown processor");
    while (file && fgets(line, sizeof(line), file)) {
        const char *colon = strchr(line, ':');
        if (!colon || strncmp(line, "model name", 10))
            continue;
        line[strcspn(line, "\n")] = 0;
        noc_snprintf(text, size, "%s", colon + 1 + strspn(colon + 1, " "));
        break;
    }
    if (file)
        fclose(file);
}

int noc_processors(void) {
    cpu_set_t sets[16]; /* of 1,024 each: the kernel refuses a set that is too small */
    int count = sched_getaffinity(0, sizeof(sets), sets) ? 0 : CPU_COUNT_S(sizeof(sets), sets);
    return count > 0 ? count : (int)NOC_MAX(sysconf(_SC_NPROCESSORS_ONLN), 1);
}
