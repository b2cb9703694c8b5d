/* Filters: each turns receiver planes and a map into visibility.
 *
 * A filter is a plain value of up to four functions, each of which may be NULL but the first:
 *   filter   compares its taps with the receiver plane
 *   exact    the same for methods that need occluders (SHB_NEEDS_OCCLUDERS): every tap asks the
 *            occluder that its texel keeps; NULL: the filter does not serve them
 *   prepare  what is made of a map before it is asked: a pyramid, moments
 *   release  frees that */
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
    float *visibility;    /* out: 0 shadowed .. 1 lit; SHB_BATCH elements, 64-byte aligned */
    const void *prepared; /* what prepare made of this map for this filter; NULL: nothing */
} shb_filter_args;

/* Works on the whole batch; must be thread-safe and may not fail. A tap outside the map is lit. The
 * function exact gets receivers that hold the positions and, unless the map keeps lists, the
 * normals as they came. */
typedef void shb_filter_fn(const shb_filter_args *args);

/* What a filter makes of a map before it is asked. Runs on the caller's thread and may use the
 * context's threads. bytes: what the result takes, for shb_map_info. On failure prepared and bytes
 * are untouched. */
typedef shb_result shb_filter_prepare_fn(const shb_map *map, const shb_filter *filter,
                                         void **prepared, size_t *bytes);
typedef void shb_filter_release_fn(const shb_map *map, void *prepared);

/* In shb_filter.needs beside SHB_NEEDS_NORMAL, _SCALE and _SLOPE: the filter is refused for maps
 * that shb_map_prepare was not called for; a filter without it does its work either way. */
enum { SHB_NEEDS_PREPARED = 32 };

struct shb_filter {
    const char *name;
    shb_filter_fn *filter;
    shb_filter_fn *exact;
    shb_filter_prepare_fn *prepare;
    shb_filter_release_fn *release;
    uint32_t needs; /* of the receivers, beside what the bias method needs: SHB_NEEDS_* */
    float params[SHB_PARAMS_MAX];
    const void *user; /* for filters of your own; must outlive the use of the value */
};

/* What the taps of a filter compare the map with. */
typedef enum shb_taps {
    SHB_TAPS_PLANE = 0, /* the receiver plane at the tap's texel: ref + m * step_x + n * step_y (the
                           delta bias of Ehm et al. 2015) */
    SHB_TAPS_OWN,       /* ref of the fragment's own texel everywhere: false shadow on any slope */
    SHB_TAPS_NAIVE /* for each tap anew, the light's ray through the texel's centre cut with the
                      fragment's plane in the world, less the same epsilon; needs normals. The
                      plane again, but for rounding and the limit of slopes; slow */
} shb_taps;

/* Taps on a disk that a filter may have. */
#define SHB_POISSON_MAX 256

/* "hard": one tap, the texel that holds the fragment (Williams 1978). Shadowed where the stored
 * depth is nearer than min(ref, far depth); equal is lit. */
shb_filter shb_filter_hard(void);

/* One built-in filter for tools: its default value and the names of its parameters. */
typedef struct shb_filter_method {
    const char *name;
    const char *summary;
    shb_filter (*make)(void);                /* with default parameters */
    const char *param_names[SHB_PARAMS_MAX]; /* in the order of shb_filter.params; NULL: none */
} shb_filter_method;

/* All built-in filters in the order above; never fails. count may be NULL. */
const shb_filter_method *shb_filter_methods(size_t *count);

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
