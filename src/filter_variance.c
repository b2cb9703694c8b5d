/* Variance shadow maps: Donnelly and Lauritzen 2006, sections 3 and 4. The paper's least variance
 * is not a constant here but the square of what rounding and format may do to the distance. */
#include "strict.h"

#include "filter_check.h"
#include "kernels/moments.h"
#include "moment_soft.h"

enum { SIZE, BLEEDING };

static void variance(const shb_filter_args *args) {
    shb_moment_map_visibility(args, shb_moment_kernels_in(args)->variance, true,
                              args->filter->params[BLEEDING]);
}

static void variance_soft(const shb_filter_args *args) {
    shb_moment_soft_visibility(args, shb_moment_kernels_in(args)->variance,
                               args->filter->params[BLEEDING]);
}

static shb_result check_bleeding(const shb_map *map, const shb_filter *filter) {
    return shb_filter_check_param(map, filter, "bleeding", filter->params[BLEEDING], 0,
                                  SHB_BLEEDING_MAX);
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    shb_result result = shb_filter_check_size(map, filter, filter->params[SIZE]);
    if (result == SHB_OK)
        result = check_bleeding(map, filter);
    if (result != SHB_OK)
        return result;
    const shb_moment_map plan = {
        .size = (int)filter->params[SIZE], .image_count = 1, .images = {{.count = 2}}};
    return shb_moment_map_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_variance(int size, float bleeding) {
    return (shb_filter){.name = "variance",
                        .filter = variance,
                        .prepare = prepare,
                        .release = shb_moment_map_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {(float)size, bleeding}};
}

static shb_result prepare_soft(const shb_map *map, const shb_filter *filter, void **prepared,
                               size_t *bytes) {
    const shb_result result = check_bleeding(map, filter);
    const shb_moment_soft plan = {.image_count = 1, .images = {{.count = 2}}};
    return result ? result : shb_moment_soft_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_variance_soft(float light_size, float bleeding) {
    return (shb_filter){.name = "variance-soft",
                        .filter = variance_soft,
                        .prepare = prepare_soft,
                        .release = shb_moment_soft_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {light_size, bleeding}};
}
