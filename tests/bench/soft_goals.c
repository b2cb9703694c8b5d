/* Times of filters with a goal: one thread, 256-bit vectors. */
#include "soft_shadows.h"

#include "goals.h"
#include "soft_work.h"
#include "subjects.h"

#include <stdio.h>
#include <string.h>

enum { MAP_SIZE = 2048, PICTURE_SIZE = 1024 };

typedef struct soft_goal {
    const char *name, *scene;
    soft_work_desc desc;
    double ns; /* a fragment */
} soft_goal;

#define HILLS(bias, filter)                                                                        \
    { SCENE_DIRECTIONAL, MAP_SIZE, bias, filter, false }
/* Under the small light the pyramid settles half of the tree's fragments, under the large one an
 * eleventh. */
#define PCSS(light) "pcss:light=" light ",blockers=25,samples=25"

static const soft_goal goals[] = {
    {"pcf 5x5 constant", "hills", HILLS("constant", "pcf:size=5"), 3.2},
    {"pcf 7x7 constant", "hills", HILLS("constant", "pcf:size=7"), 3.8},
    {"pcf 11x11 constant", "hills", HILLS("constant", "pcf:size=11"), 8.5},
    {"pcf 5x5 adaptive", "hills", HILLS("adaptive", "pcf:size=5"), 5},
    {"pcf 7x7 adaptive", "hills", HILLS("adaptive", "pcf:size=7"), 5.4},
    {"pcf 11x11 adaptive", "hills", HILLS("adaptive", "pcf:size=11"), 10},
    {"pcf 5x5 exact planes", "hills", HILLS("exact", "pcf:size=5"), 30},
    {"pcf 11x11 exact planes", "hills", HILLS("exact", "pcf:size=11"), 70},
    {"pcss adaptive, no pyramid",
     "tree",
     {SCENE_SPOT, MAP_SIZE, "adaptive", PCSS("0.4"), true},
     28},
    {"pcss adaptive, pyramid", "tree", {SCENE_SPOT, MAP_SIZE, "adaptive", PCSS("0.02"), false}, 15},
};

/* The adaptive method's time over the receiver plane's, at most: shading, and map and shading. */
static const struct {
    const char *name, *filter;
} compared[] = {{"pcf 5x5", "pcf:size=5"}, {"pcf 7x7", "pcf:size=7"}, {"pcf 11x11", "pcf:size=11"}};
static const double most_ratio = 1.05;

/* A scene and what its camera sees. */
typedef struct soft_view {
    const char *name;
    example_scene *scene;
    measure_frame frame;
} soft_view;

static bool open_view(shb_context *context, const char *name, soft_view *view) {
    char error[256];
    *view = (soft_view){.name = name};
    if (!subject_open(name, &view->scene, error, sizeof error)) {
        fprintf(stderr, "bench: %s\n", error);
        return false;
    }
    return session_succeeds(
        name, measure_frame_create(context, view->scene, PICTURE_SIZE, PICTURE_SIZE, &view->frame));
}

static void close_view(soft_view *view) {
    measure_frame_destroy(&view->frame);
    scene_close(view->scene);
}

static bench_row start_row(const soft_view *view, const char *name, shb_context *context,
                           double goal) {
    bench_row row = {.triangles = view->scene->triangle_count,
                     .size = MAP_SIZE,
                     .isa = shb_context_isa(context),
                     .threads = 1,
                     .items = (double)view->frame.fragment_count,
                     .by_fragment = true,
                     .goal = goal};
    snprintf(row.stage, sizeof row.stage, "goal:%s", name);
    snprintf(row.scene, sizeof row.scene, "%s", view->name);
    return row;
}

static bool measure_goal(bench_session *session, shb_context *context, const soft_view *view,
                         const soft_goal *goal) {
    bench_row row = start_row(view, goal->name, context, goal->ns);
    soft_work work;
    if (!session_succeeds(goal->name, soft_work_create(context, &view->frame, &goal->desc, &work)))
        return false;
    const bool done =
        goals_report_time(session, soft_work_visibility(&work), "ns", 1e9 / row.items, &row);
    soft_work_destroy(&work);
    return done;
}

static bool report_ratio(bench_session *session, const soft_view *view, shb_context *context,
                         const char *name, const bench_comparison *pair) {
    bench_row row = start_row(view, name, context, most_ratio);
    row.times = pair->first;
    row.measured = pair->ratio;
    report_goal(session, &row, "  ", pair->least_ratio, false);
    return true;
}

/* One filter with the adaptive method and with the receiver plane, by turns. */
static bool measure_ratio(bench_session *session, shb_context *context, const soft_view *view,
                          const char *title, const char *filter) {
    const soft_work_desc adaptive = HILLS("adaptive", filter);
    const soft_work_desc plane = HILLS("receiver-plane", filter);
    char name[40];
    soft_work first = {0}, second = {0};
    bench_comparison shade, overall;
    const bool done =
        session_succeeds(filter, soft_work_create(context, &view->frame, &adaptive, &first)) &&
        session_succeeds(filter, soft_work_create(context, &view->frame, &plane, &second)) &&
        session_succeeds(filter, bench_compare(soft_work_shade(&first), soft_work_shade(&second),
                                               BENCH_CLOCK_THREAD, session->plan, &shade)) &&
        session_succeeds(filter,
                         bench_compare(soft_work_overall(&first), soft_work_overall(&second),
                                       BENCH_CLOCK_THREAD, session->plan, &overall));
    soft_work_destroy(&first);
    soft_work_destroy(&second);
    if (!done)
        return false;
    snprintf(name, sizeof name, "%s shade, by plane", title);
    report_ratio(session, view, context, name, &shade);
    snprintf(name, sizeof name, "%s frame, by plane", title);
    return report_ratio(session, view, context, name, &overall);
}

static bool measure_view(bench_session *session, shb_context *context, const char *name) {
    soft_view view;
    bool done = open_view(context, name, &view);
    for (size_t i = 0; i < sizeof goals / sizeof *goals && done; i++)
        if (strcmp(goals[i].scene, name) == 0 &&
            soft_work_is_served(goals[i].desc.bias, goals[i].desc.filter))
            done = measure_goal(session, context, &view, &goals[i]);
    if (strcmp(name, "hills") == 0)
        for (size_t i = 0; i < sizeof compared / sizeof *compared && done; i++)
            done = measure_ratio(session, context, &view, compared[i].name, compared[i].filter);
    close_view(&view);
    return done;
}

bool soft_measure_goals(bench_session *session) {
    shb_context *context = session->capped[SHB_ISA_AVX2];
    if (!context)
        return true;
    report_heading(session, "filters, one thread");
    return measure_view(session, context, "hills") && measure_view(session, context, "tree");
}
