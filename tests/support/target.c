#include "target.h"

#include "contexts.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

test_contexts *test_contexts_create(uint32_t threads) {
    test_contexts *contexts = calloc(1, sizeof *contexts);
    contexts->scalar = test_context(threads, SHB_ISA_SCALAR);
    contexts->best = test_context(threads, SHB_ISA_BEST);
    return contexts;
}

void test_contexts_destroy(test_contexts *contexts) {
    shb_context_destroy(contexts->scalar);
    shb_context_destroy(contexts->best);
    free(contexts);
}

test_target test_target_create(uint32_t width, uint32_t height) {
    const size_t count = (size_t)width * height;
    test_target target = {width, height, malloc(count * 4), malloc(count * 4), malloc(count * 4)};
    memset(target.depth, 0xa5, count * 4);
    memset(target.second, 0xa5, count * 4);
    memset(target.ids, 0xa5, count * 4);
    return target;
}

void test_target_destroy(test_target *target) {
    free(target->depth);
    free(target->second);
    free(target->ids);
}

bool test_target_equal(const test_target *a, const test_target *b) {
    const size_t bytes = (size_t)a->width * a->height * 4;
    return memcmp(a->depth, b->depth, bytes) == 0 && memcmp(a->second, b->second, bytes) == 0 &&
           memcmp(a->ids, b->ids, bytes) == 0;
}

shb_draw_desc test_target_desc(const test_target *target, const shb_view *view,
                               const shb_scene *scene) {
    return (shb_draw_desc){
        .view = view,
        .scene = scene,
        .width = target->width,
        .height = target->height,
        .depth = {target->depth, 0, SHB_FORMAT_FLOAT32},
        .second = {target->second, 0, SHB_FORMAT_FLOAT32},
        .ids = target->ids,
    };
}

static shb_draw_stats draw_with(const test_target *target, shb_context *context,
                                const shb_view *view, const shb_scene *scene, uint32_t tile_size) {
    shb_draw_desc desc = test_target_desc(target, view, scene);
    desc.tile_size = tile_size;
    shb_draw_stats stats = {0};
    CHECK_INT(shb_draw(context, &desc, &stats), SHB_OK);
    return stats;
}

shb_draw_stats test_target_draw(const test_target *target, const test_contexts *contexts,
                                const shb_view *view, const shb_scene *scene, uint32_t tile_size) {
    test_target reference = test_target_create(target->width, target->height);
    const shb_draw_stats expected = draw_with(&reference, contexts->scalar, view, scene, 0);
    const shb_draw_stats stats = draw_with(target, contexts->best, view, scene, tile_size);
    CHECK(test_target_equal(target, &reference));
    CHECK(memcmp(&stats, &expected, sizeof stats) == 0);
    test_target_destroy(&reference);
    return stats;
}

shb_view test_pixel_view(uint32_t width, uint32_t height) {
    shb_view view = {.clip_from_world = shb_mat4_identity()};
    view.clip_from_world.m[0] = 2.0 / width;
    view.clip_from_world.m[5] = -2.0 / height;
    view.clip_from_world.m[12] = -1;
    view.clip_from_world.m[13] = 1;
    return view;
}
