/* Bounds of scenes against those found corner by corner. */
#include "test.h"

#include "../src/scene.h"

#include "contexts.h"
#include "random.h"
#include "shadowbias/shadowbias.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VERTICES_MAX = 1500, TRIANGLES_MAX = 800, FLOATS = 8 /* of a vertex, at most */ };

/* Meshes of a scene and the memory that they use. */
typedef struct random_mesh {
    float positions[FLOATS * VERTICES_MAX];
    uint32_t indices[3 * TRIANGLES_MAX];
    uint16_t short_indices[3 * TRIANGLES_MAX];
    shb_mesh mesh;
} random_mesh;

/* Every corner of every triangle. */
static shb_box slow_bounds(const shb_scene *scene) {
    shb_box box = box_empty();
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_instance *instance = &scene->instances[i];
        const shb_mat4 transform = shb_instance_transform(instance);
        for (uint32_t t = 0; t < instance->mesh->triangle_count; t++) {
            uint32_t v[3];
            shb_mesh_triangle(instance->mesh, t, v);
            for (int k = 0; k < 3; k++) {
                const shb_vec3 p =
                    shb_mat4_transform_point(transform, shb_mesh_point(instance->mesh, v[k]));
                if (isfinite(p.x) && isfinite(p.y) && isfinite(p.z))
                    box_grow(&box, p);
            }
        }
    }
    return box;
}

/* Spread over a box, over its corners alone, or in steps of one unit in the last place farther and
 * farther out, so that each run of vertices reaches beyond those before. */
static float random_coordinate(test_random *random, uint32_t shape, uint32_t vertex) {
    if (shape == 0)
        return (float)random_double(random, -3, 5);
    if (shape == 1)
        return random_below(random, 2) ? -1.5f : 2;
    return 1 + (float)(vertex / 2 + random_below(random, 20)) * 0x1p-23f;
}

static void place_vertices(test_random *random, uint32_t floats, random_mesh *m) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, -0.0f};
    static const uint32_t counts[] = {0, 0, 1, 4, 40};
    const uint32_t shape = random_below(random, 3), odd_ones = counts[random_below(random, 5)];
    const bool only_nan = random_below(random, 2);
    for (uint32_t i = 0; i < m->mesh.vertex_count; i++)
        for (uint32_t k = 0; k < floats; k++)
            m->positions[floats * i + k] = k < 3 ? random_coordinate(random, shape, i) : NAN;
    for (uint32_t i = 0; i < odd_ones; i++)
        m->positions[floats * random_below(random, m->mesh.vertex_count) +
                     random_below(random, 3)] = odd[only_nan ? 0 : random_below(random, 6)];
}

/* Of some or of all vertices, in order or not. */
static void place_indices(test_random *random, random_mesh *m) {
    const uint32_t corners = 3 * m->mesh.triangle_count, vertices = m->mesh.vertex_count;
    const uint32_t used = 1 + random_below(random, 2) * random_below(random, vertices);
    const bool in_order = random_below(random, 2), uses_all = random_below(random, 2);
    for (uint32_t i = 0; i < corners; i++) {
        const uint32_t number = in_order ? (uint32_t)((uint64_t)i * vertices / corners) : i;
        m->indices[i] = uses_all ? number % vertices : random_below(random, used);
        m->short_indices[i] = (uint16_t)m->indices[i];
    }
}

static void make_mesh(test_random *random, random_mesh *m) {
    const uint32_t strides[] = {0, 3, 4, FLOATS}, kind = random_below(random, 3);
    const uint32_t stride = strides[random_below(random, 4)];
    const uint32_t triangles = random_below(random, random_below(random, 2) ? 20 : TRIANGLES_MAX);
    const uint32_t vertices = 1 + random_below(random, VERTICES_MAX);
    m->mesh = (shb_mesh){.positions = m->positions,
                         .position_stride = stride * sizeof(float),
                         .vertex_count = vertices,
                         .indices = kind == 0   ? NULL
                                    : kind == 1 ? (const void *)m->indices
                                                : (const void *)m->short_indices,
                         .index_size = kind == 2 ? 2 : 4,
                         .triangle_count = triangles};
    if (kind == 0 && 3 * triangles > vertices)
        m->mesh.triangle_count = vertices / 3;
    place_vertices(random, stride ? stride : 3, m);
    place_indices(random, m);
}

static shb_mat4 random_transform(test_random *random) {
    const shb_mat4 turned =
        shb_mat4_rotation(random_direction(random), random_double(random, 0, 6));
    const shb_mat4 moved = shb_mat4_translation(random_double(random, -9, 9), 2, -5);
    const shb_mat4 far_away = shb_mat4_translation(0x1p34, 0x1p34, -0x1p33);
    switch (random_below(random, 7)) {
    case 0:
        return (shb_mat4){{0}};
    case 1:
        return shb_mat4_scaling(-2, 0.1, 3);
    case 2:
        return shb_mat4_multiply(moved, shb_mat4_scaling(1, 0, -0.3));
    case 3:
        return shb_mat4_scaling(1e271, -1e270, 1); /* overflows for a few */
    case 4:
        return shb_mat4_multiply(turned, shb_mat4_scaling(1e308, 1, 1e308));
    case 5: /* runs differ by one unit in the last place or not at all */
        return shb_mat4_multiply(far_away, shb_mat4_scaling(1, -1, 1));
    default:
        return shb_mat4_multiply(moved, turned);
    }
}

/* Numbers alike, and no -0. */
static void check_bounds(const shb_scene *scene) {
    const shb_box expected = slow_bounds(scene);
    const double lo[3] = {expected.lo.x + 0.0, expected.lo.y + 0.0, expected.lo.z + 0.0};
    const double hi[3] = {expected.hi.x + 0.0, expected.hi.y + 0.0, expected.hi.z + 0.0};
    shb_box box = {{1, 2, 3}, {4, 5, 6}};
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    CHECK(memcmp(&box.lo, lo, sizeof lo) == 0);
    CHECK(memcmp(&box.hi, hi, sizeof hi) == 0);
}

TEST(scene_bounds_are_those_of_all_corners) {
    random_mesh *meshes = malloc(2 * sizeof *meshes);
    test_random random = {23};
    shb_context *context = test_context(0, SHB_ISA_BEST);
    for (int round = 0; round < 1500; round++) {
        shb_clusters *clusters[2] = {NULL};
        shb_instance instances[3];
        for (int i = 0; i < 2; i++)
            make_mesh(&random, &meshes[i]);
        for (int i = 0; i < 3; i++)
            instances[i] = (shb_instance){.mesh = &meshes[i % 2].mesh,
                                          .world_from_mesh = random_transform(&random)};
        const shb_scene scene = {instances, 1 + random_below(&random, 3)};
        check_bounds(&scene);
        for (int i = 0; i < 2; i++) {
            CHECK_INT(shb_clusters_create(context, &meshes[i].mesh, &clusters[i]), SHB_OK);
            meshes[i].mesh.clusters = clusters[i];
            check_bounds(&scene);
        }
        for (int i = 0; i < 2; i++)
            shb_clusters_destroy(clusters[i]);
    }
    shb_context_destroy(context);
    free(meshes);
}

/* Zeros of both signs meet a translation by -0, so that they stay. */
TEST(scene_bounds_have_no_negative_zero) {
    float positions[] = {0, -0.0f, 0, -0.0f, 0, -0.0f, 0, 0, -0.0f};
    const shb_mesh mesh = {.positions = positions, .vertex_count = 3, .triangle_count = 1};
    const shb_mat4 transform = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.0, -0.0, -0.0, 1}};
    const shb_instance instance = {.mesh = &mesh, .world_from_mesh = transform};
    const shb_scene scene = {&instance, 1};
    const shb_box zeros = {{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 2; i++) {
        shb_box box;
        CHECK_INT(shb_scene_bounds(&scene, &box), SHB_OK);
        CHECK(memcmp(&box, &zeros, sizeof box) == 0);
        for (int k = 0; k < 9; k++)
            positions[k] = -0.0f;
    }
}

TEST(an_index_out_of_range_is_found_wherever_it_is) {
    enum { CORNERS = 3 * 71, VERTICES = 90 };
    static float positions[3 * VERTICES];
    uint32_t indices[CORNERS];
    uint16_t short_indices[CORNERS];
    shb_mesh mesh = {.positions = positions, .vertex_count = VERTICES, .triangle_count = 71};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const uint32_t values[] = {VERTICES - 1, VERTICES, 0x7fff, 0xffff, 0x80000000, UINT32_MAX};
    for (uint32_t i = 0; i < CORNERS; i++)
        short_indices[i] = (uint16_t)(indices[i] = i % VERTICES);
    for (uint32_t i = 0; i < CORNERS; i++)
        for (int v = 0; v < 6; v++) {
            const shb_result expected = v == 0 ? SHB_OK : SHB_ERROR_ARGUMENT;
            shb_box box;
            indices[i] = values[v];
            mesh.indices = indices;
            mesh.index_size = v % 2 ? 0 : 4;
            CHECK_INT(shb_scene_bounds(&scene, &box), expected);
            CHECK_INT(shb_scene_validate(&scene), expected);
            indices[i] = i % VERTICES;
            if (values[v] > 0xffff)
                continue;
            short_indices[i] = (uint16_t)values[v];
            mesh.indices = short_indices;
            mesh.index_size = 2;
            CHECK_INT(shb_scene_bounds(&scene, &box), expected);
            CHECK_INT(shb_scene_validate(&scene), expected);
            short_indices[i] = (uint16_t)(i % VERTICES);
        }
    /* All that two bytes hold is in range. */
    short_indices[CORNERS - 1] = 0xffff;
    mesh.vertex_count = 0x10000;
    mesh.indices = short_indices;
    mesh.index_size = 2;
    CHECK_INT(shb_scene_validate(&scene), SHB_OK);
}
