/* A film of an animation's pictures, by the program ffmpeg: they go to it through a pipe, so no name is read as a
 * pattern or an option, and no shell is asked. */
#include "render.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define TICK 50 /* ms between looks at whether it has ended */

extern char **environ;

char *cli_find_ffmpeg(void) {
    struct stat st;
    for (const char *at = getenv("PATH"); at && *at;) {
        size_t n = strcspn(at, ":");
        char *program = cli_format("%.*s/ffmpeg", (int)n, at);
        if (*at == '/' && !stat(program, &st) && S_ISREG(st.st_mode) && !access(program, X_OK))
            return program;
        free(program);
        at += n + (at[n] == ':');
    }
    return NULL;
}

bool cli_file_holds(const char *file, const char *text) {
    enum { CHUNK = 1 << 16 };
    char buffer[CHUNK];
    size_t have = 0, n, length = strlen(text);
    bool found = false;
    int fd = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    FILE *f = fd >= 0 ? fdopen(fd, "rb") : NULL;
    while (f && !found && (n = fread(buffer + have, 1, sizeof(buffer) - have, f))) {
        found = memmem(buffer, have + n, text, length) != NULL;
        size_t tail = have + n < length ? have + n : length - 1;
        memmove(buffer, buffer + have + n - tail, tail);
        have = tail;
    }
    if (f)
        fclose(f);
    else if (fd >= 0)
        close(fd);
    return found;
}

typedef struct film {
    pid_t pid;
    int to;       /* its standard input */
    FILE *said;   /* its standard error */
    char *making; /* the file that it writes, */
    int part;     /* which is ours */
    char *lost;   /* a picture that cannot be read, and why; NULL: none */
    int error;
} film;

enum { PART = STDERR_FILENO + 1 }; /* its descriptor of that file */

/* A new file, whatever had that name before: what a killed run left, or a link that leads elsewhere. Its descriptor is
 * none of the standard ones, which may be closed here and are ffmpeg's own. */
static int open_part(film *f) {
    if (unlink(f->making) && errno != ENOENT)
        return errno;
    int fd = open(f->making, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    f->part = fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, PART);
    int error = f->part < 0 ? errno : 0;
    if (fd >= 0)
        close(fd);
    if (fd >= 0 && error)
        unlink(f->making);
    return error;
}

/* H.264 at a quality without visible loss, in the colours that players take a film's for; its sides must be even. */
static int start(film *f, const char *ffmpeg, double fps, const char *comment) {
    char rate[32], *said = cli_format("comment=%s", comment), *out = cli_format("file:/dev/fd/%d", PART);
    snprintf(rate, sizeof(rate), "%.10g", fps);
    const char *arguments[] = { "ffmpeg",
                                "-nostdin",
                                "-hide_banner",
                                "-loglevel",
                                "error",
                                "-nostats",
                                "-xerror", /* a picture that is damaged is no film without it */
                                "-y",
                                "-f",
                                "image2pipe",
                                "-c:v",
                                "png",
                                "-framerate",
                                rate,
                                "-i",
                                "pipe:0",
                                "-vf",
                                "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
                                "-c:v",
                                "libx264",
                                "-crf",
                                "18",
                                "-pix_fmt",
                                "yuv420p",
                                "-colorspace",
                                "bt709",
                                "-color_primaries",
                                "bt709",
                                "-color_trc",
                                "iec61966-2-1",
                                "-metadata",
                                said,
                                "-movflags",
                                "+faststart",
                                "-f",
                                "mp4",
                                out,
                                NULL };
    int ends[2], error = 0;
    sigset_t none, all;
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigemptyset(&none);
    sigfillset(&all);
    f->said = tmpfile();
    if (!f->said || pipe2(ends, O_CLOEXEC))
        error = errno;
    if (!error && fcntl(ends[1], F_SETFL, O_NONBLOCK)) {
        error = errno;
        close(ends[0]);
        close(ends[1]);
    }
    if (!error) {
        posix_spawn_file_actions_init(&actions);
        posix_spawnattr_init(&attributes);
        posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, fileno(f->said), STDERR_FILENO);
        posix_spawn_file_actions_adddup2(&actions, f->part, PART);
        posix_spawn_file_actions_addclosefrom_np(&actions, PART + 1);
        /* signals of the terminal are ours to pass on */
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        posix_spawnattr_setpgroup(&attributes, 0);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setsigdefault(&attributes, &all);
        error = posix_spawn(&f->pid, ffmpeg, &actions, &attributes, (char *const *)(uintptr_t)arguments, environ);
        posix_spawnattr_destroy(&attributes);
        posix_spawn_file_actions_destroy(&actions);
        close(ends[0]);
        f->to = ends[1];
    }
    free(said);
    free(out);
    return error;
}

/* False: it has hung up, or we are interrupted while it takes nothing. */
static bool feed(const film *f, const char *data, size_t size) {
    while (size && !cli_interrupted()) {
        ssize_t n = write(f->to, data, size);
        if (n < 0 && errno != EAGAIN && errno != EINTR)
            return false;
        if (n < 0)
            poll(&(struct pollfd){ f->to, POLLOUT, 0 }, 1, TICK);
        data += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return !size;
}

/* Sends one picture's bytes. False: it cannot be read, and `lost` is set; or ffmpeg has hung up, and tells why. */
static bool send_picture(film *f, const char *file) {
    char buffer[1 << 16];
    ssize_t n = 0;
    bool sent = true;
    int fd = open(file, O_RDONLY | O_CLOEXEC);
    while (fd >= 0 && sent && (n = read(fd, buffer, sizeof(buffer))) > 0)
        sent = feed(f, buffer, (size_t)n);
    if (fd < 0 || n < 0) {
        f->error = errno;
        f->lost = cli_format("%s", file);
    }
    if (fd >= 0)
        close(fd);
    return fd >= 0 && n >= 0 && sent;
}

static bool send_pictures(film *f, const cli_series *series, int pictures) {
    bool going = true;
    for (int i = 0; i < pictures && going && !cli_interrupted(); i++) {
        char *file = cli_series_file(series, i + 1);
        cli_progress_show((double)i / pictures, -1, "film, picture %d of %d", i + 1, pictures);
        going = send_picture(f, file);
        free(file);
    }
    return going;
}

/* Its exit status; -1: it was ended. */
static int wait_for_end(const film *f) {
    int how;
    pid_t got;
    while (!(got = waitpid(f->pid, &how, WNOHANG)) || (got < 0 && errno == EINTR)) {
        if (cli_interrupted())
            kill(-f->pid, SIGKILL); /* its group, for it may be a script */
        poll(NULL, 0, TICK);
    }
    return got > 0 && WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

/* The last line of what it said. */
static void last_line(FILE *said, char *line, size_t size) {
    char next[512];
    snprintf(line, size, "it said nothing");
    rewind(said);
    while (fgets(next, sizeof(next), said)) {
        next[strcspn(next, "\r\n")] = 0;
        if (*next)
            noc_text_clean(line, size, next);
    }
}

/* Under its name only when it is whole, with the permissions of the file that it replaces. */
static bool publish(const film *f, const char *name) {
    struct stat st;
    bool done = (lstat(name, &st) || !S_ISREG(st.st_mode) || !fchmod(f->part, st.st_mode & 0777)) &&
                (!fsync(f->part) || errno == EINVAL) && !rename(f->making, name);
    if (!done)
        cli_error("%s: cannot be written: %s", name, strerror(errno));
    return done;
}

/* Reports why there is no film. What another process has made of the same pictures is one. */
static noc_status fail(const film *f, const char *name, const char *comment, bool started) {
    char line[300];
    if (cli_file_holds(name, comment))
        return NOC_OK;
    if (f->lost) {
        cli_error("%s: cannot be read: %s", f->lost, strerror(f->error));
    } else if (started) {
        last_line(f->said, line, sizeof(line));
        cli_error("%s: ffmpeg made no film of the pictures, which are there: %s", name, line);
    }
    return NOC_ERR_IO;
}

/* ".name.host-pid.part" beside the target: processes of several hosts, and of containers whose numbers are all 1, may
 * make the same film. */
static char *name_part(const char *target) {
    char host[65] = "";
    const char *slash = strrchr(target, '/'), *base = slash ? slash + 1 : target;
    gethostname(host, sizeof(host) - 1);
    for (char *c = host; *c; c++)
        *c = *c == '/' ? '_' : *c;
    return cli_format("%.*s.%.150s.%s-%ld.part", (int)(base - target), target, base, host, (long)getpid());
}

noc_status cli_make_film(const char *ffmpeg, const cli_series *series, int pictures, double fps, const char *name,
                         const char *comment) {
    /* what a symbolic link points to is replaced, not the link */
    char *real = readlink(name, &(char){ 0 }, 1) > 0 ? realpath(name, NULL) : NULL;
    const char *target = real ? real : name;
    film f = { .to = -1, .part = -1, .making = name_part(target) };
    struct sigaction before, ignore = { .sa_handler = SIG_IGN };
    sigaction(SIGPIPE, &ignore, &before); /* one that hangs up is an error, not our end */
    int unopened = open_part(&f), error = unopened ? unopened : start(&f, ffmpeg, fps, comment), ended = 0;
    bool sent = !error && send_pictures(&f, series, pictures);
    if (f.to >= 0)
        close(f.to);
    if (unopened) {
        cli_error("%s: cannot be written: %s", f.making, strerror(unopened));
    } else if (error) {
        cli_error("%s: %s cannot be started: %s", name, ffmpeg, strerror(error));
    } else {
        if (f.lost)
            kill(-f.pid, SIGKILL);
        ended = wait_for_end(&f);
    }
    cli_progress_clear();
    sigaction(SIGPIPE, &before, NULL);
    noc_status status = NOC_OK;
    bool whole = !error && !f.lost && sent && !ended;
    if (cli_interrupted())
        status = NOC_ERR_CANCELLED;
    else if (!whole)
        status = fail(&f, name, comment, !error);
    else if (!publish(&f, target))
        status = NOC_ERR_IO;
    if ((status || !whole) && f.part >= 0)
        unlink(f.making);
    if (f.part >= 0)
        close(f.part);
    if (f.said)
        fclose(f.said);
    free(f.lost);
    free(f.making);
    free(real);
    return status;
}
