/* The bounds of a map's pyramid, texel by texel. */
#include "../src/pyramid.h"

#include "allocator.h"
#include "contexts.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct pyramid_case {
    shb_context *context;
    shb_map *map;
    void *texels;
    shb_pyramid *pyramid;
    size_t bytes;
} pyramid_case;

static void put(void *texels, shb_format format, size_t i, double depth) {
    if (format == SHB_FORMAT_FLOAT32)
        ((float *)texels)[i] = (float)depth;
    else if (format == SHB_FORMAT_UNORM24)
        ((uint32_t *)texels)[i] = (uint32_t)(depth * 0xffffff);
    else
        ((uint16_t *)texels)[i] = (uint16_t)(depth * 0xffff);
}

static pyramid_case open_case_of(shb_isa isa, uint32_t width, uint32_t height, shb_format format,
                                 bool reversed, uint32_t threads) {
    pyramid_case made = {0};
    made.context = test_context(threads, isa);
    const shb_map_desc desc = {
        .view = probe_orthographic(reversed), .width = width, .height = height, .format = format};
    made.texels = calloc((size_t)width * height, shb_format_size(format));
    CHECK_INT(shb_map_wrap(made.context, &desc, made.texels, 0, NULL, &made.map), SHB_OK);
    return made;
}

static pyramid_case open_case(uint32_t width, uint32_t height, shb_format format, bool reversed,
                              uint32_t threads) {
    return open_case_of(SHB_ISA_BEST, width, height, format, reversed, threads);
}

static void close_case(pyramid_case *made) {
    shb_pyramid_destroy(made->map, made->pyramid);
    shb_map_destroy(made->map);
    shb_context_destroy(made->context);
    free(made->texels);
}

/* Some regions are planes, some noise, some empty. */
static void fill(pyramid_case *made, uint64_t seed) {
    const shb_map_info *info = shb_map_get_info(made->map);
    test_random random = {seed};
    const double slope_x = random_double(&random, -0.5, 0.5) / info->width;
    const double slope_y = random_double(&random, -0.5, 0.5) / info->height;
    for (uint32_t y = 0; y < info->height; y++)
        for (uint32_t x = 0; x < info->width; x++) {
            const uint32_t kind = (x / 23 + y / 17) % 4;
            double depth = 0.5 + x * slope_x + y * slope_y - 0.1 * kind;
            if (kind == 2)
                depth = random_double(&random, 0, 1);
            if (kind == 3 && x % 40 > 20)
                depth = info->view.reversed ? 0 : 1;
            put(made->texels, info->format, (size_t)y * info->width + x,
                depth < 0   ? 0
                : depth > 1 ? 1
                            : depth);
        }
}

/* Sizes of the step between cells and of a cell, in texels. */
static uint32_t step_of(int level) {
    return 8u << level;
}

/* Every texel of one cell lies between its planes; the canonical depths are those of fetch. */
static bool holds(const pyramid_case *made, int level, uint32_t column, uint32_t row) {
    const shb_map_info *info = shb_map_get_info(made->map);
    const shb_pyramid_level *cells = &made->pyramid->levels[level];
    const shb_pyramid_cell *cell = &cells->cells[(size_t)row * cells->columns + column];
    const float far_depth = info->view.reversed ? 0.0f : 1.0f;
    const uint32_t step = step_of(level);
    bool good = true;
    for (uint32_t n = 0; n < 2 * step && row * step + n < info->height; n++)
        for (uint32_t m = 0; m < 2 * step && column * step + m < info->width; m++) {
            const int32_t x = (int32_t)(column * step + m), y = (int32_t)(row * step + n);
            float depth;
            shb_map_fetch(made->map, 1, &x, &y, &depth);
            const double run = m * (double)cell->slope_x + n * (double)cell->slope_y;
            if (!(depth < far_depth))
                good &= cell->farthest == INFINITY;
            else
                good &= (double)cell->nearest + run <= (double)depth &&
                        (double)depth <= (double)cell->farthest + run;
        }
    return good;
}

static void check_bounds(pyramid_case *made) {
    made->pyramid = shb_pyramid_create(made->map, &made->bytes);
    const shb_map_info *info = shb_map_get_info(made->map);
    const shb_pyramid *pyramid = made->pyramid;
    for (int level = 0; level < pyramid->count; level++) {
        const shb_pyramid_level *cells = &pyramid->levels[level];
        CHECK_INT(cells->columns, (info->width + step_of(level) - 1) / step_of(level));
        CHECK_INT(cells->rows, (info->height + step_of(level) - 1) / step_of(level));
        bool good = true;
        for (uint32_t row = 0; row < cells->rows; row++)
            for (uint32_t column = 0; column < cells->columns; column++)
                good &= holds(made, level, column, row);
        CHECK(good);
    }
    const shb_pyramid_level *last = &pyramid->levels[pyramid->count - 1];
    CHECK(last->columns == 1 && last->rows == 1);
}

TEST(pyramid_bounds_every_texel_of_every_size_and_format) {
    const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {8, 8}, {16, 40}, {65, 33}, {130, 97}, {1, 300}};
    for (int i = 0; i < 7; i++)
        for (int k = 0; k < 6; k++) {
            pyramid_case made =
                open_case(sizes[i][0], sizes[i][1], (shb_format)(k / 2), k & 1, i % 2 ? 2u : 1u);
            fill(&made, (uint64_t)(10 * i + k));
            check_bounds(&made);
            close_case(&made);
        }
}

TEST(pyramid_of_depths_that_no_drawing_gives) {
    const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-40f, -0.0f, 2, -5};
    for (int reversed = 0; reversed < 2; reversed++)
        for (uint32_t seed = 0; seed < 20; seed++) {
            pyramid_case made = open_case(40, 24, SHB_FORMAT_FLOAT32, reversed, 1);
            fill(&made, seed);
            test_random random = {seed};
            for (uint32_t i = 0; i < seed; i++)
                ((float *)made.texels)[random_below(&random, 40 * 24)] =
                    odd[random_below(&random, 9)];
            check_bounds(&made);
            close_case(&made);
        }
}

TEST(pyramid_has_scalar_bits_on_every_instruction_set) {
    for (int reversed = 0; reversed < 2; reversed++) {
        pyramid_case scalar =
            open_case_of(SHB_ISA_SCALAR, 203, 77, SHB_FORMAT_FLOAT32, reversed, 1);
        fill(&scalar, 5);
        check_bounds(&scalar);
        for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
             isa = test_isa_after(isa)) {
            pyramid_case made = open_case_of(isa, 203, 77, SHB_FORMAT_FLOAT32, reversed, 1);
            fill(&made, 5);
            check_bounds(&made);
            CHECK_INT(made.bytes, scalar.bytes);
            CHECK(memcmp(made.pyramid->levels[0].cells, scalar.pyramid->levels[0].cells,
                         made.bytes - sizeof *made.pyramid) == 0);
            close_case(&made);
        }
        close_case(&scalar);
    }
}

/* Depths of 1/4 and 1/2 by turns have no slope: nothing is lost. */
TEST(pyramid_of_level_depths_is_exact) {
    pyramid_case made = open_case(64, 64, SHB_FORMAT_FLOAT32, false, 1);
    for (size_t i = 0; i < 64 * 64; i++)
        put(made.texels, SHB_FORMAT_FLOAT32, i, (i / 64 + i) % 2 ? 0.25 : 0.5);
    check_bounds(&made);
    for (int level = 0; level < made.pyramid->count; level++) {
        const shb_pyramid_level *cells = &made.pyramid->levels[level];
        for (size_t i = 0; i < (size_t)cells->columns * cells->rows; i++) {
            CHECK(cells->cells[i].nearest == 0.25f && cells->cells[i].farthest == 0.5f);
            CHECK(cells->cells[i].slope_x == 0 && cells->cells[i].slope_y == 0);
        }
    }
    close_case(&made);
}

/* On a tilted plane both bounds follow it, on every level: its slopes are 1/256 and -1/512. */
TEST(pyramid_of_a_plane_is_as_flat_as_the_plane) {
    enum { SIZE = 128 };
    pyramid_case made = open_case(SIZE, SIZE, SHB_FORMAT_FLOAT32, false, 1);
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++)
            put(made.texels, SHB_FORMAT_FLOAT32, (size_t)(y * SIZE + x),
                0.3 + x / 256.0 - y / 512.0);
    check_bounds(&made);
    for (int level = 0; level < made.pyramid->count; level++) {
        const shb_pyramid_level *cells = &made.pyramid->levels[level];
        for (size_t i = 0; i < (size_t)cells->columns * cells->rows; i++) {
            const shb_pyramid_cell *cell = &cells->cells[i];
            CHECK_NEAR(cell->slope_x, 1 / 256.0, 1e-7);
            CHECK_NEAR(cell->slope_y, -1 / 512.0, 1e-7);
            CHECK_NEAR(cell->farthest - cell->nearest, 0, 2e-5);
        }
    }
    close_case(&made);
}

TEST(pyramid_is_part_of_the_maps_memory) {
    pyramid_case made = open_case(256, 64, SHB_FORMAT_FLOAT32, false, 1);
    const size_t before = shb_map_get_info(made.map)->memory_bytes;
    const shb_filter filter = shb_filter_pcss(0.1f, 16, 16, SHB_TAPS_PLANE);
    CHECK_INT(shb_map_prepare(made.map, &filter), SHB_OK);
    /* 32 x 8, 16 x 4, 8 x 2, 4 x 1, 2 x 1 and 1 cells of 16 bytes */
    const size_t cells = 16 * (256 + 64 + 16 + 4 + 2 + 1);
    CHECK_INT(shb_map_get_info(made.map)->memory_bytes - before, cells + sizeof(shb_pyramid));
    close_case(&made);
}

TEST(pyramid_without_memory_is_an_error_and_leaks_nothing) {
    for (size_t fail = 1; fail <= 2; fail++) {
        test_allocator allocator = {0};
        shb_context *context;
        const shb_context_desc desc = {.allocator = test_allocator_hooks(&allocator), .threads = 1};
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        const shb_map_desc map_desc = {.view = probe_orthographic(false), .width = 32};
        shb_map *map;
        CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
        const shb_filter filter = shb_filter_pcss(0.1f, 16, 16, SHB_TAPS_PLANE);
        allocator.fail_at = allocator.calls + fail;
        CHECK_INT(shb_map_prepare(map, &filter), SHB_ERROR_MEMORY);
        allocator.fail_at = 0;
        CHECK_INT(shb_map_prepare(map, &filter), SHB_OK);
        shb_map_destroy(map);
        shb_context_destroy(context);
        CHECK_INT(allocator.live, 0);
    }
}
