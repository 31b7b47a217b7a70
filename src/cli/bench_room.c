/* Memory that is left. */
#include "bench.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* The number behind a key of a file of lines such as "MemAvailable:  123 kB"; with "" of the file itself. NAN: there is
 * none, as where a limit is "max". */
static double number_of(const char *path, const char *key) {
    char line[256];
    double value = NAN;
    FILE *f = fopen(path, "r");
    while (f && isnan(value) && fgets(line, sizeof(line), f))
        if (!strncmp(line, key, strlen(key)) && sscanf(line + strlen(key), "%lf", &value) != 1)
            value = NAN;
    if (f)
        fclose(f);
    return value;
}

double bench_room(const noc_import_params *import) {
    struct rlimit space;
    double kb = 1024, used = (double)cli_peak_memory();
    double room = kb * number_of("/proc/meminfo", "MemAvailable:");
    if (isnan(room))
        room = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) - used;
    double limits[] = { number_of("/sys/fs/cgroup/memory.max", "") - number_of("/sys/fs/cgroup/memory.current", ""),
                        number_of("/sys/fs/cgroup/memory/memory.limit_in_bytes", "") -
                            number_of("/sys/fs/cgroup/memory/memory.usage_in_bytes", ""),
                        import->max_memory > 0 ? 1e9 * import->max_memory - used : NAN, NAN };
    if (!getrlimit(RLIMIT_AS, &space) && space.rlim_cur != RLIM_INFINITY)
        limits[3] = (double)space.rlim_cur - kb * number_of("/proc/self/status", "VmSize:");
    for (size_t i = 0; i < sizeof(limits) / sizeof(*limits); i++)
        room = limits[i] < room ? limits[i] : room; /* false for NAN */
    return room > 0 ? room : 0;
}
