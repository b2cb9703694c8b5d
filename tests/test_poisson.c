/* Taps on a disk: the tables against their rule, worked out anew. */
#include "../src/poisson.h"
#include "test.h"

#include <math.h>

static uint32_t draw(uint32_t *state) {
    *state = 1664525u * *state + 1013904223u;
    return (*state >> 16) % 32768;
}

/* The square of the smallest distance that counts, with the rim rounded as the rule says. */
static int64_t room_of(int64_t x, int64_t y, int count) {
    const int64_t rim = 3 * (int64_t)ceil(16384 - sqrt((double)(x * x + y * y)));
    int64_t room = rim * rim;
    for (int i = 0; i < count; i++) {
        const int64_t dx = x - shb_poisson_disk[i][0], dy = y - shb_poisson_disk[i][1];
        const int64_t distance = dx * dx + dy * dy;
        room = distance < room ? distance : room;
    }
    return room;
}

TEST(poisson_points_are_the_best_candidates) {
    uint32_t state = 1;
    CHECK(shb_poisson_disk[0][0] == 0 && shb_poisson_disk[0][1] == 0);
    for (int count = 1; count < SHB_POISSON_MAX; count++) {
        int64_t best = -1, best_x = 0, best_y = 0;
        for (int tried = 0; tried < 64 * count;) {
            const int64_t x = (int64_t)draw(&state) - 16384;
            const int64_t y = (int64_t)draw(&state) - 16384;
            if (x * x + y * y >= 16384ll * 16384)
                continue;
            tried++;
            const int64_t room = room_of(x, y, count);
            if (room > best) {
                best = room;
                best_x = x;
                best_y = y;
            }
        }
        CHECK_INT(shb_poisson_disk[count][0], best_x);
        CHECK_INT(shb_poisson_disk[count][1], best_y);
    }
}

/* A square grid of n points on the disk is sqrt(pi / n) apart. */
TEST(poisson_beginnings_are_spread) {
    for (int count = 2; count <= SHB_POISSON_MAX; count++) {
        double nearest = 2;
        for (int i = 0; i < count; i++)
            for (int k = 0; k < i; k++)
                nearest = fmin(nearest, hypot(shb_poisson_disk[i][0] - shb_poisson_disk[k][0],
                                              shb_poisson_disk[i][1] - shb_poisson_disk[k][1]) /
                                            16384);
        CHECK(nearest > 0.5 * sqrt(3.141592653589793 / count));
    }
}

TEST(poisson_points_cover_the_disk_evenly) {
    const int counts[] = {16, 25, 32, 64, 256};
    for (int c = 0; c < 5; c++) {
        double x = 0, y = 0, squared = 0;
        for (int i = 0; i < counts[c]; i++) {
            const double px = shb_poisson_disk[i][0] / 16384.0;
            const double py = shb_poisson_disk[i][1] / 16384.0;
            x += px / counts[c];
            y += py / counts[c];
            squared += (px * px + py * py) / counts[c];
        }
        CHECK_NEAR(x, 0, 0.1); /* random ones deviate by 0.5 / sqrt(n) */
        CHECK_NEAR(y, 0, 0.1);
        CHECK_NEAR(squared, 0.5, 0.07); /* the mean of r^2 over the disk */
    }
}

TEST(turns_are_unit_vectors_at_equal_angles) {
    for (int i = 0; i < SHB_POISSON_TURNS; i++) {
        const double angle = 2 * 3.141592653589793 * i / SHB_POISSON_TURNS;
        CHECK_NEAR(shb_poisson_turns[i][0], 16384 * cos(angle), 0.5);
        CHECK_NEAR(shb_poisson_turns[i][1], 16384 * sin(angle), 0.5);
    }
}

/* 64 turns over 6400 points of a grid: 100 each, with a deviation of 10. */
TEST(neighbours_take_turns_evenly) {
    int taken[SHB_POISSON_TURNS] = {0};
    for (int y = 0; y < 80; y++)
        for (int x = 0; x < 80; x++)
            taken[shb_poisson_turn((float)x * 0.01f, 1.5f, (float)y * 0.01f)]++;
    for (int i = 0; i < SHB_POISSON_TURNS; i++)
        CHECK(taken[i] > 50 && taken[i] < 150);
}
