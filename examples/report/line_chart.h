/* Figures of lines: positive values over a few steps, as SVG. */
#ifndef REPORT_LINE_CHART_H
#define REPORT_LINE_CHART_H

#include <stddef.h>
#include <stdio.h>

#define LINE_CHART_LINES_MAX 6

typedef struct chart_line {
    const char *name;
    const double *values; /* one a step */
} chart_line;

typedef struct line_chart {
    const char *title, *step_axis, *value_axis;
    const char *const *steps; /* their names */
    size_t step_count;        /* at least 2 */
    const chart_line *lines;
    size_t line_count; /* 1 .. LINE_CHART_LINES_MAX */
} line_chart;

/* Steps are evenly spaced, values logarithmic; lines differ by dashes and are named at their ends.
 */
void line_chart_write(FILE *stream, const line_chart *chart);

#endif
