/* The test of mutual planes for REAL, as light_point.inl. */

/* The occluder that a texel holds. */
typedef struct REAL_NAME(exact_sample) {
    REAL center_x, center_y, depth; /* never in front of the true plane at the centre */
    REAL slope_x, slope_y;
    REAL slope_error_x, slope_error_y;
} REAL_NAME(exact_sample);

/* Of the plane of a fragment. Known to be 0 for those without a usable normal. */
REAL_INLINE REAL_NAME(light_slopes)
    REAL_NAME(exact_slopes_of)(const shb_light_rows *rows, const REAL_NAME(light_point) * point,
                               const REAL normal[3]) {
    const REAL zero = REAL_SPLAT(0.0), infinity = REAL_SPLAT((double)INFINITY);
    const REAL off = REAL_SPLAT(SHB_NORMAL_ERROR);
    const REAL normal_error[3] = {off, off, off};
    const REAL squared = SHB_DOT(normal, normal);
    const REAL usable = REAL_WHERE_GREATER(infinity, squared, squared, zero);
    REAL_NAME(light_slopes)
    slopes = REAL_NAME(light_slopes_of)(rows, point, normal, normal_error);
    slopes.x = REAL_WHERE_GREATER(usable, zero, slopes.x, zero);
    slopes.y = REAL_WHERE_GREATER(usable, zero, slopes.y, zero);
    slopes.error_x = REAL_WHERE_GREATER(usable, zero, slopes.error_x, zero);
    slopes.error_y = REAL_WHERE_GREATER(usable, zero, slopes.error_y, zero);
    return slopes;
}

/* Of the point against its own plane. */
REAL_INLINE REAL REAL_NAME(exact_error_of)(const REAL_NAME(light_point) * point,
                                           const REAL_NAME(light_slopes) * slopes) {
    const REAL moved_x = REAL_NAME(dot_abs)(point->a, point->by_position) + point->error_x;
    const REAL moved_y = REAL_NAME(dot_abs)(point->b, point->by_position) + point->error_y;
    return REAL_NAME(light_point_error)(point, slopes->x, slopes->y) +
           (slopes->error_x * moved_x + slopes->error_y * moved_y);
}

/* One bit a lane. error: exact_error_of. Corners are snapped to the rasterizer's grid, so the
 * occluder may end as far before the centre that it covers as that moves them, and there its plane
 * has come nearer to the fragment's. So a convex body does not shadow itself. Comparisons with NaN
 * are false: lit. */
REAL_INLINE uint32_t REAL_NAME(exact_shadowed_bits)(const REAL_NAME(light_point) * point,
                                                    const REAL_NAME(light_slopes) * slopes,
                                                    REAL error,
                                                    const REAL_NAME(exact_sample) * sample) {
    const REAL to_x = sample->center_x - point->x, to_y = sample->center_y - point->y;
    const REAL far_x = REAL_ABS(to_x), far_y = REAL_ABS(to_y);
    const REAL own = point->z + (slopes->x * to_x + slopes->y * to_y);
    const REAL turn = REAL_ABS(slopes->x - sample->slope_x) + REAL_ABS(slopes->y - sample->slope_y);
    const REAL own_error =
        (error + (slopes->error_x * far_x + slopes->error_y * far_y)) + turn * SHB_SNAPPED_TEXELS;
    const REAL occluder = sample->depth - (sample->slope_x * to_x + sample->slope_y * to_y);
    const REAL occluder_error =
        REAL_NAME(light_point_error)(point, sample->slope_x, sample->slope_y) +
        (sample->slope_error_x * far_x + sample->slope_error_y * far_y);
    return REAL_GREATER_BITS(own - sample->depth, own_error) &
           REAL_GREATER_BITS(point->z - occluder, occluder_error);
}
