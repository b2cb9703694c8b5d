/* Filters: each turns receiver planes and a map into visibility.
 *
 * A filter is a plain value of up to four functions, of which all but the first may be NULL:
 *   filter   compares its taps with the receiver plane
 *   exact    the same for methods that need occluders (SHB_NEEDS_OCCLUDERS): every tap asks the
 *            occluder that its texel keeps; NULL: the filter does not serve such methods
 *   prepare  makes what the filter reads beside the depths, as a pyramid or moments
 *   release  frees that */
#ifndef SHADOWBIAS_FILTER_H
#define SHADOWBIAS_FILTER_H

#include "shadowbias/bias.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_map shb_map;
typedef struct shb_filter shb_filter;

/* The triangles that points lie on, where they are known: arrays of one element a point. Only the
 * exact method reads them, where the map keeps triangles or lists and the filter is hard. */
typedef struct shb_own_triangles {
    const uint32_t *ids; /* of the scene that the map was drawn from, as shb_draw counts them; NULL:
                            unknown. A point's own triangle does not shadow it */
    /* barycentric weights of the triangle's second and third corner; both NULL: unknown. With them
     * the points are those that ids and weights name, in double, free of the rounding of positions.
     * These must still be near: a batch of SHB_BATCH points goes by positions alone if one of them
     * is off by more than 2^-18 of the size of its corners' coordinates */
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
    bool lifted;          /* the points were moved off their surface (smooth_terminator) */
    const void *prepared; /* what prepare made of this map for this filter; NULL: nothing */
    const shb_own_triangles *own; /* of the batch; NULL: unknown */
} shb_filter_args;

/* Works on the whole batch; must be thread-safe and may not fail. A tap outside the map is lit. The
 * function exact gets receivers that hold nothing but the positions and, unless the map keeps
 * lists, the normals as the host gave them. To ask the occluders, a filter of your own calls the
 * function exact of shb_filter_hard(); at points that it moved, with lifted true and own NULL. */
typedef void shb_filter_fn(const shb_filter_args *args);

/* Makes what the filter reads of a map; called by shb_map_prepare on the caller's thread. *prepared
 * is NULL or what the same filter made of this map before, which may be reused: if *prepared
 * changes, the old one is released. NULL as the outcome counts as not prepared. *bytes is the
 * memory of the outcome, for shb_map_info. On failure *prepared, what it points to and *bytes must
 * be left as they were. */
typedef shb_result shb_filter_prepare_fn(const shb_map *map, const shb_filter *filter,
                                         void **prepared, size_t *bytes);

/* Frees what the filter prepared, which is not NULL. */
typedef void shb_filter_release_fn(const shb_map *map, void *prepared);

/* In shb_filter.needs, beside SHB_NEEDS_NORMAL, _SCALE and _SLOPE. */
enum {
    SHB_NEEDS_PREPARED = 32, /* refused for a map that was not prepared for the filter since it was
                                drawn; other filters with a preparation work without it, too */
    SHB_NEEDS_SAMPLES = 64   /* the function exact asks the occluder that each texel keeps: refused
                                for maps that keep lists */
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
                      same as SHB_TAPS_PLANE but for rounding and the limit of slopes, and
                      slow: for comparison */
} shb_taps;

/* The most taps on a disk. */
#define SHB_POISSON_MAX 256

/* "hard": one tap, the texel that holds the fragment (Williams 1978): shadowed where the stored
 * depth is less than min(ref, far depth); equal is lit. */
shb_filter shb_filter_hard(void);

/* "pcf": the share of lit taps among the n x n texels nearest to the fragment, each lit or not as
 * by the hard filter (Reeves, Salesin and Cook 1987). size is n, 1 .. 63, rounded and limited; or,
 * with SHB_UNIT_WORLD, the width of the box in world units, which becomes n by the texel size at
 * each fragment. Any other unit is texels. Default (here and below: of tools): 5 texels,
 * SHB_TAPS_PLANE. */
shb_filter shb_filter_pcf(float size, shb_unit unit, shb_taps taps);

/* "pcf-smooth": the same n x n texels, n 2 .. 63, each weighted by the part of it that a box of n -
 * 1 texels centred on the fragment covers, so that visibility changes without steps; 2 is bilinear.
 * Default: 2 texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_pcf_smooth(float size, shb_unit unit, shb_taps taps);

/* "jittered": 16 taps in a box of size x size texels or world units around the fragment, one in
 * each cell of a grid of 4 x 4, at a place in the cell that a hash of the fragment's position gives
 * (Weiskopf and Ertl 2003, section 5). Default: 4 texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_jittered(float size, shb_unit unit, shb_taps taps);

/* "poisson": count taps, 1 .. SHB_POISSON_MAX, on a disk of this radius in texels or world units
 * around the fragment, rotated by a hash of its position. The first tap is the fragment's own
 * texel. Default: 16 taps, 3 texels, SHB_TAPS_PLANE. */
shb_filter shb_filter_poisson(float count, float radius, shb_unit unit, shb_taps taps);

/* Filters over the moments of distance. They need shb_map_prepare, which fails with
 * SHB_ERROR_ARGUMENT for a parameter out of range, and do not serve methods that ask occluders.
 * - Distance is linear along the light's axis: 0 at the near plane, 1 at the far plane or, in a
 *   perspective map, at twice the largest distance from the light in the map if that is nearer.
 *   Outside the map it is 1.
 * - Each texel gets the moments over the size x size texels around it, size being odd and 1 .. 63;
 *   between texels the distributions are mixed (bilinear).
 * - The receiver is the receiver plane at the fragment's own place. The answer is an upper bound of
 *   the part of the box that does not lie in front of it: exactly 1 where nothing does, but too
 *   much where occluders lie one behind another (light bleeding).
 * - The error e of a stored distance follows from format, rounding and projection; its square is
 *   the least variance. */
#define SHB_BLEEDING_MAX 0.99f

/* "variance": Chebyshev's inequality (Donnelly and Lauritzen 2006, eq. 5): v / (v + d^2) at the
 * distance d behind the mean, v being the variance, and 1 in front of the mean. Bounds below
 * bleeding, 0 .. SHB_BLEEDING_MAX, become 0, and the rest is stretched to 0 .. 1 (Lauritzen 2007,
 * section 8.4.3). 8 bytes a texel. Default: size 5, bleeding 0.2. */
shb_filter shb_filter_variance(int size, float bleeding);

/* "exponential-variance": the smaller of the bounds for exp(positive x) and -exp(-negative x), x
 * being distance (Lauritzen and McCool 2008). Both exponents SHB_EXPONENT_MIN .. SHB_EXPONENT_MAX.
 * The receiver moves towards the light by one standard deviation of its own plane over the box. 16
 * bytes a texel. Default: size 5, positive 80, negative 10, bleeding 0. */
#define SHB_EXPONENT_MIN 0.01f
#define SHB_EXPONENT_MAX 80.0f
shb_filter shb_filter_exponential_variance(int size, float positive, float negative,
                                           float bleeding);

/* "moments": the sharpest bound that four moments allow (Peters and Klein 2015, Hamburger's
 * problem), exact where the box holds one or two distances. Instead of the paper's moment bias the
 * moments are those of distances with independent noise of deviation e. The receiver moves towards
 * the light by e and one standard deviation of its own plane over the box. 16 bytes a texel.
 * Default: size 5. */
shb_filter shb_filter_moments(int size);

/* The same three as percentage-closer soft shadows, whose blur grows with the penumbra (Yang, Dong,
 * Feng, Seidel and Kautz 2010; Peters, Muenstermann, Wetzstein and Klein 2017). light_size, above 0
 * and finite, is the width of a light parallel to the map, in the units of shb_filter_pcss.
 * 1. The search takes the kernel that the light spans at the nearest depth that could stand between
 *    it and the fragment, as far as whole cells of 8 x 8 texels or more tell. The blockers' mean
 *    distance is that of what lies in front of the receiver in the distribution that meets the
 *    bound: blockers far behind each other count as one at their mean.
 * 2. The answer is the bound over the kernel that the light spans at that distance, with the
 *    receiver moved towards the light by one standard deviation of its own plane over the kernel.
 * A kernel mixes boxes of two sizes, 2^k texels wide, that lie a quarter of their width apart: its
 * second moments are those of a box of the width that is wanted, or a little less. It is at least
 * 2.4 texels wide and at most as wide as boxes that hold the map; where texels are not square, the
 * square of its width is the mean of both axes'.
 * Fragments that nothing stands in front of, and those whose search finds nothing, are lit: exactly
 * 1. So is a plane in the light as long as the kernel lies on it and, for
 * exponential-variance-soft, that deviation is less than 3 / negative. shb_map_prepare takes 7/3 of
 * the memory of the filters above. */

/* "variance-soft". Default: light 0.05, bleeding 0.1. */
shb_filter shb_filter_variance_soft(float light_size, float bleeding);

/* "exponential-variance-soft": the exponential with the smaller bound gives the blockers' distance,
 * too. Default: light 0.05, positive 20, negative 40, bleeding 0. */
shb_filter shb_filter_exponential_variance_soft(float light_size, float positive, float negative,
                                                float bleeding);

/* "moments-soft". Default: light 0.05. */
shb_filter shb_filter_moments_soft(float light_size);

/* Filters by backprojection: the texels in front of a fragment cover parts of the light. They need
 * shb_map_prepare, which keeps least depths, about 1/12 byte a texel, and fails with
 * SHB_ERROR_ARGUMENT for a light_size that is not above 0 and finite or another parameter out of
 * range; they do not serve methods that ask occluders.
 * - The light is a square at the light's position, parallel to the map and turned as its rows are.
 *   light_size is its width in the units of shb_filter_pcss.
 * - Every texel in front of the receiver plane is a quad parallel to the light, and covers what the
 *   fragment sees behind it of the light. A quad that lies apart from its left or upper neighbour
 *   is extended to it, which fills gaps.
 * - Texels are searched in the window that the light spans at the nearest of them. Where that is
 *   more than window x window (4 .. 64) texels, quads of several texels take the depth of the one
 *   in their middle.
 * - Exactly 1 where nothing is in front, exactly 0 where quads cover the light without overlap. */

/* "backprojection": 1 less the sum of the covered areas, at least 0 (Guennebaud, Barthe and Paulin
 * 2006): what quads cover twice counts twice. Sides are rounded to 1/1024 of the light. Default:
 * light 1, window 32. */
shb_filter shb_filter_backprojection(float light_size, int window);

/* "bitmask": the part of samples (64 or 256) points of the light that no quad covers (Schwarz and
 * Stamminger 2007). Default: light 1, window 32, samples 64. */
shb_filter shb_filter_bitmask(float light_size, int window, int samples);

/* "pcss": percentage-closer soft shadows, with the same taps in both stages (Fernando 2005; Ehm et
 * al. 2015, section 4.2).
 * 1. The search looks for blockers in the part of the map that the light spans on the near plane,
 *    as seen from the fragment: blocker_samples taps on a disk, or 0: every texel of a square.
 * 2. The penumbra of a blocker is w = (d_fragment - d_blocker) / d_blocker * light_size wide at the
 *    fragment, with distances from the light along its axis (Schwaerzler 2009, eq. 5.6). The
 *    mean over all blockers found is taken: that is the w of their mean map depth.
 * 3. The answer is the lit share of a kernel of that width: filter_samples taps on a disk, or 0:
 *    every texel of a square.
 * light_size is the width of the light, which lies parallel to the map: in world units at the
 * light's position or, for a directional light, at the distance of one unit (twice the tangent of
 * half its angular diameter). A negative one or NaN is 0.
 * Taps on a disk are the first of a fixed sequence, at most SHB_POISSON_MAX, rotated by a hash of
 * the fragment's position. Texels of a square are weighted by the part of them that it covers. A
 * kernel is centred on the fragment and 1 .. 32768 texels wide; squares of more than 126 texels
 * give way to 64 taps on the disk.
 * Methods that need occluders ask them in every tap of both stages; taps is not read then.
 * Outcomes where the papers are silent:
 * - no blocker found, or fragment outside the map: lit
 * - every tap of the search blocked: step 3 decides; 0 if all of its kernel is blocked, too
 * - tap outside the map: lit, no blocker
 * - blockers at or beyond the fragment's own depth, as on steep planes: the narrowest kernel
 * shb_map_prepare, which may be left out, makes a pyramid of bounds, a third of a byte a texel,
 * that answers at once where the search can meet nothing, or nothing but blockers, with the same
 * results. Default: light 0.05, blockers 25, samples 25, taps 0. */
shb_filter shb_filter_pcss(float light_size, int blocker_samples, int filter_samples,
                           shb_taps taps);

/* A built-in filter, for tools: its default value and the names of its parameters. */
typedef struct shb_filter_method {
    const char *name;
    const char *summary;
    shb_filter (*make)(void);                /* with default parameters */
    const char *param_names[SHB_PARAMS_MAX]; /* in the order of shb_filter.params; NULL: none */
} shb_filter_method;

/* All built-in filters in the order above; never fails. count may be NULL. */
const shb_filter_method *shb_filter_methods(size_t *count);

/* The filter that a text names, as shb_bias_parse; unit and taps by their numbers, 0, 1 or 2. */
shb_result shb_filter_parse(const char *text, shb_filter *filter);

/* The stored depths at count texels, canonical (smaller is nearer); the far depth outside the map,
 * and everywhere in one with desc.exact_only. For filters of your own. */
void shb_map_fetch(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                   float *depth);

#ifdef __cplusplus
}
#endif

#endif
