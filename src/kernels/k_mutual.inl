/* The exact method in taps: a tap is shadowed if its sample lies in front of the fragment's plane
 * at the texel's centre, and the sample's plane in front of the fragment at the fragment's own
 * place (shb_exact_is_shadowed); and, where the map keeps triangles, its sheet does not go on to be
 * the fragment's own. The bounds are those of light_point.h, put so that they are taken
 * once for a fragment and all its taps; where that makes them larger, taps are lit. */

#include "../exact.h"
#include "../exact_walk.h"
#include "../half.h"
#include "../occluders.h"

typedef struct mutual_fragment {
    double x, y, z;
    double slope_x, slope_y; /* of its plane */
    double error, slope_error_x, slope_error_y;
    double base, per_x, per_y; /* a plane through the point misses the true one by no more than base
                                  + |slope_x| per_x + |slope_y| per_y */
} mutual_fragment;

static mutual_fragment mutual_fragment_of(const shb_light_rows *rows, const shb_receivers *r,
                                          size_t i) {
    const double position[3] = {(double)r->x[i], (double)r->y[i], (double)r->z[i]};
    const double normal[3] = {(double)r->normal_x[i], (double)r->normal_y[i],
                              (double)r->normal_z[i]};
    const shb_exact_fragment exact = shb_exact_fragment_of(rows, position, normal);
    const shb_light_point *p = &exact.point;
    const double more = 1 + 0x1p-40; /* for the sums themselves */
    return (mutual_fragment){
        .x = p->x,
        .y = p->y,
        .z = p->z,
        .slope_x = exact.slopes.x,
        .slope_y = exact.slopes.y,
        .error = exact.error,
        .slope_error_x = exact.slopes.error_x,
        .slope_error_y = exact.slopes.error_y,
        .base = more * (shb_dot_abs(p->c, p->by_position) + p->error_z),
        .per_x = more * (shb_dot_abs(p->a, p->by_position) + p->error_x),
        .per_y = more * (shb_dot_abs(p->b, p->by_position) + p->error_y),
    };
}

/* The fragment's plane as floats for taps at most reach texels away. shb_tap_depth rounds the
 * steps, two products and two sums, and ref is rounded: with u = 2^-24 and S = (|slope_x| +
 * |slope_y|) reach, no more than u (4 S + 3 (|z| + S)), to first order; 16 u (|z| + S) is taken. */
static void write_mutual_plane(const mutual_fragment *f, double reach, shb_receivers *r, size_t i) {
    const double to_x = r->texel_x[i] + 0.5 - f->x, to_y = r->texel_y[i] + 0.5 - f->y;
    const double rise = (fabs(f->slope_x) + fabs(f->slope_y)) * reach;
    const double error = f->error + (f->slope_error_x + f->slope_error_y) * reach +
                         16 * SHB_FLOAT_ROUNDING * (fabs(f->z) + rise);
    r->ref[i] = (float)((f->z + (f->slope_x * to_x + f->slope_y * to_y)) - error);
    r->step_x[i] = (float)f->slope_x;
    r->step_y[i] = (float)f->slope_y;
}

/* Does the plane through (x, y, depth) pass in front of the fragment? */
static bool passes_in_front(const mutual_fragment *f, double to_x, double to_y, double depth,
                            double slope_x, double slope_y, double slope_error_x,
                            double slope_error_y) {
    const double error = f->base + fabs(slope_x) * f->per_x + fabs(slope_y) * f->per_y +
                         (slope_error_x * fabs(to_x) + slope_error_y * fabs(to_y));
    return f->z - (depth - (slope_x * to_x + slope_y * to_y)) > error;
}

/* A sample whose sheet goes on to the fragment's own place, and is the fragment's surface there:
 * the light sees the sheet at both places, whatever their planes say of each other. */
static bool is_of_own_sheet(const shb_map *map, const mutual_fragment *f, uint32_t triangle,
                            int32_t x, int32_t y) {
    const double center[2] = {x + 0.5, y + 0.5}, at[2] = {f->x, f->y};
    const uint32_t arrived = shb_exact_walk(&map->occluders.mesh, triangle, center, at);
    if (arrived == SHB_ID_NONE)
        return false;
    const shb_occluder_plane *plane = &map->occluders.planes[arrived];
    const double error =
        f->base + fabs(plane->slope_x) * f->per_x + fabs(plane->slope_y) * f->per_y + plane->error;
    return fabs(f->z - shb_occluder_depth(plane, f->x, f->y)) <= error;
}

/* What the tap of a texel in the map is compared with: NaN where the texel does not shadow the
 * fragment whatever its depth is. tap: the fragment's plane there. */
static float mutual_tap(const shb_map *map, const mutual_fragment *f, int32_t x, int32_t y,
                        float stored, float tap) {
    const double to_x = x + 0.5 - f->x, to_y = y + 0.5 - f->y;
    const uint32_t texel = shb_occluder_row(map, y)[x];
    if (map->info.occluders == SHB_OCCLUDERS_TRIANGLES) {
        if (texel == SHB_ID_NONE)
            return NAN;
        const shb_occluder_plane *plane = &map->occluders.planes[texel];
        const double depth = shb_occluder_depth(plane, x + 0.5, y + 0.5) + plane->error;
        const double own = f->z + (f->slope_x * to_x + f->slope_y * to_y);
        const double own_error =
            f->error + (f->slope_error_x * fabs(to_x) + f->slope_error_y * fabs(to_y));
        const bool shadowed =
            own - depth > own_error &&
            passes_in_front(f, to_x, to_y, depth, plane->slope_x, plane->slope_y, 0, 0) &&
            !is_of_own_sheet(map, f, texel, x, y);
        return shadowed ? INFINITY : NAN;
    }
    const double unit = map->occluders.slope_unit, smallest = SHB_HALF_ABSOLUTE * unit;
    const double slope_x = (double)shb_half_to_float((uint16_t)(texel & 0xffff)) * unit;
    const double slope_y = (double)shb_half_to_float((uint16_t)(texel >> 16)) * unit;
    const bool shadowed = passes_in_front(f, to_x, to_y, (double)stored, slope_x, slope_y,
                                          fabs(slope_x) * SHB_HALF_RELATIVE + smallest,
                                          fabs(slope_y) * SHB_HALF_RELATIVE + smallest);
    return shadowed ? tap : NAN;
}

/* What the function exact of a filter works with: its own receivers, projected, and their bounds.
 */
typedef struct mutual_batch {
    shb_receivers receivers;
    mutual_fragment fragments[SHB_BATCH];
} mutual_batch;

static void mutual_batch_init(const shb_filter_args *args, mutual_batch *batch) {
    const shb_map *map = args->map;
    memcpy(&batch->receivers, args->receivers, offsetof(shb_receivers, cosine));
    project_batch(map, args->filter->needs & SHB_NEEDS_SCALE, args->count, &batch->receivers);
    for (size_t i = 0; i < shb_round_to_lanes(args->count); i++)
        batch->fragments[i] = mutual_fragment_of(&map->rows, &batch->receivers, i);
}
