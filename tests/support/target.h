/* A target to draw into, and views whose mesh units are pixels. */
#ifndef TESTS_SUPPORT_TARGET_H
#define TESTS_SUPPORT_TARGET_H

#include "shadowbias/raster.h"

typedef struct test_target {
    uint32_t width, height;
    float *depth;
    float *second;
    uint32_t *ids;
} test_target;

/* The reference code, and what this processor offers. */
typedef struct test_contexts {
    shb_context *scalar;
    shb_context *best;
} test_contexts;

test_contexts *test_contexts_create(uint32_t threads);
void test_contexts_destroy(test_contexts *contexts);

/* Filled with a pattern that no drawing gives. */
test_target test_target_create(uint32_t width, uint32_t height);
void test_target_destroy(test_target *target);

/* True if every byte of both targets is equal. */
bool test_target_equal(const test_target *a, const test_target *b);

/* All three images of the target, the rest zero. */
shb_draw_desc test_target_desc(const test_target *target, const shb_view *view,
                               const shb_scene *scene);

/* Draws into all three images with both contexts and checks that it worked and that they agree. */
shb_draw_stats test_target_draw(const test_target *target, const test_contexts *contexts,
                                const shb_view *view, const shb_scene *scene, uint32_t tile_size);

/* Mesh x and y are pixels, x right, y down; mesh z is depth. Exact for powers of two. */
shb_view test_pixel_view(uint32_t width, uint32_t height);

#endif
