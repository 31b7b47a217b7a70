/* fail_call FOLDER N REPORT PROGRAM [ARGUMENT...]: runs the program and lets the N-th call of the kernel that opens,
 * makes, reads, writes, flushes or renames a regular file under FOLDER fail with EIO, in whichever of its processes and
 * threads. N 0: none; N+: and all later ones on that file, as of a disk that has gone bad. REPORT gets a line with the
 * number of such calls, and one with the call that failed and its file. Exits as the program does, 128 + signal where
 * one ended it, 77 where this machine cannot do it. Linux on x86-64. */
#include <stdio.h>
#include <stdlib.h>

#if defined(__linux__) && defined(__x86_64__)
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SKIPPED = 77 };

/* Where a call has its file: a descriptor, or a path in one of its arguments. */
typedef struct call {
    long number;
    const char *name;
    bool descriptor;
    int path;
} call;

static const call calls[] = {
    { SYS_read, "read", true, 0 },           { SYS_pread64, "pread", true, 0 },
    { SYS_readv, "readv", true, 0 },         { SYS_preadv, "preadv", true, 0 },
    { SYS_write, "write", true, 0 },         { SYS_pwrite64, "pwrite", true, 0 },
    { SYS_writev, "writev", true, 0 },       { SYS_pwritev, "pwritev", true, 0 },
    { SYS_fsync, "fsync", true, 0 },         { SYS_fdatasync, "fdatasync", true, 0 },
    { SYS_ftruncate, "ftruncate", true, 0 }, { SYS_copy_file_range, "copy_file_range", true, 0 },
    { SYS_sendfile, "sendfile", true, 0 },   { SYS_rename, "rename", false, 0 },
    { SYS_renameat, "renameat", false, 1 },  { SYS_renameat2, "renameat2", false, 1 },
    { SYS_link, "link", false, 0 },          { SYS_linkat, "linkat", false, 1 },
    { SYS_creat, "creat", false, 0 },        { SYS_open, "open", false, 0 },
    { SYS_openat, "openat", false, 1 },
};
enum { CALLS = sizeof(calls) / sizeof(*calls) };

/* These calls stop for us, no others. */
static bool filter(void) {
    struct sock_filter code[CALLS + 5];
    size_t n = 0;
    code[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch));
    code[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 0, CALLS + 1);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    for (size_t i = 0; i < CALLS; i++)
        code[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)calls[i].number,
                                                 (unsigned char)(CALLS - i), 0);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE);
    struct sock_fprog program = { .len = (unsigned short)n, .filter = code };
    return !prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) && !prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

static bool is_regular(const char *path) {
    struct stat st;
    return !stat(path, &st) && S_ISREG(st.st_mode);
}

/* Returns true if the path is one of another folder's descriptor. */
static bool is_elsewhere(const call *c, const unsigned long long *arguments, const char *path) {
    return c->path == 1 && *path != '/' && (int)arguments[0] != AT_FDCWD;
}

/* Makes a path of the program's own folder a whole one, without links; of a file that is not there its folder must be.
 */
static bool resolve(pid_t tid, char *path) {
    char seen[PATH_MAX], whole[PATH_MAX];
    int n = snprintf(seen, sizeof(seen), "/proc/%d/cwd/%s", (int)tid, path);
    if (n < 0 || n >= PATH_MAX)
        return false;
    if (realpath(seen, whole))
        return strcpy(path, whole);
    char *slash = strrchr(seen, '/');
    *slash = 0;
    return realpath(seen, whole) && snprintf(path, PATH_MAX, "%s/%s", whole, slash + 1) < PATH_MAX;
}

/* The file of that call; false where it has none that counts. */
static bool file_of(pid_t tid, const call *c, const unsigned long long *arguments, const char *folder, char *file) {
    char link[64];
    ssize_t n;
    if (c->descriptor) {
        snprintf(link, sizeof(link), "/proc/%d/fd/%d", (int)tid, (int)arguments[0]);
        n = readlink(link, file, PATH_MAX - 1);
    } else {
        struct iovec to = { file, PATH_MAX - 1 }, from = { (void *)(size_t)arguments[c->path], PATH_MAX - 1 };
        n = process_vm_readv(tid, &to, 1, &from, 1, 0);
        if (n <= 0) { /* the path may lie at the end of its page */
            to.iov_len = from.iov_len = 4096 - arguments[c->path] % 4096;
            n = process_vm_readv(tid, &to, 1, &from, 1, 0);
        }
    }
    if (n <= 0)
        return false;
    file[n] = 0;
    size_t length = strlen(folder);
    bool relative = *file != '/'; /* other paths are taken as they are: most are those of libraries */
    if (c->descriptor ? strstr(file, " (deleted)") != NULL
                      : is_elsewhere(c, arguments, file) || (relative && !resolve(tid, file)))
        return false;
    if (strncmp(file, folder, length) || file[length] != '/')
        return false;
    bool makes = c->number == SYS_creat ||
                 ((c->number == SYS_open || c->number == SYS_openat) && (arguments[c->path + 1] & O_CREAT));
    return is_regular(file) || (makes && access(file, F_OK));
}

static void stop(pid_t tid, const char *folder, const char *fail, unsigned long *count, FILE *report) {
    struct user_regs_struct r;
    char file[PATH_MAX], *later;
    static char broken[PATH_MAX];
    unsigned long first = strtoul(fail, &later, 10);
    if (ptrace(PTRACE_GETREGS, tid, NULL, &r))
        return;
    const unsigned long long arguments[] = { r.rdi, r.rsi, r.rdx };
    for (size_t i = 0; i < CALLS; i++)
        if (calls[i].number == (long)r.orig_rax && file_of(tid, &calls[i], arguments, folder, file) &&
            (++*count == first || !strcmp(file, broken))) {
            if (*count == first)
                fprintf(report, "%s %s\n", calls[i].name, file);
            if (*later)
                strcpy(broken, file);
            r.orig_rax = (unsigned long long)-1; /* not made, and this is what it returns */
            r.rax = (unsigned long long)-EIO;
            ptrace(PTRACE_SETREGS, tid, NULL, &r);
        }
}

int main(int argc, char **argv) {
    if (argc < 5)
        return 2;
    char folder[PATH_MAX];
    if (!realpath(argv[1], folder))
        return 2;
    unsigned long count = 0;
    pid_t program = fork();
    if (!program) {
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL))
            _exit(SKIPPED);
        raise(SIGSTOP);
        if (!filter())
            _exit(SKIPPED);
        execv(argv[4], argv + 4);
        _exit(127);
    }
    FILE *report = fopen(argv[3], "w");
    int how, status = SKIPPED;
    if (program < 0 || !report || waitpid(program, &how, 0) != program || !WIFSTOPPED(how) ||
        ptrace(PTRACE_SETOPTIONS, program, NULL,
               PTRACE_O_TRACESECCOMP | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
                   PTRACE_O_TRACEEXEC | PTRACE_O_EXITKILL))
        return SKIPPED;
    ptrace(PTRACE_CONT, program, NULL, 0);
    for (pid_t tid; (tid = waitpid(-1, &how, __WALL)) > 0;) {
        if (!WIFSTOPPED(how)) {
            if (tid == program)
                status = WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
            continue;
        }
        int signal = WSTOPSIG(how), event = how >> 16;
        if (event == PTRACE_EVENT_SECCOMP)
            stop(tid, folder, argv[2], &count, report);
        /* a new one begins with a SIGSTOP, which is none of the program's; SIGTRAP is that of events */
        long deliver = event || signal == SIGSTOP || signal == SIGTRAP ? 0 : signal;
        ptrace(PTRACE_CONT, tid, NULL, deliver);
    }
    fprintf(report, "%lu\n", count);
    return fclose(report) ? SKIPPED : status;
}

#else
int main(void) { return 77; }
#endif
