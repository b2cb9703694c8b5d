/* A group of rows: all methods with one scene, light and map size. */
#ifndef REPORT_GROUP_H
#define REPORT_GROUP_H

#include "methods.h"
#include "rows.h"
#include "stage.h"

#define REPORT_RUNS_MAX 64

typedef struct report_group {
    const char *scene; /* its name */
    report_light light;
    uint32_t map_size;
    const report_methods *methods;
    uint32_t runs, samples; /* 1 .. REPORT_RUNS_MAX; rays a fragment for the truth of a square */
    const char *settings;   /* for the rows */
    const char *pictures;   /* directory for PNG files, or NULL */
} report_group;

/* The key of a row, everything else 0. */
report_row report_group_key(const report_group *group, const report_method *method);

/* Measures all methods on the group's scene and writes the pictures. The methods take turns, as
 * often as there are runs, so that whatever disturbs the machine for a while meets all of them;
 * times are medians. rows has room for one row a method. */
shb_result report_group_measure(const report_group *group, report_stage *stage, report_row *rows);

#endif
