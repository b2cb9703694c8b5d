#include "stages.h"

#include "draw_work.h"

#include <stdio.h>

/* A run of the reference beyond this is not repeated. */
#define SLOW_SECONDS 0.1

/* Everything is culled at this size, so that the image does not matter. */
#define CULL_SIZE 64

typedef struct draw_stage {
    const char *name;
    draw_images images;
    shb_result (*view)(const example_scene *scene, uint32_t size, shb_view *view);
} draw_stage;

static shb_result light_view(const example_scene *scene, uint32_t size, shb_view *view) {
    return scene_light_view(scene, SCENE_DIRECTIONAL, size, false, view);
}

static shb_result camera_view(const example_scene *scene, uint32_t size, shb_view *view) {
    return scene_camera_view(scene, size, size, view);
}

/* The light looks past the scene, by some times its size. */
static shb_result beside_view(const example_scene *scene, uint32_t size, shb_view *view) {
    const shb_vec3 to_light = scene->lights[SCENE_DIRECTIONAL].source;
    const shb_vec3 aside = shb_vec3_normalize(
        shb_vec3_cross(to_light, (shb_vec3){to_light.y, to_light.z, -to_light.x}));
    shb_box box = scene->bounds;
    const double step = 4 * shb_vec3_length(shb_vec3_subtract(box.hi, box.lo));
    box.lo = shb_vec3_add(box.lo, shb_vec3_scale(aside, step));
    box.hi = shb_vec3_add(box.hi, shb_vec3_scale(aside, step));
    return shb_view_fit_directional(to_light, box, size, false, view);
}

static const draw_stage stages[] = {{"depth", DRAW_DEPTH, light_view},
                                    {"camera", DRAW_DEPTH_IDS, camera_view},
                                    {"dual", DRAW_DEPTH_SECOND, light_view}};

static const draw_stage cull_stage = {"cull", DRAW_DEPTH, beside_view};

static shb_result time_scalar(const bench_session *session, bench_work scalar, bench_times *times) {
    const double start = bench_seconds(session->clock);
    shb_result result = scalar.run(scalar.state);
    const double seconds = bench_seconds(session->clock) - start;
    *times = (bench_times){seconds, seconds};
    if (!result && seconds < SLOW_SECONDS)
        result = bench_measure(scalar, session->clock, session->scalar_plan, times);
    return result;
}

bool stages_measure(bench_session *session, bench_work work, bench_work scalar, bench_row *row) {
    shb_result result = bench_measure(work, session->clock, session->plan, &row->times);
    row->scalar = (bench_times){0};
    if (!result && scalar.run)
        result = time_scalar(session, scalar, &row->scalar);
    row->isa = shb_context_isa(session->context);
    row->threads = shb_context_threads(session->context);
    if (!result)
        report_stage(session, row);
    return session_succeeds(row->stage, result);
}

static bool time_stage(bench_session *session, const draw_stage *stage, const example_scene *scene,
                       const char *title, uint32_t size) {
    bench_row row = {.triangles = scene->triangle_count,
                     .size = size,
                     .items = (double)scene->triangle_count,
                     .texels = (double)size * size};
    row.bytes = row.texels * draw_work_pixel_bytes(stage->images);
    row.limit_seconds = machine_store_seconds(&session->machine, row.bytes);
    const bool clustered = scene->scene.instances[0].mesh->clusters != NULL;
    snprintf(row.stage, sizeof row.stage, "%s%s", stage->name, clustered ? ", clusters" : "");
    snprintf(row.scene, sizeof row.scene, "%s", title);
    shb_view view;
    draw_work work;
    if (!session_succeeds(title, stage->view(scene, size, &view)) ||
        !session_succeeds(title, draw_work_create(session->context, &scene->scene, &view, size,
                                                  size, stage->images, &work)))
        return false;
    draw_work scalar = work;
    scalar.context = clustered ? NULL : session->scalar;
    const bool done =
        stages_measure(session, draw_work_of(&work),
                       scalar.context ? draw_work_of(&scalar) : (bench_work){0}, &row);
    draw_work_destroy(&work);
    return done;
}

static bool time_stages(bench_session *session, const example_scene *scene, const char *title) {
    const uint32_t *sizes;
    const size_t count = options_sizes(&session->options, &sizes);
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        if (!options_want(&session->options, stages[i].name, NULL))
            continue;
        progress_step(&session->progress, title);
        for (size_t k = 0; k < count; k++)
            if (!time_stage(session, &stages[i], scene, title, sizes[k]))
                return false;
    }
    return !options_want(&session->options, cull_stage.name, NULL) ||
           time_stage(session, &cull_stage, scene, title, CULL_SIZE);
}

typedef struct prepare_work {
    shb_context *context;
    example_scene *scene;
} prepare_work;

static shb_result prepare(void *state) {
    const prepare_work *work = state;
    return scene_add_clusters(work->context, work->scene);
}

static bool time_preparation(bench_session *session, example_scene *scene, const char *title) {
    bench_row row = {.triangles = scene->triangle_count,
                     .isa = shb_context_isa(session->context),
                     .threads = 1,
                     .items = (double)scene->triangle_count};
    snprintf(row.stage, sizeof row.stage, "prepare");
    snprintf(row.scene, sizeof row.scene, "%s", title);
    prepare_work work = {session->context, scene};
    const shb_result result = bench_measure((bench_work){prepare, &work}, session->clock,
                                            session->scalar_plan, &row.times);
    if (!result && options_want(&session->options, "prepare", NULL))
        report_stage(session, &row);
    return session_succeeds(row.stage, result);
}

bool stages_draw(bench_session *session, example_scene *scene, const char *title) {
    return time_stages(session, scene, title) && time_preparation(session, scene, title) &&
           time_stages(session, scene, title);
}
