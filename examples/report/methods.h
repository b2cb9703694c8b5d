/* What the report compares: bias methods, each with what its map keeps, and filters. */
#ifndef REPORT_METHODS_H
#define REPORT_METHODS_H

#include "shadowbias/filter.h"

/* Kinds of methods, which share a mark in figures. */
typedef enum report_family {
    REPORT_OFFSETS = 0, /* a constant or an offset of depth or point */
    REPORT_PLANES,      /* the receiver's plane at the texel */
    REPORT_LAYERS,      /* the map keeps other depths */
    REPORT_EXACT,       /* the occluder is asked */
    REPORT_FAMILIES
} report_family;

typedef struct report_method {
    char name[64];   /* the bias method, with what the map keeps for the exact one */
    char filter[64]; /* text form of the filter */
    shb_bias bias;
    shb_filter with;
    shb_occluders occluders;
} report_method;

typedef struct report_methods {
    report_method *methods;
    size_t count;
} report_methods;

/* Every bias method with the hard filter, whose truth the rays know. NULL methods: out of memory.
 * To be released with free. */
report_methods report_list_methods(void);

report_family report_family_of(const char *method);
const char *report_family_name(report_family family);

#endif
