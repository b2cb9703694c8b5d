/* Sheets that wind: boxes by planes over joints of texels that are put there at random. */
#include "../src/map.h"

#include "asked_map.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

enum { SIDE = 72, APART = 9, FRAGMENTS = SIDE / APART * (SIDE / APART), KINDS = 4 };

/* To the right, below, to the one below that, and from the one to the right to the one below. */
static const int joint_ends[KINDS][2][2] = {
    {{0, 0}, {1, 0}}, {{0, 0}, {0, 1}}, {{0, 0}, {1, 1}}, {{1, 0}, {0, 1}}};

typedef struct labyrinth {
    bool joined[KINDS][SIDE][SIDE];
} labyrinth;

static bool is_in_map(int x, int y) {
    return x >= 0 && y >= 0 && x < SIDE && y < SIDE;
}

/* A texel of a fragment, which holds the ground; all others hold what is before it. */
static bool is_own(int x, int y) {
    return x % APART == APART / 2 && y % APART == APART / 2;
}

/* Joints of this part of neighbours. */
static void make_labyrinth(uint64_t seed, double part, labyrinth *made) {
    test_random random = {seed};
    for (int kind = 0; kind < KINDS; kind++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                bool inside = true;
                for (int end = 0; end < 2; end++)
                    inside &= is_in_map(x + joint_ends[kind][end][0], y + joint_ends[kind][end][1]);
                made->joined[kind][y][x] = random_double(&random, 0, 1) < part && inside;
            }
}

static void put_into_map(const labyrinth *from, shb_map *map) {
    const shb_joints *joints = &map->occluders.joints;
    const size_t blocks = joints->columns * ((SIDE + SHB_JOINT_ROWS - 1) / SHB_JOINT_ROWS);
    for (size_t i = 0; i < blocks; i++)
        atomic_store(&joints->found[i], 1);
    for (size_t y = 0; y < SIDE; y++)
        for (size_t x = 0; x < SIDE; x++) {
            _Atomic uint64_t *word =
                joints->words + y * joints->pitch + SHB_JOINT_MARGIN + x / SHB_JOINT_WORD;
            const float depth = is_own((int)x, (int)y) ? 0.5f : 0.25f;
            char *row = (char *)map->depth.texels + y * map->depth.stride;
            memcpy(row + x * sizeof depth, &depth, sizeof depth);
            for (size_t kind = 0; kind < KINDS; kind++) {
                const uint64_t bit = (uint64_t)1 << (kind * SHB_JOINT_WORD + x % SHB_JOINT_WORD);
                if (from->joined[kind][y][x])
                    atomic_fetch_or(word, bit);
                else
                    atomic_fetch_and(word, ~bit);
            }
        }
}

/* Marks what is joined to a texel in a box of n x n from left and top on. */
static void flood(const labyrinth *in, int left, int top, int n, int x, int y,
                  bool reached[SIDE][SIDE]) {
    reached[y][x] = true;
    for (int kind = 0; kind < KINDS; kind++)
        for (int end = 0; end < 2; end++) {
            const int at_x = x - joint_ends[kind][end][0], at_y = y - joint_ends[kind][end][1];
            const int to_x = at_x + joint_ends[kind][1 - end][0];
            const int to_y = at_y + joint_ends[kind][1 - end][1];
            if (is_in_map(at_x, at_y) && in->joined[kind][at_y][at_x] && to_x >= left &&
                to_x < left + n && to_y >= top && to_y < top + n && !reached[to_y][to_x])
                flood(in, left, top, n, to_x, to_y, reached);
        }
}

/* Lit taps of the box around a fragment right of its texel's centre and below it. */
static int count_lit(const labyrinth *in, int n, int x, int y) {
    bool reached[SIDE][SIDE] = {{0}};
    const int left = x - (n - 1) / 2, top = y - (n - 1) / 2;
    int lit = 0;
    flood(in, left, top, n, x, y, reached);
    for (int row = top; row < top + n; row++)
        for (int column = left; column < left + n; column++)
            lit += !is_in_map(column, row) || is_own(column, row) || reached[row][column];
    return lit;
}

static void check_labyrinth(shb_isa isa, const labyrinth *in, int n) {
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = SIDE, .occluders = SHB_OCCLUDERS_PLANES};
    const shb_filter box = shb_filter_pcf((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_bias exact = shb_bias_exact();
    float positions[FRAGMENTS][3], normals[FRAGMENTS][3], visibility[FRAGMENTS];
    int own[FRAGMENTS][2];
    for (int i = 0; i < FRAGMENTS; i++) {
        own[i][0] = i % (SIDE / APART) * APART + APART / 2;
        own[i][1] = i / (SIDE / APART) * APART + APART / 2;
        positions[i][0] = ((float)own[i][0] + 0.6f) * 2 / SIDE - 1;
        positions[i][1] = 1 - ((float)own[i][1] + 0.6f) * 2 / SIDE;
        positions[i][2] = 0;
        memcpy(normals[i], (float[]){0, 0, 1}, sizeof normals[i]);
    }
    soup ground = {0};
    soup_add_quad(&ground, (float[]){-2, -2, 0}, (float[]){2, -2, 0}, (float[]){2, 2, 0},
                  (float[]){-2, 2, 0});
    asked_map made = asked_map_draw(isa, &desc, &ground);
    put_into_map(in, made.map);
    const shb_points points = {
        .count = FRAGMENTS, .positions = positions[0], .normals = normals[0]};
    CHECK_INT(shb_map_visibility(made.map, &points, &exact, &box, visibility), SHB_OK);
    for (int i = 0; i < FRAGMENTS; i++) {
        const int lit = count_lit(in, n, own[i][0], own[i][1]);
        CHECK_NEAR(visibility[i], (double)lit / (n * n), 1e-6);
    }
    asked_map_close(&made);
    soup_free(&ground);
}

TEST(sheets_are_followed_wherever_joints_lead_in_the_box) {
    static const int sizes[] = {1, 2, 3, 5, 8, 15, 16, 17, 24, 31, 32, 33, 40, 63};
    labyrinth *made = malloc(sizeof *made);
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            for (int part = 2; part < 5; part++) {
                make_labyrinth(i, part / 10.0, made);
                check_labyrinth(isa, made, sizes[i]);
            }
    free(made);
}
