/* The bound that takes the place of every epsilon: random triangles, points on them and lights. The
 * truth comes from a plane solved in more than twice the precision. */
#include "../src/corner_errors.h"
#include "../src/exact.h"
#include "../src/map.h"
#include "contexts.h"
#include "oracle.h"
#include "random.h"
#include "soup.h"
#include "test.h"

#include "shadowbias/clusters.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct bound_light {
    shb_context *context;
    shb_map *map;
    shb_vec3 center;
} bound_light;

/* Around a scene of size 2 at this distance from the origin; kind 0 is orthographic, 1 a spot, 2 a
 * spot with reversed depth. */
static void open_light(bound_light *light, test_random *random, int kind, double offset,
                       shb_format format) {
    const double distance = 3;
    light->center = shb_vec3_scale(random_direction(random), offset);
    const shb_vec3 eye =
        shb_vec3_add(light->center, shb_vec3_scale(random_direction(random), distance));
    shb_map_desc desc = {
        .width = 256u << random_below(random, 6), .height = 16, .occluders = SHB_OCCLUDERS_PLANES};
    desc.format = format;
    if (kind == 0)
        CHECK(!shb_view_orthographic(eye, light->center, (shb_vec3){0, 0, 1}, 2, 2, 0.5, 6, false,
                                     &desc.view));
    else
        CHECK(!shb_view_perspective(eye, light->center, (shb_vec3){0, 0, 1}, 1.2, 1, 0.5, 6,
                                    kind == 2, &desc.view));
    light->context = test_context(0, SHB_ISA_BEST);
    CHECK(!shb_map_create(light->context, &desc, &light->map));
}

static void close_light(bound_light *light) {
    shb_map_destroy(light->map);
    shb_context_destroy(light->context);
}

/* A triangle that meets the light's rays at up to 89.9 degrees, down to slivers of a thousandth. */
static void random_corners(test_random *random, const bound_light *light, float corners[3][3]) {
    const double size = ldexp(1, -(int)random_below(random, 8));
    const double thin = ldexp(1, -(int)random_below(random, 11));
    const shb_vec3 along = shb_vec3_scale(random_direction(random), size);
    const shb_vec3 across = shb_vec3_scale(
        shb_vec3_normalize(shb_vec3_cross(along, random_direction(random))), size * thin);
    const shb_vec3 start =
        shb_vec3_add(light->center, shb_vec3_scale(random_direction(random), 0.5));
    const shb_vec3 exact[3] = {start, shb_vec3_add(start, along), shb_vec3_add(start, across)};
    for (int k = 0; k < 3; k++) {
        corners[k][0] = (float)exact[k].x;
        corners[k][1] = (float)exact[k].y;
        corners[k][2] = (float)exact[k].z;
    }
}

static shb_vec3 widen(const float p[3]) {
    return (shb_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

/* Map coordinates of a corner by the rows, in oracle precision. */
static void project(const shb_light_rows *rows, shb_vec3 p, oracle_real out[3]) {
    const oracle_real x = oracle_exact(p.x), y = oracle_exact(p.y), z = oracle_exact(p.z);
    const double *const all[3] = {rows->x, rows->y, rows->z};
    const oracle_real w = oracle_exact(rows->w[0]) * x + oracle_exact(rows->w[1]) * y +
                          oracle_exact(rows->w[2]) * z + oracle_exact(rows->w[3]);
    for (int k = 0; k < 3; k++)
        out[k] = (oracle_exact(all[k][0]) * x + oracle_exact(all[k][1]) * y +
                  oracle_exact(all[k][2]) * z + oracle_exact(all[k][3])) /
                 w;
}

/* The depth of the plane through three places at (x, y). */
static oracle_real plane_depth(oracle_real p[3][3], double x, double y) {
    const oracle_real ax = p[1][0] - p[0][0], ay = p[1][1] - p[0][1], az = p[1][2] - p[0][2];
    const oracle_real bx = p[2][0] - p[0][0], by = p[2][1] - p[0][1], bz = p[2][2] - p[0][2];
    const oracle_real area = ax * by - ay * bx;
    const oracle_real gx = (az * by - ay * bz) / area, gy = (ax * bz - az * bx) / area;
    return p[0][2] + gx * (oracle_exact(x) - p[0][0]) + gy * (oracle_exact(y) - p[0][1]);
}

/* How far the fragment's plane misses the true one at the centre of its texel, over the bound; -1
 * for a triangle steeper than 89.9 degrees. */
static double miss(const bound_light *light, test_random *random, const float floats[3][3]) {
    const shb_vec3 corners[3] = {widen(floats[0]), widen(floats[1]), widen(floats[2])};
    const shb_vec3 first = shb_vec3_subtract(corners[1], corners[0]);
    const shb_vec3 second = shb_vec3_subtract(corners[2], corners[0]);
    const shb_vec3 normal = shb_vec3_normalize(shb_vec3_cross(first, second));
    const double b = random_double(random, 0, 1), c = random_double(random, 0, 1 - b);
    const shb_vec3 point =
        shb_vec3_add(corners[0], shb_vec3_add(shb_vec3_scale(first, b), shb_vec3_scale(second, c)));
    const shb_light_source *source = &light->map->info.light;
    const shb_vec3 to_light =
        shb_vec3_normalize(shb_vec3_subtract(source->position, shb_vec3_scale(point, source->w)));
    if (fabs(shb_vec3_dot(normal, to_light)) < 0.001745)
        return -1;
    const double p[3] = {oracle_float(point.x), oracle_float(point.y), oracle_float(point.z)};
    const double n[3] = {oracle_float(normal.x), oracle_float(normal.y), oracle_float(normal.z)};
    const shb_exact_fragment fragment = shb_exact_fragment_of(&light->map->rows, p, n);
    const double x = floor(fragment.point.x) + 0.5, y = floor(fragment.point.y) + 0.5;
    const double to_x = x - fragment.point.x, to_y = y - fragment.point.y;
    const double bound = fragment.error + fragment.slopes.error_x * fabs(to_x) +
                         fragment.slopes.error_y * fabs(to_y);
    const double depth = fragment.point.z + (fragment.slopes.x * to_x + fragment.slopes.y * to_y);
    oracle_real places[3][3];
    for (int k = 0; k < 3; k++)
        project(&light->map->rows, corners[k], places[k]);
    return fabs((double)(oracle_exact(depth) - plane_depth(places, x, y))) / bound;
}

/* Half of SHB_BOUND_SAMPLES in each test; then they also tell how sharp the bound is. */
static long wanted_samples(long usual) {
    const char *wanted = getenv("SHB_BOUND_SAMPLES");
    return wanted ? atol(wanted) / 2 : usual;
}

static const double offsets[] = {0, 2, 200, 20000};

/* Misses as parts of their bounds. */
typedef struct miss_count {
    long tested, violations;
    double largest;
} miss_count;

/* A negative ratio is none. */
static void count_miss(miss_count *misses, double ratio) {
    misses->tested += ratio >= 0;
    misses->violations += ratio > 1;
    misses->largest = ratio > misses->largest ? ratio : misses->largest;
}

static void check_misses(const miss_count *misses) {
    test_check(misses->violations == 0, __FILE__, __LINE__, "%ld of %ld beyond the bound, up to %g",
               misses->violations, misses->tested, misses->largest);
}

TEST(no_fragment_misses_its_plane_by_more_than_the_bound) {
    const long samples = wanted_samples(250000) / 4;
    test_random random = {11};
    miss_count misses = {0};
    for (int lights = 0; lights < 48; lights++) {
        bound_light light;
        open_light(&light, &random, lights % 3, offsets[lights / 3 % 4], SHB_FORMAT_FLOAT32);
        for (long i = 0; i < samples / 48; i++) {
            float corners[3][3];
            random_corners(&random, &light, corners);
            for (int k = 0; k < 4; k++)
                count_miss(&misses, miss(&light, &random, (const float(*)[3])corners));
        }
        close_light(&light);
    }
    check_misses(&misses);
    if (getenv("SHB_BOUND_SAMPLES"))
        printf("%ld points on planes, at most %g of the bound\n", misses.tested, misses.largest);
    test_check(misses.largest > 0.5, __FILE__, __LINE__, "the bound is loose: %g at most",
               misses.largest);
    CHECK(misses.tested > samples);
}

enum { OWN_POINTS = 256 };

/* Points on a triangle as a host has them: positions and normals in floats. */
static void random_points(test_random *random, const float floats[3][3],
                          float positions[3 * OWN_POINTS], float normals[3 * OWN_POINTS]) {
    const shb_vec3 corner = widen(floats[0]);
    const shb_vec3 first = shb_vec3_subtract(widen(floats[1]), corner);
    const shb_vec3 second = shb_vec3_subtract(widen(floats[2]), corner);
    const shb_vec3 normal = shb_vec3_normalize(shb_vec3_cross(first, second));
    for (int i = 0; i < OWN_POINTS; i++) {
        const double b = random_double(random, 0, 1), c = random_double(random, 0, 1 - b);
        const shb_vec3 way = shb_vec3_add(shb_vec3_scale(first, b), shb_vec3_scale(second, c));
        const shb_vec3 point = shb_vec3_add(corner, way);
        positions[3 * i] = (float)point.x;
        positions[3 * i + 1] = (float)point.y;
        positions[3 * i + 2] = (float)point.z;
        normals[3 * i] = (float)normal.x;
        normals[3 * i + 1] = (float)normal.y;
        normals[3 * i + 2] = (float)normal.z;
    }
}

/* True unless the texel that holds the point holds a depth in front of the triangle's plane at the
 * texel's centre. */
static bool is_stored_behind(const shb_map *map, const float floats[3][3], const float p[3]) {
    const double position[3] = {(double)p[0], (double)p[1], (double)p[2]};
    const shb_light_point point = shb_light_point_at(&map->rows, position, 0);
    const bool inside =
        point.x >= 0 && point.x < map->info.width && point.y >= 0 && point.y < map->info.height;
    if (!inside)
        return true;
    const int32_t column = (int32_t)point.x, row = (int32_t)point.y;
    float depth;
    shb_map_fetch(map, 1, &column, &row, &depth);
    if (depth == (map->info.view.reversed ? 0.0f : 1.0f))
        return true;
    oracle_real places[3][3];
    for (int k = 0; k < 3; k++)
        project(&map->rows, widen(floats[k]), places[k]);
    return oracle_exact((double)depth) >= plane_depth(places, column + 0.5, row + 0.5);
}

/* What a map stores of a triangle, in any format, against points of the same triangle. */
TEST(no_triangle_shadows_itself_in_any_format) {
    const long draws = wanted_samples(100000) / OWN_POINTS / 36;
    const shb_bias exact = shb_bias_exact();
    static float positions[3 * OWN_POINTS], normals[3 * OWN_POINTS], visibility[OWN_POINTS];
    test_random random = {12};
    long asked = 0, shadowed = 0, in_front = 0;
    for (int lights = 0; lights < 36; lights++) {
        bound_light light;
        open_light(&light, &random, lights % 3, offsets[lights / 3 % 4], (shb_format)(lights / 12));
        for (long i = 0; i < draws; i++) {
            float corners[3][3];
            random_corners(&random, &light, corners);
            random_points(&random, (const float(*)[3])corners, positions, normals);
            soup s = {0};
            soup_add(&s, corners[0], corners[1], corners[2]);
            CHECK(!shb_map_draw(light.map, soup_scene(&s), NULL, NULL));
            const shb_points points = {
                .count = OWN_POINTS, .positions = positions, .normals = normals};
            CHECK(!shb_map_visibility(light.map, &points, &exact, NULL, visibility));
            for (int k = 0; k < OWN_POINTS; k++)
                shadowed += visibility[k] != 1;
            asked += OWN_POINTS;
            for (int k = 0; k < OWN_POINTS; k += OWN_POINTS / 16)
                in_front +=
                    !is_stored_behind(light.map, (const float(*)[3])corners, positions + 3 * k);
            soup_free(&s);
        }
        close_light(&light);
    }
    test_check(in_front == 0, __FILE__, __LINE__, "%ld depths lie in front of their planes",
               in_front);
    test_check(shadowed == 0, __FILE__, __LINE__, "%ld of %ld in their own shadow", shadowed,
               asked);
    if (getenv("SHB_BOUND_SAMPLES"))
        printf("%ld points on drawn triangles, %ld in their own shadow\n", asked, shadowed);
}

/* The light's target, and an instance whose transform leaves its triangles where they were in the
 * world, but for the rounding of their positions to floats. */
typedef struct bound_window {
    shb_target target;
    shb_draw_instance instance;
    shb_mesh mesh;
    float positions[9];
} bound_window;

static void open_window(bound_window *window, const bound_light *light, test_random *random,
                        const float corners[3][3]) {
    const shb_map_info *info = &light->map->info;
    const double scale = random_double(random, 0.5, 4), shear = random_double(random, -2, 2);
    const shb_vec3 move = shb_vec3_scale(random_direction(random), random_double(random, 0, 100));
    *window =
        (bound_window){.target = shb_target_of(info->width, info->height, info->view.reversed)};
    for (int k = 0; k < 3; k++) {
        float *p = &window->positions[3 * k];
        p[1] = (float)(((double)corners[k][1] - move.y) / scale);
        p[2] = (float)(((double)corners[k][2] - move.z) / scale);
        p[0] = (float)(((double)corners[k][0] - move.x - shear * (double)p[1]) / scale);
    }
    window->mesh =
        (shb_mesh){.positions = window->positions, .vertex_count = 3, .triangle_count = 1};
    shb_draw_instance *instance = &window->instance;
    *instance = (shb_draw_instance){.mesh = &window->mesh,
                                    .world_from_mesh = {{scale, 0, 0, 0, shear, scale, 0, 0, 0, 0,
                                                         scale, 0, move.x, move.y, move.z, 1}},
                                    .keep_positive = true,
                                    .keep_negative = true};
    instance->clip_from_mesh =
        shb_mat4_multiply(info->view.clip_from_world, instance->world_from_mesh);
    for (int column = 0; column < 4 && info->view.reversed; column++)
        instance->clip_from_mesh.m[4 * column + 2] *= -1;
    const double *m = instance->clip_from_mesh.m;
    instance->affine = m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
    instance->corner_errors = shb_corner_errors_of(&window->target, &info->view, instance);
}

/* Map coordinates of a corner, the transform in oracle precision, too. */
static void project_corner(const bound_window *window, const shb_light_rows *rows, int k,
                           oracle_real out[3]) {
    const double *m = window->instance.world_from_mesh.m;
    const float *p = &window->positions[3 * k];
    const double *const all[4] = {rows->x, rows->y, rows->z, rows->w};
    oracle_real world[3], sums[4];
    for (int i = 0; i < 3; i++)
        world[i] = oracle_exact(m[i]) * oracle_exact((double)p[0]) +
                   oracle_exact(m[4 + i]) * oracle_exact((double)p[1]) +
                   oracle_exact(m[8 + i]) * oracle_exact((double)p[2]) + oracle_exact(m[12 + i]);
    for (int i = 0; i < 4; i++)
        sums[i] = oracle_exact(all[i][0]) * world[0] + oracle_exact(all[i][1]) * world[1] +
                  oracle_exact(all[i][2]) * world[2] + oracle_exact(all[i][3]);
    for (int i = 0; i < 3; i++)
        out[i] = sums[i] / sums[3];
}

/* How far the plane through the triangle's window corners misses the true one up to a texel beyond
 * its box, over the bound; -1 for a triangle that is not drawn, -2 for one without a bound. */
static double miss_in_window(const bound_light *light, test_random *random,
                             const float corners[3][3]) {
    bound_window window;
    shb_clip_position clip[3];
    shb_shape shape;
    open_window(&window, light, random, corners);
    shb_geometry_corners(&window.instance, 0, clip);
    if (shb_shape_prepare(&window.target, &window.instance, clip, &shape) != SHB_OUTCOME_DRAWN ||
        shape.is_cut)
        return -1;
    const shb_plane plane = shb_plane_of(&window.target, &shape);
    const double *x = shape.X, *y = shape.Y;
    const int32_t width = shape.samples.last_column - shape.samples.first_column + 1;
    const int32_t height = shape.samples.last_row - shape.samples.first_row + 1;
    const double bound = shb_plane_bound(
        &window.instance.corner_errors,
        (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]), plane.lo,
        fmax(shape.Z[0], fmax(shape.Z[1], shape.Z[2])), width, height, plane.gx, plane.gy);
    if (bound == HUGE_VAL)
        return -2;
    oracle_real places[3][3];
    for (int k = 0; k < 3; k++)
        project_corner(&window, &light->map->rows, k, places[k]);
    double largest = 0;
    for (int i = 0; i < 4; i++) {
        const double at_x = random_double(random, fmin(x[0], fmin(x[1], x[2])) - 1,
                                          fmax(x[0], fmax(x[1], x[2])) + 1);
        const double at_y = random_double(random, fmin(y[0], fmin(y[1], y[2])) - 1,
                                          fmax(y[0], fmax(y[1], y[2])) + 1);
        const oracle_real depth =
            oracle_exact(plane.z0) +
            oracle_exact(plane.gx) *
                (oracle_exact(at_x) - oracle_exact(shape.samples.first_column + 0.5)) +
            oracle_exact(plane.gy) *
                (oracle_exact(at_y) - oracle_exact(shape.samples.first_row + 0.5));
        const double off = fabs((double)(depth - plane_depth(places, at_x, at_y)));
        largest = fmax(largest, off / bound);
    }
    return largest;
}

TEST(no_plane_through_window_corners_misses_its_triangle_by_more_than_the_bound) {
    const long samples = wanted_samples(100000);
    test_random random = {13};
    miss_count misses = {0};
    long unknown = 0;
    for (int lights = 0; lights < 48; lights++) {
        bound_light light;
        open_light(&light, &random, lights % 3, offsets[lights / 3 % 4], SHB_FORMAT_FLOAT32);
        for (long i = 0; i < samples / 48; i++) {
            float corners[3][3];
            random_corners(&random, &light, corners);
            const double ratio = miss_in_window(&light, &random, (const float(*)[3])corners);
            count_miss(&misses, ratio);
            unknown += ratio < -1;
        }
        close_light(&light);
    }
    check_misses(&misses);
    if (getenv("SHB_BOUND_SAMPLES"))
        printf("%ld planes in windows, at most %g of the bound, %ld without one\n", misses.tested,
               misses.largest, unknown);
    CHECK(misses.tested > samples / 64 && unknown > samples / 32);
}

/* One triangle lies far out, on either side and in the first or the last cluster. */
TEST(clusters_have_the_corner_errors_of_their_mesh) {
    enum { TRIANGLES = 400 };
    static float positions[9 * TRIANGLES];
    test_random random = {29};
    bound_light light;
    open_light(&light, &random, 1, 0, SHB_FORMAT_FLOAT32);
    const shb_view *view = &light.map->info.view;
    const shb_target target = shb_target_of(256, 256, false);
    shb_mesh mesh = {
        .positions = positions, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    for (int kind = 0; kind < 4; kind++) {
        for (int i = 0; i < 9 * TRIANGLES; i++)
            positions[i] = (float)random_double(&random, -0.1, 0.1);
        for (int k = 0; k < 3; k++)
            positions[k + (kind & 1 ? 9 * (TRIANGLES - 1) : 0)] = kind & 2 ? -0.5f : 0.5f;
        shb_clusters *clusters = NULL;
        CHECK_INT(shb_clusters_create(light.context, &mesh, &clusters), SHB_OK);
        shb_mesh with = mesh;
        with.clusters = clusters;
        shb_draw_instance instance = {.mesh = &mesh,
                                      .world_from_mesh = shb_mat4_identity(),
                                      .clip_from_mesh = view->clip_from_world};
        const shb_corner_errors expected = shb_corner_errors_of(&target, view, &instance);
        instance.mesh = &with;
        const shb_corner_errors errors = shb_corner_errors_of(&target, view, &instance);
        CHECK(expected.x < 1 && memcmp(&errors, &expected, sizeof errors) == 0);
        shb_clusters_destroy(clusters);
    }
    close_light(&light);
}
