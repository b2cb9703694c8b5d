/* What the report compares: bias methods, each with what its map keeps, and filters. */
#ifndef REPORT_METHODS_H
#define REPORT_METHODS_H

#include "rows.h"

#include "shadowbias/filter.h"

/* Kinds of methods, or of filters for soft shadows, which share a mark in figures. */
typedef enum report_family {
    REPORT_OFFSETS = 0, /* a constant or an offset of depth or point; taps of a fixed size */
    REPORT_PLANES,      /* the receiver's plane at the texel; taps as wide as the penumbra */
    REPORT_LAYERS,      /* the map keeps other depths; moments */
    REPORT_EXACT,       /* the occluder is asked; texels before the light */
    REPORT_FAMILIES
} report_family;

typedef struct report_method {
    char name[64];   /* the bias method, with what the map keeps for the exact one */
    char filter[64]; /* text form of the filter, without the light's width */
    shb_bias bias;
    shb_occluders occluders;
} report_method;

typedef struct report_methods {
    report_method *methods;
    size_t count;
} report_methods;

/* Hard: every bias method with the hard filter. Soft: every other filter with a bias of planes and,
 * where it serves that, the exact one; a simple and an elaborate filter with other methods, too.
 * NULL methods: out of memory. To be released with free. */
report_methods report_list_methods(bool soft);

/* The filter; those that know of lights are told this width. */
shb_filter report_method_filter(const report_method *method, double light_width);

report_family report_family_of(const report_row *row);
const char *report_family_name(report_family family, bool hard);

#endif
