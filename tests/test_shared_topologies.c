/* Maps of one context that are drawn with one scene share what they keep of it. */
#include "allocator.h"
#include "probe.h"
#include "soup.h"
#include "test.h"

enum { MAPS = 2 };

typedef struct two_maps {
    test_allocator allocator;
    shb_context *context;
    shb_map *maps[MAPS];
    soup high, low; /* a plate over a floor */
} two_maps;

static void add_plate(soup *s, float height) {
    soup_add_quad(s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    soup_add_quad(s, (float[]){-1, -1, height}, (float[]){0, -1, height}, (float[]){0, 1, height},
                  (float[]){-1, 1, height});
}

static void open_maps(two_maps *t, bool classifies) {
    *t = (two_maps){.context = NULL};
    add_plate(&t->high, 0.5f);
    add_plate(&t->low, 0.125f);
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&t->allocator), .threads = 1};
    CHECK_INT(shb_context_create(&desc, &t->context), SHB_OK);
    const shb_map_desc map = {.view = probe_orthographic(false),
                              .width = 64,
                              .occluders = SHB_OCCLUDERS_TRIANGLES,
                              .classifies = classifies};
    for (int i = 0; i < MAPS; i++)
        CHECK_INT(shb_map_create(t->context, &map, &t->maps[i]), SHB_OK);
}

static void close_maps(two_maps *t, int first) {
    shb_map_destroy(t->maps[first]);
    shb_map_destroy(t->maps[1 - first]);
    shb_context_destroy(t->context);
    soup_free(&t->high);
    soup_free(&t->low);
    CHECK_INT(t->allocator.live, 0);
}

static shb_result draw(two_maps *t, int map, soup *scene) {
    return shb_map_draw(t->maps[map], soup_scene(scene), NULL, NULL);
}

/* Visibility of a point at the middle of the high plate's height, below it: is it drawn? */
static bool sees_high(const two_maps *t, int map) {
    static const float up[3] = {0, 0, 1}, point[3] = {-0.5f, 0, 0.25f};
    const shb_points points = {.count = 1, .positions = point, .normals = up};
    const shb_bias exact = shb_bias_exact();
    float visibility = 7;
    CHECK_INT(shb_map_visibility(t->maps[map], &points, &exact, NULL, &visibility), SHB_OK);
    CHECK(visibility == 0 || visibility == 1);
    return visibility == 0;
}

/* What is allocated, and how often, while a map is drawn. */
static test_allocator drawing(two_maps *t, int map, soup *scene) {
    const test_allocator before = t->allocator;
    CHECK_INT(draw(t, map, scene), SHB_OK);
    return (test_allocator){.calls = t->allocator.calls - before.calls,
                            .live = t->allocator.live - before.live};
}

/* A topology is 4 allocations that stay: corners, neighbours, positions and the entry of the
 * context's list. Planes, world planes and triangles are 3. */
TEST(maps_of_one_scene_share_its_topology) {
    for (int first = 0; first < MAPS; first++) {
        two_maps t;
        open_maps(&t, false);
        CHECK_INT(draw(&t, first, &t.high), SHB_OK);
        const test_allocator second = drawing(&t, 1 - first, &t.high);
        CHECK_INT(second.live, 3);
        CHECK_INT(second.calls, 3);
        CHECK_INT(shb_map_get_info(t.maps[0])->memory_bytes,
                  shb_map_get_info(t.maps[1])->memory_bytes);
        const size_t live = t.allocator.live;
        shb_map_destroy(t.maps[first]);
        t.maps[first] = NULL;
        CHECK(sees_high(&t, 1 - first));
        CHECK(live - t.allocator.live > 3);
        const size_t kept = t.allocator.live;
        shb_map_destroy(t.maps[1 - first]);
        t.maps[1 - first] = NULL;
        CHECK_INT(kept - t.allocator.live, live - kept + 4);
        close_maps(&t, first);
    }
}

TEST(a_map_stays_as_it_is_while_another_follows_a_changed_scene) {
    for (int i = 0; i < 4; i++) {
        two_maps t;
        open_maps(&t, i / 2);
        CHECK_INT(draw(&t, 0, &t.high), SHB_OK);
        CHECK_INT(draw(&t, 1, &t.high), SHB_OK);
        CHECK_INT(draw(&t, 0, &t.low), SHB_OK);
        CHECK(!sees_high(&t, 0) && sees_high(&t, 1));
        CHECK_INT(draw(&t, 1, &t.low), SHB_OK);
        CHECK(!sees_high(&t, 0) && !sees_high(&t, 1));
        CHECK_INT(draw(&t, 1, &t.high), SHB_OK);
        CHECK(!sees_high(&t, 0) && sees_high(&t, 1));
        close_maps(&t, i % 2);
    }
}

/* Memory ends at the first allocation of the drawing, the second and so on. */
TEST(maps_that_share_stay_as_they_are_when_memory_ends) {
    for (int i = 0; i < 4; i++) {
        const bool both = i % 2;
        shb_result result = SHB_ERROR_MEMORY;
        for (size_t failing = 1; result == SHB_ERROR_MEMORY && failing < 100; failing++) {
            two_maps t;
            open_maps(&t, i / 2);
            CHECK_INT(draw(&t, 0, &t.high), SHB_OK);
            CHECK_INT(draw(&t, 1, both ? &t.high : &t.low), SHB_OK);
            const size_t bytes = shb_map_get_info(t.maps[0])->memory_bytes;
            t.allocator.fail_at = t.allocator.calls + failing;
            result = draw(&t, 0, &t.low);
            CHECK(sees_high(&t, 0) == (result != SHB_OK));
            CHECK(sees_high(&t, 1) == both);
            CHECK_INT(shb_map_get_info(t.maps[0])->memory_bytes, bytes);
            t.allocator.fail_at = 0;
            CHECK_INT(draw(&t, 0, &t.low), SHB_OK);
            CHECK(!sees_high(&t, 0));
            close_maps(&t, failing % 2);
        }
        CHECK_INT(result, SHB_OK);
    }
}
