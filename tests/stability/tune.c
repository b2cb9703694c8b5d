#include "tune.h"

#include <math.h>

/* Steps of the search between neighbours; each tries two values. */
enum { REFINEMENTS = 4 };

/* The state of one search. The map is drawn anew for each value if the method's combine stage
 * reads it. */
typedef struct search {
    stability_stage *stage;
    shb_map *map;
    shb_bias best;
    shb_errors errors; /* of the best */
    shb_result result;
} search;

shb_result stability_measure(stability_stage *stage, const listed_method *method,
                             shb_errors *errors) {
    shb_map *map = NULL;
    const shb_bias bias = method->method->make();
    shb_result result = stability_draw_map(stage, method, &bias, &map);
    if (!result)
        result = stability_judge(stage, map, &bias, errors);
    shb_map_destroy(map);
    return result;
}

/* Keeps the value if it is better than the best so far. */
static void try_value(search *s, float value) {
    shb_bias bias = s->best;
    bias.params[0] = value;
    shb_errors errors;
    if (!s->result && bias.combine)
        s->result = shb_map_draw(s->map, &s->stage->scene->scene, &bias, NULL);
    if (!s->result)
        s->result = stability_judge(s->stage, s->map, &bias, &errors);
    if (s->result || errors.wrong >= s->errors.wrong)
        return;
    s->best = bias;
    s->errors = errors;
}

static void run_search(search *s) {
    const float start = s->best.params[0];
    for (int i = -5; i <= 3; i++)
        if (i != 0)
            try_value(s, ldexpf(start, 3 * i));
    /* Geometric steps of 8^(1/2), 8^(1/4), ... about the best. */
    float step = 8;
    for (int i = 0; i < REFINEMENTS; i++) {
        step = sqrtf(step);
        const float middle = s->best.params[0];
        try_value(s, middle * step);
        try_value(s, middle / step);
    }
}

shb_result stability_tune(stability_stage *stage, const listed_method *method, shb_errors *errors) {
    search s = {.stage = stage, .best = method->method->make(), .errors = *errors};
    s.result = stability_draw_map(stage, method, &s.best, &s.map);
    if (!s.result)
        run_search(&s);
    shb_map_destroy(s.map);
    if (!s.result)
        *errors = s.errors;
    return s.result;
}
