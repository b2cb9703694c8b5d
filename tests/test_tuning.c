/* The search for the smallest constants, on a plane where they are known by hand. */
#include "tuning.h"

#include "overhead.h"
#include "shapes.h"
#include "test.h"

enum { MAP_SIZE = 64 };
static const double rise = 0.75; /* of the plane, per unit of x */

typedef struct setting {
    overhead scene;
    shb_map *map;
    measure_truth truth;
    tuning_subject subject;
} setting;

static void open_setting(setting *s) {
    owned_mesh mesh = {0};
    shape_quad(&mesh, (shb_vec3){-1, -rise, 1}, (shb_vec3){1, rise, 1}, (shb_vec3){1, rise, -1},
               (shb_vec3){-1, -rise, -1});
    overhead_open(&s->scene, &mesh, NULL, MAP_SIZE);
    CHECK_INT(shb_map_create(s->scene.context, &s->scene.map, &s->map), SHB_OK);
    CHECK_INT(shb_map_draw(s->map, &s->scene.scene->scene, NULL, NULL), SHB_OK);
    CHECK_INT(measure_truth_create(&s->scene.frame, s->map, &s->truth), SHB_OK);
    s->subject = (tuning_subject){&s->scene.frame, measure_positions(&s->scene.frame),
                                  s->truth.fragments, s->map};
}

static void close_setting(setting *s) {
    measure_truth_destroy(&s->truth);
    shb_map_destroy(s->map);
    overhead_close(&s->scene);
}

static tuned_smallest smallest_of(const setting *s, shb_bias start, size_t count, double limit) {
    tuned_smallest found = {0};
    const tuning_goal goal = {count, 500, limit};
    CHECK_INT(tuning_smallest(&s->subject, &start, &goal, &found), SHB_OK);
    return found;
}

/* The plane's depth changes by this much over a texel. */
static double slope_of(const setting *s) {
    return rise * overhead_texel(&s->scene) / OVERHEAD_RANGE;
}

/* A fragment lies at most half a texel behind the centre of its own; the last hundredth of them
 * have the last hundredth of a texel. */
TEST(tuner_finds_half_a_texel_of_depth_for_a_tilted_plane) {
    setting s;
    open_setting(&s);
    const shb_bias start = shb_bias_constant(0.002f, SHB_UNIT_DEPTH);
    const tuned_smallest all = smallest_of(&s, start, 1, 0);
    CHECK(all.met);
    CHECK_NEAR((double)all.tuned.bias.params[0], 0.5 * slope_of(&s),
               0.5 * slope_of(&s) * (TUNING_TOLERANCE + 0.002));
    const tuned_smallest most = smallest_of(&s, start, 1, 100000);
    CHECK(most.met);
    CHECK_NEAR((double)most.tuned.bias.params[0], 0.4 * slope_of(&s),
               0.4 * slope_of(&s) * (TUNING_TOLERANCE + 0.01));
    close_setting(&s);
}

/* The factor of a slope is in texels: half of one, without units. */
TEST(tuner_finds_a_slope_factor_of_a_half) {
    setting s;
    open_setting(&s);
    const tuned_smallest found = smallest_of(&s, shb_bias_slope(1.1f, 0, 0), 1, 0);
    CHECK(found.met);
    CHECK_NEAR((double)found.tuned.bias.params[0], 0.5, 0.5 * (TUNING_TOLERANCE + 0.002));
    close_setting(&s);
}

TEST(tuner_meets_the_limit_and_a_step_below_misses_it) {
    static const double limits[] = {0, 100, 20000};
    setting s;
    open_setting(&s);
    const shb_bias starts[] = {shb_bias_constant(0.002f, SHB_UNIT_DEPTH),
                               shb_bias_slope(1.1f, 4, 0), shb_bias_angle(0.001f, 0.01f),
                               shb_bias_normal_offset(1.5f, 1e-5f), shb_bias_dual_layer(0.01f)};
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
        for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
            const size_t count = i == 2 ? 2 : 1;
            const tuned_smallest found = smallest_of(&s, starts[i], count, limits[k]);
            tuned below = {.bias = found.tuned.bias};
            CHECK(found.met && found.tuned.errors.false_shadow_ppm <= limits[k]);
            for (size_t p = 0; p < count; p++)
                below.bias.params[p] *= 1 - 1.05f * (float)TUNING_TOLERANCE;
            CHECK_INT(tuning_ask(&s.subject, &below), SHB_OK);
            CHECK(below.errors.false_shadow_ppm > limits[k]);
        }
    close_setting(&s);
}

TEST(tuner_needs_nothing_where_the_plane_is_known_and_everything_may_be_wrong) {
    setting s;
    open_setting(&s);
    const tuned_smallest free = smallest_of(&s, shb_bias_constant(0.002f, SHB_UNIT_DEPTH), 1, 1e6);
    CHECK(free.met && free.factor <= 0 && free.tuned.errors.false_shadow > 0);
    const tuned_smallest plane = smallest_of(&s, shb_bias_receiver_plane(1e-5f), 1, 100);
    CHECK(plane.met && plane.tuned.bias.params[0] < 1e-6f);
    close_setting(&s);
}

/* A constant of the wrong sign never helps; the least that it does is nothing. */
TEST(tuner_tells_that_a_limit_is_out_of_reach) {
    setting s;
    open_setting(&s);
    const shb_bias wrong_way = shb_bias_constant(-0.002f, SHB_UNIT_DEPTH);
    const tuned_smallest found = smallest_of(&s, wrong_way, 1, 100);
    CHECK(!found.met);
    CHECK(found.tuned.errors.false_shadow_ppm > 400000 &&
          found.tuned.errors.false_shadow_ppm < 600000);
    close_setting(&s);
}
