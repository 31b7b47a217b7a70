/* A tile is done by one work group of WORKERS invocations. Every 16 of them are at a group of 16 scores, one at each
 * place. A list shader includes this before the bridge. */
#define CORE_WORKERS
#define worker gl_LocalInvocationIndex
#define EACH16(l) for (int l = int(worker % 16u), once_ = l; l <= once_; l++)
#define EACH16_SUM(x) (x)
#define EACH16_MAX(x) (x)
#define EACH_INDEX(i, n) for (uint i = worker; i < (n); i += WORKERS)
/* Group g is always looked at by the same 16. */
#define EACH_GROUP(g, begin, end)                                                                                      \
    for (uint g = (begin) / 16u * 16u + worker / 16u; g < (end); g += WORKERS / 16u)                                   \
        if (g >= (begin))
#define SETTLE settle()
#define FIRST_WORKER (worker == 0u)
#define FROM_FIRST(x) from_first(x)
