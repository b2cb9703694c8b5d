#include "measure.h"

#include "paint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Keeps the fragments of a batch at the places of their pixels, so that threads do not meet. */
static void capture_fragments(const shb_shade_args *args) {
    const measure_frame *frame = args->user;
    const shb_fragments *fragments = args->fragments;
    for (size_t i = 0; i < args->count; i++) {
        const size_t pixel =
            (size_t)fragments->pixel_y[i] * frame->frame.width + (size_t)fragments->pixel_x[i];
        const float position[3] = {fragments->x[i], fragments->y[i], fragments->z[i]};
        const float normal[3] = {fragments->normal_x[i], fragments->normal_y[i],
                                 fragments->normal_z[i]};
        memcpy(frame->positions + 3 * pixel, position, sizeof position);
        memcpy(frame->normals + 3 * pixel, normal, sizeof normal);
        frame->weights_1[pixel] = fragments->weight_1[i];
        frame->weights_2[pixel] = fragments->weight_2[i];
        args->red[i] = args->green[i] = args->blue[i] = 0;
    }
}

/* Closes the gaps that pixels without a fragment left. */
static void compact_fragments(measure_frame *frame) {
    const size_t pixel_count = (size_t)frame->frame.width * frame->frame.height;
    size_t count = 0;
    for (size_t pixel = 0; pixel < pixel_count; pixel++) {
        if (frame->ids[pixel] == SHB_ID_NONE)
            continue;
        memmove(frame->positions + 3 * count, frame->positions + 3 * pixel, 3 * sizeof(float));
        memmove(frame->normals + 3 * count, frame->normals + 3 * pixel, 3 * sizeof(float));
        frame->own_ids[count] = frame->ids[pixel];
        frame->weights_1[count] = frame->weights_1[pixel];
        frame->weights_2[count] = frame->weights_2[pixel];
        frame->pixels[count++] = (uint32_t)pixel;
    }
    frame->fragment_count = count;
}

static bool allocate_frame(measure_frame *frame, size_t pixel_count) {
    frame->ids = malloc(pixel_count * sizeof *frame->ids);
    frame->positions = malloc(pixel_count * 3 * sizeof *frame->positions);
    frame->normals = malloc(pixel_count * 3 * sizeof *frame->normals);
    frame->own_ids = malloc(pixel_count * sizeof *frame->own_ids);
    frame->weights_1 = malloc(pixel_count * sizeof *frame->weights_1);
    frame->weights_2 = malloc(pixel_count * sizeof *frame->weights_2);
    frame->pixels = malloc(pixel_count * sizeof *frame->pixels);
    frame->visibility = malloc(pixel_count * sizeof *frame->visibility);
    return frame->ids && frame->positions && frame->normals && frame->own_ids && frame->weights_1 &&
           frame->weights_2 && frame->pixels && frame->visibility;
}

static shb_result draw_frame(measure_frame *frame) {
    const shb_draw_desc draw = {.view = &frame->view,
                                .scene = &frame->scene->scene,
                                .width = frame->frame.width,
                                .height = frame->frame.height,
                                .ids = frame->ids};
    const shb_result result = shb_draw(frame->context, &draw, NULL);
    if (result)
        return result;
    const shb_shade_desc capture = {
        .frame = frame->frame, .shade = capture_fragments, .user = frame};
    return shb_shade(frame->context, &capture);
}

shb_result measure_frame_create(shb_context *context, const example_scene *scene, uint32_t width,
                                uint32_t height, measure_frame *frame) {
    *frame = (measure_frame){.context = context, .scene = scene};
    shb_result result = scene_camera_view(scene, width, height, &frame->view);
    if (!result && !allocate_frame(frame, (size_t)width * height))
        result = SHB_ERROR_MEMORY;
    frame->frame = (shb_frame){.view = &frame->view,
                               .scene = &scene->scene,
                               .width = width,
                               .height = height,
                               .ids = frame->ids};
    if (!result)
        result = draw_frame(frame);
    if (result)
        measure_frame_destroy(frame);
    else
        compact_fragments(frame);
    return result;
}

void measure_frame_destroy(measure_frame *frame) {
    free(frame->ids);
    free(frame->positions);
    free(frame->normals);
    free(frame->own_ids);
    free(frame->weights_1);
    free(frame->weights_2);
    free(frame->pixels);
    free(frame->visibility);
    *frame = (measure_frame){0};
}

shb_points measure_positions(const measure_frame *frame) {
    return (shb_points){
        .count = frame->fragment_count, .positions = frame->positions, .normals = frame->normals};
}

shb_points measure_points(const measure_frame *frame) {
    shb_points points = measure_positions(frame);
    points.own = (shb_own_triangles){frame->own_ids, frame->weights_1, frame->weights_2};
    return points;
}

shb_result measure_truth_create(const measure_frame *frame, const shb_map *map,
                                measure_truth *truth) {
    *truth = (measure_truth){0};
    shb_result result =
        shb_reference_create(frame->context, &frame->scene->scene, &truth->reference);
    if (result)
        return result;
    truth->pixels = malloc((size_t)frame->frame.width * frame->frame.height);
    truth->fragments = malloc(frame->fragment_count + 1);
    const shb_classify_desc classify = {.frame = frame->frame, .map = map};
    result = truth->pixels && truth->fragments
                 ? shb_reference_classify(truth->reference, &classify, truth->pixels)
                 : SHB_ERROR_MEMORY;
    if (result)
        measure_truth_destroy(truth);
    else
        for (size_t i = 0; i < frame->fragment_count; i++)
            truth->fragments[i] = truth->pixels[frame->pixels[i]];
    return result;
}

void measure_truth_destroy(measure_truth *truth) {
    shb_reference_destroy(truth->reference);
    free(truth->pixels);
    free(truth->fragments);
    *truth = (measure_truth){0};
}

/* What a method is timed by: a map's drawing and its answers for a frame. */
typedef struct method_work {
    const measure_frame *frame;
    shb_map *map;
    const shb_bias *bias;
    const shb_filter *filter;
} method_work;

static shb_result draw_map(void *state) {
    const method_work *work = state;
    return shb_map_draw(work->map, &work->frame->scene->scene, work->bias, NULL);
}

static shb_result ask_map(void *state) {
    const method_work *work = state;
    const shb_points points = measure_points(work->frame);
    return shb_map_visibility(work->map, &points, work->bias, work->filter,
                              work->frame->visibility);
}

shb_result measure_visibility(const measure_frame *frame, shb_map *map, const shb_bias *bias,
                              const shb_filter *filter, uint32_t runs, bench_times *times) {
    method_work work = {frame, map, bias, filter};
    const shb_result result = filter ? shb_map_prepare(map, filter) : SHB_OK;
    return result ? result
                  : bench_measure((bench_work){ask_map, &work}, BENCH_CLOCK_THREAD,
                                  (bench_plan){.runs = runs}, times);
}

shb_result measure_detachment(const shb_reference *reference, const shb_map *map,
                              const shb_bias *bias, const shb_filter *filter,
                              const scene_contact *contact, shb_detachment *detachment) {
    *detachment = (shb_detachment){(double)NAN, (double)NAN, 0};
    if (!contact || contact->length <= 0)
        return SHB_OK;
    const shb_detachment_desc desc = {.map = map,
                                      .bias = bias,
                                      .filter = filter,
                                      .contact = contact->contact,
                                      .direction = contact->direction,
                                      .normal = contact->normal,
                                      .length = contact->length,
                                      .samples = 1000,
                                      .receiver_id = SHB_ID_NONE};
    return shb_detachment_measure(reference, &desc, detachment);
}

shb_result measure_method(measure_frame *frame, const measure_truth *truth, shb_map *map,
                          const shb_bias *bias, const shb_filter *filter,
                          const scene_contact *contact, uint32_t runs, measure_result *result) {
    measure_result measured = {0};
    method_work work = {frame, map, bias, filter};
    bench_times drawing, asking;
    shb_result code = bench_measure((bench_work){draw_map, &work}, BENCH_CLOCK_WALL,
                                    (bench_plan){.runs = runs}, &drawing);
    if (!code)
        code = measure_visibility(frame, map, bias, filter, runs, &asking);
    if (!code)
        code = shb_errors_measure(frame->fragment_count, truth->fragments, frame->visibility,
                                  &measured.errors);
    if (!code)
        code =
            measure_detachment(truth->reference, map, bias, filter, contact, &measured.detachment);
    if (code)
        return code;
    measured.map_seconds = drawing.median;
    measured.visibility_seconds = asking.median;
    if (frame->fragment_count)
        measured.ns_per_fragment =
            1e9 * measured.visibility_seconds / (double)frame->fragment_count;
    *result = measured;
    return SHB_OK;
}

static void fill_evenly(const shb_filter_args *args) {
    const float visibility = args->filter->params[0];
    for (size_t i = 0; i < SHB_BATCH; i++)
        args->visibility[i] = visibility;
}

shb_filter measure_even_filter(float visibility) {
    return (shb_filter){.name = "even", .filter = fill_evenly, .params = {visibility}};
}

shb_result measure_paint(const measure_frame *frame, const shb_map *map, const shb_bias *bias,
                         const shb_filter *filter, const float light_color[3],
                         const shb_image *image) {
    const float *background = frame->scene->background;
    const shb_shade_light light = {
        .map = map,
        .bias = bias,
        .filter = filter,
        .color = {light_color[0], light_color[1], light_color[2]},
    };
    const shb_shade_desc desc = {.frame = frame->frame,
                                 .lights = &light,
                                 .light_count = 1,
                                 .shade = paint_scene,
                                 .user = frame->scene,
                                 .background = {background[0], background[1], background[2]},
                                 .image = *image};
    return shb_shade(frame->context, &desc);
}

shb_result measure_paint_errors(const measure_frame *frame, const measure_truth *truth,
                                const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                                const shb_image *image) {
    const shb_shade_light light = {.map = map, .bias = bias, .filter = filter, .color = {1, 1, 1}};
    const shb_shade_error_params params = {.truth = truth->pixels, .stride = frame->frame.width};
    const shb_shade_desc desc = {.frame = frame->frame,
                                 .lights = &light,
                                 .light_count = 1,
                                 .shade = shb_shade_error,
                                 .user = &params,
                                 .background = {0.1f, 0.1f, 0.1f},
                                 .image = *image};
    return shb_shade(frame->context, &desc);
}
