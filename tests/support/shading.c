#include "shading.h"

#include <stdlib.h>
#include <string.h>

#include "test.h"

shb_view pixel_space(uint32_t width, uint32_t height) {
    shb_view view = {{{0}}, false};
    double *m = view.clip_from_world.m;
    m[0] = 2.0 / width;
    m[12] = -1;
    m[5] = -2.0 / height;
    m[13] = 1;
    m[10] = 1.0 / 16;
    m[15] = 1;
    return view;
}

shb_view pinhole(void) {
    shb_view view = {{{0}}, false};
    view.clip_from_world.m[0] = view.clip_from_world.m[5] = 1;
    view.clip_from_world.m[10] = view.clip_from_world.m[11] = -1;
    view.clip_from_world.m[14] = -0.125;
    return view;
}

shb_context *shading_context(uint32_t threads) {
    const shb_context_desc desc = {.threads = threads};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    return context;
}

shb_map *shading_map(shb_context *context, const shb_view *view, uint32_t width, uint32_t height,
                     const float *depths) {
    const shb_map_desc desc = {.view = *view, .width = width, .height = height};
    shb_map *map = NULL;
    if (depths)
        CHECK_INT(shb_map_wrap(context, &desc, depths, 0, NULL, &map), SHB_OK);
    else
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    return map;
}

typedef struct recorder {
    uint32_t width;
    seen_pixel *pixels;
    unsigned *bad_batches; /* elements of one a pixel: the batch that ended there broke a rule */
} recorder;

static bool padding_repeats_the_last(const shb_shade_args *args) {
    const shb_fragments *f = args->fragments;
    const size_t last = args->count - 1;
    for (size_t i = args->count; i % 16; i++)
        if (f->x[i] != f->x[last] || f->normal_z[i] != f->normal_z[last] ||
            f->shading_y[i] != f->shading_y[last] || f->id[i] != f->id[last] ||
            f->pixel_x[i] != f->pixel_x[last] || f->pixel_y[i] != f->pixel_y[last])
            return false;
    return true;
}

static void record(const shb_shade_args *args) {
    const recorder *to = args->user;
    const shb_fragments *f = args->fragments;
    size_t at = 0;
    bool good = args->count >= 1 && args->count <= SHB_BATCH && padding_repeats_the_last(args);
    for (size_t i = 0; i < args->count; i++) {
        const size_t before = at;
        at = (size_t)f->pixel_y[i] * to->width + (size_t)f->pixel_x[i];
        good = good && (i == 0 || at > before);
        seen_pixel *pixel = &to->pixels[at];
        const unsigned times = pixel->times + 1;
        *pixel = (seen_pixel){times,
                              {f->x[i], f->y[i], f->z[i]},
                              {f->normal_x[i], f->normal_y[i], f->normal_z[i]},
                              {f->shading_x[i], f->shading_y[i], f->shading_z[i]},
                              f->weight_1[i],
                              f->weight_2[i],
                              f->id[i],
                              {0},
                              {0}};
        for (size_t k = 0; k < args->light_count && k < 2; k++) {
            pixel->visibility[k] = args->lighting[k].visibility[i];
            pixel->cosine[k] = args->lighting[k].cosine[i];
        }
        args->red[i] = args->green[i] = args->blue[i] = 1;
    }
    to->bad_batches[at] += !good;
}

seen_pixel *shade_and_record(shb_context *context, shb_shade_desc desc) {
    const size_t count = (size_t)desc.frame.width * desc.frame.height;
    recorder to = {desc.frame.width, calloc(count, sizeof(seen_pixel)),
                   calloc(count, sizeof(unsigned))};
    desc.shade = record;
    desc.user = &to;
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    unsigned bad = 0;
    for (size_t i = 0; i < count; i++)
        bad += to.bad_batches[i];
    CHECK_INT(bad, 0);
    free(to.bad_batches);
    return to.pixels;
}

void quad_init(quad *q, float depth, float slope) {
    const float positions[12] = {
        0, 0, depth, 8, 0, depth, 8, 4, depth + 4 * slope, 0, 4, depth + 4 * slope};
    const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
    memcpy(q->positions, positions, sizeof positions);
    memcpy(q->indices, indices, sizeof indices);
    q->mesh = (shb_mesh){.positions = q->positions,
                         .vertex_count = 4,
                         .indices = q->indices,
                         .index_size = 2,
                         .triangle_count = 2};
    q->instance = (shb_instance){.mesh = &q->mesh};
    q->scene = (shb_scene){&q->instance, 1};
    /* Centre (x, y) belongs to the first triangle where x > 2 y; none lies on the diagonal, as
     * column + 0.5 is never 2 row + 1. */
    for (uint32_t i = 0; i < 32; i++)
        q->ids[i] = i % 8 + 0.5 > 2 * (i / 8) + 1 ? 0 : 1;
    q->view = pixel_space(8, 4);
    q->frame =
        (shb_frame){.view = &q->view, .scene = &q->scene, .width = 8, .height = 4, .ids = q->ids};
}
