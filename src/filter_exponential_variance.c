/* Exponential variance shadow maps: Lauritzen and McCool 2008, sections 4 and 5. Chebyshev's bound
 * holds for any growing function of the distance; that of exp(positive x) bleeds little behind
 * occluders that are far from the receiver, that of -exp(-negative x) little behind several
 * occluders one above the other. The smaller bound counts. */
#include "strict.h"

#include "filter_check.h"
#include "kernels/moments.h"
#include "moment_soft.h"

enum { SIZE, POSITIVE, NEGATIVE, BLEEDING };

static void exponential_variance(const shb_filter_args *args) {
    shb_moment_map_visibility(args, shb_moment_kernels_in(args)->exponentials, false,
                              args->filter->params[BLEEDING]);
}

static void exponential_variance_soft(const shb_filter_args *args) {
    shb_moment_soft_visibility(args, shb_moment_kernels_in(args)->exponentials,
                               args->filter->params[BLEEDING]);
}

static shb_result check_exponents(const shb_map *map, const shb_filter *filter) {
    const float *params = filter->params;
    shb_result result = shb_filter_check_param(map, filter, "positive", params[POSITIVE],
                                               SHB_EXPONENT_MIN, SHB_EXPONENT_MAX);
    if (result == SHB_OK)
        result = shb_filter_check_param(map, filter, "negative", params[NEGATIVE], SHB_EXPONENT_MIN,
                                        SHB_EXPONENT_MAX);
    if (result == SHB_OK)
        result =
            shb_filter_check_param(map, filter, "bleeding", params[BLEEDING], 0, SHB_BLEEDING_MAX);
    return result;
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    shb_result result = shb_filter_check_size(map, filter, filter->params[SIZE]);
    if (result == SHB_OK)
        result = check_exponents(map, filter);
    if (result != SHB_OK)
        return result;
    const shb_moment_map plan = {.size = (int)filter->params[SIZE],
                                 .image_count = 2,
                                 .images = {{.count = 2, .exponent = filter->params[POSITIVE]},
                                            {.count = 2, .exponent = -filter->params[NEGATIVE]}}};
    return shb_moment_map_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_exponential_variance(int size, float positive, float negative,
                                           float bleeding) {
    return (shb_filter){.name = "exponential-variance",
                        .filter = exponential_variance,
                        .prepare = prepare,
                        .release = shb_moment_map_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {(float)size, positive, negative, bleeding}};
}

static shb_result prepare_soft(const shb_map *map, const shb_filter *filter, void **prepared,
                               size_t *bytes) {
    const shb_result result = check_exponents(map, filter);
    const float *params = filter->params;
    const shb_moment_soft plan = {.image_count = 2,
                                  .images = {{.count = 2, .exponent = params[POSITIVE]},
                                             {.count = 2, .exponent = -params[NEGATIVE]}}};
    return result ? result : shb_moment_soft_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_exponential_variance_soft(float light_size, float positive, float negative,
                                                float bleeding) {
    return (shb_filter){.name = "exponential-variance-soft",
                        .filter = exponential_variance_soft,
                        .prepare = prepare_soft,
                        .release = shb_moment_soft_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {light_size, positive, negative, bleeding}};
}
