/* Exponential variance shadow maps: Lauritzen and McCool 2008, sections 4 and 5. Chebyshev's bound
 * holds for any growing function of the distance; that of exp(positive x) bleeds little behind
 * occluders that are far from the receiver, that of -exp(-negative x) little behind several
 * occluders one above the other. The smaller bound counts. */
#include "strict.h"

#include "moment_soft.h"

#include "exponential.h"
#include "project.h"

enum { SIZE, POSITIVE, NEGATIVE, BLEEDING };

static float magnitude(float value) {
    return value < 0 ? -value : value;
}

/* The distance that shb_moment_warp takes to this; limited to 0 .. at. */
static float unwarped(float exponent, float warped, float at) {
    const float size = exponent > 0 ? warped : -warped;
    const float largest = shb_exponential(magnitude(exponent) / 2), least = 1 / largest;
    const float inside = size > least ? (size < largest ? size : largest) : least;
    const float distance = 0.5f + shb_logarithm(inside) / exponent;
    return distance < at ? distance : at;
}

/* Takes the bound of one image. Distances are scaled to the larger of mean and receiver, whose
 * squares may leave the range of floats. */
static void judge_image(const shb_moment_question *question, const shb_moment_batch *box,
                        float exponent, shb_moment_answer *answer) {
    const shb_distance_batch *receiver = question->receiver;
    for (size_t i = 0; i < shb_round_to_lanes(question->count); i++) {
        const float t = shb_moment_warp(exponent, receiver->at[i]), mean = box->at[0][i];
        const float largest = magnitude(t) > magnitude(mean) ? magnitude(t) : magnitude(mean);
        const float scale = 1 / largest;
        const float error = exponent * receiver->error[i] * (t * scale);
        const float variance = box->at[1][i] * scale * scale + error * error;
        const float part = shb_chebyshev(t * scale, mean * scale, variance);
        if (!(part < answer->lit[i]))
            continue;
        const float below = shb_chebyshev_below(t * scale, mean * scale, variance) * largest;
        answer->lit[i] = part;
        answer->blocker[i] = unwarped(exponent, below, receiver->at[i]);
    }
}

static void judge(const shb_moment_question *question, shb_moment_answer *answer) {
    for (size_t i = 0; i < shb_round_to_lanes(question->count); i++) {
        answer->lit[i] = 1;
        answer->blocker[i] = 1;
    }
    judge_image(question, &question->images[0], question->params[POSITIVE], answer);
    judge_image(question, &question->images[1], -question->params[NEGATIVE], answer);
}

static void exponential_variance(const shb_filter_args *args) {
    shb_moment_map_visibility(args, judge, false, args->filter->params[BLEEDING]);
}

static void exponential_variance_soft(const shb_filter_args *args) {
    shb_moment_soft_visibility(args, judge, args->filter->params[BLEEDING]);
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
