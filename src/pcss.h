/* Percentage-closer soft shadows: what both stages of one batch share.
 *
 * Let u be 1 / w, which is affine in the map's depth: depth = c - q u. A light of width L in a
 * plane parallel to the map's, seen past a blocker at the clip distance w_b from a fragment at w_r,
 * spans L (w_r - w_b) / w_b in the fragment's plane (thesis, eq. 5.6), where a texel is t w_r wide:
 *     L (w_r - w_b) / (w_b w_r t) = L (u_b - u_r) / t = L / (q t) (depth_r - depth_b) texels.
 * So the penumbra of a blocker, in texels, grows with the difference of the depths as the map holds
 * them, without any division; that of the mean depth of blockers is the mean of their penumbras.
 * Under parallel rays, with L the width at distance one, the same follows at once. */
#ifndef SRC_PCSS_H
#define SRC_PCSS_H

#include "map.h"
#include "poisson.h"
#include "project.h"
#include "pyramid.h"

/* Half widths of kernels, texels. A square of texels is not larger than this; where it ought to be,
 * SHB_PCSS_SPREAD taps on the disk stand for it. */
#define SHB_PCSS_LEAST 0.5f
#define SHB_PCSS_SQUARE_MOST 63.0f
#define SHB_PCSS_MOST 16384.0f
#define SHB_PCSS_SPREAD 64

typedef struct shb_pcss {
    float texels_x, texels_y; /* half width of a penumbra per depth between blocker and fragment */
    float near_depth, far_depth;
    int blockers, samples;      /* taps of search and filter; 0: every texel */
    bool own_depth;             /* taps do not follow the plane: SHB_TAPS_OWN */
    const shb_pyramid *pyramid; /* NULL: none */
    float points[SHB_POISSON_MAX][2];
    float turns[2 * SHB_POISSON_TURNS]; /* cosine, sine */
} shb_pcss;

/* A stage's outcome: of the taps with something in front of the receiver plane their weight and the
 * sum of their depths, and the weight of all taps. */
typedef struct shb_pcss_stage {
    float blocked, depth, all;
} shb_pcss_stage;

/* Half of a kernel's width for a blocker of this depth. */
static inline float shb_pcss_radius(float texels, float depth, float blocker) {
    const float radius = texels * (depth - blocker);
    const float enough = radius > SHB_PCSS_LEAST ? radius : SHB_PCSS_LEAST;
    return enough < SHB_PCSS_MOST ? enough : SHB_PCSS_MOST;
}

/* One axis of a square about a fragment: the texels that it covers at least in part. */
typedef struct shb_square_axis {
    float center, reach; /* from the own texel's centre; half of the square's width and 0.5 */
    int32_t first, last;
} shb_square_axis;

static inline int32_t shb_floor_to_int(float value) {
    const int32_t truncated = (int32_t)value;
    return truncated - ((float)truncated > value);
}

static inline shb_square_axis shb_square_axis_of(float to_center, float radius) {
    shb_square_axis axis = {-to_center, radius + 0.5f, 0, 0};
    axis.first = -shb_floor_to_int(axis.reach - axis.center);
    axis.last = shb_floor_to_int(axis.center + axis.reach);
    return axis;
}

/* The part of a texel that the square covers along the axis. */
static inline float shb_square_cover(const shb_square_axis *axis, int32_t texel) {
    const float off = (float)texel - axis->center;
    const float covered = axis->reach - (off > -off ? off : -off);
    const float above = covered > 0 ? covered : 0;
    return above < 1 ? above : 1;
}

/* Texels of a square are summed up in so many lanes, by their columns, and these by halves. */
#define SHB_SQUARE_LANES 16

static inline float shb_square_sum(float lanes[SHB_SQUARE_LANES]) {
    for (int half = SHB_SQUARE_LANES / 2; half > 0; half /= 2)
        for (int i = 0; i < half; i++)
            lanes[i] += lanes[i + half];
    return lanes[0];
}

/* pcss_tap.c: one fragment, tap by tap, for taps that do not follow a receiver plane. */

/* True if what the texel m columns to the right and n rows below holds, all inside the map, blocks
 * the light; depth receives what it holds. */
typedef bool shb_pcss_tap_fn(const void *taps, int32_t m, int32_t n, float *depth);

typedef struct shb_pcss_fragment {
    int32_t texel_x, texel_y;
    float to_center_x, to_center_y;
    float depth;
    uint32_t turn;
    shb_pcss_tap_fn *is_blocked;
    const void *taps;
} shb_pcss_fragment;

float shb_pcss_visibility(const shb_pcss *pcss, const shb_map *map,
                          const shb_pcss_fragment *fragment);

#endif
