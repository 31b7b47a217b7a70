/* seccomp: which system calls the helper may make: those that reading files and computing takes. Any other fails with
 * ENOSYS, as on a kernel that is older than it: libraries know how to do without, and a new C library that tries a new
 * call first goes on by the old one. Names, not numbers: not every machine has each, nor does every libseccomp. */
#include "import/remote/confine.h"
#include "noc_config.h"

#if NOC_HAVE_SECCOMP
#include <errno.h>
#include <fcntl.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#ifndef PR_SET_VMA
#define PR_SET_VMA 0x53564d41
#endif
#ifndef CLONE_NEWCGROUP
#define CLONE_NEWCGROUP 0x02000000
#endif
#ifndef F_OFD_GETLK
#define F_OFD_GETLK 36
#define F_OFD_SETLK 37
#define F_OFD_SETLKW 38
#endif
#if defined(__s390__)
#define CLONE_FLAGS 1 /* which argument they are */
#else
#define CLONE_FLAGS 0
#endif

/* Whatever their arguments are: they open nothing, and reach no other process. */
static const char *const harmless[] = {
    /* files that are open, or are looked for */
    "read", "readv", "pread64", "preadv", "preadv2", "write", "writev", "lseek", "_llseek", "close", "close_range",
    "dup", "dup2", "dup3", "fstat", "fstat64", "stat", "stat64", "lstat", "lstat64", "newfstatat", "fstatat64", "statx",
    "statfs", "statfs64", "fstatfs", "fstatfs64", "access", "faccessat", "faccessat2", "readlink", "readlinkat",
    "getdents", "getdents64", "getcwd", "fadvise64", "fadvise64_64", "arm_fadvise64_64", "readahead", "poll", "ppoll",
    "ppoll_time64", "select", "_newselect", "pselect6", "pselect6_time64",
    /* memory */
    "mmap", "mmap2", "munmap", "mremap", "mprotect", "madvise", "brk", "mincore", "membarrier",
    /* threads that are there */
    "futex", "futex_time64", "futex_waitv", "futex_wake", "futex_wait", "futex_requeue", "set_robust_list", "rseq",
    "set_tid_address", "sched_yield", "sched_getaffinity", "sched_getparam", "sched_getscheduler",
    "sched_get_priority_max", "sched_get_priority_min", "getcpu", "arch_prctl", "set_thread_area", "set_tls",
    "cacheflush", "riscv_flush_icache", "exit", "exit_group",
    /* signals that come */
    "rt_sigaction", "rt_sigprocmask", "rt_sigreturn", "rt_sigpending", "sigaction", "sigprocmask", "sigreturn",
    "sigaltstack", "restart_syscall",
    /* what the time is, and who and where this is */
    "clock_gettime", "clock_gettime64", "clock_getres", "clock_getres_time64", "clock_nanosleep",
    "clock_nanosleep_time64", "nanosleep", "gettimeofday", "time", "times", "getrusage", "sysinfo", "uname", "getpid",
    "gettid", "getppid", "getuid", "getuid32", "geteuid", "geteuid32", "getgid", "getgid32", "getegid", "getegid32",
    "getresuid", "getresuid32", "getresgid", "getresgid32", "getrlimit", "ugetrlimit", "getrandom"
};
/* What is written to the temporary folder, where it is. */
static const char *const writing[] = { "pwrite64",  "pwritev", "pwritev2",  "ftruncate", "ftruncate64",
                                       "fallocate", "fsync",   "fdatasync", "flock",     "unlink",
                                       "unlinkat",  "mkdir",   "mkdirat",   "rmdir" };

static void allow(scmp_filter_ctx filter, const char *name, unsigned count, const struct scmp_arg_cmp *arguments) {
    int call = seccomp_syscall_resolve_name(name);
    if (call != __NR_SCMP_ERROR) /* one that this machine has not is no rule */
        seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, count, arguments);
}

static void allow_if(scmp_filter_ctx filter, const char *name, struct scmp_arg_cmp argument) {
    allow(filter, name, 1, &argument);
}

static void allow_all(scmp_filter_ctx filter, const char *const *names, size_t count) {
    for (size_t i = 0; i < count; i++)
        allow(filter, names[i], 0, NULL);
}

/* Of an argument the bits of mask, which are those that the kernel looks at. */
static struct scmp_arg_cmp bits(unsigned argument, uint64_t mask, uint64_t value) {
    return (struct scmp_arg_cmp){ argument, SCMP_CMP_MASKED_EQ, mask, value };
}

static struct scmp_arg_cmp number(unsigned argument, int value) { return bits(argument, UINT32_MAX, (uint32_t)value); }

/* Threads, and no processes. The flags of clone3 cannot be looked at: C libraries then take clone. */
static void allow_threads(scmp_filter_ctx filter) {
    const uint64_t apart =
        CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;
    allow_if(filter, "clone", bits(CLONE_FLAGS, CLONE_THREAD | apart, CLONE_THREAD));
    allow_if(filter, "tgkill", number(0, getpid())); /* of the C library, to end */
    const struct scmp_arg_cmp look[] = { number(0, 0), bits(2, UINT64_MAX, 0) };
    allow(filter, "prlimit64", NOC_COUNT(look), look);
    static const int names[] = { PR_SET_NAME, PR_GET_NAME, PR_SET_VMA };
    for (size_t i = 0; i < NOC_COUNT(names); i++)
        allow_if(filter, "prctl", number(0, names[i]));
}

static void allow_files(scmp_filter_ctx filter, bool scratch) {
    const uint64_t changes = scratch ? 0 : O_ACCMODE | O_CREAT | O_TRUNC | (__O_TMPFILE & ~O_DIRECTORY);
    allow_if(filter, "open", bits(1, changes, 0));
    allow_if(filter, "openat", bits(2, changes, 0));
    static const int of_descriptors[] = { F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD,     F_SETFD,     F_GETFL,     F_GETLK,
                                          F_SETLK, F_SETLKW,        F_OFD_GETLK, F_OFD_SETLK, F_OFD_SETLKW };
    for (size_t i = 0; i < NOC_COUNT(of_descriptors); i++) {
        const struct scmp_arg_cmp command = number(1, of_descriptors[i]);
        allow_if(filter, "fcntl", command);
        allow_if(filter, "fcntl64", command);
    }
    allow_if(filter, "ioctl", number(1, TCGETS)); /* isatty() */
    allow_if(filter, "sendto", number(0, REMOTE_FD));
    allow_if(filter, "recvfrom", number(0, REMOTE_FD));
}

/* A filter of 0 is refused in any case; EFAULT says that there are filters. */
bool confine_has_seccomp(void) {
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, NULL, 0, 0) == -1 && errno == EFAULT;
}

void confine_calls(const confine_needs *needs) {
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(ENOSYS));
    if (!filter)
        return;
    seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_ERRNO(ENOSYS));
    seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1); /* libraries may have started threads as they were loaded */
    allow_all(filter, harmless, NOC_COUNT(harmless));
    if (needs->scratch)
        allow_all(filter, writing, NOC_COUNT(writing));
    allow_threads(filter);
    allow_files(filter, needs->scratch);
    if (seccomp_load(filter)) {
        seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 0);
        seccomp_load(filter);
    }
    seccomp_release(filter);
}

#else
bool confine_has_seccomp(void) { return false; }
void confine_calls(const confine_needs *needs) {}
#endif
