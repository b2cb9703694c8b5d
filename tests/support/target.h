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

test_target test_target_create(uint32_t width, uint32_t height);
void test_target_destroy(test_target *target);

/* True if every byte of both targets is equal. */
bool test_target_equal(const test_target *a, const test_target *b);

/* All three images of the target, the rest zero. */
shb_draw_desc test_target_desc(const test_target *target, const shb_view *view,
                               const shb_scene *scene);

/* Draws into all three images and checks that it worked. */
shb_draw_stats test_target_draw(const test_target *target, shb_context *context,
                                const shb_view *view, const shb_scene *scene, uint32_t tile_size);

/* Mesh x and y are pixels, x right, y down; mesh z is depth. Exact for powers of two. */
shb_view test_pixel_view(uint32_t width, uint32_t height);

/* A context with this number of threads; destroy it with shb_context_destroy. */
shb_context *test_context(uint32_t threads);

#endif
