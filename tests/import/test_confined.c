/* The helper as if what it reads had taken it over: each thing that it may not do is tried in a process of its own,
 * first as it is, to see that the system lets it, and then confined, which must refuse it. And what it needs goes on.
 */
#include "../test.h"
#include "import/remote/confine.h"
#include "nocturne/nocturne.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/keyctl.h>
#include <linux/perf_event.h>
#include <mqueue.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/inotify.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

static char home[] = "/tmp/noc-confined-XXXXXX";
static pid_t other; /* a process of the same user */

static const char *at(const char *name) {
    static char path[2][PATH_MAX];
    static int turn;
    turn = !turn;
    snprintf(path[turn], sizeof(path[turn]), "%s/%s", home, name);
    return path[turn];
}

/* ---- what is tried: less than 0 where it is refused ---- */

#define TRY(name, ...)                                                                                                 \
    static long name(void) { return __VA_ARGS__; }
TRY(internet, socket(AF_INET, SOCK_STREAM, 0))
TRY(local_socket, socket(AF_UNIX, SOCK_STREAM, 0))
TRY(netlink, socket(AF_NETLINK, SOCK_RAW, 0))
TRY(pair, socketpair(AF_UNIX, SOCK_STREAM, 0, (int[2]){ 0 }))
TRY(read_key, open(at("key"), O_RDONLY))
TRY(list_home, open(home, O_RDONLY | O_DIRECTORY))
TRY(read_sibling, open(at("in/secret"), O_RDONLY))
TRY(list_beside, open(at("in"), O_RDONLY | O_DIRECTORY))
TRY(own_environment, open("/proc/self/environ", O_RDONLY))
TRY(own_memory, open("/proc/self/mem", O_RDWR))
TRY(write_new, open(at("new"), O_WRONLY | O_CREAT, 0600))
TRY(write_input, open(at("in/lamps.geojson"), O_WRONLY))
TRY(write_scratch, open(at("tmp/x"), O_WRONLY | O_CREAT, 0600))
TRY(write_nameless, open(at("tmp"), O_RDWR | O_TMPFILE, 0600))
TRY(empty_by_name, truncate(at("victim"), 0))
TRY(empty_as_opened, open(at("victim"), O_RDONLY | O_TRUNC))
TRY(in_memory, syscall(SYS_memfd_create, "x", 0))
TRY(make_folder, mkdir(at("folder"), 0700))
TRY(chmod_key, chmod(at("key"), 0666))
TRY(chmod_home, chmod(home, 0777))
TRY(chmod_open, fchmod(open(at("in/lamps.geojson"), O_RDONLY), 0666))
TRY(chown_key, chown(at("key"), getuid(), getgid()))
TRY(touch, utimensat(AT_FDCWD, at("victim"), NULL, 0))
TRY(attribute, syscall(SYS_setxattr, at("victim"), "user.x", "x", 1, 0))
TRY(link_to, symlink("/tmp/x.desktop", at("autostart")))
TRY(pipe_named, mkfifo(at("pipe"), 0600))
TRY(socket_named, mknod(at("socket"), S_IFSOCK | 0600, 0))
TRY(rename_it, rename(at("victim"), at("other")))
TRY(link_it, link(at("victim"), at("other")))
TRY(remove_it, unlink(at("victim")))
TRY(signal_parent, kill(getppid(), 0))
TRY(signal_other, kill(other, 0))
TRY(signal_thread, syscall(SYS_tgkill, other, other, 0))
TRY(trace_other, ptrace(PTRACE_SEIZE, other, NULL, NULL))
TRY(handle, syscall(SYS_pidfd_open, getppid(), 0))
TRY(limits_seen, prlimit(other, RLIMIT_NOFILE, NULL, &(struct rlimit){ 0 }))
TRY(limits_set, prlimit(other, RLIMIT_CORE, &(struct rlimit){ 0 }, NULL))
TRY(own_limits, setrlimit(RLIMIT_CORE, &(struct rlimit){ 0 }))
TRY(outlive, prctl(PR_SET_PDEATHSIG, 0))
TRY(nice_other, setpriority(PRIO_PROCESS, (id_t)other, 19))
TRY(shared_memory, shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0600))
TRY(key_ring, syscall(SYS_add_key, "user", "noc", "x", 1, KEY_SPEC_PROCESS_KEYRING))
TRY(watch, inotify_add_watch(inotify_init(), home, IN_ALL_EVENTS))
TRY(rings, syscall(SYS_io_uring_setup, 1, &(char[256]){ 0 }))
TRY(terminal, open("/dev/ptmx", O_RDWR | O_NOCTTY))
TRY(own_users, unshare(CLONE_NEWUSER))
TRY(own_files, unshare(CLONE_NEWNS))
TRY(own_session, setsid())
TRY(program, execl("/bin/false", "false", (char *)NULL))
TRY(owner_of_signals, fcntl(open(at("in/lamps.geojson"), O_RDONLY), F_SETOWN, other))

static long read_memory(void) {
    char c;
    struct iovec here = { &c, 1 }, there = { &c, 1 };
    return process_vm_readv(other, &here, 1, &there, 1, 0);
}
static long other_memory(void) {
    char path[60];
    snprintf(path, sizeof(path), "/proc/%d/mem", (int)other);
    return open(path, O_RDWR);
}
static long other_environment(void) {
    char path[60];
    snprintf(path, sizeof(path), "/proc/%d/environ", (int)other);
    return open(path, O_RDONLY);
}
static long move_other(void) {
    cpu_set_t set;
    return sched_getaffinity(0, sizeof(set), &set) ? -1 : sched_setaffinity(other, sizeof(set), &set);
}
static long queue(void) {
    char name[40];
    snprintf(name, sizeof(name), "/noc-%d", (int)getpid());
    mqd_t q = mq_open(name, O_CREAT | O_RDWR, 0600, NULL);
    if (q != (mqd_t)-1)
        mq_unlink(name);
    return q;
}
static long events(void) {
    struct perf_event_attr what = { .type = PERF_TYPE_SOFTWARE, .size = sizeof(what), .exclude_kernel = 1 };
    return syscall(SYS_perf_event_open, &what, 0, -1, -1, 0);
}
static long process(void) {
    pid_t child = fork();
    if (!child)
        _exit(0);
    return child;
}
static long process_apart(void) {
    long child = syscall(SYS_clone, CLONE_NEWUSER | CLONE_NEWNS | SIGCHLD, 0, 0, 0, 0);
    if (!child)
        _exit(0);
    return child;
}
static long process_beside(void) {
    pid_t child = vfork();
    if (!child)
        _exit(0);
    return child;
}

/* ---- what it needs: less than 0 where it fails ---- */

TRY(read_input, open(at("in/lamps.geojson"), O_RDONLY))
TRY(read_part, open(at("in/lamps.geojson.index"), O_RDONLY))
TRY(read_system, open("/usr", O_RDONLY | O_DIRECTORY))
TRY(read_own_status, open("/proc/self/status", O_RDONLY))
TRY(ask_limits, getrlimit(RLIMIT_AS, &(struct rlimit){ 0 }))
TRY(end_by_signal, syscall(SYS_tgkill, getpid(), getpid(), SIGURG))

static void *end_well(void *arg) { return arg; }
static long thread(void) {
    pthread_t t;
    return pthread_create(&t, NULL, end_well, NULL) || pthread_join(t, NULL) ? -1 : 0;
}
static long write_copy(void) {
    int fd = open(at("tmp/copy"), O_RDWR | O_CREAT | O_EXCL, 0600);
    bool good = fd >= 0 && write(fd, "x", 1) == 1 && !ftruncate(fd, 100) && !unlink(at("tmp/copy"));
    return good ? 0 : -1;
}

/* ---- each in a process of its own ---- */

enum { FILES = 1, CALLS = 2, EITHER = 4 }; /* which fences refuse it */
typedef struct attempt {
    const char *name;
    long (*act)(void);
    int by;
} attempt;

#define A(act, by)                                                                                                     \
    { #act, act, by }
static const attempt refused[] = {
    A(internet, CALLS),          A(local_socket, CALLS),     A(netlink, CALLS),       A(pair, CALLS),
    A(read_key, FILES),          A(list_home, FILES),        A(read_sibling, FILES),  A(list_beside, FILES),
    A(own_environment, FILES),   A(own_memory, EITHER),      A(write_new, EITHER),    A(write_input, EITHER),
    A(write_scratch, EITHER),    A(write_nameless, EITHER),  A(empty_by_name, CALLS), A(empty_as_opened, CALLS),
    A(in_memory, CALLS),         A(make_folder, EITHER),     A(chmod_key, CALLS),     A(chmod_home, CALLS),
    A(chmod_open, CALLS),        A(chown_key, CALLS),        A(touch, CALLS),         A(attribute, CALLS),
    A(link_to, EITHER),          A(pipe_named, EITHER),      A(socket_named, EITHER), A(rename_it, EITHER),
    A(link_it, EITHER),          A(remove_it, EITHER),       A(signal_parent, CALLS), A(signal_other, CALLS),
    A(signal_thread, CALLS),     A(trace_other, CALLS),      A(handle, CALLS),        A(limits_seen, CALLS),
    A(limits_set, CALLS),        A(own_limits, CALLS),       A(outlive, CALLS),       A(nice_other, CALLS),
    A(shared_memory, CALLS),     A(key_ring, CALLS),         A(watch, CALLS),         A(rings, CALLS),
    A(terminal, EITHER),         A(own_users, CALLS),        A(own_files, CALLS),     A(own_session, CALLS),
    A(program, EITHER),          A(owner_of_signals, CALLS), A(read_memory, CALLS),   A(other_memory, EITHER),
    A(other_environment, FILES), A(move_other, CALLS),       A(queue, CALLS),         A(events, CALLS),
    A(process, CALLS),           A(process_apart, CALLS),    A(process_beside, CALLS)
};
static const attempt needed[] = { A(read_input, 0),      A(read_part, 0),  A(read_system, 0),
                                  A(read_own_status, 0), A(ask_limits, 0), A(end_by_signal, 0) };

static void confine_for(const char *input, bool whole) {
    noc_import_params params = noc_import_default_params();
    params.threads = 2;
    remote_confine(input, whole, &params);
}

/* 0: it went well; else why not, as errno; -1: it was ended. input NULL: not confined. */
static int outcome(long (*act)(void), const char *input, bool whole) {
    int how = -1;
    pid_t child = fork();
    if (!child) {
        if (input)
            confine_for(input, whole);
        errno = 0;
        _exit(act() >= 0 ? 0 : errno ? errno : 255);
    }
    assert_true(child > 0 && waitpid(child, &how, 0) == child);
    return !WIFEXITED(how) ? -1 : act == program && WEXITSTATUS(how) == 1 ? 0 : WEXITSTATUS(how);
}

static void make(const char *name, const char *text, size_t size) {
    FILE *f = fopen(at(name), "wb");
    assert_non_null(f);
    assert_true(fwrite(text, 1, size, f) == size && !fclose(f));
    assert_int_equal(chmod(at(name), 0600), 0);
}

/* What the last attempt changed is there again. */
static int set_up(void **state) {
    char command[2 * sizeof(home) + 60];
    snprintf(command, sizeof(command), "rm -rf %s && mkdir -p %s/in %s/tmp", home, home, home);
    if (system(command))
        return -1;
    make("key", "k", 1);
    make("victim", "v", 1);
    make("in/secret", "s", 1);
    make("in/lamps.geojson", "{}", 2);
    make("in/lamps.geojson.index", "x", 1);
    make("in/map.gpkg", "SQLite format 3", 16);
    make("in/roads.shp", "\0\0\x27\x0a", 4);
    return setenv("TMPDIR", at("tmp"), 1);
}

#define SKIP_BECAUSE(why)                                                                                              \
    do {                                                                                                               \
        print_message("# skipped: %s\n", why);                                                                         \
        skip();                                                                                                        \
    } while (0)

static void is_refused(void **state) {
    const attempt *a = *state;
    bool files = confine_has_landlock(), calls = confine_has_seccomp();
    if ((a->by == FILES && !files) || (a->by == CALLS && !calls) || (!files && !calls))
        SKIP_BECAUSE("this system, or this build, has not what refuses it");
    int alone = outcome(a->act, NULL, false);
    set_up(NULL);
    if (alone)
        SKIP_BECAUSE(strerror(alone));
    int confined = outcome(a->act, at("in/lamps.geojson"), false);
    if (confined <= 0)
        print_message("# %s: %s\n", a->name, confined ? "ended by a signal" : "ALLOWED");
    assert_true(confined > 0);
}

static void goes_on(void **state) {
    const attempt *a = *state;
    int confined = outcome(a->act, at("in/lamps.geojson"), false);
    if (confined)
        print_message("# %s: %s\n", a->name, strerror(confined));
    assert_int_equal(confined, 0);
}

static void formats_get_what_they_need(void **state) {
    assert_int_equal(outcome(write_copy, at("in/map.gpkg"), false), 0);
    assert_int_equal(outcome(list_beside, at("in/roads.shp"), false), 0);
    assert_int_equal(outcome(thread, at("in/lamps.geojson"), true), 0);
    assert_int_equal(outcome(read_sibling, at("in/lamps.geojson"), true), 0); /* textures of a mesh */
}

/* A GeoPackage may be copied, and nothing more is written. */
static void a_copy_has_a_limit(void **state) {
#ifdef REMOTE_SANITIZED
    SKIP_BECAUSE("sanitizers need files without a limit");
#endif
    char input[PATH_MAX];
    struct rlimit most = { 0 };
    int how;
    snprintf(input, sizeof(input), "%s", at("in/map.gpkg"));
    pid_t child = fork();
    if (!child) {
        confine_for(input, false);
        getrlimit(RLIMIT_FSIZE, &most);
        int fd = open(at("tmp/copy"), O_RDWR | O_CREAT, 0600);
        _exit(fd >= 0 && most.rlim_cur != RLIM_INFINITY && ftruncate(fd, (off_t)most.rlim_cur + 1) && errno == EFBIG
                  ? 0
                  : 1);
    }
    assert_int_equal(waitpid(child, &how, 0), child);
    assert_int_equal(how, 0);
}

/* ---- its keeper ---- */

/* A child that leaves the group, forgets whose it was, and tells its number: the reader's own is gone by then. */
static void leave(int fd) {
    if (fork())
        return;
    pid_t first = getpid();
    if (!fork()) {
        prctl(PR_SET_PDEATHSIG, 0);
        setsid();
        while (getppid() == first)
            usleep(1000);
        pid_t self = getpid();
        _exit(write(fd, &self, sizeof(self)) == sizeof(self) ? (sleep(600), 0) : 1);
    }
    _exit(0);
}

/* The keeper of a reader that has left a child behind, and its number. The reader goes on until it hears something. */
static pid_t keep_one(pid_t *left, int *to) {
    int ends_of[2];
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends_of), 0);
    int fd = fcntl(ends_of[1], F_DUPFD, 20); /* away from that of the socket, which the keeper closes */
    pid_t test = getpid(), keeper = fork(), parent;
    if (!keeper) {
        if (!remote_keep(&parent) || parent != test)
            _exit(1);
        close(ends_of[0]);
        leave(fd);
        char go;
        if (read(fd, &go, 1) == 1)
            raise(SIGXCPU);
        for (;;)
            pause();
    }
    assert_int_equal(read(ends_of[0], left, sizeof(*left)), sizeof(*left));
    close(ends_of[1]);
    close(fd);
    *to = ends_of[0];
    return keeper;
}

static void what_it_started_is_ended(void **state) {
    for (int ends = 0; ends < 2; ends++) {
        int how, to;
        pid_t left, keeper = keep_one(&left, &to);
        assert_int_equal(kill(left, 0), 0);
        if (ends)
            assert_int_equal(write(to, "", 1), 1);
        else
            kill(keeper, SIGTERM);
        assert_int_equal(waitpid(keeper, &how, 0), keeper);
        close(to);
        assert_int_equal(kill(left, 0), -1);
        assert_int_equal(errno, ESRCH);
        assert_true(WIFSIGNALED(how));
        assert_int_equal(WTERMSIG(how), ends ? SIGXCPU : SIGKILL);
    }
}

int main(void) {
    struct CMUnitTest tests[NOC_COUNT(refused) + NOC_COUNT(needed) + 3];
    size_t n = 0;
    if (!mkdtemp(home))
        return 1;
    other = fork();
    if (!other)
        for (;;)
            pause();
    for (size_t i = 0; i < NOC_COUNT(refused); i++)
        tests[n++] = (struct CMUnitTest){ refused[i].name, is_refused, set_up, NULL, (void *)&refused[i] };
    for (size_t i = 0; i < NOC_COUNT(needed); i++)
        tests[n++] = (struct CMUnitTest){ needed[i].name, goes_on, set_up, NULL, (void *)&needed[i] };
    tests[n++] = (struct CMUnitTest)cmocka_unit_test_setup(formats_get_what_they_need, set_up);
    tests[n++] = (struct CMUnitTest)cmocka_unit_test_setup(a_copy_has_a_limit, set_up);
    tests[n++] = (struct CMUnitTest)cmocka_unit_test_setup(what_it_started_is_ended, set_up);
    int failed = _cmocka_run_group_tests("confined", tests, n, NULL, NULL);
    kill(other, SIGKILL);
    char command[sizeof(home) + 10];
    snprintf(command, sizeof(command), "rm -rf %s", home);
    return system(command) || failed;
}
