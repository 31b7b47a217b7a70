/* --part K/N: the share of a command's items that this process works on. Without the option K and N come from the
 * variables that MPI launchers, Slurm and Kubernetes set. Nothing is sent between processes. */
#include "cli.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define TURNED_OFF "--part 1/1 does all"

/* Of one launcher. */
typedef struct place {
    long rank, size;        /* rank counts from 0; size 0: unknown */
    const char *first_name; /* of the variable that gives the rank; NULL: this launcher started nothing */
    const char *size_name;
} place;

static const char *variable(const char *name) {
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

static bool read_number(const char *text, long *out) {
    char *end;
    errno = 0;
    *out = strtol(text, &end, 10);
    return isdigit((unsigned char)*text) && !*end && !errno && *out <= CLI_MOST_PARTS;
}

/* Sets *out to the variable's number. CLI_USAGE after reporting one that is unset or no number. */
static int take(const cli_command *command, const char *name, const char *beside, long *out) {
    const char *value = variable(name);
    if (!value)
        return cli_usage(command, "%s is set and %s is not: pass --part K/N; " TURNED_OFF, beside, name);
    if (!read_number(value, out))
        return cli_usage(command, "%s is \"%.40s\", not a number from 0 to %d: pass --part K/N; " TURNED_OFF, name,
                         value, CLI_MOST_PARTS);
    return CLI_OK;
}

static int check_rank(const cli_command *command, const place *at) {
    if (at->rank < at->size)
        return CLI_OK;
    return cli_usage(command, "%s is %ld, beyond %s, which is %ld: pass --part K/N; " TURNED_OFF, at->first_name,
                     at->rank, at->size_name, at->size);
}

/* Both variables or none. */
static int read_pair(const cli_command *command, const char *rank, const char *size, place *at) {
    if (!variable(rank) && !variable(size))
        return CLI_OK;
    *at = (place){ .first_name = rank, .size_name = size };
    int status = take(command, rank, size, &at->rank);
    status = status ? status : take(command, size, rank, &at->size);
    return status ? status : check_rank(command, at);
}

/* Processes of one launch: MPI's, or those of srun. A batch script and the shell of salloc have variables of their
 * whole allocation, but are one process. */
static int read_launch(const cli_command *command, place *at) {
    int status = read_pair(command, "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", at);
    if (!status && !at->first_name)
        status = read_pair(command, "PMI_RANK", "PMI_SIZE", at);
    bool script = variable("SLURM_JOB_ID") && !variable("SLURM_STEP_ID");
    const char *size = variable("SLURM_STEP_NUM_TASKS") ? "SLURM_STEP_NUM_TASKS" : "SLURM_NTASKS";
    return status || at->first_name || script ? status : read_pair(command, "SLURM_PROCID", size, at);
}

/* Indices of an array are first, first + step, ..., of which there are `size`. */
static int read_array(const cli_command *command, place *at) {
    const char *const id = "SLURM_ARRAY_TASK_ID", *const first = "SLURM_ARRAY_TASK_MIN",
                      *const count = "SLURM_ARRAY_TASK_COUNT", *const last = "SLURM_ARRAY_TASK_MAX",
                      *const step = "SLURM_ARRAY_TASK_STEP";
    if (!variable(id) && !variable(first) && !variable(count))
        return CLI_OK;
    *at = (place){ .first_name = id, .size_name = variable(count) || !variable(last) ? count : last };
    long index, from = 0, to = 0, by = 1;
    int status = take(command, id, variable(first) ? first : count, &index);
    status = status ? status : take(command, first, id, &from);
    status = status ? status : take(command, at->size_name, id, &to);
    if (!status && variable(step))
        status = take(command, step, id, &by);
    if (status)
        return status;
    by = by ? by : 1;
    at->size = at->size_name == last ? (to - from) / by + 1 : to;
    at->rank = (index - from) / by;
    if (index < from || (index - from) % by || at->rank >= at->size)
        return cli_usage(command,
                         "%s is %ld, which is not one of %ld even steps from %s, %ld: pass --part K/N; " TURNED_OFF, id,
                         index, at->size, first, from);
    return CLI_OK;
}

/* An array of jobs, each of which may be a launch. Kubernetes sets no size: `counted` says that the caller has one. */
static int read_jobs(const cli_command *command, bool counted, place *at) {
    const char *const index = "JOB_COMPLETION_INDEX", *const parts = "NOCTURNE_PARTS";
    int status = read_array(command, at);
    if (status || at->first_name)
        return status;
    if (!counted || variable(parts))
        return variable(index) && !variable(parts)
                   ? cli_usage(
                         command,
                         "%s is set and %s is not: set it to the job's completions, or pass --part -/N; " TURNED_OFF,
                         index, parts)
                   : read_pair(command, index, parts, at);
    at->first_name = variable(index) ? index : NULL;
    return at->first_name ? take(command, index, index, &at->rank) : CLI_OK;
}

/* `count`: what the user has passed; 0: the environment gives it. */
static int read_environment(const cli_command *command, long count, cli_part *part) {
    place jobs = { 0 }, launch = { 0 };
    int status = read_jobs(command, count > 0, &jobs);
    status = status ? status : read_launch(command, &launch);
    if (status)
        return status;
    long inner = launch.first_name ? launch.size : 1, outer = jobs.first_name ? jobs.size : 1;
    const char *const first = jobs.first_name ? jobs.first_name : launch.first_name;
    if (!first)
        return count ? cli_usage(command, "--part -/%ld: no variable gives K: none of MPI, Slurm or Kubernetes", count)
                     : CLI_OK;
    long number = jobs.rank * inner + launch.rank + 1;
    count = count ? count : outer * inner;
    if (number > count || count > CLI_MOST_PARTS)
        return cli_usage(command, "%s%s%s: part %ld of %ld does not exist: pass --part K/N; " TURNED_OFF, first,
                         jobs.first_name && launch.first_name ? " and " : "",
                         jobs.first_name && launch.first_name ? launch.first_name : "", number, count);
    part->number = (int)number;
    part->count = (int)count;
    snprintf(part->by, sizeof(part->by), "%s%s%s", first, jobs.first_name && launch.first_name ? " and " : "",
             jobs.first_name && launch.first_name ? launch.first_name : "");
    return CLI_OK;
}

/* "2/5", or "-/5", whose K is 0 here. */
static bool parse(const char *text, long *number, long *count) {
    const char *slash = strchr(text, '/');
    if (!slash || slash == text || slash - text > 7)
        return false;
    char first[8];
    snprintf(first, sizeof(first), "%.*s", (int)(slash - text), text);
    *number = 0;
    return read_number(slash + 1, count) && (!strcmp(first, "-") || (read_number(first, number) && *number > 0));
}

int cli_choose_part(const cli_command *command, const cli_args *args, const char *text, cli_part *part) {
    long number = 0, count = 0;
    *part = (cli_part){ 1, 1, "--part" };
    if (text && (!parse(text, &number, &count) || number > count || count < 1))
        return cli_usage(command, "--part: \"%.40s\" is not K/N with K from 1 to N, nor -/N", text);
    int status = CLI_OK;
    if (number) {
        part->number = (int)number;
        part->count = (int)count;
    } else {
        status = read_environment(command, count, part);
    }
    if (!status && part->count > 1 && !args->quiet)
        cli_error("part %d of %d, by %s", part->number, part->count, part->by);
    return status;
}
