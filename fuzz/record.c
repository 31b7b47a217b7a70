/* record HELPER OUT FILE...: what the library and its helper say of each file, as seeds: OUT/request/NAME and
 * OUT/wire/NAME; and built cities. */
#include "fuzz.h"

#include "import/load/load.h"
#include "import/remote/remote.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static void write_file(const char *out, const char *folder, const char *name, const void *data, size_t size) {
    char path[4096];
    snprintf(path, sizeof(path), "%s/%s/%s", out, folder, name);
    FILE *f = fopen(path, "wb");
    FUZZ_REQUIRE(f && fwrite(data, 1, size, f) == size && !fclose(f));
}

/* Not of our own readers, which need no helper. */
static const noc_reader *reader_of(const char *path) {
    char head[4096 + 1] = "";
    FILE *f = fopen(path, "rb");
    FUZZ_REQUIRE(f);
    size_t size = fread(head, 1, sizeof(head) - 1, f);
    fclose(f);
    const noc_reader *reader = find_reader(noc_readers, head, size);
    return reader && reader->foreign && reader->foreign(head, size) ? reader : NULL;
}

static pid_t start(const char *helper, int end) {
    pid_t pid = fork();
    if (!pid) {
        dup2(end, REMOTE_FD);
        execl(helper, helper, NULL);
        _exit(127);
    }
    return pid;
}

static void record(const char *helper, const char *out, const char *path) {
    const noc_reader *reader = reader_of(path);
    if (!reader)
        return;
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    noc_import_params params = noc_import_default_params();
    geo_sink sink = { .inspect = true };
    remote_record asked = { 0 };
    char answer[1 << 16];
    int ends[2];
    FUZZ_REQUIRE(!socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends));
    int end = fcntl(ends[1], F_DUPFD_CLOEXEC, REMOTE_FD + 1); /* not the one that it is to become */
    pid_t pid = start(helper, end);
    close(ends[1]);
    close(end);
    remote_ask(&asked, reader, path, &params, &sink);
    write_file(out, "request", name, asked.bytes.data, asked.bytes.len);
    FUZZ_REQUIRE(remote_send(ends[0], &asked));
    size_t size = 0;
    for (ssize_t n = 1; n > 0 && size<sizeof(answer); size += n> 0 ? (size_t)n : 0)
        n = recv(ends[0], answer + size, sizeof(answer) - size, 0);
    close(ends[0]);
    waitpid(pid, NULL, 0);
    write_file(out, "wire", name, answer, size);
    array_free(&asked.bytes);
}

int main(int argc, char **argv) {
    built_seeds(argv[2]);
    for (int i = 3; i < argc; i++)
        record(argv[1], argv[2], argv[i]);
    return 0;
}
