/* A pool that a single caller hands one job after another.
 *
 * The caller opens a gate, works on the job itself, closes the gate and waits for the workers that
 * went through it. A worker that wakes too late finds the gate closed and is not waited for, so a
 * call costs no more than its work where the system is busy elsewhere. */
#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L /* sigset_t in a host's -std=c11 build */
#endif

#include "context.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>

/* The gate holds the number of the job in its upper half, then flags and the workers inside. */
#define GATE_OPEN 0x80000000u
#define GATE_QUIT 0x40000000u
#define GATE_CALLER_SLEEPS 0x20000000u
#define GATE_INSIDE 0x0000ffffu

/* Looks at the gate before a thread goes to sleep: some ten microseconds, about what sleep costs.
 */
enum { SPINS = 256 };

/* More than shading needs (shade.h). */
#define STACK_SIZE ((size_t)1 << 20)

struct shb_pool {
    _Alignas(64) _Atomic uint64_t gate;
    _Alignas(64) atomic_size_t next; /* the first index that nobody has taken */
    _Alignas(64) shb_task_fn *task; /* the job: constant while the gate is open or workers inside */
    void *arg;
    size_t count;
    atomic_uint sleepers;
    pthread_mutex_t mutex;
    pthread_cond_t opened, emptied;
    uint32_t workers;
    pthread_t threads[];
};

static uint32_t gate_job(uint64_t gate) {
    return (uint32_t)(gate >> 32);
}

static void relax(void) {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

static void take_tasks(shb_pool *pool) {
    for (;;) {
        const size_t index = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (index >= pool->count)
            return;
        pool->task(pool->arg, index);
    }
}

static bool calls_worker(uint64_t gate, uint32_t last_job) {
    return (gate & GATE_QUIT) || ((gate & GATE_OPEN) && gate_job(gate) != last_job);
}

/* Returns a gate that calls the worker. The caller writes the gate and then reads the number of
 * sleepers, a worker the other way round: one of the two always sees the other. */
static uint64_t wait_for_call(shb_pool *pool, uint32_t last_job) {
    for (int spin = 0; spin < SPINS; spin++) {
        const uint64_t gate = atomic_load(&pool->gate);
        if (calls_worker(gate, last_job))
            return gate;
        relax();
    }
    pthread_mutex_lock(&pool->mutex);
    atomic_fetch_add(&pool->sleepers, 1);
    uint64_t gate = atomic_load(&pool->gate);
    while (!calls_worker(gate, last_job)) {
        pthread_cond_wait(&pool->opened, &pool->mutex);
        gate = atomic_load(&pool->gate);
    }
    atomic_fetch_sub(&pool->sleepers, 1);
    pthread_mutex_unlock(&pool->mutex);
    return gate;
}

static bool enter(shb_pool *pool, uint64_t gate) {
    const uint32_t job = gate_job(gate);
    while ((gate & GATE_OPEN) && gate_job(gate) == job)
        if (atomic_compare_exchange_weak(&pool->gate, &gate, gate + 1))
            return true;
    return false;
}

static void leave(shb_pool *pool) {
    const uint64_t gate = atomic_fetch_sub(&pool->gate, 1) - 1;
    if (!(gate & GATE_CALLER_SLEEPS) || (gate & GATE_INSIDE))
        return;
    pthread_mutex_lock(&pool->mutex);
    pthread_cond_signal(&pool->emptied);
    pthread_mutex_unlock(&pool->mutex);
}

static void *work(void *arg) {
    shb_pool *pool = arg;
    uint32_t last_job = 0;
    for (;;) {
        const uint64_t gate = wait_for_call(pool, last_job);
        if (gate & GATE_QUIT)
            return NULL;
        last_job = gate_job(gate);
        if (!enter(pool, gate))
            continue;
        take_tasks(pool);
        leave(pool);
    }
}

static void set_gate(shb_pool *pool, uint64_t gate) {
    atomic_store(&pool->gate, gate);
    if (!atomic_load(&pool->sleepers))
        return;
    pthread_mutex_lock(&pool->mutex);
    pthread_cond_broadcast(&pool->opened);
    pthread_mutex_unlock(&pool->mutex);
}

static void wait_until_empty(shb_pool *pool) {
    for (int spin = 0; spin < SPINS; spin++) {
        if (!(atomic_load(&pool->gate) & GATE_INSIDE))
            return;
        relax();
    }
    pthread_mutex_lock(&pool->mutex);
    atomic_fetch_or(&pool->gate, GATE_CALLER_SLEEPS);
    while (atomic_load(&pool->gate) & GATE_INSIDE)
        pthread_cond_wait(&pool->emptied, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}

void shb_pool_run(shb_pool *pool, shb_task_fn *task, void *arg, size_t count) {
    pool->task = task;
    pool->arg = arg;
    pool->count = count;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    const uint32_t job = gate_job(atomic_load(&pool->gate)) + 1;
    set_gate(pool, ((uint64_t)job << 32) | GATE_OPEN);
    take_tasks(pool);
    atomic_fetch_and(&pool->gate, ~(uint64_t)GATE_OPEN);
    wait_until_empty(pool);
}

/* Some systems' threads have less than shading needs. */
static void ask_for_stack(pthread_attr_t *attributes) {
    size_t size;
    if (pthread_attr_getstacksize(attributes, &size) == 0 && size < STACK_SIZE)
        pthread_attr_setstacksize(attributes, STACK_SIZE);
}

/* The host's signals are not for these threads. */
static void start_workers(shb_pool *pool, uint32_t wanted) {
    pthread_attr_t attributes;
    sigset_t all, before;
    if (pthread_attr_init(&attributes))
        return;
    ask_for_stack(&attributes);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->workers < wanted &&
           pthread_create(&pool->threads[pool->workers], &attributes, work, pool) == 0)
        pool->workers++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
}

shb_pool *shb_pool_create(const shb_context *context, uint32_t threads) {
    const size_t size = sizeof(shb_pool) + threads * sizeof(pthread_t);
    shb_pool *pool = shb_alloc(context, 1, size);
    if (!pool)
        return NULL;
    atomic_init(&pool->gate, 0);
    atomic_init(&pool->next, 0);
    atomic_init(&pool->sleepers, 0);
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->opened, NULL);
    pthread_cond_init(&pool->emptied, NULL);
    pool->workers = 0;
    start_workers(pool, threads - 1);
    return pool;
}

uint32_t shb_pool_threads(const shb_pool *pool) {
    return pool->workers + 1;
}

void shb_pool_destroy(const shb_context *context, shb_pool *pool) {
    if (!pool)
        return;
    set_gate(pool, GATE_QUIT);
    for (uint32_t i = 0; i < pool->workers; i++)
        pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->emptied);
    pthread_cond_destroy(&pool->opened);
    pthread_mutex_destroy(&pool->mutex);
    shb_free(context, pool);
}
