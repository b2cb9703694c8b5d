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

/* How a form of text emphasises. */
typedef struct verdict_marks {
    const char *begin, *end;
} verdict_marks;

typedef struct verdict {
    const char *intent, *other_intent;
    const report_row *choice, *other; /* of means; NULL: there is none */
    char rule[320];                   /* by which they were chosen */
} verdict;

/* For hard or for soft shadows. */
verdict report_find_verdict(const report_rows *rows, bool hard);

/* A sentence: "For hard shadows: exact-lists, map of 512: 7.6 ms a picture, ..." */
void report_write_choice(FILE *stream, const char *intent, const report_row *choice,
                         verdict_marks marks);

/* A card of HTML; nothing without means of that kind. */
void report_write_verdict(FILE *stream, const report_rows *rows, bool hard);

#endif
