/* The hard filter and the texels under it: wrapped arrays with known contents. */
#include "contexts.h"
#include "probe.h"
#include "test.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 5, HEIGHT = 3 };

/* A host's array with gaps between its rows. */
typedef struct host_map {
    shb_context *context;
    shb_map *map;
    SHB_ALIGN unsigned char texels[HEIGHT][64];
} host_map;

static void open_map(host_map *host, shb_view view, shb_format format) {
    memset(host->texels, 0xa5, sizeof host->texels);
    host->context = test_context(1, SHB_ISA_BEST);
    const shb_map_desc desc = {.view = view, .width = WIDTH, .height = HEIGHT, .format = format};
    CHECK_INT(shb_map_wrap(host->context, &desc, host->texels, 64, NULL, &host->map), SHB_OK);
}

static void close_map(host_map *host) {
    shb_map_destroy(host->map);
    shb_context_destroy(host->context);
}

/* Writes the integer of a unorm format, or the bits of a float. */
static void put(host_map *host, int x, int y, shb_format format, uint32_t value) {
    const uint16_t narrow = (uint16_t)value;
    if (format == SHB_FORMAT_UNORM16)
        memcpy(host->texels[y] + 2 * x, &narrow, 2);
    else
        memcpy(host->texels[y] + 4 * x, &value, 4);
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    return bits;
}

static void fill(host_map *host, shb_format format, uint32_t value) {
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            put(host, x, y, format, value);
}

static float fetch(const host_map *host, int x, int y) {
    const int32_t column = x, row = y;
    float depth = -7;
    shb_map_fetch(host->map, 1, &column, &row, &depth);
    return depth;
}

/* Every texel holds its own number; gaps hold another one. */
TEST(fetch_reads_every_texel_of_every_format) {
    const shb_format formats[] = {SHB_FORMAT_FLOAT32, SHB_FORMAT_UNORM24, SHB_FORMAT_UNORM16};
    for (int i = 0; i < 6; i++) {
        const shb_format format = formats[i / 2];
        const bool reversed = i & 1;
        host_map host;
        open_map(&host, probe_orthographic(reversed), format);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const uint32_t k = (uint32_t)(1000 * y + x + 17);
                put(&host, x, y, format,
                    format == SHB_FORMAT_FLOAT32 ? bits_of((float)k / 4096) : k);
            }
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const float k = (float)(1000 * y + x + 17);
                const float stored = format == SHB_FORMAT_FLOAT32   ? k / 4096
                                     : format == SHB_FORMAT_UNORM24 ? k / 16777215
                                                                    : k / 65535;
                CHECK(fetch(&host, x, y) == (reversed ? -stored : stored));
            }
        close_map(&host);
    }
}

TEST(fetch_gives_the_far_depth_outside) {
    const int outside[][2] = {{-1, 0},
                              {WIDTH, 0},
                              {0, -1},
                              {0, HEIGHT},
                              {SHB_TEXEL_NONE, SHB_TEXEL_NONE},
                              {1 << 20, -(1 << 20)}};
    for (int reversed = 0; reversed < 2; reversed++) {
        host_map host;
        open_map(&host, probe_orthographic(reversed), SHB_FORMAT_FLOAT32);
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(0.5f));
        for (int i = 0; i < 6; i++)
            CHECK(fetch(&host, outside[i][0], outside[i][1]) == (reversed ? 0.0f : 1.0f));
        close_map(&host);
    }
}

/* Extremes of the unorm formats are exactly 0 and 1. */
TEST(unorm_depths_span_the_range) {
    host_map host;
    open_map(&host, probe_orthographic(false), SHB_FORMAT_UNORM24);
    put(&host, 0, 0, SHB_FORMAT_UNORM24, 0xffffff);
    put(&host, 1, 0, SHB_FORMAT_UNORM24, 0);
    CHECK(fetch(&host, 0, 0) == 1);
    CHECK(fetch(&host, 1, 0) == 0);
    close_map(&host);
    open_map(&host, probe_orthographic(false), SHB_FORMAT_UNORM16);
    put(&host, 0, 0, SHB_FORMAT_UNORM16, 0xffff);
    CHECK(fetch(&host, 0, 0) == 1);
    close_map(&host);
}

TEST(fetch_takes_any_count) {
    host_map host;
    open_map(&host, probe_orthographic(false), SHB_FORMAT_FLOAT32);
    fill(&host, SHB_FORMAT_FLOAT32, bits_of(0.25f));
    const size_t counts[] = {0, 1, 17, 300};
    for (int i = 0; i < 4; i++) {
        int32_t x[301] = {0}, y[301] = {0};
        float depth[301];
        for (int k = 0; k < 301; k++)
            depth[k] = -3;
        shb_map_fetch(host.map, counts[i], x, y, depth);
        for (size_t k = 0; k < 301; k++)
            CHECK(depth[k] == (k < counts[i] ? 0.25f : -3));
    }
    close_map(&host);
}

static float visibility_at(const host_map *host, const shb_bias *bias, shb_vec3 point) {
    const float position[3] = {(float)point.x, (float)point.y, (float)point.z};
    const shb_points points = {.count = 1, .positions = position};
    const shb_filter hard = shb_filter_hard();
    float visibility = -1;
    CHECK_INT(shb_map_visibility(host->map, &points, bias, &hard, &visibility), SHB_OK);
    return visibility;
}

/* Depth is (4 - z) / 8: z = 0 is at 0.5. One unit in the last place decides. */
TEST(hard_shadows_what_is_strictly_nearer) {
    const shb_bias none = shb_bias_none();
    host_map host;
    for (int reversed = 0; reversed < 2; reversed++) {
        open_map(&host, probe_orthographic(reversed), SHB_FORMAT_FLOAT32);
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(0.5f));
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == 1);
        const float nearer = reversed ? nextafterf(0.5f, 1) : nextafterf(0.5f, 0);
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(nearer));
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == 0);
        const float behind = reversed ? nextafterf(0.5f, 0) : nextafterf(0.5f, 1);
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(behind));
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == 1);
        close_map(&host);
    }
}

/* 0.5 lies between the steps 32767 and 32768 of 65535, and 8388607 and 8388608 of 16777215. */
TEST(hard_compares_quantized_depths) {
    const shb_bias none = shb_bias_none();
    const struct {
        shb_format format;
        uint32_t below;
    } cases[] = {{SHB_FORMAT_UNORM16, 32767}, {SHB_FORMAT_UNORM24, 8388607}};
    for (int i = 0; i < 4; i++) {
        const bool reversed = i & 1;
        host_map host;
        open_map(&host, probe_orthographic(reversed), cases[i / 2].format);
        fill(&host, cases[i / 2].format, cases[i / 2].below);
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == (reversed ? 1.0f : 0.0f));
        fill(&host, cases[i / 2].format, cases[i / 2].below + 1);
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == (reversed ? 0.0f : 1.0f));
        close_map(&host);
    }
}

TEST(hard_reads_the_texel_that_holds_the_fragment) {
    const shb_bias none = shb_bias_none();
    host_map host;
    open_map(&host, probe_orthographic(false), SHB_FORMAT_FLOAT32);
    fill(&host, SHB_FORMAT_FLOAT32, bits_of(1));
    put(&host, 3, 1, SHB_FORMAT_FLOAT32, bits_of(0.25f)); /* x 0.2 .. 0.6, y -1/3 .. 1/3 */
    CHECK(visibility_at(&host, &none, (shb_vec3){0.21, 0.33, 0}) == 0);
    CHECK(visibility_at(&host, &none, (shb_vec3){0.59, -0.33, 0}) == 0);
    CHECK(visibility_at(&host, &none, (shb_vec3){0.19, 0, 0}) == 1);
    CHECK(visibility_at(&host, &none, (shb_vec3){0.61, 0, 0}) == 1);
    CHECK(visibility_at(&host, &none, (shb_vec3){0.4, 0.34, 0}) == 1);
    CHECK(visibility_at(&host, &none, (shb_vec3){0.4, -0.34, 0}) == 1);
    close_map(&host);
}

TEST(fragments_that_the_map_does_not_hold_are_lit) {
    const shb_bias none = shb_bias_none();
    const shb_vec3 points[] = {{1.01, 0, 0},    {-1.01, 0, 0},   {0, 1.01, 0},    {0, -1.01, 0},
                               {nan(""), 0, 0}, {0, nan(""), 0}, {0, 0, nan("")}, {HUGE_VAL, 0, 0},
                               {3e38, 0, -9},   {0, 0, 5},       {0, 0, 4}};
    for (int reversed = 0; reversed < 2; reversed++) {
        host_map host;
        open_map(&host, probe_perspective(reversed), SHB_FORMAT_FLOAT32);
        /* nearer than anything */
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(reversed ? 3e38f : -3e38f));
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 2}) == 0);
        for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
            const bool beside = i < 4;
            const shb_vec3 point = {points[i].x, points[i].y, beside ? 3 : points[i].z};
            CHECK(visibility_at(&host, &none, point) == 1);
        }
        close_map(&host);
    }
}

/* Beyond the far plane a fragment counts as lying on it: what is nearer shadows it, an empty texel
 * does not, whatever the bias is. */
TEST(fragments_beyond_the_far_plane_are_tested_on_it) {
    for (int reversed = 0; reversed < 2; reversed++) {
        host_map host;
        open_map(&host, probe_orthographic(reversed), SHB_FORMAT_FLOAT32);
        const float far_depth = reversed ? 0.0f : 1.0f;
        const shb_bias none = shb_bias_none();
        const shb_bias towards_far = shb_bias_constant(-10, SHB_UNIT_DEPTH);
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(far_depth));
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, -100}) == 1);
        CHECK(visibility_at(&host, &towards_far, (shb_vec3){0, 0, 0}) == 1);
        fill(&host, SHB_FORMAT_FLOAT32, bits_of(nextafterf(far_depth, 0.5f)));
        CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, -100}) == 0);
        CHECK(visibility_at(&host, &towards_far, (shb_vec3){0, 0, 0}) == 0);
        close_map(&host);
    }
}

static void write_nan(const shb_bias_args *args) {
    for (size_t i = 0; i < args->count; i++)
        args->receivers->ref[i] = NAN;
}

TEST(what_is_not_a_number_is_lit) {
    const shb_bias none = shb_bias_none();
    const shb_bias undefined = {.name = "undefined", .depth = write_nan};
    host_map host;
    open_map(&host, probe_orthographic(false), SHB_FORMAT_FLOAT32);
    fill(&host, SHB_FORMAT_FLOAT32, bits_of(0));
    CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == 0);
    CHECK(visibility_at(&host, &undefined, (shb_vec3){0, 0, 0}) == 1);
    fill(&host, SHB_FORMAT_FLOAT32, bits_of(NAN));
    CHECK(visibility_at(&host, &none, (shb_vec3){0, 0, 0}) == 1);
    close_map(&host);
}
