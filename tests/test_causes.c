/* Why fragments are wrong: scenes where the cause is known by how they are made. The light shines
 * straight down on 64 x 64 texels, so that texels begin at multiples of 1/32. */
#include "causes.h"

#include "cause_picture.h"
#include "light_space.h"
#include "overhead.h"
#include "shapes.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

enum { MAP_SIZE = 64 };
static const double texel = 2.0 / MAP_SIZE;

/* A sheet between two lines of x over all z, from one height to another. */
static void add_sheet(owned_mesh *mesh, double left, double right, double y_left, double y_right) {
    shape_quad(mesh, (shb_vec3){left, y_left, 1}, (shb_vec3){right, y_right, 1},
               (shb_vec3){right, y_right, -1}, (shb_vec3){left, y_left, -1});
}

typedef struct scene {
    owned_mesh seen, unseen;
    shb_filter filter;      /* hard unless a test sets another */
    const uint16_t *texels; /* depths of a host, or NULL: the library draws */
} scene;

static scene new_scene(void) {
    return (scene){.filter = shb_filter_hard()};
}

static void make_map(const scene *s, overhead *o, const shb_bias *bias, shb_map **map) {
    const bool exact = bias->needs & SHB_NEEDS_OCCLUDERS;
    o->map.format = s->texels ? SHB_FORMAT_UNORM16 : SHB_FORMAT_FLOAT32;
    o->map.occluders = exact ? SHB_OCCLUDERS_PLANES : SHB_OCCLUDERS_NONE;
    if (s->texels) {
        CHECK_INT(shb_map_wrap(o->context, &o->map, s->texels, 0, NULL, map), SHB_OK);
        return;
    }
    CHECK_INT(shb_map_create(o->context, &o->map, map), SHB_OK);
    CHECK_INT(shb_map_draw(*map, &o->scene->scene, bias, NULL), SHB_OK);
}

/* The causes of a method's errors; the meshes are taken. */
static cause_counts counts_of(scene *s, shb_bias bias) {
    overhead o;
    shb_map *map = NULL;
    measure_truth truth;
    shb_errors errors = {0};
    overhead_open(&o, &s->seen, &s->unseen, MAP_SIZE);
    make_map(s, &o, &bias, &map);
    CHECK_INT(measure_truth_create(&o.frame, map, &truth), SHB_OK);
    uint8_t *causes = malloc(o.frame.fragment_count + 1);
    const cause_question question = {&o.frame, &truth, map, &bias, &s->filter};
    CHECK_INT(causes_find(&question, causes), SHB_OK);
    const cause_counts counts = causes_count(&question, causes);
    CHECK_INT(
        shb_errors_measure(o.frame.fragment_count, truth.fragments, o.frame.visibility, &errors),
        SHB_OK);
    CHECK_INT(counts.wrong, errors.wrong);
    CHECK_INT(counts.fragments, errors.lit + errors.shadowed);
    free(causes);
    measure_truth_destroy(&truth);
    shb_map_destroy(map);
    overhead_close(&o);
    return counts;
}

/* Every error is of this one kind, and there are at least so many. */
static void check_all(uint64_t of_kind, const cause_counts *counts, double least_share) {
    CHECK_INT(of_kind, counts->wrong);
    CHECK((double)counts->wrong >= least_share * (double)counts->fragments);
}

TEST(acne_of_a_tilted_plane_without_bias_is_by_slope) {
    scene s = new_scene();
    add_sheet(&s.seen, -1, 1, -0.75, 0.75);
    const cause_counts counts = counts_of(&s, shb_bias_none());
    CHECK((double)counts.wrong > 0.4 * (double)counts.fragments);
    /* All but those whom rounding alone keeps from the centre of their texel. */
    CHECK(counts.acne[CAUSE_QUANTISATION] <= 3);
    CHECK_INT(counts.acne[CAUSE_SLOPE] + counts.acne[CAUSE_QUANTISATION], counts.wrong);
}

/* A step of 0.01 over the left half of the floor, and a bias of four times that. */
TEST(leak_under_a_low_step_is_by_bias) {
    const shb_bias biases[] = {shb_bias_constant(0.04f / (float)OVERHEAD_RANGE, SHB_UNIT_DEPTH),
                               shb_bias_adaptive(0.04f, 1), shb_bias_normal_offset(0, 0.01f)};
    for (size_t i = 0; i < sizeof biases / sizeof *biases; i++) {
        scene s = new_scene();
        add_sheet(&s.seen, -1, 1, 0, 0);
        add_sheet(&s.unseen, -1, 0.013, 0.01, 0.01);
        const cause_counts counts = counts_of(&s, biases[i]);
        check_all(counts.leak[CAUSE_BIAS], &counts, 0.4);
    }
}

/* The map keeps the middle between step and floor, 0.005 above it; the bias alone would do. */
TEST(leak_through_a_combined_depth_is_by_bias) {
    scene s = new_scene();
    add_sheet(&s.seen, -1, 1, 0, 0);
    add_sheet(&s.unseen, -1, 0, 0.01, 0.01);
    shb_bias behind = shb_bias_constant(0.007f / (float)OVERHEAD_RANGE, SHB_UNIT_DEPTH);
    behind.combine = shb_bias_midpoint().combine;
    const cause_counts counts = counts_of(&s, behind);
    check_all(counts.leak[CAUSE_BIAS], &counts, 0.4);
}

/* Depth (2 - y) / 4 times 65535 ends on .4 here: rounded to the nearest, it lies before the floor.
 */
TEST(acne_of_a_level_floor_in_16_bits_is_by_quantisation) {
    const double depth = 30000.4 / 65535, y = 2 - OVERHEAD_RANGE * depth;
    uint16_t texels[MAP_SIZE * MAP_SIZE];
    scene s = new_scene();
    for (size_t i = 0; i < MAP_SIZE * MAP_SIZE; i++)
        texels[i] = (uint16_t)lround(depth * 65535);
    s.texels = texels;
    add_sheet(&s.seen, -1, 1, y, y);
    const cause_counts counts = counts_of(&s, shb_bias_none());
    check_all(counts.acne[CAUSE_QUANTISATION], &counts, 0.99);
}

/* The step lies 0.2 units of 16 bits above the floor, and both become the same depth. */
TEST(leak_of_a_gap_below_a_unit_of_16_bits_is_by_quantisation) {
    const double unit = OVERHEAD_RANGE / 65535, floor = 2 - OVERHEAD_RANGE * 30000.3 / 65535;
    uint16_t texels[MAP_SIZE * MAP_SIZE];
    scene s = new_scene();
    for (size_t i = 0; i < MAP_SIZE * MAP_SIZE; i++)
        texels[i] = 30001;
    s.texels = texels;
    add_sheet(&s.seen, -1, 1, floor, floor);
    add_sheet(&s.unseen, -1, 1, floor + 0.2 * unit, floor + 0.2 * unit);
    const cause_counts counts = counts_of(&s, shb_bias_none());
    check_all(counts.leak[CAUSE_QUANTISATION], &counts, 0.99);
}

/* Two slopes meet in a valley in the middle of a texel. */
TEST(acne_of_planes_in_a_valley_is_by_crease) {
    const double middle = 0.4 * texel;
    scene s = new_scene();
    add_sheet(&s.seen, -1, middle, 1, 0);
    add_sheet(&s.seen, middle, 1, 0, 1);
    const cause_counts counts = counts_of(&s, shb_bias_adaptive(1e-6f, 1));
    check_all(counts.acne[CAUSE_CREASE], &counts, 0.001);
}

/* A plate far above the floor whose border runs through a texel. */
TEST(errors_at_the_border_of_a_plate_are_by_sampling) {
    const shb_bias biases[] = {shb_bias_constant(1e-4f, SHB_UNIT_DEPTH),
                               shb_bias_adaptive(1e-4f, 1), shb_bias_exact()};
    for (size_t i = 0; i < sizeof biases / sizeof *biases; i++)
        for (int side = 0; side < 2; side++) {
            scene s = new_scene();
            add_sheet(&s.seen, -1, 1, 0, 0);
            add_sheet(&s.unseen, -1, (side ? 0.7 : 0.3) * texel, 1, 1);
            const cause_counts counts = counts_of(&s, biases[i]);
            check_all(side ? counts.acne[CAUSE_SAMPLING] : counts.leak[CAUSE_SAMPLING], &counts,
                      0.001);
        }
}

/* The floor of a trench of four texels: one tap lies in it, seven of eleven do not. At the ends of
 * the map the filter's taps are lit. */
TEST(acne_in_a_trench_under_a_wide_filter_is_by_kernel) {
    scene s = new_scene();
    add_sheet(&s.seen, -2 * texel, 2 * texel, 0, 0);
    add_sheet(&s.unseen, -1, -2 * texel, 1, 1);
    add_sheet(&s.unseen, 2 * texel, 1, 1, 1);
    s.filter = shb_filter_pcf(11, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const cause_counts counts = counts_of(&s, shb_bias_constant(1e-4f, SHB_UNIT_DEPTH));
    check_all(counts.acne[CAUSE_KERNEL], &counts, 0.7);
}

/* A tilted floor under a plate high above it, whose border is that of a texel: every fragment asks
 * the right texel until its point is moved along the normal, out of the shadow or into it. */
TEST(errors_of_a_moved_point_beside_a_border_are_by_offset) {
    for (int side = 0; side < 2; side++) {
        scene s = new_scene();
        add_sheet(&s.seen, -1, 1, -0.75, 0.75);
        add_sheet(&s.unseen, side ? 0 : -1, side ? 1 : 0, 1.5, 1.5);
        const cause_counts counts = counts_of(&s, shb_bias_normal_offset(3, 1e-5f));
        /* At the map's own border some of them move out of it, where all is lit. */
        check_all(counts.leak[CAUSE_OFFSET] + counts.acne[CAUSE_OFFSET], &counts, 0.005);
        CHECK((side ? counts.leak : counts.acne)[CAUSE_OFFSET] > counts.wrong / 2);
    }
}

/* A steep floor comes out through a level plate within a texel: below the plate its plane lies
 * above the plate at the texel's centre, above the plate it is the plate's sample that is in front.
 */
TEST(errors_where_a_floor_comes_through_a_plate_are_by_extrapolation_and_crease) {
    const double rise = 6, out = 0.3 * texel;
    for (int side = 0; side < 2; side++) {
        const double height = side ? rise * (out + 0.4 * texel) : rise * out;
        scene s = new_scene();
        add_sheet(&s.seen, -0.25, 0.25, -0.25 * rise, 0.25 * rise);
        add_sheet(&s.unseen, -1, 1, height, height);
        const cause_counts counts = counts_of(&s, shb_bias_adaptive(1e-6f, 1));
        check_all(side ? counts.acne[CAUSE_CREASE] : counts.leak[CAUSE_EXTRAPOLATION], &counts,
                  0.001);
    }
}

/* Corners at whole texels of the map: x = -0.5 is texel 16, z = -0.5 is row 16. */
TEST(light_space_has_rows_downwards_and_planes_of_depth) {
    overhead o;
    owned_mesh mesh = {0};
    add_sheet(&mesh, -1, 1, 0, 0);
    overhead_open(&o, &mesh, NULL, MAP_SIZE);
    light_space space;
    const shb_map_info info = {.view = o.map.view, .width = MAP_SIZE, .height = MAP_SIZE};
    CHECK_INT(light_space_create(&info, &space), SHB_OK);
    const shb_vec3 world = {-0.5, 1, -0.5};
    const light_point point = light_space_project(&space, world);
    CHECK_NEAR(point.x, 16, 1e-12);
    CHECK_NEAR(point.y, 16, 1e-12);
    CHECK_NEAR(point.depth, 0.25, 1e-12);
    const shb_vec3 back = light_space_unproject(&space, point);
    CHECK_NEAR(shb_vec3_length(shb_vec3_subtract(back, world)), 0, 1e-12);
    /* y = x + 2 z: a texel to the right is 1/32 nearer, one down twice that, in quarters of depth
     */
    const shb_vec3 corners[3] = {{0, 0, 0}, {1, 1, 0}, {0, 2, 1}};
    const light_plane plane = light_space_plane(&space, corners);
    CHECK_NEAR(plane.per_x, -texel / 4, 1e-15);
    CHECK_NEAR(plane.per_y, -2 * texel / 4, 1e-15);
    CHECK_NEAR(light_plane_at(&plane, 32, 32), 0.5, 1e-12);
    overhead_close(&o);
}

static double luminance(const uint8_t color[3]) {
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

/* The largest difference of light over a patch. */
static double difference(cause a, cause b) {
    double largest = 0;
    for (uint32_t y = 0; y < 4; y++)
        for (uint32_t x = 0; x < 4; x++) {
            uint8_t first[3], second[3];
            cause_picture_color(a, x, y, first);
            cause_picture_color(b, x, y, second);
            largest = fmax(largest, fabs(luminance(first) - luminance(second)));
        }
    return largest;
}

TEST(pictures_of_causes_differ_without_colour) {
    for (int a = CAUSE_NONE + 1; a < CAUSES; a++)
        for (int b = a + 1; b < CAUSES; b++)
            CHECK(difference((cause)a, (cause)b) > 30);
}

TEST(pictures_of_causes_show_the_truth_where_all_is_right) {
    uint32_t pixels[3] = {0, 2, 3};
    const measure_frame frame = {
        .frame = {.width = 4, .height = 1}, .fragment_count = 3, .pixels = pixels};
    const uint8_t truth[4] = {SHB_TRUTH_LIT, SHB_TRUTH_NONE, SHB_TRUTH_SHADOWED, SHB_TRUTH_LIT};
    const uint8_t causes[3] = {CAUSE_NONE, CAUSE_NONE, CAUSE_BIAS};
    uint8_t painted[12], bias[3];
    cause_picture_paint(&frame, truth, causes, painted);
    cause_picture_color(CAUSE_BIAS, 3, 0, bias);
    CHECK(painted[3] > painted[0] && painted[0] > painted[6]);
    for (int k = 0; k < 3; k++) {
        CHECK(painted[k] == painted[0] && painted[6 + k] == painted[6]);
        CHECK_INT(painted[9 + k], bias[k]);
    }
}
