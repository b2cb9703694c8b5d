/* The test of mutual planes in float says what it says in double, for one fragment after the other:
 * where stored depths and slopes lie near what decides, and for numbers that no scene should hold.
 */
#include "../src/context.h"
#include "../src/exact.h"
#include "../src/format.h"
#include "../src/occluders.h"
#include "../src/slopes.h"

#include "contexts.h"
#include "isas.h"
#include "odd_views.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "slow_taps.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

enum { MAP = 64, POINTS = 1500 };

typedef struct planes_case {
    shb_map *map;
    float positions[3 * POINTS], normals[3 * POINTS];
    float visibility[POINTS];
    unsigned shadowed;
} planes_case;

static shb_exact_fragment fragment_of(const planes_case *c, int i) {
    double position[3], normal[3];
    for (int k = 0; k < 3; k++) {
        position[k] = (double)c->positions[3 * i + k];
        normal[k] = (double)c->normals[3 * i + k];
    }
    return shb_exact_fragment_of(&c->map->rows, position, normal);
}

/* False: none holds the fragment. */
static bool find_texel(const shb_light_point *point, int32_t *column, int32_t *row) {
    if (!(point->w > 0 && point->x >= 0 && point->x < MAP && point->y >= 0 && point->y < MAP))
        return false;
    *column = (int32_t)point->x;
    *row = (int32_t)point->y;
    return true;
}

static float *depth_at(const shb_map *map, int32_t column, int32_t row) {
    return (float *)(void *)((char *)map->depth.texels + (size_t)row * map->depth.stride) + column;
}

static float expected_of(const planes_case *c, int i) {
    const shb_exact_fragment fragment = fragment_of(c, i);
    int32_t column, row;
    if (!find_texel(&fragment.point, &column, &row))
        return 1;
    const shb_exact_sample sample = slow_sample_of(c->map, column, row);
    const bool holds = sample.depth < (double)shb_far_depth(c->map->info.view.reversed);
    return holds && shb_exact_is_shadowed(&fragment, &sample) &&
                   !slow_is_fine_sheet(c->map, &fragment, column, row)
               ? 0.0f
               : 1.0f;
}

static unsigned count_differences(planes_case *c) {
    const shb_points points = {.count = POINTS, .positions = c->positions, .normals = c->normals};
    const shb_bias exact = shb_bias_exact();
    unsigned wrong = 0;
    CHECK_INT(shb_map_visibility(c->map, &points, &exact, NULL, c->visibility), SHB_OK);
    for (int i = 0; i < POINTS; i++) {
        const float expected = expected_of(c, i);
        wrong += c->visibility[i] != expected;
        c->shadowed += expected == 0;
    }
    return wrong;
}

/* What a depth and slopes are off by from what decides: nothing, a few of its errors, or much. */
static double some_ways(test_random *random) {
    const double way = random_double(random, -2, 3);
    return random_below(random, 3) ? way : ldexp(way, (int)random_below(random, 24));
}

/* Texels hold depths near some fragment's own plane, and planes that are parallel to it, or pass
 * near the fragment, or anything. */
static void fill_with_own_planes(planes_case *c, test_random *random) {
    shb_map *map = c->map;
    const double sign = map->info.view.reversed ? -1 : 1, unit = map->occluders.slope_unit;
    for (int i = 0; i < POINTS; i++) {
        const shb_exact_fragment f = fragment_of(c, i);
        int32_t column, row;
        if (!find_texel(&f.point, &column, &row))
            continue;
        const double to_x = column + 0.5 - f.point.x, to_y = row + 0.5 - f.point.y;
        const double own = f.point.z + (f.slopes.x * to_x + f.slopes.y * to_y);
        const double own_error =
            f.error + f.slopes.error_x * fabs(to_x) + f.slopes.error_y * fabs(to_y);
        const double depth = own - own_error * some_ways(random);
        double slope_x = f.slopes.x, slope_y = f.slopes.y;
        if (random_below(random, 2)) {
            slope_y = random_double(random, -1, 1) * 0x1p27 * unit;
            slope_x = (depth - f.point.z - slope_y * to_y) / to_x;
            slope_x *= 1 + 0x1p-13 * some_ways(random);
        }
        if (random_below(random, 4) == 0)
            slope_x = slope_y = 0;
        if (!(fabs(depth) <= 1))
            continue;
        *depth_at(map, column, row) = (float)(sign * depth);
        shb_occluder_row(map, row)[column] = shb_slopes_of(slope_x / unit, slope_y / unit);
    }
}

static void fill_with_anything(planes_case *c, test_random *random) {
    const float sign = c->map->info.view.reversed ? -1.0f : 1.0f;
    for (int32_t row = 0; row < MAP; row++)
        for (int32_t column = 0; column < MAP; column++) {
            const double most = random_below(random, 9) ? 0x1p29 : 0x1p44;
            *depth_at(c->map, column, row) =
                random_below(random, 9) ? sign * (float)random_double(random, sign < 0 ? -1 : 0, 1)
                                        : sign * shb_far_depth(sign < 0);
            shb_occluder_row(c->map, row)[column] = shb_slopes_of(
                random_double(random, -most, most), random_double(random, -most, most));
        }
}

/* On borders and centres of texels of a light straight above, and some floats beside them; every
 * third one anywhere. Normals from flat to steep. */
static void place_points(planes_case *c, shb_vec3 center, double scale, test_random *random) {
    const double base[3] = {center.x, center.y, center.z};
    for (int i = 0; i < POINTS; i++) {
        static const double flats[4] = {1, 1, 0.01, 0}; /* 0: faces a light straight above */
        const double flat = flats[random_below(random, 4)];
        double normal[3], squared = 0;
        for (int k = 0; k < 3; k++) {
            const double grid = ((double)random_below(random, 2 * MAP + 9) - MAP - 4) / MAP;
            const double way = i % 3 == 0 ? random_double(random, -1.2, 1.2) : grid;
            float *at = &c->positions[3 * i + k];
            *at = (float)(base[k] + scale * way);
            for (uint64_t steps = random_below(random, 3); steps > 0; steps--)
                *at = nextafterf(*at, (float)(base[k] - 9 * scale));
            normal[k] = random_double(random, -1, 1) * (k == 1 ? 1 : flat);
            squared += normal[k] * normal[k];
        }
        for (int k = 0; k < 3; k++)
            c->normals[3 * i + k] = (float)(normal[k] / sqrt(squared));
    }
}

/* A map that says that it holds planes. */
static shb_map *open_map(shb_context *context, int kind, shb_vec3 center, double scale) {
    shb_map_desc desc = {.width = MAP, .occluders = SHB_OCCLUDERS_PLANES};
    shb_map *map = NULL;
    CHECK_INT(odd_view(kind, center, scale, 9 * scale, &desc.view), SHB_OK);
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    map->empty = false;
    map->occluders.held = true;
    return map;
}

/* Numbers that no scene should hold. */
static void spoil(float *values, size_t count, test_random *random) {
    static const float odd[] = {NAN,   INFINITY, -INFINITY, 0,      -0.0f,
                                1e30f, -1e30f,   1e-40f,    1e-20f, 3e38f};
    for (size_t i = 0; i < count; i++)
        if (random_below(random, 40) == 0)
            values[i] = odd[random_below(random, sizeof odd / sizeof *odd)];
}

/* Unit normals, then any; then some of no numbers. */
static void check_points(planes_case *c, shb_vec3 center, double scale, test_random *random) {
    place_points(c, center, scale, random);
    fill_with_anything(c, random);
    CHECK_INT(count_differences(c), 0);
    for (int round = 0; round < 3; round++) {
        fill_with_own_planes(c, random);
        CHECK_INT(count_differences(c), 0);
    }
    for (int i = 0; i < 3 * POINTS; i++)
        c->normals[i] *= (float)ldexp(1, 8 * (i / 3 % 31) - 120);
    fill_with_own_planes(c, random);
    CHECK_INT(count_differences(c), 0);
    spoil(c->normals, 3 * POINTS, random);
    CHECK_INT(count_differences(c), 0);
    spoil(c->positions + 300, 600, random);
    CHECK_INT(count_differences(c), 0);
}

static void check_place(shb_isa isa, shb_vec3 center, double scale) {
    shb_context *context = test_context(1, isa);
    planes_case *c = malloc(sizeof *c);
    test_random random = {51};
    for (int kind = 0; kind < ODD_VIEWS; kind++) {
        c->map = open_map(context, kind, center, scale);
        c->shadowed = 0;
        check_points(c, center, scale, &random);
        CHECK(c->shadowed > POINTS / 8);
        shb_map_destroy(c->map);
    }
    free(c);
    shb_context_destroy(context);
}

TEST(quick_planes_say_what_doubles_say_at_any_scale) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (double scale = 1e-13; scale < 2e13; scale *= isa == SHB_ISA_SCALAR ? 1e2 : 1e4)
            check_place(isa, (shb_vec3){0, 0, 0}, scale);
}

TEST(quick_planes_say_what_doubles_say_far_from_the_origin) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (double far_away = 1e1; far_away < 2e6; far_away *= 1e1)
            check_place(isa, (shb_vec3){far_away, -far_away, 2 * far_away}, 1);
}
