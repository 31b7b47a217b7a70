/* Is there memory for what Embree is about to do? It has to be known before: Embree turns an allocation of its own that
 * fails into an error, but TBB, which runs its builds, ends the process where a thread or a small object of its own
 * cannot be had. So the room that TBB may take is looked for before anything starts, and again beside each block that
 * Embree announces. Other threads of the host may take it in between, as nothing is kept from them. */
#include "backend/embree/embree.h"

#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#define MB ((size_t)1 << 20)
/* Of each of TBB's threads: a stack (4 MB, 8 for another version's) and what glibc's malloc sets aside for it. */
#define THREAD_SPACE (72 * MB)
#define THREAD_STACK (4 * MB)
/* Blocks that several threads ask for at once, and what is not announced. */
#define SLACK (16 * MB)

/* TBB starts no more of them than there are cores. */
static size_t helpers(int threads) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    return (size_t)NOC_MIN(threads, NOC_MAX(cores, 1)) - 1;
}

static bool can_map(size_t bytes, int protection, int flags) {
    void *p = mmap(NULL, bytes, protection, MAP_PRIVATE | MAP_ANONYMOUS | flags, -1, 0);
    return p != MAP_FAILED && !munmap(p, bytes);
}

bool noc_embree_room(int threads, size_t bytes) {
    size_t space = helpers(threads) * THREAD_SPACE;
    return !noc_allocation_refused() && can_map(bytes + SLACK, PROT_READ | PROT_WRITE, 0) &&
           can_map(bytes + SLACK + space, PROT_NONE, MAP_NORESERVE);
}

static void *wait_for_lock(void *lock) {
    pthread_mutex_lock(lock);
    pthread_mutex_unlock(lock);
    return NULL;
}

bool noc_embree_room_for_threads(int count) {
    pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    /* as the device goes, TBB starts one whatever it was asked for */
    size_t wanted = NOC_MAX(helpers(count), 1), started = 0;
    pthread_t *threads = noc_alloc((wanted + 1) * sizeof(*threads));
    pthread_attr_t attributes;
    if (!threads || pthread_attr_init(&attributes)) {
        free(threads);
        return false;
    }
    pthread_attr_setstacksize(&attributes, THREAD_STACK);
    pthread_mutex_lock(&lock); /* all of them live at once */
    while (started < wanted && !pthread_create(&threads[started], &attributes, wait_for_lock, &lock))
        started++;
    pthread_mutex_unlock(&lock);
    for (size_t i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    pthread_attr_destroy(&attributes);
    free(threads);
    return started == wanted;
}
