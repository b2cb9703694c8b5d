#include "../src/cluster_cull.h"
#include "../src/scene.h"

#include "allocator.h"
#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "soup.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A grid of columns by rows quads over the unit square, its triangles in a random order. */
typedef struct shuffled_grid {
    float *positions;
    uint32_t *indices;
    shb_mesh mesh;
} shuffled_grid;

static shuffled_grid make_grid(uint32_t columns, uint32_t rows, test_random *random) {
    const uint32_t triangles = 2 * columns * rows, across = columns + 1;
    shuffled_grid grid = {calloc((size_t)across * (rows + 1) * 3, sizeof(float)),
                          calloc((size_t)triangles * 3, sizeof(uint32_t)),
                          {0}};
    for (uint32_t i = 0; i < across * (rows + 1); i++) {
        grid.positions[3 * i] = (float)(i % across) / (float)columns;
        grid.positions[3 * i + 1] = (float)(i / across) / (float)rows;
    }
    for (uint32_t t = 0; t < triangles; t++) {
        const uint32_t a = t / 2 / columns * across + t / 2 % columns, b = a + 1, c = a + across;
        const uint32_t corners[2][3] = {{a, b, c + 1}, {a, c + 1, c}};
        const uint32_t other = random ? random_below(random, t + 1) : t;
        memcpy(grid.indices + 3 * t, grid.indices + 3 * other, 3 * sizeof *grid.indices);
        memcpy(grid.indices + 3 * other, corners[t % 2], 3 * sizeof *grid.indices);
    }
    grid.mesh = (shb_mesh){.positions = grid.positions,
                           .vertex_count = across * (rows + 1),
                           .indices = grid.indices,
                           .triangle_count = triangles};
    return grid;
}

static void free_grid(shuffled_grid *grid) {
    free(grid->positions);
    free(grid->indices);
}

/* Every triangle of the mesh is in one cluster, by positions and in its own winding. */
static void check_complete(const shb_mesh *mesh, const shb_clusters *clusters) {
    uint8_t *found = calloc(mesh->triangle_count, 1);
    bool right = true;
    for (size_t i = 0; i < clusters->count; i++) {
        const shb_cluster *cluster = &clusters->clusters[i];
        const float *positions = clusters->positions + 3 * cluster->first_vertex;
        const size_t places = shb_cluster_places(cluster->vertex_count);
        for (uint32_t t = 0; t < cluster->triangle_count; t++) {
            const uint32_t number = clusters->triangles[cluster->first_triangle + t];
            found[number]++;
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t local =
                    clusters->corners[cluster->first_corner + shb_corner_place(t, k)];
                const uint32_t vertex = mesh->indices
                                            ? ((const uint32_t *)mesh->indices)[3 * number + k]
                                            : 3 * number + k;
                for (size_t axis = 0; axis < 3; axis++) {
                    const float p = positions[axis * places + local];
                    right &= memcmp(&p, &mesh->positions[3 * vertex + axis], sizeof p) == 0;
                    right &= !(p < cluster->lo[axis]) && !(p > cluster->hi[axis]);
                }
            }
        }
    }
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        right &= found[i] == 1;
    CHECK(right);
    free(found);
}

/* 128 quads' triangles of a shuffled grid lie within a small part of it. */
TEST(clusters_gather_neighbours_of_a_shuffled_mesh) {
    test_random random = {31};
    shuffled_grid grid = make_grid(64, 64, &random);
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &grid.mesh, &clusters), SHB_OK);
    check_complete(&grid.mesh, clusters);
    CHECK_INT(clusters->count, 64);
    for (size_t i = 0; i < clusters->count; i++) {
        const shb_cluster *cluster = &clusters->clusters[i];
        CHECK_NEAR(cluster->hi[0] - cluster->lo[0], 1.0 / 8, 1e-6);
        CHECK_NEAR(cluster->hi[1] - cluster->lo[1], 1.0 / 8, 1e-6);
        CHECK_INT(cluster->vertex_count, 81);
        /* Normals are (0, 0, 1) or (0, 0, -1), and bounds are rounded up. */
        const int up = cluster->largest[shb_direction(0, 0, 1)];
        CHECK(up == SHB_NORMAL_UNIT + 1 || up == -SHB_NORMAL_UNIT + 1);
        CHECK_INT(cluster->largest[shb_direction(1, -1, 1)], up);
        CHECK_INT(cluster->largest[shb_direction(-1, 0, -1)], 2 - up);
        CHECK_INT(cluster->largest[shb_direction(0, 1, 0)], 1);
        /* The height of the halves of a square of 1 / 64 over the diagonal. */
        CHECK_NEAR(cluster->height, sqrt(0.5) / 64, 1e-6);
    }
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    free_grid(&grid);
}

/* No power of two divides the grid, and yet the boxes of clusters hardly overlap: they cover little
 * more than it. */
TEST(clusters_of_any_shuffled_mesh_are_compact) {
    test_random random = {34};
    shuffled_grid grid = make_grid(61, 37, &random);
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &grid.mesh, &clusters), SHB_OK);
    check_complete(&grid.mesh, clusters);
    CHECK_INT(clusters->count, (2 * 61 * 37 + 127) / 128);
    double area = 0;
    for (size_t i = 0; i < clusters->count; i++) {
        const shb_cluster *cluster = &clusters->clusters[i];
        area += (double)((cluster->hi[0] - cluster->lo[0]) * (cluster->hi[1] - cluster->lo[1]));
    }
    CHECK(area < 1.25);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    free_grid(&grid);
}

#define LARGE_WIDTH 4176
#define LARGE_HEIGHT 1024

/* Depths of a scene in a target of more than 2048 x 2048 texels. */
static float *draw_large(const shb_mesh *mesh, shb_isa isa) {
    shb_context *context = NULL;
    float *depth = calloc((size_t)LARGE_WIDTH * LARGE_HEIGHT, sizeof *depth);
    const shb_view view = test_pixel_view(LARGE_WIDTH, LARGE_HEIGHT);
    const shb_instance instance = {.mesh = mesh};
    const shb_scene scene = {.instances = &instance, .instance_count = 1};
    const shb_draw_desc desc = {.scene = &scene,
                                .view = &view,
                                .width = LARGE_WIDTH,
                                .height = LARGE_HEIGHT,
                                .depth = {.texels = depth}};
    context = test_context(1, isa);
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    shb_context_destroy(context);
    return depth;
}

/* So many triangles that the target is drawn as a whole; a part of it stays clear. */
TEST(clusters_of_a_dense_mesh_give_the_scalar_depths_in_a_large_target) {
    test_random random = {33};
    shuffled_grid grid = make_grid(330, 330, NULL);
    for (uint32_t i = 0; i < grid.mesh.vertex_count; i++) {
        grid.positions[3 * i] *= LARGE_WIDTH - 75.5f;
        grid.positions[3 * i + 1] *= LARGE_HEIGHT - 30.25f;
        grid.positions[3 * i + 2] = 0.25f + (float)random_below(&random, 512) / 1024;
    }
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &grid.mesh, &clusters), SHB_OK);
    float *expected = draw_large(&grid.mesh, SHB_ISA_SCALAR);
    shb_mesh mesh = grid.mesh;
    mesh.clusters = clusters;
    float *found = draw_large(&mesh, SHB_ISA_BEST);
    CHECK(memcmp(found, expected, (size_t)LARGE_WIDTH * LARGE_HEIGHT * sizeof *found) == 0);
    free(expected);
    free(found);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    free_grid(&grid);
}

/* Bands of the target, one an instance: those in the middle have no clusters. */
TEST(instances_without_clusters_are_drawn_between_those_with_them) {
    shuffled_grid grid = make_grid(8, 8, NULL);
    shb_context *context = test_context(1, SHB_ISA_BEST);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &grid.mesh, &clusters), SHB_OK);
    shb_mesh clustered = grid.mesh;
    clustered.clusters = clusters;
    shb_instance with[4], without[4];
    for (int i = 0; i < 4; i++) {
        shb_mat4 place = shb_mat4_scaling(16, 64, 1);
        place.m[12] = 16 * i;
        place.m[14] = 0.125 * (i + 1);
        with[i] = (shb_instance){.mesh = i == 1 || i == 2 ? &grid.mesh : &clustered,
                                 .world_from_mesh = place};
        without[i] = (shb_instance){.mesh = &grid.mesh, .world_from_mesh = place};
    }
    const shb_view view = test_pixel_view(64, 64);
    test_target drawn = test_target_create(64, 64), expected = test_target_create(64, 64);
    const shb_scene scenes[2] = {{with, 4}, {without, 4}};
    const shb_draw_desc desc[2] = {test_target_desc(&drawn, &view, &scenes[0]),
                                   test_target_desc(&expected, &view, &scenes[1])};
    for (int i = 0; i < 2; i++)
        CHECK_INT(shb_draw(context, &desc[i], NULL), SHB_OK);
    CHECK(test_target_equal(&drawn, &expected));
    for (int i = 0; i < 4; i++)
        CHECK(drawn.depth[32 * 64 + 16 * i + 8] == 0.125f * (float)(i + 1));
    test_target_destroy(&drawn);
    test_target_destroy(&expected);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    free_grid(&grid);
}

static double product_with(const shb_mesh *mesh, uint32_t triangle, int x, int y, int z) {
    uint32_t corners[3];
    shb_mesh_triangle(mesh, triangle, corners);
    double p[3][3];
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            p[k][axis] = (double)shb_mesh_position(mesh, corners[k])[axis];
    const double b[3] = {p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]};
    const double c[3] = {p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
    const double n[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                         b[0] * c[1] - b[1] * c[0]};
    return (n[0] * x + n[1] * y + n[2] * z) / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* In each direction the bound is the largest product, rounded up. */
TEST(clusters_bound_their_normals_in_every_direction) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    soup s = {0};
    soup_add_ball(&s, (const float[3]){0.5f, -1, 2}, 40, 20, NULL);
    const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, mesh, &clusters), SHB_OK);
    bool right = true;
    for (size_t i = 0; i < clusters->count; i++) {
        const shb_cluster *cluster = &clusters->clusters[i];
        const uint32_t *triangles = clusters->triangles + cluster->first_triangle;
        for (int d = 0; d < SHB_DIRECTIONS; d++) {
            const int x = d / 9 - 1, y = d / 3 % 3 - 1, z = d % 3 - 1;
            double largest = -2;
            for (uint32_t t = 0; t < cluster->triangle_count; t++)
                largest = fmax(largest, product_with(mesh, triangles[t], x, y, z));
            const double bound = cluster->largest[shb_direction(x, y, z)];
            right &= !(cluster->height > 0) || (bound >= SHB_NORMAL_UNIT * largest &&
                                                bound < SHB_NORMAL_UNIT * largest + 1.01);
        }
    }
    CHECK(right);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(clusters_of_loose_triangles_have_vertices_that_a_byte_can_count) {
    test_random random = {32};
    soup s = {0};
    for (int t = 0; t < 1000; t++) {
        float p[9];
        for (int i = 0; i < 9; i++)
            p[i] = (float)random_double(&random, -1, 1);
        if (t % 50 == 0)
            p[random_below(&random, 9)] = t % 100 ? NAN : (float)HUGE_VAL;
        soup_add(&s, p, p + 3, p + 6);
    }
    const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, mesh, &clusters), SHB_OK);
    check_complete(mesh, clusters);
    for (size_t i = 0; i < clusters->count; i++)
        CHECK(clusters->clusters[i].vertex_count <= SHB_CLUSTER_VERTICES);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(a_mesh_without_triangles_has_no_clusters) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    const shb_mesh mesh = {0};
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &mesh, &clusters), SHB_OK);
    CHECK_INT(clusters->count, 0);
    shb_clusters_destroy(clusters);
    shb_clusters_destroy(NULL);
    shb_context_destroy(context);
}

/* Whatever its other fields say, nothing of it is read. */
TEST(a_mesh_without_triangles_may_lack_what_it_counts) {
    static const float corners[] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
    const shb_mesh meshes[2] = {{.positions = corners, .vertex_count = 3, .triangle_count = 1},
                                {.vertex_count = UINT32_MAX, .position_stride = 7}};
    const shb_instance instances[2] = {{.mesh = &meshes[1]}, {.mesh = &meshes[0]}};
    const shb_scene scene = {instances, 2};
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &meshes[1], &clusters), SHB_OK);
    shb_clusters_destroy(clusters);
    for (int i = 0; i < 8; i++) {
        const shb_map_desc desc = {.view = probe_orthographic(false),
                                   .width = 16,
                                   .occluders = (shb_occluders)(i / 2),
                                   .classifies = i % 2};
        shb_map *map = NULL;
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
}

TEST(clusters_refuse_what_is_no_mesh) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t indices[3] = {0, 1, 3};
    const shb_mesh fine = {.positions = positions, .vertex_count = 3, .triangle_count = 1};
    shb_mesh mesh = fine;
    shb_clusters *const untouched = (shb_clusters *)(uintptr_t)64;
    shb_clusters *clusters = untouched;
    CHECK_INT(shb_clusters_create(NULL, &mesh, &clusters), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_clusters_create(context, NULL, &clusters), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_clusters_create(context, &mesh, NULL), SHB_ERROR_ARGUMENT);
    mesh.indices = indices;
    CHECK_INT(shb_clusters_create(context, &mesh, &clusters), SHB_ERROR_ARGUMENT);
    mesh = fine;
    mesh.vertex_count = 2;
    CHECK_INT(shb_clusters_create(context, &mesh, &clusters), SHB_ERROR_ARGUMENT);
    mesh = fine;
    mesh.positions = NULL;
    CHECK_INT(shb_clusters_create(context, &mesh, &clusters), SHB_ERROR_ARGUMENT);
    mesh = (shb_mesh){.positions = positions,
                      .vertex_count = 3,
                      .indices = indices,
                      .triangle_count = UINT32_MAX};
    CHECK_INT(shb_clusters_create(context, &mesh, &clusters), SHB_ERROR_SIZE);
    CHECK(clusters == untouched);
    shb_context_destroy(context);
}

TEST(clusters_of_another_mesh_are_refused) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shuffled_grid grid = make_grid(4, 4, NULL);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &grid.mesh, &clusters), SHB_OK);
    shb_mesh mesh = grid.mesh;
    mesh.clusters = clusters;
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    CHECK_INT(shb_scene_validate(&scene), SHB_OK);
    mesh.triangle_count--;
    CHECK_INT(shb_scene_validate(&scene), SHB_ERROR_ARGUMENT);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    free_grid(&grid);
}

TEST(clusters_fail_cleanly_wherever_memory_is_out) {
    test_allocator state = {0};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&(shb_context_desc){.allocator = test_allocator_hooks(&state)},
                                 &context),
              SHB_OK);
    test_random random = {33};
    shuffled_grid grid = make_grid(32, 32, &random);
    const size_t live = state.live;
    shb_clusters *clusters = NULL;
    shb_result result = SHB_ERROR_MEMORY;
    size_t fail_at = 0;
    while (result == SHB_ERROR_MEMORY) {
        state.fail_at = state.calls + ++fail_at;
        result = shb_clusters_create(context, &grid.mesh, &clusters);
        CHECK(result == SHB_OK || (state.live == live && !clusters));
    }
    CHECK_INT(result, SHB_OK);
    CHECK(fail_at > 6);
    state.fail_at = 0;
    shb_clusters_destroy(clusters);
    CHECK_INT(state.live, live);
    shb_context_destroy(context);
    free_grid(&grid);
}

/* Drawing where memory runs out at an allocation; leaves the images alone then. */
static bool draw_without_memory(shb_draw_desc desc, bool depth, uint32_t threads, size_t fail_at) {
    test_allocator state = {0};
    shb_context *context = NULL;
    const shb_context_desc made = {.allocator = test_allocator_hooks(&state), .threads = threads};
    CHECK_INT(shb_context_create(&made, &context), SHB_OK);
    test_target target = test_target_create(64, 64), before = test_target_create(64, 64);
    desc.width = desc.height = 64;
    desc.ids = depth ? NULL : target.ids;
    desc.depth.texels = depth ? target.depth : NULL;
    state.fail_at = state.calls + fail_at;
    const shb_result result = shb_draw(context, &desc, NULL);
    CHECK(result == SHB_OK || result == SHB_ERROR_MEMORY);
    CHECK(test_target_equal(&target, &before) == (result != SHB_OK));
    test_target_destroy(&target);
    test_target_destroy(&before);
    shb_context_destroy(context);
    CHECK_INT(state.live, 0);
    return result == SHB_OK;
}

/* Tiles and coded triangles; clusters of many layers in tiles; the whole target, by one thread and
 * by several. Without a depth image, all but the first. */
TEST(drawing_fails_cleanly_wherever_memory_is_out) {
    enum { INSTANCES = 16 };
    static const struct {
        bool clustered, depth;
        uint32_t threads, tile_size, instances;
    } ways[] = {{true, true, 0, 16, 1},
                {true, false, 2, 16, INSTANCES},
                {false, false, 1, 0, 1},
                {false, false, 4, 0, INSTANCES}};
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shuffled_grid grid = make_grid(16, 16, NULL);
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, &grid.mesh, &clusters), SHB_OK);
    shb_view view = {0};
    CHECK_INT(shb_view_perspective((shb_vec3){0.5, 0.5, 0.05}, (shb_vec3){1, 1, 0},
                                   (shb_vec3){0, 0, 1}, 1, 1, 0.01, 9, false, &view),
              SHB_OK);
    shb_instance instances[INSTANCES];
    for (int i = 0; i < INSTANCES; i++)
        instances[i] = (shb_instance){.mesh = &grid.mesh};
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        grid.mesh.clusters = ways[way].clustered ? clusters : NULL;
        const shb_scene scene = {instances, ways[way].instances};
        const shb_draw_desc desc = {
            .view = &view, .scene = &scene, .tile_size = ways[way].tile_size};
        size_t fail_at = 1;
        while (!draw_without_memory(desc, ways[way].depth, ways[way].threads, fail_at))
            fail_at++;
        CHECK(fail_at > (ways[way].clustered ? 8 : 4));
    }
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    free_grid(&grid);
}
