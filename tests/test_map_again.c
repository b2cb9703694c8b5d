/* Maps that are drawn again and again: what one drawing leaves must not be seen in the next. */
#include "../src/occluders.h"

#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "soup.h"
#include "test.h"

#include <string.h>

/* True if both maps hold the same. */
static bool are_equal(const shb_map *a, const shb_map *b) {
    const shb_map_info *info = &a->info;
    bool equal = a->occluders.held == b->occluders.held;
    for (uint32_t row = 0; row < info->height; row++) {
        const float *depth =
            (const float *)(const void *)((const char *)a->depth.texels + row * a->depth.stride);
        const char *other = (const char *)b->depth.texels + row * b->depth.stride;
        equal &= memcmp(depth, other, info->width * sizeof *depth) == 0;
        if (!a->occluders.held)
            continue;
        const uint32_t *texels = shb_occluder_row(a, (int32_t)row);
        const uint32_t *others = shb_occluder_row(b, (int32_t)row);
        /* Slopes mean nothing where there is no occluder. */
        const float empty = info->view.reversed ? 0.0f : 1.0f;
        for (uint32_t i = 0; i < info->width; i++)
            equal &= (depth[i] == empty && info->occluders == SHB_OCCLUDERS_PLANES) ||
                     texels[i] == others[i];
    }
    return equal;
}

/* Draws another scene, by another method, and compares with a map that is new. */
static void draw_again(shb_context *context, const shb_map_desc *desc, shb_map *map,
                       test_random *random) {
    const shb_bias methods[] = {shb_bias_exact(), shb_bias_constant(0, SHB_UNIT_DEPTH),
                                shb_bias_midpoint()};
    const shb_bias *bias = &methods[random_below(random, 8) < 6 ? 0 : random_below(random, 3)];
    soup s = {0};
    for (uint32_t i = random_below(random, 12); i > 0; i--)
        soup_add_patch(&s, random);
    soup_scene(&s);
    shb_clusters *clusters = NULL;
    if (s.count > 0 && random_below(random, 2))
        CHECK_INT(shb_clusters_create(context, &s.mesh, &clusters), SHB_OK);
    s.mesh.clusters = clusters;
    shb_map *fresh = NULL;
    CHECK_INT(shb_map_create(context, desc, &fresh), SHB_OK);
    CHECK_INT(shb_map_draw(fresh, &s.scene, bias, NULL), SHB_OK);
    CHECK_INT(shb_map_draw(map, &s.scene, bias, NULL), SHB_OK);
    CHECK(are_equal(map, fresh));
    shb_map_destroy(fresh);
    shb_clusters_destroy(clusters);
    soup_free(&s);
}

static void check_map(uint32_t threads, shb_isa isa, uint32_t width, int drawings,
                      test_random *random) {
    shb_context *context = test_context(threads, isa);
    for (int kind = 0; kind < 12; kind++) {
        const bool reversed = kind / 3 % 2;
        const shb_map_desc desc = {.view = kind < 6 ? probe_orthographic(reversed)
                                                    : probe_perspective(reversed),
                                   .width = width,
                                   .height = width / 2 + 3,
                                   .occluders = (shb_occluders)(kind % 3)};
        shb_map *map = NULL;
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        for (int i = 0; i < drawings; i++)
            draw_again(context, &desc, map, random);
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
}

TEST(a_map_that_is_drawn_again_is_as_a_new_one) {
    static const uint32_t widths[] = {400, 50, 32};
    test_random random = {7};
    for (uint32_t threads = 1; threads <= 3; threads++) {
        for (int i = 0; i < 3; i++)
            check_map(threads, SHB_ISA_BEST, widths[i], 6, &random);
        if (threads != 2) /* larger than a cache: cleared in another way */
            check_map(threads, SHB_ISA_BEST, 2064, 3, &random);
    }
    check_map(1, SHB_ISA_SCALAR, 64, 6, &random);
    check_map(2, SHB_ISA_SSE2, 240, 6, &random);
}
