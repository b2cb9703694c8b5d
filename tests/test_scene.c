#include "test.h"

#include "../src/scene.h"

#include <math.h>
#include <string.h>

/* Two triangles of a unit square in z = 0, the second vertex row at y = 2. */
static const float square[] = {0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0};
static const uint32_t square_indices[] = {0, 1, 2, 0, 2, 3};
static const uint16_t square_short_indices[] = {0, 1, 2, 0, 2, 3};

static shb_mesh square_mesh(void) {
    return (shb_mesh){
        .positions = square, .vertex_count = 4, .indices = square_indices, .triangle_count = 2};
}

static shb_scene scene_of(const shb_instance *instances, size_t count) {
    return (shb_scene){instances, count};
}

static void check_point(shb_vec3 actual, double x, double y, double z) {
    CHECK_NEAR(actual.x, x, 0);
    CHECK_NEAR(actual.y, y, 0);
    CHECK_NEAR(actual.z, z, 0);
}

/* Every door of a scene must give the same verdict. */
static void check_verdict(const shb_scene *scene, shb_result expected) {
    CHECK_INT(shb_scene_check(NULL, "", "", scene), expected);
    CHECK_INT(shb_scene_validate(scene), expected);
    shb_box bounds = {{7, 7, 7}, {7, 7, 7}};
    CHECK_INT(shb_scene_bounds(scene, &bounds), expected);
    CHECK(expected == SHB_OK || (bounds.lo.x == 7 && bounds.hi.z == 7));
    shb_vec3 corners[3] = {{7, 7, 7}, {7, 7, 7}, {7, 7, 7}};
    if (expected) {
        CHECK_INT(shb_scene_triangle(scene, 0, corners), expected);
        CHECK_NEAR(corners[0].x + corners[1].y + corners[2].z, 21, 0);
        CHECK_INT(shb_scene_triangle_count(scene), 0);
    }
}

static void check_mesh_verdict(shb_mesh mesh, shb_result expected) {
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = scene_of(&instance, 1);
    check_verdict(&scene, expected);
}

TEST(scene_counts_triangles_through_its_instances) {
    const shb_mesh mesh = square_mesh(), empty = {0};
    const shb_instance instances[] = {
        {.mesh = &empty}, {.mesh = &mesh}, {.mesh = &empty}, {.mesh = &mesh}, {.mesh = &mesh}};
    const shb_scene scene = scene_of(instances, 5);
    CHECK_INT(shb_scene_triangle_count(&scene), 6);
    const size_t owners[] = {1, 1, 3, 3, 4, 4};
    for (uint32_t id = 0; id < 6; id++) {
        uint32_t first = 99;
        CHECK_INT(shb_scene_instance_of(&scene, id, &first), owners[id]);
        CHECK_INT(first, id / 2 * 2);
    }
}

TEST(scene_triangle_applies_the_transform) {
    const shb_mesh mesh = square_mesh();
    const shb_mat4 transform =
        shb_mat4_multiply(shb_mat4_translation(10, 20, 30), shb_mat4_scaling(2, 3, 4));
    const shb_instance instances[] = {{.mesh = &mesh},
                                      {.mesh = &mesh, .world_from_mesh = transform}};
    const shb_scene scene = scene_of(instances, 2);
    shb_vec3 corners[3];
    CHECK_INT(shb_scene_triangle(&scene, 1, corners), SHB_OK);
    check_point(corners[0], 0, 0, 0);
    check_point(corners[1], 1, 2, 0);
    check_point(corners[2], 0, 2, 0);
    CHECK_INT(shb_scene_triangle(&scene, 2, corners), SHB_OK);
    check_point(corners[0], 10, 20, 30);
    check_point(corners[1], 12, 20, 30);
    check_point(corners[2], 12, 26, 30);
    CHECK_INT(shb_scene_triangle(&scene, 4, corners), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_scene_triangle(&scene, SHB_ID_NONE, corners), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_scene_triangle(&scene, 0, NULL), SHB_ERROR_ARGUMENT);
    check_point(corners[2], 12, 26, 30);
}

TEST(mesh_reads_strides_and_index_sizes) {
    /* Position and normal interleaved with two floats of something else: 32 bytes a vertex. */
    const float vertices[] = {1, 2,    3,  .5f, 0, -1, 90, 91, 4,  5,  6,  0,
                              1, .25f, 92, 93,  7, 8,  9,  -1, -2, -3, 94, 95};
    shb_mesh mesh = {.positions = vertices,
                     .position_stride = 32,
                     .normals = vertices + 3,
                     .normal_stride = 32,
                     .vertex_count = 3,
                     .triangle_count = 1};
    CHECK_NEAR(shb_mesh_position(&mesh, 2)[0], 7, 0);
    CHECK_NEAR(shb_mesh_normal(&mesh, 1)[2], 0.25, 0);
    mesh.position_stride = mesh.normal_stride = 0; /* packed: 12 bytes */
    CHECK_NEAR(shb_mesh_position(&mesh, 1)[0], 0.5, 0);
    CHECK_NEAR(shb_mesh_normal(&mesh, 1)[0], 90, 0);

    const uint32_t wide[] = {1, 2, 70000, 5, 4, 3};
    const uint16_t narrow[] = {1, 2, 60000, 5, 4, 3};
    uint32_t v[3];
    shb_mesh_triangle(&mesh, 5, v);
    CHECK(v[0] == 15 && v[1] == 16 && v[2] == 17);
    mesh.indices = wide;
    shb_mesh_triangle(&mesh, 0, v);
    CHECK(v[0] == 1 && v[1] == 2 && v[2] == 70000);
    mesh.index_size = 4;
    shb_mesh_triangle(&mesh, 1, v);
    CHECK(v[0] == 5 && v[1] == 4 && v[2] == 3);
    mesh.indices = narrow;
    mesh.index_size = 2;
    shb_mesh_triangle(&mesh, 0, v);
    CHECK(v[0] == 1 && v[1] == 2 && v[2] == 60000);
    shb_mesh_triangle(&mesh, 1, v);
    CHECK(v[0] == 5 && v[1] == 4 && v[2] == 3);
}

TEST(scene_bounds_hold_what_triangles_use) {
    /* Vertex 1 is used by no triangle; the box must not reach it. */
    const float vertices[] = {0, 0, 0, 100, 100, 100, 1, 2, 3, -1, 5, 2};
    const uint16_t indices[] = {0, 2, 3};
    const shb_mesh mesh = {.positions = vertices,
                           .vertex_count = 4,
                           .indices = indices,
                           .index_size = 2,
                           .triangle_count = 1};
    const shb_instance instances[] = {
        {.mesh = &mesh}, {.mesh = &mesh, .world_from_mesh = shb_mat4_scaling(-2, 1, 1)}};
    const shb_scene scene = scene_of(instances, 2);
    shb_box box;
    CHECK_INT(shb_scene_bounds(&scene, &box), SHB_OK);
    check_point(box.lo, -2, 0, 0);
    check_point(box.hi, 2, 5, 3);
    CHECK_INT(shb_scene_bounds(&scene, NULL), SHB_ERROR_ARGUMENT);
}

TEST(scene_bounds_of_many_triangles_hold_what_they_use) {
    /* A fan of 100 triangles about vertex 0; the last vertex is used by none at first. */
    enum { TRIANGLES = 100 };
    float vertices[3 * (TRIANGLES + 3)] = {0};
    uint32_t indices[3 * TRIANGLES];
    for (uint32_t i = 0; i < TRIANGLES + 3; i++)
        for (uint32_t k = 0; k < 3; k++)
            vertices[3 * i + k] = (float)(k == 1 ? -(int)i : (int)i);
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        indices[3 * i] = 0;
        indices[3 * i + 1] = i + 1;
        indices[3 * i + 2] = i + 2;
    }
    const shb_mesh mesh = {.positions = vertices,
                           .vertex_count = TRIANGLES + 3,
                           .indices = indices,
                           .triangle_count = TRIANGLES};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = scene_of(&instance, 1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(&scene, &box), SHB_OK);
    check_point(box.lo, 0, -101, 0);
    check_point(box.hi, 101, 0, 101);
    indices[3 * TRIANGLES - 2] = TRIANGLES + 2;
    CHECK_INT(shb_scene_bounds(&scene, &box), SHB_OK);
    check_point(box.lo, 0, -102, 0);
    check_point(box.hi, 102, 0, 102);
    indices[3 * TRIANGLES - 2] = TRIANGLES + 3;
    CHECK_INT(shb_scene_bounds(&scene, &box), SHB_ERROR_ARGUMENT);
}

TEST(scene_bounds_skip_vertices_that_are_not_finite) {
    const float vertices[] = {1,  1,         NAN, INFINITY, 2, 2, 3, 4, 5,
                              -1, -INFINITY, 0,   2,        9, 1, 0, 0, 6};
    const shb_mesh mesh = {.positions = vertices, .vertex_count = 6, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = scene_of(&instance, 1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(&scene, &box), SHB_OK);
    check_point(box.lo, 0, 0, 1);
    check_point(box.hi, 3, 9, 6);
    /* Finite in the mesh, but not after its transform. */
    const shb_instance far_away = {.mesh = &mesh, .world_from_mesh = shb_mat4_scaling(1e308, 1, 1)};
    const shb_scene overflowing = scene_of(&far_away, 1);
    CHECK_INT(shb_scene_bounds(&overflowing, &box), SHB_OK);
    check_point(box.lo, 0, 0, 6);
    check_point(box.hi, 0, 0, 6);
}

TEST(empty_scene_has_empty_bounds) {
    const shb_mesh empty = {0};
    const shb_instance instance = {.mesh = &empty};
    const shb_scene scenes[] = {scene_of(NULL, 0), scene_of(&instance, 1)};
    for (int i = 0; i < 2; i++) {
        shb_box box = {{0, 0, 0}, {1, 1, 1}};
        check_verdict(&scenes[i], SHB_OK);
        CHECK_INT(shb_scene_bounds(&scenes[i], &box), SHB_OK);
        CHECK(box.lo.x > box.hi.x && box.lo.y > box.hi.y && box.lo.z > box.hi.z);
        CHECK_INT(shb_scene_triangle_count(&scenes[i]), 0);
        shb_vec3 corners[3];
        CHECK_INT(shb_scene_triangle(&scenes[i], 0, corners), SHB_ERROR_ARGUMENT);
    }
}

TEST(scene_refuses_missing_pointers) {
    check_verdict(NULL, SHB_ERROR_ARGUMENT);
    const shb_scene nothing_there = scene_of(NULL, 1);
    check_verdict(&nothing_there, SHB_ERROR_ARGUMENT);
    const shb_instance no_mesh = {0};
    const shb_scene scene = scene_of(&no_mesh, 1);
    check_verdict(&scene, SHB_ERROR_ARGUMENT);
    shb_mesh mesh = square_mesh();
    mesh.positions = NULL;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh.triangle_count = 0;
    check_mesh_verdict(mesh, SHB_OK);
}

TEST(scene_refuses_bad_strides_and_alignments) {
    check_mesh_verdict(square_mesh(), SHB_OK);
    shb_mesh mesh = square_mesh();
    mesh.position_stride = 14;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh.position_stride = 4; /* triples would overlap */
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh = square_mesh();
    mesh.normal_stride = 8;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh = square_mesh();
    mesh.normal_stride = 13;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh = square_mesh();
    mesh.positions = (const float *)(const void *)((const char *)square + 2);
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh = square_mesh();
    mesh.normals = (const float *)(const void *)((const char *)square + 1);
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh = square_mesh();
    mesh.indices = (const char *)square_indices + 2;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh = square_mesh();
    mesh.indices = square_short_indices;
    mesh.index_size = 2;
    check_mesh_verdict(mesh, SHB_OK);
    mesh.indices = (const char *)square_short_indices + 1;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
}

TEST(scene_refuses_bad_sizes) {
    shb_mesh mesh = square_mesh();
    mesh.vertex_count = 0;
    check_mesh_verdict(mesh, SHB_ERROR_SIZE);
    mesh = square_mesh();
    mesh.position_stride = SIZE_MAX / 4; /* a multiple of 4 minus 1 */
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    mesh.position_stride = (SIZE_MAX / 4) & ~(size_t)3;
    check_mesh_verdict(mesh, SHB_ERROR_SIZE);
    mesh = square_mesh();
    mesh.normals = square;
    mesh.normal_stride = (SIZE_MAX / 4) & ~(size_t)3;
    check_mesh_verdict(mesh, SHB_ERROR_SIZE);
    mesh.normals = NULL;
    check_mesh_verdict(mesh, SHB_OK);
    const uint32_t sizes[] = {1, 3, 8};
    for (int i = 0; i < 3; i++) {
        mesh = square_mesh();
        mesh.index_size = sizes[i];
        check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    }
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene endless = scene_of(&instance, SIZE_MAX / 2);
    check_verdict(&endless, SHB_ERROR_SIZE);
}

TEST(scene_holds_at_most_the_largest_id) {
    /* Nothing is read of the meshes by these checks, so the triangles need not exist. */
    shb_mesh mesh = square_mesh();
    mesh.triangle_count = SHB_TRIANGLES_MAX - 1;
    shb_mesh one = square_mesh(), two = square_mesh();
    one.triangle_count = 1;
    const shb_instance just_fits[] = {{.mesh = &mesh}, {.mesh = &one}};
    const shb_instance one_more[] = {{.mesh = &mesh}, {.mesh = &two}};
    const shb_scene fits = scene_of(just_fits, 2), exceeds = scene_of(one_more, 2);
    CHECK_INT(shb_scene_check(NULL, "", "", &fits), SHB_OK);
    CHECK_INT(shb_scene_triangle_count(&fits), SHB_TRIANGLES_MAX);
    check_verdict(&exceeds, SHB_ERROR_SIZE);
    mesh.triangle_count = UINT32_MAX;
    const shb_scene alone = scene_of(just_fits, 1);
    check_verdict(&alone, SHB_ERROR_SIZE);
}

TEST(scene_without_indices_needs_three_vertices_a_triangle) {
    shb_mesh mesh = {.positions = square, .vertex_count = 3, .triangle_count = 1};
    check_mesh_verdict(mesh, SHB_OK);
    mesh.vertex_count = 2;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
    /* 3 * 0x60000000 would wrap to 0x20000000 in 32 bits. */
    mesh.vertex_count = 0x30000000;
    mesh.triangle_count = 0x60000000;
    check_mesh_verdict(mesh, SHB_ERROR_ARGUMENT);
}

TEST(indices_out_of_range_are_found_where_they_are_read) {
    for (int corner = 0; corner < 3; corner++) {
        uint32_t indices[] = {0, 1, 2, 0, 2, 3};
        indices[3 + corner] = 4;
        shb_mesh mesh = square_mesh();
        mesh.indices = indices;
        const shb_instance instance = {.mesh = &mesh};
        const shb_scene scene = scene_of(&instance, 1);
        shb_box box = {{7, 7, 7}, {7, 7, 7}};
        shb_vec3 corners[3];
        CHECK_INT(shb_scene_check(NULL, "", "", &scene), SHB_OK);
        CHECK_INT(shb_scene_validate(&scene), SHB_ERROR_ARGUMENT);
        CHECK_INT(shb_scene_bounds(&scene, &box), SHB_ERROR_ARGUMENT);
        CHECK_NEAR(box.lo.x, 7, 0);
        CHECK_INT(shb_scene_triangle(&scene, 0, corners), SHB_OK);
        CHECK_INT(shb_scene_triangle(&scene, 1, corners), SHB_ERROR_ARGUMENT);
        mesh.vertex_count = 5; /* now index 4 is in range, and nothing reads the vertex */
        CHECK_INT(shb_scene_validate(&scene), SHB_OK);
    }
}

TEST(scene_refuses_bad_instances) {
    const shb_mesh mesh = square_mesh();
    shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = scene_of(&instance, 1);
    instance.cull = (shb_cull)3;
    check_verdict(&scene, SHB_ERROR_ARGUMENT);
    instance.cull = (shb_cull)-1;
    check_verdict(&scene, SHB_ERROR_ARGUMENT);
    instance.cull = SHB_CULL_FRONT;
    check_verdict(&scene, SHB_OK);
    for (int i = 0; i < 16; i++) {
        instance.world_from_mesh = shb_mat4_identity();
        instance.world_from_mesh.m[i] = i % 2 ? (double)NAN : HUGE_VAL;
        check_verdict(&scene, SHB_ERROR_NUMBER);
    }
    for (int column = 0; column < 4; column++) {
        instance.world_from_mesh = shb_mat4_identity();
        instance.world_from_mesh.m[4 * column + 3] += 0x1p-40;
        check_verdict(&scene, SHB_ERROR_ARGUMENT);
    }
}

TEST(all_zeros_stand_for_the_identity) {
    const shb_instance instance = {0};
    const shb_mat4 identity = shb_mat4_identity(), read = shb_instance_transform(&instance);
    CHECK(memcmp(&read, &identity, sizeof(read)) == 0);
    const shb_instance flat = {.world_from_mesh = shb_mat4_scaling(0, 0, 0)};
    CHECK_NEAR(shb_instance_transform(&flat).m[0], 0, 0);
}

TEST(mirroring_transforms_are_recognised) {
    const shb_mat4 turns = shb_mat4_rotation((shb_vec3){1, 2, 3}, 2),
                   identity = shb_mat4_identity();
    const shb_mat4 mirrors = shb_mat4_scaling(1, -1, 1), half_turn = shb_mat4_scaling(-1, -1, 1);
    const shb_mat4 through = shb_mat4_multiply(turns, shb_mat4_scaling(-2, -3, -4));
    CHECK(!shb_transform_mirrors(&identity));
    CHECK(!shb_transform_mirrors(&turns));
    CHECK(!shb_transform_mirrors(&half_turn));
    CHECK(shb_transform_mirrors(&mirrors));
    CHECK(shb_transform_mirrors(&through));
}
