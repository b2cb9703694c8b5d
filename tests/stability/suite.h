/* Runs cases and methods. */
#ifndef STABILITY_SUITE_H
#define STABILITY_SUITE_H

#include "rows.h"
#include "tune.h"

typedef struct stability_options {
    const char *method;  /* only this one, or NULL */
    const char *subject; /* only this case, or NULL */
    uint32_t box;        /* texels on a side of a filter, 0: a single one, if not pcss: */
    uint32_t pcss;       /* texels across the widest kernel of soft shadows, or 0 */
    uint32_t map_size;   /* of maps whose case does not name one, 0: STABILITY_MAP_SIZE */
    bool named;          /* fragments by triangle and weights */
    bool quick;
    bool tsv;
    const char *directory; /* for files, or NULL */
} stability_options;

bool stability_wants_method(const stability_options *options, const char *name);
bool stability_wants_case(const stability_options *options, const stability_case *c);

/* The stage of a case, with the frame of the options; to be closed even where it fails. */
shb_result stability_open(shb_context *context, const stability_options *options,
                          const stability_case *c, uint32_t reach, stability_stage *stage);

/* Does something for every wanted case, until it fails. */
typedef bool stability_case_fn(shb_context *context, const stability_options *options,
                               const stability_case *c, void *user);
bool stability_each_case(shb_context *context, const stability_options *options,
                         stability_case_fn *run, void *user);

/* Measures everything that the options ask for. False, and a line on stderr, if something fails. */
bool stability_run(shb_context *context, const stability_options *options, stability_rows *rows);

#endif
