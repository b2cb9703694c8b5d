/* Certain answers: never wrong, whatever the scene, and as many as the scene allows. */
#include "../src/map.h"
#include "contexts.h"
#include "isas.h"
#include "list_samples.h"
#include "probe.h"
#include "starved.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct asked {
    size_t lit, shadowed, unsure, wrong;
} asked;

/* A map that classifies, with lists, which find their own sheets, or without occluders. */
static shb_map *draw_kind(shb_context *context, const shb_view *view, uint32_t width,
                          uint32_t height, const shb_scene *scene, bool with_lists) {
    const shb_map_desc desc = {.view = *view,
                               .width = width,
                               .height = height,
                               .occluders = with_lists ? SHB_OCCLUDERS_LISTS : SHB_OCCLUDERS_NONE,
                               .classifies = true};
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    return map;
}

static shb_map *draw(shb_context *context, const shb_view *view, uint32_t size,
                     const shb_scene *scene) {
    return draw_kind(context, view, size, size, scene, false);
}

/* Asks for samples whose truth is known, their coordinates rounded to floats. */
static asked ask(const shb_map *map, const list_samples *samples) {
    asked sums = {0};
    float *positions = malloc(3 * samples->count * sizeof *positions);
    uint8_t *answers = malloc(samples->count);
    for (size_t i = 0; i < samples->count; i++) {
        positions[3 * i] = (float)samples->x[i];
        positions[3 * i + 1] = (float)samples->y[i];
        positions[3 * i + 2] = (float)samples->z[i];
    }
    const shb_points points = {.count = samples->count, .positions = positions};
    CHECK_INT(shb_map_classify(map, &points, answers), SHB_OK);
    for (size_t i = 0; i < samples->count; i++) {
        sums.lit += answers[i] == SHB_LIGHT_LIT;
        sums.shadowed += answers[i] == SHB_LIGHT_SHADOWED;
        sums.unsure += answers[i] == SHB_LIGHT_UNSURE;
        sums.wrong += answers[i] == (samples->occluded[i] ? SHB_LIGHT_LIT : SHB_LIGHT_SHADOWED);
    }
    free(positions);
    free(answers);
    return sums;
}

/* By sizes of the map, one light and kind of depth each; returns the share of unsure points at the
 * largest. */
static double check_kind(const shb_scene *scene, const lists_light *light, bool with_lists) {
    static const uint32_t sizes[] = {8, 61, 256, 1024};
    enum { POINTS = 20000 };
    shb_context *context = lists_context(2);
    shb_reference *reference = NULL;
    shb_box box;
    double unsure = 1;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    list_samples samples = list_samples_create(scene, POINTS, 7);
    for (int i = 0; i < 4; i++) {
        const shb_view view = lists_view(light, box, sizes[i], i % 2 == 1);
        shb_map *map = draw_kind(context, &view, sizes[i], 3 * sizes[i] / 4, scene, with_lists);
        list_samples_find_truth(reference, &view, &samples);
        const asked said = ask(map, &samples);
        CHECK_INT(said.wrong, 0);
        unsure = (double)said.unsure / POINTS;
        shb_map_destroy(map);
    }
    list_samples_free(&samples);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    return unsure;
}

/* The larger share of unsure points. */
static double check_scene(const shb_scene *scene, const lists_light *light) {
    const double sheets = check_kind(scene, light, false), lists = check_kind(scene, light, true);
    return sheets > lists ? sheets : lists;
}

TEST(certain_answers_on_closed_bodies_are_right_and_most) {
    soup s = {0};
    const float center[3] = {0.3f, 0.2f, 1.4f};
    soup_add_ball(&s, center, 60, 60, NULL);
    soup_add_box(&s, (float[]){-3, -3, -1}, (float[]){3, 3, 0});
    soup_add_box(&s, (float[]){-2, -2, 0.5f}, (float[]){-1, -1, 2});
    CHECK(check_scene(soup_scene(&s), &lists_slanted) < 0.1);
    CHECK(check_scene(soup_scene(&s), &lists_grazing) < 0.2);
    CHECK(check_scene(soup_scene(&s), &lists_spot) < 0.1);
    soup_free(&s);
}

/* Open edges everywhere, and triangles that pass through each other. */
TEST(certain_answers_in_a_soup_are_right) {
    soup s = {0};
    test_random random = {31};
    for (int i = 0; i < 300; i++)
        soup_add_random(&s, &random, i % 7 == 0 ? 0.9 : 0.1);
    CHECK(check_scene(soup_scene(&s), &lists_slanted) < 0.5);
    CHECK(check_scene(soup_scene(&s), &lists_spot) < 0.5);
    soup_free(&s);
}

/* A pleated sheet turns round between the samples of the map, its parts wound at random. */
TEST(certain_answers_on_folds_are_right) {
    soup s = {0};
    test_random random = {32};
    for (int i = 0; i < 400; i++) {
        const float x = -1 + 0.005f * (float)i, next = x + (i % 2 ? 0.005f : 0.012f);
        const float z = i % 2 ? 0.3f : 0, next_z = 0.3f - z;
        const float a[3] = {x, -1, z}, b[3] = {next, -1, next_z};
        const float c[3] = {next, 1, next_z}, d[3] = {x, 1, z};
        if (random_below(&random, 2))
            soup_add_quad(&s, a, b, c, d);
        else
            soup_add_quad(&s, d, c, b, a);
    }
    soup_add_box(&s, (float[]){-2, -2, -2}, (float[]){2, 2, -1});
    check_scene(soup_scene(&s), &lists_slanted);
    check_scene(soup_scene(&s), &lists_spot);
    soup_free(&s);
}

/* Sheets of which the map's samples see one only: a lid of 0.2 texels in each. */
TEST(what_lies_between_the_samples_is_not_overlooked) {
    soup s = {0};
    soup_add_quad(&s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 16; k++) {
            const float x = -1 + 0.125f * ((float)i + 0.1f), y = -1 + 0.125f * ((float)k + 0.1f);
            const float size = 0.125f * 0.2f;
            soup_add_quad(&s, (float[]){x, y, 1}, (float[]){x + size, y, 1},
                          (float[]){x + size, y + size, 1}, (float[]){x, y + size, 1});
        }
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(false);
    shb_map *map = draw(context, &view, 16, soup_scene(&s));
    float positions[3 * 256];
    uint8_t answers[256];
    for (int i = 0; i < 256; i++) {
        positions[3 * i] = -1 + 0.125f * ((float)(i % 16) + 0.5f);
        positions[3 * i + 1] = -1 + 0.125f * ((float)(i / 16) + 0.5f);
        positions[3 * i + 2] = 0;
    }
    const shb_points points = {.count = 256, .positions = positions};
    CHECK_INT(shb_map_classify(map, &points, answers), SHB_OK);
    for (int i = 0; i < 256; i++)
        CHECK_INT(answers[i], SHB_LIGHT_UNSURE);
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

/* A plate over half of a floor, both drawn twice: of the 16 columns of texels the plate's last and
 * the outermost hold an edge, the others nothing but whole sheets. */
TEST(texels_without_an_edge_are_certain_and_twins_do_not_matter) {
    soup s = {0};
    for (int twice = 0; twice < 2; twice++) {
        soup_add_quad(&s, (float[]){-2, -2, 0}, (float[]){2, -2, 0}, (float[]){2, 2, 0},
                      (float[]){-2, 2, 0});
        soup_add_quad(&s, (float[]){-2, -2, 1}, (float[]){0.06f, -2, 1}, (float[]){0.06f, 2, 1},
                      (float[]){-2, 2, 1});
    }
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(true);
    shb_map *map = draw_kind(context, &view, 16, 32, soup_scene(&s), false);
    for (int i = 0; i < 16; i++)
        for (int height = 0; height < 2; height++) {
            const float position[3] = {-1 + 0.125f * ((float)i + 0.3f), -0.3f, (float)height};
            uint8_t answer;
            const shb_points point = {.count = 1, .positions = position};
            CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
            if (i < 8)
                CHECK_INT(answer, height ? SHB_LIGHT_LIT : SHB_LIGHT_SHADOWED);
            else if (!height)
                CHECK_INT(answer, i == 8 ? SHB_LIGHT_UNSURE : SHB_LIGHT_LIT);
        }
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(points_that_the_light_cannot_see_are_unsure) {
    soup s = {0};
    soup_add_quad(&s, (float[]){-4, -4, 2}, (float[]){4, -4, 2}, (float[]){4, 4, 2},
                  (float[]){-4, 4, 2});
    shb_context *context = lists_context(1);
    const shb_view view = probe_perspective(false);
    shb_map *map = draw(context, &view, 16, soup_scene(&s));
    const float positions[] = {0.1f, 0.1f, 2,    9,   0, 0, 0, 0,        5,
                               0,    0,    3.5f, NAN, 0, 0, 0, INFINITY, 0};
    static const uint8_t expected[] = {SHB_LIGHT_LIT, 0, 0, 0, 0, 0};
    uint8_t answers[6];
    const shb_points points = {.count = 6, .positions = positions};
    CHECK_INT(shb_map_classify(map, &points, answers), SHB_OK);
    CHECK(memcmp(answers, expected, sizeof expected) == 0);
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

/* Two level plates of so small a size that a step from one float to the next is two texels. */
TEST(points_are_unsure_where_floats_have_no_finer_steps) {
    const float step = 0x1p-149f;
    const shb_vec3 above = {0, 0x1p-144, 0}, down = {0, 0, 0}, north = {0, 0, -1};
    soup s = {0};
    for (int plate = 0; plate < 2; plate++) {
        const float half = (float)(plate ? 4 : 12) * step, y = (float)(4 * plate) * step;
        soup_add_quad(&s, (float[]){-half, y, half}, (float[]){half, y, half},
                      (float[]){half, y, -half}, (float[]){-half, y, -half});
    }
    shb_view view;
    CHECK_INT(
        shb_view_orthographic(above, down, north, 0x1p-145, 0x1p-145, 0, 0x1p-143, false, &view),
        SHB_OK);
    shb_context *context = lists_context(1);
    for (int with_lists = 0; with_lists < 2; with_lists++) {
        shb_map *map = draw_kind(context, &view, 64, 64, soup_scene(&s), with_lists);
        for (int x = -11; x < 12; x++) {
            const float position[3] = {(float)x * step, 0, step};
            const shb_points point = {.count = 1, .positions = position};
            uint8_t answer;
            CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
            CHECK_INT(answer, SHB_LIGHT_UNSURE);
        }
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
    soup_free(&s);
}

/* A blade over a floor at z = 2, from (-0.3, 2.5) to (1.5, 5.5) in x and z and 0.6 wide, through
 * the near plane and, with the spot, past the light. What the near plane leaves of it ends at x =
 * 0.6; seen from the spot at x = 0, its lower end 0.4 about the axis on the floor and its upper one
 * 0.6. A triangle that is not finite lies in no texel. */
TEST(nothing_is_lit_below_what_the_near_plane_cuts) {
    static const struct {
        bool is_spot;
        uint32_t size; /* texels are 0.125 wide on the floor */
        double begin, end, half_width, half_box;
    } cases[] = {{false, 16, -0.3, 0.6, 0.3, 0.3}, {true, 32, -0.4, 0, 0.4, 0.6}};
    soup s = {0};
    soup_add_quad(&s, (float[]){-6, -6, 2}, (float[]){6, -6, 2}, (float[]){6, 6, 2},
                  (float[]){-6, 6, 2});
    soup_add_quad(&s, (float[]){-0.3f, -0.3f, 2.5f}, (float[]){1.5f, -0.3f, 5.5f},
                  (float[]){1.5f, 0.3f, 5.5f}, (float[]){-0.3f, 0.3f, 2.5f});
    soup_add(&s, (float[]){-1, -1, 3}, (float[]){1, -1, NAN}, (float[]){1, 1, 3});
    shb_context *context = lists_context(1);
    for (int i = 0; i < 4; i++) {
        const bool is_spot = cases[i / 2].is_spot;
        const double begin = cases[i / 2].begin, end = cases[i / 2].end;
        const shb_view view = is_spot ? probe_perspective(false) : probe_orthographic(false);
        const uint32_t size = cases[i / 2].size;
        shb_map *map = draw_kind(context, &view, size, size, soup_scene(&s), i % 2);
        for (int at = 0; at < 31 * 31; at++) {
            const double limit = is_spot ? 1.9 : 0.95;
            const double x = limit * (at % 31 - 15) / 15, y = limit * (at / 31 - 15) / 15;
            const float position[3] = {(float)x, (float)y, 2};
            uint8_t answer;
            const shb_points point = {.count = 1, .positions = position};
            CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
            if (x > begin && x < end && fabs(y) < cases[i / 2].half_width)
                CHECK(answer != SHB_LIGHT_LIT);
            else if (x < begin - 0.25 || x > end + 0.25 || fabs(y) > cases[i / 2].half_box + 0.25)
                CHECK_INT(answer, SHB_LIGHT_LIT);
        }
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
    soup_free(&s);
}

/* A blade over a floor that the light sees edge-on, from (-0.4, -0.35) to (0.5, 0.4): it is told
 * nothing where the blade is, and all beside it. */
TEST(texels_with_a_triangle_seen_edge_on_are_unsure) {
    soup s = {0};
    soup_add_quad(&s, (float[]){-2, -2, 0}, (float[]){2, -2, 0}, (float[]){2, 2, 0},
                  (float[]){-2, 2, 0});
    soup_add_quad(&s, (float[]){-0.4f, -0.35f, 1}, (float[]){0.5f, 0.4f, 1},
                  (float[]){0.5f, 0.4f, 2}, (float[]){-0.4f, -0.35f, 2});
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(false);
    for (int kind = 0; kind < 2; kind++) {
        shb_map *map = draw_kind(context, &view, 16, 16, soup_scene(&s), kind);
        for (int i = 0; i < 60; i++) {
            const double along = (i / 3 + 0.5) / 20, aside = 0.2 * (i % 3 - 1);
            const float position[3] = {(float)(-0.4 + 0.9 * along - aside),
                                       (float)(-0.35 + 0.75 * along + aside), 0};
            uint8_t answer;
            const shb_points point = {.count = 1, .positions = position};
            CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
            CHECK_INT(answer, i % 3 == 1 ? SHB_LIGHT_UNSURE : SHB_LIGHT_LIT);
        }
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
    soup_free(&s);
}

/* Vertices that move in place make another scene. */
TEST(a_scene_that_changes_in_place_is_seen_anew) {
    soup s = {0};
    const float center[3] = {0, 0, 0};
    soup_add_ball(&s, center, 16, 16, NULL);
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(false);
    const shb_scene *scene = soup_scene(&s);
    shb_map *map = draw(context, &view, 16, scene);
    const float position[3] = {0.01f, 0.02f, 0.9f};
    uint8_t answer;
    const shb_points point = {.count = 1, .positions = position};
    CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
    CHECK_INT(answer, SHB_LIGHT_SHADOWED);
    for (uint32_t i = 0; i < 3 * s.count; i++)
        s.positions[3 * i] += 10;
    CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
    CHECK_INT(answer, SHB_LIGHT_UNSURE);
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

static void check_same_bounds(const shb_map *a, const shb_map *b) {
    const shb_sheets *x = shb_map_sheets(a), *y = shb_map_sheets(b);
    size_t whole = 0;
    for (size_t row = 0; row < x->height; row++) {
        const float *bounds = x->bounds + row * x->stride;
        CHECK(memcmp(bounds, y->bounds + row * y->stride, x->width * sizeof *bounds) == 0);
        for (size_t i = 0; i < x->width; i++) {
            uint32_t bits;
            memcpy(&bits, &bounds[i], sizeof bits);
            whole += bits & 1;
        }
    }
    CHECK(whole > x->height);
}

/* The map of triangles knows its scene again, but not from what another map left in the context. */
TEST(a_scene_drawn_again_is_not_classified_by_what_was_drawn_between) {
    soup ball = {0}, boxes = {0};
    soup_add_ball(&ball, (float[]){0.2f, 0.1f, 1.6f}, 40, 40, NULL);
    soup_add_box(&boxes, (float[]){-3, -3, 0}, (float[]){3, 3, 1.2f});
    for (int i = 0; i < 400; i++)
        soup_add_box(&boxes, (float[]){-1, -1, 1.5f}, (float[]){1, 1, 1.7f});
    shb_context *context = lists_context(1), *other = lists_context(1);
    const shb_map_desc desc = {.view = probe_perspective(false),
                               .width = 150,
                               .occluders = SHB_OCCLUDERS_TRIANGLES,
                               .classifies = true};
    shb_map *map = NULL, *expected = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_create(other, &desc, &expected), SHB_OK);
    CHECK_INT(shb_map_draw(expected, soup_scene(&ball), NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&ball), NULL, NULL), SHB_OK);
    shb_map_destroy(draw(context, &desc.view, 150, soup_scene(&boxes)));
    CHECK_INT(shb_map_draw(map, soup_scene(&ball), NULL, NULL), SHB_OK);
    check_same_bounds(expected, map);
    shb_map_destroy(map);
    shb_map_destroy(expected);
    shb_context_destroy(context);
    shb_context_destroy(other);
    soup_free(&ball);
    soup_free(&boxes);
}

TEST(sheets_are_the_same_for_every_instruction_set_and_any_threads) {
    soup s = {0};
    test_random random = {33};
    soup_add_ball(&s, (float[]){0.2f, 0.1f, 1.6f}, 40, 40, NULL);
    for (int i = 0; i < 100; i++)
        soup_add_random(&s, &random, 0.3);
    soup_add_box(&s, (float[]){-3, -3, 0}, (float[]){3, 3, 1.2f});
    shb_context *scalar = test_context(1, SHB_ISA_SCALAR);
    for (int kind = 0; kind < 4; kind++) {
        const shb_view view = probe_perspective(kind % 2);
        const bool with_lists = kind >= 2;
        shb_map *expected = draw_kind(scalar, &view, 150, 150, soup_scene(&s), with_lists);
        for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
             isa = test_isa_after(isa)) {
            shb_context *context = NULL;
            const shb_context_desc capped = {.threads = (uint32_t)isa, .max_isa = isa};
            CHECK_INT(shb_context_create(&capped, &context), SHB_OK);
            shb_map *map = draw_kind(context, &view, 150, 150, soup_scene(&s), with_lists);
            check_same_bounds(expected, map);
            list_samples samples = list_samples_create(soup_scene(&s), 3000, 5);
            memset(samples.occluded, 0, samples.count);
            const asked a = ask(expected, &samples), b = ask(map, &samples);
            CHECK(a.lit == b.lit && a.shadowed == b.shadowed && a.unsure == b.unsure);
            CHECK(a.lit && a.shadowed && a.unsure);
            list_samples_free(&samples);
            shb_map_destroy(map);
            shb_context_destroy(context);
        }
        shb_map_destroy(expected);
    }
    shb_context_destroy(scalar);
    soup_free(&s);
}

/* Quads one in the other over the left of a tile, more than cells of four texels have room for:
 * texels at the right, beside them in a cell and far from them, have the same bounds in larger
 * ones. */
TEST(sheets_are_the_same_in_larger_cells) {
    static const int quads[2] = {200, 1600};
    enum { POINTS = 4000, FIRST_BESIDE = 30 };
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(false);
    shb_map *maps[2];
    for (int i = 0; i < 2; i++) {
        soup s = {0};
        for (int k = 0; k < quads[i]; k++)
            soup_add_quad(&s, (float[]){-1.1f, -1.1f, 1.2f}, (float[]){-0.1f, -1.1f, 0.4f},
                          (float[]){-0.1f, 1.1f, 0.4f}, (float[]){-1.1f, 1.1f, 1.2f});
        soup_add_ball(&s, (float[]){0.4f, 0.1f, 1.4f}, 30, 30, NULL);
        soup_add_box(&s, (float[]){-2, -2, -1}, (float[]){2, 2, 0});
        maps[i] = draw_kind(context, &view, 64, 64, soup_scene(&s), true);
        CHECK_INT(maps[i]->lists->tiles[0].cell_bits, SHB_LIST_BLOCK_BITS + i);
        shb_reference *reference = NULL;
        CHECK_INT(shb_reference_create(context, soup_scene(&s), &reference), SHB_OK);
        list_samples samples = list_samples_create(soup_scene(&s), POINTS, 11);
        list_samples_find_truth(reference, &view, &samples);
        CHECK_INT(ask(maps[i], &samples).wrong, 0);
        list_samples_free(&samples);
        shb_reference_destroy(reference);
        soup_free(&s);
    }
    const shb_sheets *small = shb_map_sheets(maps[0]), *large = shb_map_sheets(maps[1]);
    for (size_t row = 0; row < 64; row++)
        CHECK(memcmp(small->bounds + row * small->stride + FIRST_BESIDE,
                     large->bounds + row * large->stride + FIRST_BESIDE,
                     (64 - FIRST_BESIDE) * sizeof *small->bounds) == 0);
    shb_map_destroy(maps[0]);
    shb_map_destroy(maps[1]);
    shb_context_destroy(context);
}

TEST(sheets_without_memory_are_an_error_at_every_allocation) {
    soup s = {0};
    soup_add_ball(&s, (float[]){0, 0, 0}, 8, 8, NULL);
    for (int kind = SHB_OCCLUDERS_NONE; kind <= SHB_OCCLUDERS_LISTS; kind++) {
        const shb_map_desc desc = {.view = probe_orthographic(false),
                                   .width = 16,
                                   .occluders = (shb_occluders)kind,
                                   .classifies = true};
        CHECK(test_starve_map(&desc, soup_scene(&s)) > 10);
    }
    soup_free(&s);
}

TEST(classifying_refuses_what_it_cannot_answer) {
    shb_context *context = lists_context(1);
    shb_map_desc desc = {.view = probe_orthographic(false), .width = 4};
    shb_map *map = NULL;
    const float position[3] = {0, 0, 0}, depths[16] = {0};
    uint8_t answer = 9;
    const shb_points point = {.count = 1, .positions = position};
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_classify(map, &point, &answer), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(answer, 9);
    shb_map_destroy(map);
    desc.classifies = true;
    CHECK_INT(shb_map_wrap(context, &desc, depths, 0, NULL, &map), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_classify(NULL, &point, &answer), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_classify(map, NULL, &answer), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_classify(map, &point, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_classify(map, &(shb_points){.count = 1}, &answer), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_classify(map, &point, &answer), SHB_OK);
    CHECK_INT(answer, SHB_LIGHT_UNSURE);
    shb_map_destroy(map);
    shb_context_destroy(context);
}

/* What a map of this kind answers, sheets asked first or not. */
static void ask_exact(shb_context *context, const shb_view *view, shb_occluders occluders,
                      bool classifies, const shb_scene *scene, const shb_points *points,
                      float *visibility) {
    const shb_map_desc desc = {
        .view = *view, .width = 61, .occluders = occluders, .classifies = classifies};
    const shb_bias exact = shb_bias_exact();
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_visibility(map, points, &exact, NULL, visibility), SHB_OK);
    shb_map_destroy(map);
}

/* Lists are right by themselves, so that nothing may change. */
TEST(lists_answer_the_same_with_sheets_before_them) {
    enum { POINTS = 3000 };
    static float positions[3 * POINTS], with[POINTS], without[POINTS];
    soup s = {0};
    test_random random = {34};
    soup_add_ball(&s, (float[]){0.1f, 0.2f, 1.5f}, 30, 30, NULL);
    for (int i = 0; i < 60; i++)
        soup_add_random(&s, &random, 0.5);
    soup_add_box(&s, (float[]){-3, -3, -3}, (float[]){3, 3, -1});
    shb_context *context = lists_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(soup_scene(&s), &box), SHB_OK);
    list_samples samples = list_samples_create(soup_scene(&s), POINTS, 8);
    for (int i = 0; i < POINTS; i++) {
        positions[3 * i] = (float)samples.x[i];
        positions[3 * i + 1] = (float)samples.y[i];
        positions[3 * i + 2] = (float)samples.z[i];
    }
    const shb_points points = {.count = POINTS, .positions = positions};
    for (int spot = 0; spot < 2; spot++) {
        const shb_view view = lists_view(spot ? &lists_spot : &lists_slanted, box, 61, spot);
        ask_exact(context, &view, SHB_OCCLUDERS_LISTS, false, soup_scene(&s), &points, without);
        ask_exact(context, &view, SHB_OCCLUDERS_LISTS, true, soup_scene(&s), &points, with);
        CHECK(memcmp(with, without, sizeof with) == 0);
    }
    list_samples_free(&samples);
    shb_context_destroy(context);
    soup_free(&s);
}

/* On planes the sample of each texel tells as much. */
TEST(planes_answer_the_same_with_sheets_before_them) {
    soup s = {0};
    soup_add_quad(&s, (float[]){-2, -2, 0}, (float[]){2, -2, 0}, (float[]){2, 2, 0},
                  (float[]){-2, 2, 0});
    soup_add_quad(&s, (float[]){-2, -2, 1}, (float[]){0.03f, -2, 1}, (float[]){0.03f, 2, 1},
                  (float[]){-2, 2, 1});
    shb_context *context = lists_context(1);
    const shb_view view = probe_orthographic(false);
    static float positions[3 * 200], normals[3 * 200], with[200], without[200];
    for (int i = 0; i < 200; i++) {
        positions[3 * i] = -0.995f + 0.01f * (float)i;
        positions[3 * i + 1] = 0.21f;
        normals[3 * i + 2] = 1;
    }
    const shb_points points = {.count = 200, .positions = positions, .normals = normals};
    ask_exact(context, &view, SHB_OCCLUDERS_PLANES, false, soup_scene(&s), &points, without);
    ask_exact(context, &view, SHB_OCCLUDERS_PLANES, true, soup_scene(&s), &points, with);
    CHECK(memcmp(with, without, sizeof with) == 0);
    CHECK(with[0] == 0 && with[199] == 1);
    shb_context_destroy(context);
    soup_free(&s);
}
