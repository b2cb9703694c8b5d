/* Exponential variance shadow maps: Lauritzen and McCool 2008, sections 4 and 5. Chebyshev's bound
 * holds for any growing function of the distance; that of exp(positive x) bleeds little behind
 * occluders that are far from the receiver, that of -exp(-negative x) little behind several
 * occluders one above the other. The smaller bound counts. */
#include "strict.h"

#include "moment_map.h"

enum { SIZE, POSITIVE, NEGATIVE, BLEEDING };

/* Of the deviation of the receiver's own plane, against what curvature of the warp takes away. */
#define SPREAD 1.0f

static float magnitude(float value) {
    return value < 0 ? -value : value;
}

/* Takes the bound of one image. Distances are scaled to the larger of mean and receiver, whose
 * squares may leave the range of floats. */
static void bound(const shb_moment_image *image, const shb_filter_args *args,
                  const shb_distance_batch *receiver, float *lit) {
    const float exponent = image->exponent;
    shb_moment_batch box;
    shb_moment_image_sample(image, args->receivers, args->count, &box);
    for (size_t i = 0; i < args->count; i++) {
        const float t = shb_moment_warp(exponent, receiver->at[i]), mean = box.at[0][i];
        const float largest = magnitude(t) > magnitude(mean) ? magnitude(t) : magnitude(mean);
        const float scale = 1 / largest;
        const float error = exponent * receiver->error[i] * (t * scale);
        const float variance = box.at[1][i] * scale * scale + error * error;
        const float part = shb_chebyshev(t * scale, mean * scale, variance);
        lit[i] = part < lit[i] ? part : lit[i];
    }
}

static void exponential_variance(const shb_filter_args *args) {
    const shb_moment_map *moments = args->prepared;
    const float bleeding = args->filter->params[BLEEDING];
    shb_distance_batch receiver;
    shb_moment_receivers(moments, args->receivers, SPREAD, args->count, &receiver);
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = 1;
    for (int i = 0; i < moments->image_count; i++)
        bound(&moments->images[i], args, &receiver, args->visibility);
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = shb_less_bleeding(args->visibility[i], bleeding);
    shb_light_outside(args);
}

static shb_result check(const shb_map *map, const shb_filter *filter) {
    const float *params = filter->params;
    shb_result result = shb_filter_check_size(map, filter, params[SIZE]);
    if (result == SHB_OK)
        result = shb_filter_check_param(map, filter, "positive", params[POSITIVE], SHB_EXPONENT_MIN,
                                        SHB_EXPONENT_MAX);
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
    const shb_result result = check(map, filter);
    if (result != SHB_OK)
        return result;
    const shb_moment_map plan = {.size = (int)filter->params[SIZE],
                                 .image_count = 2,
                                 .images = {{.count = 2, .exponent = filter->params[POSITIVE]},
                                            {.count = 2, .exponent = -filter->params[NEGATIVE]}}};
    return shb_moment_map_prepare(map, filter->name, &plan, prepared, bytes);
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
