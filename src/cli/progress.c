#include "cli.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

static bool shown_at_all, on_screen, told_at_all;
static double last_shown, next_told, started;
static volatile sig_atomic_t caught;

#define FIRST_TOLD 10       /* s */
#define LONGEST_SILENCE 300 /* s */

double cli_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void cli_progress_start(bool quiet) {
    const char *term = getenv("TERM");
    shown_at_all = !quiet && isatty(STDERR_FILENO) && !(term && !strcmp(term, "dumb"));
    told_at_all = !quiet && !shown_at_all;
    last_shown = 0;
    started = cli_now();
    next_told = FIRST_TOLD;
}

/* A sign of life in a pipe or a log, where a bar has no place: a line after FIRST_TOLD seconds, and then ever more
 * rarely. */
static void tell(double done, double left, const char *what) {
    double spent = cli_now() - started;
    if (!told_at_all || spent < next_told)
        return;
    char remaining[48] = "", time[32];
    if (left >= 0 && left < 360000)
        snprintf(remaining, sizeof(remaining), ", about %s left", noc_text_seconds(time, left));
    cli_error("%d %%, %s%s", (int)(100 * (done > 0 ? done < 1 ? done : 1 : 0)), what, remaining);
    next_told = spent + (spent < LONGEST_SILENCE ? spent : LONGEST_SILENCE);
}

static int columns(void) {
    struct winsize size;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) || size.ws_col < 20 ? 80 : size.ws_col;
}

void cli_progress_show(double done, double left, const char *fmt, ...) {
    double now = cli_now();
    if (!(shown_at_all || told_at_all) || now - last_shown < 0.1)
        return;
    last_shown = now;
    char what[160], line[256];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(what, sizeof(what), fmt, ap);
    va_end(ap);
    if (!shown_at_all) {
        tell(done, left, what);
        return;
    }
    done = done > 0 ? done < 1 ? done : 1 : 0;
    enum { BAR = 24 };
    char bar[BAR + 1];
    for (int i = 0; i < BAR; i++)
        bar[i] = i < (int)(done * BAR + 0.5) ? '#' : '.';
    bar[BAR] = 0;
    int n = snprintf(line, sizeof(line), "[%s] %3d%%  %s", bar, (int)(done * 100), what);
    if (left >= 0 && n < (int)sizeof(line) && left < 360000)
        snprintf(line + n, sizeof(line) - (size_t)n, "  %d:%02d left", (int)left / 60, (int)left % 60);
    noc_text_clean(line, sizeof(line), line);
    /* One line rewritten in place: it must not wrap. */
    fprintf(stderr, "\r%.*s\033[K", columns() - 1, line);
    fflush(stderr);
    on_screen = true;
}

void cli_progress_clear(void) {
    if (!on_screen)
        return;
    fputs("\r\033[K", stderr);
    fflush(stderr);
    on_screen = false;
}

bool cli_load_progress(void *user, const char *what, double done) {
    const char *slash = strrchr(what, '/'); /* of a file the name is enough */
    cli_progress_show(done, -1, "%s%s", slash ? "reading " : "", slash ? slash + 1 : what);
    return !cli_interrupted();
}

static const int signals[] = { SIGINT, SIGTERM, SIGHUP };
enum { SIGNALS = sizeof(signals) / sizeof(*signals) };

/* Libraries that cannot be asked to stop (a triangulation, a hierarchy) are not waited for where nothing is to be kept.
 */
#define GRACE_NS 500000000
static volatile sig_atomic_t nothing_to_keep;
static timer_t grace;
static bool has_grace;
static const char *volatile made; /* what is not to be left behind */

static void on_grace(int number) {
    const char *path = made;
    if (path && unlink(path))
        rmdir(path);
    static const char text[] = "\nnocturne: interrupted: nothing was saved\n";
    ssize_t written = write(STDERR_FILENO, text + !on_screen, sizeof(text) - 1 - !on_screen);
    (void)written, (void)number;
    _exit(CLI_INTERRUPTED + caught);
}

static void set_grace(long ns) {
    struct itimerspec when = { .it_value = { .tv_nsec = ns } };
    if (has_grace)
        timer_settime(grace, 0, &when, NULL);
}

void cli_leave_nothing_at(const char *path) { made = path; }

void cli_nothing_to_keep(bool nothing) {
    nothing_to_keep = nothing;
    set_grace(nothing && caught ? GRACE_NS : 0);
}

static void on_signal(int number) {
    caught = number;
    if (nothing_to_keep)
        set_grace(GRACE_NS);
    /* Whoever asks twice means it. What was ignored from the start stays so. */
    for (int i = 0; i < SIGNALS; i++) {
        struct sigaction now;
        if (!sigaction(signals[i], NULL, &now) && now.sa_handler == on_signal)
            signal(signals[i], SIG_DFL);
    }
}

/* Those that are ignored are so for a reason: nohup, or a shell's job in the background. */
void cli_catch_signals(void) {
    struct sigevent event = { .sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGALRM };
    signal(SIGALRM, on_grace);
    has_grace = !timer_create(CLOCK_MONOTONIC, &event, &grace);
    struct sigaction action = { .sa_handler = on_signal, .sa_flags = SA_RESTART }, now;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < SIGNALS; i++)
        if (!sigaction(signals[i], NULL, &now) && now.sa_handler != SIG_IGN)
            sigaction(signals[i], &action, NULL);
}

int cli_interrupted(void) { return caught; }

bool cli_goes_on(void *user, const char *what, double done) {
    (void)user, (void)what, (void)done;
    return !caught;
}
