/* Studies: questions of their own beside the survey. Each writes a table as NAME.tsv and a section
 * of the page as NAME.html into the report's directory, from where the page takes the sections. */
#ifndef REPORT_STUDY_H
#define REPORT_STUDY_H

#include "survey.h"

#include <stdio.h>

typedef struct report_study {
    const char *name, *title;
    /* Measures, and writes the table and what stands below the title. False, and a line on stderr,
     * if something fails. */
    bool (*run)(shb_context *context, const report_options *options, FILE *table, FILE *section);
    bool own_scenes; /* it has scenes of its own and does nothing for those of the user */
} report_study;

/* Runs all studies; those that the report has of the same settings stay unless the options are for
 * fresh ones. False, and a line on stderr, if something fails. */
bool report_studies_run(shb_context *context, const report_options *options, const char *settings);

/* All sections that are there, for the page. */
void report_studies_write(FILE *stream, const char *directory);

#endif
