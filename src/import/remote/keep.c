/* The helper is two processes: one that reads, and may be taken over by what it reads, and one that keeps it. That one
 * has read nothing, and outlives it: when the reader ends, when it is told to (SIGTERM), or when who started it is gone
 * (which the system tells by that signal), it ends all that came of the reader, wherever that went: as their subreaper
 * it is the parent of those whose own has ended. */
#include "import/remote/remote.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* SIGKILL to all children of this process. */
static void kill_children(void) {
    char path[60];
    long child;
    snprintf(path, sizeof(path), "/proc/self/task/%ld/children", (long)getpid());
    FILE *f = fopen(path, "r");
    while (f && fscanf(f, "%ld", &child) == 1)
        kill((pid_t)child, SIGKILL);
    if (f)
        fclose(f);
}

/* Those that are killed leave their own children to us, until there are none. */
static void end_all(pid_t reader, int *how) {
    kill(-reader, SIGKILL); /* at once all that has not left its group: nothing there can start more */
    kill(reader, SIGKILL);
    for (;;) {
        int status;
        kill_children();
        pid_t ended = waitpid(-1, &status, 0);
        if (ended == reader)
            *how = status;
        else if (ended < 0 && errno != EINTR)
            return;
    }
}

/* Ends as the reader has. */
static void end_like(int how) {
    sigset_t all;
    if (WIFEXITED(how))
        _exit(WEXITSTATUS(how));
    setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
    signal(WTERMSIG(how), SIG_DFL);
    sigfillset(&all);
    raise(WTERMSIG(how));
    sigprocmask(SIG_UNBLOCK, &all, NULL);
    _exit(1);
}

static void keep(pid_t reader, const sigset_t *awaited) {
    int how = 0;
    pid_t ended = 0;
    close(REMOTE_FD); /* so that who listens hears the reader hang up */
    for (int got = 0; got != SIGTERM && ended != reader;) {
        got = sigwaitinfo(awaited, NULL);
        while (got == SIGCHLD && ended != reader && (ended = waitpid(-1, &how, WNOHANG)) > 0)
            continue;
    }
    int before = how;
    end_all(reader, &how);
    end_like(ended == reader ? before : how);
}

bool remote_keep(pid_t *parent) {
    sigset_t awaited, none;
    sigemptyset(&none);
    sigemptyset(&awaited);
    sigaddset(&awaited, SIGCHLD);
    sigaddset(&awaited, SIGTERM);
    sigprocmask(SIG_SETMASK, &awaited, NULL);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    *parent = getppid();
    pid_t keeper = getpid(), reader = fork();
    if (reader > 0)
        keep(reader, &awaited);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpgid(0, 0);
    sigprocmask(SIG_SETMASK, &none, NULL);
    return !reader && getppid() == keeper;
}
