/* The best that a method can do in a case. */
#ifndef STABILITY_TUNE_H
#define STABILITY_TUNE_H

#include "stage.h"

/* Errors of a method with default parameters. */
shb_result stability_measure(stability_stage *stage, const listed_method *method,
                             shb_errors *errors);

/* Searches the first parameter of a method for the fewest wrong fragments, starting from
 * errors, those of the default: eight values by powers of eight about it, then between the best and
 * its neighbours. Never worse than it started. */
shb_result stability_tune(stability_stage *stage, const listed_method *method, shb_errors *errors);

#endif
