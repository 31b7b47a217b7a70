/* What the helper may do. Limits of the process hold everywhere; Landlock (files, Linux 5.13) and seccomp (system
 * calls) where the system and the build have them: they are a second fence behind the rules that the readers keep. */
#include "import/remote/remote.h"
#include "import/scratch.h"
#include "noc_config.h"

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#if NOC_HAVE_LANDLOCK
#include <linux/landlock.h>
#endif
#if NOC_HAVE_SECCOMP
#include <errno.h>
#include <linux/seccomp.h>
#include <seccomp.h>
#endif

/* grace: how far above it the hard limit lies. */
static void limit(int what, rlim_t most, rlim_t grace) {
    struct rlimit now;
    if (getrlimit((__rlimit_resource_t)what, &now))
        return;
    now.rlim_cur = NOC_MIN(most, now.rlim_max);
    now.rlim_max = NOC_MIN(most + grace, now.rlim_max);
    setrlimit((__rlimit_resource_t)what, &now);
}

#ifndef REMOTE_SANITIZED
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
#endif

#if NOC_HAVE_LANDLOCK

#define READ_FILES (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_EXECUTE)
#define READ_FOLDERS (READ_FILES | LANDLOCK_ACCESS_FS_READ_DIR)
#define WRITE                                                                                                          \
    (LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |                  \
     LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_DIR)

static void allow(int rules, const char *path, uint64_t access) {
    struct landlock_path_beneath_attr attr = { .allowed_access = access, .parent_fd = open(path, O_PATH | O_CLOEXEC) };
    struct stat st;
    if (attr.parent_fd < 0 || fstat(attr.parent_fd, &st))
        return;
    if (!S_ISDIR(st.st_mode))
        attr.allowed_access &=
            LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE;
    syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &attr, 0);
    close(attr.parent_fd);
}

/* Where libraries, their data and their plugins are. */
static void allow_system(int rules) {
    static const char *const places[] = { "/usr",
                                          "/lib",
                                          "/lib64",
                                          "/opt",
                                          "/nix/store",
                                          "/gnu/store",
                                          "/etc/ld.so.cache",
                                          "/etc/localtime",
                                          "/sys/devices/system/cpu",
                                          "/dev/null",
                                          "/dev/urandom",
                                          "/proc/self",
                                          "/proc/cpuinfo",
                                          "/proc/meminfo" };
    static const char *const variables[] = { "PROJ_DATA",        "PROJ_LIB",        "GDAL_DATA",
                                             "GDAL_DRIVER_PATH", "OGR_DRIVER_PATH", "LD_LIBRARY_PATH" };
    for (size_t i = 0; i < NOC_COUNT(places); i++)
        allow(rules, places[i], READ_FOLDERS);
    for (size_t i = 0; i < NOC_COUNT(variables); i++) {
        const char *place = getenv(variables[i]);
        for (size_t n; place && *place; place += n + (place[n] != 0)) {
            n = strcspn(place, ":");
            char path[PATH_MAX];
            if (n && n < sizeof(path) && noc_snprintf(path, sizeof(path), "%.*s", (int)n, place) > 0)
                allow(rules, path, READ_FOLDERS);
        }
    }
    allow(rules, scratch_place(), READ_FOLDERS | WRITE);
}

/* GDAL and PROJ of one's own have their data beside themselves. */
static void allow_beside(int rules, void *library, const char *function) {
    Dl_info info;
    void *at = dlsym(library, function);
    char *path = at && dladdr(at, &info) ? realpath(info.dli_fname, NULL) : NULL,
         *slash = path ? strrchr(path, '/') : NULL;
    if (slash) {
        char share[PATH_MAX + 10];
        noc_snprintf(share, sizeof(share), "%.*s/../share", (int)(slash - path), path);
        *slash = 0;
        allow(rules, path, READ_FOLDERS);
        allow(rules, share, READ_FOLDERS);
    }
    free(path);
}

/* The file itself and, of a map, its parts: those beside it whose names begin like its own; of a mesh the folder. */
static void allow_input(int rules, const char *path, bool whole) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strrchr(base, '.');
    char folder[PATH_MAX], part[PATH_MAX + NAME_MAX]; /* what does not fit cannot be opened */
    noc_snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(base - path) : 2, slash ? path : "./");
    size_t stem = dot ? (size_t)(dot - base) : strlen(base);
    DIR *dir = opendir(folder);
    struct dirent *entry;
    allow(rules, path, READ_FILES);
    allow(rules, folder, whole ? READ_FOLDERS : LANDLOCK_ACCESS_FS_READ_DIR);
    while (dir && (entry = readdir(dir))) {
        noc_snprintf(part, sizeof(part), "%s%s", folder, entry->d_name);
        struct stat st;
        if (!strncasecmp(entry->d_name, base, stem) && !stat(part, &st) && S_ISREG(st.st_mode))
            allow(rules, part, READ_FILES);
    }
    if (dir)
        closedir(dir);
}

static void confine_files(const char *path, bool whole, bool anywhere) {
    struct landlock_ruleset_attr attr = { .handled_access_fs = READ_FOLDERS | WRITE };
    int rules = (int)syscall(SYS_landlock_create_ruleset, &attr, sizeof(attr), 0);
    if (rules < 0)
        return;
    allow_system(rules);
    allow_beside(rules, dlopen(NOC_GDAL_LIBRARY, RTLD_LAZY | RTLD_NOLOAD), "GDALOpenEx");
    allow_beside(rules, RTLD_DEFAULT, "proj_create");
    if (anywhere)
        allow(rules, "/", READ_FOLDERS);
    else
        allow_input(rules, path, whole);
    syscall(SYS_landlock_restrict_self, rules, 0);
    close(rules);
}

#else
static void confine_files(const char *path, bool whole, bool anywhere) {}
#endif

#if NOC_HAVE_SECCOMP
static void confine_calls(void) {
    static const int calls[] = { SCMP_SYS(socket),
                                 SCMP_SYS(connect),
                                 SCMP_SYS(bind),
                                 SCMP_SYS(listen),
                                 SCMP_SYS(execve),
                                 SCMP_SYS(execveat),
                                 SCMP_SYS(ptrace),
                                 SCMP_SYS(process_vm_readv),
                                 SCMP_SYS(process_vm_writev),
                                 SCMP_SYS(io_uring_setup),
                                 SCMP_SYS(mount),
                                 SCMP_SYS(unshare),
                                 SCMP_SYS(setns),
                                 SCMP_SYS(bpf),
                                 SCMP_SYS(keyctl),
                                 SCMP_SYS(userfaultfd) };
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    for (size_t i = 0; filter && i < NOC_COUNT(calls); i++)
        seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), calls[i], 0);
    if (filter)
        seccomp_load(filter);
    seccomp_release(filter);
}
#else
static void confine_calls(void) {}
#endif

static bool has_landlock(void) {
#if NOC_HAVE_LANDLOCK
    return syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 1;
#else
    return false;
#endif
}

/* A filter of 0 is refused in any case; EFAULT says that there are filters. */
static bool has_seccomp(void) {
#if NOC_HAVE_SECCOMP
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, NULL, 0, 0) == -1 && errno == EFAULT;
#else
    return false;
#endif
}

const char *noc_isolation(void) {
    static const char *const texts[2][2] = {
        { "a process of its own and limits; neither Landlock for files nor seccomp for system calls is there",
          "a process of its own and limits, system calls by seccomp; Landlock for files is not there" },
        { "a process of its own and limits, files by Landlock; seccomp for system calls is not there",
          "a process of its own and limits, files by Landlock, system calls by seccomp" },
    };
    return texts[has_landlock()][has_seccomp()];
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

void remote_confine(const char *path, bool whole, const noc_import_params *params) {
    unsetenv("SPATIALITE_SECURITY"); /* "relaxed" lets SQL touch files */
    limit(RLIMIT_CORE, 0, 0);
    /* Where who started it no longer looks at the clock, of all threads together: only meshes are read by some. SIGXCPU
     * comes at the limit and tells why the process ended; SIGKILL comes after the grace. */
    double threads = whole ? NOC_MAX(params->threads, 1) : 1;
    limit(RLIMIT_CPU, (rlim_t)(NOC_MIN(params->reader_time, 1e9) * threads) + 2, 2);
#ifndef REMOTE_SANITIZED /* whose shadow takes terabytes of addresses */
    limit(RLIMIT_AS, (rlim_t)(own_addresses() + import_budget_of(params).memory), 0);
#endif
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    confine_files(path, whole, params->allow_outside);
    confine_calls();
}
