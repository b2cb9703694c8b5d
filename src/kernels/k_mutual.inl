/* The exact method in taps: a tap is shadowed if what the map holds lies in front of the fragment's
 * plane at the texel's centre, and the plane of that occluder in front of the fragment at the
 * fragment's own place (shb_exact_is_shadowed, but for what snapping moves, which is
 * some millionths of a box); and the occluder's sheet does not go on to be the fragment's own: over
 * the mesh where the map keeps triangles, from texel to texel in boxes where it keeps planes.
 *
 * The bounds are those of light_point.h, made larger so that they are sums of few floats, taken
 * once for a fragment and all its taps; where that makes a difference, taps are lit. In the units
 * of light_bounds.h, with u = 2^-24 and N the largest element of the normal:
 *
 * The elements of A are no larger than |unit_x| + |xi| |unit_w|. So the true point lies no farther
 * from the calculated one than moved_x = q_x unit_x and so on,
 *     q_x = u (1 + 2^-9 + 8 u r) (sum |unit_x P| + |xi| sum |unit_w P|) / w_low
 *     r = (sum |unit_w P| + |w_3|) / w_low,  w_low = w - 8 u (sum |unit_w P| + |w_3|)
 * and another 2^-25 texels for the rounding of its place to floats.
 *
 * |A| is at most a = |unit_x| + |xi|, and |A x B| at most |A| |B|. So the denominator of the slopes
 * is off by no more than N (e_a b + e_b a), e_a = q_x + 12 u a: the rounding of a unit vector to
 * floats is 7 u N a b, and the calculation in floats another 10 u N a b. The numerators likewise. A
 * quarter more of the denominator's error holds the rounding of the slopes themselves. */

#include "../exact_sheet.h"
#include "../light_point.h"
#include "../occluders.h"
#include "k_slopes.inl"

/* What a triangle means to a fragment, relative to the fragment's plane. */
typedef struct mutual_triangle {
    bool shadows; /* where it lies in front of that plane */
    /* it lies so far in front at the fragment's own place, and more for each texel from there; to
     * be compared with error */
    float front, rise_x, rise_y, error;
} mutual_triangle;

/* Triangles that were asked lately. */
#define MEMO_SIZE 1024

typedef struct mutual_memo {
    uint64_t keys[MEMO_SIZE]; /* number of the fragment, id of the triangle */
    mutual_triangle triangles[MEMO_SIZE];
} mutual_memo;

/* What the function exact of a filter works with: its own receivers, projected, and bounds. */
typedef struct mutual_batch {
    const shb_map *map;
    shb_receivers receivers;
    SHB_ALIGN float moved_x[SHB_BATCH], moved_y[SHB_BATCH]; /* texels */
    float moved_z[SHB_BATCH];                               /* depth, before rounding to float */
    float error[SHB_BATCH];       /* of the fragment's plane at its own place */
    float slope_error[SHB_BATCH]; /* and as much for each texel from there */
    float reach[SHB_BATCH];       /* of taps on an axis, texels */
    float base[SHB_BATCH]; /* a plane passes in front of the fragment if it does so by more */
    /* where the map keeps triangles: */
    double x[SHB_BATCH], y[SHB_BATCH], z[SHB_BATCH]; /* the fragment in the map */
    uint32_t plain[SHB_BATCH]; /* the own texel's triangle if it shadows no tap, or SHB_ID_NONE */
    mutual_memo memo;
} mutual_batch;

typedef struct vf3 {
    vf x, y, z;
} vf3;

static inline ALWAYS_INLINE vf dot_floats(const float *a, vf3 b) {
    return (a[0] * b.x + a[1] * b.y) + a[2] * b.z;
}

/* In the units of light_bounds.h. */
typedef struct mutual_place {
    vf xi, eta, zeta;
    vf q_x, q_y, q_z;
} mutual_place;

static inline ALWAYS_INLINE mutual_place find_place(const shb_light_bounds *bounds, bool affine,
                                                    const shb_receivers *r, size_t i) {
    const vf3 p = {vf_load(r->x + i), vf_load(r->y + i), vf_load(r->z + i)};
    const vf3 size = {vf_abs(p.x), vf_abs(p.y), vf_abs(p.z)};
    const vf sum_x = dot_floats(bounds->x, size), sum_y = dot_floats(bounds->y, size);
    const vf sum_z = dot_floats(bounds->z, size);
    const float u = (float)SHB_FLOAT_ROUNDING, few = 1 + 0x1p-9f;
    if (affine) {
        const vf moved = vf_splat(u * few / bounds->way[3]);
        return (mutual_place){{0}, {0}, {0}, moved * sum_x, moved * sum_y, moved * sum_z};
    }
    const vf texel_x = __builtin_convertvector(vi_load(r->texel_x + i), vf);
    const vf texel_y = __builtin_convertvector(vi_load(r->texel_y + i), vf);
    const vf x = (texel_x - bounds->middle_x) + (0.5f - vf_load(r->to_center_x + i));
    const vf y = (texel_y - bounds->middle_y) + (0.5f - vf_load(r->to_center_y + i));
    const vf xi = x * bounds->to_xi, eta = y * bounds->to_eta;
    const vf zeta = vf_load(r->depth + i) * bounds->to_zeta;
    const vf sum_w = dot_floats(bounds->w, size);
    const vf noise = 8 * u * (sum_w + fabsf(bounds->way[3]));
    const vf low = (dot_floats(bounds->way, p) + bounds->way[3]) - noise;
    const vf inverse = vf_where(low > 0, 1 / low, vf_splat(INFINITY));
    const vf moved = u * inverse * (few + noise * inverse);
    return (mutual_place){xi,
                          eta,
                          zeta,
                          moved * (sum_x + vf_abs(xi) * sum_w),
                          moved * (sum_y + vf_abs(eta) * sum_w),
                          moved * (sum_z + vf_abs(zeta) * sum_w)};
}

/* Depth per texel of the fragments' planes, and how much they may be off; 0 without a normal. */
typedef struct mutual_slopes {
    vf x, y, error_x, error_y;
} mutual_slopes;

static inline ALWAYS_INLINE mutual_slopes find_slopes(const shb_light_bounds *bounds, bool affine,
                                                      const mutual_place *at,
                                                      const shb_receivers *r, size_t i) {
    const vf3 n = {vf_load(r->normal_x + i), vf_load(r->normal_y + i), vf_load(r->normal_z + i)};
    vf ab = dot_floats(bounds->x_cross_y, n), cb = dot_floats(bounds->z_cross_y, n);
    vf ac = dot_floats(bounds->x_cross_z, n);
    vf a = vf_splat(bounds->size_x), b = vf_splat(bounds->size_y), c = vf_splat(bounds->size_z);
    if (!affine) {
        const vf xw = dot_floats(bounds->x_cross_w, n), yw = dot_floats(bounds->y_cross_w, n);
        const vf zw = dot_floats(bounds->z_cross_w, n);
        ab = (ab - at->eta * xw) + at->xi * yw;
        cb = (cb - at->eta * zw) + at->zeta * yw;
        ac = (ac - at->zeta * xw) + at->xi * zw;
        a += vf_abs(at->xi);
        b += vf_abs(at->eta);
        c += vf_abs(at->zeta);
    }
    const float noise = 12 * (float)SHB_FLOAT_ROUNDING, turns = bounds->turns;
    const vf largest = vf_max(vf_max(vf_abs(n.x), vf_abs(n.y)), vf_abs(n.z));
    const vf e_a = largest * (turns * at->q_x + noise * a);
    const vf e_b = largest * (turns * at->q_y + noise * b);
    const vf e_c = largest * (turns * at->q_z + noise * c);
    const vf off = 1.25f * (e_a * b + e_b * a);
    const vf left = vf_abs(ab) - 3 * off;
    const vf scale = vf_where(left > 0, 1 / left, vf_splat(INFINITY));
    const vf inverse = 1 / ab, x = cb * inverse, y = ac * inverse;
    const vf error_x = ((e_c * b + e_b * c) + vf_abs(x) * off) * scale;
    const vf error_y = ((e_a * c + e_c * a) + vf_abs(y) * off) * scale;
    const vf squared = (n.x * n.x + n.y * n.y) + n.z * n.z;
    const vi usable = (squared > 0) & (squared <= FLT_MAX);
    return (mutual_slopes){
        vf_keep(usable, x * bounds->slope_x), vf_keep(usable, y * bounds->slope_y),
        vf_keep(usable, error_x * bounds->slope_x), vf_keep(usable, error_y * bounds->slope_y)};
}

static inline ALWAYS_INLINE void find_bounds(bool affine, size_t count, mutual_batch *batch) {
    const shb_light_bounds bounds = batch->map->bounds;
    shb_receivers *r = &batch->receivers;
    const float more = 1 + 0x1p-20f, u = (float)SHB_FLOAT_ROUNDING;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE) {
        const mutual_place at = find_place(&bounds, affine, r, i);
        const mutual_slopes slopes = find_slopes(&bounds, affine, &at, r, i);
        const vf moved_x = at.q_x * (more * bounds.unit_x) + u / 2;
        const vf moved_y = at.q_y * (more * bounds.unit_y) + u / 2;
        const vf moved_z = at.q_z * (more * bounds.unit_z);
        vf_store(batch->moved_x + i, moved_x);
        vf_store(batch->moved_y + i, moved_y);
        vf_store(batch->moved_z + i, moved_z);
        vf_store(batch->error + i, (moved_z + (vf_abs(slopes.x) + slopes.error_x) * moved_x) +
                                       (vf_abs(slopes.y) + slopes.error_y) * moved_y);
        vf_store(batch->slope_error + i, slopes.error_x + slopes.error_y);
        vf_store(r->step_x + i, slopes.x);
        vf_store(r->step_y + i, slopes.y);
    }
}

/* Writes the fragments' planes, batch->reach being known; one that may be parallel to the light's
 * ray has nothing in front of it. shb_tap_depth rounds two products and two sums, and ref is the
 * outcome of three more: with S = (|slope_x| + |slope_y|) reach that is no more than
 * u (4 S + 3 (|z| + S) + 3 (|z| + S) + |z|), to first order. In a map that keeps triangles depths
 * are those of their planes but for 5 u |z| (plane.h); there the plane is written behind all of
 * that, and what lies in front of it is asked once more. */
static void write_mutual_planes(mutual_batch *batch, size_t count) {
    shb_receivers *r = &batch->receivers;
    const float side = batch->map->info.occluders == SHB_OCCLUDERS_TRIANGLES ? -1.0f : 1.0f;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE) {
        const vf z = vf_load(r->depth + i), reach = vf_load(batch->reach + i);
        const vf step_x = vf_load(r->step_x + i), step_y = vf_load(r->step_y + i);
        const vf rise = (vf_abs(step_x) + vf_abs(step_y)) * reach;
        const vf rounding = 24 * (float)SHB_FLOAT_ROUNDING * (vf_abs(z) + rise);
        const vf error =
            (vf_load(batch->error + i) + vf_load(batch->slope_error + i) * reach) + rounding;
        const vf run = step_x * vf_load(r->to_center_x + i) + step_y * vf_load(r->to_center_y + i);
        const vi known = error < INFINITY;
        vf_store(r->ref + i, vf_where(known, (z + run) - side * error, vf_splat(-INFINITY)));
        vf_store(r->step_x + i, vf_keep(known, step_x));
        vf_store(r->step_y + i, vf_keep(known, step_y));
        vf_store(batch->base + i,
                 vf_load(batch->moved_z + i) + 2 * (float)SHB_FLOAT_ROUNDING * vf_abs(z));
    }
}

/* What the planes of occluders are compared with, of WIDE fragments or of one. */
typedef struct mutual_lanes {
    vf z, base, moved_x, moved_y;
} mutual_lanes;

static inline ALWAYS_INLINE mutual_lanes mutual_lanes_at(const mutual_batch *batch, size_t i) {
    return (mutual_lanes){vf_load(batch->receivers.depth + i), vf_load(batch->base + i),
                          vf_load(batch->moved_x + i), vf_load(batch->moved_y + i)};
}

static inline ALWAYS_INLINE mutual_lanes mutual_lanes_of_one(const mutual_batch *batch, size_t i) {
    return (mutual_lanes){vf_splat(batch->receivers.depth[i]), vf_splat(batch->base[i]),
                          vf_splat(batch->moved_x[i]), vf_splat(batch->moved_y[i])};
}

/* A length along one axis, from the fragment to a tap, by the slope of the tap's plane, less what
 * the fragment may have moved: for slopes that rise and for those that fall. error: what the slope
 * may be off by times the length, by its step. */
typedef struct mutual_way {
    vf rising, falling, error;
} mutual_way;

static inline ALWAYS_INLINE mutual_way mutual_way_of(vf moved, vf texels, float unit) {
    const vf to = texels * unit, miss = moved * unit;
    return (mutual_way){to - miss, to + miss, SLOPE_ERROR * vf_abs(to)};
}

/* -1 where the plane of the texel's occluder, through what is stored, passes in front of the
 * fragment. */
static inline ALWAYS_INLINE vi passes_in_front(vf z, vf base, const mutual_way *x,
                                               const mutual_way *y, vf stored, vu texels) {
    const vf rise_x = x_mantissas(texels) * vf_by_sign((vi)texels, x->falling, x->rising);
    const vf rise_y = y_mantissas(texels) * vf_by_sign((vi)(texels << 14), y->falling, y->rising);
    const vf rise = slope_steps(texels) * ((rise_x + rise_y) - (x->error + y->error));
    return ((z - stored) + rise > base) & have_slopes(texels);
}
