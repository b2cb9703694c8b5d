#include "strict.h"

#include "moment_soft.h"

#include <float.h>

#include "project.h"

shb_result shb_moment_soft_prepare(const shb_map *map, const shb_filter *filter,
                                   const shb_moment_soft *plan, void **prepared, size_t *bytes) {
    const float light_size = filter->params[0];
    const shb_result result =
        shb_filter_check_param(map, filter, "light", light_size, FLT_MIN, FLT_MAX);
    if (result != SHB_OK)
        return result;
    shb_moment_soft *made = shb_alloc(map->context, 1, sizeof *made);
    if (made)
        *made = *plan;
    bool complete = made && shb_light_span_create(map, light_size, &made->span);
    size_t made_bytes = complete ? sizeof *made + made->span.minima.bytes : 0;
    if (complete)
        made->distance = shb_distance_of(map);
    for (int i = 0; i < plan->image_count && complete; i++) {
        complete = shb_moment_pyramid_create(map, &made->distance, &made->images[i]);
        made_bytes += made->images[i].bytes;
    }
    if (!complete) {
        shb_moment_soft_release(map, made);
        return shb_fail(map->context, SHB_ERROR_MEMORY,
                        "shb_map_prepare: no memory for the filter \"%s\" over %u by %u texels",
                        filter->name, (unsigned)map->info.width, (unsigned)map->info.height);
    }
    *prepared = made;
    *bytes = made_bytes;
    return SHB_OK;
}

void shb_moment_soft_release(const shb_map *map, void *prepared) {
    shb_moment_soft *soft = prepared;
    if (!soft)
        return;
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
    shb_moment_judge *judge;
    size_t lanes;
    bool open[SHB_BATCH];
    float depth[SHB_BATCH], nearest[SHB_BATCH];
    SHB_ALIGN float square_widths[SHB_BATCH]; /* of the kernel that is asked */
} soft_batch;

static bool open_batch(soft_batch *batch) {
    const shb_filter_args *args = batch->args;
    const shb_light_span *span = &batch->soft->span;
    bool any = false;
    for (size_t i = 0; i < batch->lanes; i++) {
        shb_light_place place = {0, 0, span->near_depth};
        bool open = shb_light_place_of(args->map, span, args->receivers, i, &place);
        const float nearest = open ? shb_light_span_nearest(args->map, span, &place) : place.depth;
        batch->depth[i] = place.depth;
        batch->nearest[i] = nearest;
        batch->open[i] = nearest < place.depth;
        any |= batch->open[i];
    }
    return any;
}

/* The kernel that the light spans for a blocker so much nearer than the fragment: the mean of both
 * axes, where texels are not squares. */
static float square_width(const shb_moment_soft *soft, float nearer_by) {
    const float x = soft->span.x * nearer_by, y = soft->span.y * nearer_by;
    const float width = 0.5f * (x * x + y * y);
    const float least = shb_moment_pyramid_least();
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
    shb_moment_receivers(&soft->distance, args->receivers, spreads, args->count, &receiver);
    for (int i = 0; i < soft->image_count; i++)
        shb_moment_pyramid_sample(&soft->images[i], args->info, args->receivers,
                                  batch->square_widths, args->count, &images[i]);
    const shb_moment_question question = {args->count, args->filter->params, &receiver, images};
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
    for (size_t i = 0; i < batch->lanes; i++)
        batch->square_widths[i] = square_width(batch->soft, batch->depth[i] - batch->nearest[i]);
    ask(batch, none, found);
}

/* Kernels as wide as the penumbra of what was found; false if nothing was. */
static bool widths_of_penumbras(soft_batch *batch, const shb_moment_answer *found) {
    const shb_moment_soft *soft = batch->soft;
    bool any = false;
    for (size_t i = 0; i < batch->lanes; i++) {
        const float at = found->blocker[i] > 0 ? found->blocker[i] : 0;
        const float depth = shb_distance_to_depth(&soft->distance, at);
        const float blocker = depth > batch->nearest[i] ? depth : batch->nearest[i];
        batch->square_widths[i] = square_width(soft, batch->depth[i] - blocker);
        batch->open[i] &= found->lit[i] < 1;
        any |= batch->open[i];
    }
    return any;
}

void shb_moment_soft_visibility(const shb_filter_args *args, shb_moment_judge *judge,
                                float bleeding) {
    soft_batch batch = {.args = args, .soft = args->prepared, .judge = judge};
    shb_moment_answer found, answer;
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
