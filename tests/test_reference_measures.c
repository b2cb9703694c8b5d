/* Errors counted by hand, and the detachment of shadows whose bias is known. */
#include "shadowbias/reference.h"

#include <math.h>

#include "contexts.h"
#include "soup.h"
#include "test.h"

/* ---- errors ---- */

TEST(errors_are_counted_by_truth_and_boundary) {
    enum { L = SHB_TRUTH_LIT, S = SHB_TRUTH_SHADOWED, B = SHB_TRUTH_BOUNDARY, COUNT = 16 };
    const uint8_t truth[COUNT] = {L, L, L,     L,     L | B, L | B, L | B, S,
                                  S, S, S | B, S | B, S | B, S | B, 0,     0};
    const float visibility[COUNT] = {1, 0.5f, 0.4999f, 0,    1,     0,    0.25f, 0,
                                     1, 0.4f, 1,       0.5f, 0.75f, 0.1f, 0,     1};
    shb_errors errors;
    CHECK_INT(shb_errors_measure(COUNT, truth, visibility, &errors), SHB_OK);
    CHECK_INT(errors.lit, 7);
    CHECK_INT(errors.shadowed, 7);
    CHECK_INT(errors.false_shadow, 2);
    CHECK_INT(errors.false_light, 1);
    CHECK_INT(errors.boundary_shadow, 2);
    CHECK_INT(errors.boundary_light, 3);
    CHECK_NEAR(errors.false_shadow_ppm, 2e6 / 7, 1e-6);
    CHECK_NEAR(errors.false_light_ppm, 1e6 / 7, 1e-6);
    CHECK_NEAR(errors.boundary_ppm, 5e6 / 14, 1e-6);
    CHECK_INT(errors.wrong, 8);
    CHECK_NEAR(errors.wrong_ppm, 8e6 / 14, 1e-6);
}

TEST(errors_of_nothing_are_zero) {
    const uint8_t truth[2] = {SHB_TRUTH_NONE, SHB_TRUTH_NONE};
    const float visibility[2] = {0, 1};
    for (size_t count = 0; count < 3; count++) {
        shb_errors errors;
        CHECK_INT(
            shb_errors_measure(count, count ? truth : NULL, count ? visibility : NULL, &errors),
            SHB_OK);
        CHECK(errors.lit == 0 && errors.shadowed == 0 && errors.false_shadow == 0);
        CHECK(errors.false_shadow_ppm == 0 && errors.false_light_ppm == 0);
        CHECK(errors.boundary_ppm == 0);
    }
}

TEST(errors_refuse_bad_arguments) {
    const uint8_t truth = SHB_TRUTH_LIT;
    const float visibility = 1;
    shb_errors errors = {.lit = 99};
    CHECK_INT(shb_errors_measure(1, NULL, &visibility, &errors), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_errors_measure(1, &truth, NULL, &errors), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_errors_measure(1, &truth, &visibility, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(errors.lit, 99);
}

/* ---- detachment ---- */

/* A wall 8 high stands on x = 0 of the ground z = 0; the light comes along (0.6, 0, 0.8). Probes
 * run along -x. The probe at x = -s is shadowed by the wall's point at height s * 8 / 6, which lies
 * s / 0.6 before it; truly shadowed are s = 0 .. 6. The light's map looks at the origin from 50
 * units away: the ground at x = -s lies 50 + 0.6 s away, near and far are 0 and 100. */
typedef struct wall {
    soup soup;
    shb_context *context;
    shb_reference *reference;
    shb_view light;
} wall;

static wall make_wall(void) {
    wall w = {0};
    soup_add_quad(&w.soup, (float[3]){-20, -20, 0}, (float[3]){20, -20, 0}, (float[3]){20, 20, 0},
                  (float[3]){-20, 20, 0});
    soup_add_quad(&w.soup, (float[3]){0, -15, 0}, (float[3]){0, 15, 0}, (float[3]){0, 15, 8},
                  (float[3]){0, -15, 8});
    w.context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(w.context, soup_scene(&w.soup), &w.reference), SHB_OK);
    CHECK_INT(shb_view_orthographic((shb_vec3){30, 0, 40}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    16, 16, 0, 100, false, &w.light),
              SHB_OK);
    return w;
}

static void wall_end(wall *w) {
    shb_reference_destroy(w->reference);
    shb_context_destroy(w->context);
    soup_free(&w->soup);
}

static shb_detachment_desc probe(const shb_map *map, const shb_bias *bias) {
    return (shb_detachment_desc){.map = map,
                                 .bias = bias,
                                 .contact = {0, 1, 0},
                                 .direction = {-1, 0, 0},
                                 .normal = {0, 0, 1},
                                 .length = 8,
                                 .samples = 800,
                                 .receiver_id = 0};
}

TEST(detachment_is_the_last_falsely_lit_probe) {
    /* A map of 2 x 2 texels, 16 units wide each, holds one depth: 51 units away. A constant bias of
     * 1.0055 units lights what is nearer than 52.0055 units: 0.6 s <= 2.0055, s <= 3.3425. Samples
     * lie at 0.005, 0.015, ...: the last one is 3.335. 600 of 800 samples are in shadow. */
    wall w = make_wall();
    const float depths[4] = {0.51f, 0.51f, 0.51f, 0.51f};
    const shb_map_desc desc = {.view = w.light, .width = 2};
    shb_map *map;
    CHECK_INT(shb_map_wrap(w.context, &desc, depths, 0, NULL, &map), SHB_OK);
    const shb_bias bias = shb_bias_constant(1.0055f, SHB_UNIT_WORLD);
    const shb_detachment_desc attached = probe(map, &bias);
    shb_detachment found;
    CHECK_INT(shb_detachment_measure(w.reference, &attached, &found), SHB_OK);
    CHECK_NEAR(found.world, 3.335, 1e-12);
    CHECK_NEAR(found.texels, 3.335 / 16, 1e-9);
    CHECK_INT(found.probed, 600);
    shb_map_destroy(map);
    wall_end(&w);
}

TEST(detachment_of_a_drawn_map_follows_the_bias) {
    /* In the map columns run along (0.8, 0, -0.6) in texels of 1/8 unit. On the wall the depth
     * changes by 0.8 per 0.6 units of columns, so that sampling at texel centres moves the depth by
     * up to 1/16 * 0.8 / 0.6 = 0.083 units. A bias of 2 units hides the wall as long as it is no
     * more than 2 units before the probe: s / 0.6 = 2 +- 0.083. Without bias all is shadowed but
     * what the sampling lights: s / 0.6 = 0.083. */
    wall w = make_wall();
    const shb_map_desc desc = {.view = w.light, .width = 256};
    shb_map *map;
    CHECK_INT(shb_map_create(w.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&w.soup), NULL, NULL), SHB_OK);
    for (int k = 0; k < 2; k++) {
        const double units = k ? 2 : 0;
        const shb_bias bias = shb_bias_constant((float)units, SHB_UNIT_WORLD);
        shb_detachment_desc probes = probe(map, &bias);
        probes.length = 5;
        probes.samples = 500;
        shb_detachment found;
        CHECK_INT(shb_detachment_measure(w.reference, &probes, &found), SHB_OK);
        CHECK_NEAR(found.world, 0.6 * units, 0.6 * 0.0834 + 0.006);
        CHECK_NEAR(found.texels, found.world * 8, 1e-9);
        CHECK_INT(found.probed, 500);
    }
    shb_map_destroy(map);
    wall_end(&w);
}

TEST(detachment_of_an_empty_map_is_the_whole_shadow) {
    wall w = make_wall();
    const shb_map_desc desc = {.view = w.light, .width = 32};
    shb_map *map;
    CHECK_INT(shb_map_create(w.context, &desc, &map), SHB_OK);
    const shb_bias bias = shb_bias_none();
    shb_detachment_desc probes = probe(map, &bias);
    shb_detachment found;
    CHECK_INT(shb_detachment_measure(w.reference, &probes, &found), SHB_OK);
    CHECK_NEAR(found.world, 5.995, 1e-12);
    CHECK_INT(found.probed, 600);
    /* Away from the wall nothing is shadowed. */
    probes.direction = (shb_vec3){1, 0, 0};
    CHECK_INT(shb_detachment_measure(w.reference, &probes, &found), SHB_OK);
    CHECK(found.world == 0 && found.texels == 0);
    CHECK_INT(found.probed, 0);
    shb_map_destroy(map);
    wall_end(&w);
}

TEST(detachment_refuses_bad_arguments) {
    wall w = make_wall();
    const shb_map_desc desc = {.view = w.light, .width = 32};
    shb_map *map;
    CHECK_INT(shb_map_create(w.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&w.soup), NULL, NULL), SHB_OK);
    const shb_bias none = shb_bias_none(), flipped = shb_bias_back_face();
    const shb_detachment_desc good = probe(map, &none);
    shb_detachment found = {.probed = 99};
    shb_detachment_desc bad[10];
    for (int i = 0; i < 10; i++)
        bad[i] = good;
    bad[0].map = NULL;
    bad[1].bias = NULL;
    bad[2].direction = (shb_vec3){-1.001, 0, 0};
    bad[3].direction.y = (double)NAN;
    bad[4].contact.x = HUGE_VAL;
    bad[5].normal.z = (double)NAN;
    bad[6].length = 0;
    bad[7].samples = 0;
    bad[8].samples = (1u << 20) + 1;
    bad[9].bias = &flipped;
    const shb_result results[10] = {SHB_ERROR_ARGUMENT,   SHB_ERROR_ARGUMENT, SHB_ERROR_ARGUMENT,
                                    SHB_ERROR_NUMBER,     SHB_ERROR_NUMBER,   SHB_ERROR_NUMBER,
                                    SHB_ERROR_NUMBER,     SHB_ERROR_SIZE,     SHB_ERROR_SIZE,
                                    SHB_ERROR_UNSUPPORTED};
    for (int i = 0; i < 10; i++)
        CHECK_INT(shb_detachment_measure(w.reference, &bad[i], &found), results[i]);
    CHECK_INT(shb_detachment_measure(NULL, &good, &found), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_detachment_measure(w.reference, NULL, &found), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_detachment_measure(w.reference, &good, NULL), SHB_ERROR_ARGUMENT);
    shb_map_destroy(map);
    shb_map_desc behind = {.width = 32};
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 20}, (shb_vec3){0, 0, 40}, (shb_vec3){0, 1, 0},
                                   1, 1, 1, 100, false, &behind.view),
              SHB_OK);
    CHECK_INT(shb_map_create(w.context, &behind, &map), SHB_OK);
    const shb_detachment_desc dark = probe(map, &none);
    CHECK_INT(shb_detachment_measure(w.reference, &dark, &found), SHB_ERROR_ARGUMENT);
    CHECK_INT(found.probed, 99);
    shb_map_destroy(map);
    wall_end(&w);
}
