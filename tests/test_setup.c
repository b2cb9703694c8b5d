#include "../src/setup.h"

#include "random.h"
#include "test.h"

#include <math.h>

static shb_clip_position random_corner(test_random *random, double reach) {
    shb_clip_position corner;
    for (int axis = 0; axis < 4; axis++)
        corner.v[axis] = random_double(random, -1, 1) * exp(random_double(random, 0, log(reach)));
    return corner;
}

static void check_shape(const shb_shape *shape, bool reversed) {
    const int32_t limit = 1 << 22;
    int64_t area = 0;
    CHECK(shape->count >= 3 && shape->count <= SHB_POLYGON_MAX);
    CHECK(shape->is_cut || shape->count == 3);
    for (size_t i = 0; i < shape->count; i++) {
        const size_t next = (i + 1) % shape->count;
        CHECK(shape->snapped_x[i] >= -limit && shape->snapped_x[i] <= limit);
        CHECK(shape->snapped_y[i] >= -limit && shape->snapped_y[i] <= limit);
        area += (int64_t)shape->snapped_x[i] * shape->snapped_y[next] -
                (int64_t)shape->snapped_x[next] * shape->snapped_y[i];
        CHECK(shape->is_cut || shape->Z[i] >= (reversed ? -1 - 0x1p-50 : 0));
    }
    CHECK(area > 0);
}

/* Where coordinates of 1e18 meet small ones, a cut point may lie anywhere. */
TEST(snapped_corners_stay_within_22_bits_whatever_the_coordinates) {
    static const uint32_t sizes[][2] = {{64, 32}, {1, 16384}, {16384, 3}};
    const shb_draw_instance both_sides = {.keep_positive = true, .keep_negative = true};
    test_random random = {62};
    unsigned cut = 0, whole = 0;
    size_t corners_max = 0;
    for (int round = 0; round < 90000; round++) {
        const bool reversed = round & 1;
        const uint32_t *size = sizes[round % 3];
        const shb_target target = shb_target_of(size[0], size[1], reversed);
        const double reach = round % 5 == 0 ? 1e18 : round % 5 == 1 ? 4 : 1e5;
        const shb_clip_position corners[3] = {random_corner(&random, reach),
                                              random_corner(&random, reach),
                                              random_corner(&random, reach)};
        shb_shape shape;
        if (shb_shape_prepare(&target, &both_sides, corners, &shape) != SHB_OUTCOME_DRAWN)
            continue;
        check_shape(&shape, reversed);
        cut += shape.is_cut;
        whole += !shape.is_cut;
        corners_max = shape.count > corners_max ? shape.count : corners_max;
    }
    CHECK(cut > 5000);
    CHECK(whole > 500);
    CHECK(corners_max >= 6);
}

/* Boxes are tight: a sample on the left or top end counts, on the right or bottom end not. */
TEST(boxes_of_samples_by_hand) {
    const shb_target target = shb_target_of(16, 16, false);
    const shb_draw_instance both_sides = {.keep_positive = true, .keep_negative = true};
    /* Corners in subpixels: x0 .. x1 on both axes; sample i lies at 256 i + 128. */
    const struct {
        int lo, hi, first, last;
    } cases[] = {{0, 256, 0, 0},   {128, 256, 0, 0},   {129, 384, 1, 0},
                 {129, 385, 1, 1}, {128, 384, 0, 0},   {128, 385, 0, 1},
                 {0, 4096, 0, 15}, {-512, 640, -2, 1}, {-128, 1, -1, -1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double lo = cases[i].lo / 2048.0 - 1, hi = cases[i].hi / 2048.0 - 1;
        const shb_clip_position corners[3] = {
            {{lo, -lo, 0, 1}}, {{hi, -lo, 0, 1}}, {{lo, -hi, 0, 1}}};
        shb_shape shape = {.samples = {7, 7, 7, 7}};
        const shb_outcome outcome = shb_shape_prepare(&target, &both_sides, corners, &shape);
        const bool is_seen = cases[i].last >= 0 && cases[i].first <= cases[i].last;
        CHECK((outcome == SHB_OUTCOME_DRAWN) == is_seen);
        if (!is_seen)
            continue;
        CHECK_INT(shape.samples.first_column, cases[i].first);
        CHECK_INT(shape.samples.last_column, cases[i].last);
        CHECK_INT(shape.samples.first_row, cases[i].first);
        CHECK_INT(shape.samples.last_row, cases[i].last);
    }
}
