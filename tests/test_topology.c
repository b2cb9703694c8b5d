/* What tells one scene from another, which vertices are one, and which triangles are neighbours. */
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

/* To a scene that is seen for the first time. */
static const shb_topology unknown;

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
    CHECK(shb_topology_make(context, &(shb_scene){m.instances, 2}, 5, &unknown, &topology));
    CHECK_INT(topology.key, 5);
    CHECK_INT(topology.triangle_count, 4);
    CHECK_INT(topology.vertex_count, 6);
    for (int i = 0; i < 12; i++)
        CHECK_INT(shb_neighbour_of(topology.neighbours[i / 3][i % 3]), expected[i / 3][i % 3]);
    shb_topology_release(context, &topology);
    shb_context_destroy(context);
}

/* Vertices move and those that were one are so still: neighbours are not looked for, so that what
 * was written over them stays. */
TEST(neighbours_are_known_where_vertices_only_move) {
    two_meshes m;
    shb_context *context = test_context(1, SHB_ISA_BEST);
    shb_topology known, topology;
    fill(&m);
    CHECK(shb_topology_make(context, &(shb_scene){m.instances, 2}, 5, &unknown, &known));
    known.neighbours[3][2] = 77;
    m.positions[0][1][0] = 0.75f;
    m.instances[1].world_from_mesh.m[13] = 9;
    CHECK(shb_topology_make(context, &(shb_scene){m.instances, 2}, 6, &known, &topology));
    CHECK_INT(topology.key, 6);
    CHECK_INT(topology.vertex_count, 8);
    CHECK(topology.positions[1][0] == 0.75 && topology.positions[4][1] == 9);
    CHECK(memcmp(topology.neighbours, known.neighbours, 4 * sizeof *known.neighbours) == 0);
    shb_topology_release(context, &topology);
    shb_topology_release(context, &known);
    shb_context_destroy(context);
}

/* The same squares, side by side or apart by so much; and with an index that differs. */
TEST(neighbours_are_found_anew_where_vertices_come_together_or_part) {
    two_meshes m;
    shb_context *context = test_context(1, SHB_ISA_BEST);
    shb_topology known, topology = {0};
    fill(&m);
    m.instances[1].world_from_mesh.m[14] = -1;
    for (int i = 0; i < 5; i++) {
        const bool meet = i % 2;
        m.instances[1].world_from_mesh.m[12] = meet ? 1 : 1.5;
        m.indices[1][0] = i < 4 ? 0 : 3;
        known = topology;
        CHECK(shb_topology_make(context, &(shb_scene){m.instances, 2}, 5, &known, &topology));
        CHECK_INT(topology.vertex_count, meet ? 6 : i < 4 ? 8 : 7);
        CHECK_INT(topology.neighbours[1][1] != SHB_ID_NONE, meet);
        CHECK_INT(topology.neighbours[2][2] != SHB_ID_NONE, meet);
        CHECK_INT(topology.neighbours[2][1] != SHB_ID_NONE, i < 4);
        shb_topology_release(context, &known);
    }
    shb_topology_release(context, &topology);
    shb_context_destroy(context);
}

enum { RANDOM_TRIANGLES = 300, RANDOM_VERTICES = 90, RANDOM_PLACES = 60 };

/* Vertices at few places, so that some triangles collapse, some are twins, and edges are those of
 * one triangle, of two or of more. */
static void fill_randomly(two_meshes *m, float positions[RANDOM_VERTICES][3],
                          uint32_t indices[3 * RANDOM_TRIANGLES], uint32_t seed) {
    uint32_t state = seed;
    fill(m);
    for (int i = 0; i < RANDOM_VERTICES; i++) {
        const int place = i < RANDOM_PLACES ? i : i - RANDOM_PLACES;
        positions[i][0] = (float)(place % 5);
        positions[i][1] = (float)(place / 5 % 4);
        positions[i][2] = (float)(place / 20);
    }
    for (int i = 0; i < 3 * RANDOM_TRIANGLES; i++) {
        state = state * 1664525 + 1013904223;
        const uint32_t first = i % 3 ? indices[i - i % 3] : state >> 8;
        indices[i] = (first + (state >> 24) % 8) % RANDOM_VERTICES;
    }
    for (int i = 0; i < 2; i++)
        m->meshes[i] = (shb_mesh){.vertex_count = RANDOM_VERTICES,
                                  .positions = positions[0],
                                  .triangle_count = RANDOM_TRIANGLES,
                                  .indices = indices};
    m->meshes[1].triangle_count = RANDOM_TRIANGLES / 2;
    m->instances[1].world_from_mesh.m[12] = 3;
}

/* Found by looking at all that came before. */
static uint32_t vertex_of(double (*known)[3], uint32_t *count, shb_vec3 p) {
    for (uint32_t i = 0; i < *count; i++)
        if (known[i][0] == p.x && known[i][1] == p.y && known[i][2] == p.z)
            return i;
    known[*count][0] = p.x;
    known[*count][1] = p.y;
    known[*count][2] = p.z;
    return (*count)++;
}

static bool have_edge(const uint32_t a[3], int i, const uint32_t b[3], int k) {
    const uint32_t x = a[i], y = a[(i + 1) % 3], z = b[k], w = b[(k + 1) % 3];
    return (x == z && y == w) || (x == w && y == z);
}

static int place_of(const uint32_t corners[3], int k) {
    return (corners[k] > corners[0]) + (corners[k] > corners[1]) + (corners[k] > corners[2]);
}

/* The sides that have the edge of corner k of triangle t, three times a triangle plus a corner;
 * among the first limit triangles, those left out apart. Returns how many, and the first two. */
static int sides_of(uint32_t (*corners)[3], const bool *left_out, int limit, int t, int k,
                    int sides[2]) {
    int count = 0;
    for (int side = 0; side < 3 * limit; side++)
        if (!left_out[side / 3] && have_edge(corners[t], k, corners[side / 3], side % 3)) {
            if (count < 2)
                sides[count] = side;
            count++;
        }
    return count;
}

static bool is_twin_of(const uint32_t a[3], const uint32_t b[3]) {
    for (int i = 0; i < 3; i++)
        if (b[i] != a[0] && b[i] != a[1] && b[i] != a[2])
            return false;
    return true;
}

static uint32_t expected_neighbour(uint32_t (*corners)[3], const bool *left_out, int count, int t,
                                   int k) {
    int sides[2];
    if (sides_of(corners, left_out, count, t, k, sides) != 2)
        return SHB_ID_NONE;
    const int side = sides[0] == 3 * t + k ? sides[1] : sides[0];
    const uint32_t *other = corners[side / 3];
    const uint32_t is_turned = other[side % 3] == corners[t][k];
    return (uint32_t)(side / 3) << 3 | is_turned << 2 |
           (uint32_t)place_of(other, (side % 3 + 2) % 3);
}

TEST(any_mesh_is_linked_as_by_looking_at_all_of_its_edges) {
    enum { COUNT = RANDOM_TRIANGLES + RANDOM_TRIANGLES / 2 };
    static float positions[RANDOM_VERTICES][3];
    static uint32_t indices[3 * RANDOM_TRIANGLES], corners[COUNT][3];
    static double places[3 * COUNT][3];
    shb_context *context = test_context(1, SHB_ISA_BEST);
    int twins = 0, joined = 0, crowded = 0;
    for (uint32_t seed = 0; seed < 20; seed++) {
        bool left_out[COUNT] = {false}; /* collapsed, or twins */
        two_meshes m;
        shb_topology topology;
        uint32_t vertices = 0;
        fill_randomly(&m, positions, indices, seed);
        const shb_scene scene = {m.instances, 2};
        CHECK(shb_topology_make(context, &scene, 5, &unknown, &topology));
        for (int t = 0; t < COUNT; t++) {
            shb_vec3 points[3];
            CHECK_INT(shb_scene_triangle(&scene, (uint32_t)t, points), SHB_OK);
            for (int k = 0; k < 3; k++)
                corners[t][k] = vertex_of(places, &vertices, points[k]);
        }
        CHECK_INT(topology.vertex_count, vertices);
        CHECK(memcmp(topology.corners, corners, sizeof corners) == 0);
        CHECK(memcmp(topology.positions, places, vertices * sizeof *places) == 0);
        for (int t = 0; t < COUNT; t++) {
            const uint32_t *c = corners[t];
            int sides[2];
            left_out[t] = c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
            const int count = left_out[t] ? 0 : sides_of(corners, left_out, t, t, 0, sides);
            bool twin = false;
            for (int i = 0; i < count && i < 2; i++)
                twin |= is_twin_of(corners[sides[i] / 3], c);
            CHECK_INT(shb_topology_is_twin(&topology, (size_t)t), twin);
            left_out[t] |= twin;
            twins += twin;
        }
        for (int t = 0; t < COUNT; t++)
            for (int k = 0; k < 3; k++) {
                const uint32_t found = topology.neighbours[t][k];
                int sides[2];
                if (left_out[t]) {
                    CHECK(found >= SHB_TWIN);
                    continue;
                }
                CHECK_INT(found, expected_neighbour(corners, left_out, COUNT, t, k));
                joined += found != SHB_ID_NONE;
                crowded += sides_of(corners, left_out, COUNT, t, k, sides) > 2;
            }
        shb_topology_release(context, &topology);
    }
    CHECK(twins > 20 && joined > 1000 && crowded > 1000);
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
    CHECK(shb_topology_make(context, &(shb_scene){&instance, 1}, 5, &unknown, &topology));
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
    CHECK(!shb_topology_make(context, &(shb_scene){&instance, 1}, 5, &unknown, &topology));
    CHECK(memcmp(&topology, &empty, sizeof empty) == 0);
    shb_context_destroy(context);
}
