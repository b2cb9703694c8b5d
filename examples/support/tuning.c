#include "tuning.h"

#include <math.h>

/* Steps of the search for the fewest errors between neighbours; each tries two values. */
enum { REFINEMENTS = 4 };

/* Steps between the smallest and the largest factor that is tried, each fourfold. */
enum { STEPS = 10 };

shb_result tuning_ask(const tuning_subject *subject, tuned *tried) {
    measure_frame *frame = subject->frame;
    shb_result result = SHB_OK;
    if (tried->bias.combine)
        result = shb_map_draw(subject->map, &frame->scene->scene, &tried->bias, NULL);
    if (!result)
        result = shb_map_visibility(subject->map, &subject->points, &tried->bias, NULL,
                                    frame->visibility);
    return result ? result
                  : shb_errors_measure(frame->fragment_count, subject->truth, frame->visibility,
                                       &tried->errors);
}

/* ---- the fewest errors ---- */

/* Keeps the value if it is better than the best so far. */
static shb_result try_value(const tuning_subject *subject, float value, tuned *best) {
    tuned tried = *best;
    tried.bias.params[0] = value;
    const shb_result result = tuning_ask(subject, &tried);
    if (!result && tried.errors.wrong < best->errors.wrong)
        *best = tried;
    return result;
}

shb_result tuning_fewest_wrong(const tuning_subject *subject, tuned *best) {
    const float start = best->bias.params[0];
    shb_result result = SHB_OK;
    for (int i = -5; i <= 3 && !result; i++)
        if (i != 0)
            result = try_value(subject, ldexpf(start, 3 * i), best);
    /* Geometric steps of 8^(1/2), 8^(1/4), ... about the best. */
    float step = 8;
    for (int i = 0; i < REFINEMENTS && !result; i++) {
        step = sqrtf(step);
        const float middle = best->bias.params[0];
        result = try_value(subject, middle * step, best);
        if (!result)
            result = try_value(subject, middle / step, best);
    }
    return result;
}

/* ---- the smallest value ---- */

typedef struct search {
    const tuning_subject *subject;
    const shb_bias *start;
    const tuning_goal *goal;
} search;

static shb_result try_factor(const search *s, double factor, tuned_smallest *tried) {
    *tried = (tuned_smallest){.tuned = {.bias = *s->start}, .factor = factor};
    for (size_t i = 0; i < s->goal->count; i++)
        tried->tuned.bias.params[i] = (float)((double)s->start->params[i] * factor);
    const shb_result result = tuning_ask(s->subject, &tried->tuned);
    tried->met = tried->tuned.errors.false_shadow_ppm <= s->goal->limit_ppm;
    return result;
}

/* 0, or the first step that meets the limit, and the one before that does not; if none does, the
 * one with the least false shadow. */
static shb_result bracket(const search *s, double *misses, tuned_smallest *found) {
    tuned_smallest tried;
    shb_result result = try_factor(s, 0, found);
    *misses = 0;
    for (int step = 0; step <= STEPS && !found->met && !result; step++) {
        result = try_factor(s, ldexp(s->goal->largest, 2 * (step - STEPS)), &tried);
        if (!result && tried.met)
            *misses = step == 0 ? 0 : tried.factor / 4;
        if (!result && (tried.met ||
                        tried.tuned.errors.false_shadow_ppm < found->tuned.errors.false_shadow_ppm))
            *found = tried;
    }
    return result;
}

shb_result tuning_smallest(const tuning_subject *subject, const shb_bias *start,
                           const tuning_goal *goal, tuned_smallest *smallest) {
    const search s = {subject, start, goal};
    double misses;
    tuned_smallest found, tried;
    shb_result result = bracket(&s, &misses, &found);
    while (!result && found.met && misses > 0 && misses < found.factor * (1 - TUNING_TOLERANCE)) {
        result = try_factor(&s, sqrt(misses * found.factor), &tried);
        if (tried.met)
            found = tried;
        else
            misses = tried.factor;
    }
    if (!result)
        *smallest = found;
    return result;
}
