/* The stability suite's own promises, and a few of its cases where the outcome is known by hand. */
#include "shadowbias/bias.h"

#include <stdio.h>
#include <string.h>

#include "contexts.h"
#include "stability/filters.h"
#include "stability/heat_map.h"
#include "stability/report.h"
#include "stability/tune.h"
#include "test.h"

enum { WIDTH = 160, HEIGHT = 120 };

/* Errors of a method in a case, by default. */
static shb_errors errors_in(stability_stage *stage, const char *name) {
    listed_method method;
    shb_errors errors = {0};
    if (CHECK(method_list_named(name, &method)))
        CHECK_INT(stability_measure(stage, &method, &errors), SHB_OK);
    return errors;
}

static stability_stage stage_of(shb_context *context, const stability_case *c) {
    stability_stage stage;
    CHECK_INT(stability_stage_open(context, c, WIDTH, HEIGHT, 0, 1, &stage), SHB_OK);
    return stage;
}

static stability_case case_of(const char *name) {
    const stability_case *c = stability_case_named(name);
    return CHECK(c != NULL) ? *c : (stability_case){0};
}

/* A plane that is alone lies in the light wherever it faces it. */
TEST(lone_planes_get_no_false_shadow_from_methods_that_know_their_slope) {
    static const char *const methods[] = {"adaptive",     "adaptive-soft",   "receiver-plane",
                                          "exact-planes", "exact-triangles", "exact-lists"};
    shb_context *context = test_context(2, SHB_ISA_BEST);
    for (size_t i = 0; stability_case_at(i); i++) {
        if (strncmp(stability_case_at(i)->name, "plane-", 6) != 0)
            continue;
        stability_stage stage = stage_of(context, stability_case_at(i));
        for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
            const shb_errors errors = errors_in(&stage, methods[k]);
            CHECK_INT(errors.false_shadow + errors.boundary_shadow, 0);
            CHECK_INT(errors.shadowed, 0);
            CHECK(errors.lit > WIDTH * HEIGHT / 8);
        }
        stability_stage_close(&stage);
    }
    shb_context_destroy(context);
}

/* Half of the fragments lie behind the centre of their texel, as the light sees it. */
TEST(without_bias_half_of_a_lone_plane_is_in_false_shadow) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const stability_case c = case_of("plane-45");
    stability_stage stage = stage_of(context, &c);
    const shb_errors errors = errors_in(&stage, "none");
    CHECK_NEAR(errors.false_shadow + errors.boundary_shadow, 0.5 * (double)errors.lit,
               0.03 * (double)errors.lit);
    stability_stage_close(&stage);
    shb_context_destroy(context);
}

/* A power of two scales every number without rounding. */
TEST(a_scale_of_a_power_of_two_changes_no_count_of_errors) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    stability_case small = case_of("scale-1"), large = small;
    small.scale = 0x1p-12;
    large.scale = 0x1p20;
    stability_stage first = stage_of(context, &small), second = stage_of(context, &large);
    listed_method method;
    for (size_t i = 0; method_list_at(i, &method); i++) {
        const shb_errors a = errors_in(&first, method.name), b = errors_in(&second, method.name);
        CHECK(a.lit > 0 && a.shadowed > 0);
        CHECK_INT(a.lit, b.lit);
        CHECK_INT(a.shadowed, b.shadowed);
        CHECK_INT(a.false_shadow, b.false_shadow);
        CHECK_INT(a.false_light, b.false_light);
        CHECK_INT(a.boundary_shadow, b.boundary_shadow);
        CHECK_INT(a.boundary_light, b.boundary_light);
    }
    stability_stage_close(&first);
    stability_stage_close(&second);
    shb_context_destroy(context);
}

/* The gap is 1e-5 of a scene 2.8 wide; a bias of 0.002 of a depth range above 1 is far more. */
TEST(a_constant_bias_loses_a_narrow_gap_that_lists_keep) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const stability_case c = case_of("gap-1e-5");
    stability_stage stage = stage_of(context, &c);
    const shb_errors lost = errors_in(&stage, "constant");
    CHECK(lost.shadowed > 1000);
    CHECK_INT(lost.false_light + lost.boundary_light, lost.shadowed);
    const shb_errors kept = errors_in(&stage, "exact-lists");
    CHECK_INT(kept.false_light, 0);
    CHECK_INT(kept.false_shadow, 0);
    stability_stage_close(&stage);
    shb_context_destroy(context);
}

/* At 10^7 units from the origin float positions are half a unit apart, in a scene of 3 units. */
TEST(lists_have_no_errors_at_all_where_points_are_named_by_triangle_and_weights) {
    static const char *const names[] = {"moved-1e7", "relief-0.1", "needles", "foliage"};
    shb_context *context = test_context(2, SHB_ISA_BEST);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const stability_case c = case_of(names[i]);
        stability_stage stage = stage_of(context, &c);
        if (i == 0)
            CHECK(errors_in(&stage, "exact-lists").wrong > stage.frame.fragment_count / 100);
        CHECK_INT(stability_name_points(&stage), SHB_OK);
        const shb_errors errors = errors_in(&stage, "exact-lists");
        CHECK_INT(errors.wrong, 0);
        CHECK(errors.lit > 1000);
        stability_stage_close(&stage);
    }
    shb_context_destroy(context);
}

TEST(maps_have_the_size_of_their_case_before_that_of_the_options) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const stability_case own = case_of("map-size-64"), any = case_of("plane-45");
    stability_stage stage;
    CHECK_INT(stability_stage_open(context, &own, 16, 12, 128, 1, &stage), SHB_OK);
    CHECK_INT(stage.map.width, 64);
    stability_stage_close(&stage);
    CHECK_INT(stability_stage_open(context, &any, 16, 12, 128, 1, &stage), SHB_OK);
    CHECK_INT(stage.map.width, 128);
    stability_stage_close(&stage);
    CHECK_INT(stability_stage_open(context, &any, 16, 12, 0, 1, &stage), SHB_OK);
    CHECK_INT(stage.map.width, STABILITY_MAP_SIZE);
    stability_stage_close(&stage);
    shb_context_destroy(context);
}

static shb_errors errors_of_case(const char *name, const char *method) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const stability_case c = case_of(name);
    stability_stage stage = stage_of(context, &c);
    const shb_errors errors = errors_in(&stage, method);
    stability_stage_close(&stage);
    shb_context_destroy(context);
    return errors;
}

/* Creases and thin walls, where every map without lists has errors somewhere. */
TEST(lists_have_no_errors_away_from_boundaries) {
    static const char *const names[] = {"corner", "stair-sheet-600", "wall-0.1", "wedge-1",
                                        "slivers"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const shb_errors errors = errors_of_case(names[i], "exact-lists");
        CHECK(errors.lit > 1000);
        CHECK_INT(errors.false_shadow, 0);
        CHECK_INT(errors.false_light, 0);
    }
}

/* Facets that are turned alike and lie side by side in a texel look like sheets one above the
 * other; without a look at the texels around them more than 6 % are in false shadow. */
TEST(planes_leave_reliefs_finer_than_texels_in_their_own_light) {
    static const char *const names[] = {"relief-0.1", "relief-0.25", "relief-0.5"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const shb_errors errors = errors_of_case(names[i], "exact-planes");
        CHECK(errors.lit > 1000);
        CHECK(errors.false_shadow_ppm < 2000);
    }
}

/* Sheets that lie less than a texel apart, and the ground beside a box. */
TEST(planes_keep_the_shadows_of_sheets_that_lie_close) {
    static const char *const names[] = {"gap-1e-6", "gap-1e-5", "gap-1e-4", "contact-1e-4",
                                        "wedge-1"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const shb_errors errors = errors_of_case(names[i], "exact-planes");
        CHECK(errors.shadowed > 500);
        CHECK_INT(errors.false_light, 0);
    }
}

static uint64_t wrong(const shb_errors *errors) {
    return errors->false_shadow + errors->false_light + errors->boundary_shadow +
           errors->boundary_light;
}

TEST(tuning_finds_a_better_parameter) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const stability_case c = case_of("relief-1");
    stability_stage stage = stage_of(context, &c);
    listed_method method;
    for (size_t i = 0; method_list_at(i, &method); i++) {
        if (!method.method->param_names[0])
            continue;
        const shb_errors usual = errors_in(&stage, method.name);
        shb_errors tuned = usual;
        CHECK_INT(stability_tune(&stage, &method, &tuned), SHB_OK);
        CHECK(wrong(&tuned) <= wrong(&usual));
        if (strcmp(method.name, "adaptive") == 0)
            CHECK(wrong(&usual) > 0 && 2 * wrong(&tuned) < wrong(&usual));
    }
    stability_stage_close(&stage);
    shb_context_destroy(context);
}

TEST(cases_and_methods_of_the_suite_have_names_of_their_own) {
    for (size_t i = 0; stability_case_at(i); i++)
        CHECK(stability_case_named(stability_case_at(i)->name) == stability_case_at(i));
    CHECK(stability_case_named("") == NULL);
    listed_method method, named;
    for (size_t i = 0; method_list_at(i, &method); i++)
        CHECK(method_list_named(method.name, &named) && named.method == method.method &&
              named.occluders == method.occluders);
    CHECK(!method_list_named("", &named));
}

/* 1 of 4 lit and 2 of 8 shadowed fragments are wrong in all: 3 of 12, or 250000 per million. */
TEST(rates_are_per_million_of_the_fragments_they_are_about) {
    const shb_errors errors = {.lit = 4,
                               .shadowed = 8,
                               .boundary_shadow = 1,
                               .boundary_light = 2,
                               .false_shadow_ppm = 5,
                               .false_light_ppm = 6,
                               .wrong_ppm = 250000};
    const stability_rates rates = stability_rates_of(&errors);
    CHECK_NEAR(rates.false_shadow_near, 250000, 0);
    CHECK_NEAR(rates.false_light_near, 250000, 0);
    CHECK_NEAR(rates.wrong, 250000, 0);
    CHECK_NEAR(rates.false_shadow_far, 5, 0);
    CHECK_NEAR(rates.false_light_far, 6, 0);
}

TEST(means_leave_out_cases_without_such_fragments_and_name_the_worst) {
    const stability_case first = {.name = "first", .group = "wall"};
    const stability_case second = {.name = "second", .group = "wall"};
    stability_rows rows = {0};
    const stability_rates a = {.lit = 10, .false_shadow_far = 100, .wrong = 100};
    const stability_rates b = {
        .lit = 5, .shadowed = 5, .false_shadow_far = 300, .false_light_far = 50, .wrong = 175};
    CHECK(stability_rows_add(&rows, (stability_row){&first, "m", STABILITY_DEFAULT, a, 64}));
    CHECK(stability_rows_add(&rows, (stability_row){&first, "m", STABILITY_TUNED, b, 64}));
    CHECK(stability_rows_add(&rows, (stability_row){&second, "m", STABILITY_DEFAULT, b, 64}));
    const stability_row *worst;
    const stability_rates mean =
        stability_rows_mean(&rows, STABILITY_ALL, "m", STABILITY_DEFAULT, &worst);
    CHECK(worst == &rows.rows[2]);
    CHECK_INT(mean.lit, 15);
    CHECK_INT(mean.shadowed, 5);
    CHECK_NEAR(mean.false_shadow_far, 200, 0);
    CHECK_NEAR(mean.false_light_far, 50, 0);
    CHECK_NEAR(mean.wrong, 137.5, 0);
    stability_rows_mean(&rows, STABILITY_ALL, "other", STABILITY_DEFAULT, &worst);
    CHECK(worst == NULL);
    stability_rows_free(&rows);
}

TEST(means_of_resolved_cases_leave_out_those_finer_than_floats) {
    static const char *const left_out[] = {"gap", "moved", "near-far"};
    stability_case cases[4] = {{.name = "kept", .group = "wall"}};
    stability_rows rows = {0};
    for (int i = 0; i < 4; i++) {
        const stability_rates rates = {.lit = 1, .false_shadow_far = i ? 400 : 100};
        cases[i].group = i ? left_out[i - 1] : cases[i].group;
        CHECK(stability_rows_add(&rows,
                                 (stability_row){&cases[i], "m", STABILITY_DEFAULT, rates, 64}));
    }
    const stability_row *worst;
    stability_rates mean =
        stability_rows_mean(&rows, STABILITY_RESOLVED, "m", STABILITY_DEFAULT, &worst);
    CHECK(worst == &rows.rows[0]);
    CHECK_INT(mean.lit, 1);
    CHECK_NEAR(mean.false_shadow_far, 100, 0);
    mean = stability_rows_mean(&rows, STABILITY_ALL, "m", STABILITY_DEFAULT, &worst);
    CHECK_INT(mean.lit, 4);
    CHECK_NEAR(mean.false_shadow_far, 325, 0);
    stability_rows_free(&rows);
}

/* What a table prints, until the next call. */
static const char *printed(void (*print)(FILE *, const stability_rows *),
                           const stability_rows *rows) {
    static char text[1024];
    FILE *file = tmpfile();
    memset(text, 0, sizeof text);
    if (CHECK(file != NULL)) {
        print(file, rows);
        rewind(file);
        CHECK(fread(text, 1, sizeof text - 1, file) > 0);
        fclose(file);
    }
    return text;
}

TEST(the_table_names_its_columns_and_ends_with_the_means) {
    const stability_case c = {
        .name = "c", .group = "g", .format = SHB_FORMAT_UNORM16, .reversed = true};
    const stability_rates rates = {3, 1, 1.5, 2, 3, 4, 0.25};
    stability_rows rows = {0};
    CHECK(stability_rows_add(&rows, (stability_row){&c, "none", STABILITY_TUNED, rates, 64}));
    const char *text = printed(stability_print_tsv, &rows);
    CHECK(strcmp(text, "case\tgroup\tformat\tmap_size\tmethod\tsetting\tlit\tshadowed\t"
                       "fs_far_ppm\tfl_far_ppm\tfs_near_ppm\tfl_near_ppm\twrong_ppm\n"
                       "c\tg\tunorm16-reversed\t64\tnone\ttuned\t3\t1\t"
                       "1.500\t2.000\t3.000\t4.000\t0.250\n"
                       "RESOLVED\tRESOLVED\t-\t-\tnone\ttuned\t3\t1\t"
                       "1.500\t2.000\t3.000\t4.000\t0.250\n"
                       "ALL\tALL\t-\t-\tnone\ttuned\t3\t1\t"
                       "1.500\t2.000\t3.000\t4.000\t0.250\n") == 0);
    stability_rows_free(&rows);
}

/* 1 of 4 and 3 of 4 fragments are unsure. */
TEST(the_table_of_certain_answers_ends_with_the_means) {
    const stability_case kept = {.name = "a", .group = "g"}, gap = {.name = "b", .group = "gap"};
    stability_rows rows = {0};
    CHECK(stability_rows_add_certain(&rows, (stability_certain){&kept, 4, 1, 0, 1}));
    CHECK(stability_rows_add_certain(&rows, (stability_certain){&gap, 4, 3, 1, 0}));
    CHECK(strcmp(printed(stability_print_certain, &rows),
                 "case\tgroup\tfragments\tunsure\tunsure_ppm\tfalse_shadow\tfalse_light\n"
                 "a\tg\t4\t1\t250000.000\t0\t1\n"
                 "b\tgap\t4\t3\t750000.000\t1\t0\n"
                 "RESOLVED\tRESOLVED\t4\t1\t250000.000\t0\t1\n"
                 "ALL\tALL\t8\t4\t500000.000\t1\t1\n") == 0);
    stability_rows_free(&rows);
}

TEST(cells_of_the_heat_map_show_the_digits_of_a_rate) {
    CHECK_INT(heat_map_digits(0), 0);
    CHECK_INT(heat_map_digits(0.001), 1);
    CHECK_INT(heat_map_digits(9.9), 1);
    CHECK_INT(heat_map_digits(10), 2);
    CHECK_INT(heat_map_digits(999999), 6);
    CHECK_INT(heat_map_digits(1e6), 7);
}

typedef struct kernel_row {
    unsigned long long lit, shadowed;
    double lit_error, bad_lit, shadowed_error;
} kernel_row;

/* The mean of a single case, for a box or, if it is 0, soft shadows. */
static kernel_row kernel_row_of(shb_context *context, const char *name, const char *method,
                                uint32_t box, uint32_t pcss) {
    const stability_options options = {
        .method = method, .subject = name, .box = box, .pcss = pcss, .quick = true};
    kernel_row row = {0};
    char line[256] = "";
    FILE *file = tmpfile();
    if (!CHECK(file != NULL))
        return row;
    CHECK(stability_run_filter(context, &options, file));
    rewind(file);
    while (fgets(line, sizeof line, file) && strncmp(line, "ALL", 3) != 0)
        ;
    fclose(file);
    CHECK_INT(sscanf(line, "ALL\tALL\t%*s\t%llu\t%llu\t%lf\t%lf\t%lf", &row.lit, &row.shadowed,
                     &row.lit_error, &row.bad_lit, &row.shadowed_error),
              5);
    return row;
}

/* A heading, and a row for each mean that the case belongs to. */
static int filter_lines_of(shb_context *context, const char *name) {
    const stability_options options = {.method = "none", .subject = name, .box = 3, .quick = true};
    int lines = 0;
    FILE *file = tmpfile();
    if (!CHECK(file != NULL))
        return 0;
    CHECK(stability_run_filter(context, &options, file));
    rewind(file);
    for (int c; (c = fgetc(file)) != EOF;)
        lines += c == '\n';
    fclose(file);
    return lines;
}

TEST(means_of_filters_leave_out_cases_finer_than_floats) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    CHECK_INT(filter_lines_of(context, "plane-45"), 3);
    CHECK_INT(filter_lines_of(context, "gap-1e-2"), 2);
    shb_context_destroy(context);
}

static kernel_row box_row_of(shb_context *context, const char *name, const char *method,
                             uint32_t box) {
    return kernel_row_of(context, name, method, box, 0);
}

/* Without bias half of the taps on a lone plane are in false shadow, and nearly every fragment has
 * some of them; with the plane in every tap none is. */
TEST(boxes_are_judged_by_the_mean_error_of_lit_fragments) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const kernel_row none = box_row_of(context, "plane-45", "none", 5);
    const kernel_row plane = box_row_of(context, "plane-45", "exact-planes", 5);
    CHECK(none.lit > 1000 && none.lit == plane.lit && none.shadowed == 0);
    CHECK_NEAR(none.lit_error, 5e5, 2e4);
    CHECK(none.bad_lit > 9e5);
    CHECK(plane.lit_error == 0 && plane.bad_lit == 0);
    shb_context_destroy(context);
}

/* Sheets all of which lie in the light, where adaptive shadows more than a tenth. */
static void check_sheets(const char *const names[], int count, const char *method, double most) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    for (int i = 0; i < count; i++) {
        const kernel_row adaptive = box_row_of(context, names[i], "adaptive", 5);
        const kernel_row row = box_row_of(context, names[i], method, 5);
        CHECK(row.lit > 1000 && adaptive.lit_error > 1e5);
        CHECK(row.lit_error < most);
    }
    shb_context_destroy(context);
}

/* A relief finer than a texel is one of them. */
TEST(exact_taps_by_triangles_leave_a_sheet_in_its_own_light) {
    static const char *const names[] = {"relief-0.25", "relief-2", "saddle", "stair-sheet-600"};
    check_sheets(names, 4, "exact-triangles", 100);
}

/* Where triangles are no finer than texels, planes meet from texel to texel. */
TEST(exact_boxes_by_planes_leave_most_of_a_sheet_in_its_own_light) {
    static const char *const names[] = {"relief-2", "saddle", "stair-sheet-600"};
    check_sheets(names, 3, "exact-planes", 5e3);
}

/* Two sheets one above the other have no planes that meet, however small the gap. */
TEST(exact_boxes_by_planes_keep_the_shadows_of_sheets_that_lie_close) {
    static const char *const names[] = {"gap-1e-2", "gap-1e-4", "contact-1e-3"};
    shb_context *context = test_context(2, SHB_ISA_BEST);
    for (int i = 0; i < 3; i++) {
        const kernel_row planes = box_row_of(context, names[i], "exact-planes", 5);
        CHECK(planes.shadowed > 500 && planes.shadowed_error == 0);
    }
    shb_context_destroy(context);
}

/* The kernels of pcss, which are up to 11 texels wide. */
TEST(soft_shadows_by_planes_leave_a_sheet_in_its_own_light) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const kernel_row relief = kernel_row_of(context, "relief-2", "exact-planes", 0, 11);
    const kernel_row stairs = kernel_row_of(context, "stair-sheet-600", "exact-planes", 0, 11);
    const kernel_row gap = kernel_row_of(context, "gap-1e-4", "exact-planes", 0, 11);
    CHECK(relief.lit > 1000 && relief.lit_error < 250);
    CHECK(stairs.lit > 1000 && stairs.lit_error < 100);
    CHECK(gap.shadowed > 500 && gap.shadowed_error == 0);
    shb_context_destroy(context);
}

/* As for boxes: on a lone plane without bias half of what any kernel holds is in false shadow. */
TEST(soft_shadows_are_judged_by_the_mean_error_of_lit_fragments) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const kernel_row none = kernel_row_of(context, "plane-45", "none", 0, 11);
    const kernel_row plane = kernel_row_of(context, "plane-45", "exact-planes", 0, 11);
    CHECK(none.lit > 1000 && none.lit == plane.lit && none.shadowed == 0);
    CHECK_NEAR(none.lit_error, 5e5, 5e4);
    CHECK(plane.lit_error == 0 && plane.bad_lit == 0);
    shb_context_destroy(context);
}

/* Larger boxes leave less that is far from silhouettes. */
TEST(boxes_are_judged_where_no_silhouette_is_in_them) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    const kernel_row small = box_row_of(context, "scale-1", "exact-triangles", 3);
    const kernel_row large = box_row_of(context, "scale-1", "exact-triangles", 31);
    CHECK(large.lit > 1000 && large.lit < small.lit);
    CHECK(large.shadowed > 100 && large.shadowed < small.shadowed);
    CHECK(small.lit_error < 50 && small.shadowed_error < 50);
    shb_context_destroy(context);
}
