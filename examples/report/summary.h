/* What the rows say together: means over scenes, the Pareto front, the recommendation. */
#ifndef REPORT_SUMMARY_H
#define REPORT_SUMMARY_H

#include "rows.h"

/* The name of scene and light in rows that are means. */
#define REPORT_ALL "all"

/* A measure of error; smaller is better, NaN: the row has none. */
typedef double report_error_fn(const report_row *row);

double report_wrong_away(const report_row *row); /* wrong fragments away from boundaries, ppm */
double report_wrong(const report_row *row);      /* all wrong fragments, ppm */
double report_rms(const report_row *row);
double report_dissimilarity(const report_row *row); /* 1 - structural similarity */

bool report_is_hard(const report_row *row);

/* Whether it is one of those that report_add_means adds. */
bool report_is_mean(const report_row *row);

/* Whether rows are of one scene, light and kind. */
bool report_share_pair(const report_row *a, const report_row *b);

/* Adds for each filter, method and map size that every scene and light of its kind has one row of
 * means: times are geometric means, everything else arithmetic ones over the rows that have it.
 * False: out of memory. */
bool report_add_means(report_rows *rows);

/* Whether a row is on the Pareto front of its scene, light and kind (hard or soft): none of the
 * others is as fast and as right, and better in one of the two. Here and below the more right of
 * two rows with the same error is the one with fewer wrong fragments in all. */
bool report_is_on_front(const report_rows *rows, const report_row *row, report_error_fn *error_of);

/* The fastest means whose error is at most the limit, or rather the one with the smallest error of
 * those that take up to a tenth longer, as times differ by as much from run to run; NULL: none. */
const report_row *report_fastest(const report_rows *rows, bool hard, report_error_fn *error_of,
                                 double limit);

/* The means with the smallest error, the fastest of them; NULL: none. */
const report_row *report_most_exact(const report_rows *rows, bool hard, report_error_fn *error_of);

/* Pairs of scene and light that have rows of a kind, without the means. */
size_t report_count_pairs(const report_rows *rows, bool hard);

#endif
