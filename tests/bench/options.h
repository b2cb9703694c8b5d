/* The command line of the benchmark. */
#ifndef BENCH_OPTIONS_H
#define BENCH_OPTIONS_H

#include "shadowbias/context.h"

typedef struct bench_options {
    const char *only;   /* a group of stages or one stage; NULL: all */
    const char *scene;  /* name or file; NULL: all */
    const char *folder; /* of OBJ files */
    const char *isa_name;
    shb_isa isa;
    uint32_t threads;
    uint32_t size; /* 0: all */
    bool tsv, quick, pin, help;
} bench_options;

/* False when the program is to end with *exit_code; the reason has been printed. */
bool options_read(int argc, char **argv, bench_options *options, int *exit_code);

/* True if a group (depth, visibility, ...), or a stage of that group, is to be measured. stage
 * NULL: any stage of the group. */
bool options_want(const bench_options *options, const char *group, const char *stage);

/* Map sizes to measure; returns how many. */
size_t options_sizes(const bench_options *options, const uint32_t **sizes);

#endif
