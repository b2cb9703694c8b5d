/* Soft shadows: the tables of Ehm et al. 2015 on a scene of our own, and times with a goal. */
#ifndef BENCH_SOFT_SHADOWS_H
#define BENCH_SOFT_SHADOWS_H

#include "report.h"

/* Time and error of filters with several methods of bias, each beside the receiver plane's. */
bool soft_measure_tables(bench_session *session);

/* Nanoseconds a fragment of one thread. */
bool soft_measure_goals(bench_session *session);

#endif
