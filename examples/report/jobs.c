#include "jobs.h"

#include <stdlib.h>

/* Jobs of a scene, at most. */
enum { JOBS_MAX = SCENE_LIGHT_KINDS * 16 };

const report_scale *report_scale_of(const report_options *options) {
    static const report_scale full = {.size = {640, 400},
                                      .samples = 256,
                                      .runs = {5, 3},
                                      .map_sizes = {512, 1024, 2048},
                                      .degrees = {1, 4}};
    static const report_scale quick = {.size = {400, 250},
                                       .samples = 64,
                                       .runs = {3, 2},
                                       .map_sizes = {512, 1024},
                                       .degrees = {2}};
    return options->quick ? &quick : &full;
}

static void add_light(report_jobs *list, const report_scene *scene, report_light light,
                      const report_scale *scale) {
    for (const uint32_t *sizes = scale->map_sizes; *sizes; sizes++)
        list->jobs[list->count++] = (report_job){scene, light, *sizes};
}

static void add_scene(report_jobs *list, const report_scene *scene, const report_scale *scale) {
    for (int kind = 0; kind < (scene->both_lights ? SCENE_LIGHT_KINDS : 1); kind++) {
        report_light light = {.kind = (scene_light_kind)kind};
        add_light(list, scene, light, scale);
        for (const double *degrees = scale->degrees; scene->soft && *degrees > 0; degrees++) {
            light.degrees = *degrees;
            add_light(list, scene, light, scale);
        }
    }
}

report_jobs report_list_jobs(const report_scene_list *scenes, const report_scale *scale) {
    report_jobs list = {.jobs = calloc(scenes->count * JOBS_MAX + 1, sizeof *list.jobs)};
    for (size_t i = 0; list.jobs && i < scenes->count; i++)
        add_scene(&list, &scenes->scenes[i], scale);
    return list;
}
