/* The context: allocator, threads, log and instruction-set cap. */
#ifndef SHADOWBIAS_CONTEXT_H
#define SHADOWBIAS_CONTEXT_H

#include "shadowbias/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_context shb_context;

/* alloc returns NULL when there is no memory; alignment is a power of two of at most 64. Both
 * functions are called on any thread that calls the library, but never within a task. */
typedef struct shb_allocator {
    void *(*alloc)(void *user, size_t size, size_t alignment);
    void (*free)(void *user, void *memory);
    void *user;
} shb_allocator;

/* One piece of work: index is 0 .. count - 1. Tasks of one call are independent of each other. */
typedef void shb_task_fn(void *arg, size_t index);

/* Runs task(arg, i) for every i below count, in any order, on any threads, and returns when all of
 * them are done. The host's scheduler plugs in here. */
typedef void shb_parallel_for_fn(void *user, shb_task_fn *task, void *arg, size_t count);

/* Called once for every call that fails and is given a context, or something made with one. The
 * sentence names the function, the field and the value; the function is the one that was called or,
 * where that calls others (shb_area_visibility draws maps), the one that failed. Called on any
 * thread that calls the library. */
typedef void shb_log_fn(void *user, shb_result result, const char *sentence);

/* Instruction sets. Results never depend on them: the cap is for tests, tools and measurements. */
typedef enum shb_isa {
    SHB_ISA_BEST = 0, /* what the processor offers */
    SHB_ISA_SCALAR,   /* the reference code, one lane */
    SHB_ISA_SSE2,     /* x86-64 baseline */
    SHB_ISA_AVX2,
    SHB_ISA_AVX512,
    SHB_ISA_NEON, /* aarch64 baseline */
    SHB_ISA_COUNT
} shb_isa;

typedef struct shb_context_desc {
    shb_allocator allocator;           /* alloc and free NULL: the C library's */
    shb_parallel_for_fn *parallel_for; /* NULL: a pool of this library's own threads */
    void *parallel_user;
    uint32_t threads; /* of the library's own pool, caller included, 1 .. 256; 0: one a processor.
                         With parallel_for: how many threads the host runs, as a hint; 0: 8 */
    shb_log_fn *log;  /* NULL: silent */
    void *log_user;
    shb_isa max_isa; /* no better one is used; if the processor lacks it, the next lower one is */
} shb_context_desc;

/* desc may be NULL: all defaults. SHB_ERROR_ARITHMETIC if the floating point of this build or
 * thread is not IEEE round-to-nearest without contraction and without flushed subnormals;
 * SHB_ERROR_ARGUMENT, SHB_ERROR_MEMORY.
 *
 * A context serves one call at a time of those that work on its threads or in its memory, which say
 * so: drawing, preparing, shading, making clusters, the reference. Meanwhile other threads may make
 * and destroy maps, and ask those that are not being drawn or prepared (shb_map_visibility,
 * shb_map_classify). Contexts know nothing of each other. */
shb_result shb_context_create(const shb_context_desc *desc, shb_context **context);

/* NULL is ignored. Destroy what was created with the context first. */
void shb_context_destroy(shb_context *context);

/* The instruction set that the context uses (NULL: SHB_ISA_SCALAR), and the name of one: "best",
 * "scalar", "avx2", ...; "unknown" for any other value. */
shb_isa shb_context_isa(const shb_context *context);
const char *shb_isa_name(shb_isa isa);

/* The threads that work on one call, caller included: fewer than asked for if the system could not
 * start more; 0 for NULL. */
uint32_t shb_context_threads(const shb_context *context);

#ifdef __cplusplus
}
#endif

#endif
