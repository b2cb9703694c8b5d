#include "soft.h"

#include "paint.h"

#include <math.h>
#include <stdlib.h>

static shb_vec3 row_of(const shb_view *view, int row) {
    const double *m = view->clip_from_world.m;
    return (shb_vec3){m[row], m[4 + row], m[8 + row]};
}

shb_area_light soft_light(const shb_view *view, double width, bool disk) {
    shb_area_light area = {.disk = disk};
    shb_view_light_source(view, &area.light);
    area.u = shb_vec3_scale(shb_vec3_normalize(row_of(view, 0)), width / 2);
    area.v = shb_vec3_scale(shb_vec3_normalize(row_of(view, 1)), width / 2);
    return area;
}

/* ---- truth ---- */

static shb_vec3 triple(const float *values, size_t index) {
    const float *v = values + 3 * index;
    return (shb_vec3){(double)v[0], (double)v[1], (double)v[2]};
}

static shb_vec3 to_light(const shb_light_source *light, shb_vec3 point) {
    return light->w > 0 ? shb_vec3_subtract(light->position, point) : light->position;
}

/* Fragments as the reference takes them. */
typedef struct fragment_points {
    shb_vec3 *positions, *normals;
    uint32_t *own_ids;
    float *visibility;
} fragment_points;

static void free_points(fragment_points *points) {
    free(points->positions);
    free(points->normals);
    free(points->own_ids);
    free(points->visibility);
}

static bool copy_points(const measure_frame *frame, fragment_points *points) {
    const size_t count = frame->fragment_count + 1;
    *points = (fragment_points){malloc(count * sizeof(shb_vec3)), malloc(count * sizeof(shb_vec3)),
                                malloc(count * sizeof(uint32_t)), malloc(count * sizeof(float))};
    if (!points->positions || !points->normals || !points->own_ids || !points->visibility)
        return false;
    for (size_t i = 0; i < frame->fragment_count; i++) {
        points->positions[i] = triple(frame->positions, i);
        points->normals[i] = triple(frame->normals, i);
        points->own_ids[i] = frame->ids[frame->pixels[i]];
    }
    return true;
}

static shb_result follow_rays(const measure_frame *frame, const shb_area_light *area,
                              uint32_t samples, const fragment_points *points) {
    shb_reference *reference;
    shb_result result = shb_reference_create(frame->context, &frame->scene->scene, &reference);
    if (result)
        return result;
    const shb_area_points asked = {frame->fragment_count, points->positions, points->normals,
                                   points->own_ids};
    result = shb_reference_area(reference, area, samples, &asked, points->visibility);
    shb_reference_destroy(reference);
    return result;
}

static bool is_well_inside(const shb_view *view, const float *position) {
    const double *m = view->clip_from_world.m;
    double clip[4];
    for (int row = 0; row < 4; row++)
        clip[row] = m[row] * (double)position[0] + m[4 + row] * (double)position[1] +
                    m[8 + row] * (double)position[2] + m[12 + row];
    return fmax(fabs(clip[0]), fabs(clip[1])) < 0.9 * clip[3];
}

static void place_truth(const measure_frame *frame, const shb_view *view,
                        const shb_area_light *area, const fragment_points *points,
                        soft_truth *truth) {
    for (size_t i = 0; i < frame->fragment_count; i++) {
        const uint32_t pixel = frame->pixels[i];
        const shb_vec3 direction = to_light(&area->light, points->positions[i]);
        truth->visibility[pixel] = points->visibility[i];
        truth->mask[pixel] = shb_vec3_dot(points->normals[i], direction) > 0 &&
                             is_well_inside(view, frame->positions + 3 * i);
    }
}

shb_result soft_truth_create(const measure_frame *frame, const shb_view *view,
                             const shb_area_light *area, uint32_t samples, soft_truth *truth) {
    const size_t pixel_count = (size_t)frame->frame.width * frame->frame.height;
    *truth = (soft_truth){calloc(pixel_count, sizeof(float)), calloc(pixel_count, sizeof(float)),
                          calloc(pixel_count, 1)};
    fragment_points points = {0};
    shb_result result = SHB_ERROR_MEMORY;
    if (truth->visibility && truth->seen && truth->mask && copy_points(frame, &points))
        result = follow_rays(frame, area, samples, &points);
    if (result)
        soft_truth_destroy(truth);
    else
        place_truth(frame, view, area, &points, truth);
    free_points(&points);
    return result;
}

void soft_truth_destroy(soft_truth *truth) {
    free(truth->visibility);
    free(truth->seen);
    free(truth->mask);
    *truth = (soft_truth){0};
}

shb_result soft_truth_compare(const measure_frame *frame, const soft_truth *truth,
                              shb_soft_errors *errors) {
    for (size_t i = 0; i < frame->fragment_count; i++)
        truth->seen[frame->pixels[i]] = frame->visibility[i];
    return shb_soft_errors_measure(frame->frame.width, frame->frame.height, truth->visibility,
                                   truth->seen, truth->mask, errors);
}

/* ---- pictures ---- */

/* What the callback needs beside the scene. */
typedef struct painted {
    const measure_frame *frame;
    const shb_light_source *light;
    const float *color, *visibility;
} painted;

/* The lighting that the pixel's own values make of a batch. */
static void light_batch(const painted *p, const shb_shade_args *args, shb_lighting *lighting) {
    const shb_fragments *f = args->fragments;
    for (size_t i = 0; i < args->count; i++) {
        const size_t pixel = (size_t)f->pixel_y[i] * p->frame->frame.width + (size_t)f->pixel_x[i];
        const shb_vec3 point = {(double)f->x[i], (double)f->y[i], (double)f->z[i]};
        const shb_vec3 shading = {(double)f->shading_x[i], (double)f->shading_y[i],
                                  (double)f->shading_z[i]};
        const shb_vec3 normal = {(double)f->normal_x[i], (double)f->normal_y[i],
                                 (double)f->normal_z[i]};
        const shb_vec3 direction = shb_vec3_normalize(to_light(p->light, point));
        const double cosine = shb_vec3_dot(shading, direction);
        const bool faces = shb_vec3_dot(normal, direction) > 0 && cosine > 0;
        lighting->visibility[i] = p->visibility[pixel];
        lighting->cosine[i] = faces ? (float)cosine : 0;
    }
}

static void paint_batch(const shb_shade_args *args) {
    const painted *p = args->user;
    shb_lighting lighting;
    light_batch(p, args, &lighting);
    const shb_shade_light light = {.color = {p->color[0], p->color[1], p->color[2]}};
    shb_shade_args lit = *args;
    lit.user = p->frame->scene;
    lit.light_count = 1;
    lit.lights = &light;
    lit.lighting = &lighting;
    paint_scene(&lit);
}

shb_result soft_paint(const measure_frame *frame, const shb_light_source *light,
                      const float light_color[3], const float *visibility, const shb_image *image) {
    const painted user = {frame, light, light_color, visibility};
    const float *background = frame->scene->background;
    const shb_shade_desc desc = {.frame = frame->frame,
                                 .shade = paint_batch,
                                 .user = &user,
                                 .background = {background[0], background[1], background[2]},
                                 .image = *image};
    return shb_shade(frame->context, &desc);
}

void soft_paint_errors(const measure_frame *frame, const soft_truth *truth,
                       const shb_image *image) {
    const size_t stride = image->stride ? image->stride : 3 * (size_t)image->width;
    for (size_t row = 0; row < image->height; row++)
        for (size_t column = 0; column < image->width; column++) {
            const size_t pixel = row * image->width + column;
            uint8_t *out = image->pixels + row * stride + 3 * column;
            const float grey =
                frame->ids[pixel] == SHB_ID_NONE ? 25 : 40 + 50 * truth->visibility[pixel];
            const float error =
                truth->mask[pixel] ? truth->seen[pixel] - truth->visibility[pixel] : 0;
            const float shown = sqrtf(fabsf(error));
            const float share[3] = {error < 0 ? shown : 0, 0, error > 0 ? shown : 0};
            for (int k = 0; k < 3; k++)
                out[k] = (uint8_t)(grey * (1 - shown) + 255 * share[k] + 0.5f);
        }
}
