#include "causes.h"

#include "light_space.h"
#include "receivers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *cause_name(cause kind) {
    static const char *const names[CAUSES] = {
        "right",  "kernel", "quantisation",  "slope",    "bias",
        "offset", "crease", "extrapolation", "sampling", "unexplained"};
    return names[kind];
}

/* What questions are asked of again. */
typedef struct finder {
    const cause_question *question;
    const shb_map_info *info;
    light_space space;
    shb_map *sharp;  /* as the map, in float */
    float *nearest;  /* canonical depth of the nearest surface of each texel */
    uint32_t *ids;   /* its triangle */
    bool knows_ref;  /* false: the exact method, which asks more than the sample */
    uint8_t *causes; /* out */
} finder;

/* Wrong fragments that are looked at together. */
typedef struct batch {
    size_t count;
    size_t fragments[SHB_BATCH];
    float positions[3 * SHB_BATCH], normals[3 * SHB_BATCH];
    SHB_ALIGN float visibility[SHB_BATCH]; /* by a single tap */
    shb_receivers receivers;
    float stored[SHB_BATCH], stored_sharp[SHB_BATCH]; /* at the texel that is asked */
    float stored_own[SHB_BATCH];                      /* at the fragment's own texel */
    int32_t own_x[SHB_BATCH], own_y[SHB_BATCH];
    light_point points[SHB_BATCH];
    uint8_t within[SHB_BATCH]; /* 1: nothing stands between the light and the receiver plane at the
                                  fragment's own place */
} batch;

/* ---- what is drawn again ---- */

static shb_result draw_sharp(finder *f) {
    const cause_question *q = f->question;
    const shb_map_desc desc = {.view = f->info->view,
                               .width = f->info->width,
                               .height = f->info->height,
                               .scene_scale = f->info->scene_scale};
    const bool plain = q->bias->needs & SHB_NEEDS_OCCLUDERS;
    shb_result result = shb_map_create(q->frame->context, &desc, &f->sharp);
    return result ? result
                  : shb_map_draw(f->sharp, &q->frame->scene->scene, plain ? NULL : q->bias, NULL);
}

static shb_result draw_nearest(finder *f) {
    const size_t count = (size_t)f->info->width * f->info->height;
    f->nearest = malloc(count * sizeof *f->nearest);
    f->ids = malloc(count * sizeof *f->ids);
    if (!f->nearest || !f->ids)
        return SHB_ERROR_MEMORY;
    const shb_draw_desc desc = {.view = &f->info->view,
                                .scene = &f->question->frame->scene->scene,
                                .width = f->info->width,
                                .height = f->info->height,
                                .depth = {.texels = f->nearest},
                                .ids = f->ids};
    const shb_result result = shb_draw(f->question->frame->context, &desc, NULL);
    for (size_t i = 0; i < count && !result && f->info->view.reversed; i++)
        f->nearest[i] = -f->nearest[i];
    return result;
}

/* ---- one fragment ---- */

/* One of a batch, with what its tests compare. */
typedef struct suspect {
    size_t number; /* in the batch */
    uint32_t id;
    light_point point;
    int32_t x, y;         /* the texel that is asked */
    bool moved;           /* it is not the fragment's own one */
    double ref;           /* there, not behind the far plane */
    double ref_own;       /* the receiver plane at the fragment's own place */
    light_plane plane;    /* of the receiver */
    double rounding;      /* of depths */
    double sample, sharp; /* stored at the texel, in the map and in float */
} suspect;

static bool is_inside(const finder *f, int32_t x, int32_t y) {
    return x >= 0 && y >= 0 && (uint32_t)x < f->info->width && (uint32_t)y < f->info->height;
}

static size_t texel_of(const finder *f, int32_t x, int32_t y) {
    return (size_t)y * f->info->width + (size_t)x;
}

static double far_depth(const finder *f) {
    return f->info->view.reversed ? 0 : 1;
}

static light_plane plane_of(const finder *f, uint32_t id) {
    shb_vec3 corners[3] = {{0}};
    shb_scene_triangle(&f->question->frame->scene->scene, id, corners);
    return light_space_plane(&f->space, corners);
}

static suspect suspect_of(const finder *f, const batch *b, size_t number) {
    const measure_frame *frame = f->question->frame;
    const shb_receivers *r = &b->receivers;
    suspect s = {.number = number,
                 .id = frame->ids[frame->pixels[b->fragments[number]]],
                 .point = b->points[number],
                 .x = r->texel_x[number],
                 .y = r->texel_y[number],
                 .sample = (double)b->stored[number],
                 .sharp = (double)b->stored_sharp[number]};
    const double ref = (double)r->ref[number];
    s.moved = f->question->bias->offset && (s.x != b->own_x[number] || s.y != b->own_y[number]);
    s.ref = fmin(ref, far_depth(f));
    s.ref_own = ref + (double)r->step_x[number] * (s.point.x - (s.x + 0.5)) +
                (double)r->step_y[number] * (s.point.y - (s.y + 0.5));
    s.plane = plane_of(f, s.id);
    /* A few operations on floats, and how far rounding moved the position off its plane. */
    const double off = light_plane_at(&s.plane, s.point.x, s.point.y) - s.point.depth;
    s.rounding = 8 * 0x1p-24 * fabs(s.point.depth) + (isfinite(off) ? fabs(off) : 0);
    return s;
}

/* Outside of the map there is nothing. */
static double nearest_at(const finder *f, int32_t x, int32_t y) {
    return is_inside(f, x, y) ? (double)f->nearest[texel_of(f, x, y)] : far_depth(f);
}

/* The nearest surface at a texel's centre does not lie in front of the receiver's plane. */
static bool plane_lights(const finder *f, const suspect *s, int32_t x, int32_t y) {
    return nearest_at(f, x, y) >= light_plane_at(&s->plane, x + 0.5, y + 0.5) - s->rounding;
}

static bool share_corner(const finder *f, uint32_t first, uint32_t second) {
    const shb_scene *scene = &f->question->frame->scene->scene;
    shb_vec3 a[3], b[3];
    if (shb_scene_triangle(scene, first, a) || shb_scene_triangle(scene, second, b))
        return false;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (a[i].x == b[k].x && a[i].y == b[k].y && a[i].z == b[k].z)
                return true;
    return false;
}

static cause cause_of_acne(const finder *f, const batch *b, const suspect *s) {
    if (f->knows_ref && s->sharp >= s->ref - s->rounding)
        return CAUSE_QUANTISATION;
    if (f->knows_ref && plane_lights(f, s, s->x, s->y))
        return CAUSE_SLOPE;
    if (s->moved && plane_lights(f, s, b->own_x[s->number], b->own_y[s->number]))
        return CAUSE_OFFSET;
    const uint32_t occluder =
        is_inside(f, s->x, s->y) ? f->ids[texel_of(f, s->x, s->y)] : SHB_ID_NONE;
    if (occluder == SHB_ID_NONE || occluder == s->id)
        return CAUSE_UNEXPLAINED;
    const light_plane plane = plane_of(f, occluder);
    const double carried = light_plane_at(&plane, s->point.x, s->point.y);
    if (carried >= s->point.depth - s->rounding || share_corner(f, occluder, s->id))
        return CAUSE_CREASE;
    return CAUSE_SAMPLING;
}

static cause cause_of_leak(const finder *f, const batch *b, const suspect *s) {
    const double nearest = nearest_at(f, s->x, s->y);
    const double far = far_depth(f), own = fmin(s->ref_own, far);
    if (!f->knows_ref)
        return nearest < s->ref || nearest < s->point.depth ? CAUSE_EXTRAPOLATION : CAUSE_SAMPLING;
    if (s->sharp < s->ref + s->rounding)
        return CAUSE_QUANTISATION;
    if (b->within[s->number] || nearest < s->ref)
        return CAUSE_BIAS;
    const double ref_at_own =
        s->ref + (double)b->receivers.step_x[s->number] * (b->own_x[s->number] - s->x) +
        (double)b->receivers.step_y[s->number] * (b->own_y[s->number] - s->y);
    if (s->moved && (double)b->stored_own[s->number] < fmin(ref_at_own, far))
        return CAUSE_OFFSET;
    return s->sample < own ? CAUSE_EXTRAPOLATION : CAUSE_SAMPLING;
}

/* ---- a batch ---- */

static bool is_hard(const shb_filter *filter) {
    return !filter || strcmp(filter->name, "hard") == 0;
}

static shb_vec3 triple(const float *values, size_t index) {
    const float *v = values + 3 * index;
    return (shb_vec3){(double)v[0], (double)v[1], (double)v[2]};
}

/* The questions of all fragments of a batch: by the map's single tap, and what it compares. */
static shb_result ask_batch(const finder *f, batch *b) {
    const cause_question *q = f->question;
    const shb_bias plane = shb_bias_receiver_plane(0);
    const shb_points points = {.count = b->count, .positions = b->positions, .normals = b->normals};
    shb_result result = shb_map_visibility(q->map, &points, q->bias, NULL, b->visibility);
    if (!result)
        result = f->knows_ref ? receivers_look(q->map, &points, q->bias, &b->receivers)
                              : receivers_look(f->sharp, &points, &plane, &b->receivers);
    if (result)
        return result;
    const shb_receivers *r = &b->receivers;
    for (size_t i = 0; i < b->count; i++) {
        b->points[i] = light_space_project(&f->space, triple(b->positions, i));
        b->own_x[i] = (int32_t)floor(b->points[i].x);
        b->own_y[i] = (int32_t)floor(b->points[i].y);
    }
    shb_map_fetch(q->map, b->count, r->texel_x, r->texel_y, b->stored);
    shb_map_fetch(f->sharp, b->count, r->texel_x, r->texel_y, b->stored_sharp);
    shb_map_fetch(q->map, b->count, b->own_x, b->own_y, b->stored_own);
    return SHB_OK;
}

/* Rays to the receiver plane at each fragment's own place. */
static shb_result follow_rays(const finder *f, batch *b) {
    shb_vec3 points[SHB_BATCH];
    uint32_t ids[SHB_BATCH];
    uint8_t occluded[SHB_BATCH];
    for (size_t i = 0; i < b->count; i++) {
        const suspect s = suspect_of(f, b, i);
        light_point point = s.point;
        point.depth = fmin(s.ref_own, point.depth);
        points[i] = light_space_unproject(&f->space, point);
        ids[i] = s.id;
    }
    const shb_result result = shb_reference_occluded(f->question->truth->reference, &f->info->light,
                                                     b->count, points, ids, occluded);
    for (size_t i = 0; i < b->count && !result; i++)
        b->within[i] = !occluded[i];
    return result;
}

static cause cause_of(const finder *f, const batch *b, size_t number) {
    const suspect s = suspect_of(f, b, number);
    const bool lit = f->question->truth->fragments[b->fragments[number]] & SHB_TRUTH_LIT;
    const bool single_tap_lights = b->visibility[number] >= 0.5f;
    if (!is_hard(f->question->filter) && single_tap_lights == lit)
        return CAUSE_KERNEL;
    if (f->info->occluders == SHB_OCCLUDERS_LISTS ||
        (f->knows_ref && (s.sample >= s.ref) != single_tap_lights))
        return CAUSE_UNEXPLAINED;
    return lit ? cause_of_acne(f, b, &s) : cause_of_leak(f, b, &s);
}

static shb_result explain_batch(const finder *f, batch *b) {
    if (b->count == 0)
        return SHB_OK;
    shb_result result = ask_batch(f, b);
    if (!result)
        result = follow_rays(f, b);
    for (size_t i = 0; i < b->count && !result; i++)
        f->causes[b->fragments[i]] = (uint8_t)cause_of(f, b, i);
    b->count = 0;
    return result;
}

static bool is_wrong(const cause_question *q, size_t fragment) {
    const uint8_t truth = q->truth->fragments[fragment];
    const bool lights = q->frame->visibility[fragment] >= 0.5f;
    return truth != SHB_TRUTH_NONE && lights != ((truth & SHB_TRUTH_LIT) != 0);
}

static shb_result explain(finder *f) {
    const cause_question *q = f->question;
    const measure_frame *frame = q->frame;
    shb_result result = SHB_OK;
    batch *b = aligned_alloc(_Alignof(batch), sizeof *b);
    if (!b)
        return SHB_ERROR_MEMORY;
    b->count = 0;
    for (size_t i = 0; i < frame->fragment_count && !result; i++) {
        f->causes[i] = CAUSE_NONE;
        if (!is_wrong(q, i))
            continue;
        memcpy(b->positions + 3 * b->count, frame->positions + 3 * i, 3 * sizeof(float));
        memcpy(b->normals + 3 * b->count, frame->normals + 3 * i, 3 * sizeof(float));
        b->fragments[b->count++] = i;
        if (b->count == SHB_BATCH)
            result = explain_batch(f, b);
    }
    if (!result)
        result = explain_batch(f, b);
    free(b);
    return result;
}

shb_result causes_find(const cause_question *question, uint8_t *causes) {
    measure_frame *frame = question->frame;
    finder f = {.question = question,
                .info = shb_map_get_info(question->map),
                .knows_ref = !(question->bias->needs & SHB_NEEDS_OCCLUDERS),
                .causes = causes};
    const shb_points points = measure_points(frame);
    shb_result result = shb_map_visibility(question->map, &points, question->bias, question->filter,
                                           frame->visibility);
    if (!result)
        result = light_space_create(f.info, &f.space);
    if (!result)
        result = draw_sharp(&f);
    if (!result)
        result = draw_nearest(&f);
    if (!result)
        result = explain(&f);
    shb_map_destroy(f.sharp);
    free(f.nearest);
    free(f.ids);
    return result;
}

cause_counts causes_count(const cause_question *question, const uint8_t *causes) {
    cause_counts counts = {0};
    for (size_t i = 0; i < question->frame->fragment_count; i++) {
        const uint8_t truth = question->truth->fragments[i];
        if (truth == SHB_TRUTH_NONE)
            continue;
        counts.fragments++;
        if (causes[i] == CAUSE_NONE)
            continue;
        counts.wrong++;
        if (truth & SHB_TRUTH_LIT)
            counts.acne[causes[i]]++;
        else
            counts.leak[causes[i]]++;
    }
    return counts;
}
