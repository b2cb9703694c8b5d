#include "soft_work.h"

#include <stdlib.h>

static shb_result run_map(void *state) {
    soft_work *work = state;
    const shb_result result =
        shb_map_draw(work->map, &work->frame->scene->scene, &work->bias, NULL);
    return result || work->unprepared ? result : shb_map_prepare(work->map, &work->filter);
}

static shb_result run_camera(void *state) {
    soft_work *work = state;
    const shb_frame *frame = &work->frame->frame;
    const shb_draw_desc desc = {.view = frame->view,
                                .scene = frame->scene,
                                .width = frame->width,
                                .height = frame->height,
                                .ids = work->frame->ids};
    return shb_draw(work->context, &desc, NULL);
}

static shb_result run_visibility(void *state) {
    soft_work *work = state;
    const measure_frame *frame = work->frame;
    const shb_points points = measure_points(frame);
    return shb_map_visibility(work->map, &points, &work->bias, &work->filter, frame->visibility);
}

static shb_result run_shade(void *state) {
    soft_work *work = state;
    const shb_shade_light light = {
        .map = work->map, .bias = &work->bias, .filter = &work->filter, .color = {1, 1, 1}};
    const shb_shade_desc desc = {.frame = work->frame->frame,
                                 .lights = &light,
                                 .light_count = 1,
                                 .shade = shb_shade_lambert,
                                 .image = work->image};
    return shb_shade(work->context, &desc);
}

static shb_result run_overall(void *state) {
    const shb_result result = run_map(state);
    return result ? result : run_shade(state);
}

static bench_work map_work(soft_work *work) {
    return (bench_work){run_map, work};
}

bench_work soft_work_camera(soft_work *work) {
    return (bench_work){run_camera, work};
}

bench_work soft_work_visibility(soft_work *work) {
    return (bench_work){run_visibility, work};
}

bench_work soft_work_shade(soft_work *work) {
    return (bench_work){run_shade, work};
}

bench_work soft_work_overall(soft_work *work) {
    return (bench_work){run_overall, work};
}

shb_result soft_work_create(shb_context *context, const measure_frame *frame,
                            const soft_work_desc *desc, soft_work *work) {
    const uint32_t width = frame->frame.width, height = frame->frame.height;
    *work = (soft_work){.context = context,
                        .frame = frame,
                        .unprepared = desc->unprepared,
                        .image = {malloc((size_t)width * height * 3), width, height, 0}};
    shb_result result = shb_bias_parse(desc->bias, &work->bias);
    if (!result)
        result = shb_filter_parse(desc->filter, &work->filter);
    if (!result && !work->image.pixels)
        result = SHB_ERROR_MEMORY;
    const bool asks_occluders = work->bias.needs & SHB_NEEDS_OCCLUDERS;
    shb_map_desc map = {.width = desc->map_size,
                        .occluders = asks_occluders ? SHB_OCCLUDERS_PLANES : SHB_OCCLUDERS_NONE};
    if (!result)
        result = scene_light_view(frame->scene, desc->light, desc->map_size, true, &map.view);
    if (!result)
        result = shb_map_create(context, &map, &work->map);
    if (!result)
        result = run_map(work);
    if (result)
        soft_work_destroy(work);
    return result;
}

void soft_work_destroy(soft_work *work) {
    shb_map_destroy(work->map);
    free(work->image.pixels);
    *work = (soft_work){0};
}

bool soft_work_is_served(const char *bias, const char *filter) {
    shb_bias parsed_bias;
    shb_filter parsed_filter;
    return shb_bias_parse(bias, &parsed_bias) == SHB_OK &&
           shb_filter_parse(filter, &parsed_filter) == SHB_OK &&
           (parsed_filter.exact || !(parsed_bias.needs & SHB_NEEDS_OCCLUDERS));
}

shb_result soft_work_compare(soft_work *first, soft_work *second, bench_plan plan,
                             soft_work_times times[2]) {
    bench_comparison map, shade;
    shb_result result =
        bench_compare(map_work(first), map_work(second), BENCH_CLOCK_THREAD, plan, &map);
    if (!result)
        result = bench_compare(soft_work_shade(first), soft_work_shade(second), BENCH_CLOCK_THREAD,
                               plan, &shade);
    if (result)
        return result;
    times[0] = (soft_work_times){map.first.median, shade.first.median};
    times[1] = (soft_work_times){map.second.median, shade.second.median};
    return SHB_OK;
}
