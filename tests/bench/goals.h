/* What the library has set itself, beside what this run measures. */
#ifndef BENCH_GOALS_H
#define BENCH_GOALS_H

#include "report.h"

/* Times of one thread, for each instruction set that the options allow. */
bool goals_measure(bench_session *session);

/* Two pieces of work by turns, and two single times. */
bool ratios_measure(bench_session *session);

#endif
