#include "timing.h"

#include "statistics.h"

#include <time.h>

/* Shorter samples than this would be those of the clock. */
#define SAMPLE_SECONDS 50e-6

double bench_seconds(bench_clock clock) {
    struct timespec now;
    clock_gettime(clock == BENCH_CLOCK_WALL ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Seconds a run of `repeats` runs in a row. */
static shb_result take_sample(bench_work work, bench_clock clock, uint32_t repeats,
                              double *seconds) {
    const double start = bench_seconds(clock);
    for (uint32_t i = 0; i < repeats; i++) {
        const shb_result result = work.run(work.state);
        if (result)
            return result;
    }
    *seconds = (bench_seconds(clock) - start) / repeats;
    return SHB_OK;
}

/* Warms up and finds how many runs make a sample. */
static shb_result warm_up(bench_work work, bench_clock clock, uint32_t *repeats, double *seconds) {
    shb_result result = take_sample(work, clock, 1, seconds);
    *repeats = 1;
    while (!result && *seconds * *repeats < SAMPLE_SECONDS && *repeats < 1u << 16) {
        *repeats *= 4;
        result = take_sample(work, clock, *repeats, seconds);
    }
    return result;
}

static bench_times summarize(const double *samples, size_t count) {
    return (bench_times){statistics_median(samples, count), statistics_least(samples, count)};
}

static bool wants_more(bench_plan plan, uint32_t count, double spent) {
    return count < plan.runs || (count < STATISTICS_MAX && spent < plan.seconds);
}

shb_result bench_measure(bench_work work, bench_clock clock, bench_plan plan, bench_times *times) {
    double samples[STATISTICS_MAX];
    uint32_t repeats;
    double seconds, spent = 0;
    shb_result result = warm_up(work, clock, &repeats, &seconds);
    uint32_t count = 0;
    while (!result && wants_more(plan, count, spent)) {
        result = take_sample(work, clock, repeats, &samples[count]);
        if (!result)
            spent += samples[count++] * repeats;
    }
    if (!result)
        *times = summarize(samples, count);
    return result;
}

shb_result bench_compare(bench_work first, bench_work second, bench_clock clock, bench_plan plan,
                         bench_comparison *comparison) {
    double firsts[STATISTICS_MAX], seconds[STATISTICS_MAX];
    uint32_t first_repeats, second_repeats;
    double warm, spent = 0;
    uint32_t count = 0;
    shb_result result = warm_up(first, clock, &first_repeats, &warm);
    if (!result)
        result = warm_up(second, clock, &second_repeats, &warm);
    while (!result && wants_more(plan, count, spent)) {
        result = take_sample(first, clock, first_repeats, &firsts[count]);
        if (!result)
            result = take_sample(second, clock, second_repeats, &seconds[count]);
        if (!result) {
            spent += firsts[count] * first_repeats + seconds[count] * second_repeats;
            count++;
        }
    }
    if (result)
        return result;
    comparison->first = summarize(firsts, count);
    comparison->second = summarize(seconds, count);
    comparison->ratio = statistics_median_ratio(firsts, seconds, count);
    comparison->least_ratio = comparison->first.least / comparison->second.least;
    return SHB_OK;
}
