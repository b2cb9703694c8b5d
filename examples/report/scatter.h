/* Figures: time against error, both logarithmic, as SVG. */
#ifndef REPORT_SCATTER_H
#define REPORT_SCATTER_H

#include "methods.h"
#include "summary.h"

#include <stdio.h>

typedef struct report_scatter {
    const char *title;
    const char *axis; /* what the error is, with its unit */
    report_error_fn *error_of;
    const report_row *pair; /* whose scene, light and kind, hard or soft, is shown */
    bool alone;             /* a file of its own, with its colours */
} report_scatter;

/* Marks are shapes by family of methods, larger for larger maps; the Pareto front is a line, and
 * its methods are named where there is room. Errors of 0 have a line of their own below the axis.
 */
void report_scatter_write(FILE *stream, const report_rows *rows, const report_scatter *scatter);

/* The mark of a family about a point; r is half its size. */
void report_scatter_shape(FILE *stream, report_family family, double x, double y, double r);

#endif
