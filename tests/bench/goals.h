/* What the library has set itself, beside what this run measures. */
#ifndef BENCH_GOALS_H
#define BENCH_GOALS_H

#include "report.h"

/* Times of one thread, for each instruction set that the options allow. */
bool goals_measure(bench_session *session);

/* Two pieces of work by turns, and two single times. */
bool ratios_measure(bench_session *session);

/* One piece of work, which has one thread, as a row whose goal is in this unit, so many of which
 * are a second. */
bool goals_report_time(bench_session *session, bench_work work, const char *unit, double scale,
                       bench_row *row);

#endif
