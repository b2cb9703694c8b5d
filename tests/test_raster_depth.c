#include "oracle.h"
#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>

#define WIDTH 64 /* powers of two: corners in pixels reach the window exactly */
#define HEIGHT 32
#define UNIT 0x1p-24 /* half of the distance between floats at 1 */

/* What a run of single triangles has seen, so that no test passes on nothing. */
typedef struct seen_samples {
    unsigned plain, careful;
    double worst_plain; /* in units of 2^-24 * |z| */
} seen_samples;

static double magnitude(oracle_real v) {
    return fabs((double)v);
}

static oracle_real clamped(const oracle_triangle *t, oracle_real z) {
    const oracle_real lo = oracle_exact(fmin(t->Z[0], fmin(t->Z[1], t->Z[2])));
    const oracle_real hi = oracle_exact(fmax(t->Z[0], fmax(t->Z[1], t->Z[2])));
    return z < lo ? lo : z > hi ? hi : z;
}

/* The contract: in float within 5 units of the plane, else within 1 unit of the plane clamped to
 * the corners, but for the double set-up's own error. */
static void check_bound(const oracle_triangle *triangle, int column, int row, float stored,
                        seen_samples *seen) {
    const oracle_real z = oracle_depth(triangle, column, row);
    if (oracle_is_plain(triangle)) {
        const double error = magnitude(oracle_exact((double)stored) - z) / (UNIT * magnitude(z));
        test_check(error <= 5, __FILE__, __LINE__, "plain depth is %g units off", error);
        seen->worst_plain = fmax(seen->worst_plain, error);
        seen->plain++;
    } else {
        const oracle_real expected = clamped(triangle, z);
        const double error = magnitude(oracle_exact((double)stored) - expected);
        test_check(error <= UNIT * magnitude(expected) + 1e-12, __FILE__, __LINE__,
                   "careful depth %g is %g off", (double)stored, error);
        seen->careful++;
    }
}

static void check_sample(const test_target *target, const oracle_triangle *triangle, bool reversed,
                         int column, int row, seen_samples *seen) {
    const uint32_t at = (uint32_t)row * target->width + (uint32_t)column;
    const float stored = reversed ? -target->depth[at] : target->depth[at];
    const float declared = oracle_stored(triangle, column, row);
    const bool is_seen = oracle_covers(triangle, column, row) && declared < (reversed ? 0 : 1);
    CHECK((target->ids[at] == 0) == is_seen);
    if (!is_seen)
        return;
    test_check(stored == declared, __FILE__, __LINE__, "depth %.9g, declared %.9g", (double)stored,
               (double)declared);
    check_bound(triangle, column, row, stored, seen);
}

static void check_triangle(test_contexts *contexts, const test_target *target, const shb_view *view,
                           const float corners[9], seen_samples *seen) {
    const oracle_triangle triangle = oracle_project(view, target->width, target->height, corners);
    if (triangle.needs_clipping)
        return;
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    test_target_draw(target, contexts, view, &scene, 16);
    for (int row = 0; row < (int)target->height; row++)
        for (int column = 0; column < (int)target->width; column++)
            check_sample(target, &triangle, view->reversed, column, row, seen);
}

typedef void corner_maker(test_random *random, float corners[9]);

static seen_samples check_triangles_on(uint32_t width, uint32_t height, const shb_view *view,
                                       corner_maker *make, int count) {
    test_random random = {(uint64_t)count};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(width, height);
    seen_samples seen = {0};
    for (int i = 0; i < count; i++) {
        float corners[9];
        make(&random, corners);
        check_triangle(contexts, &target, view, corners, &seen);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
    return seen;
}

static seen_samples check_triangles(const shb_view *view, corner_maker *make, int count) {
    return check_triangles_on(WIDTH, HEIGHT, view, make, count);
}

/* Pixels, around a centre on the target. */
static void put_corners(test_random *random, double spread, double z_lo, double z_hi,
                        float corners[9]) {
    const double x = random_double(random, 0, WIDTH), y = random_double(random, 0, HEIGHT);
    for (int k = 0; k < 3; k++) {
        corners[3 * k] = (float)(x + random_double(random, -spread, spread));
        corners[3 * k + 1] = (float)(y + random_double(random, -spread, spread));
        corners[3 * k + 2] = (float)random_double(random, z_lo, z_hi);
    }
}

static void make_gentle(test_random *random, float corners[9]) {
    put_corners(random, random_double(random, 1, 40), 0.6, 0.7, corners);
}

static void make_steep(test_random *random, float corners[9]) {
    put_corners(random, random_double(random, 1, 40), 0, 1, corners);
}

static void make_huge(test_random *random, float corners[9]) {
    put_corners(random, 10000, 0.5, 0.55, corners);
}

/* About the smallest depths that are still evaluated in float. */
static void make_tiny(test_random *random, float corners[9]) {
    const double z = exp2(random_double(random, -67, -61));
    put_corners(random, 30, z, 1.1 * z, corners);
}

static void make_flat(test_random *random, float corners[9]) {
    put_corners(random, 30, 0.6, 0.7, corners);
    corners[5] = corners[8] = corners[2];
}

/* From a sample's centre in a direction that meets further centres. */
static void put_line(test_random *random, double direction[2], float corners[9]) {
    static const double directions[][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {-1, 2}};
    const double *chosen = directions[random_below(random, 6)];
    put_corners(random, 0, 0.3, 0.7, corners);
    for (int axis = 0; axis < 2; axis++) {
        direction[axis] = chosen[axis];
        corners[axis] = floorf(corners[axis]) + 0.5f;
    }
}

/* Long, and thinner than the grid of snapped corners or a little thicker. */
static void make_needle(test_random *random, float corners[9]) {
    double direction[2];
    put_line(random, direction, corners);
    const double length = random_double(random, 2, 40), t = random_double(random, 0, 1);
    for (int axis = 0; axis < 2; axis++) {
        const double thin = random_double(random, -0.01, 0.01);
        corners[3 + axis] = (float)((double)corners[axis] + length * direction[axis]);
        corners[6 + axis] = (float)((double)corners[axis] + t * length * direction[axis] + thin);
    }
}

/* The same with all corners off the line, so that samples may lie outside the true triangle. */
static void make_loose_needle(test_random *random, float corners[9]) {
    make_needle(random, corners);
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 2; axis++)
            corners[3 * k + axis] += (float)random_double(random, -0.003, 0.003);
}

/* From a hundredth of a pixel to a few pixels high, and nearly flat: both sides of the borders
 * between plain and careful. */
static void make_slender(test_random *random, float corners[9]) {
    double direction[2];
    put_line(random, direction, corners);
    const double length = random_double(random, 2, 40), t = random_double(random, 0, 1);
    const double height = exp(random_double(random, log(0.01), log(1)));
    for (int axis = 0; axis < 2; axis++) {
        const double across = axis ? direction[0] : -direction[1];
        corners[3 + axis] = (float)((double)corners[axis] + length * direction[axis]);
        corners[6 + axis] =
            (float)((double)corners[axis] + t * length * direction[axis] + across * height);
    }
    const double range = exp(random_double(random, log(1e-7), log(1e-2)));
    for (int k = 0; k < 3; k++)
        corners[3 * k + 2] = (float)(0.6 + random_double(random, 0, range));
}

/* Corners that lie exactly in one line until they are snapped: steps of half a subpixel. */
static void make_collinear(test_random *random, float corners[9]) {
    double direction[2];
    put_line(random, direction, corners);
    const int length = 256 + (int)random_below(random, 2048);
    for (int axis = 0; axis < 2; axis++) {
        const int steps = length * (int)direction[axis] + (int)random_below(random, 3) - 1;
        corners[3 + axis] = corners[axis] + (float)steps * 0x1p-9f;
        corners[6 + axis] = corners[axis] + (float)(3 * steps) * 0x1p-9f;
    }
}

TEST(gentle_depth_is_within_five_units_of_the_plane) {
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    const seen_samples seen = check_triangles(&view, make_gentle, 400);
    CHECK(seen.plain > 20000);
    CHECK(seen.worst_plain > 0.9); /* the bound is not met by chance of too exact numbers */
    const seen_samples huge = check_triangles(&view, make_huge, 300);
    CHECK(huge.plain > 20000);
    const seen_samples flat = check_triangles(&view, make_flat, 100);
    CHECK(flat.plain > 5000 && flat.careful < flat.plain / 10);
}

TEST(tiny_depth_has_the_declared_value) {
    shb_view view = test_pixel_view(WIDTH, HEIGHT);
    view.reversed = true;
    const seen_samples seen = check_triangles(&view, make_tiny, 200);
    CHECK(seen.plain > 5000 && seen.careful > 5000);
}

TEST(steep_depth_is_within_a_unit_of_the_plane) {
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    const seen_samples seen = check_triangles(&view, make_steep, 400);
    CHECK(seen.careful > 20000);
}

static void check_stays_in_range(const test_target *target, const float corners[9],
                                 unsigned *samples) {
    const float lo = fminf(corners[2], fminf(corners[5], corners[8]));
    const float hi = fmaxf(corners[2], fmaxf(corners[5], corners[8]));
    /* A triangle 1/16 pixel high, moved by 1/512 pixel on each axis, may leave its range by
     * 16 * 2 / 512 of it; thinner ones may not at all. */
    const float slack = (hi - lo) / 16;
    for (int at = 0; at < WIDTH * HEIGHT; at++)
        if (target->ids[at] == 0) {
            CHECK(target->depth[at] >= lo - slack && target->depth[at] <= hi + slack);
            ++*samples;
        }
}

static unsigned draw_slivers(corner_maker *make, int count) {
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    test_random random = {7};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    unsigned samples = 0;
    for (int i = 0; i < count; i++) {
        float corners[9];
        make(&random, corners);
        const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
        const shb_instance instance = {.mesh = &mesh};
        const shb_scene scene = {&instance, 1};
        test_target_draw(&target, contexts, &view, &scene, 0);
        check_stays_in_range(&target, corners, &samples);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
    return samples;
}

TEST(slivers_stay_within_the_depth_range_of_their_corners) {
    CHECK(draw_slivers(make_needle, 1000) > 1000);
    CHECK(draw_slivers(make_loose_needle, 1000) > 500);
    CHECK(draw_slivers(make_collinear, 1000) > 100);
}

TEST(slivers_have_the_declared_depth) {
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    CHECK(check_triangles(&view, make_needle, 1000).careful > 1000);
    CHECK(check_triangles(&view, make_loose_needle, 1000).careful > 500);
    const seen_samples slender = check_triangles(&view, make_slender, 3000);
    CHECK(slender.plain > 1000 && slender.careful > 1000);
}

TEST(collinear_corners_that_snapping_opens_have_their_mean_depth) {
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    test_random random = {8};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    unsigned samples = 0;
    for (int i = 0; i < 1000; i++) {
        float corners[9];
        make_collinear(&random, corners);
        const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
        const shb_instance instance = {.mesh = &mesh};
        const shb_scene scene = {&instance, 1};
        test_target_draw(&target, contexts, &view, &scene, 0);
        const double mean = ((double)corners[2] + (double)corners[5] + (double)corners[8]) / 3;
        for (int at = 0; at < WIDTH * HEIGHT; at++)
            if (target.ids[at] == 0) {
                CHECK_NEAR(target.depth[at], mean, 0x1p-24);
                samples++;
            }
    }
    CHECK(samples > 100);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

static void make_world(test_random *random, float corners[9]) {
    const double distance = exp(random_double(random, log(0.6), log(60)));
    for (int k = 0; k < 3; k++) {
        corners[3 * k] = (float)random_double(random, -distance, distance);
        corners[3 * k + 1] = (float)random_double(random, -distance, distance);
        corners[3 * k + 2] = (float)(-distance * random_double(random, 0.9, 1.3));
    }
}

static void check_perspective(double far_distance, bool reversed) {
    shb_view view;
    CHECK_INT(shb_view_perspective((shb_vec3){0.1, 0.2, 0.3}, (shb_vec3){0, 0, -4},
                                   (shb_vec3){0, 1, 0}, 1, 1.2, 0.5, far_distance, reversed, &view),
              SHB_OK);
    const seen_samples seen = check_triangles_on(50, 37, &view, make_world, 400);
    CHECK(seen.plain + seen.careful > 5000);
}

TEST(perspective_depth_is_within_its_bound) {
    check_perspective(50, false);
    check_perspective(50, true);
    check_perspective(HUGE_VAL, false);
    check_perspective(HUGE_VAL, true);
}

TEST(depth_of_hand_examples) {
    /* z = 0.25 + x / 64 over 16 by 16 pixels: at the centre of column i, 0.25 + (i + 0.5) / 64,
     * exact in float. */
    const float corners[] = {0, 0, 0.25f, 16, 0, 0.5f, 0, 16, 0.25f, 16, 16, 0.5f};
    const uint16_t indices[] = {0, 1, 2, 2, 1, 3};
    const shb_mesh mesh = {.positions = corners,
                           .vertex_count = 4,
                           .indices = indices,
                           .index_size = 2,
                           .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = test_pixel_view(16, 16);
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(16, 16);
    test_target_draw(&target, contexts, &view, &scene, 0);
    for (int row = 0; row < 16; row++)
        for (int column = 0; column < 16; column++)
            CHECK(target.depth[row * 16 + column] == 0.25f + ((float)column + 0.5f) / 64);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

/* One triangle over the whole target at this depth. */
static float depth_of_flat(float z, bool reversed) {
    const float corners[] = {-1, -1, z, 20, -1, z, -1, 20, z};
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    shb_view view = test_pixel_view(4, 4);
    view.reversed = reversed;
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(4, 4);
    test_target_draw(&target, contexts, &view, &scene, 0);
    const float depth = target.ids[5] == 0 ? target.depth[5] : -1;
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
    return depth;
}

TEST(depth_at_or_beyond_far_is_not_seen) {
    const float just_before_one = 1 - 0x1p-24f;
    CHECK(depth_of_flat(0, false) == 0);
    CHECK(depth_of_flat(just_before_one, false) == just_before_one);
    CHECK(depth_of_flat(1, false) == -1);
    CHECK(depth_of_flat(1.5f, false) == -1);
    CHECK(depth_of_flat(3e38f, false) == -1);
    CHECK(depth_of_flat(1, true) == 1);
    CHECK(depth_of_flat(0x1p-149f, true) == 0x1p-149f);
    CHECK(depth_of_flat(0, true) == -1);
    CHECK(depth_of_flat(-0.5f, true) == -1);
    /* Before the near plane. */
    CHECK(depth_of_flat(-0x1p-20f, false) == -1);
    CHECK(depth_of_flat(1 + 0x1p-20f, true) == -1);
}
