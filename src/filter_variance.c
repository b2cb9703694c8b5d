/* Variance shadow maps: Donnelly and Lauritzen 2006, sections 3 and 4. The paper's least variance
 * is not a constant here but the square of what rounding and format may do to the distance. */
#include "strict.h"

#include "moment_map.h"

enum { SIZE, BLEEDING };

static void variance(const shb_filter_args *args) {
    const shb_moment_map *moments = args->prepared;
    const float bleeding = args->filter->params[BLEEDING];
    shb_distance_batch receiver;
    shb_moment_batch box;
    shb_moment_receivers(moments, args->receivers, 0, args->count, &receiver);
    shb_moment_image_sample(&moments->images[0], args->receivers, args->count, &box);
    for (size_t i = 0; i < args->count; i++) {
        const float least = receiver.error[i] * receiver.error[i];
        const float lit = shb_chebyshev(receiver.at[i], box.at[0][i], box.at[1][i] + least);
        args->visibility[i] = shb_less_bleeding(lit, bleeding);
    }
    shb_light_outside(args);
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    shb_result result = shb_filter_check_size(map, filter, filter->params[SIZE]);
    if (result == SHB_OK)
        result = shb_filter_check_param(map, filter, "bleeding", filter->params[BLEEDING], 0,
                                        SHB_BLEEDING_MAX);
    if (result != SHB_OK)
        return result;
    const shb_moment_map plan = {
        .size = (int)filter->params[SIZE], .image_count = 1, .images = {{.count = 2}}};
    return shb_moment_map_prepare(map, filter->name, &plan, prepared, bytes);
}

shb_filter shb_filter_variance(int size, float bleeding) {
    return (shb_filter){.name = "variance",
                        .filter = variance,
                        .prepare = prepare,
                        .release = shb_moment_map_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {(float)size, bleeding}};
}
