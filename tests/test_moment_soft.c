/* Prefiltered maps with kernels as wide as the penumbra: an edge worked out on paper, then a slow
 * calculation of both stages. Under the orthographic light depth is (4 - z) / 8, and distance is
 * depth. */
#include "depth_map.h"
#include "oracle.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdbool.h>

enum { SIZE = 64, METHODS = 3 };

static shb_filter filter_of(int method, double light) {
    return method == 0   ? shb_filter_variance_soft((float)light, 0)
           : method == 1 ? shb_filter_exponential_variance_soft((float)light, 6, 4, 0)
                         : shb_filter_moments_soft((float)light);
}

static double limited(double value) {
    return value < 0 ? 0 : value > 1 ? 1 : value;
}

/* The part of a kernel on the right of an edge at texel 32: boxes about places that lie spacing
 * texels apart, the two around x mixed. */
static double right_of_edge(double x, int box, int spacing) {
    const double left = floor(x / spacing) * spacing, part = (x - left) / spacing;
    const double before = limited((left + box / 2.0 - 32) / box);
    const double after = limited((left + spacing + box / 2.0 - 32) / box);
    return (1 - part) * before + part * after;
}

/* An edge at depth 3/8 over a floor at 1/2, one unit apart, light 0.5 wide at the distance of one:
 * a penumbra of 0.5 or 16 texels. Of two depths every bound is exact, and so is the distance of the
 * blocker. The square of 16 lies between 75, for boxes of 8 texels every 2, and 303, for 16 every
 * 4. */
TEST(an_edge_has_the_penumbra_of_its_distance) {
    float depths[SIZE * SIZE];
    const double coarser = (256.0 - 75) / (303 - 75);
    for (int i = 0; i < SIZE * SIZE; i++)
        depths[i] = i % SIZE < SIZE / 2 ? 0.375f : 0.5f;
    for (int i = 0; i < 2 * METHODS; i++) {
        const shb_filter filter = filter_of(i / 2, 0.5);
        const shb_map_desc desc = {.view = probe_orthographic(i & 1), .width = SIZE};
        depth_map host = depth_map_open(NULL, &desc, depths);
        depth_map_prepare(&host, &filter);
        for (double way = -0.35; way < 0.35; way += 0.0131) {
            const double x = 32 * (1 + way);
            const double lit =
                (1 - coarser) * right_of_edge(x, 8, 2) + coarser * right_of_edge(x, 16, 4);
            CHECK_NEAR(depth_map_ask(&host, &filter, way, 0.003, 0), lit, 2e-3);
        }
        depth_map_close(&host);
    }
}

/* Blockers twice as far above the floor have a penumbra twice as wide. */
TEST(blur_grows_with_the_distance_of_blockers) {
    float depths[SIZE * SIZE];
    double widths[2];
    for (int method = 0; method < METHODS; method++) {
        for (int k = 0; k < 2; k++) {
            for (int i = 0; i < SIZE * SIZE; i++)
                depths[i] = i % SIZE < SIZE / 2 ? 0.5f - 0.0625f * (float)(k + 1) : 0.5f;
            const shb_filter filter = filter_of(method, 0.5);
            const shb_map_desc desc = {.view = probe_orthographic(false), .width = SIZE};
            depth_map host = depth_map_open(NULL, &desc, depths);
            depth_map_prepare(&host, &filter);
            widths[k] = 0;
            for (double way = -0.5; way < 0.5; way += 0.001) {
                const double lit = depth_map_ask(&host, &filter, way, 0.003, 0);
                widths[k] += lit > 0.1 && lit < 0.9 ? 0.001 : 0;
            }
            depth_map_close(&host);
        }
        CHECK_NEAR(widths[1] / widths[0], 2, 0.1);
    }
}

/* The view with the world's unit changed. */
static shb_view scaled_view(shb_view view, double scale) {
    for (int i = 0; i < 12; i++)
        view.clip_from_world.m[i] /= scale;
    return view;
}

/* Powers of two change no bit; a directional light's size is an angle. */
TEST(prefiltered_penumbras_do_not_depend_on_the_worlds_unit) {
    float depths[SIZE * SIZE];
    test_random random = {71};
    for (int i = 0; i < SIZE * SIZE; i++)
        depths[i] = (float)random_double(&random, 0.2, 1);
    for (int i = 0; i < 2 * METHODS; i++) {
        const bool spot = i & 1;
        const shb_view view = spot ? probe_perspective(true) : probe_orthographic(false);
        for (int power = -30; power <= 30; power += 60) {
            const double scale = ldexp(1, power);
            const shb_filter filter = filter_of(i / 2, 0.125);
            const shb_filter scaled = filter_of(i / 2, spot ? 0.125 * scale : 0.125);
            depth_map one =
                depth_map_open(NULL, &(shb_map_desc){.view = view, .width = SIZE}, depths);
            depth_map other = depth_map_open(
                NULL, &(shb_map_desc){.view = scaled_view(view, scale), .width = SIZE}, depths);
            depth_map_prepare(&one, &filter);
            depth_map_prepare(&other, &scaled);
            for (int k = 0; k < 20; k++) {
                const double x = oracle_float(random_double(&random, -0.9, 0.9));
                const double y = oracle_float(random_double(&random, -0.9, 0.9)), z = 1.5;
                CHECK(depth_map_ask(&one, &filter, x, y, z) ==
                      depth_map_ask(&other, &scaled, x * scale, y * scale, z * scale));
            }
            depth_map_close(&one);
            depth_map_close(&other);
        }
    }
}

/* ---- against a slow calculation ---- */

enum { WIDTH = 40, HEIGHT = 24, LEVELS = 6 };

/* Powers of what a kernel holds, each times its weight. */
typedef struct powers {
    long double m[5];
} powers;

static double warp(double exponent, double x) {
    return exponent == 0 ? x : (exponent < 0 ? -1 : 1) * exp(exponent * (x - 0.5));
}

static double unwarp(double exponent, double w) {
    return exponent == 0 ? w : 0.5 + log(fabs(w)) / exponent;
}

static double square_of_level(int level) {
    const double box = 2 << level, spacing = level > 1 ? 1 << (level - 1) : 1;
    return box * box - 1 + 3 * spacing * spacing;
}

/* How much a texel weighs on an axis, in the boxes about the two places around x. */
static double weight_of(double x, int texel, int level) {
    const double box = 2 << level, spacing = level > 1 ? 1 << (level - 1) : 1;
    const double left = floor(x / spacing) * spacing, part = (x - left) / spacing;
    const double from_left = fabs(texel + 0.5 - left);
    const double from_right = fabs(texel + 0.5 - left - spacing);
    return ((from_left < box / 2 ? 1 - part : 0) + (from_right < box / 2 ? part : 0)) / box;
}

static powers kernel_powers(const float *depths, double x, double y, double square,
                            double exponent) {
    int level = 0;
    while (level < LEVELS - 2 && square > square_of_level(level + 1))
        level++;
    const double finer = square_of_level(level);
    const double coarser = (square - finer) / (square_of_level(level + 1) - finer);
    powers sum = {{0}};
    for (int row = -80; row < HEIGHT + 80; row++)
        for (int column = -80; column < WIDTH + 80; column++) {
            const bool inside = row >= 0 && row < HEIGHT && column >= 0 && column < WIDTH;
            const double weight =
                (1 - coarser) * weight_of(x, column, level) * weight_of(y, row, level) +
                coarser * weight_of(x, column, level + 1) * weight_of(y, row, level + 1);
            if (!(weight > 0))
                continue;
            const double depth = inside ? (double)depths[row * WIDTH + column] : 1;
            long double power = (long double)weight;
            for (int k = 0; k < 5; k++, power *= (long double)warp(exponent, depth))
                sum.m[k] += power;
        }
    return sum;
}

/* What lies in front of t: how much of the kernel is lit, and the mean distance of the rest. */
typedef struct judged {
    double lit, blocker;
} judged;

/* Two points with the kernel's mean and variance, the farther one at t. */
static judged judge_two(const powers *kernel, double exponent, double t) {
    const long double warped = (long double)warp(exponent, t), mean = kernel->m[1];
    const long double variance = kernel->m[2] - mean * mean, d = warped - mean;
    if (d <= 0)
        return (judged){1, t};
    const long double lit = variance / (variance + d * d);
    const double below = (double)((mean - lit * warped) / (1 - lit));
    const double least = warp(exponent, 0);
    return (judged){(double)lit, unwarp(exponent, below > least ? below : least)};
}

/* The weight of the point a of three that have the kernel's mean and second moment. */
static long double weight_of_three(const powers *kernel, long double a, long double b,
                                   long double c) {
    return (kernel->m[2] - (b + c) * kernel->m[1] + b * c) / ((a - b) * (a - c));
}

/* Three points with the kernel's four moments, one of them at t. The other two are the roots of
 * z^2 - p z + q, for which sums over (z - t) (z^2 - p z + q) z^k vanish. */
static judged judge_four(const powers *kernel, double at) {
    const long double *m = kernel->m, t = (long double)at;
    const long double a = m[1] - t, b = m[2] - t * m[1], c = m[3] - t * m[2], d = m[4] - t * m[3];
    const long double p = (d * a - c * b) / (c * a - b * b), q = (p * b - c) / a;
    const long double root = sqrtl(p * p / 4 - q), near_z = p / 2 - root, far_z = p / 2 + root;
    long double below = 0, sum = 0;
    if (near_z < t) {
        below += weight_of_three(kernel, near_z, far_z, t);
        sum += weight_of_three(kernel, near_z, far_z, t) * near_z;
    }
    if (far_z < t) {
        below += weight_of_three(kernel, far_z, near_z, t);
        sum += weight_of_three(kernel, far_z, near_z, t) * far_z;
    }
    return (judged){(double)(1 - below), below > 0 ? (double)(sum / below) : at};
}

static judged judge(int method, const float *depths, double x, double y, double square, double t) {
    judged best = {1, t};
    const double exponents[2] = {method == 1 ? 6 : 0, method == 1 ? -4 : 0};
    for (int i = 0; i < 2; i++) {
        const powers kernel = kernel_powers(depths, x, y, square, exponents[i]);
        const judged one =
            method == 2 ? judge_four(&kernel, t) : judge_two(&kernel, exponents[i], t);
        best = one.lit < best.lit ? one : best;
    }
    return best;
}

/* The mean of both axes' squares: a texel is 2 / WIDTH by 2 / HEIGHT, and depth 1 is 8 units. */
static double square_of_penumbra(double light, double nearer_by) {
    const double x = 8 * light * nearer_by * WIDTH / 2, y = 8 * light * nearer_by * HEIGHT / 2;
    const double square = (x * x + y * y) / 2, most = square_of_level(LEVELS - 1);
    return square < 6 ? 6 : square > most ? most : square;
}

/* Every 8 x 8 texels hold one at 1/8, the nearest of all, so that every search is for that. */
static void fill(float *depths) {
    test_random random = {61};
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const bool corner = i % WIDTH % 8 == 0 && i / WIDTH % 8 == 0;
        depths[i] = (float)random_double(&random, 0.2, random_below(&random, 2) ? 0.4 : 0.9);
        depths[i] = corner ? 0.125f : depths[i];
    }
}

TEST(both_stages_are_those_of_a_slow_calculation) {
    float depths[WIDTH * HEIGHT];
    fill(depths);
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = WIDTH, .height = HEIGHT};
    depth_map host = depth_map_open(NULL, &desc, depths);
    test_random random = {67};
    for (int i = 0; i < 60; i++) {
        const int method = i % METHODS;
        const double light = oracle_float(i / METHODS % 4 * 0.03 + 0.02);
        const shb_filter filter = filter_of(method, light);
        depth_map_prepare(&host, &filter);
        const double x = oracle_float(random_double(&random, -1, 1));
        const double y = oracle_float(random_double(&random, -1, 1));
        const double depth = oracle_float(random_double(&random, 0.2, 0.95));
        const double column = (x + 1) * WIDTH / 2, row = (1 - y) * HEIGHT / 2;
        const judged found =
            judge(method, depths, column, row, square_of_penumbra(light, depth - 0.125), depth);
        const double blocker = found.blocker > 0.125 ? found.blocker : 0.125;
        const judged answer =
            judge(method, depths, column, row, square_of_penumbra(light, depth - blocker), depth);
        CHECK_NEAR(depth_map_ask(&host, &filter, x, y, 4 - 8 * depth),
                   found.lit < 1 ? answer.lit : 1, 1e-3);
    }
    depth_map_close(&host);
}
