#include "group.h"

#include "pictures.h"
#include "statistics.h"
#include "stopwatch.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Times of one method, seconds. */
typedef struct samples {
    double map[REPORT_RUNS_MAX], shading[REPORT_RUNS_MAX], visibility[REPORT_RUNS_MAX];
} samples;

/* A group while it is measured: methods that keep the same of occluders share a map, which is drawn
 * anew for each of them. */
typedef struct session {
    const report_group *group;
    report_stage *stage;
    const scene_light *light;
    shb_map *maps[SHB_OCCLUDERS_LISTS + 1];
    uint8_t *truth_of_pixels, *truth; /* of pixels and of fragments */
    samples *samples;                 /* one a method */
} session;

report_row report_group_key(const report_group *group, const report_method *method) {
    report_row row = {.map_size = group->map_size};
    snprintf(row.scene, sizeof row.scene, "%s", group->stage->name);
    snprintf(row.light, sizeof row.light, "%s", report_light_name(group->light));
    snprintf(row.filter, sizeof row.filter, "%s", method->filter);
    snprintf(row.method, sizeof row.method, "%s", method->name);
    snprintf(row.settings, sizeof row.settings, "%s", group->settings);
    return row;
}

static shb_result create_maps(session *s) {
    shb_map_desc desc = {.width = s->group->map_size};
    shb_result result =
        scene_light_view(s->stage->scene, s->group->light, desc.width, false, &desc.view);
    for (int i = SHB_OCCLUDERS_NONE; !result && i <= SHB_OCCLUDERS_LISTS; i++) {
        desc.occluders = (shb_occluders)i;
        result = shb_map_create(s->stage->context, &desc, &s->maps[i]);
    }
    return result;
}

static shb_result find_truth(session *s) {
    const measure_frame *frame = &s->stage->frame;
    s->truth_of_pixels = malloc((size_t)frame->frame.width * frame->frame.height);
    s->truth = malloc(frame->fragment_count + 1);
    s->samples = calloc(s->group->methods->count, sizeof *s->samples);
    if (!s->truth_of_pixels || !s->truth || !s->samples)
        return SHB_ERROR_MEMORY;
    const shb_classify_desc classify = {.frame = frame->frame, .map = s->maps[0]};
    const shb_result result =
        shb_reference_classify(s->stage->reference, &classify, s->truth_of_pixels);
    for (size_t i = 0; !result && i < frame->fragment_count; i++)
        s->truth[i] = s->truth_of_pixels[frame->pixels[i]];
    return result;
}

static shb_result draw_map(session *s, const report_method *method, double *seconds) {
    shb_map *map = s->maps[method->occluders];
    const double start = stopwatch_seconds();
    shb_result result = shb_map_draw(map, &s->stage->scene->scene, &method->bias, NULL);
    if (!result)
        result = shb_map_prepare(map, &method->with);
    *seconds = stopwatch_seconds() - start;
    return result;
}

static shb_result shade(session *s, const report_method *method, double *seconds) {
    const double start = stopwatch_seconds();
    const shb_result result =
        measure_paint(&s->stage->frame, s->maps[method->occluders], &method->bias, &method->with,
                      s->light->color, &s->stage->image);
    *seconds = stopwatch_seconds() - start;
    return result;
}

static shb_result ask(session *s, const report_method *method, double *seconds) {
    measure_frame *frame = &s->stage->frame;
    const shb_points points = {
        .count = frame->fragment_count, .positions = frame->positions, .normals = frame->normals};
    const double start = stopwatch_seconds();
    const shb_result result = shb_map_visibility(s->maps[method->occluders], &points, &method->bias,
                                                 &method->with, frame->visibility);
    *seconds = stopwatch_seconds() - start;
    return result;
}

static shb_result run(session *s, size_t number, uint32_t run) {
    const report_method *method = &s->group->methods->methods[number];
    samples *times = &s->samples[number];
    shb_result result = draw_map(s, method, &times->map[run]);
    if (!result)
        result = shade(s, method, &times->shading[run]);
    return result ? result : ask(s, method, &times->visibility[run]);
}

static shb_result judge_detachment(session *s, const report_method *method, report_row *row) {
    const scene_contact *contact = &s->light->contact;
    shb_detachment detachment;
    row->detachment_texels = (double)NAN;
    if (contact->length <= 0)
        return SHB_OK;
    const shb_detachment_desc desc = {.map = s->maps[method->occluders],
                                      .bias = &method->bias,
                                      .filter = &method->with,
                                      .contact = contact->contact,
                                      .direction = contact->direction,
                                      .normal = contact->normal,
                                      .length = contact->length,
                                      .samples = 1000,
                                      .receiver_id = SHB_ID_NONE};
    const shb_result result = shb_detachment_measure(s->stage->reference, &desc, &detachment);
    if (!result)
        row->detachment_texels = detachment.texels;
    return result;
}

/* What the latest run of a method said, against the truth. */
static shb_result judge(session *s, const report_method *method, report_row *row) {
    const measure_frame *frame = &s->stage->frame;
    shb_errors errors;
    *row = report_group_key(s->group, method);
    shb_result result =
        shb_errors_measure(frame->fragment_count, s->truth, frame->visibility, &errors);
    if (result)
        return result;
    row->triangles = s->stage->scene->triangle_count;
    row->fragments = errors.lit + errors.shadowed;
    row->memory_bytes = shb_map_get_info(s->maps[method->occluders])->memory_bytes;
    row->false_shadow_ppm = errors.false_shadow_ppm;
    row->false_light_ppm = errors.false_light_ppm;
    row->boundary_ppm = errors.boundary_ppm;
    row->wrong_ppm = errors.wrong_ppm;
    row->rms = row->ssim = (double)NAN;
    return judge_detachment(s, method, row);
}

static shb_result picture_method(const session *s, const report_row *row) {
    return s->group->pictures ? report_picture_visibility(s->group->pictures, row, &s->stage->frame)
                              : SHB_OK;
}

static void take_medians(const session *s, size_t number, report_row *row) {
    const samples *times = &s->samples[number];
    const uint32_t runs = s->group->runs;
    const size_t fragments = s->stage->frame.fragment_count;
    row->map_ms = 1e3 * statistics_median(times->map, runs);
    row->shading_ms = 1e3 * statistics_median(times->shading, runs);
    if (fragments)
        row->ns_per_fragment = 1e9 * statistics_median(times->visibility, runs) / (double)fragments;
}

static shb_result run_all(session *s, report_row *rows) {
    const size_t count = s->group->methods->count;
    shb_result result = SHB_OK;
    for (uint32_t k = 0; !result && k < s->group->runs; k++)
        for (size_t i = 0; !result && i < count; i++) {
            result = run(s, i, k);
            if (!result && k == 0)
                result = judge(s, &s->group->methods->methods[i], &rows[i]);
            if (!result && k == 0)
                result = picture_method(s, &rows[i]);
        }
    for (size_t i = 0; !result && i < count; i++)
        take_medians(s, i, &rows[i]);
    return result;
}

/* The pictures that all methods of the light, and of the size, have in common. */
static shb_result picture_rest(session *s) {
    const report_group *group = s->group;
    if (!group->pictures)
        return SHB_OK;
    const report_row key = report_group_key(group, &group->methods->methods[0]);
    const shb_result result = report_picture_extremes(
        group->pictures, &key, &s->stage->frame, s->maps[0], s->light->color, &s->stage->image);
    return result
               ? result
               : report_picture_truth(group->pictures, &key, &s->stage->frame, s->truth_of_pixels);
}

shb_result report_group_measure(const report_group *group, report_row *rows) {
    session s = {
        .group = group, .stage = group->stage, .light = &group->stage->scene->lights[group->light]};
    shb_result result = create_maps(&s);
    if (!result)
        result = find_truth(&s);
    if (!result)
        result = picture_rest(&s);
    if (!result)
        result = run_all(&s, rows);
    for (int i = SHB_OCCLUDERS_NONE; i <= SHB_OCCLUDERS_LISTS; i++)
        shb_map_destroy(s.maps[i]);
    free(s.truth_of_pixels);
    free(s.truth);
    free(s.samples);
    return result;
}
