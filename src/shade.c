#include "strict.h"

#include "shadowbias/shade.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "context.h"
#include "fragments.h"
#include "frame.h"
#include "kernels/shade.h"
#include "terminator.h"
#include "visibility.h"

/* Pixels of a task: rows enough to meet triangles again. */
enum { TASK_COLUMNS = SHB_SPAN, TASK_ROWS = 32 };

/* One call of shb_shade, shared by its tasks. */
typedef struct shading {
    const shb_shade_desc *desc;
    shb_light_source lights[SHB_LIGHTS_MAX];
    shb_surface_view view;
    shb_filter filters[SHB_LIGHTS_MAX];
    const shb_shade_kernels *kernels;
    uint8_t empty_row[3 * TASK_COLUMNS + SHB_DISPLAY_MARGIN]; /* of a task */
    uint32_t tasks_across;
} shading;

/* The arrays of one task. */
typedef struct workspace {
    shb_fragment_reader reader;
    shb_fragment_batch batch;
    shb_lifted_points lifted; /* for a smooth terminator */
    shb_receivers receivers;
    shb_quick_test tests[SHB_LIGHTS_MAX];
    shb_lighting lighting[SHB_LIGHTS_MAX];
    SHB_ALIGN float red[SHB_BATCH];
    float green[SHB_BATCH];
    float blue[SHB_BATCH];
} workspace;

static shb_result fail(const shb_context *context, shb_result result, const char *what) {
    return shb_fail(context, result, "shb_shade: %s", what);
}

static bool are_finite(const float rgb[3]) {
    return isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
}

static shb_result check_image(const shb_context *context, const shb_shade_desc *desc) {
    const shb_image *image = &desc->image;
    if (!are_finite(desc->background))
        return fail(context, SHB_ERROR_NUMBER, "desc.background is not finite");
    if (!image->pixels)
        return SHB_OK;
    if (image->width != desc->frame.width || image->height != desc->frame.height)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_shade: desc.image is %u x %u, the frame is %u x %u",
                        (unsigned)image->width, (unsigned)image->height,
                        (unsigned)desc->frame.width, (unsigned)desc->frame.height);
    if (image->stride && image->stride < 3 * (size_t)image->width)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_shade: desc.image.stride %zu is below 3 * width %u", image->stride,
                        (unsigned)image->width);
    if (image->stride > PTRDIFF_MAX / image->height)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_shade: desc.image.stride %zu times desc.image.height %u overflows",
                        image->stride, (unsigned)image->height);
    return SHB_OK;
}

static shb_result check_lights(const shb_context *context, const shb_shade_desc *desc) {
    if (desc->light_count > SHB_LIGHTS_MAX)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_shade: desc.light_count %zu exceeds %d",
                        desc->light_count, SHB_LIGHTS_MAX);
    if (desc->light_count && !desc->lights)
        return fail(context, SHB_ERROR_ARGUMENT, "desc.lights is NULL");
    for (size_t k = 0; k < desc->light_count; k++) {
        const shb_shade_light *light = &desc->lights[k];
        if (!light->map)
            return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_shade: desc.lights[%zu].map is NULL",
                            k);
        if (!are_finite(light->color))
            return shb_fail(context, SHB_ERROR_NUMBER,
                            "shb_shade: desc.lights[%zu].color is not finite", k);
        char caller[48];
        snprintf(caller, sizeof caller, "shb_shade: desc.lights[%zu]", k);
        const shb_result result =
            shb_visibility_check(light->map, caller, light->bias, light->filter, true);
        if (result != SHB_OK)
            return result;
    }
    return SHB_OK;
}

static shb_result check(const shb_context *context, const shb_shade_desc *desc) {
    if (!desc)
        return fail(context, SHB_ERROR_ARGUMENT, "desc is NULL");
    if (!desc->shade)
        return fail(context, SHB_ERROR_ARGUMENT, "desc.shade is NULL");
    shb_result result = shb_frame_check(context, "shb_shade", &desc->frame);
    if (result == SHB_OK)
        result = check_image(context, desc);
    return result == SHB_OK ? check_lights(context, desc) : result;
}

/* A triangle that faces away has no plane that could tell of the smooth surface: there the
 * surface's own tangent plane does, and the triangle counts as facing the light. */
static void smooth_normals(uint32_t light, size_t lanes, const shb_fragments *fragments,
                           uint32_t *facing, shb_receivers *receivers) {
    for (size_t i = 0; i < lanes; i++) {
        const bool faces = (facing[i] >> light & 1) != 0;
        receivers->normal_x[i] = faces ? fragments->normal_x[i] : fragments->shading_x[i];
        receivers->normal_y[i] = faces ? fragments->normal_y[i] : fragments->shading_y[i];
        receivers->normal_z[i] = faces ? fragments->normal_z[i] : fragments->shading_z[i];
        facing[i] |= 1u << light;
    }
}

/* What light number light is asked about. Where the terminator is smooth, all triangles of the
 * batch count as facing it afterwards. */
static shb_quick_points asked_points(const shading *job, size_t light, size_t count,
                                     workspace *work) {
    const shb_fragments *fragments = &work->batch.fragments;
    shb_receivers *receivers = &work->receivers;
    if (!job->desc->smooth_terminator)
        return (shb_quick_points){
            .position = {fragments->x, fragments->y, fragments->z},
            .normal = {fragments->normal_x, fragments->normal_y, fragments->normal_z}};
    smooth_normals((uint32_t)light, shb_round_to_lanes(count), fragments, work->batch.facing,
                   receivers);
    return (shb_quick_points){
        .position = {work->lifted.x, work->lifted.y, work->lifted.z},
        .normal = {receivers->normal_x, receivers->normal_y, receivers->normal_z}};
}

/* A light's share of a batch; all fragments go through the map, so that vectors stay full. */
static void ask_light(const shading *job, size_t k, size_t count, workspace *work) {
    const shb_shade_light *light = &job->desc->lights[k];
    shb_lighting *lighting = &work->lighting[k];
    float *visibility = lighting->visibility;
    const shb_quick_points points = asked_points(job, k, count, work);
    const shb_fragments *fragments = &work->batch.fragments;
    const shb_own_triangles own = {fragments->id, fragments->weight_1, fragments->weight_2};
    const bool lifted = job->desc->smooth_terminator;
    const shb_asked_batch batch = {count, lifted, lifted ? NULL : &own, NULL};
    shb_visibility_batch(light->map, light->bias, &job->filters[k], &batch, &points,
                         &work->tests[k], &work->receivers, visibility);
    for (size_t i = count; i % SHB_LANES; i++)
        visibility[i] = visibility[count - 1];
    job->kernels->lighting(&job->lights[k], (uint32_t)k, count, &work->batch.fragments,
                           work->batch.facing, lighting);
}

static uint8_t *pixels_of(const shading *job, uint32_t row, uint32_t column) {
    const shb_image *image = &job->desc->image;
    const size_t stride = image->stride ? image->stride : 3 * (size_t)image->width;
    return image->pixels + row * stride + 3 * (size_t)column;
}

static void write_batch(const shading *job, const workspace *work) {
    uint8_t bytes[3 * SHB_BATCH + SHB_DISPLAY_MARGIN];
    const uint8_t *from = bytes;
    job->kernels->display(shb_round_to_lanes(work->batch.count), work->red, work->green, work->blue,
                          bytes);
    for (size_t i = 0; i < work->batch.piece_count; i++) {
        const shb_piece *piece = &work->batch.pieces[i];
        memcpy(pixels_of(job, piece->row, piece->column), from, 3 * (size_t)piece->count);
        from += 3 * (size_t)piece->count;
    }
}

static void color_batch(const shading *job, workspace *work) {
    const shb_shade_desc *desc = job->desc;
    const size_t count = work->batch.count;
    if (desc->smooth_terminator)
        shb_terminator_lift_batch(&work->reader, count, &work->batch.fragments, &work->lifted);
    for (size_t k = 0; k < desc->light_count; k++)
        ask_light(job, k, count, work);
    const size_t size = shb_round_to_lanes(count) * sizeof *work->red;
    memset(work->red, 0, size);
    memset(work->green, 0, size);
    memset(work->blue, 0, size);
    const shb_shade_args args = {.count = count,
                                 .fragments = &work->batch.fragments,
                                 .light_count = desc->light_count,
                                 .lights = desc->lights,
                                 .lighting = work->lighting,
                                 .user = desc->user,
                                 .red = work->red,
                                 .green = work->green,
                                 .blue = work->blue,
                                 .kernels = job->kernels};
    desc->shade(&args);
}

/* Shades the pixels that were taken into the batch, and empties it. */
static void shade_batch(const shading *job, workspace *work) {
    shb_fragments_read(&work->reader, &work->batch);
    if (work->batch.count) {
        color_batch(job, work);
        if (job->desc->image.pixels)
            write_batch(job, work);
    }
    shb_fragments_clear(&work->batch);
}

static uint32_t min_u32(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static void shade_block(void *arg, size_t index) {
    const shading *job = arg;
    const shb_frame *frame = &job->desc->frame;
    const uint32_t top = (uint32_t)index / job->tasks_across * TASK_ROWS;
    const uint32_t bottom = min_u32(top + TASK_ROWS, frame->height);
    const uint32_t left = (uint32_t)index % job->tasks_across * TASK_COLUMNS;
    const uint32_t right = min_u32(left + TASK_COLUMNS, frame->width);
    workspace work;
    shb_fragment_reader_init(&work.reader, job->kernels, frame, &job->view, left);
    shb_fragments_clear(&work.batch);
    for (size_t k = 0; k < job->desc->light_count; k++)
        work.tests[k].known = false;
    for (uint32_t row = top; row < bottom; row++) {
        const shb_piece span = {row, left, right - left};
        if (job->desc->image.pixels)
            memcpy(pixels_of(job, row, left), job->empty_row, 3 * (size_t)(right - left));
        shb_fragments_take(&work.reader, &span, &work.batch);
        if (work.batch.count + SHB_SPAN > SHB_BATCH)
            shade_batch(job, &work);
    }
    shade_batch(job, &work);
}

static void write_empty_row(shading *job) {
    float colors[3][TASK_COLUMNS];
    for (size_t i = 0; i < TASK_COLUMNS; i++)
        for (size_t k = 0; k < 3; k++)
            colors[k][i] = job->desc->background[k];
    job->kernels->display(TASK_COLUMNS, colors[0], colors[1], colors[2], job->empty_row);
}

shb_result shb_shade(shb_context *context, const shb_shade_desc *desc) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    const shb_result result = check(context, desc);
    if (result != SHB_OK)
        return result;
    shading job = {.desc = desc,
                   .kernels = context->shade_kernels,
                   .tasks_across = (desc->frame.width + TASK_COLUMNS - 1) / TASK_COLUMNS};
    if (shb_view_light_source(desc->frame.view, &job.view.eye) != SHB_OK)
        return fail(context, SHB_ERROR_NUMBER, "desc.frame.view cannot be inverted");
    job.view.camera = desc->frame.view;
    job.view.lights = job.lights;
    job.view.light_count = desc->light_count;
    for (size_t k = 0; k < desc->light_count; k++) {
        job.lights[k] = shb_map_get_info(desc->lights[k].map)->light;
        job.filters[k] = desc->lights[k].filter ? *desc->lights[k].filter : shb_filter_hard();
    }
    write_empty_row(&job);
    const uint32_t tasks_down = (desc->frame.height + TASK_ROWS - 1) / TASK_ROWS;
    shb_parallel_for(context, shade_block, &job, (size_t)job.tasks_across * tasks_down);
    return SHB_OK;
}
