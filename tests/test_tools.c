#include "arguments.h"
#include "measure.h"
#include "scenes.h"
#include "sheet.h"

#include "contexts.h"
#include "test.h"

#include <string.h>

typedef struct values {
    const char *operand, *text;
    uint32_t count, size[2];
    double point[3];
    bool flag;
} values;

static char error[256];

static bool parse(int argc, char **argv, values *parsed) {
    const argument_spec arguments[] = {
        {NULL, "FILE", "operand", ARGUMENT_TEXT, &parsed->operand, 0, 0},
        {"--text", "T", "text", ARGUMENT_TEXT, &parsed->text, 0, 0},
        {"--count", "N", "count", ARGUMENT_COUNT, &parsed->count, 2, 300},
        {"--size", "WxH", "size", ARGUMENT_SIZE, parsed->size, 1, 20},
        {"--point", "X,Y,Z", "point", ARGUMENT_POINT, parsed->point, 0, 0},
        {"--flag", NULL, "flag", ARGUMENT_FLAG, &parsed->flag, 0, 0},
    };
    error[0] = 0;
    return arguments_parse(argc, argv, arguments, sizeof arguments / sizeof *arguments, error,
                           sizeof error);
}

TEST(arguments_are_read_in_both_forms_and_any_order) {
    char *argv[] = {"tool",       "--count", "300",    "--size=3x20", "in.obj", "--point",
                    "1,-2.5,1e3", "--flag",  "--text", "--flag",      NULL};
    values parsed = {0};
    CHECK(parse(10, argv, &parsed));
    CHECK(parsed.count == 300 && parsed.size[0] == 3 && parsed.size[1] == 20 && parsed.flag);
    CHECK(parsed.operand && strcmp(parsed.operand, "in.obj") == 0);
    CHECK(parsed.text && strcmp(parsed.text, "--flag") == 0);
    CHECK(parsed.point[0] == 1 && parsed.point[1] == -2.5 && parsed.point[2] == 1000);
}

TEST(arguments_that_are_absent_leave_their_targets_alone) {
    char *argv[] = {"tool", NULL};
    values parsed = {.count = 7, .text = "default"};
    CHECK(parse(1, argv, &parsed));
    CHECK(parsed.count == 7 && strcmp(parsed.text, "default") == 0 && !parsed.flag);
}

static void check_refused(char *first, char *second, const char *sentence) {
    char *argv[] = {"tool", first, second, NULL};
    values parsed = {.count = 7, .size = {7, 7}, .point = {7, 7, 7}};
    CHECK(!parse(second ? 3 : 2, argv, &parsed));
    test_check(strcmp(error, sentence) == 0, __FILE__, __LINE__, "\"%s\", expected \"%s\"", error,
               sentence);
    CHECK(parsed.count == 7 && parsed.size[0] == 7 && parsed.point[0] == 7);
}

TEST(arguments_error_names_argument_and_value) {
    check_refused("--nothing", NULL, "--nothing: unknown argument");
    check_refused("a", "b", "b: unknown argument");
    check_refused("--count", NULL, "--count: a value N is missing");
    check_refused("--count", "1", "--count: \"1\" is not a number of 2 to 300");
    check_refused("--count", "301", "--count: \"301\" is not a number of 2 to 300");
    check_refused("--count", "-3", "--count: \"-3\" is not a number of 2 to 300");
    check_refused("--count", "3x", "--count: \"3x\" is not a number of 2 to 300");
    check_refused("--count=", NULL, "--count: \"\" is not a number of 2 to 300");
    check_refused("--count", "99999999999999999999999",
                  "--count: \"99999999999999999999999\" is not a number of 2 to 300");
    check_refused("--size", "3", "--size: \"3\" is not WxH with both 1 to 20");
    check_refused("--size", "3x21", "--size: \"3x21\" is not WxH with both 1 to 20");
    check_refused("--size", "3x2x1", "--size: \"3x2x1\" is not WxH with both 1 to 20");
    check_refused("--point", "1,2", "--point: \"1,2\" is not three numbers X,Y,Z");
    check_refused("--point", "1,2,inf", "--point: \"1,2,inf\" is not three numbers X,Y,Z");
    check_refused("--flag=1", NULL, "--flag: takes no value");
}

static uint8_t sheet_pixel(const contact_sheet *sheet, uint32_t x, uint32_t y, uint32_t channel) {
    return sheet->image.pixels[3 * (y * sheet->image.width + x) + channel];
}

/* A gap of 8 pixels all round, tiles of 10 x 6, captions of 24: tile 3 of two columns starts at
 * (8 + 10 + 8, 8 + 6 + 24 + 8). */
TEST(sheet_tile_holds_means_of_squares) {
    contact_sheet sheet;
    CHECK(sheet_create(&sheet, 2, 3, 10, 6));
    CHECK_INT(sheet.image.width, 2 * 18 + 8);
    CHECK_INT(sheet.image.height, 2 * 38 + 8);
    uint8_t pixels[12 * 20 * 3];
    for (uint32_t i = 0; i < sizeof pixels; i++)
        pixels[i] = (uint8_t)(i % 3 == 0 ? 10 * (i / 3 % 2) : i % 3 == 1 ? 200 : i / 60);
    const shb_image picture = {pixels, 20, 12, 0};
    sheet_place(&sheet, 3, &picture, 2, "");
    CHECK_INT(sheet_pixel(&sheet, 26, 46, 0), 5);   /* mean of columns 0 and 10 */
    CHECK_INT(sheet_pixel(&sheet, 35, 51, 1), 200); /* the last pixel of the tile */
    CHECK_INT(sheet_pixel(&sheet, 30, 50, 2), 9);   /* rows 8 and 9: 8.5, rounded up */
    const uint8_t background = sheet_pixel(&sheet, 0, 0, 0);
    CHECK_INT(sheet_pixel(&sheet, 25, 46, 1), background);
    CHECK_INT(sheet_pixel(&sheet, 36, 51, 1), background);
    CHECK_INT(sheet_pixel(&sheet, 26, 52, 1), background);
    sheet_destroy(&sheet);
}

/* Each fragment belongs to a covered pixel and lies where its weights say, on the triangle seen
 * there. */
TEST(measure_frame_holds_the_fragments_of_covered_pixels) {
    example_scene *scene = NULL;
    shb_context *context = NULL;
    measure_frame frame;
    CHECK(scene_open("l-shape", &scene, error, sizeof error));
    context = test_context(0, SHB_ISA_BEST);
    CHECK(!measure_frame_create(context, scene, 80, 50, &frame));
    size_t covered = 0;
    for (size_t i = 0; i < 80 * 50; i++)
        covered += frame.ids[i] != SHB_ID_NONE;
    CHECK(covered > 1000 && covered < 80 * 50);
    CHECK_INT(frame.fragment_count, covered);
    const shb_points points = measure_points(&frame);
    for (size_t i = 0; i < frame.fragment_count; i++) {
        const float *p = frame.positions + 3 * i, *n = frame.normals + 3 * i;
        shb_vec3 corners[3];
        CHECK(!shb_scene_triangle(&scene->scene, frame.ids[frame.pixels[i]], corners));
        const shb_vec3 normal = {(double)n[0], (double)n[1], (double)n[2]};
        const shb_vec3 point = {(double)p[0], (double)p[1], (double)p[2]};
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(shb_vec3_dot(normal, shb_vec3_subtract(corners[k], point)), 0, 1e-5);
        const double w1 = (double)points.own.weight_1[i], w2 = (double)points.own.weight_2[i];
        const shb_vec3 there = shb_vec3_add(
            shb_vec3_add(shb_vec3_scale(corners[0], 1 - w1 - w2), shb_vec3_scale(corners[1], w1)),
            shb_vec3_scale(corners[2], w2));
        CHECK_NEAR(shb_vec3_length(shb_vec3_subtract(there, point)), 0, 1e-5);
        CHECK_INT(points.own.ids[i], frame.ids[frame.pixels[i]]);
    }
    measure_frame_destroy(&frame);
    shb_context_destroy(context);
    scene_close(scene);
}

/* A small picture of the scene box, a map of its sun, and the truth of both. */
typedef struct box_picture {
    example_scene *scene;
    shb_context *context;
    shb_map *map;
    measure_frame frame;
    measure_truth truth;
} box_picture;

static void open_box(box_picture *box) {
    *box = (box_picture){0};
    shb_map_desc desc = {.width = 256};
    CHECK(scene_open("box", &box->scene, error, sizeof error));
    box->context = test_context(0, SHB_ISA_BEST);
    CHECK(!scene_light_view(box->scene, SCENE_DIRECTIONAL, 256, false, &desc.view));
    CHECK(!shb_map_create(box->context, &desc, &box->map));
    CHECK(!measure_frame_create(box->context, box->scene, 160, 100, &box->frame));
    CHECK(!measure_truth_create(&box->frame, box->map, &box->truth));
}

static void close_box(box_picture *box) {
    measure_truth_destroy(&box->truth);
    measure_frame_destroy(&box->frame);
    shb_map_destroy(box->map);
    shb_context_destroy(box->context);
    scene_close(box->scene);
}

/* Without bias half of the lit ground is in false shadow; with the plane none of it is. */
TEST(measure_method_tells_acne_from_none) {
    box_picture box;
    open_box(&box);
    const shb_bias none = shb_bias_none(), plane = shb_bias_receiver_plane(1e-4f);
    measure_result without, with;
    const scene_contact *contact = &box.scene->lights[SCENE_DIRECTIONAL].contact;
    CHECK(!measure_method(&box.frame, &box.truth, box.map, &none, NULL, contact, 3, &without));
    CHECK(!measure_method(&box.frame, &box.truth, box.map, &plane, NULL, contact, 3, &with));
    CHECK(without.errors.false_shadow_ppm > 300000 && without.errors.false_shadow_ppm < 700000);
    CHECK(with.errors.false_shadow_ppm < 20000);
    CHECK(with.errors.lit > with.errors.shadowed && with.errors.shadowed > 1000);
    CHECK(with.detachment.probed == 1000);
    CHECK(with.ns_per_fragment > 0 && with.map_seconds > 0);
    close_box(&box);
}

TEST(measure_method_prepares_every_filter) {
    size_t count;
    const shb_filter_method *filters = shb_filter_methods(&count);
    const shb_bias plane = shb_bias_receiver_plane(1e-4f);
    box_picture box;
    open_box(&box);
    for (size_t i = 0; i < count; i++) {
        const shb_filter filter = filters[i].make();
        measure_result measured;
        test_check(
            !measure_method(&box.frame, &box.truth, box.map, &plane, &filter, NULL, 1, &measured),
            __FILE__, __LINE__, "%s cannot be measured", filter.name);
    }
    close_box(&box);
}
