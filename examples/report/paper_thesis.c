/* Schwaerzler 2009, figure 5.6: a walk through a scene, pictures per second of PCSS with 16 + 16
 * and with 32 + 32 samples and of the thesis's own method, which the library does not have. The
 * figure prints no numbers. */
#include "paper.h"

#include "tool.h"

#include <math.h>

enum { CASES = 2, STEPS_MAX = 16 };

static const paper_case cases[CASES] = {
    {"PCSS 16/16", "adaptive", "pcss:light=0.4,blockers=16,samples=16", 0},
    {"PCSS 32/32", "adaptive", "pcss:light=0.4,blockers=32,samples=32", 0}};

/* Around the middle of the scene, nearer and farther by turns. */
static void walk_to(example_scene *scene, const scene_camera *start, double share) {
    const shb_vec3 away = shb_vec3_subtract(start->eye, start->target);
    const double angle = 2 * 3.14159265358979323846 * share, near = 0.8 + 0.3 * cos(2 * angle);
    const shb_mat4 turn = shb_mat4_rotation((shb_vec3){0, 1, 0}, angle);
    scene_move_camera(
        scene,
        shb_vec3_add(start->target, shb_vec3_scale(shb_mat4_transform_point(turn, away), near)),
        start->target);
}

static shb_result measure_step(const paper_output *output, example_scene *scene,
                               const uint32_t size[2], paper_row *rows) {
    measure_frame frame;
    shb_result result = measure_frame_create(output->single, scene, size[0], size[1], &frame);
    if (result)
        return result;
    result = paper_measure(output, &frame, SCENE_SPOT, 1024, "walk", cases, CASES, rows);
    measure_frame_destroy(&frame);
    return result;
}

static void write_walk(const paper_output *output, const paper_row *rows, size_t step_count) {
    static const char *const names[STEPS_MAX] = {"1", "2",  "3",  "4",  "5",  "6",  "7",  "8",
                                                 "9", "10", "11", "12", "13", "14", "15", "16"};
    paper_write_rows(
        output, "Schwaerzler 2009, figure 5.6",
        "A walk around the tree, in the order of the rows; map of 1024, picture of 800 x 600. The "
        "thesis draws a chart without numbers, of its own method, PCSS with 16 samples for "
        "blockers and 16 taps, and PCSS with twice as many.",
        rows, step_count * CASES,
        "The thesis's own method gathers one sample of the light a picture over time; the library "
        "has no maps that last from picture to picture, so that line is missing. Twice the samples "
        "take less than twice the time, as drawing does not depend on them and only fragments that "
        "may lie in a penumbra take them.");
    paper_write_chart(output, "Schwaerzler 2009, figure 5.6: a walk around the tree",
                      "step of the walk", names, step_count, rows, CASES);
}

bool paper_thesis(const paper_output *output) {
    const uint32_t size[2] = {output->quick ? 320 : 800, output->quick ? 240 : 600};
    const size_t step_count = output->quick ? 6 : STEPS_MAX;
    paper_row rows[STEPS_MAX * CASES];
    example_scene *scene = tool_open_scene("report", "tree");
    if (!scene)
        return false;
    const scene_camera start = scene->camera;
    shb_result result = SHB_OK;
    for (size_t k = 0; k < step_count && !result; k++) {
        walk_to(scene, &start, (double)k / (double)step_count);
        result = measure_step(output, scene, size, &rows[k * CASES]);
    }
    scene_close(scene);
    const bool done = tool_succeeds("report", "Schwaerzler 2009, figure 5.6", result);
    if (done)
        write_walk(output, rows, step_count);
    return done;
}
