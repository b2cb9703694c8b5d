/* Moment shadow maps: Peters and Klein 2015, Hamburger's problem for four moments.
 *
 * Of all distributions with the given mean, variance, third and fourth moment, the one that has the
 * least below t is known (their algorithm 3): it sits on three points, t and the two roots of
 *     c0 + c1 z + c2 z^2 = 0   where   B c = (1, t, t^2),   B = (1 m1 m2; m1 m2 m3; m2 m3 m4).
 * With distances counted from the mean in standard deviations, u for t, m1 = 0, m2 = 1 and, s and k
 * being skewness and kurtosis, Cholesky's B = L diag(1, 1, D) L^T has D = k - 1 - s^2, and
 *     c2 = q / D,  c1 = u - s c2,  c0 = 1 - c2   where   q = u^2 - s u - 1.
 * The weight of a point z is 1 / (1 + z^2 + (z^2 - s z - 1)^2 / D). D is 0 where the box holds one
 * or two distances only, and these are then the roots.
 *
 * The paper's moment bias is what the depths' error e does to the moments: independent noise of
 * this deviation adds e^2 to the variance and 6 variance e^2 + 3 e^4 to the fourth moment. Rounding
 * of the moments themselves moves D by some units of k. */
#include "strict.h"

#include "kernels/moments.h"
#include "moment_soft.h"

enum { SIZE };

static void moments(const shb_filter_args *args) {
    shb_moment_map_visibility(args, shb_moment_kernels_in(args)->moments, false, 0);
}

static void moments_soft(const shb_filter_args *args) {
    shb_moment_soft_visibility(args, shb_moment_kernels_in(args)->moments, 0);
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    const shb_result result = shb_filter_check_size(map, filter, filter->params[SIZE]);
    if (result != SHB_OK)
        return result;
    const shb_moment_map plan = {
        .size = (int)filter->params[SIZE], .image_count = 1, .images = {{.count = 4}}};
    return shb_moment_map_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_moments(int size) {
    return (shb_filter){.name = "moments",
                        .filter = moments,
                        .prepare = prepare,
                        .release = shb_moment_map_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {(float)size}};
}

static shb_result prepare_soft(const shb_map *map, const shb_filter *filter, void **prepared,
                               size_t *bytes) {
    const shb_moment_soft plan = {.image_count = 1, .images = {{.count = 4}}};
    return shb_moment_soft_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_moments_soft(float light_size) {
    return (shb_filter){.name = "moments-soft",
                        .filter = moments_soft,
                        .prepare = prepare_soft,
                        .release = shb_moment_soft_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {light_size}};
}
