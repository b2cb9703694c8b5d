/* Statistics of repeated measurements. */
#ifndef EXAMPLES_STATISTICS_H
#define EXAMPLES_STATISTICS_H

#include <stddef.h>

#define STATISTICS_MAX 256

/* Of 1 .. STATISTICS_MAX values; an even count gives the mean of the two in the middle. */
double statistics_median(const double *values, size_t count);

/* The smallest of at least one value. */
double statistics_least(const double *values, size_t count);

/* The median of first[i] / second[i]: of pairs that were measured one right after the other, so
 * that whatever disturbs a machine for a while meets both of a pair. */
double statistics_median_ratio(const double *first, const double *second, size_t count);

#endif
