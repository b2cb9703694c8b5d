/* The best that a method can do in a case. */
#ifndef STABILITY_TUNE_H
#define STABILITY_TUNE_H

#include "stage.h"

/* Errors of a method with default parameters. */
shb_result stability_measure(stability_stage *stage, const listed_method *method,
                             shb_errors *errors);

/* The first parameter of a method for the fewest wrong fragments (tuning_fewest_wrong), starting
 * from errors, those of the default. */
shb_result stability_tune(stability_stage *stage, const listed_method *method, shb_errors *errors);

#endif
