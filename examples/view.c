/* Any scene with any method: view --help. */
#include "arguments.h"
#include "measure.h"
#include "progress.h"
#include "tool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct view_options {
    const char *scene, *light, *bias, *filter, *occluders, *format, *isa, *out, *errors;
    uint32_t map_size, threads, size[2];
    double eye[3], target[3], to_light[3]; /* NaN: the scene's own */
    bool reversed, stats, list, help;
} view_options;

/* What the options stand for. */
typedef struct view_setup {
    scene_light_kind light;
    shb_bias bias;
    shb_filter filter;
    shb_occluders occluders;
    shb_format format;
    shb_isa isa;
} view_setup;

/* Everything that is made for one picture. */
typedef struct view_work {
    example_scene *scene;
    shb_context *context;
    shb_map *map;
    measure_frame frame;
    measure_truth truth;
    shb_image image;
    progress_line progress;
} view_work;

static void print_error(const char *name, const char *value, const char *problem) {
    fprintf(stderr, "view: %s: \"%s\" %s\n", name, value, problem);
}

/* As the options take it. */
static void print_method(const char *name, const char *const params[SHB_PARAMS_MAX],
                         const float values[SHB_PARAMS_MAX], const char *summary) {
    char text[128];
    int length = snprintf(text, sizeof text, "%s", name);
    for (int k = 0; k < SHB_PARAMS_MAX && params[k]; k++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%c%s=%g", k ? ',' : ':',
                           params[k], (double)values[k]);
    printf("  %-48s %s\n", text, summary);
}

static void print_biases(void) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    printf("bias methods, with their parameters' defaults:\n");
    for (size_t i = 0; i < count; i++)
        print_method(methods[i].name, methods[i].param_names, methods[i].make().params,
                     methods[i].summary);
}

static void print_filters(void) {
    size_t count;
    const shb_filter_method *methods = shb_filter_methods(&count);
    printf("filters, with their parameters' defaults:\n");
    for (size_t i = 0; i < count; i++)
        print_method(methods[i].name, methods[i].param_names, methods[i].make().params,
                     methods[i].summary);
}

static void print_lists(void) {
    print_biases();
    print_filters();
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    printf("scenes, with their parameters' defaults:\n");
    for (size_t i = 0; i < count; i++) {
        char text[64];
        if (entries[i].parameter)
            snprintf(text, sizeof text, "%s:%g", entries[i].name, entries[i].standard);
        else
            snprintf(text, sizeof text, "%s", entries[i].name);
        printf("  %-48s %s%s%s\n", text, entries[i].summary, entries[i].parameter ? "; " : "",
               entries[i].parameter ? entries[i].parameter : "");
    }
}

static bool find_name(const char *option, const char *name, const char *const *names, int *index) {
    for (*index = 0; names[*index]; ++*index)
        if (strcmp(name, names[*index]) == 0)
            return true;
    print_error(option, name, "is unknown");
    return false;
}

static bool read_setup(const view_options *options, view_setup *setup) {
    static const char *const lights[] = {"directional", "spot", NULL};
    static const char *const occluder_kinds[] = {"planes", "triangles", "lists", NULL};
    static const char *const formats[] = {"float32", "unorm24", "unorm16", NULL};
    int light, occluders, format;
    if (!find_name("--light", options->light, lights, &light) ||
        !find_name("--occluders", options->occluders, occluder_kinds, &occluders) ||
        !find_name("--format", options->format, formats, &format))
        return false;
    setup->light = (scene_light_kind)light;
    setup->occluders = (shb_occluders)(SHB_OCCLUDERS_PLANES + occluders);
    setup->format = (shb_format)format;
    if (shb_bias_parse(options->bias, &setup->bias)) {
        print_error("--bias", options->bias, "is not a method with its parameters, see --list");
        return false;
    }
    if (shb_filter_parse(options->filter, &setup->filter)) {
        print_error("--filter", options->filter, "is not a filter with its parameters, see --list");
        return false;
    }
    if (!tool_parse_isa(options->isa, &setup->isa)) {
        print_error("--isa", options->isa, "is not best, scalar, sse2, avx2, avx512 or neon");
        return false;
    }
    const double *to_light = options->to_light;
    if (to_light[0] == 0 && to_light[1] == 0 && to_light[2] == 0) {
        print_error("--to-light", "0,0,0", "is no direction");
        return false;
    }
    if (options->out || options->errors || options->stats)
        return true;
    fprintf(stderr, "view: nothing to do: give --out, --error or --stats\n");
    return false;
}

static void override_point(const double values[3], shb_vec3 *point) {
    if (!isnan(values[0]))
        *point = (shb_vec3){values[0], values[1], values[2]};
}

static bool is_same(shb_vec3 a, shb_vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool open_scene(const view_options *options, view_work *work) {
    work->scene = tool_open_scene("view", options->scene);
    if (!work->scene)
        return false;
    scene_camera camera = work->scene->camera;
    override_point(options->eye, &camera.eye);
    override_point(options->target, &camera.target);
    if (is_same(camera.eye, camera.target)) {
        fprintf(stderr, "view: --eye and --target are the same point\n");
        return false;
    }
    if (!isnan(options->eye[0]) || !isnan(options->target[0]))
        scene_move_camera(work->scene, camera.eye, camera.target);
    override_point(options->to_light, &work->scene->lights[SCENE_DIRECTIONAL].source);
    return true;
}

static bool succeeds(const char *what, shb_result result) {
    return tool_succeeds("view", what, result);
}

/* Everything up to a map without depths and the camera's fragments. */
static bool prepare(const view_options *options, const view_setup *setup, view_work *work) {
    progress_begin(&work->progress, 4);
    progress_step(&work->progress, "reading the scene");
    if (!open_scene(options, work))
        return false;
    progress_step(&work->progress, "drawing the camera's view");
    work->context = tool_create_context("view", options->threads, setup->isa);
    if (!work->context)
        return false;
    const uint32_t width = options->size[0], height = options->size[1];
    work->image = (shb_image){malloc(3 * (size_t)width * height), width, height, 0};
    shb_map_desc desc = {
        .width = options->map_size, .format = setup->format, .occluders = setup->occluders};
    return succeeds("image", work->image.pixels ? SHB_OK : SHB_ERROR_MEMORY) &&
           succeeds("light", scene_light_view(work->scene, setup->light, options->map_size,
                                              options->reversed, &desc.view)) &&
           succeeds("map", shb_map_create(work->context, &desc, &work->map)) &&
           succeeds("camera",
                    measure_frame_create(work->context, work->scene, width, height, &work->frame));
}

static void release(view_work *work) {
    progress_end(&work->progress);
    measure_truth_destroy(&work->truth);
    measure_frame_destroy(&work->frame);
    shb_map_destroy(work->map);
    shb_context_destroy(work->context);
    free(work->image.pixels);
    scene_close(work->scene);
}

static bool print_stats(const view_options *options, const view_work *work,
                        const measure_result *measured, double shade_seconds) {
    printf("scene\ttriangles\tmap_size\tbias\tfilter\tfragments\tfalse_shadow_ppm\t"
           "false_light_ppm\tboundary_ppm\tmap_ms\tshade_ms\tns_per_fragment\n");
    printf("%s\t%llu\t%u\t%s\t%s\t%zu\t%.1f\t%.1f\t%.1f\t%.3f\t%.3f\t%.2f\n", options->scene,
           (unsigned long long)work->scene->triangle_count, options->map_size, options->bias,
           options->filter, work->frame.fragment_count, measured->errors.false_shadow_ppm,
           measured->errors.false_light_ppm, measured->errors.boundary_ppm,
           1e3 * measured->map_seconds, 1e3 * shade_seconds, measured->ns_per_fragment);
    return succeeds("standard output", fflush(stdout) ? SHB_ERROR_FILE : SHB_OK);
}

/* Fills the map and, if somebody asks, measures. */
static bool draw_and_measure(const view_options *options, const view_setup *setup, view_work *work,
                             measure_result *measured) {
    if (!options->stats && !options->errors)
        return succeeds("map", shb_map_draw(work->map, &work->scene->scene, &setup->bias, NULL)) &&
               succeeds("filter", shb_map_prepare(work->map, &setup->filter));
    progress_step(&work->progress, "casting rays for the truth");
    return succeeds("truth", measure_truth_create(&work->frame, work->map, &work->truth)) &&
           succeeds("measuring", measure_method(&work->frame, &work->truth, work->map, &setup->bias,
                                                &setup->filter, NULL, 5, measured));
}

static bool write_pictures(const view_options *options, const view_setup *setup, view_work *work,
                           double *shade_seconds) {
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    if (!succeeds("shading", measure_paint(&work->frame, work->map, &setup->bias, &setup->filter,
                                           work->scene->lights[setup->light].color, &work->image)))
        return false;
    *shade_seconds = bench_seconds(BENCH_CLOCK_WALL) - start;
    if (options->out && !tool_write_image("view", &work->image, options->out))
        return false;
    return !options->errors ||
           (succeeds("shading", measure_paint_errors(&work->frame, &work->truth, work->map,
                                                     &setup->bias, &setup->filter, &work->image)) &&
            tool_write_image("view", &work->image, options->errors));
}

static bool show(const view_options *options, const view_setup *setup, view_work *work) {
    double shade_seconds = 0;
    measure_result measured = {0};
    if (!prepare(options, setup, work) || !draw_and_measure(options, setup, work, &measured))
        return false;
    progress_step(&work->progress, "shading");
    if (!write_pictures(options, setup, work, &shade_seconds))
        return false;
    progress_end(&work->progress);
    return !options->stats || print_stats(options, work, &measured, shade_seconds);
}

/* False when the program is to end with *exit_code. */
static bool read_options(int argc, char **argv, view_options *options, int *exit_code) {
    const argument_spec arguments[] = {
        {NULL, "SCENE", "built-in scene or OBJ file (columns)", ARGUMENT_TEXT, &options->scene, 0,
         0},
        {"--light", "KIND", "directional or spot (directional)", ARGUMENT_TEXT, &options->light, 0,
         0},
        {"--bias", "NAME[:PARAM=X,..]", "bias method (adaptive)", ARGUMENT_TEXT, &options->bias, 0,
         0},
        {"--filter", "NAME[:PARAM=X,..]", "filter (hard)", ARGUMENT_TEXT, &options->filter, 0, 0},
        {"--occluders", "KIND", "planes, triangles or lists, for exact (triangles)", ARGUMENT_TEXT,
         &options->occluders, 0, 0},
        {"--map-size", "N", "texels on a side (1024)", ARGUMENT_COUNT, &options->map_size, 8,
         SHB_SIZE_MAX},
        {"--format", "NAME", "float32, unorm24 or unorm16 (float32)", ARGUMENT_TEXT,
         &options->format, 0, 0},
        {"--reversed", NULL, "map depth falls from 1 to 0", ARGUMENT_FLAG, &options->reversed, 0,
         0},
        {"--size", "WxH", "of the picture (960x600)", ARGUMENT_SIZE, options->size, 1,
         SHB_SIZE_MAX},
        {"--eye", "X,Y,Z", "where the camera stands", ARGUMENT_POINT, options->eye, 0, 0},
        {"--target", "X,Y,Z", "what it looks at", ARGUMENT_POINT, options->target, 0, 0},
        {"--to-light", "X,Y,Z", "direction to the directional light", ARGUMENT_POINT,
         options->to_light, 0, 0},
        {"--threads", "N", "0: one a processor (0)", ARGUMENT_COUNT, &options->threads, 0, 256},
        {"--isa", "NAME", "best, scalar, sse2, avx2, avx512, neon (best)", ARGUMENT_TEXT,
         &options->isa, 0, 0},
        {"--out", "FILE.ppm", "write the picture", ARGUMENT_TEXT, &options->out, 0, 0},
        {"--error", "FILE.ppm", "write false shadow in red, false light in blue", ARGUMENT_TEXT,
         &options->errors, 0, 0},
        {"--stats", NULL, "print errors and times, tab-separated", ARGUMENT_FLAG, &options->stats,
         0, 0},
        {"--list", NULL, "print methods, filters and scenes", ARGUMENT_FLAG, &options->list, 0, 0},
        {"--help", NULL, "print this", ARGUMENT_FLAG, &options->help, 0, 0},
    };
    return arguments_read(argc, argv, "view [SCENE] [OPTIONS]", arguments,
                          sizeof arguments / sizeof *arguments, NULL, exit_code);
}

int main(int argc, char **argv) {
    view_options options = {.scene = "columns",
                            .light = "directional",
                            .bias = "adaptive",
                            .filter = "hard",
                            .occluders = "triangles",
                            .format = "float32",
                            .isa = "best",
                            .map_size = 1024,
                            .size = {960, 600},
                            .eye = {(double)NAN},
                            .target = {(double)NAN},
                            .to_light = {(double)NAN}};
    int exit_code;
    if (!read_options(argc, argv, &options, &exit_code))
        return exit_code;
    if (options.list) {
        print_lists();
        return TOOL_OK;
    }
    view_setup setup;
    if (!read_setup(&options, &setup))
        return TOOL_USAGE;
    view_work work = {0};
    const bool done = show(&options, &setup, &work);
    release(&work);
    return done ? TOOL_OK : TOOL_FAILED;
}
