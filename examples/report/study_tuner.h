/* The tuner's results as a table on the terminal, a file and a section of the page. */
#ifndef REPORT_STUDY_TUNER_H
#define REPORT_STUDY_TUNER_H

#include "study.h"

extern const report_study report_study_tuner;

/* Tunes every method for one scene, which text names as scene_open takes it, and both its lights;
 * prints a table of each and writes all of them to tuner.tsv in the report's directory. False, and
 * a line on stderr, if something fails. */
bool report_tune(shb_context *context, const report_options *options, const char *text);

#endif
