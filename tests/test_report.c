/* The report: rows and their file, means, the Pareto front, errors of soft shadows, methods. */
#include "../examples/report/judge.h"
#include "../examples/report/methods.h"
#include "../examples/report/peers.h"
#include "../examples/report/stage.h"
#include "../examples/report/summary.h"

#include "scratch.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static report_row make_row(const char *scene, const char *filter, const char *method, double ms,
                           double error) {
    report_row row = {.map_size = 512, .map_ms = ms, .ns_per_fragment = 1, .detachment_texels = 1};
    snprintf(row.scene, sizeof row.scene, "%s", scene);
    snprintf(row.light, sizeof row.light, "sun");
    snprintf(row.filter, sizeof row.filter, "%s", filter);
    snprintf(row.method, sizeof row.method, "%s", method);
    snprintf(row.settings, sizeof row.settings, "here");
    row.wrong_ppm = error;
    row.rms = error;
    row.ssim = (double)NAN;
    return row;
}

static void add(report_rows *rows, report_row row) {
    CHECK(report_rows_add(rows, &row));
}

/* No file is there. */
static const char *file_path(void) {
    static scratch_path path;
    path = scratch_name("report.tsv");
    remove(path.text);
    return path.text;
}

TEST(report_rows_come_back_from_their_file) {
    const char *path = file_path();
    report_rows rows = {0}, back = {0};
    add(&rows, make_row("a", "hard", "none", 0.25, 3));
    add(&rows, make_row("b", "pcf:size=5", "slope", 1.5, 4));
    rows.rows[1].memory_bytes = 123456789012;
    CHECK(report_rows_append(rows.rows, rows.count, path));
    CHECK(report_rows_read(&back, "here", path));
    CHECK_INT(back.count, 2);
    CHECK(strcmp(back.rows[1].filter, "pcf:size=5") == 0);
    CHECK(back.rows[0].map_ms == 0.25 && back.rows[1].rms == 4 && isnan(back.rows[0].ssim));
    CHECK(back.rows[1].memory_bytes == 123456789012);
    report_rows_free(&rows);
    report_rows_free(&back);
    remove(path);
}

/* As a run leaves it that was stopped while it wrote, after one with other settings. */
TEST(report_rows_that_are_cut_off_or_of_other_settings_are_passed_over) {
    const char *path = file_path();
    report_rows rows = {0}, back = {0};
    add(&rows, make_row("a", "hard", "none", 1, 1));
    add(&rows, make_row("b", "hard", "none", 1, 1));
    snprintf(rows.rows[0].settings, sizeof rows.rows[0].settings, "elsewhere");
    CHECK(report_rows_append(rows.rows, rows.count, path));
    FILE *stream = fopen(path, "a");
    CHECK(stream && fprintf(stream, "c\tsun\t512\thard") > 0 && fclose(stream) == 0);
    CHECK(report_rows_read(&back, "here", path));
    CHECK_INT(back.count, 1);
    CHECK(strcmp(back.rows[0].scene, "b") == 0);
    CHECK(report_rows_replace(&back, path));
    report_rows again = {0};
    CHECK(report_rows_read(&again, "elsewhere", path));
    CHECK_INT(again.count, 0);
    CHECK(report_rows_read(&again, "here", path));
    CHECK_INT(again.count, 1);
    report_rows_free(&rows);
    report_rows_free(&back);
    report_rows_free(&again);
    remove(path);
}

static const report_row *find_mean(const report_rows *rows, const char *filter,
                                   const char *method) {
    report_row key = make_row(REPORT_ALL, filter, method, 0, 0);
    snprintf(key.light, sizeof key.light, "%s", REPORT_ALL);
    return report_rows_find(rows, &key);
}

/* 1 ms and 4 ms: 2 ms; errors 10 and 30: 20. What is missing in one scene of its kind has none. */
TEST(report_means_are_geometric_for_times_and_over_all_scenes_of_a_kind) {
    report_rows rows = {0};
    add(&rows, make_row("a", "hard", "none", 1, 10));
    add(&rows, make_row("b", "hard", "none", 4, 30));
    add(&rows, make_row("a", "hard", "slope", 1, 10));
    add(&rows, make_row("a", "pcss", "slope", 8, 0.5));
    for (size_t i = 0; i < rows.count; i++)
        rows.rows[i].shading_ms = rows.rows[i].map_ms;
    CHECK_INT(report_count_pairs(&rows, true), 2);
    CHECK_INT(report_count_pairs(&rows, false), 1);
    CHECK(report_add_means(&rows));
    const report_row *none = find_mean(&rows, "hard", "none");
    const report_row *pcss = find_mean(&rows, "pcss", "slope");
    CHECK(none && pcss && !find_mean(&rows, "hard", "slope"));
    if (none && pcss) {
        CHECK_NEAR(none->map_ms, 2, 1e-12);
        CHECK_NEAR(report_row_ms(none), 4, 1e-12);
        CHECK_NEAR(none->wrong_ppm, 20, 1e-12);
        CHECK(isnan(none->ssim));
        CHECK_NEAR(pcss->rms, 0.5, 1e-12);
    }
    report_rows_free(&rows);
}

TEST(report_front_has_what_nothing_beats_in_both) {
    report_rows rows = {0};
    add(&rows, make_row("a", "hard", "fast", 1, 50));
    add(&rows, make_row("a", "hard", "right", 5, 1));
    add(&rows, make_row("a", "hard", "beaten", 6, 1));
    add(&rows, make_row("a", "pcss", "soft", 0.5, 0));
    add(&rows, make_row("a", "hard", "whole", 7, 1)); /* as "right", but for boundaries */
    rows.rows[4].wrong_ppm = 0.5;
    const bool expected[5] = {true, true, false, true, true};
    for (size_t i = 0; i < 5; i++)
        CHECK(report_is_on_front(&rows, &rows.rows[i], report_rms) == expected[i]);
    report_rows_free(&rows);
}

/* The limit leaves what takes 2 ms and more; a tenth more buys the smaller error, more does not. Of
 * two that are equally right the faster one is taken, wherever it stands. */
TEST(report_recommends_the_most_right_of_the_fastest) {
    report_rows rows = {0};
    add(&rows, make_row("a", "hard", "rough", 1, 50));
    add(&rows, make_row("a", "hard", "fast", 2, 9));
    add(&rows, make_row("a", "hard", "close, slower", 2.15, 3));
    add(&rows, make_row("a", "hard", "close", 2.1, 3));
    add(&rows, make_row("a", "hard", "slow", 4, 0));
    CHECK(report_add_means(&rows));
    const report_row *fastest = report_fastest(&rows, true, report_rms, 10);
    const report_row *nearest = report_most_exact(&rows, true, report_rms);
    CHECK(fastest && strcmp(fastest->method, "close") == 0);
    CHECK(nearest && strcmp(nearest->method, "slow") == 0);
    CHECK(!report_fastest(&rows, true, report_rms, -1));
    CHECK(!report_fastest(&rows, false, report_rms, 10));
    report_rows_free(&rows);
}

/* Lit: 1 and 0.75 seen; dark: 0 and 0.5; a penumbra of 0.5 seen as 0.25; one does not count. */
TEST(report_judges_soft_shadows_by_light_that_is_missing_or_too_much) {
    uint32_t pixels[6] = {0, 1, 2, 3, 4, 5};
    float visibility[6] = {1, 0.75f, 0, 0.5f, 0.25f, 1};
    float truth[6] = {1, 1, 0, 0, 0.5f, 0}, seen[6] = {0};
    uint8_t mask[6] = {1, 1, 1, 1, 1, 0};
    const measure_frame frame = {.frame = {.width = 6, .height = 1},
                                 .fragment_count = 6,
                                 .pixels = pixels,
                                 .visibility = visibility};
    const soft_truth soft = {truth, seen, mask};
    report_row row = {0};
    CHECK_INT(report_judge_soft(&frame, &soft, &row), SHB_OK);
    CHECK_INT(row.fragments, 5);
    CHECK_NEAR(row.false_shadow_ppm, 125000, 1e-6);
    CHECK_NEAR(row.false_light_ppm, 250000, 1e-6);
    CHECK_NEAR(row.boundary_ppm, 50000, 1e-6);
    CHECK_NEAR(row.wrong_ppm, 200000, 1e-6);
    CHECK_NEAR(row.rms, sqrt(0.375 / 5), 1e-9);
    CHECK(row.ssim < 1);
}

TEST(report_lights_have_names_and_widths) {
    static example_scene scene;
    scene.lights[SCENE_SPOT] =
        (scene_light){.source = {0, 5, 0}, .target = {0, 1, 3}}; /* 5 units away */
    const report_light sun = {SCENE_DIRECTIONAL, 90}, spot = {SCENE_SPOT, 90},
                       point = {SCENE_SPOT, 0};
    char name[24];
    CHECK_NEAR(report_light_width(&scene, sun), 2, 1e-12);
    CHECK_NEAR(report_light_width(&scene, spot), 10, 1e-12);
    CHECK_NEAR(report_light_width(&scene, point), 0, 0);
    report_name_light(spot, name, sizeof name);
    CHECK(strcmp(name, "spot-90deg") == 0);
    report_name_light(point, name, sizeof name);
    CHECK(strcmp(name, "spot") == 0);
}

/* All filters are compared, and only with methods that they serve. */
TEST(report_has_every_filter) {
    report_methods hard = report_list_methods(false), soft = report_list_methods(true);
    size_t count, found = 0;
    const shb_filter_method *filters = shb_filter_methods(&count);
    CHECK(hard.count > 0 && soft.count > 0);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < hard.count + soft.count; k++) {
            const report_method *method =
                k < hard.count ? &hard.methods[k] : &soft.methods[k - hard.count];
            const shb_filter filter = report_method_filter(method, 0.25);
            CHECK(filter.exact || !method->occluders);
            if (strcmp(filter.name, filters[i].name) == 0) {
                found++;
                break;
            }
        }
    CHECK_INT(found, count);
    free(hard.methods);
    free(soft.methods);
}

TEST(report_tells_filters_the_width_of_the_light) {
    report_methods soft = report_list_methods(true);
    size_t told = 0;
    for (size_t i = 0; i < soft.count; i++) {
        const report_method *method = &soft.methods[i];
        const shb_filter filter = report_method_filter(method, 0.125);
        if (strcmp(filter.name, "pcss") == 0 || strcmp(filter.name, "bitmask") == 0) {
            CHECK(filter.params[0] == 0.125f);
            told++;
        }
        if (strcmp(method->filter, "pcf:size=11") == 0)
            CHECK(filter.params[0] == 11);
    }
    CHECK(told > 1);
    free(soft.methods);
}

TEST(report_reads_rows_of_peers_and_nothing_else) {
    const char *path = file_path();
    FILE *stream = fopen(path, "w");
    CHECK(stream != NULL);
    fputs(
        "skipped llvmpipe: install libegl-dev\npeer\tscene\ttriangles\n"
        "embree\thills\t180000\thard shadows, fast build\texact lists\t1024\t1000\t10\t2\t5\t1\t2\t"
        "7\t-1\n",
        stream);
    fclose(stream);
    peer_rows peers = {0};
    CHECK(report_peers_read(&peers, path));
    CHECK_INT(peers.count, 1);
    remove(path);
    CHECK(report_peers_append(&peers, path));
    report_rows rows = {0};
    CHECK(report_rows_read(&rows, "here", path));
    CHECK_INT(rows.count, 0);
    CHECK(!report_peers_read(&peers, "/nonexistent/peers.txt"));
    free(peers.rows);
    report_rows_free(&rows);
    remove(path);
}
