/* The printed tables. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include "session.h"

/* What rows of soft shadows have beside the times of visibility. */
typedef struct bench_soft {
    double map_seconds, shade_seconds;
    double ratio, paper;    /* overall time over the receiver plane's, here and in the paper; 0:
                               the paper has none */
    double rms, similarity; /* against the truth of the area light */
} bench_soft;

typedef struct bench_row {
    char stage[48];
    char scene[48];
    uint64_t triangles;
    uint32_t size;
    shb_isa isa;
    uint32_t threads;
    bench_times times;
    double items; /* what the times are divided by: triangles or fragments */
    bool by_fragment;
    double texels; /* written by draws, asked by visibility, of map and picture by others */
    double bytes;  /* that the stage must move at least; 0: not told */
    double limit_seconds;
    bench_times scalar;    /* of the reference; 0: not measured */
    double measured, goal; /* of goals and ratios; goal 0: none */
    bench_soft soft;
} bench_row;

/* The machine, and the names of columns when tab-separated. */
void report_begin(bench_session *session);

/* One row of stages; a heading goes before the first one and wherever the scene changes. */
void report_stage(bench_session *session, const bench_row *row);

/* Before goals or ratios. */
void report_heading(bench_session *session, const char *heading);

/* One row of goals or ratios, whose times are those of the first of a pair; unit: what follows the
 * goal; least: of the least times. at_least: larger values reach the goal. */
void report_goal(bench_session *session, const bench_row *row, const char *unit, double least,
                 bool at_least);

/* Before rows of soft shadows, and one of them. */
void report_soft_heading(bench_session *session, const char *heading);
void report_soft(bench_session *session, const bench_row *row);

#endif
