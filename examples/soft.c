/* Every filter under lights with an extent: soft OUTDIR draws the scene with each filter and three
 * methods of bias, measures them against the truth of three disks of light, prints a table, and
 * writes for one of the lights a picture and a map of errors of each, and a contact sheet of all.
 */
#include "soft.h"
#include "arguments.h"
#include "sheet.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { LIGHTS = 3, BIASES = 3, PICTURED = 1, RUNS = 2 };
enum { sheet_columns = 2 * BIASES };

static const char *const bias_names[BIASES] = {"receiver-plane", "adaptive", "exact"};

/* Diameters in world units. */
static const double light_widths[LIGHTS] = {0.2, 0.4, 0.64};

typedef struct soft_options {
    const char *directory, *scene;
    uint32_t samples, map_size, size[2];
    bool help;
} soft_options;

typedef struct soft_state {
    soft_options options;
    example_scene *scene;
    shb_context *context;
    shb_map *map;
    measure_frame frame;
    soft_truth truths[LIGHTS];
    shb_image picture;
    contact_sheet sheet;
    unsigned files;
} soft_state;

/* One filter and one method of bias, and where they stand in their tables. */
typedef struct soft_pair {
    const shb_filter_method *method;
    shb_bias bias;
    uint32_t filter_number, bias_number;
} soft_pair;

static const scene_light *soft_scene_light(const soft_state *soft) {
    return &soft->scene->lights[SCENE_SPOT];
}

static bool succeeds(const char *what, shb_result result) {
    return tool_succeeds("soft", what, result);
}

/* ---- what is measured ---- */

static bool create_truths(soft_state *soft) {
    const shb_view *view = &shb_map_get_info(soft->map)->view;
    for (int i = 0; i < LIGHTS; i++) {
        const shb_area_light area = soft_light(view, light_widths[i], true);
        if (!succeeds("truth", soft_truth_create(&soft->frame, view, &area, soft->options.samples,
                                                 &soft->truths[i])))
            return false;
    }
    return true;
}

static bool open_soft(soft_state *soft) {
    const soft_options *options = &soft->options;
    const uint32_t width = options->size[0], height = options->size[1];
    soft->scene = tool_open_scene("soft", options->scene);
    if (!soft->scene)
        return false;
    size_t count;
    shb_filter_methods(&count);
    shb_map_desc map = {.width = options->map_size, .occluders = SHB_OCCLUDERS_TRIANGLES};
    map.view.reversed = true;
    soft->context = tool_create_context("soft", 0, SHB_ISA_BEST);
    soft->picture = (shb_image){malloc((size_t)width * height * 3), width, height, 0};
    const bool room =
        soft->picture.pixels && sheet_create(&soft->sheet, sheet_columns,
                                             ((uint32_t)count + 1) * sheet_columns, width, height);
    return soft->context && succeeds("pictures", room ? SHB_OK : SHB_ERROR_MEMORY) &&
           succeeds("light", scene_light_view(soft->scene, SCENE_SPOT, options->map_size, true,
                                              &map.view)) &&
           succeeds("map", shb_map_create(soft->context, &map, &soft->map)) &&
           succeeds("map", shb_map_draw(soft->map, &soft->scene->scene, NULL, NULL)) &&
           succeeds("camera", measure_frame_create(soft->context, soft->scene, width, height,
                                                   &soft->frame)) &&
           create_truths(soft);
}

static void close_soft(soft_state *soft) {
    for (int i = 0; i < LIGHTS; i++)
        soft_truth_destroy(&soft->truths[i]);
    measure_frame_destroy(&soft->frame);
    shb_map_destroy(soft->map);
    shb_context_destroy(soft->context);
    sheet_destroy(&soft->sheet);
    free(soft->picture.pixels);
    scene_close(soft->scene);
}

/* ---- pictures ---- */

static bool write_image(soft_state *soft, const shb_image *image, const char *name) {
    soft->files++;
    return tool_write_picture("soft", image, soft->options.directory, name);
}

static bool write_tile(soft_state *soft, uint32_t tile, const char *name, const char *caption) {
    sheet_place(&soft->sheet, tile, &soft->picture, 1, caption);
    return write_image(soft, &soft->picture, name);
}

static bool paint(soft_state *soft, const float *visibility) {
    return succeeds("picture",
                    soft_paint(&soft->frame, &shb_map_get_info(soft->map)->light,
                               soft_scene_light(soft)->color, visibility, &soft->picture));
}

/* The first row of the sheet: the truth of each light. */
static bool picture_truths(soft_state *soft) {
    for (int i = 0; i < LIGHTS; i++) {
        char name[64], caption[64];
        snprintf(name, sizeof name, "soft-truth-%d", i);
        snprintf(caption, sizeof caption, "truth, light of %.2f", light_widths[i]);
        if (!paint(soft, soft->truths[i].visibility) ||
            !write_tile(soft, (uint32_t)i, name, caption))
            return false;
    }
    return true;
}

/* Picture and errors of the latest method, whose place is a row of the sheet for each filter and
 * two columns for each bias. */
static bool picture_method(soft_state *soft, const soft_pair *pair, const shb_soft_errors *errors) {
    const soft_truth *truth = &soft->truths[PICTURED];
    const uint32_t tile = (pair->filter_number + 1) * sheet_columns + 2 * pair->bias_number;
    char name[128], caption[64];
    snprintf(name, sizeof name, "soft-%s-%s", pair->method->name, pair->bias.name);
    if (!paint(soft, truth->seen) || !write_tile(soft, tile, name, pair->method->name))
        return false;
    soft_paint_errors(&soft->frame, truth, &soft->picture);
    snprintf(name, sizeof name, "soft-%s-%s-errors", pair->method->name, pair->bias.name);
    snprintf(caption, sizeof caption, "%s %.4f %.4f", pair->bias.name, errors->rms,
             errors->similarity);
    return write_tile(soft, tile + 1, name, caption);
}

/* ---- the table ---- */

/* The filter for a light of this width: those that know of lights have a parameter for it. */
static bool make_filter(const shb_filter_method *method, double width, shb_filter *filter) {
    char text[64];
    snprintf(text, sizeof text, "%s:light=%g", method->name, width);
    if (shb_filter_parse(text, filter) == SHB_OK)
        return true;
    *filter = method->make();
    return false;
}

static bool show_pair(soft_state *soft, const soft_pair *pair) {
    printf("%-25s %-15s", pair->method->name, pair->bias.name);
    bench_times times = {0};
    for (int i = 0; i < LIGHTS; i++) {
        shb_filter filter;
        shb_soft_errors errors;
        const bool knows_lights = make_filter(pair->method, light_widths[i], &filter);
        if (((i == 0 || knows_lights) &&
             !succeeds(pair->method->name, measure_visibility(&soft->frame, soft->map, &pair->bias,
                                                              &filter, RUNS, &times))) ||
            !succeeds(pair->method->name,
                      soft_truth_compare(&soft->frame, &soft->truths[i], &errors)))
            return false;
        printf("  %8.1f %6.4f %6.4f", 1e9 * times.least / (double)soft->frame.fragment_count,
               errors.rms, errors.similarity);
        if (i == PICTURED && !picture_method(soft, pair, &errors))
            return false;
    }
    printf("\n");
    return true;
}

static bool show_method(soft_state *soft, uint32_t number, const shb_filter_method *method) {
    const shb_filter filter = method->make();
    for (uint32_t i = 0; i < BIASES; i++) {
        soft_pair pair = {.method = method, .filter_number = number, .bias_number = i};
        if (!succeeds(bias_names[i], shb_bias_parse(bias_names[i], &pair.bias)))
            return false;
        const bool is_served = filter.exact || !(pair.bias.needs & SHB_NEEDS_OCCLUDERS);
        if (is_served && !show_pair(soft, &pair))
            return false;
    }
    return true;
}

static bool run_soft(soft_state *soft) {
    if (!open_soft(soft) || !picture_truths(soft))
        return false;
    printf("%s: %llu triangles, %zu fragments, map of %u x %u texels, truth of %u rays\n",
           soft->options.scene, (unsigned long long)soft->scene->triangle_count,
           soft->frame.fragment_count, soft->options.map_size, soft->options.map_size,
           soft->options.samples);
    printf("%-41s", "ns a fragment (one thread), rms, ssim;");
    for (int i = 0; i < LIGHTS; i++)
        printf("  light of %-13.2f", light_widths[i]);
    printf("\n");
    size_t count;
    const shb_filter_method *methods = shb_filter_methods(&count);
    for (uint32_t i = 0; i < count; i++)
        if (!show_method(soft, i, &methods[i]))
            return false;
    return write_image(soft, &soft->sheet.image, "soft");
}

/* ---- the command line ---- */

static bool read_options(int argc, char **argv, soft_options *options, int *exit_code) {
    *options = (soft_options){.directory = "build/out",
                              .scene = "tree",
                              .samples = 256,
                              .map_size = 1024,
                              .size = {352, 264}};
    const argument_spec arguments[] = {
        {NULL, "OUTDIR", "where pictures go (build/out)", ARGUMENT_TEXT, &options->directory, 0, 0},
        {"--scene", "NAME|FILE", "built-in scene or OBJ file (tree)", ARGUMENT_TEXT,
         &options->scene, 0, 0},
        {"--samples", "N", "rays of the truth, 1 to 4096 (256)", ARGUMENT_COUNT, &options->samples,
         1, SHB_AREA_SAMPLES_MAX},
        {"--map-size", "N", "texels on a side (1024)", ARGUMENT_COUNT, &options->map_size, 8,
         SHB_SIZE_MAX},
        {"--size", "WxH", "of the pictures (352x264)", ARGUMENT_SIZE, options->size, 8, 2048},
        {"--help", NULL, "print this", ARGUMENT_FLAG, &options->help, 0, 0},
    };
    return arguments_read(argc, argv, "soft [OUTDIR] [OPTIONS]", arguments,
                          sizeof arguments / sizeof *arguments, NULL, exit_code);
}

int main(int argc, char **argv) {
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    soft_state soft = {0};
    int exit_code;
    if (!read_options(argc, argv, &soft.options, &exit_code))
        return exit_code;
    mkdir(soft.options.directory, 0777);
    const bool done = run_soft(&soft);
    if (done)
        printf("%u pictures in %s, all in %s/soft.ppm, %.1f s\n", soft.files,
               soft.options.directory, soft.options.directory,
               bench_seconds(BENCH_CLOCK_WALL) - start);
    close_soft(&soft);
    return done ? TOOL_OK : TOOL_FAILED;
}
