#include "grid.h"
#include "oracle.h"
#include "random.h"
#include "target.h"
#include "test.h"

/* Pictures of covered samples, '#' and '.', for triangles in pixels, y down, on an 8 by 4 target.
 */
typedef struct hand_example {
    float corners[9];
    const char *rows[4];
} hand_example;

static void check_hand_example(test_contexts *contexts, const hand_example *example) {
    const shb_view view = test_pixel_view(8, 4);
    const shb_mesh mesh = {.positions = example->corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    test_target target = test_target_create(8, 4);
    test_target_draw(&target, contexts, &view, &scene, 0);
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 8; column++)
            test_check((target.ids[row * 8 + column] == 0) == (example->rows[row][column] == '#'),
                       __FILE__, __LINE__, "sample %d %d of %s", column, row, example->rows[row]);
    test_target_destroy(&target);
}

TEST(top_left_rule_by_hand) {
    /* Sample centres lie at .5. Edges through them: left and top ones cover, others do not. */
    const hand_example examples[] = {
        /* Right angle at the top left, all three edges through centres: (0.5, 0.5), (3.5, 0.5),
         * (0.5, 3.5). The top and the left edge count, the diagonal x + y = 4 (right) does not. */
        {{0.5f, 0.5f, 0.5f, 3.5f, 0.5f, 0.5f, 0.5f, 3.5f, 0.5f},
         {"###.....", "##......", "#.......", "........"}},
        /* The other half of that square: the diagonal is its left edge; right and bottom do not
         * count. */
        {{3.5f, 0.5f, 0.5f, 3.5f, 3.5f, 0.5f, 0.5f, 3.5f, 0.5f},
         {"........", "..#.....", ".##.....", "........"}},
        /* The first one wound the other way. */
        {{0.5f, 0.5f, 0.5f, 0.5f, 3.5f, 0.5f, 3.5f, 0.5f, 0.5f},
         {"###.....", "##......", "#.......", "........"}},
        /* Thinner than a pixel between two rows of centres: nothing. */
        {{0, 0.75f, 0.5f, 8, 0.75f, 0.5f, 4, 1.25f, 0.5f},
         {"........", "........", "........", "........"}},
        /* A flat top on the centres of row 1 from 1.5 to 6.5: the left corner counts, the right one
         * lies on the right edge. Down to (4, 4): row 2 from 2.5 to 5.5 (edges 1.5 + 1 = 2.5 and
         * 6.5 - 1 = 5.5, exactly on centres), row 3 from 3.5 to 4.5. */
        {{1.5f, 1.5f, 0.5f, 6.5f, 1.5f, 0.5f, 4, 4, 0.5f},
         {"........", ".#####..", "..###...", "...#...."}},
        /* No area. */
        {{0.5f, 0.5f, 0.5f, 4.5f, 2.5f, 0.5f, 6.5f, 3.5f, 0.5f},
         {"........", "........", "........", "........"}},
    };
    test_contexts *contexts = test_contexts_create(1);
    for (size_t i = 0; i < sizeof examples / sizeof *examples; i++)
        check_hand_example(contexts, &examples[i]);
    test_contexts_destroy(contexts);
}

static bool covers_as_oracle(const test_target *target, const oracle_triangle *triangle) {
    for (uint32_t row = 0; row < target->height; row++)
        for (uint32_t column = 0; column < target->width; column++)
            if ((target->ids[row * target->width + column] == 0) !=
                oracle_covers(triangle, (int)column, (int)row))
                return false;
    return true;
}

/* Corners about the target, on a lattice of the given step (0: anywhere). */
static void random_corners(test_random *random, double spread, double step, float corners[9]) {
    for (int k = 0; k < 3; k++) {
        for (int axis = 0; axis < 2; axis++) {
            const double p = 16 + random_double(random, -spread, spread);
            corners[3 * k + axis] = (float)(step > 0 ? step * (int)(p / step) : p);
        }
        corners[3 * k + 2] = 0.5f;
    }
}

static void check_against_oracle(double spread, double step, int count) {
    test_random random = {(uint64_t)(spread * 1000 + step * 10)};
    const shb_view view = test_pixel_view(32, 32);
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(32, 32);
    for (int i = 0; i < count; i++) {
        float corners[9];
        random_corners(&random, spread, step, corners);
        const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
        const shb_instance instance = {.mesh = &mesh};
        const shb_scene scene = {&instance, 1};
        test_target_draw(&target, contexts, &view, &scene, 16);
        const oracle_triangle triangle = oracle_project(&view, 32, 32, corners);
        CHECK(!triangle.needs_clipping);
        CHECK(covers_as_oracle(&target, &triangle));
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

TEST(coverage_is_the_exact_top_left_rule_anywhere) {
    check_against_oracle(20, 0, 1000);
    check_against_oracle(2, 0, 500);
    check_against_oracle(0.6, 0, 500);
    check_against_oracle(16000, 0, 1000);
}

TEST(coverage_is_the_exact_top_left_rule_on_ties) {
    check_against_oracle(20, 0.5, 2000);
    check_against_oracle(4, 0.5, 1000);
    check_against_oracle(3, 0.25, 1000);
    check_against_oracle(16000, 0.5, 1000);
}

/* Everything drawn once and nothing twice: the nearest layer is full and the second one empty. */
static void check_covered_once(const test_target *target, float far_depth) {
    unsigned holes = 0, overlaps = 0;
    for (uint32_t i = 0; i < target->width * target->height; i++) {
        holes += target->ids[i] == SHB_ID_NONE;
        overlaps += target->second[i] != far_depth;
    }
    CHECK_INT(holes, 0);
    CHECK_INT(overlaps, 0);
}

static void check_grid_once(test_contexts *contexts, uint32_t width, uint32_t height,
                            const shb_mesh *mesh, uint32_t tile_size) {
    const shb_view view = test_pixel_view(width, height);
    const shb_instance instance = {.mesh = mesh};
    const shb_scene scene = {&instance, 1};
    test_target target = test_target_create(width, height);
    test_target_draw(&target, contexts, &view, &scene, tile_size);
    check_covered_once(&target, 1);
    test_target_destroy(&target);
}

TEST(meshes_cover_every_sample_once) {
    static const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {64, 64}, {100, 37}, {300, 16}, {16384, 3}};
    test_random random = {1};
    test_contexts *contexts = test_contexts_create(1);
    for (int round = 0; round < 12; round++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            const uint32_t width = sizes[i][0], height = sizes[i][1];
            const uint32_t columns = 1 + random_below(&random, width < 300 ? 80 : 300);
            const uint32_t rows = 1 + random_below(&random, 40);
            test_grid grid =
                test_grid_create(&random, columns, rows, -1, -1, width + 1, height + 1);
            check_grid_once(contexts, width, height, &grid.mesh, 16u << random_below(&random, 6));
            test_grid_destroy(&grid);
        }
    test_contexts_destroy(contexts);
}

TEST(fans_cover_every_sample_once) {
    test_random random = {2};
    test_contexts *contexts = test_contexts_create(1);
    for (uint32_t count = 4; count <= 4096; count *= 4) {
        test_grid fan = test_grid_create_fan(&random, count, 32, 24, 40, 30);
        check_grid_once(contexts, 64, 48, &fan.mesh, 16);
        test_grid_destroy(&fan);
        fan = test_grid_create_fan(&random, count, 2000, -1000, 9000, 7000);
        check_grid_once(contexts, 64, 48, &fan.mesh, 16);
        test_grid_destroy(&fan);
    }
    test_contexts_destroy(contexts);
}

TEST(meshes_with_corners_on_samples_cover_once) {
    /* Unit cells whose corners are sample centres: every sample is a corner of eight triangles. */
    test_random random = {3};
    test_contexts *contexts = test_contexts_create(1);
    for (int round = 0; round < 20; round++) {
        test_grid grid = test_grid_create(&random, 40, 40, -4, -4, 36, 36);
        for (uint32_t i = 0; i < grid.mesh.vertex_count; i++)
            for (int axis = 0; axis < 2; axis++) {
                const uint32_t at = 3 * i + (uint32_t)axis;
                const uint32_t cell = axis ? i / 41 : i % 41;
                grid.positions[at] = (float)cell - 3.5f;
            }
        check_grid_once(contexts, 32, 32, &grid.mesh, 16);
        test_grid_destroy(&grid);
    }
    test_contexts_destroy(contexts);
}

TEST(a_tilted_mesh_covers_every_sample_once_in_perspective) {
    test_random random = {4};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(120, 90);
    for (int round = 0; round < 10; round++) {
        const bool reversed = round % 2;
        shb_view view;
        const shb_vec3 eye = {random_double(&random, -1, 1), random_double(&random, -1, 1), 4};
        CHECK_INT(shb_view_perspective(eye, (shb_vec3){0, 0, 0}, (shb_vec3){0.3, 1, 0}, 0.8, 1.3,
                                       0.5, 30, reversed, &view),
                  SHB_OK);
        test_grid grid = test_grid_create(&random, 150, 60, -5, -5, 5, 5);
        test_grid_flatten(&grid, 0);
        const shb_instance instance = {.mesh = &grid.mesh};
        const shb_scene scene = {&instance, 1};
        const shb_draw_stats stats = test_target_draw(&target, contexts, &view, &scene, 32);
        CHECK_INT(stats.clipped, 0);
        check_covered_once(&target, reversed ? 0 : 1);
        test_grid_destroy(&grid);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}
