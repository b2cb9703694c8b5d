/* The least depths of windows, against a search. */
#include "../src/depth_minima.h"

#include "depth_map.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

static float search(const float *depths, uint32_t width, const shb_texel_box *box) {
    float least = 1;
    for (int32_t y = box->y0; y <= box->y1; y++)
        for (int32_t x = box->x0; x <= box->x1; x++) {
            const float depth = depths[(uint32_t)y * width + (uint32_t)x];
            least = depth < least ? depth : least;
        }
    return least;
}

/* The cells that answer reach less than twice the side of the box beyond it, and than 16 texels for
 * a small one. */
static shb_texel_box widened(const shb_texel_box *box, int32_t width, int32_t height) {
    const int32_t side_x = box->x1 - box->x0 + 1, side_y = box->y1 - box->y0 + 1;
    const int32_t side = side_x > side_y ? side_x : side_y, by = side > 8 ? 2 * side : 16;
    shb_texel_box wide = {box->x0 - by, box->y0 - by, box->x1 + by, box->y1 + by};
    wide.x0 = wide.x0 > 0 ? wide.x0 : 0;
    wide.y0 = wide.y0 > 0 ? wide.y0 : 0;
    wide.x1 = wide.x1 < width ? wide.x1 : width - 1;
    wide.y1 = wide.y1 < height ? wide.y1 : height - 1;
    return wide;
}

TEST(least_depths_of_boxes_are_safe_and_near) {
    const uint32_t sizes[][2] = {{1, 1}, {7, 9}, {300, 17}, {64, 64}, {33, 129}};
    test_random random = {8};
    for (int k = 0; k < 5; k++) {
        const uint32_t width = sizes[k][0], height = sizes[k][1];
        float *depths = malloc(width * height * sizeof *depths);
        for (uint32_t i = 0; i < width * height; i++)
            depths[i] = (float)pow(random_double(&random, 0, 1), 0.05);
        const bool reversed = k & 1;
        depth_map host = depth_map_open(
            NULL,
            &(shb_map_desc){.view = probe_orthographic(reversed), .width = width, .height = height},
            depths);
        shb_depth_minima minima;
        CHECK(shb_depth_minima_create(host.map, &minima));
        for (int i = 0; i < 500; i++) {
            shb_texel_box box = {
                (int32_t)random_below(&random, width), (int32_t)random_below(&random, height),
                (int32_t)random_below(&random, width), (int32_t)random_below(&random, height)};
            const int32_t x = box.x0, y = box.y0;
            box.x0 = box.x1 < x ? box.x1 : x;
            box.y0 = box.y1 < y ? box.y1 : y;
            box.x1 = box.x1 < x ? x : box.x1;
            box.y1 = box.y1 < y ? y : box.y1;
            const shb_texel_box wide = widened(&box, (int32_t)width, (int32_t)height);
            const float least = shb_depth_minima_over(&minima, &box) + (reversed ? 1.0f : 0.0f);
            CHECK(least <= search(depths, width, &box) + 1e-6f);
            CHECK(least >= search(depths, width, &wide) - 1e-6f);
        }
        shb_depth_minima_destroy(host.map, &minima);
        depth_map_close(&host);
        free(depths);
    }
}
