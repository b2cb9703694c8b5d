/* What tells one scene from another, and which vertices are one. */
#include "../src/topology.h"
#include "contexts.h"
#include "test.h"

#include <math.h>
#include <string.h>

/* Two meshes of two triangles each. */
typedef struct two_meshes {
    float positions[2][4][3];
    uint32_t indices[2][6];
    shb_mesh meshes[2];
    shb_instance instances[2];
} two_meshes;

static void fill(two_meshes *m) {
    static const uint32_t indices[6] = {0, 1, 2, 2, 1, 3};
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 4; k++) {
            m->positions[i][k][0] = (float)(k & 1);
            m->positions[i][k][1] = (float)(k >> 1);
            m->positions[i][k][2] = (float)i;
        }
        memcpy(m->indices[i], indices, sizeof indices);
        m->meshes[i] = (shb_mesh){.vertex_count = 4,
                                  .positions = m->positions[i][0],
                                  .triangle_count = 2,
                                  .indices = m->indices[i]};
        m->instances[i] =
            (shb_instance){.mesh = &m->meshes[i], .world_from_mesh = shb_mat4_identity()};
    }
}

static uint64_t key_of(const two_meshes *m, size_t count) {
    return shb_topology_key(&(shb_scene){m->instances, count});
}

/* Any coordinate, index or element of a transform that differs. */
TEST(scenes_that_differ_anywhere_have_different_keys) {
    static two_meshes m;
    uint64_t keys[100];
    int count = 0;
    fill(&m);
    keys[count++] = key_of(&m, 2);
    keys[count++] = key_of(&m, 1);
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 12; k++) {
            float *coordinate = &m.positions[i][k / 3][k % 3], old = *coordinate;
            *coordinate = nextafterf(old, 2);
            keys[count++] = key_of(&m, 2);
            *coordinate = old;
        }
        for (int k = 0; k < 6; k++) {
            const uint32_t old = m.indices[i][k];
            m.indices[i][k] = (old + 1) % 4;
            keys[count++] = key_of(&m, 2);
            m.indices[i][k] = old;
        }
        for (int k = 0; k < 16; k++) {
            double *element = &m.instances[i].world_from_mesh.m[k];
            const double old = *element;
            *element = nextafter(old, 2);
            keys[count++] = key_of(&m, 2);
            *element = old;
        }
        m.meshes[i].triangle_count = 1;
        keys[count++] = key_of(&m, 2);
        m.meshes[i].triangle_count = 2;
    }
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++)
            CHECK(keys[i] != keys[k]);
    CHECK(key_of(&m, 2) == keys[0]);
}

/* Two unit squares side by side: the one's triangle 1 and the other's triangle 0, the scene's 2,
 * have the edge at x = 1. */
TEST(instances_are_one_mesh) {
    enum { NONE = SHB_ID_NONE >> 3 };
    static const uint32_t expected[4][3] = {
        {NONE, 1, NONE}, {0, 2, NONE}, {NONE, 3, 1}, {2, NONE, NONE}};
    two_meshes m;
    shb_context *context = test_context(1, SHB_ISA_BEST);
    shb_topology topology;
    fill(&m);
    m.instances[1].world_from_mesh.m[12] = 1;
    m.instances[1].world_from_mesh.m[14] = -1;
    CHECK(shb_topology_make(context, &(shb_scene){m.instances, 2}, 5, &topology));
    CHECK_INT(topology.key, 5);
    CHECK_INT(topology.triangle_count, 4);
    CHECK_INT(topology.vertex_count, 6);
    for (int i = 0; i < 12; i++)
        CHECK_INT(shb_neighbour_of(topology.neighbours[i / 3][i % 3]), expected[i / 3][i % 3]);
    shb_topology_release(context, &topology);
    shb_context_destroy(context);
}

/* Two triangles with an edge on the plane x = 0, its vertices at 0 in one and at -0 in the other.
 */
TEST(vertices_at_either_zero_are_one) {
    static const float positions[6][3] = {{-1, 0, 0},    {0, 0, 0},     {0, 1, 0},
                                          {1, 0, -0.0f}, {-0.0f, 1, 0}, {-0.0f, -0.0f, 0}};
    const shb_mesh mesh = {.vertex_count = 6, .positions = positions[0], .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    shb_context *context;
    shb_topology topology;
    context = test_context(1, SHB_ISA_BEST);
    CHECK(shb_topology_make(context, &(shb_scene){&instance, 1}, 5, &topology));
    CHECK_INT(topology.vertex_count, 4);
    CHECK_INT(topology.neighbours[0][0], SHB_ID_NONE);
    CHECK_INT(shb_neighbour_of(topology.neighbours[0][1]), 1);
    CHECK(!shb_neighbour_is_turned(topology.neighbours[0][1]));
    CHECK_INT(topology.neighbours[0][2], SHB_ID_NONE);
    shb_topology_release(context, &topology);
    shb_context_destroy(context);
}

/* A neighbour has 29 bits for a triangle, all ones for none. */
TEST(topologies_of_too_many_triangles_are_refused) {
    static const float positions[9];
    static const uint32_t unread = 0;
    const shb_mesh mesh = {
        .vertex_count = 3, .positions = positions, .triangle_count = 1u << 29, .indices = &unread};
    const shb_instance instance = {.mesh = &mesh};
    const shb_topology empty = {0};
    shb_context *context;
    shb_topology topology;
    context = test_context(1, SHB_ISA_BEST);
    CHECK(!shb_topology_make(context, &(shb_scene){&instance, 1}, 5, &topology));
    CHECK(memcmp(&topology, &empty, sizeof empty) == 0);
    shb_context_destroy(context);
}
