/* Tables 1 and 2 of Ehm, Ederer, Klein and Nischwitz 2015, rebuilt: map, shading and overall times
 * of a picture of 1024 x 768 with a map of 2048, each method measured by turns with the receiver
 * plane's, and the ratio beside the paper's (a graphics card's).
 *
 * Errors are those of a smaller picture of the same view, against rays to a light of the shape that
 * the taps have: a square for all texels of a box, a disk for Poisson taps. Table 1 has kernels of
 * fixed size; its light is the smallest of table 2. */
#include "soft_shadows.h"

#include "scenes.h"
#include "soft.h"
#include "soft_work.h"

#include <stdio.h>

enum { MAP_SIZE = 2048, WIDTH = 1024, HEIGHT = 768, TRUTH_WIDTH = 320, TRUTH_HEIGHT = 240 };
enum { LIGHTS = 3 };

/* World units, in the proportions of the paper's small, medium and large. */
static const double light_widths[LIGHTS] = {0.2, 0.4, 0.64};

/* A row: which bias and filter, and the overall time over the receiver plane's in the paper. */
typedef struct soft_row {
    const char *name, *bias, *filter;
    int light;
    bool disk;
    double paper; /* 0: not in the paper; 1: the receiver plane, that the next rows stand beside */
} soft_row;

static const soft_row pcf_rows[] = {
    {"5x5 receiver plane", "receiver-plane", "pcf:size=5", 0, false, 1},
    {"5x5 adaptive, naive", "adaptive", "pcf:size=5,taps=2", 0, false, 1.82 / 1.18},
    {"5x5 adaptive", "adaptive", "pcf:size=5", 0, false, 1.30 / 1.18},
    {"5x5 exact", "exact", "pcf:size=5", 0, false, 0},
    {"7x7 receiver plane", "receiver-plane", "pcf:size=7", 0, false, 1},
    {"7x7 adaptive, naive", "adaptive", "pcf:size=7,taps=2", 0, false, 2.93 / 1.49},
    {"7x7 adaptive", "adaptive", "pcf:size=7", 0, false, 1.82 / 1.49},
    {"7x7 exact", "exact", "pcf:size=7", 0, false, 0},
    {"11x11 receiver plane", "receiver-plane", "pcf:size=11", 0, false, 1},
    {"11x11 adaptive, naive", "adaptive", "pcf:size=11,taps=2", 0, false, 6.19 / 2.71},
    {"11x11 adaptive", "adaptive", "pcf:size=11", 0, false, 3.45 / 2.71},
    {"11x11 exact", "exact", "pcf:size=11", 0, false, 0},
};

#define ALL(width) "pcss:light=" width ",blockers=25,samples=0"
#define POISSON(width) "pcss:light=" width ",blockers=25,samples=25"

static const soft_row pcss_rows[] = {
    {"small receiver plane", "receiver-plane", ALL("0.2"), 0, false, 1},
    {"small adaptive", "adaptive", ALL("0.2"), 0, false, 5.55 / 4.05},
    {"small exact", "exact", ALL("0.2"), 0, false, 0},
    {"small Poisson rec. plane", "receiver-plane", POISSON("0.2"), 0, true, 1},
    {"small Poisson adaptive", "adaptive", POISSON("0.2"), 0, true, 3.01 / 2.36},
    {"small Poisson exact", "exact", POISSON("0.2"), 0, true, 0},
    {"medium receiver plane", "receiver-plane", ALL("0.4"), 1, false, 1},
    {"medium adaptive", "adaptive", ALL("0.4"), 1, false, 19.54 / 14.09},
    {"medium exact", "exact", ALL("0.4"), 1, false, 0},
    {"medium Poisson rec. plane", "receiver-plane", POISSON("0.4"), 1, true, 1},
    {"medium Poisson adaptive", "adaptive", POISSON("0.4"), 1, true, 3.15 / 2.48},
    {"medium Poisson exact", "exact", POISSON("0.4"), 1, true, 0},
    {"large receiver plane", "receiver-plane", ALL("0.64"), 2, false, 1},
    {"large adaptive", "adaptive", ALL("0.64"), 2, false, 48.95 / 35.18},
    {"large exact", "exact", ALL("0.64"), 2, false, 0},
    {"large Poisson rec. plane", "receiver-plane", POISSON("0.64"), 2, true, 1},
    {"large Poisson adaptive", "adaptive", POISSON("0.64"), 2, true, 3.30 / 2.61},
    {"large Poisson exact", "exact", POISSON("0.64"), 2, true, 0},
};

/* What all rows share. */
typedef struct soft_subject {
    bench_session *session;
    example_scene *scene;
    measure_frame timed, judged;
    soft_truth truths[LIGHTS][2]; /* of squares and disks */
} soft_subject;

static shb_result create_truths(soft_subject *subject) {
    const uint32_t samples = subject->session->options.quick ? 64 : 1024;
    shb_view view;
    shb_result result = scene_light_view(subject->scene, SCENE_SPOT, MAP_SIZE, true, &view);
    for (int light = 0; light < LIGHTS; light++)
        for (int disk = 0; disk < 2 && !result; disk++) {
            const shb_area_light area = soft_light(&view, light_widths[light], disk);
            progress_step(&subject->session->progress, "truth");
            result =
                soft_truth_create(&subject->judged, &area, samples, &subject->truths[light][disk]);
        }
    return result;
}

static bool open_subject(bench_session *session, soft_subject *subject) {
    char error[256];
    *subject = (soft_subject){.session = session};
    if (!scene_open("tree", &subject->scene, error, sizeof error)) {
        fprintf(stderr, "bench: %s\n", error);
        return false;
    }
    return session_succeeds("tree", measure_frame_create(session_single(session), subject->scene,
                                                         WIDTH, HEIGHT, &subject->timed)) &&
           session_succeeds("tree", measure_frame_create(session->two, subject->scene, TRUTH_WIDTH,
                                                         TRUTH_HEIGHT, &subject->judged)) &&
           session_succeeds("tree", create_truths(subject));
}

static void close_subject(soft_subject *subject) {
    for (int light = 0; light < LIGHTS; light++)
        for (int disk = 0; disk < 2; disk++)
            soft_truth_destroy(&subject->truths[light][disk]);
    measure_frame_destroy(&subject->judged);
    measure_frame_destroy(&subject->timed);
    scene_close(subject->scene);
}

static shb_result create_work(const soft_subject *subject, const measure_frame *frame,
                              const soft_row *row, soft_work *work) {
    const soft_work_desc desc = {SCENE_SPOT, MAP_SIZE, row->bias, row->filter, false};
    return soft_work_create(session_single(subject->session), frame, &desc, work);
}

/* Errors over the judged frame. */
static shb_result measure_errors(const soft_subject *subject, const soft_row *row,
                                 bench_soft *measured) {
    soft_work work;
    shb_result result = create_work(subject, &subject->judged, row, &work);
    if (result)
        return result;
    const bench_work asked = soft_work_visibility(&work);
    shb_soft_errors errors;
    result = asked.run(asked.state);
    if (!result)
        result =
            soft_truth_compare(&subject->judged, &subject->truths[row->light][row->disk], &errors);
    soft_work_destroy(&work);
    if (result)
        return result;
    measured->rms = errors.rms;
    measured->similarity = errors.similarity;
    return SHB_OK;
}

/* Times of a row and of the receiver plane's, by turns. */
static shb_result measure_times(const soft_subject *subject, soft_work *work, soft_work *beside,
                                bench_times *visibility, bench_soft *measured) {
    const bench_plan plan = {subject->session->options.quick ? 2 : 5, 0.02};
    bench_comparison map, shade;
    shb_result result =
        bench_compare(soft_work_map(work), soft_work_map(beside), BENCH_CLOCK_THREAD, plan, &map);
    if (!result)
        result = bench_compare(soft_work_shade(work), soft_work_shade(beside), BENCH_CLOCK_THREAD,
                               plan, &shade);
    if (!result)
        result = bench_measure(soft_work_visibility(work), BENCH_CLOCK_THREAD, plan, visibility);
    if (result)
        return result;
    measured->map_seconds = map.first.median;
    measured->shade_seconds = shade.first.median;
    measured->ratio =
        (map.first.median + shade.first.median) / (map.second.median + shade.second.median);
    return SHB_OK;
}

static bool measure_row(const soft_subject *subject, const soft_row *row, soft_work *beside) {
    bench_row reported = {.triangles = subject->scene->triangle_count,
                          .size = MAP_SIZE,
                          .isa = shb_context_isa(session_single(subject->session)),
                          .threads = 1,
                          .items = (double)subject->timed.fragment_count,
                          .by_fragment = true,
                          .soft = {.paper = row->paper}};
    snprintf(reported.stage, sizeof reported.stage, "soft:%s", row->name);
    snprintf(reported.scene, sizeof reported.scene, "tree");
    soft_work work;
    progress_step(&subject->session->progress, row->name);
    if (!session_succeeds(row->name, create_work(subject, &subject->timed, row, &work)))
        return false;
    const bool done = session_succeeds(row->name, measure_times(subject, &work, beside,
                                                                &reported.times, &reported.soft)) &&
                      session_succeeds(row->name, measure_errors(subject, row, &reported.soft));
    soft_work_destroy(&work);
    if (done)
        report_soft(subject->session, &reported);
    return done;
}

static bool measure_rows(const soft_subject *subject, const char *heading, const soft_row *rows,
                         size_t count) {
    report_soft_heading(subject->session, heading);
    soft_work beside = {0};
    bool done = true;
    for (size_t i = 0; i < count && done; i++) {
        if (!soft_work_is_served(rows[i].bias, rows[i].filter))
            continue;
        if (rows[i].paper == 1) {
            soft_work_destroy(&beside);
            done = session_succeeds(rows[i].name,
                                    create_work(subject, &subject->timed, &rows[i], &beside));
        }
        done = done && measure_row(subject, &rows[i], &beside);
    }
    soft_work_destroy(&beside);
    return done;
}

bool soft_measure_tables(bench_session *session) {
    soft_subject subject;
    const bool done = open_subject(session, &subject) &&
                      measure_rows(&subject, "PCF over boxes of texels", pcf_rows,
                                   sizeof pcf_rows / sizeof *pcf_rows) &&
                      measure_rows(&subject, "PCSS, 25 taps search blockers", pcss_rows,
                                   sizeof pcss_rows / sizeof *pcss_rows);
    close_subject(&subject);
    return done;
}
