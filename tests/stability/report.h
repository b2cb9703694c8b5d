/* Tables of results. */
#ifndef STABILITY_REPORT_H
#define STABILITY_REPORT_H

#include "rows.h"

#include <stdio.h>

/* Every row, tab-separated below a line of names; at the end the means of each method, the name of
 * the mean as group and case. */
void stability_print_tsv(FILE *stream, const stability_rows *rows);

/* Shares of certain answers, case by case, in the same way: ppm of unsure fragments, and wrong
 * answers. */
void stability_print_certain(FILE *stream, const stability_rows *rows);

/* The means and the worst case of each method, and of certain answers, for people. */
void stability_print_means(FILE *stream, const stability_rows *rows);

#endif
