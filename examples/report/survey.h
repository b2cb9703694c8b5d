/* The whole comparison, one group of rows after the other. */
#ifndef REPORT_SURVEY_H
#define REPORT_SURVEY_H

#include "rows.h"

#include "shadowbias/context.h"

#define REPORT_OPERANDS_MAX 64

typedef struct report_options {
    const char *operands[REPORT_OPERANDS_MAX + 1]; /* scenes of the user, instead of the report's
                                                      own; NULL ends them */
    const char *directory;                         /* of the report */
    const char *meshes;                            /* directory of further OBJ files */
    uint32_t threads;                              /* 0: all */
    bool quick;
    bool fresh;          /* forget rows that are there already */
    uint32_t limit_ppm;  /* of false shadow, for the tuner */
    uint32_t tuned_size; /* of the map that the tuner is for; 0: 1024 */
} report_options;

/* The settings that rows must share to be compared: size of the picture, runs, threads,
 * instruction set, processor. */
void report_settings(const report_options *options, const shb_context *context, char *text,
                     size_t size);

/* Width and height of the pictures, pixels. */
const uint32_t *report_picture_size(const report_options *options);

/* Measures everything that the options ask for and is not in rows, and appends it to the file as
 * soon as it is there. False, and a line on stderr, if something fails. */
bool report_survey(shb_context *context, const report_options *options, const char *settings,
                   const char *path, report_rows *rows);

#endif
