/* Tables and figures of papers, measured again: what all of them share. Times are processor time
 * of one thread; a graphics card's lie beside them as ratios only. */
#ifndef REPORT_PAPER_H
#define REPORT_PAPER_H

#include "line_chart.h"

#include "scenes.h"
#include "soft_work.h"

/* What the papers' parts write to. */
typedef struct paper_output {
    shb_context *single, *several;
    bool quick;
    FILE *table, *section;
} paper_output;

/* A method within a group of rows, whose first one the others are measured beside. */
typedef struct paper_case {
    const char *method, *bias;
    const char *filter; /* NULL: no shadow at all */
    double paper; /* overall time over that of the group's first, in the paper; 0: not there */
} paper_case;

typedef struct paper_row {
    const char *group, *method;
    uint32_t map_size;
    double map_ms, camera_ms, shade_ms;
    double ratio, paper; /* overall times over those of the group's first; paper 0: not there */
    double rms, ssim;    /* NaN: not judged */
} paper_row;

/* A group over one frame of output->single's: count rows, in the order of the cases. */
shb_result paper_measure(const paper_output *output, const measure_frame *frame,
                         scene_light_kind light, uint32_t map_size, const char *group,
                         const paper_case *cases, size_t count, paper_row *rows);

/* One row beside the group's first. */
shb_result paper_compare(const paper_output *output, soft_work *work, soft_work *beside,
                         paper_row *row);

/* The rows as a table of the page and lines of the file. what: "Dou et al. 2014, table 1"; setting:
 * a sentence on the scene; why: how the ratios differ from the paper's, and for what reason. */
void paper_write_rows(const paper_output *output, const char *what, const char *setting,
                      const paper_row *rows, size_t count, const char *why);

/* The names of the file's columns. */
void paper_write_head(FILE *table);

/* A figure of overall times: groups of line_count rows each, one group a step. */
void paper_write_chart(const paper_output *output, const char *title, const char *step_axis,
                       const char *const *steps, size_t step_count, const paper_row *rows,
                       size_t line_count);

/* A built-in scene and what its camera sees, for output->single. frame must not move. False, and a
 * line on stderr, if something fails; both are to be closed in any case. */
bool paper_open(const paper_output *output, const char *name, const uint32_t size[2],
                example_scene **scene, measure_frame *frame);

/* The papers' parts: each measures and writes its tables. False, and a line on stderr, if something
 * fails. */
bool paper_dou(const paper_output *output);
bool paper_ehm(const paper_output *output);
bool paper_layers(const paper_output *output);
bool paper_thesis(const paper_output *output);

#endif
