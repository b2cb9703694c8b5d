#include "stages.h"

#include "light_work.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FRAGMENTS_MIN 500000

/* Of the map under the stage shade, whose time depends little on it. */
#define SHADE_MAP_SIZE 2048

/* A stage over all fragments of a frame. */
typedef struct light_stage {
    const char *group, *prefix;
    bench_work (*work)(light_work *work);
} light_stage;

static const light_stage visibility_stage = {"visibility", "hard", light_work_visibility};
static const light_stage shade_stage = {"shade", "shade", light_work_shade};
static const light_stage frame_stage = {"frame", "frame", light_work_frame};

/* The camera's picture, made larger until there are fragments enough; empty if none is in sight. */
static shb_result create_frame(shb_context *context, const example_scene *scene,
                               measure_frame *frame) {
    uint32_t size = 1024;
    shb_result result = measure_frame_create(context, scene, size, size, frame);
    if (result || frame->fragment_count >= FRAGMENTS_MIN || frame->fragment_count == 0)
        return result;
    const double factor = sqrt(1.02 * FRAGMENTS_MIN / (double)frame->fragment_count);
    size = factor < 8 ? (uint32_t)(size * factor) + 1 : 8 * size;
    measure_frame_destroy(frame);
    return measure_frame_create(context, scene, size, size, frame);
}

/* What the stage must read and write at least: points in, visibility out, and a texel each; or ids
 * in, colours out, and a texel each; a whole frame also writes map and ids. */
static double least_bytes(const light_stage *stage, const light_work *work, double texels) {
    const double fragments = (double)work->frame->fragment_count;
    const double pixels = (double)work->frame->frame.width * work->frame->frame.height;
    const bool by_normal = work->bias.needs & (SHB_NEEDS_NORMAL | SHB_NEEDS_SLOPE);
    if (stage == &visibility_stage)
        return fragments * (12 + (by_normal ? 12 : 0) + 4 + 4);
    const double shading = pixels * (4 + 3) + fragments * 4;
    return stage == &shade_stage ? shading : shading + 4 * pixels + 4 * texels;
}

static bool time_stage(bench_session *session, const light_stage *stage, light_work *work,
                       light_work *scalar, const char *title) {
    const shb_map_info *info = shb_map_get_info(work->map);
    const double pixels = (double)work->frame->frame.width * work->frame->frame.height;
    const double map_texels = (double)info->width * info->height;
    bench_row row = {.triangles = work->frame->scene->triangle_count,
                     .size = info->width,
                     .items = (double)work->frame->fragment_count,
                     .by_fragment = true,
                     .bytes = least_bytes(stage, work, map_texels)};
    row.texels = stage == &visibility_stage ? row.items
                 : stage == &shade_stage    ? pixels
                                            : pixels + map_texels;
    row.limit_seconds = machine_copy_seconds(&session->machine, row.bytes);
    snprintf(row.stage, sizeof row.stage, "%s:%s", stage->prefix, work->bias.name);
    snprintf(row.scene, sizeof row.scene, "%s", title);
    if (!options_want(&session->options, stage->group, row.stage))
        return true;
    return stages_measure(session, stage->work(work),
                          scalar ? stage->work(scalar) : (bench_work){0}, &row);
}

/* Visibility and, at one map size, shading by the method that the work has. */
static bool time_method(bench_session *session, light_work *work, const char *title) {
    light_work scalar = {0};
    if (session->scalar &&
        !session_succeeds(title, light_work_share(session->scalar, work, &scalar)))
        return false;
    const uint32_t size = shb_map_get_info(work->map)->width;
    light_work *const reference = scalar.context ? &scalar : NULL;
    bool done = time_stage(session, &visibility_stage, work, reference, title);
    if (done && (size == SHADE_MAP_SIZE || session->options.size))
        done = time_stage(session, &shade_stage, work, reference, title);
    light_work_destroy(&scalar);
    return done;
}

static bool is_wanted(const bench_session *session, const char *method) {
    static const char *const few[] = {"none", "constant", "slope", "receiver-plane", "adaptive"};
    if (!session->options.quick)
        return true;
    for (size_t i = 0; i < sizeof few / sizeof *few; i++)
        if (strcmp(method, few[i]) == 0)
            return true;
    return false;
}

static bool time_methods(bench_session *session, const measure_frame *frame, uint32_t size,
                         const char *title) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    const shb_bias none = shb_bias_none();
    light_work work;
    if (!session_succeeds(title, light_work_create(session->context, frame, size, &none, &work)))
        return false;
    bool done = true;
    for (size_t i = 0; i < count && done; i++) {
        if (!is_wanted(session, methods[i].name))
            continue;
        const shb_bias bias = methods[i].make();
        done = session_succeeds(title, light_work_set_bias(&work, &bias)) &&
               time_method(session, &work, title);
    }
    light_work_destroy(&work);
    return done;
}

static bool time_frame(bench_session *session, const measure_frame *frame, uint32_t size,
                       const shb_bias *bias, const char *title) {
    light_work work, scalar = {0};
    if (!session_succeeds(title, light_work_create(session->context, frame, size, bias, &work)))
        return false;
    bool done =
        !session->scalar ||
        session_succeeds(title, light_work_create(session->scalar, frame, size, bias, &scalar));
    if (done)
        done = time_stage(session, &frame_stage, &work, scalar.context ? &scalar : NULL, title);
    light_work_destroy(&scalar);
    light_work_destroy(&work);
    return done;
}

static bool time_sizes(bench_session *session, const measure_frame *frame, const char *title) {
    const shb_bias methods[] = {shb_bias_methods(NULL)[1].make(), shb_bias_adaptive(1e-4f, 0)};
    const bench_options *options = &session->options;
    const uint32_t *sizes;
    const size_t count = options_sizes(options, &sizes);
    const bool by_method =
        options_want(options, "visibility", NULL) || options_want(options, "shade", NULL);
    for (size_t i = 0; i < count; i++) {
        progress_step(&session->progress, title);
        if (by_method && !time_methods(session, frame, sizes[i], title))
            return false;
        for (size_t k = 0; k < 2 && options_want(options, "frame", NULL); k++)
            if (!time_frame(session, frame, sizes[i], &methods[k], title))
                return false;
    }
    return true;
}

bool stages_light(bench_session *session, const example_scene *scene, const char *title) {
    const bench_options *options = &session->options;
    if (!options_want(options, "visibility", NULL) && !options_want(options, "shade", NULL) &&
        !options_want(options, "frame", NULL))
        return true;
    measure_frame frame;
    if (!session_succeeds(title, create_frame(session->context, scene, &frame)))
        return false;
    const bool done = frame.fragment_count == 0 || time_sizes(session, &frame, title);
    measure_frame_destroy(&frame);
    return done;
}
