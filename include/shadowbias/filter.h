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

/* What is known of the triangles that points lie on: arrays of one element a point. The exact
 * method reads them where the map keeps triangles or lists and the filter is hard; nothing else
 * does. */
typedef struct shb_own_triangles {
    const uint32_t *ids; /* of the scene that the map was drawn from, as shb_draw counts them; NULL:
                            unknown. A point's own triangle does not shadow it */
    /* barycentric weights of the triangle's second and third corner: both or, NULL, neither. With
     * them the points are those that ids and weights name, in double: nothing is left to the
     * rounding of positions. Points are taken by batches of SHB_BATCH; a batch with a position that
     * is off by 2^-18 of the size of its corners' coordinates goes by positions alone */
    const float *weight_1;
    const float *weight_2;
} shb_own_triangles;

typedef struct shb_filter_args {
    size_t count; /* 1 .. SHB_BATCH */
    const shb_filter *filter;
    const shb_map *map;
    const shb_map_info *info;
    const shb_receivers *receivers;
    float *visibility;    /* out: 0 shadowed .. 1 lit; SHB_BATCH elements, 64-byte aligned */
    bool lifted;          /* the points were moved off their surface, for a smooth terminator */
    const void *prepared; /* what prepare made of this map for this filter; NULL: nothing */
    const shb_own_triangles *own; /* of the batch; NULL: unknown */
} shb_filter_args;

/* Works on the whole batch; must be thread-safe and may not fail. A tap outside the map is lit. The
 * function exact gets receivers that hold the positions and, unless the map keeps lists, the
 * normals as they came. */
typedef void shb_filter_fn(const shb_filter_args *args);

/* What a filter makes of a map before it is asked. Runs on the caller's thread and may use the
 * context's threads. *prepared is NULL, or what the same filter made of this map before, which may
 * be made over in place: what is not returned is released. A result of NULL counts as not prepared.
 * bytes: what the result takes, for shb_map_info. On failure prepared, what it points to and bytes
 * are untouched. */
typedef shb_result shb_filter_prepare_fn(const shb_map *map, const shb_filter *filter,
                                         void **prepared, size_t *bytes);

/* Frees what the filter prepared, which is not NULL. */
typedef void shb_filter_release_fn(const shb_map *map, void *prepared);

/* In shb_filter.needs beside SHB_NEEDS_NORMAL, _SCALE and _SLOPE: the filter is refused for maps
 * that shb_map_prepare was not called for; a filter without it does its work either way. */
enum {
    SHB_NEEDS_PREPARED = 32,
    SHB_NEEDS_SAMPLES = 64 /* the function exact asks the occluder that each texel keeps: it is
                              refused for maps that keep lists */
};

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

/* "pcf": the share of lit taps among the n x n texels nearest to the fragment: 1 tap is lit or not
 * as by the hard filter (Reeves, Salesin and Cook 1987). size: n, 1 .. 63, rounded and limited; in
 * world units (SHB_UNIT_WORLD; any other unit is texels) the width of the box, which each fragment
 * measures in its own texels. Default of tools: 5 texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_pcf(float size, shb_unit unit, shb_taps taps);

/* "pcf-smooth": the same n x n texels, n 2 .. 63, each by what a box of n - 1 texels centred on the
 * fragment covers of it, so that visibility changes without steps. 2 is bilinear. Default: 2
 * texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_pcf_smooth(float size, shb_unit unit, shb_taps taps);

/* "jittered": 16 taps in the cells of a grid of 4 x 4 over a box of size x size texels or world
 * units around the fragment, each at a place in its cell that a hash of the fragment's position
 * decides (Weiskopf and Ertl 2003, section 5). Default: 4 texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_jittered(float size, shb_unit unit, shb_taps taps);

/* "poisson": count taps, 1 .. SHB_POISSON_MAX, on a disk of the radius in texels or world units
 * around the fragment, turned by a hash of its position. The first tap is the fragment's own texel.
 * Default: 16 taps, 3 texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_poisson(float count, float radius, shb_unit unit, shb_taps taps);

/* Filters over the moments of distance. They are prepared (SHB_NEEDS_PREPARED) and serve methods
 * that ask no occluders. What they share:
 * - Distance grows evenly from 0 at the near plane to 1 at the far plane, or for a central
 *   projection at twice the largest distance from the light in the map if that is nearer.
 * - shb_map_prepare keeps the moments of a box of size x size texels around each texel, size being
 *   odd and 1 .. 63; between texels they are those of the mixed distributions. Outside the map the
 *   distance is 1.
 * - The receiver is the receiver plane at the fragment's own place. The answer is an upper bound of
 *   the part of the box that does not lie in front of it: exactly 1 where nothing does, but more
 *   than that part where several occluders lie one above the other (light bleeding).
 * - The distance error e of a depth follows from format, rounding and projection; its square is the
 *   least variance.
 * shb_map_prepare fails with SHB_ERROR_ARGUMENT for a parameter that is out of range. */
#define SHB_BLEEDING_MAX 0.99f

/* "variance": Chebyshev's inequality for mean and variance (Donnelly and Lauritzen 2006, eq. 5),
 * v / (v + d^2) at the distance d behind the mean and 1 before it. Bounds below bleeding, 0 ..
 * SHB_BLEEDING_MAX, become 0 and the rest spans 0 .. 1 (Lauritzen 2007, section 8.4.3). 8 bytes a
 * texel. Default of tools: size 5, bleeding 0.2. */
shb_filter shb_filter_variance(int size, float bleeding);

/* "exponential-variance": the smaller of the bounds for exp(positive x) and -exp(-negative x), x
 * being distance (Lauritzen and McCool 2008). Both exponents SHB_EXPONENT_MIN .. SHB_EXPONENT_MAX.
 * The receiver is taken nearer by one standard deviation of its own plane over the box. 16 bytes a
 * texel. Default: size 5, positive 80, negative 10, bleeding 0. */
#define SHB_EXPONENT_MIN 0.01f
#define SHB_EXPONENT_MAX 80.0f
shb_filter shb_filter_exponential_variance(int size, float positive, float negative,
                                           float bleeding);

/* "moments": the sharpest bound that four moments allow (Peters and Klein 2015, Hamburger's
 * problem), exact for one or two distances in the box. The moment bias is independent noise of
 * deviation e. The receiver is taken nearer by e and one standard deviation of its own plane over
 * the box. 16 bytes a texel. Default: size 5. */
shb_filter shb_filter_moments(int size);

/* The same three as percentage-closer soft shadows, whose blur grows with the penumbra (Yang, Dong,
 * Feng, Seidel and Kautz 2010; Peters, Muenstermann, Wetzstein and Klein 2017). light_size is the
 * width of a light parallel to the map, in the units of shb_filter_pcss.
 * 1. The search takes the kernel that the light spans at the nearest of all depths that could stand
 *    between, within whole cells of 8 x 8 texels or more. The blockers' mean distance is that of
 *    what lies in front of the receiver in the distribution that meets the bound.
 * 2. The answer is the bound over the kernel that the light spans at that distance.
 * A kernel mixes boxes of two sizes, 2^k texels wide, that lie a quarter of their width apart: its
 * second moments are those of a box of the width that is asked for, or a little less. It is at
 * least 2.4 texels wide, at most as wide as boxes that hold the map; where texels are not squares,
 * its square is the mean of both axes'. Fragments that nothing stands in front of, and those whose
 * search finds nothing, are lit: exactly 1. In the second stage the receiver is taken nearer by one
 * standard deviation of its own plane over the kernel, and a plane in the light stays exactly 1 as
 * long as the kernel lies on it, and that deviation is less than 3 / negative for
 * exponential-variance-soft. Blockers that lie far apart behind each other count as one at their
 * mean. shb_map_prepare takes 7/3 of the memory of the filters above. light_size above 0 and
 * finite. */

/* "variance-soft". Default of tools: light 0.05, bleeding 0.1. */
shb_filter shb_filter_variance_soft(float light_size, float bleeding);

/* "exponential-variance-soft": the exponential with the smaller bound tells the distance, too.
 * Default: light 0.05, positive 20, negative 40, bleeding 0. */
shb_filter shb_filter_exponential_variance_soft(float light_size, float positive, float negative,
                                                float bleeding);

/* "moments-soft". Default: light 0.05. */
shb_filter shb_filter_moments_soft(float light_size);

/* Filters by backprojection. They are prepared and serve methods that ask no occluders. The light
 * is a square in the plane of the light's position, parallel to the map and turned as its rows are;
 * light_size is its width in world units, or, for a light at infinity, the width at the distance of
 * one unit (twice the tangent of half the angle). Every texel of the map in front of the receiver
 * plane is a quad parallel to the light, and covers what of the light the fragment sees behind it;
 * a quad that lies apart from its left or upper neighbour is extended to it. Texels are searched in
 * the window that the light spans at the nearest of them, at most window x window (4 .. 64): where
 * it ought to be larger, quads of several texels take the depth of their middle one. Exactly 1
 * where nothing is in front, exactly 0 where quads without overlap cover the light. shb_map_prepare
 * keeps least depths, some 1/12 byte a texel, and fails with SHB_ERROR_ARGUMENT for a light_size
 * that is not above 0 and finite or another parameter out of range. */

/* "backprojection": 1 less the sum of the areas (Guennebaud, Barthe and Paulin 2006), at least 0:
 * what quads cover twice counts twice. Sides are rounded to 1/1024 of the light. Default of tools:
 * light 1, window 32. */
shb_filter shb_filter_backprojection(float light_size, int window);

/* "bitmask": the part of 64 or 256 samples of the light that no quad covers (Schwarz and Stamminger
 * 2007). Default of tools: light 1, window 32, samples 64. */
shb_filter shb_filter_bitmask(float light_size, int window, int samples);

/* "pcss": percentage-closer soft shadows, with the same taps in both stages (Fernando 2005; Ehm et
 * al. 2015, section 4.2).
 * 1. The search looks for blockers in the part of the map that the light spans, as seen from the
 *    fragment, on the near plane: blocker_samples taps on a disk, or 0: every texel of a square.
 * 2. The penumbra at the fragment is w = (d_fragment - d_blocker) / d_blocker * light_size, with
 *    distances from the light along its axis (Schwaerzler 2009, eq. 5.6); the mean over all
 *    blockers found, which is the w of their mean map depth.
 * 3. The answer is the lit share of a kernel of that width: filter_samples taps on a disk, or 0:
 *    every texel of a square.
 * light_size: width of the light, which lies parallel to the map. World units at the light's
 * position; for a directional light the width at distance one, that is twice the tangent of half
 * its angular diameter. Taps on a disk: the first of a fixed sequence, at most SHB_POISSON_MAX,
 * turned by a hash of the fragment's position. Texels of a square count by the part of them that it
 * covers. A kernel is centred on the fragment and at least one texel wide; squares of more than 126
 * texels give way to 64 taps on the disk, and nothing is wider than 32768 texels.
 * Methods that need occluders ask them in every tap of both stages; taps is not read then.
 * Outcomes: no blocker found: lit. Every tap of the search blocked: the kernel of step 3 decides,
 * 0 if all of it is blocked too. Taps outside the map: lit, and no blockers. Blockers at or beyond
 * the fragment's own depth, as steep planes have them: the narrowest kernel. Fragments outside the
 * map: lit. light_size negative or no number: 0.
 * shb_map_prepare makes a pyramid of bounds, a third of a byte a texel, by which fragments whose
 * search can meet nothing, or nothing but blockers, are answered at once; results are the same.
 * Default of tools: light 0.05, blockers 25, samples 25, taps 0. */
shb_filter shb_filter_pcss(float light_size, int blocker_samples, int filter_samples,
                           shb_taps taps);

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
