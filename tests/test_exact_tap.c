/* The mutual test of one texel, by hand: texels are world units, depth is world z. */
#include "../src/exact.h"
#include "test.h"

static const shb_light_rows unit_rows = {
    .x = {1, 0, 0, 0}, .y = {0, 1, 0, 0}, .z = {0, 0, 1, 0}, .w = {0, 0, 0, 1}};

/* A fragment a quarter of a texel to the right of the centre of texel (2, 3), at depth 0.5, on a
 * plane whose depth changes by slope for a texel to the right. */
static shb_exact_fragment fragment_on_slope(double slope) {
    const double position[3] = {2.75, 3.5, 0.5}, normal[3] = {-slope, 0, 1};
    return shb_exact_fragment_of(&unit_rows, position, normal);
}

/* The sample at that centre, at depth 0.45, of an occluder with such a slope. */
static shb_exact_sample sample_on_slope(double slope) {
    return (shb_exact_sample){.center_x = 2.5, .center_y = 3.5, .depth = 0.45, .slope_x = slope};
}

/* At the fragment the occluder's depth is 0.45 + 0.25 * slope. */
TEST(an_occluder_that_falls_behind_the_fragment_does_not_shadow_it) {
    const shb_exact_fragment level = fragment_on_slope(0);
    const shb_exact_sample falling = sample_on_slope(0.4); /* 0.55 there */
    const shb_exact_sample rising = sample_on_slope(-0.4); /* 0.35 there */
    CHECK(!shb_exact_is_shadowed(&level, &falling));
    CHECK(shb_exact_is_shadowed(&level, &rising));
}

/* At the centre the fragment's plane has the depth 0.5 - 0.25 * slope. */
TEST(a_sample_behind_the_fragments_plane_does_not_shadow_it) {
    const shb_exact_sample level = sample_on_slope(0);
    const shb_exact_fragment in_front = fragment_on_slope(0.4); /* 0.4 there */
    const shb_exact_fragment behind = fragment_on_slope(-0.4);  /* 0.6 there */
    CHECK(!shb_exact_is_shadowed(&in_front, &level));
    CHECK(shb_exact_is_shadowed(&behind, &level));
}

/* Planes that meet in the centre and at the fragment are one surface, whatever rounding does. */
TEST(a_sample_of_the_fragments_own_plane_does_not_shadow_it) {
    const shb_exact_fragment fragment = fragment_on_slope(0.3);
    shb_exact_sample sample = sample_on_slope(0.3);
    sample.depth = 0.5 - 0.3 * 0.25;
    CHECK(!shb_exact_is_shadowed(&fragment, &sample));
    sample.depth -= 1e-6;
    CHECK(shb_exact_is_shadowed(&fragment, &sample));
}

/* A plane that falls away to the left of the fragment's level one, from an edge beside the centre
 * on, as a convex body does; the sample holds it where snapping has moved the edge over the centre,
 * which is by 1/512 = 0.00195 texel at most. */
static shb_exact_sample sample_beyond_edge(double edge_from_center) {
    shb_exact_sample sample = sample_on_slope(-2);
    sample.depth = 0.5 + 2 * edge_from_center;
    return sample;
}

TEST(a_convex_edge_that_snapping_moved_over_a_sample_does_not_shadow_it) {
    const shb_exact_fragment level = fragment_on_slope(0);
    const shb_exact_sample moved = sample_beyond_edge(-0.0019), far = sample_beyond_edge(-0.002);
    CHECK(!shb_exact_is_shadowed(&level, &moved));
    CHECK(shb_exact_is_shadowed(&level, &far));
}
