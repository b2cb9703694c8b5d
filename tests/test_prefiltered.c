/* Variance, exponential variance and moment maps: known answers, then those of a slow calculation.
 *
 * Under the orthographic light depth is (4 - z) / 8, and distance is depth. */
#include "depth_map.h"
#include "oracle.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

enum { SIZE = 16 };

static depth_map open_map(const float *depths) {
    return depth_map_open(NULL, &(shb_map_desc){.view = probe_orthographic(false), .width = SIZE},
                          depths);
}

static double z_of(double depth) {
    return 4 - 8 * depth;
}

/* Depth left in the left half of the map and right in the other. */
static void fill_halves(float *depths, float left, float right) {
    for (int i = 0; i < SIZE * SIZE; i++)
        depths[i] = i % SIZE < SIZE / 2 ? left : right;
}

static double ask(const float *depths, shb_filter filter, double x, double depth) {
    depth_map host = open_map(depths);
    depth_map_prepare(&host, &filter);
    const double visibility = depth_map_ask(&host, &filter, x, 1.0 / SIZE, z_of(depth));
    depth_map_close(&host);
    return visibility;
}

/* At x = 0 the boxes of columns 7 and 8 are mixed by halves, with three near columns of five and
 * two: half of all is at 1/4 and half at 3/4. Mean 1/2, variance 1/16. At 3/4 d is 1/4, and the
 * bound 1/16 / (1/16 + 1/16); at 1 it is 1/16 / (1/16 + 1/4) = 1/5. */
TEST(variance_gives_chebyshevs_bound_for_two_depths) {
    float depths[SIZE * SIZE];
    fill_halves(depths, 0.25f, 0.75f);
    CHECK_NEAR(ask(depths, shb_filter_variance(5, 0), 0, 0.75), 0.5, 1e-6);
    CHECK_NEAR(ask(depths, shb_filter_variance(5, 0), 0, 1), 0.2, 1e-6);
    CHECK(ask(depths, shb_filter_variance(5, 0), 0, 0.499) == 1);
    /* in the middle of column 7 two columns of five are at 3/4: 0.24 / 4 over that and 0.3^2 */
    CHECK_NEAR(ask(depths, shb_filter_variance(5, 0), -1.0 / SIZE, 0.75), 0.4, 1e-6);
    /* five columns at 1/4, and outside the sides of the box is nothing of the others */
    CHECK_NEAR(ask(depths, shb_filter_variance(5, 0), -5.0 / SIZE, 0.75), 0, 1e-6);
}

/* (0.5 - 0.2) / (1 - 0.2) = 3/8, and 0.2 is nothing. */
TEST(variance_takes_light_bleeding_away) {
    float depths[SIZE * SIZE];
    fill_halves(depths, 0.25f, 0.75f);
    CHECK_NEAR(ask(depths, shb_filter_variance(5, 0.2f), 0, 0.75), 0.375, 1e-6);
    CHECK(ask(depths, shb_filter_variance(5, 0.21f), 0, 1) == 0);
    CHECK(ask(depths, shb_filter_variance(5, 0.2f), 0, 0.25) == 1);
}

/* Any function of two depths is a distribution on two points, and Chebyshev's bound is met at the
 * farther one. Behind it the smaller bound counts: with w1, w2, t = exp(c (depth - 1/2)), mean m
 * and variance v of w1 and w2 by halves, v / (v + (t - m)^2). */
TEST(exponential_variance_takes_the_smaller_bound) {
    float depths[SIZE * SIZE];
    fill_halves(depths, 0.25f, 0.75f);
    CHECK_NEAR(ask(depths, shb_filter_exponential_variance(5, 20, 10, 0), 0, 0.75), 0.5, 1e-4);
    CHECK_NEAR(ask(depths, shb_filter_exponential_variance(5, 20, 10, 0), -1.0 / SIZE, 0.75), 0.4,
               1e-4);
    const double exponents[] = {2, -3};
    double smaller = 1;
    for (int i = 0; i < 2; i++) {
        const double c = exponents[i], sign = c < 0 ? -1 : 1;
        const double near_w = sign * exp(-0.25 * c), far_w = sign * exp(0.25 * c);
        const double mean = 0.5 * (near_w + far_w), d = sign * exp(0.5 * c) - mean;
        const double variance = 0.25 * (far_w - near_w) * (far_w - near_w);
        const double bound = variance / (variance + d * d);
        smaller = bound < smaller ? bound : smaller;
    }
    CHECK_NEAR(ask(depths, shb_filter_exponential_variance(5, 2, 3, 0), 0, 1), smaller, 1e-5);
}

/* Four moments determine two depths, so the least part below anything between them is exact. */
TEST(moments_are_exact_for_one_and_two_depths) {
    float depths[SIZE * SIZE];
    fill_halves(depths, 0.25f, 0.75f);
    const shb_filter filter = shb_filter_moments(5);
    for (int i = 0; i <= 8; i++) {
        const double between = 0.3 + 0.05 * i;
        CHECK_NEAR(ask(depths, filter, 0, between), 0.5, 1e-4);
        CHECK_NEAR(ask(depths, filter, -1.0 / SIZE, between), 0.4, 1e-4);
    }
    CHECK(ask(depths, filter, 0, 0.25) == 1);
    CHECK(ask(depths, filter, 0, 0.2) == 1);
    CHECK_NEAR(ask(depths, filter, 0, 0.8), 0, 1e-4);
    fill_halves(depths, 0.5f, 0.5f);
    CHECK(ask(depths, filter, 0, 0.5) == 1);
    CHECK(ask(depths, filter, 0, 0.4999) == 1);
    CHECK_NEAR(ask(depths, filter, 0, 0.5001), 0, 1e-4);
}

enum { KINDS = 6 };

static shb_filter filter_of(int index) {
    static const char *const names[KINDS] = {
        "variance",      "exponential-variance",      "moments",
        "variance-soft", "exponential-variance-soft", "moments-soft"};
    shb_filter filter = {0};
    CHECK_INT(shb_filter_parse(names[index], &filter), SHB_OK);
    return filter;
}

/* Nine texels of the box around the corner texel lie in the map, at 1/4; sixteen at the far plane.
 * At the farther of two depths every bound is exact. */
TEST(boxes_hold_the_far_plane_outside_the_map) {
    float depths[SIZE * SIZE];
    fill_halves(depths, 0.25f, 0.25f);
    const shb_filter filters[] = {shb_filter_variance(5, 0),
                                  shb_filter_exponential_variance(5, 10, 5, 0),
                                  shb_filter_moments(5)};
    for (int i = 0; i < 3; i++) {
        depth_map host = open_map(depths);
        depth_map_prepare(&host, &filters[i]);
        const double corner = 1 - 1.0 / SIZE;
        CHECK_NEAR(depth_map_ask(&host, &filters[i], -corner, corner, z_of(0.9999)), 16 / 25.0,
                   1e-3);
        CHECK_NEAR(depth_map_ask(&host, &filters[i], corner, -corner, z_of(0.9999)), 16 / 25.0,
                   1e-3);
        CHECK(depth_map_ask(&host, &filters[i], -1.001, 0, z_of(0.9)) == 1);
        CHECK(depth_map_ask(&host, &filters[i], 0, 1.001, z_of(0.9)) == 1);
        CHECK(depth_map_ask(&host, &filters[i], 0, 0, z_of(0.9)) < 0.01);
        depth_map_close(&host);
    }
}

TEST(nothing_in_front_is_exactly_lit) {
    float depths[SIZE * SIZE];
    for (int i = 0; i < 4 * KINDS; i++) {
        const int reversed = i & 1, spot = i >> 1 & 1;
        const shb_view view = spot ? probe_perspective(reversed) : probe_orthographic(reversed);
        const shb_filter filter = filter_of(i / 4);
        fill_halves(depths, 1, 1);
        depth_map host = depth_map_open(NULL, &(shb_map_desc){.view = view, .width = SIZE}, depths);
        depth_map_prepare(&host, &filter);
        for (int k = -40; k <= 80; k++)
            CHECK(depth_map_ask(&host, &filter, 0.011 * k, 0.3, -0.1 * k) == 1);
        depth_map_close(&host);
        fill_halves(depths, 0.5f, 0.75f);
        host = depth_map_open(NULL, &(shb_map_desc){.view = view, .width = SIZE}, depths);
        depth_map_prepare(&host, &filter);
        const double behind = spot ? 2.51 : 0.01;
        for (int k = 0; k < 10; k++)
            CHECK(depth_map_ask(&host, &filter, 0.02 * k - 0.1, 0.3, behind + 0.1 * k) == 1);
        depth_map_close(&host);
    }
}

static void write_nan(const shb_bias_args *args) {
    for (size_t i = 0; i < args->count; i++)
        args->receivers->ref[i] = args->receivers->step_x[i] = args->receivers->step_y[i] = NAN;
}

static double ask_without_plane(const depth_map *host, const shb_filter *filter) {
    const shb_bias undefined = {.name = "undefined", .depth = write_nan};
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, 0}};
    float visibility = -7;
    CHECK_INT(shb_map_visibility(host->map, &points, &undefined, filter, &visibility), SHB_OK);
    return (double)visibility;
}

TEST(fragments_and_texels_that_are_no_number_are_lit) {
    float depths[SIZE * SIZE];
    for (int i = 0; i < KINDS; i++) {
        const shb_filter filter = filter_of(i);
        fill_halves(depths, 0.25f, 0.25f);
        depth_map host = open_map(depths);
        depth_map_prepare(&host, &filter);
        CHECK(depth_map_ask(&host, &filter, 0, 0, 0) < 0.01);
        CHECK(depth_map_ask(&host, &filter, 0, 0, (double)NAN) == 1);
        CHECK(depth_map_ask(&host, &filter, (double)NAN, 0, 0) == 1);
        CHECK(ask_without_plane(&host, &filter) == 1);
        CHECK(depth_map_ask(&host, &filter, 0, HUGE_VAL, 0) == 1);
        float *texels = host.texels;
        for (int k = 0; k < SIZE * SIZE; k++)
            texels[k] = k % 3 == 0 ? NAN : k % 3 == 1 ? 1.0f : HUGE_VALF;
        depth_map_prepare(&host, &filter);
        CHECK(depth_map_ask(&host, &filter, 0, 0, 0) == 1);
        CHECK(depth_map_ask(&host, &filter, 0, 0, -100) == 1);
        depth_map_close(&host);
    }
}

/* ---- against a slow calculation ---- */

enum { WIDTH = 20, HEIGHT = 13 };

/* Raw moments of a warped distance, averaged over a box around the fragment with weights of the
 * bilinear mixture. */
typedef struct raw {
    long double m[5];
} raw;

static double warp(double exponent, double x) {
    return exponent == 0 ? x : (exponent < 0 ? -1 : 1) * exp(exponent * (x - 0.5));
}

static double tent(double x) {
    const double size = fabs(x);
    return size < 1 ? 1 - size : 0;
}

static raw raw_moments(const float *depths, int size, double column, double row, double exponent) {
    raw sum = {{0}};
    for (int y = -40; y < HEIGHT + 40; y++)
        for (int x = -40; x < WIDTH + 40; x++) {
            const bool inside = x >= 0 && x < WIDTH && y >= 0 && y < HEIGHT;
            const double distance = inside ? (double)depths[y * WIDTH + x] : 1;
            double weight = 0;
            for (int j = -1; j <= HEIGHT; j++)
                for (int i = -1; i <= WIDTH; i++)
                    if (abs(x - i) <= size / 2 && abs(y - j) <= size / 2)
                        weight += tent(column - i - 0.5) * tent(row - j - 0.5);
            const long double value = (long double)warp(exponent, distance);
            long double power = (long double)weight / size / size;
            for (int k = 0; k < 5; k++, power *= value)
                sum.m[k] += power;
        }
    return sum;
}

static double slow_bound(const raw *box, double t) {
    const long double variance = box->m[2] - box->m[1] * box->m[1];
    const long double d = (long double)t - box->m[1];
    return d > 0 ? (double)(variance / (variance + d * d)) : 1;
}

static long double determinant(const long double a[3], const long double b[3],
                               const long double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Peters and Klein's algorithm 3 as it is printed, by Cramer's rule: the part below t, and from it
 * what is lit. */
static double slow_hamburger(const raw *box, long double t) {
    const long double *m = box->m;
    const long double a[3] = {1, m[1], m[2]}, b[3] = {m[1], m[2], m[3]}, c[3] = {m[2], m[3], m[4]};
    const long double right[3] = {1, t, t * t};
    const long double whole = determinant(a, b, c);
    const long double c0 = determinant(right, b, c) / whole;
    const long double c1 = determinant(a, right, c) / whole;
    const long double c2 = determinant(a, b, right) / whole;
    const long double p = c1 / c2, q = c0 / c2, root = sqrtl(p * p / 4 - q);
    const long double z2 = -p / 2 - root, z3 = -p / 2 + root;
    if (t <= z2)
        return 1;
    if (t <= z3)
        return (double)(1 - (t * z3 - m[1] * (t + z3) + m[2]) / ((z3 - z2) * (t - z2)));
    return (double)((z2 * z3 - m[1] * (z2 + z3) + m[2]) / ((t - z2) * (t - z3)));
}

static double slow_answer(int method, const float *depths, int size, double column, double row,
                          double t) {
    if (method == 2) {
        const raw box = raw_moments(depths, size, column, row, 0);
        return slow_hamburger(&box, (long double)t);
    }
    const double exponents[2] = {method == 1 ? 6 : 0, method == 1 ? -4 : 0};
    double lit = 1;
    for (int i = 0; i < 2; i++) {
        const raw box = raw_moments(depths, size, column, row, exponents[i]);
        const double bound = slow_bound(&box, warp(exponents[i], t));
        lit = bound < lit ? bound : lit;
    }
    return lit;
}

TEST(answers_are_those_of_a_slow_calculation) {
    test_random random = {31};
    float depths[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        depths[i] = (float)random_double(&random, 0.2, random_below(&random, 2) ? 0.4 : 0.9);
    depth_map host = depth_map_open(
        NULL, &(shb_map_desc){.view = probe_orthographic(false), .width = WIDTH, .height = HEIGHT},
        depths);
    const int sizes[] = {1, 3, 7, 31};
    for (int k = 0; k < 4; k++) {
        const int size = sizes[k];
        const shb_filter filters[] = {shb_filter_variance(size, 0),
                                      shb_filter_exponential_variance(size, 6, 4, 0),
                                      shb_filter_moments(size)};
        for (int method = 0; method < 3; method++)
            depth_map_prepare(&host, &filters[method]);
        for (int i = 0; i < 10; i++) {
            const double column = oracle_float(random_double(&random, 0, WIDTH));
            const double row = oracle_float(random_double(&random, 0, HEIGHT));
            const double depth = random_double(&random, 0.15, 1);
            for (int method = 0; method < 3; method++)
                CHECK_NEAR(depth_map_ask(&host, &filters[method], 2 * column / WIDTH - 1,
                                         1 - 2 * row / HEIGHT, z_of(depth)),
                           slow_answer(method, depths, size, column, row, depth), 2e-4);
        }
    }
    depth_map_close(&host);
}
