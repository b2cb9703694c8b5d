/* What a map's occluders take of memory, and what is kept of them from one drawing to the next. */
#include "allocator.h"
#include "probe.h"
#include "soup.h"
#include "test.h"

#include <stdlib.h>

enum { SIZE = 64 };

typedef struct host {
    test_allocator allocator;
    shb_context *context;
    shb_map *map;
} host;

static void open_host(host *h, shb_occluders occluders) {
    *h = (host){.map = NULL};
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&h->allocator), .threads = 1};
    CHECK_INT(shb_context_create(&desc, &h->context), SHB_OK);
    const shb_map_desc map = {
        .view = probe_orthographic(false), .width = SIZE, .occluders = occluders};
    CHECK_INT(shb_map_create(h->context, &map, &h->map), SHB_OK);
}

static void close_host(host *h) {
    shb_map_destroy(h->map);
    shb_context_destroy(h->context);
    CHECK_INT(h->allocator.live, 0);
}

/* A floor at z = 0 and a plate over its left half at z = height, seen from above. */
static void add_plate(soup *s, float height) {
    soup_add_quad(s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    soup_add_quad(s, (float[]){-1, -1, height}, (float[]){0, -1, height}, (float[]){0, 1, height},
                  (float[]){-1, 1, height});
}

static size_t memory_of(const host *h) {
    return shb_map_get_info(h->map)->memory_bytes;
}

/* Of a point halfway between floor and plate. */
static float visibility_below(const host *h, float x) {
    static const float up[3] = {0, 0, 1};
    const float point[3] = {x, 0, 0.25f};
    const shb_points points = {.count = 1, .positions = point, .normals = up};
    const shb_bias exact = shb_bias_exact();
    float visibility = 7;
    CHECK_INT(shb_map_visibility(h->map, &points, &exact, NULL, &visibility), SHB_OK);
    return visibility;
}

TEST(planes_take_nothing_beside_the_texels) {
    static uint32_t ids[SIZE * SIZE];
    static float depths[SIZE * SIZE];
    soup s = {0};
    add_plate(&s, 0.5f);
    host h;
    open_host(&h, SHB_OCCLUDERS_PLANES);
    const size_t texels = memory_of(&h);
    const shb_draw_desc desc = {.view = &shb_map_get_info(h.map)->view,
                                .scene = soup_scene(&s),
                                .width = SIZE,
                                .height = SIZE,
                                .depth = {.texels = depths},
                                .ids = ids};
    CHECK_INT(shb_draw(h.context, &desc, NULL), SHB_OK);
    const size_t before = h.allocator.bytes;
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), NULL, NULL), SHB_OK);
    CHECK_INT(h.allocator.bytes, before);
    CHECK_INT(memory_of(&h), texels);
    soup_free(&s);
    close_host(&h);
}

/* Of 64 texels in padded rows; and 24 bytes a triangle, 24 a vertex and one more that vectors may
 * read, to know the scene again. */
TEST(classifying_takes_four_bytes_a_texel_and_the_scene) {
    soup s = {0};
    add_plate(&s, 0.5f);
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    size_t created[2], drawn[2];
    for (int classifies = 0; classifies < 2; classifies++) {
        shb_map *map = NULL;
        const shb_map_desc desc = {
            .view = probe_orthographic(false), .width = SIZE, .classifies = classifies};
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        created[classifies] = shb_map_get_info(map)->memory_bytes;
        CHECK_INT(shb_map_draw(map, soup_scene(&s), NULL, NULL), SHB_OK);
        drawn[classifies] = shb_map_get_info(map)->memory_bytes;
        shb_map_destroy(map);
    }
    CHECK_INT(created[1] - created[0], SIZE * (4 * SIZE + 64));
    CHECK_INT(drawn[0], created[0]);
    CHECK_INT(drawn[1] - created[1], 4 * 24 + (8 + 1) * 24);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(what_was_prepared_counts_on_when_occluders_are_drawn_again) {
    soup s = {0};
    add_plate(&s, 0.5f);
    const shb_filter soft = shb_filter_pcss(0.1f, 9, 9, SHB_TAPS_PLANE);
    for (int i = SHB_OCCLUDERS_PLANES; i <= SHB_OCCLUDERS_LISTS; i++) {
        host h;
        open_host(&h, (shb_occluders)i);
        CHECK_INT(shb_map_draw(h.map, soup_scene(&s), NULL, NULL), SHB_OK);
        const size_t drawn = memory_of(&h);
        CHECK_INT(shb_map_prepare(h.map, &soft), SHB_OK);
        const size_t prepared = memory_of(&h);
        CHECK(prepared > drawn);
        CHECK_INT(shb_map_draw(h.map, soup_scene(&s), NULL, NULL), SHB_OK);
        CHECK_INT(memory_of(&h), prepared);
        close_host(&h);
    }
    soup_free(&s);
}

TEST(triangles_of_a_scene_that_is_drawn_again_are_not_made_again) {
    soup s = {0};
    add_plate(&s, 0.5f);
    host h;
    open_host(&h, SHB_OCCLUDERS_TRIANGLES);
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), NULL, NULL), SHB_OK);
    const size_t calls = h.allocator.calls, bytes = memory_of(&h);
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), NULL, NULL), SHB_OK);
    CHECK_INT(h.allocator.calls, calls);
    CHECK_INT(memory_of(&h), bytes);
    CHECK(visibility_below(&h, -0.5f) == 0 && visibility_below(&h, 0.5f) == 1);
    soup_free(&s);
    close_host(&h);
}

TEST(triangles_follow_a_scene_that_changes_and_come_back) {
    const shb_bias constant = shb_bias_constant(0, SHB_UNIT_DEPTH);
    soup high = {0}, low = {0};
    add_plate(&high, 0.5f);
    add_plate(&low, 0.125f);
    host h;
    open_host(&h, SHB_OCCLUDERS_TRIANGLES);
    for (int i = 0; i < 6; i++) {
        soup *drawn = i % 3 == 2 ? &low : &high;
        if (i == 4)
            CHECK_INT(shb_map_draw(h.map, soup_scene(drawn), &constant, NULL), SHB_OK);
        CHECK_INT(shb_map_draw(h.map, soup_scene(drawn), NULL, NULL), SHB_OK);
        CHECK(visibility_below(&h, -0.5f) == (drawn == &high ? 0 : 1));
        CHECK(visibility_below(&h, 0.5f) == 1);
    }
    soup_free(&high);
    soup_free(&low);
    close_host(&h);
}

/* Memory of two drawings is enough for all that follow, but for an entry of the context's list. */
TEST(triangles_of_a_scene_that_changes_take_no_new_memory) {
    soup high = {0}, low = {0};
    add_plate(&high, 0.5f);
    add_plate(&low, 0.125f);
    host h;
    open_host(&h, SHB_OCCLUDERS_TRIANGLES);
    size_t calls = 0, bytes = 0, live = 0;
    for (int i = 0; i < 6; i++) {
        CHECK_INT(shb_map_draw(h.map, soup_scene(i % 2 ? &high : &low), NULL, NULL), SHB_OK);
        if (i >= 2) {
            CHECK_INT(h.allocator.calls - calls, 1);
            CHECK_INT(h.allocator.live, live);
            CHECK_INT(memory_of(&h), bytes);
        }
        calls = h.allocator.calls;
        live = h.allocator.live;
        bytes = memory_of(&h);
    }
    soup_free(&high);
    soup_free(&low);
    close_host(&h);
}

/* Bytes that a host has given and not got back. The size lies before each allocation. */
static void *give(void *user, size_t size, size_t alignment) {
    size_t *const given = user;
    void *memory = NULL;
    if (posix_memalign(&memory, alignment, size + 64))
        return NULL;
    *(size_t *)memory = size;
    *given += size;
    return (char *)memory + 64;
}

static void take_back(void *user, void *memory) {
    size_t *const given = user;
    void *const begin = (char *)memory - 64;
    *given -= *(size_t *)begin;
    free(begin);
}

/* Of a mesh whose triangles share no vertices. The map itself takes less than 8 KB, and lists have
 * some room to spare. */
TEST(a_map_tells_the_memory_that_it_gives_back) {
    soup s = {0};
    soup_add_ball(&s, (float[]){0, 0, 0}, 60, 30, NULL);
    for (int i = 0; i < 8; i++) {
        size_t given = 0;
        shb_context *context = NULL;
        shb_map *map = NULL;
        const shb_context_desc desc = {.allocator = {give, take_back, &given}, .threads = 1};
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        const shb_map_desc map_desc = {.view = probe_orthographic(false),
                                       .width = SIZE,
                                       .occluders = (shb_occluders)(i / 2),
                                       .classifies = i % 2};
        CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, soup_scene(&s), NULL, NULL), SHB_OK);
        const size_t told = shb_map_get_info(map)->memory_bytes, before = given;
        shb_map_destroy(map);
        CHECK(before - given >= told && before - given < told + told / 16 + 8192);
        shb_context_destroy(context);
        CHECK_INT(given, 0);
    }
    soup_free(&s);
}

/* Memory that was made for more triangles is told, and stays with the map. */
TEST(a_map_tells_the_memory_that_it_keeps_of_a_larger_scene) {
    soup plate = {0}, ball = {0};
    add_plate(&plate, 0.5f);
    soup_add_ball(&ball, (float[]){0, 0, 0}, 60, 30, NULL);
    soup *const drawn[] = {&ball, &ball, &plate, &ball, &plate, &plate};
    for (size_t count = 1; count <= sizeof drawn / sizeof *drawn; count++) {
        size_t given = 0;
        shb_context *context = NULL;
        shb_map *map = NULL;
        const shb_context_desc desc = {.allocator = {give, take_back, &given}, .threads = 1};
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        const shb_map_desc map_desc = {
            .view = probe_orthographic(false), .width = SIZE, .occluders = SHB_OCCLUDERS_TRIANGLES};
        CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
        for (size_t i = 0; i < count; i++)
            CHECK_INT(shb_map_draw(map, soup_scene(drawn[i]), NULL, NULL), SHB_OK);
        const size_t told = shb_map_get_info(map)->memory_bytes, before = given;
        shb_map_destroy(map);
        CHECK(before - given >= told && before - given < told + 8192);
        shb_context_destroy(context);
    }
    soup_free(&plate);
    soup_free(&ball);
}
