#include "../src/clip.h"

#include "grid.h"
#include "oracle.h"
#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>

typedef struct clip_counts {
    unsigned covered, uncovered;
    uint64_t clipped;
} clip_counts;

/* Canonical distance of a depth from the near plane. */
static double behind_near(oracle_real z, bool reversed) {
    return (double)(z + (reversed ? 1 : 0));
}

/* Away from edges and from the near and far planes there is no doubt about a sample. */
static void check_sample(const test_target *target, const oracle_triangle *triangle, bool reversed,
                         uint32_t column, uint32_t row, clip_counts *counts) {
    const size_t at = (size_t)row * target->width + column;
    const double margin = 1.0 / 64, inside = oracle_clip_inside(triangle, (int)column, (int)row);
    const oracle_real z = oracle_clip_depth(triangle, (int)column, (int)row);
    const double front = behind_near(z, reversed), back = (reversed ? 0 : 1) - (double)z;
    if (inside < -margin || front < -1e-4 || back < -1e-4) {
        CHECK(target->ids[at] == SHB_ID_NONE);
        counts->uncovered++;
    } else if (inside > margin && front > 1e-4 && back > 1e-4) {
        const double stored = (double)(reversed ? -target->depth[at] : target->depth[at]);
        CHECK(target->ids[at] == 0);
        CHECK_NEAR(stored, (double)z, 5 * 0x1p-24 * fabs((double)z) + 1e-11);
        counts->covered++;
    }
}

static void check_triangle(test_contexts *contexts, const test_target *target, const shb_view *view,
                           const float corners[9], clip_counts *counts) {
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    counts->clipped += test_target_draw(target, contexts, view, &scene, 32).clipped;
    const oracle_triangle triangle = oracle_project(view, target->width, target->height, corners);
    const uint32_t step = target->width > 1000 ? 11 : 1;
    for (uint32_t row = 0; row < target->height; row++)
        for (uint32_t column = 0; column < target->width; column += step)
            check_sample(target, &triangle, view->reversed, column, row, counts);
}

static void check_counts(const clip_counts *counts) {
    CHECK(counts->clipped > 5);
    CHECK(counts->covered > 5000);
    CHECK(counts->uncovered > 5000);
}

/* Triangles all around the eye, of any size. */
static void check_around_eye(double far_distance, bool reversed) {
    shb_view view;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 0}, (shb_vec3){0.2, 0.1, -1},
                                   (shb_vec3){0, 1, 0}, 1.2, 1.5, 0.25, far_distance, reversed,
                                   &view),
              SHB_OK);
    test_random random = {11};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(45, 30);
    clip_counts counts = {0};
    for (int i = 0; i < 80; i++) {
        float corners[9];
        const double size = exp(random_double(&random, log(0.3), log(30)));
        for (int k = 0; k < 9; k++)
            corners[k] = (float)random_double(&random, -size, size);
        check_triangle(contexts, &target, &view, corners, &counts);
    }
    check_counts(&counts);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

TEST(triangles_around_the_eye_are_cut_at_the_near_plane) {
    check_around_eye(20, false);
    check_around_eye(20, true);
    check_around_eye(HUGE_VAL, false);
    check_around_eye(HUGE_VAL, true);
}

/* Corners up to reach pixels away, so that the triangle leaves the guard band. */
static void check_huge(uint32_t width, uint32_t height, double reach, int count) {
    const shb_view view = test_pixel_view(width, height);
    test_random random = {12};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(width, height);
    clip_counts counts = {0};
    for (int i = 0; i < count; i++) {
        float corners[9];
        for (int k = 0; k < 3; k++) {
            corners[3 * k] = (float)(width / 2 + random_double(&random, -reach, reach));
            corners[3 * k + 1] = (float)(height / 2 + random_double(&random, -reach, reach));
            corners[3 * k + 2] = (float)random_double(&random, 0.2, 0.8);
        }
        check_triangle(contexts, &target, &view, corners, &counts);
    }
    check_counts(&counts);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

TEST(huge_triangles_are_cut_at_the_guard_band) {
    check_huge(64, 32, 30000, 80);
    check_huge(50, 33, 1e7, 60);
    check_huge(50, 33, 1e30, 60);
    check_huge(16384, 2, 40000, 40);
    check_huge(1, 300, 1e6, 150);
}

/* A triangle with one corner far out on an axis. */
static uint64_t clipped_by_corner(test_contexts *contexts, int axis, float pixels) {
    float corners[9] = {10, 10, 0.5f, 20, 12, 0.5f, 12, 20, 0.5f};
    corners[axis] = pixels;
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = test_pixel_view(64, 32);
    test_target target = test_target_create(64, 32);
    const shb_draw_stats stats = test_target_draw(&target, contexts, &view, &scene, 0);
    CHECK_INT(stats.drawn, 1);
    test_target_destroy(&target);
    return stats.clipped;
}

TEST(the_guard_band_ends_at_16384_pixels) {
    test_contexts *contexts = test_contexts_create(1);
    for (int axis = 0; axis < 2; axis++) {
        CHECK_INT(clipped_by_corner(contexts, axis, 16384), 0);
        CHECK_INT(clipped_by_corner(contexts, axis, -16384), 0);
        CHECK_INT(clipped_by_corner(contexts, axis, 16384.5f), 1);
        CHECK_INT(clipped_by_corner(contexts, axis, -16384.5f), 1);
    }
    test_contexts_destroy(contexts);
}

/* A level ground of one quad, the eye at height h looking along -z: a row at the slope s below the
 * horizon meets it at the distance w = h / s along the view, and depth follows from w alone. */
static void check_ground(double far_distance, bool reversed) {
    enum { WIDTH = 90, HEIGHT = 60 };
    const double h = 0.0625, near_distance = 0.125, angle = 2 * atan(1.0);
    const float corners[] = {-1e4f, 0, 1e4f, 1e4f, 0, 1e4f, -1e4f, 0, -1e4f, 1e4f, 0, -1e4f};
    const uint32_t indices[] = {0, 1, 2, 2, 1, 3};
    const shb_mesh mesh = {
        .positions = corners, .vertex_count = 4, .indices = indices, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh, .cull = SHB_CULL_BACK};
    const shb_scene scene = {&instance, 1};
    shb_view view;
    CHECK_INT(shb_view_perspective((shb_vec3){0, h, 0}, (shb_vec3){0, h, -1}, (shb_vec3){0, 1, 0},
                                   angle, (double)WIDTH / HEIGHT, near_distance, far_distance,
                                   reversed, &view),
              SHB_OK);
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    CHECK_INT(test_target_draw(&target, contexts, &view, &scene, 16).clipped, 2);
    for (int at = 0; at < WIDTH * HEIGHT; at++) {
        /* The half angle's tangent is 1: the slope runs from 1 at the top to -1 at the bottom. The
         * near plane cuts at s = h / near = 0.5, which is row 45 exactly, on no centre. */
        const double s = (at / WIDTH + 0.5) / (HEIGHT / 2.0) - 1, w = h / s;
        const double ratio = far_distance < 1e30 ? near_distance / far_distance : 0;
        const double z = (1 - near_distance / w) / (1 - ratio);
        const bool is_seen = s > 0 && w > near_distance && z < 1;
        CHECK((target.ids[at] != SHB_ID_NONE) == is_seen);
        CHECK_NEAR(target.depth[at],
                   reversed  ? (is_seen ? 1 - z : 0)
                   : is_seen ? z
                             : 1,
                   0x1p-24 + 1e-12);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

TEST(ground_under_the_eye_has_its_analytic_depth) {
    check_ground(8, false);
    check_ground(8, true);
    check_ground(HUGE_VAL, false);
    check_ground(HUGE_VAL, true);
}

/* The ground seen from above it, with fine and coarse cells all around and behind the eye. Samples
 * close to the horizon are left out: cells thinner than the snapping grid turn round there. */
static uint64_t check_ground_once(test_random *random, uint32_t columns, uint32_t rows,
                                  double reach) {
    shb_view view;
    const double h = random_double(random, 0.02, 0.5);
    const shb_vec3 eye = {random_double(random, -1, 1), h, random_double(random, -1, 1)};
    const shb_vec3 to = {eye.x + 0.3, h - 0.3, eye.z - 1};
    CHECK_INT(
        shb_view_perspective(eye, to, (shb_vec3){0.1, 1, 0}, 1.4, 1.5, 0.25, HUGE_VAL, true, &view),
        SHB_OK);
    test_grid grid = test_grid_create(random, columns, rows, -reach, -reach, reach, reach);
    for (uint32_t i = 0; i < grid.mesh.vertex_count; i++) {
        grid.positions[3 * i + 2] = grid.positions[3 * i + 1];
        grid.positions[3 * i + 1] = 0;
    }
    const shb_instance instance = {.mesh = &grid.mesh};
    const shb_scene scene = {&instance, 1};
    const float quad[9] = {-9, 0, -9, 9, 0, -9, 0, 0, 9}; /* any triangle of that plane */
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(150, 100);
    const uint64_t clipped = test_target_draw(&target, contexts, &view, &scene, 64).clipped;
    const oracle_triangle plane = oracle_project(&view, 150, 100, quad);
    unsigned holes = 0, ghosts = 0, overlaps = 0, covered = 0;
    for (int at = 0; at < 150 * 100; at++) {
        const double z = (double)oracle_clip_depth(&plane, at % 150, at / 150);
        const bool is_ground = z > -1 + 1e-3 && z < -2e-3 - 0.5 / reach;
        const bool is_empty = z < -1 - 1e-3 || z > 2e-3;
        covered += target.ids[at] != SHB_ID_NONE;
        holes += is_ground && target.ids[at] == SHB_ID_NONE;
        ghosts += is_empty && target.ids[at] != SHB_ID_NONE;
        overlaps += is_ground && target.second[at] != 0;
    }
    CHECK(covered > 1000);
    CHECK_INT(holes, 0);
    CHECK_INT(ghosts, 0);
    CHECK_INT(overlaps, 0);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
    test_grid_destroy(&grid);
    return clipped;
}

TEST(a_clipped_mesh_covers_every_sample_once) {
    test_random random = {13};
    uint64_t clipped = 0;
    for (int i = 0; i < 12; i++) {
        clipped += check_ground_once(&random, 2 + random_below(&random, 6),
                                     2 + random_below(&random, 6), 100);
        clipped += check_ground_once(&random, 120, 120, 6);
        clipped += check_ground_once(&random, 40, 40, 1e6);
    }
    CHECK(clipped > 50);
}

/* Cells larger than the guard band around cells that fit it: edges are cut on both of their sides.
 */
TEST(a_mesh_beyond_the_guard_band_covers_every_sample_once) {
    test_random random = {14};
    test_contexts *contexts = test_contexts_create(1);
    static const uint32_t sizes[][2] = {{64, 48}, {16384, 2}, {3, 200}};
    for (int round = 0; round < 60; round++) {
        const uint32_t width = sizes[round % 3][0], height = sizes[round % 3][1];
        const double reach = exp(random_double(&random, log(3e4), log(1e6)));
        const shb_view view = test_pixel_view(width, height);
        test_grid grid = test_grid_create(&random, 7, 7, -reach, -reach, reach, 1.5 * reach);
        const shb_instance instance = {.mesh = &grid.mesh};
        const shb_scene scene = {&instance, 1};
        test_target target = test_target_create(width, height);
        test_target_draw(&target, contexts, &view, &scene, 512);
        for (uint32_t at = 0; at < width * height; at++)
            CHECK(target.ids[at] != SHB_ID_NONE && target.second[at] == 1);
        test_target_destroy(&target);
        test_grid_destroy(&grid);
    }
    test_contexts_destroy(contexts);
}

/* What the near plane leaves of a triangle, in snapped coordinates; 0 corners: nothing. */
static size_t snap_polygon(const shb_view *view, const float corners[9], uint32_t width,
                           uint32_t height, int64_t x[SHB_POLYGON_MAX],
                           int64_t y[SHB_POLYGON_MAX]) {
    const oracle_triangle triangle = oracle_project(view, width, height, corners);
    const shb_clip_volume volume = shb_clip_volume_of(width, height, view->reversed);
    shb_clip_position positions[3];
    shb_polygon polygon;
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 4; axis++)
            positions[k].v[axis] = triangle.clip[k][axis];
    if (shb_clip_triangle(&volume, positions, &polygon) != SHB_CLIP_CUT)
        return 0;
    for (size_t i = 0; i < polygon.count; i++) {
        const double *v = polygon.corners[i].v;
        x[i] = oracle_snap(width / 2.0 + width / 2.0 * (v[0] / v[3]));
        y[i] = oracle_snap(height / 2.0 - height / 2.0 * (v[1] / v[3]));
    }
    return polygon.count;
}

static int64_t polygon_area(size_t count, const int64_t *x, const int64_t *y) {
    int64_t area = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t next = (i + 1) % count;
        area += x[i] * y[next] - x[next] * y[i];
    }
    return area;
}

/* Needles along lines of sample centres that the near plane cuts on the target. Many polygons are
 * so thin that snapping bends them inwards or turns a part of them over. */
TEST(cut_polygons_cover_where_their_winding_number_is_positive) {
    enum { WIDTH = 64, HEIGHT = 32 };
    static const double directions[][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {-1, 2}};
    test_random random = {15};
    test_contexts *contexts = test_contexts_create(1);
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    test_target target = test_target_create(WIDTH, HEIGHT);
    unsigned covered = 0, inverted = 0;
    for (int round = 0; round < 4000; round++) {
        const double *direction = directions[random_below(&random, 6)];
        const double middle[2] = {floor(random_double(&random, 0, WIDTH)) + 0.5,
                                  floor(random_double(&random, 0, HEIGHT)) + 0.5};
        const double loose = round % 2 ? 0.008 : 0.5;
        float corners[9];
        for (int k = 0; k < 3; k++) {
            const double along = random_double(&random, -30, 30);
            for (int axis = 0; axis < 2; axis++)
                corners[3 * k + axis] = (float)(middle[axis] + along * direction[axis] +
                                                random_double(&random, -loose, loose));
            corners[3 * k + 2] = (float)random_double(&random, -0.5, 0.9);
        }
        int64_t x[SHB_POLYGON_MAX], y[SHB_POLYGON_MAX];
        const size_t count = snap_polygon(&view, corners, WIDTH, HEIGHT, x, y);
        if (count == 0)
            continue;
        const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
        const shb_instance instance = {.mesh = &mesh};
        const shb_scene scene = {&instance, 1};
        test_target_draw(&target, contexts, &view, &scene, 32);
        const int64_t area = polygon_area(count, x, y);
        for (int at = 0; at < WIDTH * HEIGHT; at++) {
            const int winding = oracle_winding(count, x, y, at % WIDTH, at / WIDTH);
            CHECK((target.ids[at] == 0) == (area > 0 ? winding > 0 : area < 0 && winding < 0));
            covered += winding != 0;
            inverted += area > 0 ? winding < 0 : winding > 0;
        }
    }
    CHECK(covered > 3000);
    CHECK(inverted > 0);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}
