/* Moments over boxes and kernels of all widths, against sums over texels. */
#include "../src/kernels/moments.h"

#include "depth_map.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <string.h>

enum { SIDE = 40 };

/* Mean and three central moments of what has weights, added up one by one. */
typedef struct sums {
    long double weight, value[4];
} sums;

static double depth_at(const float *depths, int width, int height, int x, int y) {
    const bool inside = x >= 0 && x < width && y >= 0 && y < height;
    return inside ? (double)depths[y * width + x] : 1;
}

static double warp(double exponent, double x) {
    return exponent == 0 ? x : (exponent < 0 ? -1 : 1) * exp(exponent * (x - 0.5));
}

/* The texels of a map of this size with their weights, far ones around it; those that count lie in
 * a square about a place. */
typedef struct weighted {
    const float *depths;
    int width, height;
    int x, y, reach;
    double exponent;
    double (*weight)(const void *kernel, int x, int y);
    const void *kernel;
} weighted;

static sums add_up(const weighted *w) {
    sums raw = {0, {0}}, central = {0, {0}};
    for (int pass = 0; pass < 2; pass++)
        for (int y = w->y - w->reach; y < w->y + w->reach; y++)
            for (int x = w->x - w->reach; x < w->x + w->reach; x++) {
                const long double part = (long double)w->weight(w->kernel, x, y);
                if (!(part > 0))
                    continue;
                const long double value =
                    (long double)warp(w->exponent, depth_at(w->depths, w->width, w->height, x, y));
                if (pass == 0) {
                    raw.weight += part;
                    raw.value[0] += part * value;
                    continue;
                }
                const long double d = value - raw.value[0] / raw.weight;
                central.value[1] += part * d * d / raw.weight;
                central.value[2] += part * d * d * d / raw.weight;
                central.value[3] += part * d * d * d * d / raw.weight;
            }
    central.weight = raw.weight;
    central.value[0] = raw.value[0] / raw.weight;
    return central;
}

/* Moments of the order k, to parts of the k-th power of what their values may differ by. */
static void check_moments(const float *moments, int count, const sums *expected, double span) {
    double unit = span;
    for (int k = 0; k < count; k++, unit *= span)
        CHECK_NEAR((double)moments[k], (double)expected->value[k], 4e-6 * unit);
}

/* A square box: its middle, texels from the map's corner. */
typedef struct box {
    int x, y, size;
} box;

static double in_box(const void *kernel, int x, int y) {
    const box *b = kernel;
    const double off_x = fabs(x + 0.5 - b->x), off_y = fabs(y + 0.5 - b->y);
    return off_x < b->size / 2.0 && off_y < b->size / 2.0 ? 1 : 0;
}

static void fill(float *depths, int count) {
    test_random random = {41};
    for (int i = 0; i < count; i++)
        depths[i] = (float)random_double(&random, 0.2, random_below(&random, 2) ? 0.4 : 0.9);
}

static int spacing_of(int level) {
    return level > 1 ? 1 << (level - 1) : 1;
}

TEST(boxes_of_every_level_hold_the_moments_of_their_texels) {
    const int sizes[][2] = {{1, 1}, {2, 3}, {5, 4}, {17, 9}, {33, 20}};
    const double exponents[] = {0, 5, -7};
    float depths[SIDE * SIDE];
    fill(depths, SIDE * SIDE);
    for (int i = 0; i < 5; i++)
        for (int e = 0; e < 3; e++) {
            const int width = sizes[i][0], height = sizes[i][1], count = e ? 2 : 4;
            const shb_map_desc desc = {.view = probe_orthographic(false),
                                       .width = (uint32_t)width,
                                       .height = (uint32_t)height};
            depth_map host = depth_map_open(NULL, &desc, depths);
            const shb_distance distance = shb_distance_of(host.map);
            shb_moment_pyramid pyramid = {.count = count, .exponent = (float)exponents[e]};
            CHECK(shb_moment_pyramid_create(host.map, &pyramid));
            shb_moment_pyramid_fill(host.map, &distance, &pyramid);
            CHECK(2 << (pyramid.level_count - 1) >= (width > height ? width : height));
            for (int k = 0; k < pyramid.level_count; k++) {
                const shb_moment_level *level = &pyramid.levels[k];
                for (uint32_t b = 0; b < level->columns * level->rows; b += k < 3 ? 7 : 1) {
                    const box at = {(int)(b % level->columns) * spacing_of(k),
                                    (int)(b / level->columns) * spacing_of(k), 2 << k};
                    const weighted texels = {depths, width,        height, at.x, at.y,
                                             1 << k, exponents[e], in_box, &at};
                    const sums expected = add_up(&texels);
                    check_moments(level->boxes + (size_t)b * (size_t)count, count, &expected,
                                  exp(fabs(exponents[e]) / 2));
                }
            }
            shb_moment_pyramid_destroy(host.map, &pyramid);
            depth_map_close(&host);
        }
}

/* A part of a high map, as a map of its own, has the same boxes but for those at its ends. */
TEST(rows_of_a_high_image_are_those_of_its_parts) {
    enum { WIDTH = 9, HEIGHT = 600, PART = 60, SIZE = 5, TEXEL = 4, ROW = (WIDTH + 2) * TEXEL };
    static float depths[WIDTH * HEIGHT];
    fill(depths, WIDTH * HEIGHT);
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = WIDTH, .height = HEIGHT};
    shb_map_desc part_desc = desc;
    part_desc.height = PART;
    depth_map host = depth_map_open(NULL, &desc, depths);
    const shb_distance distance = shb_distance_of(host.map);
    shb_moment_image image = {.count = TEXEL}, part = {.count = TEXEL};
    CHECK(shb_moment_image_create(host.map, &image));
    shb_moment_image_fill(host.map, &distance, SIZE, &image);
    for (int top = 0; top <= HEIGHT - PART; top += PART / 2) {
        depth_map part_host = depth_map_open(NULL, &part_desc, depths + top * WIDTH);
        CHECK(shb_moment_image_create(part_host.map, &part));
        shb_moment_image_fill(part_host.map, &distance, SIZE, &part);
        for (int row = SIZE; row < PART - SIZE; row++)
            CHECK(memcmp(part.texels + row * ROW, image.texels + (top + row) * ROW,
                         ROW * sizeof *image.texels) == 0);
        shb_moment_image_destroy(part_host.map, &part);
        depth_map_close(&part_host);
    }
    shb_moment_image_destroy(host.map, &image);
    depth_map_close(&host);
}

/* A mixture of boxes of two sizes, each between the four that lie around the fragment. */
typedef struct mixture {
    double x, y, coarser;
    int level;
} mixture;

static double tent(double off) {
    return fabs(off) < 1 ? 1 - fabs(off) : 0;
}

static double part_of_level(const mixture *m, int level, int x, int y) {
    const int spacing = spacing_of(level), size = 2 << level;
    const int left = (int)floor(m->x / spacing), top = (int)floor(m->y / spacing);
    double sum = 0;
    for (int j = top; j <= top + 1; j++)
        for (int i = left; i <= left + 1; i++) {
            const box at = {i * spacing, j * spacing, size};
            sum += tent(m->x / spacing - i) * tent(m->y / spacing - j) * in_box(&at, x, y);
        }
    return sum / size / size;
}

static double in_mixture(const void *kernel, int x, int y) {
    const mixture *m = kernel;
    return (1 - m->coarser) * part_of_level(m, m->level, x, y) +
           m->coarser * part_of_level(m, m->level + 1, x, y);
}

/* Square widths of 6, 18, 75, 303, 1215: of 2^(k + 1) texels, b^2 - 1 + 3 (b / 4)^2. */
TEST(kernels_mix_two_sizes_by_the_square_of_their_width) {
    const double squares[] = {6, 18, 75, 303, 1215};
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = SIDE, .height = 23};
    float depths[SIDE * SIDE];
    fill(depths, SIDE * SIDE);
    depth_map host = depth_map_open(NULL, &desc, depths);
    const shb_distance distance = shb_distance_of(host.map);
    shb_moment_pyramid pyramid = {.count = 4};
    CHECK(shb_moment_pyramid_create(host.map, &pyramid));
    shb_moment_pyramid_fill(host.map, &distance, &pyramid);
    CHECK(shb_moment_pyramid_least(&pyramid) == 6);
    CHECK_INT(pyramid.level_count, 6);
    CHECK(shb_moment_pyramid_most(&pyramid) == 64 * 64 - 1 + 3 * 16 * 16);
    test_random random = {43};
    static shb_receivers r;
    SHB_ALIGN float widths[SHB_BATCH];
    shb_moment_batch moments;
    mixture kernels[64];
    for (int i = 0; i < 64; i++) {
        const int level = i % 4;
        const double part = i < 8 ? i / 4 : random_double(&random, 0, 1);
        widths[i] = (float)(squares[level] + part * (squares[level + 1] - squares[level]));
        r.texel_x[i] = (int32_t)random_below(&random, SIDE);
        r.texel_y[i] = (int32_t)random_below(&random, 23);
        r.to_center_x[i] = (float)random_double(&random, -0.5, 0.5);
        r.to_center_y[i] = (float)random_double(&random, -0.5, 0.5);
        kernels[i] = (mixture){r.texel_x[i] + 0.5 - (double)r.to_center_x[i],
                               r.texel_y[i] + 0.5 - (double)r.to_center_y[i], part, level};
    }
    shb_moment_kernels_of(host.context->isa)
        ->sample_pyramid(&pyramid, shb_map_get_info(host.map), 64, &r, widths, &moments);
    for (int i = 0; i < 64; i++) {
        const weighted texels = {depths, SIDE, 23,         (int)kernels[i].x, (int)kernels[i].y,
                                 40,     0,    in_mixture, &kernels[i]};
        const sums expected = add_up(&texels);
        CHECK_NEAR((double)expected.weight, 1, 1e-9);
        check_moments(
            (float[]){moments.at[0][i], moments.at[1][i], moments.at[2][i], moments.at[3][i]}, 4,
            &expected, 1);
    }
    shb_moment_pyramid_destroy(host.map, &pyramid);
    depth_map_close(&host);
}
