/* What the helper may do. Limits of the process hold everywhere; Landlock (files, Linux 5.13) and seccomp (system
 * calls) where the system and the build have them: they are a second fence behind the rules that the readers keep. */
#include "import/remote/confine.h"

#include <linux/capability.h>
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* grace: how far above it the hard limit lies. */
static void limit(int what, rlim_t most, rlim_t grace) {
    struct rlimit now;
    if (getrlimit((__rlimit_resource_t)what, &now))
        return;
    now.rlim_cur = NOC_MIN(most, now.rlim_max);
    now.rlim_max = NOC_MIN(most + grace, now.rlim_max);
    setrlimit((__rlimit_resource_t)what, &now);
}

#ifndef REMOTE_SANITIZED /* whose shadow takes terabytes of addresses, and whose reports may go to a file */
/* Bytes of addresses that this program takes whatever it reads: its libraries, which are there, and what they set up.
 */
static double own_addresses(void) {
    enum { SET_UP = 256 << 20 };
    double pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (f && fscanf(f, "%lf", &pages) != 1)
        pages = 0;
    if (f)
        fclose(f);
    return SET_UP + pages * (double)sysconf(_SC_PAGESIZE);
}

/* Of addresses, and of what is written: a copy of the input has its holes, too. */
static void limit_bytes(const char *path, double memory, bool scratch) {
    struct stat st;
    double copy = scratch ? memory + (stat(path, &st) ? 0 : (double)st.st_size) : 0;
    limit(RLIMIT_AS, (rlim_t)(own_addresses() + memory), 0);
    limit(RLIMIT_FSIZE, (rlim_t)copy, 0);
}
#else
static void limit_bytes(const char *path, double memory, bool scratch) {}
#endif

const char *noc_isolation(void) {
    static const char *const texts[2][2] = {
        { "a process of its own and limits; neither Landlock for files nor seccomp for system calls is there",
          "a process of its own and limits, system calls by seccomp; Landlock for files is not there" },
        { "a process of its own and limits, files by Landlock; seccomp for system calls is not there",
          "a process of its own and limits, files by Landlock, system calls by seccomp" },
    };
    return texts[confine_has_landlock()][confine_has_seccomp()];
}

const char *remote_short_of_fences(void) {
    static const char *const texts[2] = {
        "neither Landlock nor seccomp is here: a map or an OBJ that takes over the process that reads it may do what "
        "you may",
        "Landlock is not here (Linux has it since 5.13): a map or an OBJ that takes over the process that reads it may "
        "read files of yours, one in GeoPackage, OpenStreetMap or an archive may write some, too",
    };
    return confine_has_landlock() ? NULL : texts[confine_has_seccomp()];
}

bool remote_short_of_memory(void) {
    struct rlimit most;
    double peak = 0;
    char line[256];
    FILE *f = fopen("/proc/self/status", "r");
    while (f && fgets(line, sizeof(line), f))
        if (sscanf(line, "VmPeak: %lf kB", &peak) == 1)
            break;
    if (f)
        fclose(f);
    return !getrlimit(RLIMIT_AS, &most) && most.rlim_cur != RLIM_INFINITY && 2 * 1024 * peak > (double)most.rlim_cur;
}

/* Root has no rights but that of reading what belongs to others. */
static void drop_rights(void) {
    struct __user_cap_header_struct head = { .version = _LINUX_CAPABILITY_VERSION_3 };
    struct __user_cap_data_struct has[_LINUX_CAPABILITY_U32S_3] = { 0 };
    if (syscall(SYS_capget, &head, has))
        return;
    for (int i = 0; i < _LINUX_CAPABILITY_U32S_3; i++) {
        has[i].permitted &= i ? 0 : 1u << CAP_DAC_READ_SEARCH;
        has[i].effective &= has[i].permitted;
        has[i].inheritable = 0;
    }
    syscall(SYS_capset, &head, has);
}

/* What a file that begins so needs. GDAL writes a large OpenStreetMap file, which may lie in an archive, into one of
 * its own before it reads it; a GeoPackage with a log is copied, and SQLite sorts in files; a Shapefile is several
 * files, whose endings are in any case. */
static confine_needs needs_of(const char *path, bool whole, bool anywhere) {
    static const char *const written[] = { "SQLite format 3", "PK\3\4", "\x1f\x8b", "<", "\xef\xbb\xbf<" };
    confine_needs needs = { .whole = whole, .anywhere = anywhere };
    char head[64] = "";
    FILE *f = whole ? NULL : fopen(path, "rb");
    size_t n = f ? fread(head, 1, sizeof(head), f) : 0;
    if (f)
        fclose(f);
    for (size_t i = 0; i < NOC_COUNT(written); i++)
        needs.scratch |= n >= strlen(written[i]) && !memcmp(head, written[i], strlen(written[i]));
    needs.scratch |= memmem(head, n, "OSMHeader", 9) != NULL;
    needs.lists = n >= 4 && !memcmp(head, "\0\0\x27\x0a", 4);
    return needs;
}

void remote_confine(const char *path, bool whole, const noc_import_params *params) {
    confine_needs needs = needs_of(path, whole, params->allow_outside);
    limit(RLIMIT_CORE, 0, 0);
    /* Where who started it no longer looks at the clock, of all threads together: only meshes are read by some. SIGXCPU
     * comes at the limit and tells why the process ended; SIGKILL comes after the grace. */
    double threads = whole ? NOC_MAX(params->threads, 1) : 1;
    limit(RLIMIT_CPU, (rlim_t)(NOC_MIN(params->reader_time, 1e9) * threads) + 2, 2);
    signal(SIGXFSZ, SIG_IGN); /* writing more fails, as on a disk that is full */
    limit_bytes(path, import_budget_of(params).memory, needs.scratch);
    if (!whole)
        limit(RLIMIT_NPROC, 0, 0); /* of all that this user runs: it can take no more, and that holds root up nowhere */
    drop_rights();
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    confine_files(path, &needs);
    confine_calls(&needs);
}
