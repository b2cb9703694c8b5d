/* The recommendation, by rules that it states. */
#ifndef REPORT_VERDICT_H
#define REPORT_VERDICT_H

#include "rows.h"

#include <stdio.h>

/* The limits of the rules: wrong fragments per million away from boundaries; and how many times the
 * smallest distance from the true soft shadow a faster filter may have. */
#define REPORT_CLEAN_PPM 100
#define REPORT_ROUGH_PPM 1000
#define REPORT_SOFT_TIMES 1.5

/* One paragraph of HTML for hard or soft shadows; nothing without means of that kind. */
void report_write_verdict(FILE *stream, const report_rows *rows, bool hard);

#endif
