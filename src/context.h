/* The inside of a context: memory, scratch, threads, log. */
#ifndef SRC_CONTEXT_H
#define SRC_CONTEXT_H

#include "lists_scratch.h"
#include "scratch.h"
#include "shadowbias/context.h"

#include <pthread.h>

/* Memory that grows and is kept, so that a warm context allocates nothing. */
typedef struct shb_buffer {
    void *data;
    size_t size;
} shb_buffer;

typedef struct shb_pool shb_pool;

struct shb_context {
    shb_allocator allocator;
    shb_parallel_for_fn *parallel_for;
    void *parallel_user;
    shb_pool *pool; /* NULL with a host's scheduler or a single thread */
    uint32_t threads;
    shb_log_fn *log;
    void *log_user;
    shb_isa isa;
    const struct shb_kernels *kernels; /* of the instruction set; NULL: scalar code */
    const struct shb_shade_kernels *shade_kernels;
    shb_buffer draw_scratch[SHB_SCRATCH_BUFFERS];
    shb_buffer occluder_scratch[4]; /* named in map.h */
    shb_buffer list_scratch[SHB_LIST_BUFFERS];
    shb_buffer sheet_scratch[7];    /* named in sheets_bin.h */
    shb_buffer topology_scratch[8]; /* named in topology.h */
    pthread_mutex_t topology_mutex;
    struct shb_shared_topology *topologies; /* those that maps use, see shared_topologies.h */
};

/* The C library's memory. */
extern const shb_allocator shb_default_allocator;

/* count * size bytes on a 64-byte boundary, or NULL when the product overflows or memory is out.
 * Zero bytes give one byte, so that NULL always means failure. */
void *shb_alloc(const shb_context *context, size_t count, size_t size);

/* NULL is ignored. */
void shb_free(const shb_context *context, void *memory);

/* The buffer's memory, at least count * size bytes; old contents are lost when it grows. NULL: out
 * of memory, the buffer is then empty. */
void *shb_buffer_reserve(const shb_context *context, shb_buffer *buffer, size_t count, size_t size);

/* Of count buffers. Moving and freeing leave them, or those moved from, empty; what to held is not
 * freed. */
void shb_buffers_move(size_t count, shb_buffer *from, shb_buffer *to);
void shb_buffers_free(const shb_context *context, size_t count, shb_buffer *buffers);
size_t shb_buffers_bytes(size_t count, const shb_buffer *buffers);

/* Runs the tasks on the host's scheduler, the pool or the calling thread. */
void shb_parallel_for(const shb_context *context, shb_task_fn *task, void *arg, size_t count);

/* Logs one sentence and returns the result: return shb_fail(context, SHB_ERROR_SIZE, "...").
 * Without a context nothing is logged. */
shb_result shb_fail(const shb_context *context, shb_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* pool.c: threads - 1 workers, or as many as the system grants; NULL: out of memory. */
shb_pool *shb_pool_create(const shb_context *context, uint32_t threads);
/* The threads it has, caller included. */
uint32_t shb_pool_threads(const shb_pool *pool);
void shb_pool_destroy(const shb_context *context, shb_pool *pool);
void shb_pool_run(shb_pool *pool, shb_task_fn *task, void *arg, size_t count);

/* cpu.c: the best instruction set of this processor that is not above the cap. */
shb_isa shb_cpu_isa(shb_isa cap);

#endif
