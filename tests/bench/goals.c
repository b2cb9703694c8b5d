#include "goals.h"

#include "light_work.h"
#include "subjects.h"

#include <stdio.h>
#include <string.h>

enum { GOAL_SSE2, GOAL_AVX2, GOAL_AVX512, GOAL_ISAS };

static const shb_isa goal_isas[GOAL_ISAS] = {SHB_ISA_SSE2, SHB_ISA_AVX2, SHB_ISA_AVX512};

typedef struct depth_goal {
    const char *scene;
    uint32_t size;
    double ms[GOAL_ISAS];
} depth_goal;

static const depth_goal depth_goals[] = {
    {"bunny_69k", 1024, {1.4, 0.75, 0.60}}, {"bunny_69k", 2048, {3.6, 1.9, 1.5}},
    {"sponza", 2048, {18, 10, 7.5}},        {"littlest_tokyo", 2048, {40, 22, 15}},
    {"height-field", 1024, {23, 14, 11}},   {"height-field", 4096, {70, 38, 31}},
    {"stack", 2048, {2.7, 1.7, 1.2}},
};

static const double adaptive_goals[GOAL_ISAS] = {2.8, 2.0, 1.6};

bool goals_report_time(bench_session *session, bench_work work, const char *unit, double scale,
                       bench_row *row) {
    const shb_result result = bench_measure(work, BENCH_CLOCK_THREAD, session->plan, &row->times);
    row->measured = scale * row->times.median;
    if (!result)
        report_goal(session, row, unit, scale * row->times.least, false);
    return session_succeeds(row->stage, result);
}

static bool report_depth_goal(bench_session *session, const depth_goal *goal,
                              const example_scene *scene, int isa) {
    shb_context *context = session->capped[goal_isas[isa]];
    bench_row row = {.triangles = scene->triangle_count,
                     .size = goal->size,
                     .isa = goal_isas[isa],
                     .threads = 1,
                     .items = (double)scene->triangle_count,
                     .goal = goal->ms[isa]};
    snprintf(row.stage, sizeof row.stage, "goal:depth");
    snprintf(row.scene, sizeof row.scene, "%s", goal->scene);
    shb_view view;
    draw_work work;
    if (!session_succeeds(goal->scene,
                          scene_light_view(scene, SCENE_DIRECTIONAL, goal->size, false, &view)) ||
        !session_succeeds(goal->scene, draw_work_create(context, &scene->scene, &view, goal->size,
                                                        goal->size, DRAW_DEPTH, &work)))
        return false;
    const bool done = goals_report_time(session, draw_work_of(&work), "ms", 1e3, &row);
    draw_work_destroy(&work);
    return done;
}

static bool measure_depth_goal(bench_session *session, const depth_goal *goal,
                               const example_scene *scene) {
    bool done = true;
    for (int isa = 0; isa < GOAL_ISAS && done; isa++)
        if (session->capped[goal_isas[isa]])
            done = report_depth_goal(session, goal, scene, isa);
    return done;
}

/* Goals of one scene follow each other, so that each scene is opened once. */
static bool measure_depth_goals(bench_session *session) {
    const depth_goal *end = depth_goals + sizeof depth_goals / sizeof *depth_goals;
    const char *opened = "";
    example_scene *scene = NULL;
    bool done = true;
    for (const depth_goal *goal = depth_goals; goal < end && done; goal++) {
        progress_step(&session->progress, goal->scene);
        if (strcmp(opened, goal->scene) != 0) {
            scene_close(scene);
            scene = subject_open_if_there(session->options.folder, goal->scene);
            opened = goal->scene;
            done = !scene || session_succeeds(opened, scene_add_clusters(session->context, scene));
        }
        done = done && (!scene || measure_depth_goal(session, goal, scene));
    }
    scene_close(scene);
    return done;
}

static bool report_adaptive_goal(bench_session *session, const measure_frame *frame, int isa) {
    const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
    bench_row row = {.triangles = frame->scene->triangle_count,
                     .size = 2048,
                     .isa = goal_isas[isa],
                     .threads = 1,
                     .items = (double)frame->fragment_count,
                     .by_fragment = true,
                     .goal = adaptive_goals[isa]};
    snprintf(row.stage, sizeof row.stage, "goal:hard:adaptive");
    snprintf(row.scene, sizeof row.scene, "hills");
    light_work work;
    if (!session_succeeds("hills", light_work_create(session->capped[goal_isas[isa]], frame,
                                                     row.size, &bias, &work)))
        return false;
    const bool done =
        goals_report_time(session, light_work_visibility(&work), "ns", 1e9 / row.items, &row);
    light_work_destroy(&work);
    return done;
}

static bool measure_adaptive_goal(bench_session *session) {
    example_scene *scene = subject_open_if_there(NULL, "hills");
    measure_frame frame = {0};
    bool done = scene != NULL &&
                session_succeeds("hills",
                                 measure_frame_create(session->context, scene, 1024, 1024, &frame));
    for (int isa = 0; isa < GOAL_ISAS && done; isa++)
        if (session->capped[goal_isas[isa]])
            done = report_adaptive_goal(session, &frame, isa);
    measure_frame_destroy(&frame);
    scene_close(scene);
    return done;
}

bool goals_measure(bench_session *session) {
    report_heading(session, "goals, one thread, meshes with clusters");
    return measure_depth_goals(session) && measure_adaptive_goal(session);
}
