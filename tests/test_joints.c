/* What is found of a map when it is asked: joints of texels. */
#include "../src/map.h"

#include "allocator.h"
#include "asked_map.h"
#include "probe.h"
#include "slow_taps.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

TEST(exact_boxes_in_a_map_that_is_drawn_again_are_those_of_a_new_one) {
    const shb_filter box = shb_filter_pcf(7, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_bias exact = shb_bias_exact();
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 90, .occluders = SHB_OCCLUDERS_PLANES};
    soup first = {0}, second = {0};
    asked_scene_add(&first);
    soup_add_quad(&second, (float[]){-1, -1, 0.3f}, (float[]){1, -1, 0.1f}, (float[]){1, 1, 0.9f},
                  (float[]){-1, 1, -0.9f});
    asked_scene_add_steep(&second);
    asked_points *given = malloc(sizeof *given);
    asked_points_fill(&second, 8, given);
    asked_map drawn_again = asked_map_draw(SHB_ISA_BEST, &desc, &first);
    asked_map fresh = asked_map_draw(SHB_ISA_BEST, &desc, &second);
    float before[ASKED_POINTS], after[ASKED_POINTS], expected[ASKED_POINTS];
    asked_map_ask(&drawn_again, given, &box, before);
    CHECK_INT(shb_map_draw(drawn_again.map, soup_scene(&second), &exact, NULL), SHB_OK);
    asked_map_ask(&drawn_again, given, &box, after);
    asked_map_ask(&fresh, given, &box, expected);
    CHECK(memcmp(after, expected, sizeof expected) == 0);
    CHECK(memcmp(before, expected, sizeof expected) != 0);
    asked_map_close(&fresh);
    asked_map_close(&drawn_again);
    free(given);
    soup_free(&first);
    soup_free(&second);
}

enum { ASKERS = 4 };

typedef struct asked_at_once {
    const asked_map *made;
    const asked_points *given;
    shb_result results[ASKERS + 1];
    float seen[ASKERS + 1][ASKED_POINTS];
} asked_at_once;

/* Checks are for one thread. */
static void ask_as_one_of_many(void *arg, size_t index) {
    asked_at_once *all = arg;
    const shb_filter box = shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    all->results[index] = asked_map_answer(all->made, all->given, &box, all->seen[index]);
}

TEST(threads_that_ask_a_new_map_at_once_get_the_answers_of_one) {
    const shb_context_desc many = {.threads = ASKERS};
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 200, .occluders = SHB_OCCLUDERS_PLANES};
    shb_context *threads = NULL;
    soup s = {0};
    asked_scene_add(&s);
    asked_at_once *all = malloc(sizeof *all);
    asked_points *given = malloc(sizeof *given);
    asked_points_fill(&s, 9, given);
    CHECK_INT(shb_context_create(&many, &threads), SHB_OK);
    for (int i = 0; i < 20; i++) {
        asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
        all->made = &made;
        all->given = given;
        shb_parallel_for(threads, ask_as_one_of_many, all, ASKERS);
        ask_as_one_of_many(all, ASKERS);
        for (int k = 0; k <= ASKERS; k++) {
            CHECK_INT(all->results[k], SHB_OK);
            CHECK(memcmp(all->seen[k], all->seen[ASKERS], sizeof *all->seen) == 0);
        }
        asked_map_close(&made);
    }
    shb_context_destroy(threads);
    free(given);
    free(all);
    soup_free(&s);
}

/* Bits of a kind in the words of joints, and the two texels that it joins. */
typedef struct joint_kind {
    int bit, from_x, to_x, to_y;
} joint_kind;

static bool is_joined(const shb_joints *joints, int x, int y, int bit) {
    const uint64_t word =
        joints->words[(size_t)y * joints->pitch + SHB_JOINT_MARGIN + (size_t)(x / SHB_JOINT_WORD)];
    return word >> (bit + x % SHB_JOINT_WORD) & 1;
}

static void *filled_alloc(void *user, size_t size, size_t alignment) {
    void *memory = test_allocator_hooks(user).alloc(user, size, alignment);
    return memory ? memset(memory, 0xff, size) : NULL;
}

TEST(texels_beyond_the_ends_of_a_row_are_joined_to_none_whatever_memory_held) {
    test_allocator state = {0};
    const shb_context_desc desc = {
        .allocator = {filled_alloc, test_allocator_hooks(&state).free, &state}, .threads = 1};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    shb_joints joints;
    CHECK(shb_joints_create(context, 65, 17, &joints));
    CHECK_INT(joints.pitch, 2 * SHB_JOINT_MARGIN + 8);
    for (size_t y = 0; y < 17; y++)
        for (size_t i = 0; i < SHB_JOINT_MARGIN; i++) {
            const _Atomic uint64_t *row = joints.words + y * joints.pitch;
            CHECK(row[i] == 0 && row[joints.pitch - 1 - i] == 0);
        }
    for (size_t i = 0; i < 4; i++)
        CHECK_INT(joints.found[i], 0);
    shb_joints_destroy(context, &joints);
    shb_context_destroy(context);
    CHECK_INT(state.live, 0);
}

TEST(joints_tell_in_each_direction_whether_the_planes_of_neighbours_meet) {
    static const joint_kind kinds[] = {{0, 0, 1, 0}, {16, 0, 0, 1}, {32, 0, 1, 1}, {48, 1, 0, 1}};
    const shb_filter box = shb_filter_pcf(7, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_map_desc desc = {.view = probe_orthographic(reversed != 0),
                                   .width = 150,
                                   .height = 90,
                                   .occluders = SHB_OCCLUDERS_PLANES};
        soup s = {0};
        asked_scene_add(&s);
        asked_scene_add_relief(&s);
        asked_points *given = malloc(sizeof *given);
        asked_points_fill(&s, 11, given);
        asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
        float seen[ASKED_POINTS];
        asked_map_ask(&made, given, &box, seen);
        const shb_joints *joints = &made.map->occluders.joints;
        for (int k = 0; k < 4; k++) {
            int counts[3] = {0}, wrong = 0;
            for (int y = 0; y < 90; y++)
                for (int x = 0; x < 150; x++) {
                    if (!joints->found[(size_t)(y / SHB_JOINT_ROWS) * joints->columns +
                                       (size_t)(x / SHB_JOINT_COLUMNS)])
                        continue;
                    const slow_joint expected = slow_joint_of(made.map, x + kinds[k].from_x, y,
                                                              x + kinds[k].to_x, y + kinds[k].to_y);
                    counts[expected]++;
                    wrong += expected != SLOW_JOINT_UNSURE &&
                             is_joined(joints, x, y, kinds[k].bit) != (expected == SLOW_JOINT_MEET);
                }
            CHECK_INT(wrong, 0);
            CHECK(counts[SLOW_JOINT_APART] > 300 && counts[SLOW_JOINT_MEET] > 1000);
            CHECK(counts[SLOW_JOINT_UNSURE] < 20);
        }
        asked_map_close(&made);
        free(given);
        soup_free(&s);
    }
}

static void forget_block(const shb_joints *joints, size_t column, size_t row) {
    enum { WORDS = SHB_JOINT_COLUMNS / SHB_JOINT_WORD };
    joints->found[row * joints->columns + column] = 0;
    for (size_t y = row * SHB_JOINT_ROWS; y < (row + 1) * SHB_JOINT_ROWS && y < joints->height; y++)
        for (size_t i = 0; i < WORDS; i++)
            joints->words[y * joints->pitch + SHB_JOINT_MARGIN + column * WORDS + i] = 0;
}

/* A corner of four blocks that a box of 7 x 7 texels around the place reaches. */
static bool is_at_corner(double x, double y, size_t *column, size_t *row) {
    const double nearest_column = round(x / SHB_JOINT_COLUMNS);
    const double nearest_row = round(y / SHB_JOINT_ROWS);
    *column = (size_t)nearest_column;
    *row = (size_t)nearest_row;
    return nearest_column >= 1 && nearest_column <= 2 && nearest_row >= 1 && nearest_row <= 9 &&
           fabs(x - nearest_column * SHB_JOINT_COLUMNS) < 2.4 &&
           fabs(y - nearest_row * SHB_JOINT_ROWS) < 2.4;
}

TEST(a_box_finds_each_block_that_it_reaches_whichever_were_found_before) {
    const shb_filter box = shb_filter_pcf(7, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_bias exact = shb_bias_exact();
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 150, .occluders = SHB_OCCLUDERS_PLANES};
    soup s = {0};
    asked_scene_add_relief(&s);
    asked_points *given = malloc(sizeof *given);
    asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
    const shb_joints *joints = &made.map->occluders.joints;
    int asked = 0;
    for (uint64_t seed = 12; seed < 24; seed++) {
        float expected[ASKED_POINTS];
        asked_points_fill(&s, seed, given);
        asked_map_ask(&made, given, &box, expected);
        for (int i = 0; i < ASKED_POINTS; i++) {
            shb_exact_fragment fragment;
            size_t column, row;
            if (!asked_point_fragment(made.map, given, i, &fragment) ||
                !is_at_corner(fragment.point.x, fragment.point.y, &column, &row))
                continue;
            const shb_points one = {.count = 1,
                                    .positions = given->positions + 3 * i,
                                    .normals = given->normals + 3 * i};
            asked++;
            for (size_t block = 0; block < 4; block++) {
                float seen;
                forget_block(joints, column - block % 2, row - block / 2);
                CHECK_INT(shb_map_visibility(made.map, &one, &exact, &box, &seen), SHB_OK);
                CHECK(memcmp(&seen, &expected[i], sizeof seen) == 0);
            }
        }
    }
    CHECK(asked > 100);
    asked_map_close(&made);
    free(given);
    soup_free(&s);
}
