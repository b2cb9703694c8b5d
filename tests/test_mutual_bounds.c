/* The exact method in taps: its bounds, which are sums of few floats, against those in double that
 * they stand for. The kernel is that of one lane. */
#include "../src/exact.h"
#include "../src/project.h"
#include "../src/taps.h"
#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define WIDE 1
#define ALWAYS_INLINE __attribute__((always_inline))
#define NEVER_INLINE __attribute__((noinline))
#include "../src/kernels/wide_scalar.h"

#include "../src/kernels/vectors.h"

#include "../src/kernels/k_mutual.inl"

enum { COUNT = 64 };

typedef struct tap_light {
    shb_context *context;
    shb_map *map;
    shb_vec3 center;
    bool affine;
} tap_light;

/* A light that looks at a scene of size 2 so far from the origin; kind 0 is orthographic, 1 a spot,
 * 2 a spot with reversed depth. */
static tap_light open_light(test_random *random, int kind, double offset, shb_occluders occluders) {
    tap_light light = {.center = shb_vec3_scale(random_direction(random), offset),
                       .affine = kind == 0};
    const shb_vec3 eye = shb_vec3_add(light.center, shb_vec3_scale(random_direction(random), 3));
    shb_map_desc desc = {.width = 1024, .height = 256, .occluders = occluders};
    if (light.affine)
        CHECK(!shb_view_orthographic(eye, light.center, (shb_vec3){0, 0, 1}, 2, 2, 0.5, 6, false,
                                     &desc.view));
    else
        CHECK(!shb_view_perspective(eye, light.center, (shb_vec3){0, 0, 1}, 1.2, 1, 0.5, 6,
                                    kind == 2, &desc.view));
    light.context = test_context(0, SHB_ISA_SCALAR);
    CHECK(!shb_map_create(light.context, &desc, &light.map));
    return light;
}

static void close_light(tap_light *light) {
    shb_map_destroy(light->map);
    shb_context_destroy(light->context);
}

/* A fragment of a batch, as doubles see it. */
static shb_exact_fragment fragment_at(const mutual_batch *batch, size_t i) {
    const shb_receivers *r = &batch->receivers;
    const double position[3] = {(double)r->x[i], (double)r->y[i], (double)r->z[i]};
    const double normal[3] = {(double)r->normal_x[i], (double)r->normal_y[i],
                              (double)r->normal_z[i]};
    return shb_exact_fragment_of(&batch->map->rows, position, normal);
}

static void set_fragment(mutual_batch *batch, size_t i, shb_vec3 position, shb_vec3 normal) {
    shb_receivers *r = &batch->receivers;
    r->x[i] = (float)position.x;
    r->y[i] = (float)position.y;
    r->z[i] = (float)position.z;
    r->normal_x[i] = (float)normal.x;
    r->normal_y[i] = (float)normal.y;
    r->normal_z[i] = (float)normal.z;
    const shb_light_point point = fragment_at(batch, i).point;
    r->texel_x[i] = (int32_t)floor(point.x);
    r->texel_y[i] = (int32_t)floor(point.y);
    r->to_center_x[i] = (float)(floor(point.x) + 0.5 - point.x);
    r->to_center_y[i] = (float)(floor(point.y) + 0.5 - point.y);
    r->depth[i] = (float)point.z;
}

/* Points of the scene on planes of any slope. */
static void fill(mutual_batch *batch, const tap_light *light, test_random *random) {
    memset(batch, 0, sizeof *batch);
    batch->map = light->map;
    for (size_t i = 0; i < COUNT; i++) {
        const shb_vec3 away = shb_vec3_scale(random_direction(random), 0.9);
        set_fragment(batch, i, shb_vec3_add(light->center, away), random_direction(random));
        batch->reach[i] = (float)random_double(random, 0.5, 40);
    }
    find_bounds(light->affine, COUNT, batch);
}

static double moved_along(const double axis[3], const shb_light_point *point, double error) {
    return shb_dot_abs(axis, point->by_position) + error;
}

/* A way to a texel's centre, at most a half, is rounded by up to 2^-26. */
TEST(bounds_of_taps_are_not_below_those_in_double) {
    static mutual_batch batch;
    static const double offsets[] = {0, 10, 1e3, 1e5};
    test_random random = {71};
    for (int n = 0; n < 60; n++) {
        tap_light light = open_light(&random, n % 3, offsets[n % 4], SHB_OCCLUDERS_PLANES);
        fill(&batch, &light, &random);
        for (size_t i = 0; i < COUNT; i++) {
            const shb_exact_fragment f = fragment_at(&batch, i);
            const shb_light_point *p = &f.point;
            CHECK((double)batch.moved_x[i] >= moved_along(p->a, p, p->error_x) + 0x1p-26);
            CHECK((double)batch.moved_y[i] >= moved_along(p->b, p, p->error_y) + 0x1p-26);
            CHECK((double)batch.moved_z[i] >= moved_along(p->c, p, p->error_z));
            CHECK((double)batch.error[i] >= f.error);
            CHECK((double)batch.slope_error[i] >= f.slopes.error_x + f.slopes.error_y);
        }
        close_light(&light);
    }
}

/* What a fragment's plane may be off by anywhere within its reach. */
static double plane_error(const mutual_batch *batch, size_t i) {
    return (double)batch->error[i] + (double)batch->slope_error[i] * (double)batch->reach[i];
}

/* Planes are written before the true ones where the map keeps planes, and behind them by what its
 * depths are off by as well, 5 * 2^-24 of them, where it keeps triangles. */
TEST(planes_for_taps_lie_on_the_sure_side_of_the_true_ones) {
    static mutual_batch batch;
    static const shb_occluders kinds[] = {SHB_OCCLUDERS_PLANES, SHB_OCCLUDERS_TRIANGLES};
    test_random random = {72};
    for (int n = 0; n < 60; n++) {
        const bool before = n % 2 == 0;
        tap_light light = open_light(&random, n % 3, 0, kinds[n % 2]);
        fill(&batch, &light, &random);
        /* of planes that are known well, so that rounding counts */
        memset(batch.error, 0, sizeof batch.error);
        shb_receivers *r = &batch.receivers;
        float slopes[2][COUNT];
        memcpy(slopes[0], r->step_x, sizeof slopes[0]);
        memcpy(slopes[1], r->step_y, sizeof slopes[1]);
        write_mutual_planes(&batch, COUNT);
        for (size_t i = 0; i < COUNT; i++) {
            const double error = plane_error(&batch, i), z = (double)r->depth[i];
            const int reach = (int)batch.reach[i];
            for (int k = 0; k < 4 && r->ref[i] > -INFINITY; k++) {
                const float m = (float)(k & 1 ? reach : -reach),
                            t = (float)(k & 2 ? reach : -reach);
                const double tap =
                    (double)shb_tap_depth(r->ref[i], r->step_x[i], r->step_y[i], m, t);
                const double plane =
                    z + (double)slopes[0][i] * ((double)m + (double)r->to_center_x[i]) +
                    (double)slopes[1][i] * ((double)t + (double)r->to_center_y[i]);
                if (before)
                    CHECK(tap <= plane - error);
                else
                    CHECK(tap >= plane + error + 5 * 0x1p-24 * fabs(plane));
            }
        }
        close_light(&light);
    }
}

/* A plane that the light may see edge-on has nothing in front of it; one without a normal faces
 * the light. */
TEST(planes_that_are_parallel_to_the_ray_have_nothing_in_front_of_them) {
    static mutual_batch batch;
    static const shb_occluders kinds[] = {SHB_OCCLUDERS_PLANES, SHB_OCCLUDERS_TRIANGLES};
    for (int k = 0; k < 2; k++) {
        shb_map *map;
        shb_context *context = test_context(0, SHB_ISA_SCALAR);
        const shb_map_desc desc = {
            .view = probe_orthographic(false), .width = 64, .occluders = kinds[k]};
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        memset(&batch, 0, sizeof batch);
        batch.map = map;
        const shb_vec3 normals[] = {
            {1, 0, 0}, {0.8, 0.6, 1e-9}, {0, 0, 0}, {(double)NAN, 0, 1}, {1e30, 0, 1e30}};
        for (size_t i = 0; i < 5; i++) {
            set_fragment(&batch, i, (shb_vec3){0.25, 0.5, 1}, normals[i]);
            batch.reach[i] = 3;
        }
        find_bounds(true, 5, &batch);
        write_mutual_planes(&batch, 5);
        const shb_receivers *r = &batch.receivers;
        for (size_t i = 0; i < 5; i++) {
            CHECK(r->step_x[i] == 0 && r->step_y[i] == 0);
            if (i < 2)
                CHECK(r->ref[i] == -INFINITY);
            else
                CHECK_NEAR(r->ref[i], (4 - 1) / 8.0, 1e-5);
        }
        shb_map_destroy(map);
        shb_context_destroy(context);
    }
}

/* A point, as far as it matters to the planes of occluders, and a texel with its plane. */
typedef struct passing {
    const shb_map *map;
    float z, moved[3], to[2], stored;
    uint32_t texel;
} passing;

static bool passes(const passing *p) {
    static mutual_batch batch;
    const float unit = step_unit(p->map);
    batch.map = p->map;
    batch.receivers.depth[0] = p->z;
    batch.moved_z[0] = p->moved[2];
    batch.reach[0] = fmaxf(fabsf(p->to[0]), fabsf(p->to[1]));
    write_mutual_planes(&batch, 1);
    const mutual_way x = mutual_way_of(vf_splat(p->moved[0]), vf_splat(p->to[0]), unit);
    const mutual_way y = mutual_way_of(vf_splat(p->moved[1]), vf_splat(p->to[1]), unit);
    return vi_any(passes_in_front(vf_splat(p->z), vf_load(batch.base), &x, &y, vf_splat(p->stored),
                                  (vu)vi_splat((int32_t)p->texel)));
}

/* What the way along an axis may add to the depth between a texel's centre and a point: where the
 * point lies, and half of a step of the slope. */
static double unsure_rise(double slope, double step, float moved, float to) {
    return fabs(slope) * (double)moved + step / 2 * fabs((double)to);
}

/* A point that lies on the plane, but for what all of its numbers may be off by, is not in shadow;
 * one that lies behind it by some more is. */
TEST(planes_of_occluders_shadow_what_lies_surely_behind_them) {
    test_random random = {73};
    tap_light light = open_light(&random, 0, 0, SHB_OCCLUDERS_PLANES);
    const double unit = light.map->occluders.slope_unit;
    for (int n = 0; n < 4000; n++) {
        const double size = ldexp(1, (int)random_below(&random, 36) - 1);
        const uint32_t slopes =
            shb_slopes_of(random_double(&random, -size, size), random_double(&random, -size, size));
        const double step = unit * shb_slopes_step(slopes);
        const double slope_x = unit * shb_slope_x(slopes), slope_y = unit * shb_slope_y(slopes);
        passing p = {.map = light.map,
                     .stored = (float)random_double(&random, 0, n % 2 ? 1 : 1e-3),
                     .texel = slopes};
        for (int k = 0; k < 2; k++) {
            p.moved[k] = (float)random_double(&random, 0, 0.25);
            p.to[k] = (float)random_double(&random, -20, 20);
        }
        p.moved[2] = n % 3 ? 0 : 0x1p-20f;
        const double rise = slope_x * (double)p.to[0] + slope_y * (double)p.to[1];
        const double unsure = (double)p.moved[2] + unsure_rise(slope_x, step, p.moved[0], p.to[0]) +
                              unsure_rise(slope_y, step, p.moved[1], p.to[1]);
        const double plane = (double)p.stored - rise;
        p.z = (float)(plane + unsure * (1 - 0x1p-22));
        CHECK(!passes(&p));
        p.z = (float)(plane + 1.02 * unsure + 0x1p-22 * fabs(plane));
        CHECK(passes(&p));
        p.z = 1e30f;
        p.texel = SHB_SLOPES_NONE;
        CHECK(!passes(&p));
    }
    close_light(&light);
}
