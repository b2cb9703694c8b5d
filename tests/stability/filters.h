/* Percentage-closer filtering and soft shadows in every case, judged where the kernel holds no
 * silhouette: there the truth is the same for all taps, and what differs from it is the bias's
 * fault. */
#ifndef STABILITY_FILTERS_H
#define STABILITY_FILTERS_H

#include <stdio.h>

#include "suite.h"

/* Measures boxes of options->box x options->box texels, or soft shadows of a light whose kernels
 * reach options->pcss texels across, by every method that the filter serves, each with its default
 * parameters: a row for each case and method if options->tsv, and the means over cases. False, and
 * a line on stderr, if something fails. */
bool stability_run_filter(shb_context *context, const stability_options *options, FILE *stream);

#endif
