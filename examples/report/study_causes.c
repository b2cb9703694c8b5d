#include "study_causes.h"

#include "cause_picture.h"
#include "method_list.h"
#include "page_images.h"
#include "page_table.h"
#include "pictures.h"
#include "png.h"
#include "scene_list.h"
#include "stage.h"
#include "tool.h"

#include <stdlib.h>

enum { MAP_SIZE = 1024, SWATCH_WIDTH = 20, SWATCH_HEIGHT = 12 };

/* What is looked at: methods with their default parameters. */
static const struct {
    const char *title, *method, *filter;
    shb_format format;
} subjects[] = {
    {"none", "none", "hard", SHB_FORMAT_FLOAT32},
    {"constant", "constant", "hard", SHB_FORMAT_FLOAT32},
    {"slope", "slope", "hard", SHB_FORMAT_FLOAT32},
    {"slope-pcf-5", "slope", "pcf:size=5,taps=1", SHB_FORMAT_FLOAT32},
    {"normal-offset", "normal-offset", "hard", SHB_FORMAT_FLOAT32},
    {"receiver-plane", "receiver-plane", "hard", SHB_FORMAT_FLOAT32},
    {"texel-cone", "texel-cone", "hard", SHB_FORMAT_FLOAT32},
    {"dual-layer", "dual-layer", "hard", SHB_FORMAT_FLOAT32},
    {"adaptive", "adaptive", "hard", SHB_FORMAT_FLOAT32},
    {"adaptive-16-bit", "adaptive", "hard", SHB_FORMAT_UNORM16},
    {"adaptive-soft", "adaptive-soft", "hard", SHB_FORMAT_FLOAT32},
    {"exact-planes", "exact-planes", "hard", SHB_FORMAT_FLOAT32},
    {"exact-triangles", "exact-triangles", "hard", SHB_FORMAT_FLOAT32},
};
enum { SUBJECTS = sizeof subjects / sizeof *subjects };

/* The tests in the order in which they are made; NULL: the cause is none of this side. */
static const struct {
    cause kind;
    const char *acne, *leak;
} tests[] = {
    {CAUSE_KERNEL, "the filter is wider than a texel, and its one tap at the fragment is right",
     "the same"},
    {CAUSE_QUANTISATION, "a map of float depths would light it, or rounding alone decides",
     "a map of float depths would darken it, or rounding alone decides"},
    {CAUSE_SLOPE,
     "the receiver's own plane, taken at the texel's centre, lights it: the method compared "
     "something deeper",
     NULL},
    {CAUSE_BIAS, NULL,
     "the offset exceeds the gap: at the fragment's own light ray nothing lies before the biased "
     "receiver, but something lies before the fragment; or the map keeps depths of its own where "
     "the nearest one darkens"},
    {CAUSE_OFFSET,
     "the point was moved to another texel; at its own one the receiver's plane lights it",
     "the point was moved to another texel; at its own one the sample darkens it"},
    {CAUSE_CREASE,
     "the sample is another triangle's that shares a corner with the receiver's, or whose plane, "
     "carried to the fragment's own light ray, lies not before the fragment: one surface, bent "
     "within a texel",
     NULL},
    {CAUSE_EXTRAPOLATION, NULL,
     "the sample lies before the receiver's plane at the fragment, but not where the plane was "
     "carried to the texel's centre; or the exact method's plane of the occluder was carried past "
     "the fragment"},
    {CAUSE_SAMPLING, "the sample is a true occluder's that the fragment's own light ray misses",
     "the occluder on the fragment's own light ray is missed, or deeper, at the texel's centre"},
    {CAUSE_UNEXPLAINED, "none of these", "none of these"},
};
enum { TESTS = sizeof tests / sizeof *tests };

typedef struct cause_study {
    const report_options *options;
    FILE *table, *section;
    report_stage *stage;
    scene_light_kind light;
    measure_truth truth;
    uint8_t *causes, *pixels;
    cause_counts counts[SUBJECTS];
} cause_study;

/* ---- measuring ---- */

static shb_result create_map(const cause_study *s, const listed_method *method, shb_format format,
                             shb_map **map) {
    shb_map_desc desc = {.width = MAP_SIZE, .format = format, .occluders = method->occluders};
    const shb_result result =
        scene_light_view(s->stage->scene, s->light, MAP_SIZE, false, &desc.view);
    return result ? result : shb_map_create(s->stage->context, &desc, map);
}

/* Of the light; no method's depths matter. */
static shb_result find_truth(cause_study *s) {
    const listed_method any = {0};
    shb_map *map = NULL;
    shb_result result = create_map(s, &any, SHB_FORMAT_FLOAT32, &map);
    if (!result)
        result = measure_truth_create(&s->stage->frame, map, &s->truth);
    shb_map_destroy(map);
    return result;
}

static shb_result find_causes(const cause_study *s, size_t number, cause_counts *counts) {
    listed_method method;
    shb_filter filter;
    shb_map *map = NULL;
    if (!method_list_named(subjects[number].method, &method))
        return SHB_ERROR_ARGUMENT;
    const shb_bias bias = method.method->make();
    const shb_scene *scene = &s->stage->scene->scene;
    shb_result result = shb_filter_parse(subjects[number].filter, &filter);
    if (!result)
        result = create_map(s, &method, subjects[number].format, &map);
    if (!result)
        result = shb_map_draw(map, scene, &bias, NULL);
    if (!result)
        result = shb_map_prepare(map, &filter);
    const cause_question question = {&s->stage->frame, &s->truth, map, &bias, &filter};
    if (!result)
        result = causes_find(&question, s->causes);
    if (!result)
        *counts = causes_count(&question, s->causes);
    shb_map_destroy(map);
    return result;
}

/* ---- writing ---- */

/* An image that the page holds; text: what it shows. */
static bool embed(FILE *section, const png_image *image, const char *text) {
    bytes file = {0};
    const bool encoded = png_encode(image, &file);
    if (encoded) {
        fprintf(section, "<img width=\"%u\" height=\"%u\" alt=\"%s\" src=\"data:image/png;base64,",
                (unsigned)image->width, (unsigned)image->height, text);
        report_write_base64(section, file.data, file.size);
        fprintf(section, "\">");
    }
    bytes_free(&file);
    return encoded;
}

/* A patch of one cause, beside its name. */
static bool write_swatch(FILE *section, cause kind) {
    uint8_t pixels[3 * SWATCH_WIDTH * SWATCH_HEIGHT];
    for (uint32_t y = 0; y < SWATCH_HEIGHT; y++)
        for (uint32_t x = 0; x < SWATCH_WIDTH; x++)
            cause_picture_color(kind, x, y, pixels + 3 * (y * SWATCH_WIDTH + x));
    const png_image image = {pixels, SWATCH_WIDTH, SWATCH_HEIGHT, 0, PNG_RGB};
    return embed(section, &image, "");
}

static double share_of(uint64_t count, const cause_counts *counts) {
    return counts->wrong ? 100.0 * (double)count / (double)counts->wrong : 0;
}

static double wrong_ppm(const cause_counts *counts) {
    return counts->fragments ? 1e6 * (double)counts->wrong / (double)counts->fragments : 0;
}

static void write_table_head(FILE *table) {
    fprintf(table, "scene\tlight\tmap_size\tmethod\tfragments\twrong");
    for (size_t k = 0; k < TESTS; k++)
        if (tests[k].acne)
            fprintf(table, "\tacne_%s", cause_name(tests[k].kind));
    for (size_t k = 0; k < TESTS; k++)
        if (tests[k].leak)
            fprintf(table, "\tleak_%s", cause_name(tests[k].kind));
    fprintf(table, "\n");
}

static void write_table_row(const cause_study *s, size_t number) {
    const cause_counts *counts = &s->counts[number];
    fprintf(s->table, "%s\t%s\t%u\t%s\t%llu\t%llu", s->stage->name, report_light_name(s->light),
            (unsigned)MAP_SIZE, subjects[number].title, (unsigned long long)counts->fragments,
            (unsigned long long)counts->wrong);
    for (size_t k = 0; k < TESTS; k++)
        if (tests[k].acne)
            fprintf(s->table, "\t%llu", (unsigned long long)counts->acne[tests[k].kind]);
    for (size_t k = 0; k < TESTS; k++)
        if (tests[k].leak)
            fprintf(s->table, "\t%llu", (unsigned long long)counts->leak[tests[k].kind]);
    fprintf(s->table, "\n");
}

static bool write_legend(FILE *section) {
    bool done = true;
    fprintf(
        section,
        "<p class=\"lead\">Each wrong fragment gets the first cause whose test it passes, of those "
        "below "
        "from top to bottom. The tests ask the truth and the map again with one thing changed. "
        "Grey is what is right, lighter where it is lit.</p>\n"
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Causes\">\n<table "
        "class=\"plain\">\n<caption>The causes and their tests</caption><thead><tr><th "
        "class=\"text\" scope=\"col\">cause</th><th "
        "class=\"text\" scope=\"col\">false shadow if</th><th class=\"text\" scope=\"col\">false "
        "light if</th></tr></thead>\n<tbody>\n");
    for (size_t k = 0; k < TESTS && done; k++) {
        fprintf(section, "<tr><th scope=\"row\">");
        done = write_swatch(section, tests[k].kind);
        fprintf(section,
                " %s</th><td class=\"text prose\">%s</td><td class=\"text prose\">%s</td></tr>\n",
                cause_name(tests[k].kind), tests[k].acne ? tests[k].acne : "-",
                tests[k].leak ? tests[k].leak : "-");
    }
    fprintf(section, "</tbody>\n</table>\n</div>\n");
    return done;
}

/* The caption names the largest share of each side. */
static void write_caption(FILE *section, const char *title, const cause_counts *counts) {
    cause acne = CAUSE_KERNEL, leak = CAUSE_KERNEL;
    for (int k = CAUSE_KERNEL; k < CAUSES; k++) {
        acne = counts->acne[k] > counts->acne[acne] ? (cause)k : acne;
        leak = counts->leak[k] > counts->leak[leak] ? (cause)k : leak;
    }
    char wrong[32];
    report_format_number(wrong, sizeof wrong, wrong_ppm(counts));
    fprintf(section, "<figcaption><b>%s</b>: %s wrong per million", title, wrong);
    if (counts->acne[acne])
        fprintf(section, "; %.1f %% false shadow by %s", share_of(counts->acne[acne], counts),
                cause_name(acne));
    if (counts->leak[leak])
        fprintf(section, "; %.1f %% false light by %s", share_of(counts->leak[leak], counts),
                cause_name(leak));
    fprintf(section, "</figcaption>");
}

static shb_result write_picture(const cause_study *s, size_t number) {
    char path[REPORT_PICTURE_PATH], text[160];
    const measure_frame *frame = &s->stage->frame;
    const png_image image = {s->pixels, frame->frame.width, frame->frame.height, 0, PNG_RGB};
    cause_picture_paint(frame, s->truth.pixels, s->causes, s->pixels);
    snprintf(text, sizeof text, "Causes of errors of %s, %s, %s", subjects[number].title,
             s->stage->name, report_light_name(s->light));
    if (snprintf(path, sizeof path, "%s/pictures/causes-%s-%s-%s.png", s->options->directory,
                 s->stage->name, report_light_name(s->light),
                 subjects[number].title) >= (int)sizeof path ||
        !png_write(&image, path))
        return SHB_ERROR_FILE;
    fprintf(s->section, "<figure>");
    const bool embedded = embed(s->section, &image, text);
    write_caption(s->section, subjects[number].title, &s->counts[number]);
    fprintf(s->section, "</figure>\n");
    return embedded ? SHB_OK : SHB_ERROR_MEMORY;
}

static void write_share(FILE *section, uint64_t count, const cause_counts *counts) {
    if (count)
        fprintf(section, "<td>%.1f</td>", share_of(count, counts));
    else
        fprintf(section, "<td>-</td>");
}

static void write_shares(const cause_study *s) {
    fprintf(s->section,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Shares of causes, "
            "%s, %s\">\n<table class=\"plain\">\n<caption>Shares of the wrong fragments in "
            "percent</caption>\n<thead><tr><th class=\"text\" scope=\"col\">method</th><th "
            "scope=\"col\">wrong per million</th>",
            s->stage->name, report_light_name(s->light));
    for (size_t k = 0; k < TESTS; k++)
        if (tests[k].acne)
            fprintf(s->section, "<th scope=\"col\">false shadow by %s</th>",
                    cause_name(tests[k].kind));
    for (size_t k = 0; k < TESTS; k++)
        if (tests[k].leak)
            fprintf(s->section, "<th scope=\"col\">false light by %s</th>",
                    cause_name(tests[k].kind));
    fprintf(s->section, "</tr></thead>\n<tbody>\n");
    for (size_t i = 0; i < SUBJECTS; i++) {
        const cause_counts *counts = &s->counts[i];
        char wrong[32];
        report_format_number(wrong, sizeof wrong, wrong_ppm(counts));
        fprintf(s->section, "<tr><th scope=\"row\">%s</th><td>%s</td>", subjects[i].title, wrong);
        for (size_t k = 0; k < TESTS; k++)
            if (tests[k].acne)
                write_share(s->section, counts->acne[tests[k].kind], counts);
        for (size_t k = 0; k < TESTS; k++)
            if (tests[k].leak)
                write_share(s->section, counts->leak[tests[k].kind], counts);
        fprintf(s->section, "</tr>\n");
    }
    fprintf(s->section, "</tbody>\n</table>\n</div>\n");
}

/* ---- running ---- */

static shb_result study_light(cause_study *s) {
    shb_result result = find_truth(s);
    fprintf(s->section, "<h3>%s, %s, map of %u</h3>\n<div class=\"causes\">\n", s->stage->name,
            report_light_name(s->light), (unsigned)MAP_SIZE);
    for (size_t i = 0; i < SUBJECTS && !result; i++) {
        result = find_causes(s, i, &s->counts[i]);
        if (!result)
            result = write_picture(s, i);
        if (!result)
            write_table_row(s, i);
    }
    fprintf(s->section, "</div>\n");
    write_shares(s);
    measure_truth_destroy(&s->truth);
    return result;
}

static bool study_scene(cause_study *s, shb_context *context, const report_scene *scene) {
    report_stage stage;
    const uint32_t *size = report_picture_size(s->options);
    bool done = report_stage_open(context, scene->text, scene->name, size, &stage);
    s->stage = &stage;
    s->causes = malloc((size_t)size[0] * size[1]);
    s->pixels = malloc(3 * (size_t)size[0] * size[1]);
    done = done &&
           tool_succeeds("report", "causes", s->causes && s->pixels ? SHB_OK : SHB_ERROR_MEMORY);
    for (int light = 0; done && light < (scene->both_lights ? SCENE_LIGHT_KINDS : 1); light++) {
        s->light = (scene_light_kind)light;
        done = tool_succeeds("report", scene->name, study_light(s));
    }
    free(s->causes);
    free(s->pixels);
    report_stage_close(&stage);
    return done;
}

static bool run_causes(shb_context *context, const report_options *options, FILE *table,
                       FILE *section) {
    cause_study s = {.options = options, .table = table, .section = section};
    report_scene_list scenes = report_list_main_scenes(options);
    write_table_head(table);
    bool done =
        tool_succeeds("report", "scenes", scenes.failed ? SHB_ERROR_MEMORY : SHB_OK) &&
        tool_succeeds("report", "legend", write_legend(section) ? SHB_OK : SHB_ERROR_MEMORY);
    for (size_t i = 0; done && i < scenes.count; i++)
        done = study_scene(&s, context, &scenes.scenes[i]);
    report_scene_list_free(&scenes);
    return done;
}

const report_study report_study_causes = {
    .name = "causes", .title = "Which setting is to blame", .run = run_causes};
