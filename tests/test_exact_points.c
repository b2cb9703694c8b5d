/* Points that name their triangle and weights, on every instruction set. */
#include "../src/kernels/shade.h"

#include "isas.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VERTICES = 50, TRIANGLES = 40 };

typedef struct named_batch {
    uint32_t corners[TRIANGLES][3];
    double vertices[VERTICES + 1][3]; /* and what vectors may read */
    float *weight_1, *weight_2;       /* not one more than there are points */
    double places[3][SHB_BATCH], slack[3][SHB_BATCH];
    shb_receivers receivers;
    shb_exact_points points;
} named_batch;

/* No coordinate is near 0, so that the slack is far more than floats are rounded by. */
static void add_scene(named_batch *b, test_random *random) {
    for (int i = 0; i < VERTICES; i++)
        for (int k = 0; k < 3; k++)
            b->vertices[i][k] = random_double(random, 0.5, 1) * (random_below(random, 2) ? 1 : -1);
    for (int i = 0; i < TRIANGLES; i++)
        for (int k = 0; k < 3; k++)
            b->corners[i][k] = random_below(random, VERTICES);
    b->corners[TRIANGLES - 1][1] = VERTICES - 1;
}

static float *position_of(named_batch *b, int k, size_t i) {
    return (k == 0 ? b->receivers.x : k == 1 ? b->receivers.y : b->receivers.z) + i;
}

static void add_point(named_batch *b, test_random *random, size_t i) {
    const uint32_t id = b->points.own_ids[i];
    const size_t last = b->points.count - 1;
    if (i <= last) {
        b->weight_1[i] = (float)random_double(random, 0, 0.5);
        b->weight_2[i] = (float)random_double(random, 0, 0.5);
    }
    const double u = (double)b->weight_1[i < last ? i : last];
    const double v = (double)b->weight_2[i < last ? i : last];
    for (int k = 0; k < 3; k++) {
        const double p = b->vertices[b->corners[id][0]][k];
        const double q = b->vertices[b->corners[id][1]][k];
        const double r = b->vertices[b->corners[id][2]][k];
        b->places[k][i] = p + ((q - p) * u + (r - p) * v);
        b->slack[k][i] = 0x1p-18 * (fabs(p) + fabs(q) + fabs(r));
        *position_of(b, k, i) = (float)b->places[k][i];
    }
}

/* Runs of points on the same triangle, some of which are longer than vectors. */
static named_batch *new_batch(size_t count, uint64_t seed) {
    named_batch *b = calloc(1, sizeof *b);
    test_random random = {seed};
    add_scene(b, &random);
    b->points.count = count;
    b->weight_1 = malloc(count * sizeof *b->weight_1);
    b->weight_2 = malloc(count * sizeof *b->weight_2);
    const uint32_t lengths = random_below(&random, 2) ? 40 : 3;
    uint32_t id = TRIANGLES - 1;
    for (size_t i = 0; i < SHB_BATCH; i++) {
        if (i && i < count && random_below(&random, lengths) == 0)
            id = random_below(&random, TRIANGLES);
        b->points.own_ids[i] = id;
        add_point(b, &random, i);
    }
    return b;
}

static void free_batch(named_batch *b) {
    free(b->weight_1);
    free(b->weight_2);
    free(b);
}

/* With the first triangles alone. */
static bool place_among(named_batch *b, shb_isa isa, size_t triangles) {
    const shb_drawn_mesh mesh = {triangles, (const uint32_t(*)[3])b->corners,
                                 (const double(*)[3])b->vertices};
    return shb_shade_kernels_of(isa)->place(&mesh, b->weight_1, b->weight_2, &b->receivers,
                                            &b->points);
}

static bool place(named_batch *b, shb_isa isa) {
    return place_among(b, isa, TRIANGLES);
}

TEST(named_points_are_placed_with_the_bits_of_plain_arithmetic) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (size_t count = 1; count <= SHB_BATCH; count += count < 40 ? 1 : 72) {
            named_batch *b = new_batch(count, count);
            CHECK(place(b, isa));
            CHECK(memcmp(b->points.x, b->places[0], count * sizeof(double)) == 0);
            CHECK(memcmp(b->points.y, b->places[1], count * sizeof(double)) == 0);
            CHECK(memcmp(b->points.z, b->places[2], count * sizeof(double)) == 0);
            free_batch(b);
        }
}

/* One coordinate of one point, by a little less and a little more than may be; or nowhere. */
TEST(named_points_are_told_from_others_by_any_coordinate_of_any_point) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (int k = 0; k < 3; k++)
            for (size_t i = 0; i < 21; i++) {
                named_batch *b = new_batch(21, 100 + i);
                float *position = position_of(b, k, i);
                const double at = b->places[k][i], slack = b->slack[k][i] * (i % 2 ? 1 : -1);
                *position = (float)(at + slack * 0.95);
                CHECK(place(b, isa));
                *position = (float)(at + slack * 1.05);
                CHECK(!place(b, isa));
                *position = NAN;
                CHECK(!place(b, isa));
                free_batch(b);
            }
}

TEST(named_points_are_not_placed_on_triangles_that_a_scene_has_not) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (size_t i = 0; i < 21; i++) {
            named_batch *b = new_batch(21, 200 + i);
            test_random random = {200};
            for (size_t n = 0; n < SHB_BATCH; n++) {
                b->points.own_ids[n] = n == i ? TRIANGLES - 1 : 0;
                add_point(b, &random, n);
            }
            CHECK(place(b, isa));
            CHECK(!place_among(b, isa, TRIANGLES - 1));
            free_batch(b);
        }
}

/* Three steps of a float wide: rounding moves the points by more than 2^-18 of that. */
TEST(named_points_are_known_where_floats_have_no_finer_steps) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (int k = 0; k < 3; k++) {
            named_batch *b = new_batch(21, 300);
            for (int i = 0; i < VERTICES; i++)
                b->vertices[i][k] *= 0x3p-149;
            test_random random = {301};
            for (size_t i = 0; i < SHB_BATCH; i++)
                add_point(b, &random, i);
            CHECK(place(b, isa));
            *position_of(b, k, 20) += 0x1p-147f;
            CHECK(!place(b, isa));
            free_batch(b);
        }
}
