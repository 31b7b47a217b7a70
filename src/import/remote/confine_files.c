/* Landlock: which files the helper may open. Every right that the running kernel knows is taken away, and those that
 * reading needs are given back, file by file. What it has none for can be told of any path: whether it is there, how
 * large it is, whose it is. */
#include "import/remote/confine.h"
#include "import/scratch.h"
#include "noc_config.h"

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#if NOC_HAVE_LANDLOCK
#include <linux/landlock.h>

/* As the kernel numbers them: a system's headers may be older than its kernel. */
enum {
    EXECUTE = 1 << 0,
    WRITE_FILE = 1 << 1,
    READ_FILE = 1 << 2,
    READ_DIR = 1 << 3,
    REMOVE_DIR = 1 << 4,
    REMOVE_FILE = 1 << 5,
    MAKE_DIR = 1 << 7,
    MAKE_REG = 1 << 8,
    TRUNCATE = 1 << 14,
    FIRST_FS = (1 << 13) - 1, /* those of Linux 5.13 */
    OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE,
    READ_FOLDERS = READ_FILE | READ_DIR,
    WRITE = WRITE_FILE | REMOVE_FILE | REMOVE_DIR | MAKE_REG | MAKE_DIR | TRUNCATE
};

typedef struct landlock_rights {
    uint64_t fs, net, scoped;
} landlock_rights;

static int landlock_version(void) {
    return (int)syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
}

/* Of each version what it was the first to know. A version beyond the last has rights that may be needed for reading:
 * who adds it here finds out. */
static landlock_rights all_rights(int version) {
    static const landlock_rights news[] = {
        { .fs = FIRST_FS },            /* 1, Linux 5.13 */
        { .fs = 1 << 13 },             /* 2, 5.19: to move between folders */
        { .fs = TRUNCATE },            /* 3, 6.2 */
        { .net = 1 << 0 | 1 << 1 },    /* 4, 6.7: to bind and to connect TCP */
        { .fs = 1 << 15 },             /* 5, 6.10: ioctl of devices */
        { .scoped = 1 << 0 | 1 << 1 }, /* 6, 6.12: abstract sockets and signals beyond itself */
    };
    landlock_rights all = { 0 };
    for (int i = 0; i < version && i < (int)NOC_COUNT(news); i++) {
        all.fs |= news[i].fs;
        all.net |= news[i].net;
        all.scoped |= news[i].scoped;
    }
    return all;
}

typedef struct landlock_rules {
    int fd;
    uint64_t handled; /* of files */
} landlock_rules;

/* Returns the descriptor that it was looked up by; -1 where there is no such path. */
static int allow_open(const landlock_rules *rules, const char *path, uint64_t access) {
    int fd = open(path, O_PATH | O_CLOEXEC);
    struct landlock_path_beneath_attr attr = { .allowed_access = access & rules->handled, .parent_fd = fd };
    struct stat st;
    if (fd < 0 || fstat(fd, &st))
        return fd;
    if (!S_ISDIR(st.st_mode))
        attr.allowed_access &= OF_FILES;
    if (attr.allowed_access)
        syscall(SYS_landlock_add_rule, rules->fd, LANDLOCK_RULE_PATH_BENEATH, &attr, 0);
    return fd;
}

static void allow(const landlock_rules *rules, const char *path, uint64_t access) {
    int fd = allow_open(rules, path, access);
    if (fd >= 0)
        close(fd);
}

/* Where libraries, their data and their plugins are. */
static void allow_system(const landlock_rules *rules) {
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
                                          "/proc/cpuinfo",
                                          "/proc/meminfo",
                                          "/proc/sys/vm/overcommit_memory" };
    /* What it is itself, as the C library and sanitizers ask; not its environment, nor its memory. */
    static const char *const own[] = { "maps", "status", "stat", "statm", "auxv", "cgroup" };
    static const char *const variables[] = { "PROJ_DATA",        "PROJ_LIB",        "GDAL_DATA",
                                             "GDAL_DRIVER_PATH", "OGR_DRIVER_PATH", "LD_LIBRARY_PATH" };
    for (size_t i = 0; i < NOC_COUNT(places); i++)
        allow(rules, places[i], READ_FOLDERS);
    for (size_t i = 0; i < NOC_COUNT(own); i++) {
        char path[40];
        noc_snprintf(path, sizeof(path), "/proc/self/%s", own[i]);
        allow_open(rules, path, READ_FILE); /* kept open: such a file is another one when it is looked up anew */
    }
    for (size_t i = 0; i < NOC_COUNT(variables); i++) {
        const char *place = getenv(variables[i]);
        for (size_t n; place && *place; place += n + (place[n] != 0)) {
            n = strcspn(place, ":");
            char path[PATH_MAX];
            if (n && n < sizeof(path) && noc_snprintf(path, sizeof(path), "%.*s", (int)n, place) > 0)
                allow(rules, path, READ_FOLDERS);
        }
    }
}

/* GDAL and PROJ of one's own have their data beside themselves. */
static void allow_beside(const landlock_rules *rules, void *library, const char *function) {
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
static void allow_input(const landlock_rules *rules, const char *path, const confine_needs *needs) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strrchr(base, '.');
    char folder[PATH_MAX], part[PATH_MAX + NAME_MAX]; /* what does not fit cannot be opened */
    noc_snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(base - path) : 2, slash ? path : "./");
    size_t stem = dot ? (size_t)(dot - base) : strlen(base);
    DIR *dir = opendir(folder);
    struct dirent *entry;
    allow(rules, path, READ_FILE);
    allow(rules, folder, (needs->whole ? READ_FILE : 0) | (needs->lists ? READ_DIR : 0));
    while (dir && (entry = readdir(dir))) {
        noc_snprintf(part, sizeof(part), "%s%s", folder, entry->d_name);
        struct stat st;
        if (!strncasecmp(entry->d_name, base, stem) && !stat(part, &st) && S_ISREG(st.st_mode))
            allow(rules, part, READ_FILE);
    }
    if (dir)
        closedir(dir);
}

bool confine_has_landlock(void) { return landlock_version() >= 1; }

void confine_files(const char *path, const confine_needs *needs) {
    landlock_rights all = all_rights(landlock_version());
    landlock_rules rules = { -1, all.fs };
    if (all.fs)
        rules.fd = (int)syscall(SYS_landlock_create_ruleset, &all, sizeof(all), 0);
    if (rules.fd < 0)
        return;
    allow_system(&rules);
    allow_beside(&rules, dlopen(NOC_GDAL_LIBRARY, RTLD_LAZY | RTLD_NOLOAD), "GDALOpenEx");
    allow_beside(&rules, dlopen(NOC_PROJ_LIBRARY, RTLD_LAZY | RTLD_NOLOAD), "proj_create");
    if (needs->scratch)
        allow(&rules, scratch_place(), READ_FOLDERS | WRITE);
    if (needs->anywhere)
        allow(&rules, "/", READ_FOLDERS);
    else
        allow_input(&rules, path, needs);
    syscall(SYS_landlock_restrict_self, rules.fd, 0);
    close(rules.fd);
}

#else
bool confine_has_landlock(void) { return false; }
void confine_files(const char *path, const confine_needs *needs) {}
#endif
