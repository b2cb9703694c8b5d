/* Percentage-closer filtering in every case, judged where the kernel holds no silhouette: there the
 * truth is the same for all taps, and what differs from it is the bias's fault. */
#ifndef STABILITY_BOXES_H
#define STABILITY_BOXES_H

#include <stdio.h>

#include "suite.h"

/* Measures boxes of options->box x options->box texels by every method that the filter serves, each
 * with its default parameters: a row for each case and method if options->tsv, and the means over
 * cases. False, and a line on stderr, if something fails. */
bool stability_run_boxes(shb_context *context, const stability_options *options, FILE *stream);

#endif
