/* Repeating work and timing it. */
#ifndef EXAMPLES_TIMING_H
#define EXAMPLES_TIMING_H

#include "shadowbias/base.h"

/* A piece of work that can be done again and again. */
typedef struct bench_work {
    shb_result (*run)(void *state);
    void *state;
} bench_work;

/* Work of the calling thread alone is timed by that thread's processor time, which other programs
 * disturb less; work of several threads by the clock on the wall. */
typedef enum bench_clock { BENCH_CLOCK_THREAD = 0, BENCH_CLOCK_WALL } bench_clock;

double bench_seconds(bench_clock clock);

typedef struct bench_times {
    double median, least; /* seconds a run */
} bench_times;

/* How many samples to take: at least so many, and more as long as they took less than this time. */
typedef struct bench_plan {
    uint32_t runs;
    double seconds;
} bench_plan;

/* The median and the least of all samples. A sample of very short work is many runs in a row. One
 * more run goes first, to warm up. */
shb_result bench_measure(bench_work work, bench_clock clock, bench_plan plan, bench_times *times);

typedef struct bench_comparison {
    bench_times first, second;
    double ratio;       /* first / second: the median over pairs */
    double least_ratio; /* of the least times */
} bench_comparison;

/* Both pieces of work by turns, so that each pair of samples sees the same machine. */
shb_result bench_compare(bench_work first, bench_work second, bench_clock clock, bench_plan plan,
                         bench_comparison *comparison);

#endif
