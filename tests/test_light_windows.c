/* What could stand between a fragment and a light, against a search of all texels. */
#include "../src/kernels/moments.h"

#include "depth_map.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

enum { FRAGMENTS = SHB_BATCH - 6, SIZES = 5 };

/* Where a fragment of the batch lies, in double. */
typedef struct fragment {
    double x, y, depth; /* texels, canonical */
    bool asks;          /* in the map and behind the near plane */
} fragment;

static const uint32_t sizes[SIZES][2] = {{1, 1}, {7, 9}, {300, 17}, {64, 64}, {33, 129}};

/* Most texels are far, so that the nearest of a window is not that of its neighbours. */
static float *random_depths(test_random *random, size_t count) {
    float *depths = malloc(count * sizeof *depths);
    for (size_t i = 0; i < count; i++)
        depths[i] = (float)pow(random_double(random, 0, 1), 0.05);
    return depths;
}

static void random_fragments(test_random *random, const shb_map_info *info, shb_receivers *r,
                             fragment *fragments) {
    const double near_depth = info->view.reversed ? -1 : 0;
    for (int i = 0; i < SHB_BATCH; i++) {
        r->texel_x[i] = (int32_t)random_below(random, info->width + 4) - 2;
        r->texel_y[i] = (int32_t)random_below(random, info->height + 4) - 2;
        r->to_center_x[i] = (float)random_double(random, -0.5, 0.5);
        r->to_center_y[i] = (float)random_double(random, -0.5, 0.5);
        r->step_x[i] = (float)random_double(random, -0.1, 0.1);
        r->step_y[i] = (float)random_double(random, -0.1, 0.1);
        r->ref[i] = (float)(near_depth + random_double(random, -0.1, 1.2));
        const double own = (double)(r->ref[i] - (r->step_x[i] * r->to_center_x[i] +
                                                 r->step_y[i] * r->to_center_y[i]));
        const bool inside =
            (uint32_t)r->texel_x[i] < info->width && (uint32_t)r->texel_y[i] < info->height;
        fragments[i] = (fragment){r->texel_x[i] + 0.5 - (double)r->to_center_x[i],
                                  r->texel_y[i] + 0.5 - (double)r->to_center_y[i],
                                  fmin(own, near_depth + 1), inside && own > near_depth};
    }
}

/* The least depth of the texels that a light of this span covers for a blocker so much nearer, each
 * at its own depth if by is below 0, and of those within some texels of them. */
static double search(const shb_map_info *info, const float *depths, const fragment *f,
                     const shb_light_span *span, double by, int margin) {
    const double near_depth = info->view.reversed ? -1 : 0;
    double least = f->depth;
    for (int y = 0; y < (int)info->height; y++)
        for (int x = 0; x < (int)info->width; x++) {
            const double depth = near_depth + (double)depths[y * (int)info->width + x];
            const double nearer_by = by < 0 ? f->depth - depth : by;
            const double reach_x = (double)span->x * nearer_by / 2 + margin;
            const double reach_y = (double)span->y * nearer_by / 2 + margin;
            if (x + 1 > f->x - reach_x && x < f->x + reach_x && y + 1 > f->y - reach_y &&
                y < f->y + reach_y)
                least = fmin(least, depth);
        }
    return least;
}

/* Cells that hold a window reach less than twice its side beyond it, and than 16 texels for a small
 * one. */
static int margin_of(const shb_light_span *span, double nearer_by) {
    const double side = fmax((double)span->x, (double)span->y) * nearer_by + 1;
    return side > 8 ? (int)(2 * side) + 2 : 16;
}

static void check_fragment(const shb_map *map, const float *depths, const shb_light_span *span,
                           const fragment *f, const shb_light_windows *windows, int i) {
    const shb_map_info *info = &map->info;
    const double depth = (double)windows->depth[i];
    const double nearest = fmin((double)windows->nearest[i], depth);
    CHECK_NEAR(depth, f->depth, 1e-6);
    if (!f->asks) {
        CHECK(nearest == depth);
        return;
    }
    const double whole = f->depth - (double)span->near_depth;
    CHECK(nearest <= search(info, depths, f, span, -1, 0) + 1e-5);
    CHECK(nearest >= search(info, depths, f, span, whole, margin_of(span, whole)) - 1e-5);
    if (nearest == depth)
        return;
    const double reach = (double)span->x * (depth - nearest) / 2;
    CHECK(windows->x0[i] >= 0 && windows->x1[i] < (int)info->width);
    CHECK(windows->x0[i] <= fmax(f->x - reach, 0) + 1e-3);
    CHECK(windows->x1[i] + 1 >= fmin(f->x + reach, info->width) - 1e-3);
}

static void check_same(const shb_light_windows *a, const shb_light_windows *b, int i) {
    CHECK(a->depth[i] == b->depth[i] && a->nearest[i] == b->nearest[i]);
    CHECK(a->x[i] == b->x[i] && a->y[i] == b->y[i]);
    CHECK(a->x0[i] == b->x0[i] && a->x1[i] == b->x1[i]);
    CHECK(a->y0[i] == b->y0[i] && a->y1[i] == b->y1[i]);
}

static void check_light(const shb_map *map, const float *depths, float light_size,
                        test_random *random) {
    static shb_receivers receivers;
    static fragment fragments[SHB_BATCH];
    static shb_light_windows scalar, kernels;
    shb_light_span span;
    CHECK(shb_light_span_create(map, light_size, &span));
    shb_light_span_fill(map, &span);
    random_fragments(random, &map->info, &receivers, fragments);
    shb_moment_kernels_of(SHB_ISA_SCALAR)->windows(map, &span, FRAGMENTS, &receivers, &scalar);
    shb_moment_kernels_of(map->context->isa)->windows(map, &span, FRAGMENTS, &receivers, &kernels);
    for (int i = 0; i < FRAGMENTS; i++) {
        check_fragment(map, depths, &span, &fragments[i], &scalar, i);
        check_same(&scalar, &kernels, i);
    }
    shb_light_span_destroy(map, &span);
}

/* Lights that span from less than a texel to more than the map. */
TEST(windows_hold_all_that_could_stand_before_a_light) {
    const float lights[] = {0.02f, 0.3f, 2, 40};
    const shb_isa sets[] = {SHB_ISA_SSE2, SHB_ISA_AVX2, SHB_ISA_BEST};
    test_random random = {8};
    for (int k = 0; k < SIZES; k++) {
        const uint32_t width = sizes[k][0], height = sizes[k][1];
        float *depths = random_depths(&random, (size_t)width * height);
        const shb_map_desc desc = {
            .view = probe_orthographic(k & 1), .width = width, .height = height};
        for (int l = 0; l < 4; l++) {
            const shb_context_desc context = {.threads = 1, .max_isa = sets[(k + l) % 3]};
            depth_map host = depth_map_open(&context, &desc, depths);
            check_light(host.map, depths, lights[l], &random);
            depth_map_close(&host);
        }
        free(depths);
    }
}
