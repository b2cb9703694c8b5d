#include "strict.h"

#include "context.h"

#include "kernels/raster.h"
#include "kernels/shade.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

enum { THREADS_MAX = 256, HOST_THREADS = 8, SENTENCE_MAX = 256 };

/* Volatile operands keep the compiler from answering in place of the processor. */
static bool rounds_to_nearest(void) {
    const volatile double one = 1, tiny = 0x1p-60;
    return one + tiny == one && one - tiny == one;
}

static bool keeps_subnormals(void) {
    const volatile float least_normal = FLT_MIN, subnormal = 0x1p-149f;
    return least_normal * 0.5f > 0 && subnormal * 0x1p60f > 0;
}

/* A square that ends just below half a unit in the last place: only a fused sum sees the rest. */
static bool does_not_contract(void) {
    const volatile double a = 1 + 0x1p-27, rounded = 1 + 0x1p-26;
    const volatile float b = 1 + 0x1p-13f, rounded_float = 1 + 0x1p-12f;
    return a * a - rounded == 0 && b * b - rounded_float == 0;
}

static bool evaluates_float_in_float(void) {
    const volatile float largest = FLT_MAX, two = 2;
    return isinf(largest * two / two);
}

static bool arithmetic_is_strict(void) {
    return rounds_to_nearest() && keeps_subnormals() && does_not_contract() &&
           evaluates_float_in_float();
}

static uint32_t processor_count(void) {
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : count > THREADS_MAX ? THREADS_MAX : (uint32_t)count;
}

static uint32_t wanted_threads(const shb_context_desc *desc) {
    if (desc->threads)
        return desc->threads;
    return desc->parallel_for ? HOST_THREADS : processor_count();
}

static shb_result check_desc(const shb_context *context, const shb_context_desc *desc) {
    if (!desc->allocator.alloc != !desc->allocator.free)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_context_create: desc.allocator.%s is NULL and the other is not",
                        desc->allocator.alloc ? "free" : "alloc");
    if (desc->threads > THREADS_MAX)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_context_create: desc.threads %lu exceeds %d",
                        (unsigned long)desc->threads, THREADS_MAX);
    if ((unsigned)desc->max_isa >= SHB_ISA_COUNT)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_context_create: desc.max_isa %d is not an instruction set",
                        (int)desc->max_isa);
    if (!arithmetic_is_strict())
        return shb_fail(context, SHB_ERROR_ARITHMETIC,
                        "shb_context_create: floating point is not IEEE round-to-nearest with "
                        "subnormals and without contraction");
    return SHB_OK;
}

shb_result shb_context_create(const shb_context_desc *desc, shb_context **context) {
    const shb_context_desc defaults = {0};
    if (!desc)
        desc = &defaults;
    shb_context made = {.log = desc->log, .log_user = desc->log_user};
    if (!context)
        return shb_fail(&made, SHB_ERROR_ARGUMENT, "shb_context_create: context is NULL");
    const shb_result result = check_desc(&made, desc);
    if (result)
        return result;

    made.allocator = desc->allocator.alloc ? desc->allocator : shb_default_allocator;
    made.parallel_for = desc->parallel_for;
    made.parallel_user = desc->parallel_user;
    made.threads = wanted_threads(desc);
    made.isa = shb_cpu_isa(desc->max_isa);
    made.kernels = shb_kernels_of(made.isa);
    made.shade_kernels = shb_shade_kernels_of(made.isa);
    shb_context *memory = shb_alloc(&made, 1, sizeof(made));
    if (!memory)
        return shb_fail(&made, SHB_ERROR_MEMORY, "shb_context_create: no memory for the context");
    if (!made.parallel_for && made.threads > 1) {
        made.pool = shb_pool_create(&made, made.threads);
        if (!made.pool) {
            shb_free(&made, memory);
            return shb_fail(&made, SHB_ERROR_MEMORY, "shb_context_create: no memory for %u threads",
                            (unsigned)made.threads);
        }
        made.threads = shb_pool_threads(made.pool);
    }
    *memory = made;
    pthread_mutex_init(&memory->topology_mutex, NULL);
    *context = memory;
    return SHB_OK;
}

void shb_context_destroy(shb_context *context) {
    if (!context)
        return;
    shb_context last = *context;
    shb_pool_destroy(&last, last.pool);
    pthread_mutex_destroy(&context->topology_mutex);
    shb_buffers_free(&last, sizeof(last.draw_scratch) / sizeof(shb_buffer), last.draw_scratch);
    shb_buffers_free(&last, sizeof(last.occluder_scratch) / sizeof(shb_buffer),
                     last.occluder_scratch);
    shb_buffers_free(&last, sizeof(last.list_scratch) / sizeof(shb_buffer), last.list_scratch);
    shb_buffers_free(&last, sizeof(last.sheet_scratch) / sizeof(shb_buffer), last.sheet_scratch);
    shb_buffers_free(&last, sizeof(last.topology_scratch) / sizeof(shb_buffer),
                     last.topology_scratch);
    shb_free(&last, context);
}

shb_isa shb_context_isa(const shb_context *context) {
    return context ? context->isa : SHB_ISA_SCALAR;
}

uint32_t shb_context_threads(const shb_context *context) {
    return context ? context->threads : 0;
}

void shb_parallel_for(const shb_context *context, shb_task_fn *task, void *arg, size_t count) {
    if (count > 1 && context->parallel_for)
        context->parallel_for(context->parallel_user, task, arg, count);
    else if (count > 1 && context->pool)
        shb_pool_run(context->pool, task, arg, count);
    else
        for (size_t i = 0; i < count; i++)
            task(arg, i);
}

shb_result shb_fail(const shb_context *context, shb_result result, const char *format, ...) {
    if (!context || !context->log)
        return result;
    char sentence[SENTENCE_MAX];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof(sentence), format, args);
    va_end(args);
    context->log(context->log_user, result, sentence);
    return result;
}
