#include "stages.h"

#include "light_work.h"
#include "tool.h"

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

/* A method that --only names is always wanted; else whole frames show the price of two methods, and
 * shading is measured at one map size. */
static bool is_wanted(const bench_options *options, const light_stage *stage, const char *method,
                      uint32_t size) {
    static const char *const framed[] = {"constant", "adaptive", NULL};
    static const char *const few[] = {"constant", "adaptive",       "none",
                                      "slope",    "receiver-plane", NULL};
    char name[64];
    snprintf(name, sizeof name, "%s:%s", stage->prefix, method);
    if (options->only && strchr(options->only, ':'))
        return strcmp(options->only, name) == 0;
    if (!options_want(options, stage->group, name))
        return false;
    if (stage == &shade_stage && size != SHADE_MAP_SIZE && !options->size)
        return false;
    return stage == &frame_stage ? tool_is_among(method, framed)
                                 : !options->quick || tool_is_among(method, few);
}

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
    snprintf(row.stage, sizeof row.stage, "%s:%s", stage->prefix, work->name);
    snprintf(row.scene, sizeof row.scene, "%s", title);
    if (!is_wanted(&session->options, stage, work->name, info->width))
        return true;
    return stages_measure(session, stage->work(work),
                          scalar ? stage->work(scalar) : (bench_work){0}, &row);
}

/* Visibility by the method that the work has, and shading if it is wanted, too. */
static bool time_method(bench_session *session, light_work *work, bool shades, const char *title) {
    light_work scalar = {0};
    if (session->scalar &&
        !session_succeeds(title, light_work_share(session->scalar, work, &scalar)))
        return false;
    light_work *const reference = scalar.context ? &scalar : NULL;
    const bool done = time_stage(session, &visibility_stage, work, reference, title) &&
                      (!shades || time_stage(session, &shade_stage, work, reference, title));
    light_work_destroy(&scalar);
    return done;
}

/* The wanted methods, by turns on one map. */
static bool time_methods(bench_session *session, const measure_frame *frame, uint32_t size,
                         const char *title) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    light_work work = {0};
    bool done = true;
    for (size_t i = 0; i < count && done; i++) {
        const shb_bias bias = methods[i].make();
        if (!is_wanted(&session->options, &visibility_stage, bias.name, size) &&
            !is_wanted(&session->options, &shade_stage, bias.name, size))
            continue;
        done = session_succeeds(title, work.map ? light_work_set_bias(&work, &bias)
                                                : light_work_create(session->context, frame, size,
                                                                    &bias, &work)) &&
               time_method(session, &work, true, title);
    }
    light_work_destroy(&work);
    return done;
}

/* The exact method on maps of its own. Shading would know all triangles in any case. */
static bool time_exact(bench_session *session, const measure_frame *frame, uint32_t size,
                       const char *title) {
    bool done = true;
    for (size_t i = 0; i < LIGHT_EXACT_KINDS && done; i++) {
        const light_exact *kind = &light_exact_kinds[i];
        light_work work = {0};
        if (!is_wanted(&session->options, &visibility_stage, kind->name, size))
            continue;
        done = session_succeeds(
                   title, light_work_create_exact(session->context, frame, size, kind, &work)) &&
               time_method(session, &work, false, title);
        light_work_destroy(&work);
    }
    return done;
}

/* Both contexts draw maps of their own. */
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

static bool time_frames(bench_session *session, const measure_frame *frame, uint32_t size,
                        const char *title) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    bool done = true;
    for (size_t i = 0; i < count && done; i++) {
        const shb_bias bias = methods[i].make();
        if (is_wanted(&session->options, &frame_stage, bias.name, size))
            done = time_frame(session, frame, size, &bias, title);
    }
    return done;
}

static bool time_sizes(bench_session *session, const measure_frame *frame, const char *title) {
    const uint32_t *sizes;
    const size_t count = options_sizes(&session->options, &sizes);
    for (size_t i = 0; i < count; i++) {
        progress_step(&session->progress, title);
        if (!time_methods(session, frame, sizes[i], title) ||
            !time_exact(session, frame, sizes[i], title) ||
            !time_frames(session, frame, sizes[i], title))
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
