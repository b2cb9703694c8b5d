#include "tuning.h"

#include <math.h>

/* Steps of the search for the fewest errors between neighbours; each tries two values. */
enum { REFINEMENTS = 4 };

/* Powers of two between which the smallest value is sought, and steps between them. */
enum { LOWEST = -20, HIGHEST = 16, STRIDE = 2 };

shb_result tuning_ask(const tuning_subject *subject, tuned *tried) {
    measure_frame *frame = subject->frame;
    const shb_points points = {
        .count = frame->fragment_count, .positions = frame->positions, .normals = frame->normals};
    shb_result result = SHB_OK;
    if (tried->bias.combine)
        result = shb_map_draw(subject->map, &frame->scene->scene, &tried->bias, NULL);
    if (!result)
        result = shb_map_visibility(subject->map, &points, &tried->bias, NULL, frame->visibility);
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
    size_t count;
    double limit_ppm;
} search;

static shb_result try_factor(const search *s, double factor, tuned_smallest *tried) {
    *tried = (tuned_smallest){.tuned = {.bias = *s->start}, .factor = factor};
    for (size_t i = 0; i < s->count; i++)
        tried->tuned.bias.params[i] = (float)((double)s->start->params[i] * factor);
    const shb_result result = tuning_ask(s->subject, &tried->tuned);
    tried->met = tried->tuned.errors.false_shadow_ppm <= s->limit_ppm;
    return result;
}

/* 0, or the first power of two that meets the limit, and the one before that does not; if none
 * does, the one with the least false shadow. */
static shb_result bracket(const search *s, double *misses, tuned_smallest *found) {
    tuned_smallest tried;
    shb_result result = try_factor(s, 0, found);
    *misses = 0;
    for (int power = LOWEST; power <= HIGHEST && !found->met && !result; power += STRIDE) {
        result = try_factor(s, ldexp(1, power), &tried);
        if (!result && tried.met)
            *misses = power == LOWEST ? 0 : ldexp(1, power - STRIDE);
        if (!result && (tried.met ||
                        tried.tuned.errors.false_shadow_ppm < found->tuned.errors.false_shadow_ppm))
            *found = tried;
    }
    return result;
}

shb_result tuning_smallest(const tuning_subject *subject, const shb_bias *start, size_t count,
                           double limit_ppm, tuned_smallest *smallest) {
    const search s = {subject, start, count, limit_ppm};
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
