/* Runs cases and methods. */
#ifndef STABILITY_SUITE_H
#define STABILITY_SUITE_H

#include "rows.h"
#include "tune.h"

typedef struct stability_options {
    const char *method;  /* only this one, or NULL */
    const char *subject; /* only this case, or NULL */
    bool quick;
    bool tsv;
    const char *directory; /* for files, or NULL */
} stability_options;

bool stability_wants_method(const stability_options *options, const char *name);
bool stability_wants_case(const stability_options *options, const stability_case *c);

/* Measures everything that the options ask for. False, and a line on stderr, if something fails. */
bool stability_run(shb_context *context, const stability_options *options, stability_rows *rows);

#endif
