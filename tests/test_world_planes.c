/* The planes that maps of triangles keep in the world hold their triangles within what they claim,
 * and have the light on their negative side, on any instruction set. */
#include "../src/map.h"
#include "probe.h"
#include "random.h"
#include "soup.h"
#include "test.h"

#include <math.h>

enum { TRIANGLES = 500 };

typedef struct plane_counts {
    int held, sided;
} plane_counts;

/* How far a point lies behind a plane, and what rounding of its coordinates to doubles changes. */
static double distance_behind(const shb_world_plane *plane, const double p[3], double *rounding) {
    double sum = plane->offset;
    *rounding = 0;
    for (int k = 0; k < 3; k++) {
        sum += plane->normal[k] * p[k];
        *rounding += 0x1p-50 * fabs(plane->normal[k] * p[k]);
    }
    return sum;
}

/* A place of the triangle, and the direction to the light there, of length 1. */
static void place_inside(const double corners[3][3], const shb_light_source *light,
                         test_random *random, double at[3], double to_light[3]) {
    const double u = random_double(random, 0, 1), v = random_double(random, 0, 1 - u);
    const double position[3] = {light->position.x, light->position.y, light->position.z};
    double squared = 0;
    for (int k = 0; k < 3; k++) {
        at[k] = corners[0][k] +
                (u * (corners[1][k] - corners[0][k]) + v * (corners[2][k] - corners[0][k]));
        to_light[k] = position[k] - light->w * at[k];
        squared += to_light[k] * to_light[k];
    }
    for (int k = 0; k < 3; k++)
        to_light[k] /= sqrt(squared);
}

/* The sine of the angle between a triangle and a direction. */
static double steepness(const double corners[3][3], const double direction[3]) {
    double a[3], b[3], along = 0, squared = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = corners[1][k] - corners[0][k];
        b[k] = corners[2][k] - corners[0][k];
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double n = a[i] * b[j] - a[j] * b[i];
        along += n * direction[k];
        squared += n * n;
    }
    return fabs(along) / sqrt(squared);
}

static void check_plane(const shb_world_plane *plane, const double corners[3][3],
                        const shb_light_source *light, test_random *random, plane_counts *counts) {
    double at[3], to_light[3], moved[3], rounding;
    place_inside(corners, light, random, at, to_light);
    if (isnan(plane->offset)) {
        CHECK(steepness(corners, to_light) < 1e-6);
        return;
    }
    const double on = distance_behind(plane, at, &rounding);
    CHECK(fabs(on) <= 1 + rounding);
    counts->held++;
    if (steepness(corners, to_light) < 1e-3)
        return;
    for (int side = -1; side <= 1; side += 2) {
        for (int k = 0; k < 3; k++)
            moved[k] = at[k] - 1e-6 * side * to_light[k];
        CHECK(distance_behind(plane, moved, &rounding) * side > 1 + rounding);
    }
    counts->sided++;
}

static void check_light(shb_isa isa, const shb_view *view, const shb_mat4 *transform,
                        plane_counts *counts) {
    test_random random = {(uint64_t)isa + 1};
    soup s = {.transform = *transform};
    shb_map *map;
    shb_context *context;
    const shb_context_desc desc = {.max_isa = isa};
    const shb_map_desc map_desc = {
        .view = *view, .width = 64, .occluders = SHB_OCCLUDERS_TRIANGLES};
    for (int i = 0; i < TRIANGLES; i++) {
        float corners[3][3];
        const double size = ldexp(1, -(int)random_below(&random, 10));
        for (int k = 0; k < 9; k++)
            corners[k / 3][k % 3] =
                (k < 3 ? 0 : corners[0][k % 3]) +
                (float)random_double(&random, -0.4, 0.4) * (k < 3 ? 1 : (float)size);
        soup_add(&s, corners[0], corners[1], corners[2]);
    }
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&s), NULL, NULL), SHB_OK);
    for (uint32_t t = 0; t < s.count; t++) {
        double corners[3][3];
        for (int k = 0; k < 3; k++) {
            const float *p = s.positions + 9 * (size_t)t + 3 * k;
            const shb_vec3 world = shb_mat4_transform_point(
                *transform, (shb_vec3){(double)p[0], (double)p[1], (double)p[2]});
            corners[k][0] = world.x;
            corners[k][1] = world.y;
            corners[k][2] = world.z;
        }
        check_plane(&map->occluders.world_planes[t], (const double(*)[3])corners, &map->info.light,
                    &random, counts);
    }
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(planes_in_the_world_hold_their_triangles_and_tell_the_side_of_the_light) {
    const shb_mat4 still = shb_mat4_identity();
    shb_mat4 mirrored = still;
    mirrored.m[0] = -0.75;
    mirrored.m[4] = 0.3;
    mirrored.m[12] = 0.1;
    for (int isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa++) {
        plane_counts counts = {0, 0};
        for (int reversed = 0; reversed < 2; reversed++) {
            const shb_view views[] = {probe_orthographic(reversed), probe_perspective(reversed)};
            for (int k = 0; k < 2; k++) {
                check_light((shb_isa)isa, &views[k], &still, &counts);
                check_light((shb_isa)isa, &views[k], &mirrored, &counts);
            }
        }
        CHECK(counts.held > 7 * TRIANGLES && counts.sided > 7 * TRIANGLES);
    }
}
