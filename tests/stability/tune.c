#include "tune.h"

#include "tuning.h"

static tuning_subject subject_of(stability_stage *stage, shb_map *map) {
    return (tuning_subject){
        .frame = &stage->frame, .points = stage->points, .truth = stage->truth, .map = map};
}

shb_result stability_measure(stability_stage *stage, const listed_method *method,
                             shb_errors *errors) {
    shb_map *map = NULL;
    tuned standard = {.bias = method->method->make()};
    shb_result result = stability_draw_map(stage, method, &standard.bias, &map);
    const tuning_subject subject = subject_of(stage, map);
    if (!result)
        result = tuning_ask(&subject, &standard);
    shb_map_destroy(map);
    if (!result)
        *errors = standard.errors;
    return result;
}

shb_result stability_tune(stability_stage *stage, const listed_method *method, shb_errors *errors) {
    shb_map *map = NULL;
    tuned best = {.bias = method->method->make(), .errors = *errors};
    shb_result result = stability_draw_map(stage, method, &best.bias, &map);
    const tuning_subject subject = subject_of(stage, map);
    if (!result)
        result = tuning_fewest_wrong(&subject, &best);
    shb_map_destroy(map);
    if (!result)
        *errors = best.errors;
    return result;
}
