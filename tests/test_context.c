#include "allocator.h"
#include "contexts.h"
#include "random.h"
#include "test.h"

#include "../src/context.h"

#include <fenv.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

/* The description must be refused with one sentence that holds both texts. */
static void check_refused(shb_context_desc desc, shb_result expected, const char *field,
                          const char *value) {
    test_log log = {0};
    desc.log = test_log_keep;
    desc.log_user = &log;
    shb_context *const untouched = (shb_context *)(void *)&log;
    shb_context *context = untouched;
    CHECK_INT(shb_context_create(&desc, &context), expected);
    CHECK(context == untouched);
    CHECK_INT(log.calls, 1);
    CHECK_INT(log.result, expected);
    CHECK(strstr(log.sentence, "shb_context_create: ") == log.sentence);
    CHECK(strstr(log.sentence, field) && strstr(log.sentence, value));
}

TEST(every_result_has_its_own_sentence) {
    for (int a = SHB_OK; a <= SHB_ERROR_ARITHMETIC; a++)
        for (int b = SHB_OK; b < a; b++)
            CHECK(strcmp(shb_result_string((shb_result)a), shb_result_string((shb_result)b)) != 0);
    CHECK(strcmp(shb_result_string((shb_result)(SHB_ERROR_ARITHMETIC + 1)), "unknown result") == 0);
    CHECK(strcmp(shb_result_string((shb_result)-1), "unknown result") == 0);
    CHECK(strcmp(shb_result_string(SHB_ERROR_ARITHMETIC), "unknown result") != 0);
}

TEST(context_without_description_has_defaults) {
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    CHECK(shb_context_threads(context) >= 1 && shb_context_threads(context) <= 256);
    CHECK(shb_context_isa(context) == shb_cpu_isa(SHB_ISA_BEST));
    shb_context_destroy(context);
    shb_context_destroy(NULL);
    CHECK_INT(shb_context_threads(NULL), 0);
    CHECK_INT(shb_context_isa(NULL), SHB_ISA_SCALAR);
}

TEST(context_refuses_bad_descriptions) {
    test_allocator state = {0};
    const shb_allocator hooks = test_allocator_hooks(&state);
    check_refused((shb_context_desc){.threads = 257}, SHB_ERROR_ARGUMENT, "desc.threads", "257");
    check_refused((shb_context_desc){.max_isa = SHB_ISA_COUNT}, SHB_ERROR_ARGUMENT, "desc.max_isa",
                  "6");
    check_refused((shb_context_desc){.max_isa = (shb_isa)-1}, SHB_ERROR_ARGUMENT, "desc.max_isa",
                  "-1");
    check_refused((shb_context_desc){.allocator = {.alloc = hooks.alloc}}, SHB_ERROR_ARGUMENT,
                  "desc.allocator.free", "NULL");
    check_refused((shb_context_desc){.allocator = {.free = hooks.free}}, SHB_ERROR_ARGUMENT,
                  "desc.allocator.alloc", "NULL");
    CHECK_INT(shb_context_create(NULL, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(state.calls, 0);
}

TEST(context_survives_failure_of_every_allocation) {
    for (uint32_t threads = 1; threads <= 4; threads += 3) {
        shb_result result = SHB_ERROR_MEMORY;
        size_t fail_at = 1;
        for (; result == SHB_ERROR_MEMORY; fail_at++) {
            test_allocator state = {.fail_at = fail_at};
            test_log log = {0};
            const shb_context_desc desc = {.allocator = test_allocator_hooks(&state),
                                           .threads = threads,
                                           .log = test_log_keep,
                                           .log_user = &log};
            shb_context *context = NULL;
            result = shb_context_create(&desc, &context);
            CHECK_INT(log.calls, result != SHB_OK);
            CHECK_INT(log.result, result);
            CHECK((context != NULL) == (result == SHB_OK));
            CHECK(result == SHB_OK || state.live == 0);
            shb_context_destroy(context);
            CHECK_INT(state.live, 0);
        }
        CHECK_INT(result, SHB_OK);
        /* the context, and the pool if there is one */
        CHECK_INT(fail_at - 2, threads == 1 ? 1 : 2);
    }
}

TEST(context_refuses_directed_rounding) {
    const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    for (int i = 0; i < 3; i++) {
        shb_context *context = NULL;
        fesetround(modes[i]);
        const shb_result result = shb_context_create(NULL, &context);
        fesetround(FE_TONEAREST);
        CHECK_INT(result, SHB_ERROR_ARITHMETIC);
        CHECK(context == NULL);
    }
}

#if defined(__x86_64__)
TEST(context_refuses_flushed_subnormals) {
    const unsigned before = _mm_getcsr();
    const unsigned flush_results = 0x8000, flush_operands = 0x0040;
    const unsigned modes[] = {flush_results, flush_operands, flush_results | flush_operands};
    for (int i = 0; i < 3; i++) {
        shb_context *context = NULL;
        _mm_setcsr(before | modes[i]);
        const shb_result result = shb_context_create(NULL, &context);
        _mm_setcsr(before);
        CHECK_INT(result, SHB_ERROR_ARITHMETIC);
        CHECK(context == NULL);
    }
}
#endif

TEST(instruction_set_never_exceeds_its_cap) {
    CHECK_INT(shb_cpu_isa(SHB_ISA_SCALAR), SHB_ISA_SCALAR);
    shb_isa last = SHB_ISA_SCALAR;
    for (int cap = SHB_ISA_SCALAR; cap < SHB_ISA_COUNT; cap++) {
        const shb_context_desc desc = {.threads = 1, .max_isa = (shb_isa)cap};
        shb_context *context = NULL;
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        const shb_isa isa = shb_context_isa(context);
        shb_context_destroy(context);
        /* either the cap itself or what the next lower cap gives */
        CHECK(isa == (shb_isa)cap || isa == last);
        last = isa;
    }
    CHECK_INT(shb_cpu_isa(SHB_ISA_BEST), last);
#if defined(__x86_64__)
    CHECK_INT(shb_cpu_isa(SHB_ISA_SSE2), SHB_ISA_SSE2);
#elif defined(__aarch64__)
    CHECK_INT(shb_cpu_isa(SHB_ISA_BEST), SHB_ISA_NEON);
#endif
}

TEST(instruction_sets_have_names) {
    CHECK(strcmp(shb_isa_name(SHB_ISA_SCALAR), "scalar") == 0);
    CHECK(strcmp(shb_isa_name(SHB_ISA_SSE2), "sse2") == 0);
    CHECK(strcmp(shb_isa_name(SHB_ISA_AVX2), "avx2") == 0);
    CHECK(strcmp(shb_isa_name(SHB_ISA_AVX512), "avx512") == 0);
    CHECK(strcmp(shb_isa_name(SHB_ISA_NEON), "neon") == 0);
    CHECK(strcmp(shb_isa_name(SHB_ISA_COUNT), "unknown") == 0);
    CHECK(strcmp(shb_isa_name((shb_isa)-1), "unknown") == 0);
}

TEST(memory_is_aligned_and_overflow_is_refused) {
    shb_context *context = test_context(1, SHB_ISA_BEST);
    for (size_t size = 0; size < 200; size += 37) {
        unsigned char *memory = shb_alloc(context, size, 3);
        CHECK(memory != NULL);
        CHECK_INT((uintptr_t)memory % 64, 0);
        memset(memory, 1, 3 * size);
        shb_free(context, memory);
    }
    CHECK(shb_alloc(context, SIZE_MAX / 2, 3) == NULL);
    CHECK(shb_alloc(context, SIZE_MAX, SIZE_MAX) == NULL);
    CHECK(shb_alloc(context, SIZE_MAX - 8, 1) == NULL);
    shb_free(context, NULL);
    shb_context_destroy(context);
}

static void *refuse_zero(void *user, size_t size, size_t alignment) {
    (void)alignment;
    return size ? user : NULL;
}

TEST(zero_bytes_are_never_asked_for) {
    char memory = 0;
    const shb_context context = {.allocator = {.alloc = refuse_zero, .user = &memory}};
    CHECK(shb_alloc(&context, 0, 8) == &memory);
    CHECK(shb_alloc(&context, 8, 0) == &memory);
}

TEST(buffer_grows_only_when_it_must) {
    test_allocator state = {0};
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&state), .threads = 1};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    const size_t before = state.calls;
    shb_buffer *buffer = &context->draw_scratch[15];
    CHECK(shb_buffer_reserve(context, buffer, 10, 10));
    void *data = buffer->data;
    CHECK(shb_buffer_reserve(context, buffer, 0, 10));
    CHECK(shb_buffer_reserve(context, buffer, 25, 4));
    CHECK(buffer->data == data);
    CHECK_INT(state.calls - before, 1);
    CHECK(shb_buffer_reserve(context, buffer, 101, 1));
    memset(buffer->data, 1, 101);
    CHECK_INT(state.calls - before, 2);
    CHECK_INT(state.live, 2);
    CHECK(shb_buffer_reserve(context, &context->sheet_scratch[1], 1, 1));
    shb_context_destroy(context);
    CHECK_INT(state.live, 0);
}

TEST(buffer_is_empty_after_failure) {
    test_allocator state = {.fail_at = 3};
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&state), .threads = 1};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    shb_buffer buffer = {NULL, 0};
    CHECK(shb_buffer_reserve(context, &buffer, 8, 8));
    CHECK(!shb_buffer_reserve(context, &buffer, 9, 8));
    CHECK(buffer.data == NULL && buffer.size == 0);
    state.fail_at = 0;
    CHECK(shb_buffer_reserve(context, &buffer, 8, 8));
    CHECK(!shb_buffer_reserve(context, &buffer, SIZE_MAX / 4, 8));
    CHECK(buffer.data == NULL && buffer.size == 0);
    CHECK_INT(state.live, 1);
    shb_context_destroy(context);
}

TEST(failure_is_logged_as_one_sentence) {
    test_log log = {0};
    const shb_context_desc desc = {.threads = 1, .log = test_log_keep, .log_user = &log};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    CHECK_INT(log.calls, 0);
    CHECK_INT(shb_fail(context, SHB_ERROR_SIZE, "shb_draw: desc.width %d is 0", 7), SHB_ERROR_SIZE);
    CHECK(strcmp(log.sentence, "shb_draw: desc.width 7 is 0") == 0);
    CHECK_INT(log.result, SHB_ERROR_SIZE);
    /* a sentence without an end is cut, not written past its buffer */
    CHECK_INT(shb_fail(context, SHB_ERROR_FILE, "%0900d", 1), SHB_ERROR_FILE);
    CHECK(strlen(log.sentence) >= 200 && strlen(log.sentence) < 900);
    CHECK_INT(log.calls, 2);
    shb_context_destroy(context);
    context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_fail(context, SHB_ERROR_NUMBER, "silent"), SHB_ERROR_NUMBER);
    CHECK_INT(shb_fail(NULL, SHB_ERROR_NUMBER, "silent"), SHB_ERROR_NUMBER);
    shb_context_destroy(context);
}

enum { MOST_TASKS = 1000 };

/* Not atomic on purpose: each counter belongs to one task, and the caller reads it afterwards. */
static void count_visit(void *arg, size_t index) {
    unsigned *visits = arg;
    visits[index]++;
}

TEST(parallel_for_visits_every_index_once) {
    const size_t counts[] = {0, 1, 2, 3, 7, 64, MOST_TASKS};
    for (uint32_t threads = 1; threads <= 8; threads++) {
        shb_context *context = test_context(threads, SHB_ISA_BEST);
        CHECK_INT(shb_context_threads(context), threads);
        for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++) {
            unsigned visits[MOST_TASKS + 1] = {0};
            const unsigned calls = 300;
            for (unsigned call = 0; call < calls; call++)
                shb_parallel_for(context, count_visit, visits, counts[i]);
            for (size_t index = 0; index <= MOST_TASKS; index++)
                CHECK_INT(visits[index], index < counts[i] ? calls : 0);
        }
        shb_context_destroy(context);
    }
}

static void sleep_microseconds(long microseconds) {
    const struct timespec time = {microseconds / 1000000, microseconds % 1000000 * 1000};
    nanosleep(&time, NULL);
}

typedef struct meeting {
    atomic_uint arrived;
    uint32_t expected;
    atomic_bool missed;
} meeting;

/* Ends only when as many tasks run side by side as are expected, or after 20 seconds in vain. */
static void meet(void *arg, size_t index) {
    (void)index;
    meeting *m = arg;
    atomic_fetch_add(&m->arrived, 1);
    for (int wait = 0; atomic_load(&m->arrived) < m->expected; wait++) {
        if (wait > 200000 || atomic_load(&m->missed)) {
            atomic_store(&m->missed, true);
            return;
        }
        if (wait < 1000)
            sched_yield();
        else
            sleep_microseconds(100);
    }
}

static void check_meeting(const shb_context *context, uint32_t threads) {
    meeting m = {.expected = threads};
    shb_parallel_for(context, meet, &m, threads);
    CHECK_INT(atomic_load(&m.arrived), threads);
    CHECK(!atomic_load(&m.missed));
}

TEST(all_threads_of_the_pool_work) {
    for (uint32_t threads = 2; threads <= 8; threads++) {
        shb_context *context = test_context(threads, SHB_ISA_BEST);
        for (int call = 0; call < 20; call++)
            check_meeting(context, threads);
        shb_context_destroy(context);
    }
}

TEST(sleeping_threads_wake_for_every_call) {
    const uint32_t threads = 4;
    shb_context *context = test_context(threads, SHB_ISA_BEST);
    test_random random = {1};
    for (int call = 0; call < 100; call++) {
        sleep_microseconds((long)random_below(&random, 2000));
        check_meeting(context, threads);
    }
    shb_context_destroy(context);
}

static void sleep_at_last_task(void *arg, size_t index) {
    meet(arg, index);
    if (index == 1)
        sleep_microseconds(2000);
}

TEST(caller_waits_for_slow_tasks) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    for (int call = 0; call < 20; call++) {
        meeting m = {.expected = 2};
        shb_parallel_for(context, sleep_at_last_task, &m, 2);
        CHECK_INT(atomic_load(&m.arrived), 2);
    }
    shb_context_destroy(context);
}

static void read_signal_mask(void *arg, size_t index) {
    sigset_t mask;
    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    ((int *)arg)[index] = sigismember(&mask, SIGUSR1);
    meeting *m = *(meeting **)(void *)((int *)arg + 4);
    meet(m, index);
}

TEST(workers_leave_signals_to_the_host) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    struct {
        int blocked[4];
        meeting *m;
    } job = {{0}, &(meeting){.expected = 2}};
    shb_parallel_for(context, read_signal_mask, &job, 2);
    CHECK_INT(job.blocked[0] + job.blocked[1], 1);
    sigset_t mask;
    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    CHECK(!sigismember(&mask, SIGUSR1));
    shb_context_destroy(context);
}

typedef struct host_scheduler {
    unsigned calls;
    size_t last_count;
} host_scheduler;

static void run_backwards(void *user, shb_task_fn *task, void *arg, size_t count) {
    host_scheduler *host = user;
    host->calls++;
    host->last_count = count;
    for (size_t i = count; i-- > 0;)
        task(arg, i);
}

TEST(host_scheduler_takes_the_place_of_the_pool) {
    test_allocator state = {0};
    host_scheduler host = {0};
    shb_context_desc desc = {.allocator = test_allocator_hooks(&state),
                             .parallel_for = run_backwards,
                             .parallel_user = &host};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    CHECK_INT(state.live, 1);
    CHECK(context->pool == NULL);
    CHECK_INT(shb_context_threads(context), 8);
    unsigned visits[9] = {0};
    shb_parallel_for(context, count_visit, visits, 8);
    CHECK_INT(host.calls, 1);
    CHECK_INT(host.last_count, 8);
    for (int i = 0; i < 9; i++)
        CHECK_INT(visits[i], i < 8);
    shb_context_destroy(context);
    desc.threads = 3;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    CHECK_INT(shb_context_threads(context), 3);
    shb_context_destroy(context);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ADDRESS_SPACE_IS_HUGE 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ADDRESS_SPACE_IS_HUGE 1
#endif
#endif

static unsigned long pages_in_use(void) {
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0;
    if (fscanf(file, "%lu", &pages) != 1)
        pages = 0;
    fclose(file);
    return pages;
}

TEST(pool_goes_on_with_fewer_threads_than_asked_for) {
    const unsigned long pages = pages_in_use();
#ifdef ADDRESS_SPACE_IS_HUGE
    test_skip("needs a limit on the address space");
    return;
#endif
    if (!pages) {
        test_skip("needs the size of the address space");
        return;
    }
    /* Room for some stacks, not for 256 of them. */
    struct rlimit before, tight;
    getrlimit(RLIMIT_AS, &before);
    tight = before;
    tight.rlim_cur = (rlim_t)pages * 4096 + (rlim_t)(100 << 20);
    setrlimit(RLIMIT_AS, &tight);
    const shb_context_desc desc = {.threads = 256};
    shb_context *context = NULL;
    const shb_result result = shb_context_create(&desc, &context);
    setrlimit(RLIMIT_AS, &before);
    CHECK_INT(result, SHB_OK);
    const uint32_t threads = shb_context_threads(context);
    CHECK(threads >= 1 && threads < 256);
    check_meeting(context, threads);
    shb_context_destroy(context);
}
