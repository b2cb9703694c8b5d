#if defined(__linux__)
#define _GNU_SOURCE /* sched_setaffinity */
#include <sched.h>
#endif

#include "machine.h"

#include "timing.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool machine_pin_thread(void) {
#if defined(__linux__)
    const int processor = sched_getcpu();
    cpu_set_t set;
    CPU_ZERO(&set);
    if (processor < 0)
        return false;
    CPU_SET((size_t)processor, &set);
    return sched_setaffinity(0, sizeof set, &set) == 0;
#else
    return false;
#endif
}

/* A million additions, each of which needs the sum before it. The empty assembly keeps the
 * compiler from adding them up. */
#define ADD                                                                                        \
    sum += step;                                                                                   \
    __asm__ volatile("" : "+r"(sum));
#define ADD_10 ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD
static void add_in_a_chain(uint64_t step) {
    uint64_t sum = step;
    for (int i = 0; i < 100000; i++) {
        ADD_10
    }
}

static double measure_cycles_per_second(void) {
    double best = 1;
    for (int run = 0; run < 20; run++) {
        const double start = bench_seconds(BENCH_CLOCK_THREAD);
        add_in_a_chain((uint64_t)run);
        const double seconds = bench_seconds(BENCH_CLOCK_THREAD) - start;
        best = seconds < best ? seconds : best;
    }
    return 1e6 / best;
}

typedef float line __attribute__((vector_size(64)));

static void store_lines(line *lines, size_t count) {
    for (size_t i = 0; i < count; i++) {
        lines[i] = (line){1};
        __asm__ volatile("" ::: "memory");
    }
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) static void store_wide_lines(line *lines, size_t count) {
    const line value = {1};
    for (size_t i = 0; i < count; i++)
        lines[i] = value;
}
#endif

void machine_store_lines(void *buffer, size_t size) {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f")) {
        store_wide_lines(buffer, size / sizeof(line));
        return;
    }
#endif
    store_lines(buffer, size / sizeof(line));
}

static void set_bytes(void *buffer, size_t size) {
    memset(buffer, 0x3f, size);
}

static void copy_half(void *buffer, size_t size) {
    memcpy(buffer, (char *)buffer + size / 2, size / 2);
}

/* Bytes a second, the best run of a few. */
static double measure_bandwidth(void (*touch)(void *buffer, size_t size), void *buffer,
                                size_t size) {
    const uint32_t repeats = size < 8u << 20 ? 8 : 1;
    double best = 1e9;
    for (int run = 0; run < 8; run++) {
        const double start = bench_seconds(BENCH_CLOCK_THREAD);
        for (uint32_t i = 0; i < repeats; i++)
            touch(buffer, size);
        const double seconds = (bench_seconds(BENCH_CLOCK_THREAD) - start) / repeats;
        best = seconds < best ? seconds : best;
    }
    return (double)size / best;
}

bool machine_measure(size_t sizes, bench_machine *machine) {
    const size_t largest = (size_t)1 << (20 + 2 * (sizes - 1));
    void *buffer = aligned_alloc(64, largest);
    if (!buffer)
        return false;
    memset(buffer, 0, largest);
    machine->cycles_per_second = measure_cycles_per_second();
    machine->bandwidth_count = sizes;
    for (size_t i = 0; i < sizes; i++) {
        const size_t bytes = (size_t)1 << (20 + 2 * i);
        machine->bandwidths[i] =
            (machine_bandwidth){.bytes = bytes,
                                .set = measure_bandwidth(set_bytes, buffer, bytes),
                                .store = measure_bandwidth(machine_store_lines, buffer, bytes),
                                .copy = measure_bandwidth(copy_half, buffer, bytes)};
    }
    free(buffer);
    return true;
}

/* The measured size nearest to so many bytes, on a scale of factors. */
static const machine_bandwidth *nearest_bandwidth(const bench_machine *machine, double bytes) {
    size_t i = 0;
    while (i + 1 < machine->bandwidth_count && bytes > 2.0 * (double)machine->bandwidths[i].bytes)
        i++;
    return &machine->bandwidths[i];
}

double machine_store_seconds(const bench_machine *machine, double bytes) {
    return bytes / nearest_bandwidth(machine, bytes)->store;
}

double machine_copy_seconds(const bench_machine *machine, double bytes) {
    return bytes / nearest_bandwidth(machine, bytes)->copy;
}
