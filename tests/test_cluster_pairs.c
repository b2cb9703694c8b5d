#include "contexts.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "soup.h"
#include "target.h"
#include "test.h"

/* Clusters whose snapped coordinates fit into 16 bits are drawn by vectors of pairs. Whatever their
 * size and place they have to give the bits of the scalar code, which knows no clusters. */

#define SIZE 512

/* A cluster of 128 triangles. */
typedef struct pair_case {
    float x, y, width, height; /* pixels: the box that two of the triangles span */
    float largest;             /* size of a triangle; all others are small */
    float quantum;             /* of coordinates */
    shb_cull cull;
} pair_case;

static float quantized(test_random *random, float from, float size, float quantum) {
    const float steps = size / quantum;
    return from + quantum * (float)random_below(random, (uint32_t)steps + 1);
}

static void add_at(soup *s, test_random *random, const pair_case *c, float x, float y, float size) {
    float corners[3][3];
    for (int k = 0; k < 3; k++) {
        corners[k][0] = quantized(random, x, size, c->quantum);
        corners[k][1] = quantized(random, y, size, c->quantum);
        corners[k][2] = 0.0625f + (float)random_below(random, 1000) / 1024;
    }
    soup_add(s, corners[0], corners[1], corners[2]);
}

/* Its box is exactly this large. */
static void add_spanning(soup *s, float x, float y, float width, float height) {
    const float a[3] = {x, y, 0.5f}, b[3] = {x + width, y + height / 2, 0.25f};
    const float c[3] = {x + width / 2, y + height, 0.75f};
    soup_add(s, a, b, c);
}

static void fill_soup(soup *s, test_random *random, const pair_case *c) {
    add_spanning(s, c->x, c->y, 2, 2);
    add_spanning(s, c->x + c->width - 2, c->y + c->height - 2, 2, 2);
    if (c->largest > 0)
        add_spanning(s, c->x, c->y, c->largest, c->largest);
    while (s->count < 128) {
        const float size = s->count % 2 ? 2 : s->count % 3 ? 8 : 1;
        add_at(s, random, c, quantized(random, c->x, c->width - size, c->quantum),
               quantized(random, c->y, c->height - size, c->quantum), size);
    }
}

static void check_against_scalar(const shb_scene *plain, const shb_scene *clustered,
                                 uint32_t tile_size) {
    const shb_view view = test_pixel_view(SIZE, SIZE);
    test_target expected = test_target_create(SIZE, SIZE);
    shb_draw_stats stats = {0};
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa++) {
        shb_context *context = test_context(1, isa);
        if (shb_context_isa(context) == isa) {
            const bool scalar = isa == SHB_ISA_SCALAR;
            test_target found = test_target_create(SIZE, SIZE);
            shb_draw_desc desc =
                test_target_desc(scalar ? &expected : &found, &view, scalar ? plain : clustered);
            shb_draw_stats counted = {0};
            desc.tile_size = tile_size;
            CHECK_INT(shb_draw(context, &desc, scalar ? &stats : &counted), SHB_OK);
            CHECK(scalar || test_target_equal(&found, &expected));
            CHECK(scalar || (counted.drawn == stats.drawn && counted.culled == stats.culled));
            desc.second.texels = NULL;
            desc.ids = NULL;
            CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
            for (size_t i = 0; i < (size_t)SIZE * SIZE; i++)
                if (!scalar && found.depth[i] != expected.depth[i])
                    CHECK_INT(i, SIZE * SIZE);
            test_target_destroy(&found);
        }
        shb_context_destroy(context);
    }
    CHECK(stats.drawn > 0);
    test_target_destroy(&expected);
}

static void check_case(test_random *random, const pair_case *c, uint32_t tile_size) {
    soup s = {0};
    fill_soup(&s, random, c);
    shb_context *context = NULL;
    shb_clusters *clusters = NULL;
    context = test_context(0, SHB_ISA_BEST);
    const shb_scene *plain = soup_scene(&s);
    CHECK_INT(shb_clusters_create(context, plain->instances[0].mesh, &clusters), SHB_OK);
    shb_mesh mesh = *plain->instances[0].mesh;
    mesh.clusters = clusters;
    s.instance.cull = c->cull;
    shb_instance instance = plain->instances[0];
    instance.mesh = &mesh;
    instance.cull = c->cull;
    check_against_scalar(plain, &(shb_scene){&instance, 1}, tile_size);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(clusters_up_to_and_beyond_what_pairs_reach_are_drawn_as_without_them) {
    test_random random = {41};
    const float extents[] = {17, 200, 252.5f, 253, 253.75f, 254, 254.5f, 255, 256, 257, 300};
    for (size_t i = 0; i < sizeof extents / sizeof *extents; i++)
        for (int tall = 0; tall < 2; tall++) {
            const pair_case c = {.x = 100.25f + (float)i / 256,
                                 .y = 99.75f,
                                 .width = tall ? 40 : extents[i],
                                 .height = tall ? extents[i] : 40,
                                 .quantum = 1.0f / 1024};
            check_case(&random, &c, 0);
        }
}

TEST(triangles_as_large_as_pairs_can_hold_are_drawn_as_without_clusters) {
    test_random random = {42};
    const float sizes[] = {60, 64, 65, 120, 125.5f, 126, 126.25f, 127, 127.5f, 128, 129, 180};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const pair_case c = {.x = 130 + (float)i * 0.3125f,
                             .y = 140.5f,
                             .width = 230,
                             .height = 240,
                             .largest = sizes[i],
                             .quantum = 1.0f / 256};
        check_case(&random, &c, i % 3 ? 0 : 64);
    }
}

TEST(pairs_across_borders_and_tiles_and_on_centres_are_drawn_as_without_clusters) {
    test_random random = {43};
    const float places[][2] = {{-40, -30}, {-60, 200}, {480, 490}, {300, -20}, {200, 225}};
    const float quanta[] = {0.5f, 0.25f, 1.0f / 256};
    const shb_cull culls[] = {SHB_CULL_NONE, SHB_CULL_BACK, SHB_CULL_FRONT};
    for (size_t i = 0; i < 5; i++)
        for (size_t j = 0; j < 3; j++) {
            const pair_case c = {.x = places[i][0],
                                 .y = places[i][1],
                                 .width = 96,
                                 .height = 80,
                                 .largest = j == 1 ? 50 : 0,
                                 .quantum = quanta[j],
                                 .cull = culls[(i + j) % 3]};
            check_case(&random, &c, j == 2 ? 32 : 0);
        }
}
