#include "../src/kernels/shade.h"

#include "isas.h"
#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <string.h>

#define WIDTH 37
#define HEIGHT 21
#define SAMPLES (WIDTH * HEIGHT)
#define MAX24 0xffffffu
#define MAX16 0xffffu

TEST(format_sizes) {
    CHECK_INT(shb_format_size(SHB_FORMAT_FLOAT32), 4);
    CHECK_INT(shb_format_size(SHB_FORMAT_UNORM24), 4);
    CHECK_INT(shb_format_size(SHB_FORMAT_UNORM16), 2);
    CHECK_INT(shb_format_size((shb_format)3), 0);
    CHECK_INT(shb_format_size((shb_format)-1), 0);
}

/* The value stored for one flat triangle at this depth. */
static uint32_t store_flat(float z, shb_format format, bool reversed) {
    const float corners[] = {-1, -1, z, 9, -1, z, -1, 9, z};
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    shb_view view = test_pixel_view(2, 2);
    view.reversed = reversed;
    uint32_t texels[4] = {0};
    test_contexts *contexts = test_contexts_create(1);
    const shb_draw_desc desc = {.view = &view,
                                .scene = &scene,
                                .width = 2,
                                .height = 2,
                                .depth = {.texels = texels, .format = format}};
    CHECK_INT(shb_draw(contexts->best, &desc, NULL), SHB_OK);
    test_contexts_destroy(contexts);
    uint16_t first;
    memcpy(&first, texels, sizeof first);
    return format == SHB_FORMAT_UNORM16 ? first : texels[0];
}

TEST(unorm_depths_by_hand_are_rounded_away_from_the_viewer) {
    /* 0.5 * (2^24 - 1) = 8388607.5 and 0.5 * (2^16 - 1) = 32767.5. */
    CHECK_INT(store_flat(0.5f, SHB_FORMAT_UNORM24, false), 8388608);
    CHECK_INT(store_flat(0.5f, SHB_FORMAT_UNORM24, true), 8388607);
    CHECK_INT(store_flat(0.5f, SHB_FORMAT_UNORM16, false), 32768);
    CHECK_INT(store_flat(0.5f, SHB_FORMAT_UNORM16, true), 32767);
    /* The near plane is exact, the smallest step from it is a whole one, or none when reversed. */
    CHECK_INT(store_flat(0, SHB_FORMAT_UNORM16, false), 0);
    CHECK_INT(store_flat(0x1p-60f, SHB_FORMAT_UNORM16, false), 1);
    CHECK_INT(store_flat(1, SHB_FORMAT_UNORM16, true), MAX16);
    CHECK_INT(store_flat(1 - 0x1p-24f, SHB_FORMAT_UNORM16, true), MAX16 - 1);
    /* Just before far: not to be told from it. */
    CHECK_INT(store_flat(1 - 0x1p-24f, SHB_FORMAT_UNORM24, false), MAX24);
    CHECK_INT(store_flat(0x1p-60f, SHB_FORMAT_UNORM24, true), 0);
    /* Nothing there: far. */
    CHECK_INT(store_flat(2, SHB_FORMAT_UNORM24, false), MAX24);
    CHECK_INT(store_flat(2, SHB_FORMAT_UNORM16, false), MAX16);
    CHECK_INT(store_flat(-1, SHB_FORMAT_UNORM24, true), 0);
}

/* q is z * max rounded away from the viewer. z * max has at most 48 bits and is exact in double. */
static bool is_rounded_away(uint32_t q, float z, uint32_t max, bool reversed) {
    const double scaled = (double)z * max;
    return reversed ? q <= scaled && q + 1.0 > scaled : q >= scaled && q - 1.0 < scaled;
}

#define DEPTHS 3000

/* Depths of a standard map: odd ones, random ones of all sizes, multiples of a unorm's step and
 * their neighbours. */
static void make_depths(float depths[DEPTHS]) {
    static const float odd[] = {0,        -0.0f,  1,          1 - 0x1p-24f, 1 + 0x1p-23f,
                                1.5f,     -1e-9f, -0.25f,     0x1p-149f,    0x1p-24f,
                                0x1p-16f, 0.5f,   -HUGE_VALF, HUGE_VALF};
    enum { ODD = sizeof odd / sizeof *odd };
    test_random random = {77};
    for (int i = 0; i < DEPTHS; i++) {
        const float max = i % 2 ? (float)MAX16 : (float)MAX24;
        const float step = floorf((float)random_double(&random, 0, 1) * max) / max;
        const float all[] = {(float)random_double(&random, 0, 1),
                             (float)exp2(random_double(&random, -26, 0)), step, nextafterf(step, 0),
                             nextafterf(step, 1)};
        depths[i] = i < ODD ? odd[i] : all[i % 5];
    }
}

static uint32_t stored_unorm(shb_format format, const void *texels, size_t i) {
    uint16_t half;
    uint32_t word;
    if (format == SHB_FORMAT_UNORM16) {
        memcpy(&half, (const char *)texels + i * sizeof half, sizeof half);
        return half;
    }
    memcpy(&word, (const char *)texels + i * sizeof word, sizeof word);
    return word;
}

static void check_stored(shb_format format, bool reversed, size_t count, const float *depths,
                         const void *texels) {
    const uint32_t max = format == SHB_FORMAT_UNORM16 ? MAX16 : MAX24;
    for (size_t i = 0; i < count; i++) {
        const float z = depths[i];
        const uint32_t stored = stored_unorm(format, texels, i);
        if (format == SHB_FORMAT_FLOAT32)
            CHECK(memcmp(&z, (const char *)texels + i * sizeof z, sizeof z) == 0);
        else
            CHECK(is_rounded_away(stored, z < 0 ? 0 : z > 1 ? 1 : z, max, reversed));
    }
}

/* Counts that are no multiple of a vector; what lies behind the last texel stays as it was. */
static void check_store(shb_format_store_fn *store, shb_format format, bool reversed) {
    const size_t size = shb_format_size(format);
    float depths[DEPTHS], canonical[DEPTHS];
    char texels[(DEPTHS + 1) * sizeof(float)], untouched[sizeof(float)];
    make_depths(depths);
    for (int i = 0; i < DEPTHS; i++) {
        canonical[i] = reversed ? -depths[i] : depths[i];
        depths[i] = depths[i] == 0 && reversed ? 0 : depths[i];
    }
    memset(untouched, 0xa5, sizeof untouched);
    for (size_t count = 0; count <= DEPTHS; count += count < 40 ? 1 : DEPTHS - 40) {
        memset(texels, 0xa5, sizeof texels);
        store(format, reversed, count, canonical, texels);
        check_stored(format, reversed, count, depths, texels);
        CHECK(memcmp(texels + count * size, untouched, sizeof untouched) == 0);
    }
    store(format, reversed, DEPTHS, canonical, canonical);
    check_stored(format, reversed, DEPTHS, depths, canonical);
}

TEST(every_instruction_set_stores_depths_rounded_away_from_the_viewer) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        for (int format = 0; format < 3; format++)
            for (int reversed = 0; reversed < 2; reversed++)
                check_store(shb_shade_kernels_of(isa)->store, (shb_format)format, reversed);
}

static void check_formats(const shb_view *view, const shb_scene *scene) {
    float floats[SAMPLES], second[SAMPLES];
    uint32_t unorm24[SAMPLES];
    uint16_t unorm16[SAMPLES];
    test_contexts *contexts = test_contexts_create(1);
    shb_draw_desc desc = {.view = view,
                          .scene = scene,
                          .width = WIDTH,
                          .height = HEIGHT,
                          .depth = {floats, 0, SHB_FORMAT_FLOAT32},
                          .second = {second, 0, SHB_FORMAT_FLOAT32}};
    CHECK_INT(shb_draw(contexts->best, &desc, NULL), SHB_OK);
    /* The two layers in two formats, then the other way round. */
    for (int round = 0; round < 2; round++) {
        desc.depth = (shb_depth_image){unorm24, 0, SHB_FORMAT_UNORM24};
        desc.second = (shb_depth_image){unorm16, 0, SHB_FORMAT_UNORM16};
        if (round == 1) {
            const shb_depth_image first = desc.depth;
            desc.depth = desc.second;
            desc.second = first;
        }
        CHECK_INT(shb_draw(contexts->best, &desc, NULL), SHB_OK);
        for (int i = 0; i < SAMPLES; i++) {
            CHECK(
                is_rounded_away(unorm24[i], round ? second[i] : floats[i], MAX24, view->reversed));
            CHECK(
                is_rounded_away(unorm16[i], round ? floats[i] : second[i], MAX16, view->reversed));
        }
    }
    test_contexts_destroy(contexts);
}

/* Corners in front of the target and around it. */
static void place_corners(uint64_t seed, int count, float *positions) {
    test_random random = {seed};
    for (int i = 0; i < 3 * count; i++)
        positions[i] =
            (float)(i % 3 == 2 ? random_double(&random, 0, 1) : random_double(&random, -10, 40));
}

TEST(unorm_layers_are_the_float_layers_rounded_away_from_the_viewer) {
    enum { TRIANGLES = 80 };
    float positions[9 * TRIANGLES];
    place_corners(31, 3 * TRIANGLES, positions);
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    shb_view view = test_pixel_view(WIDTH, HEIGHT);
    check_formats(&view, &scene);
    view.reversed = true;
    check_formats(&view, &scene);
}

/* Rows longer than the target: what lies behind their end stays as it was. */
TEST(padding_between_rows_is_not_written) {
    enum { DEPTH_ROW = WIDTH + 5, SECOND_ROW = WIDTH + 3, ID_ROW = WIDTH + 1 };
    float depth[DEPTH_ROW * HEIGHT];
    uint16_t second[SECOND_ROW * HEIGHT];
    uint32_t ids[ID_ROW * HEIGHT];
    memset(depth, 0xa5, sizeof depth);
    memset(second, 0xa5, sizeof second);
    memset(ids, 0xa5, sizeof ids);
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    const float corners[] = {-1, -1, 0.5f, 200, -1, 0.5f, -1, 200, 0.5f};
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    test_contexts *contexts = test_contexts_create(1);
    const shb_draw_desc desc = {
        .view = &view,
        .scene = &scene,
        .width = WIDTH,
        .height = HEIGHT,
        .depth = {depth, sizeof(float) * DEPTH_ROW, SHB_FORMAT_FLOAT32},
        .second = {second, sizeof(uint16_t) * SECOND_ROW, SHB_FORMAT_UNORM16},
        .ids = ids,
        .id_stride = sizeof(uint32_t) * ID_ROW,
        .tile_size = 16};
    CHECK_INT(shb_draw(contexts->best, &desc, NULL), SHB_OK);
    uint32_t padding;
    memset(&padding, 0xa5, sizeof padding);
    for (int row = 0; row < HEIGHT; row++) {
        for (int i = 0; i < DEPTH_ROW; i++)
            CHECK(i < WIDTH ? depth[row * DEPTH_ROW + i] == 0.5f
                            : memcmp(&depth[row * DEPTH_ROW + i], &padding, 4) == 0);
        for (int i = 0; i < SECOND_ROW; i++)
            CHECK_INT(second[row * SECOND_ROW + i], i < WIDTH ? 0xffff : 0xa5a5);
        for (int i = 0; i < ID_ROW; i++)
            CHECK_INT(ids[row * ID_ROW + i], i < WIDTH ? 0 : padding);
    }
    test_contexts_destroy(contexts);
}

/* Any subset of the images gives the same texels as all of them. */
TEST(images_that_are_not_wanted_change_nothing) {
    enum { TRIANGLES = 60 };
    float positions[9 * TRIANGLES];
    place_corners(32, 3 * TRIANGLES, positions);
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    test_contexts *contexts = test_contexts_create(1);
    test_target all = test_target_create(WIDTH, HEIGHT);
    test_target_draw(&all, contexts, &view, &scene, 16);
    for (int wanted = 0; wanted < 8; wanted++) {
        test_target some = test_target_create(WIDTH, HEIGHT);
        shb_draw_desc desc = test_target_desc(&some, &view, &scene);
        desc.depth.texels = wanted & 1 ? some.depth : NULL;
        desc.second.texels = wanted & 2 ? some.second : NULL;
        desc.ids = wanted & 4 ? some.ids : NULL;
        CHECK_INT(shb_draw(contexts->best, &desc, NULL), SHB_OK);
        const size_t bytes = SAMPLES * 4;
        CHECK((memcmp(some.depth, all.depth, bytes) == 0) == ((wanted & 1) != 0));
        CHECK((memcmp(some.second, all.second, bytes) == 0) == ((wanted & 2) != 0));
        CHECK((memcmp(some.ids, all.ids, bytes) == 0) == ((wanted & 4) != 0));
        test_target_destroy(&some);
    }
    test_target_destroy(&all);
    test_contexts_destroy(contexts);
}
