/* Filters: each turns receiver planes and a map into visibility. */
#ifndef SHADOWBIAS_FILTER_H
#define SHADOWBIAS_FILTER_H

#include "shadowbias/bias.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_map shb_map;
typedef struct shb_filter shb_filter;

typedef struct shb_filter_args {
    size_t count; /* 1 .. SHB_BATCH */
    const shb_filter *filter;
    const shb_map *map;
    const shb_map_info *info;
    const shb_receivers *receivers;
    float *visibility; /* out: 0 shadowed .. 1 lit; SHB_BATCH elements, 64-byte aligned */
} shb_filter_args;

/* Works on the whole batch; must be thread-safe and may not fail. A tap outside the map is lit. */
typedef void shb_filter_fn(const shb_filter_args *args);

struct shb_filter {
    const char *name;
    shb_filter_fn *filter;
    float params[SHB_PARAMS_MAX];
    const void *user; /* for filters of your own; must outlive the use of the value */
};

/* "hard": one tap, the texel that holds the fragment (Williams 1978). Shadowed where the stored
 * depth is nearer than min(ref, far depth); equal is lit. */
shb_filter shb_filter_hard(void);

/* A filter by its text form, as shb_bias_parse. */
shb_result shb_filter_parse(const char *text, shb_filter *filter);

/* The stored depths at count texels, canonical (smaller is nearer); the far depth outside the map.
 * For filters of your own. */
void shb_map_fetch(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                   float *depth);

#ifdef __cplusplus
}
#endif

#endif
