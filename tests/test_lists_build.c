/* What lists are made of: the same for every unit, thread and instruction set; memory, errors. */
#include "list_samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "allocator.h"
#include "contexts.h"
#include "probe.h"
#include "test.h"

static void make_soup(soup *s, float scale) {
    test_random random = {8};
    for (int i = 0; i < 300; i++)
        soup_add_random(s, &random, 0.2);
    for (size_t i = 0; i < 9 * (size_t)s->count; i++)
        s->positions[i] *= scale;
}

/* The cell that holds a texel: its entries, and how far they reach. */
typedef struct cell_view {
    const shb_list_entry *entries;
    size_t count;
    float far;
} cell_view;

static cell_view cell_at(const shb_lists *lists, uint32_t column, uint32_t row) {
    const shb_list_tile *tile =
        &lists->tiles[row / SHB_LIST_TILE * lists->tile_columns + column / SHB_LIST_TILE];
    if (tile->cell_bits < 0)
        return (cell_view){.far = HUGE_VALF};
    const uint32_t x = column % SHB_LIST_TILE >> tile->cell_bits;
    const uint32_t y = row % SHB_LIST_TILE >> tile->cell_bits;
    const shb_list_cell *cell =
        &lists->cells[tile->first_cell + (y << (SHB_LIST_TILE_BITS - tile->cell_bits)) + x];
    return (cell_view){lists->entries + tile->first_entry + cell[0].start,
                       cell[1].start - cell[0].start, cell[0].far};
}

static size_t count_entries(const shb_lists *lists) {
    size_t count = 0;
    for (uint32_t row = 0; row < lists->height; row++)
        for (uint32_t column = 0; column < lists->width; column++)
            count += cell_at(lists, column, row).count;
    return count;
}

/* The same entries in the same order in every texel. */
static bool lists_equal(const shb_lists *a, const shb_lists *b) {
    if (a->width != b->width || a->height != b->height)
        return false;
    for (uint32_t row = 0; row < a->height; row++)
        for (uint32_t column = 0; column < a->width; column++) {
            const cell_view x = cell_at(a, column, row), y = cell_at(b, column, row);
            if (x.count != y.count)
                return false;
            if (x.count && memcmp(x.entries, y.entries, x.count * sizeof *x.entries) != 0)
                return false;
        }
    return true;
}

/* Entries of the cell left of a triangle whose left edge is a 2^-10th of a texel beside it; height
 * is that of its third corner, which the near plane cuts off from 4 on. */
static size_t count_beside_edge(float height, bool with_sheets) {
    enum { SIZE = 64 };
    const float left = -0.5f + 0x1p-15f;
    soup s = {0};
    soup_add(&s, (float[]){left, -0.5f, 0}, (float[]){left + 0.5f, 0, height},
             (float[]){left, 0.5f, 0});
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(false);
    shb_lists *lists = NULL;
    shb_lists_desc desc = lists_desc(&view, SIZE, soup_scene(&s));
    desc.with_sheets = with_sheets;
    CHECK_INT(shb_lists_build(context, &desc, &lists), SHB_OK);
    CHECK_INT(cell_at(lists, 16, SIZE / 2).count, 1);
    const size_t count = cell_at(lists, 15, SIZE / 2).count;
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
    return count;
}

TEST(cells_of_sheets_hold_what_points_are_rounded_away_from) {
    CHECK_INT(count_beside_edge(1, false), 0);
    CHECK_INT(count_beside_edge(1, true), 1);
    CHECK_INT(count_beside_edge(5, true), 1);
}

TEST(lists_do_not_depend_on_the_unit_of_length) {
    shb_context *context = lists_context(1);
    shb_lists *lists[3];
    list_samples points[3];
    soup s[3] = {{0}, {0}, {0}};
    for (int i = 0; i < 3; i++) {
        const float scale = i == 0 ? 1 : i == 1 ? 0x1p20f : 0x1p-30f;
        make_soup(&s[i], scale);
        shb_box box;
        CHECK_INT(shb_scene_bounds(soup_scene(&s[i]), &box), SHB_OK);
        const shb_view view = lists_view(&lists_slanted, box, 128, true);
        lists[i] = lists_of(context, &view, 128, soup_scene(&s[i]));
        points[i] = list_samples_create(soup_scene(&s[i]), 2000, 9);
        list_samples_ask(lists[i], &points[i], false, 0);
        CHECK(lists_equal(lists[0], lists[i]));
        CHECK(memcmp(points[0].visibility, points[i].visibility, 2000 * sizeof(float)) == 0);
    }
    for (int i = 0; i < 3; i++) {
        list_samples_free(&points[i]);
        shb_lists_destroy(lists[i]);
        soup_free(&s[i]);
    }
    shb_context_destroy(context);
}

TEST(lists_do_not_depend_on_threads) {
    soup s = {0};
    test_random random = {10};
    for (int i = 0; i < 5000; i++)
        soup_add_random(&s, &random, i % 50 == 0 ? 0.9 : 0.05);
    const shb_box box = {{-2, -2, -2}, {2, 2, 2}};
    const shb_view view = lists_view(&lists_spot, box, 300, true);
    shb_context *one = lists_context(1), *four = lists_context(4);
    shb_lists *a = lists_of(one, &view, 300, soup_scene(&s));
    shb_lists *b = lists_of(four, &view, 300, soup_scene(&s));
    CHECK(lists_equal(a, b));
    CHECK(memcmp(a->triangles, b->triangles, a->id_count * sizeof *a->triangles) == 0);
    CHECK(count_entries(a) > 5000);
    shb_lists_destroy(a);
    shb_lists_destroy(b);
    shb_context_destroy(one);
    shb_context_destroy(four);
    soup_free(&s);
}

TEST(lists_do_not_depend_on_the_instruction_set) {
    soup s = {0};
    test_random random = {13};
    for (int i = 0; i < 3000; i++)
        soup_add_random(&s, &random, i % 50 == 0 ? 0.9 : 0.05);
    const shb_view view = lists_view(&lists_spot, (shb_box){{-2, -2, -2}, {2, 2, 2}}, 300, true);
    shb_context *best = lists_context(1), *scalar = NULL;
    scalar = test_context(1, SHB_ISA_SCALAR);
    shb_lists *a = lists_of(best, &view, 300, soup_scene(&s));
    shb_lists *b = lists_of(scalar, &view, 300, soup_scene(&s));
    CHECK(lists_equal(a, b));
    CHECK(memcmp(a->triangles, b->triangles, a->id_count * sizeof *a->triangles) == 0);
    list_samples x = list_samples_create(soup_scene(&s), 3000, 14);
    list_samples y = list_samples_create(soup_scene(&s), 3000, 14);
    list_samples_ask(a, &x, false, 0x1p-24);
    list_samples_ask(b, &y, false, 0x1p-24);
    CHECK(memcmp(x.visibility, y.visibility, 3000 * sizeof(float)) == 0);
    list_samples_free(&x);
    list_samples_free(&y);
    shb_lists_destroy(a);
    shb_lists_destroy(b);
    shb_context_destroy(best);
    shb_context_destroy(scalar);
    soup_free(&s);
}

TEST(lists_under_a_memory_cap_are_smaller_and_say_the_same) {
    soup s = {0};
    make_soup(&s, 1);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = lists_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_view view = lists_view(&lists_slanted, box, 512, true);
    shb_lists *all = lists_of(context, &view, 512, scene),
              *least = lists_of(context, &view, 1, scene);
    const size_t cap = (all->memory_bytes + 3 * least->memory_bytes) / 4;
    shb_lists *capped = NULL;
    shb_lists_desc desc = lists_desc(&view, 512, scene);
    desc.memory_cap = cap;
    CHECK_INT(shb_lists_build(context, &desc, &capped), SHB_OK);
    CHECK(capped->memory_bytes <= cap && capped->width < 512);
    list_samples a = list_samples_create(scene, 3000, 11), b = list_samples_create(scene, 3000, 11);
    list_samples_ask(all, &a, true, 0);
    list_samples_ask(capped, &b, true, 0);
    CHECK(memcmp(a.visibility, b.visibility, 3000 * sizeof(float)) == 0);
    shb_lists *none = NULL;
    desc.memory_cap = least->memory_bytes - 1;
    CHECK_INT(shb_lists_build(context, &desc, &none), SHB_ERROR_MEMORY);
    CHECK(none == NULL);
    list_samples_free(&a);
    list_samples_free(&b);
    shb_lists_destroy(all);
    shb_lists_destroy(least);
    shb_lists_destroy(capped);
    shb_context_destroy(context);
    soup_free(&s);
}

static shb_map *make_map(shb_context *context, const shb_view *view, size_t occluder_memory) {
    const shb_map_desc desc = {.view = *view,
                               .width = 256,
                               .occluders = SHB_OCCLUDERS_LISTS,
                               .occluder_memory = occluder_memory};
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    return map;
}

TEST(a_map_keeps_to_the_memory_for_its_occluders_and_says_the_same) {
    enum { COUNT = 2000 };
    soup s = {0};
    make_soup(&s, 1);
    const shb_scene *scene = soup_scene(&s);
    test_log log = {0};
    shb_context *context = NULL;
    const shb_context_desc desc = {.threads = 1, .log = test_log_keep, .log_user = &log};
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_view view = lists_view(&lists_slanted, box, 256, true);
    shb_map *free_map = make_map(context, &view, 0);
    const size_t texels = shb_map_get_info(free_map)->memory_bytes;
    CHECK_INT(shb_map_draw(free_map, scene, NULL, NULL), SHB_OK);
    const size_t all = shb_map_get_info(free_map)->memory_bytes - texels;
    shb_lists *least = lists_of(context, &view, 1, scene);
    const size_t cap = (all + 3 * least->memory_bytes) / 4;
    shb_map *capped = make_map(context, &view, cap);
    CHECK_INT(shb_map_draw(capped, scene, NULL, NULL), SHB_OK);
    CHECK(shb_map_get_info(capped)->memory_bytes - texels <= cap && cap < all);

    list_samples points = list_samples_create(scene, COUNT, 17);
    static float positions[3 * COUNT], a[COUNT], b[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        positions[3 * i] = (float)points.x[i];
        positions[3 * i + 1] = (float)points.y[i];
        positions[3 * i + 2] = (float)points.z[i];
    }
    const shb_points asked = {.count = COUNT, .positions = positions};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_map_visibility(free_map, &asked, &exact, NULL, a), SHB_OK);
    CHECK_INT(shb_map_visibility(capped, &asked, &exact, NULL, b), SHB_OK);
    CHECK(memcmp(a, b, sizeof a) == 0);

    shb_map *tight = make_map(context, &view, least->memory_bytes - 1);
    CHECK_INT(shb_map_draw(tight, scene, NULL, NULL), SHB_ERROR_MEMORY);
    CHECK(strstr(log.sentence, "shb_map_draw") && strstr(log.sentence, "desc.occluder_memory"));
    CHECK_INT(shb_map_get_info(tight)->memory_bytes, texels);
    shb_lists_destroy(least);
    shb_map_destroy(free_map);
    shb_map_destroy(capped);
    shb_map_destroy(tight);
    list_samples_free(&points);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(lists_without_memory_fail_and_leak_nothing) {
    soup s = {0};
    make_soup(&s, 1);
    const shb_view view = lists_view(&lists_slanted, (shb_box){{-2, -2, -2}, {2, 2, 2}}, 64, true);
    shb_result result = SHB_ERROR_MEMORY;
    for (size_t step = 1; result != SHB_OK; step++) {
        test_allocator allocator = {0};
        shb_context *context;
        const shb_context_desc desc = {.allocator = test_allocator_hooks(&allocator), .threads = 1};
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        allocator.calls = 0;
        allocator.fail_at = step;
        shb_lists *lists = NULL;
        const shb_lists_desc lists_64 = lists_desc(&view, 64, soup_scene(&s));
        result = shb_lists_build(context, &lists_64, &lists);
        CHECK(result == SHB_OK ? step > 10 : result == SHB_ERROR_MEMORY && !lists);
        shb_lists_destroy(lists);
        shb_context_destroy(context);
        CHECK_INT(allocator.live, 0);
    }
    soup_free(&s);
}

TEST(a_map_with_lists_answers_as_rays_without_normals) {
    soup s = {0};
    const float ground_lo[3] = {-2, -2, -1}, ground_hi[3] = {2, 2, 0};
    soup_add_box(&s, ground_lo, ground_hi);
    const float lo[3] = {-0.4f, -0.3f, 0}, hi[3] = {0.5f, 0.4f, 1};
    soup_add_box(&s, lo, hi);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = lists_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_map_desc desc = {.view = lists_view(&lists_slanted, box, 16, true),
                               .width = 16,
                               .occluders = SHB_OCCLUDERS_LISTS};
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    const size_t before = shb_map_get_info(map)->memory_bytes;
    for (int draw = 0; draw < 2; draw++)
        CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    CHECK(shb_map_get_info(map)->memory_bytes > before);
    CHECK(shb_map_get_info(map)->draw_seconds > 0);

    shb_reference *reference = NULL;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    list_samples points = list_samples_create(scene, 3000, 12);
    list_samples_find_truth(reference, &desc.view, &points);
    float *positions = malloc(points.count * 3 * sizeof *positions);
    for (size_t i = 0; i < points.count; i++) {
        positions[3 * i] = (float)points.x[i];
        positions[3 * i + 1] = (float)points.y[i];
        positions[3 * i + 2] = (float)points.z[i];
    }
    const shb_points asked = {.count = points.count, .positions = positions};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_map_visibility(map, &asked, &exact, NULL, points.visibility), SHB_OK);
    CHECK(list_samples_occluded(&points) > 300);
    CHECK_INT(list_samples_false_shadow(&points), 0);
    CHECK(list_samples_false_light(&points) <= 4); /* the ground under the box: contact */
    free(positions);
    list_samples_free(&points);
    shb_reference_destroy(reference);
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

/* Texels are (x + 1) * 8 and (1 - y) * 8, depth -z / 20. One corner lies before the near plane; the
 * others are seen at (16, 16) and (8, 0) with depth 0.05. */
TEST(what_the_near_plane_cuts_has_a_plane_unless_that_overflows) {
    const double corners[3][3] = {{-1, -1, 1}, {1, -1, -1}, {0, 1, -1}};
    const double not_finite[3][3] = {{-1, -1, 1e100}, {1, -1, -1}, {0, 1, -1}};
    shb_view view;
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 0}, (shb_vec3){0, 0, -1}, (shb_vec3){0, 1, 0},
                                    1, 1, 0, 20, false, &view),
              SHB_OK);
    shb_list_frame frame;
    CHECK_INT(shb_list_frame_init(&view, 16, 16, &frame), SHB_OK);
    shb_list_frame_fit(&frame, 1, &(shb_list_extent){1, 0, 1});
    shb_list_triangle triangle;
    shb_list_box box;
    shb_list_triangle_cut(&frame, corners, &triangle, &box);
    CHECK(!shb_list_box_is_none(&box) && triangle.bound < 1e-12f);
    CHECK_NEAR(shb_list_behind(&triangle, 16, 16, 0.05), 0, 1e-12);
    CHECK_NEAR(shb_list_behind(&triangle, 8, 0, 0.05), 0, 1e-12);
    CHECK_NEAR(shb_list_behind(&triangle, 0, 16, -0.05), 0, 1e-12);
    shb_list_triangle_cut(&frame, not_finite, &triangle, &box);
    CHECK(shb_list_box_is_none(&box));
    frame.errors[2] = HUGE_VAL;
    shb_list_triangle_cut(&frame, corners, &triangle, &box);
    CHECK(!shb_list_box_is_none(&box) && triangle.bound == HUGE_VALF);
}
