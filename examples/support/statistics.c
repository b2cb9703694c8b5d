#include "statistics.h"

#include <stdlib.h>
#include <string.h>

static int compare_doubles(const void *a, const void *b) {
    const double first = *(const double *)a, second = *(const double *)b;
    return (first > second) - (first < second);
}

double statistics_median(const double *values, size_t count) {
    double sorted[STATISTICS_MAX];
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_doubles);
    return (sorted[(count - 1) / 2] + sorted[count / 2]) / 2;
}

double statistics_least(const double *values, size_t count) {
    double least = values[0];
    for (size_t i = 1; i < count; i++)
        least = values[i] < least ? values[i] : least;
    return least;
}

double statistics_median_ratio(const double *first, const double *second, size_t count) {
    double ratios[STATISTICS_MAX];
    for (size_t i = 0; i < count; i++)
        ratios[i] = first[i] / second[i];
    return statistics_median(ratios, count);
}
