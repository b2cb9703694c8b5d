#include "group.h"

#include "judge.h"
#include "pictures.h"
#include "statistics.h"
#include "timing.h"

#include <stdio.h>
#include <stdlib.h>

/* One method while it is measured; times in seconds. */
typedef struct contender {
    const report_method *method;
    shb_filter filter;
    shb_map *map;
    double map_times[REPORT_RUNS_MAX], shading[REPORT_RUNS_MAX], visibility[REPORT_RUNS_MAX];
} contender;

/* A group while it is measured: methods that keep the same of occluders share a map, which is drawn
 * anew for each of them. */
typedef struct session {
    const report_group *group;
    report_stage *stage;
    const scene_light *light;
    shb_map *maps[SHB_OCCLUDERS_LISTS + 1];
    contender *contenders;            /* one a method */
    uint8_t *truth_of_pixels, *truth; /* of a point: of pixels and of fragments */
} session;

report_row report_group_key(const report_group *group, const report_method *method) {
    report_row row = {.map_size = group->map_size};
    snprintf(row.scene, sizeof row.scene, "%s", group->scene);
    report_name_light(group->light, row.light, sizeof row.light);
    snprintf(row.filter, sizeof row.filter, "%s", method->filter);
    snprintf(row.method, sizeof row.method, "%s", method->name);
    snprintf(row.settings, sizeof row.settings, "%s", group->settings);
    return row;
}

static bool is_soft(const session *s) {
    return s->group->light.degrees > 0;
}

static shb_result create_maps(session *s) {
    shb_map_desc desc = {.width = s->group->map_size};
    shb_result result =
        scene_light_view(s->stage->scene, s->group->light.kind, desc.width, false, &desc.view);
    for (int i = SHB_OCCLUDERS_NONE; !result && i <= SHB_OCCLUDERS_LISTS; i++) {
        desc.occluders = (shb_occluders)i;
        desc.exact_only = i == SHB_OCCLUDERS_LISTS;
        result = shb_map_create(s->stage->context, &desc, &s->maps[i]);
    }
    return result;
}

static shb_result call_contenders(session *s) {
    const report_methods *methods = s->group->methods;
    const double width = report_light_width(s->stage->scene, s->group->light);
    s->contenders = calloc(methods->count, sizeof *s->contenders);
    for (size_t i = 0; s->contenders && i < methods->count; i++) {
        contender *c = &s->contenders[i];
        c->method = &methods->methods[i];
        c->filter = report_method_filter(c->method, width);
        c->map = s->maps[c->method->occluders];
    }
    return s->contenders ? SHB_OK : SHB_ERROR_MEMORY;
}

static shb_result find_truth(session *s) {
    const measure_frame *frame = &s->stage->frame;
    if (is_soft(s))
        return report_stage_soften(s->stage, &shb_map_get_info(s->maps[0])->view, s->group->light,
                                   s->group->samples);
    s->truth_of_pixels = malloc((size_t)frame->frame.width * frame->frame.height);
    s->truth = malloc(frame->fragment_count + 1);
    if (!s->truth_of_pixels || !s->truth)
        return SHB_ERROR_MEMORY;
    const shb_classify_desc classify = {.frame = frame->frame, .map = s->maps[0]};
    const shb_result result =
        shb_reference_classify(s->stage->reference, &classify, s->truth_of_pixels);
    for (size_t i = 0; !result && i < frame->fragment_count; i++)
        s->truth[i] = s->truth_of_pixels[frame->pixels[i]];
    return result;
}

static shb_result draw_map(session *s, const contender *c, double *seconds) {
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    shb_result result = shb_map_draw(c->map, &s->stage->scene->scene, &c->method->bias, NULL);
    if (!result)
        result = shb_map_prepare(c->map, &c->filter);
    *seconds = bench_seconds(BENCH_CLOCK_WALL) - start;
    return result;
}

static shb_result shade(session *s, const contender *c, double *seconds) {
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    const shb_result result = measure_paint(&s->stage->frame, c->map, &c->method->bias, &c->filter,
                                            s->light->color, &s->stage->image);
    *seconds = bench_seconds(BENCH_CLOCK_WALL) - start;
    return result;
}

static shb_result ask(session *s, const contender *c, double *seconds) {
    measure_frame *frame = &s->stage->frame;
    const shb_points points = measure_points(frame);
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    const shb_result result =
        shb_map_visibility(c->map, &points, &c->method->bias, &c->filter, frame->visibility);
    *seconds = bench_seconds(BENCH_CLOCK_WALL) - start;
    return result;
}

static shb_result run(session *s, contender *c, uint32_t number) {
    shb_result result = draw_map(s, c, &c->map_times[number]);
    if (!result)
        result = shade(s, c, &c->shading[number]);
    return result ? result : ask(s, c, &c->visibility[number]);
}

/* What the latest run of a method said, against the truth. */
static shb_result judge(session *s, const contender *c, report_row *row) {
    const measure_frame *frame = &s->stage->frame;
    *row = report_group_key(s->group, c->method);
    row->triangles = s->stage->scene->triangle_count;
    row->memory_bytes = shb_map_get_info(c->map)->memory_bytes;
    const shb_result result = is_soft(s) ? report_judge_soft(frame, &s->stage->soft, row)
                                         : report_judge_hard(frame, s->truth, row);
    if (result)
        return result;
    shb_detachment detachment;
    const shb_result measured = measure_detachment(s->stage->reference, c->map, &c->method->bias,
                                                   &c->filter, &s->light->contact, &detachment);
    row->detachment_texels = detachment.texels;
    return measured;
}

static shb_result judge_and_picture(session *s, const contender *c, report_row *row) {
    const shb_result result = judge(s, c, row);
    if (result || !s->group->pictures)
        return result;
    return report_picture_visibility(s->group->pictures, row, &s->stage->frame);
}

static void take_medians(const session *s, contender *c, report_row *row) {
    const uint32_t runs = s->group->runs;
    const size_t fragments = s->stage->frame.fragment_count;
    row->map_ms = 1e3 * statistics_median(c->map_times, runs);
    row->shading_ms = 1e3 * statistics_median(c->shading, runs);
    if (fragments)
        row->ns_per_fragment = 1e9 * statistics_median(c->visibility, runs) / (double)fragments;
}

/* Maps that are drawn for every frame take their memory in the first two drawings: not timed. */
static shb_result warm_maps(session *s) {
    shb_result result = SHB_OK;
    for (size_t i = 0; i < sizeof s->maps / sizeof *s->maps; i++)
        for (int k = 0; k < 2 && s->maps[i] && !result; k++)
            result = shb_map_draw(s->maps[i], &s->stage->scene->scene, NULL, NULL);
    return result;
}

static shb_result run_all(session *s, report_row *rows) {
    const size_t count = s->group->methods->count;
    shb_result result = warm_maps(s);
    for (uint32_t k = 0; !result && k < s->group->runs; k++)
        for (size_t i = 0; !result && i < count; i++) {
            result = run(s, &s->contenders[i], k);
            if (!result && k == 0)
                result = judge_and_picture(s, &s->contenders[i], &rows[i]);
        }
    for (size_t i = 0; !result && i < count; i++)
        take_medians(s, &s->contenders[i], &rows[i]);
    return result;
}

static shb_result picture_truth(session *s, const report_row *key) {
    const char *directory = s->group->pictures;
    const measure_frame *frame = &s->stage->frame;
    return is_soft(s) ? report_picture_soft_truth(directory, key, frame, &s->stage->soft)
                      : report_picture_truth(directory, key, frame, s->truth_of_pixels);
}

/* The pictures that all methods of the light, and of the size, have in common. */
static shb_result picture_rest(session *s) {
    const report_group *group = s->group;
    if (!group->pictures)
        return SHB_OK;
    const report_row key = report_group_key(group, &group->methods->methods[0]);
    const shb_result result = report_picture_extremes(
        group->pictures, &key, &s->stage->frame, s->maps[0], s->light->color, &s->stage->image);
    return result ? result : picture_truth(s, &key);
}

shb_result report_group_measure(const report_group *group, report_stage *stage, report_row *rows) {
    session s = {.group = group, .stage = stage, .light = &stage->scene->lights[group->light.kind]};
    shb_result result = create_maps(&s);
    if (!result)
        result = call_contenders(&s);
    if (!result)
        result = find_truth(&s);
    if (!result)
        result = picture_rest(&s);
    if (!result)
        result = run_all(&s, rows);
    for (int i = SHB_OCCLUDERS_NONE; i <= SHB_OCCLUDERS_LISTS; i++)
        shb_map_destroy(s.maps[i]);
    free(s.contenders);
    free(s.truth_of_pixels);
    free(s.truth);
    return result;
}
