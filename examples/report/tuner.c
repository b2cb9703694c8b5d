#include "tuner.h"

#include "receivers.h"
#include "statistics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef enum knob_unit { KNOB_NONE, KNOB_DEPTH, KNOB_TEXELS, KNOB_SCENE, KNOB_SLOPE } knob_unit;

/* The parameters that are tuned: the first ones, which keep their proportion, up to a value of the
 * first that is beyond all use. */
static const struct {
    const char *method;
    size_t count;
    knob_unit unit;
    double largest;
} knobs[TUNER_METHODS] = {
    {"constant", 1, KNOB_DEPTH, 1},        {"slope", 1, KNOB_SLOPE, 64},
    {"angle", 2, KNOB_SCENE, 0.1},         {"normal-offset", 1, KNOB_TEXELS, 16},
    {"receiver-plane", 1, KNOB_DEPTH, 1},  {"texel-cone", 0, KNOB_NONE, 0},
    {"dual-layer", 1, KNOB_DEPTH, 1},      {"adaptive", 1, KNOB_SCENE, 0.1},
    {"adaptive-soft", 1, KNOB_SCENE, 0.1},
};

typedef struct tuner {
    report_stage *stage;
    const scene_light *light;
    shb_map *map;
    measure_truth truth;
    double limit_ppm;
    tuner_units units;
} tuner;

static const shb_bias_method *method_named(const char *name) {
    const shb_bias_method *methods = shb_bias_methods(NULL);
    while (strcmp(methods->name, name) != 0)
        methods++;
    return methods;
}

/* ---- units ---- */

/* Up to SHB_BATCH lit fragments, spread evenly over all of them; their number. */
static size_t choose_fragments(const tuner *t, float positions[], float normals[]) {
    const measure_frame *frame = &t->stage->frame;
    size_t lit = 0, seen = 0, count = 0;
    for (size_t i = 0; i < frame->fragment_count; i++)
        lit += (t->truth.fragments[i] & SHB_TRUTH_LIT) != 0;
    for (size_t i = 0; i < frame->fragment_count; i++) {
        if (!(t->truth.fragments[i] & SHB_TRUTH_LIT))
            continue;
        if (seen++ * SHB_BATCH < count * lit)
            continue;
        memcpy(positions + 3 * count, frame->positions + 3 * i, 3 * sizeof(float));
        memcpy(normals + 3 * count, frame->normals + 3 * i, 3 * sizeof(float));
        count++;
    }
    return count;
}

static double median_of(const float *values, size_t count) {
    double doubles[SHB_BATCH];
    for (size_t i = 0; i < count; i++)
        doubles[i] = (double)values[i];
    return statistics_median(doubles, count);
}

static shb_result find_units(tuner *t) {
    float positions[3 * SHB_BATCH], normals[3 * SHB_BATCH];
    shb_receivers receivers;
    const shb_bias none = shb_bias_none();
    const shb_points points = {.count = choose_fragments(t, positions, normals),
                               .positions = positions,
                               .normals = normals};
    t->units = (tuner_units){shb_map_get_info(t->map)->scene_scale, (double)NAN, (double)NAN};
    if (points.count == 0)
        return SHB_OK;
    const shb_result result = receivers_look(t->map, &points, &none, &receivers);
    if (result)
        return result;
    t->units.texel_size = median_of(receivers.texel_size, points.count);
    t->units.depth_per_world = median_of(receivers.depth_per_world, points.count);
    return SHB_OK;
}

static void convert(const tuner_units *units, knob_unit unit, double value, tuner_row *row) {
    row->world = unit == KNOB_DEPTH    ? value / units->depth_per_world
                 : unit == KNOB_TEXELS ? value * units->texel_size
                 : unit == KNOB_SCENE  ? value * units->scene_scale
                                       : (double)NAN;
    row->depth = unit == KNOB_DEPTH ? value : row->world * units->depth_per_world;
    row->texels = unit == KNOB_TEXELS ? value : row->world / units->texel_size;
    row->slope_factor = unit == KNOB_SLOPE ? value : (double)NAN;
}

double tuner_integer_depth(double depth, int bits) {
    return ceil(depth * (ldexp(1, bits) - 1));
}

/* ---- rows ---- */

static void write_setting(const shb_bias_method *method, const shb_bias *bias, tuner_row *row) {
    int length = snprintf(row->setting, sizeof row->setting, "%s", method->name);
    for (size_t i = 0; i < SHB_PARAMS_MAX && method->param_names[i]; i++)
        length += snprintf(row->setting + length, sizeof row->setting - (size_t)length, "%c%s=%.6g",
                           i == 0 ? ':' : ',', method->param_names[i], (double)bias->params[i]);
}

static shb_result search(const tuner *t, const tuning_subject *subject, size_t number,
                         const shb_bias *start, tuner_row *row) {
    const tuning_goal goal = {.count = knobs[number].count,
                              .largest = knobs[number].largest / (double)start->params[0],
                              .limit_ppm = t->limit_ppm};
    return tuning_smallest(subject, start, &goal, &row->found);
}

/* The map is left as the row's last question drew it; what is measured after needs its own. */
static shb_result tune(const tuner *t, size_t number, tuner_row *row) {
    const shb_bias_method *method = method_named(knobs[number].method);
    const tuning_subject subject = {&t->stage->frame, measure_positions(&t->stage->frame),
                                    t->truth.fragments, t->map};
    const shb_bias start = method->make();
    *row = (tuner_row){.method = method->name,
                       .has_knob = knobs[number].count > 0,
                       .found = {.tuned = {.bias = start}}};
    shb_result result = shb_map_draw(t->map, &t->stage->scene->scene, &start, NULL);
    if (!result && row->has_knob)
        result = search(t, &subject, number, &start, row);
    if (!result)
        result = tuning_ask(&subject, &row->found.tuned);
    if (!result)
        result = measure_detachment(t->truth.reference, t->map, &row->found.tuned.bias, NULL,
                                    &t->light->contact, &row->detachment);
    row->found.met = row->found.tuned.errors.false_shadow_ppm <= t->limit_ppm;
    write_setting(method, &row->found.tuned.bias, row);
    convert(&t->units, knobs[number].unit, (double)row->found.tuned.bias.params[0], row);
    return result;
}

static shb_result open_tuner(tuner *t, scene_light_kind light, uint32_t map_size) {
    shb_map_desc desc = {.width = map_size};
    shb_result result = scene_light_view(t->stage->scene, light, map_size, false, &desc.view);
    if (!result)
        result = shb_map_create(t->stage->context, &desc, &t->map);
    if (!result)
        result = shb_map_draw(t->map, &t->stage->scene->scene, NULL, NULL);
    if (!result)
        result = measure_truth_create(&t->stage->frame, t->map, &t->truth);
    return result ? result : find_units(t);
}

shb_result tuner_run(report_stage *stage, scene_light_kind light, uint32_t map_size,
                     double limit_ppm, tuner_result *result) {
    tuner t = {.stage = stage, .light = &stage->scene->lights[light], .limit_ppm = limit_ppm};
    tuner_result found = {0};
    shb_result code = open_tuner(&t, light, map_size);
    for (size_t i = 0; i < TUNER_METHODS && !code; i++)
        code = tune(&t, i, &found.rows[i]);
    found.units = t.units;
    found.fragments =
        found.rows[0].found.tuned.errors.lit + found.rows[0].found.tuned.errors.shadowed;
    measure_truth_destroy(&t.truth);
    shb_map_destroy(t.map);
    if (!code)
        *result = found;
    return code;
}
