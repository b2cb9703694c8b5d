#include "strict.h"

#include "moment_soft.h"

#include <float.h>

#include "filter_check.h"
#include "kernels/moments.h"
#include "project.h"

/* NULL: no memory. */
static shb_moment_soft *create(const shb_map *map, float light_size, const shb_moment_soft *plan) {
    shb_moment_soft *made = shb_alloc(map->context, 1, sizeof *made);
    if (!made)
        return NULL;
    *made = *plan;
    bool complete = shb_light_span_create(map, light_size, &made->span);
    for (int i = 0; i < plan->image_count && complete; i++)
        complete = shb_moment_pyramid_create(map, &made->images[i]);
    if (complete)
        return made;
    shb_moment_soft_release(map, made);
    return NULL;
}

shb_result shb_moment_soft_prepare(const shb_map *map, const shb_filter *filter,
                                   const shb_moment_soft *plan, void **prepared, size_t *bytes) {
    const float light_size = filter->params[0];
    const shb_result result =
        shb_filter_check_param(map, filter, "light", light_size, FLT_MIN, FLT_MAX);
    if (result != SHB_OK)
        return result;
    shb_moment_soft *made = *prepared ? *prepared : create(map, light_size, plan);
    if (!made)
        return shb_filter_no_memory(map, filter);
    shb_light_span_fill(map, &made->span);
    made->distance = shb_distance_of(map);
    size_t made_bytes = sizeof *made + made->span.minima.bytes;
    for (int i = 0; i < plan->image_count; i++) {
        shb_moment_pyramid_fill(map, &made->distance, &made->images[i]);
        made_bytes += made->images[i].bytes;
    }
    *prepared = made;
    *bytes = made_bytes;
    return SHB_OK;
}

void shb_moment_soft_release(const shb_map *map, void *prepared) {
    shb_moment_soft *soft = prepared;
    for (int i = 0; i < soft->image_count; i++)
        shb_moment_pyramid_destroy(map, &soft->images[i]);
    shb_light_span_destroy(map, &soft->span);
    shb_free(map->context, soft);
}

/* Fragments that something may block, from where the light's ray meets their plane to the nearest
 * of all that could stand between. */
typedef struct soft_batch {
    const shb_filter_args *args;
    const shb_moment_soft *soft;
    const shb_moment_kernels *kernels;
    shb_moment_judge *judge;
    size_t lanes;
    bool open[SHB_BATCH];
    shb_light_windows windows;
    SHB_ALIGN float square_widths[SHB_BATCH]; /* of the kernel that is asked */
} soft_batch;

static bool open_batch(soft_batch *batch) {
    const shb_filter_args *args = batch->args;
    shb_light_windows *windows = &batch->windows;
    batch->kernels->windows(args->map, &batch->soft->span, args->count, args->receivers, windows);
    bool any = false;
    for (size_t i = 0; i < batch->lanes; i++) {
        batch->open[i] = windows->nearest[i] < windows->depth[i];
        any |= batch->open[i];
    }
    return any;
}

/* The kernel that the light spans for a blocker so much nearer than the fragment: the mean of both
 * axes, where texels are not squares. */
static float square_width(const shb_moment_soft *soft, float nearer_by) {
    const float x = soft->span.x * nearer_by, y = soft->span.y * nearer_by;
    const float width = 0.5f * (x * x + y * y);
    const float least = shb_moment_pyramid_least(&soft->images[0]);
    const float most = shb_moment_pyramid_most(&soft->images[0]);
    const float enough = width > least ? width : least;
    return enough < most ? enough : most;
}

/* spreads: how widely the receiver's own plane spreads, as square widths of kernels. */
static void ask(const soft_batch *batch, const float *spreads, shb_moment_answer *answer) {
    const shb_filter_args *args = batch->args;
    const shb_moment_soft *soft = batch->soft;
    shb_distance_batch receiver;
    shb_moment_batch images[SHB_MOMENT_IMAGES_MAX];
    float exponents[SHB_MOMENT_IMAGES_MAX];
    batch->kernels->receivers(&soft->distance, args->count, args->receivers, spreads, &receiver);
    for (int i = 0; i < soft->image_count; i++) {
        exponents[i] = soft->images[i].exponent;
        batch->kernels->sample_pyramid(&soft->images[i], args->info, args->count, args->receivers,
                                       batch->square_widths, &images[i]);
    }
    const shb_moment_question question = {args->count, exponents, &receiver, images};
    batch->judge(&question, answer);
}

/* Kernels between boxes lean to one side: by a skewness of 1/16, which takes no more than 1/32 of a
 * deviation. */
static void widen(const soft_batch *batch, float *spreads) {
    for (size_t i = 0; i < batch->lanes; i++)
        spreads[i] = batch->square_widths[i] * 1.0635f;
}

/* Blockers closer to a plane than its own spread over so wide a kernel would be lost if the
 * receiver were taken nearer here. A plane that blocks itself here is lit by the second stage. */
static void search(soft_batch *batch, shb_moment_answer *found) {
    SHB_ALIGN static const float none[SHB_BATCH];
    const shb_light_windows *windows = &batch->windows;
    for (size_t i = 0; i < batch->lanes; i++)
        batch->square_widths[i] =
            square_width(batch->soft, windows->depth[i] - windows->nearest[i]);
    ask(batch, none, found);
}

/* Kernels as wide as the penumbra of what was found; false if nothing was. */
static bool widths_of_penumbras(soft_batch *batch, const shb_moment_answer *found) {
    const shb_moment_soft *soft = batch->soft;
    const shb_light_windows *windows = &batch->windows;
    bool any = false;
    for (size_t i = 0; i < batch->lanes; i++) {
        const float at = found->blocker[i] > 0 ? found->blocker[i] : 0;
        const float depth = shb_distance_to_depth(&soft->distance, at);
        const float blocker = depth > windows->nearest[i] ? depth : windows->nearest[i];
        batch->square_widths[i] = square_width(soft, windows->depth[i] - blocker);
        batch->open[i] &= found->lit[i] < 1;
        any |= batch->open[i];
    }
    return any;
}

void shb_moment_soft_visibility(const shb_filter_args *args, shb_moment_judge *judge,
                                float bleeding) {
    soft_batch batch;
    shb_moment_answer found, answer;
    batch.args = args;
    batch.soft = args->prepared;
    batch.kernels = shb_moment_kernels_in(args);
    batch.judge = judge;
    batch.lanes = shb_round_to_lanes(args->count);
    bool any = open_batch(&batch);
    if (any) {
        search(&batch, &found);
        any = widths_of_penumbras(&batch, &found);
    }
    if (any) {
        SHB_ALIGN float spreads[SHB_BATCH];
        widen(&batch, spreads);
        ask(&batch, spreads, &answer);
    }
    for (size_t i = 0; i < args->count; i++)
        answer.lit[i] = batch.open[i] ? answer.lit[i] : 1;
    shb_moment_finish(args, bleeding, answer.lit);
}
