/* Every bias method on one scene: demo OUTDIR writes for each method a picture and a view of its
 * errors, a contact sheet of all, and prints a table of what was measured. */
#include "measure.h"
#include "sheet.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { width = 960, height = 600, map_size = 512, divisor = 2, runs = 5, sheet_columns = 6 };

typedef struct demo_state {
    const char *directory;
    example_scene *scene;
    shb_context *context;
    shb_map *map;
    measure_frame frame;
    measure_truth truth;
    shb_image picture;
    contact_sheet sheet;
    unsigned files;
} demo_state;

static const scene_light *demo_light(const demo_state *demo) {
    return &demo->scene->lights[SCENE_DIRECTIONAL];
}

static bool succeeds(shb_result result) {
    return tool_succeeds("demo", "columns", result);
}

static bool open_demo(demo_state *demo) {
    demo->scene = tool_open_scene("demo", "columns");
    if (!demo->scene)
        return false;
    size_t count;
    shb_bias_methods(&count);
    shb_map_desc map = {.width = map_size, .occluders = SHB_OCCLUDERS_TRIANGLES};
    demo->context = tool_create_context("demo", 0, SHB_ISA_BEST);
    demo->picture = (shb_image){malloc(3 * width * height), width, height, 0};
    const bool room =
        demo->picture.pixels && sheet_create(&demo->sheet, sheet_columns, 2 * (uint32_t)count,
                                             width / divisor, height / divisor);
    return demo->context && succeeds(room ? SHB_OK : SHB_ERROR_MEMORY) &&
           succeeds(scene_light_view(demo->scene, SCENE_DIRECTIONAL, map_size, false, &map.view)) &&
           succeeds(shb_map_create(demo->context, &map, &demo->map)) &&
           succeeds(
               measure_frame_create(demo->context, demo->scene, width, height, &demo->frame)) &&
           succeeds(measure_truth_create(&demo->frame, demo->map, &demo->truth));
}

static void close_demo(demo_state *demo) {
    measure_truth_destroy(&demo->truth);
    measure_frame_destroy(&demo->frame);
    shb_map_destroy(demo->map);
    shb_context_destroy(demo->context);
    sheet_destroy(&demo->sheet);
    free(demo->picture.pixels);
    scene_close(demo->scene);
}

static bool write_image(demo_state *demo, const shb_image *image, const char *name) {
    demo->files++;
    return tool_write_picture("demo", image, demo->directory, name);
}

/* Pictures of a method for the map as measuring left it. */
static bool picture_method(demo_state *demo, uint32_t number, const shb_bias *bias,
                           const measure_result *measured) {
    char text[64];
    if (!succeeds(measure_paint(&demo->frame, demo->map, bias, NULL, demo_light(demo)->color,
                                &demo->picture)))
        return false;
    sheet_place(&demo->sheet, 2 * number, &demo->picture, divisor, bias->name);
    if (!write_image(demo, &demo->picture, bias->name) ||
        !succeeds(measure_paint_errors(&demo->frame, &demo->truth, demo->map, bias, NULL,
                                       &demo->picture)))
        return false;
    snprintf(text, sizeof text, "false shadow %.0f light %.0f ppm",
             measured->errors.false_shadow_ppm, measured->errors.false_light_ppm);
    sheet_place(&demo->sheet, 2 * number + 1, &demo->picture, divisor, text);
    snprintf(text, sizeof text, "%s-errors", bias->name);
    return write_image(demo, &demo->picture, text);
}

static bool show_method(demo_state *demo, uint32_t number, const shb_bias *bias) {
    measure_result measured;
    if (!succeeds(measure_method(&demo->frame, &demo->truth, demo->map, bias, NULL,
                                 &demo_light(demo)->contact, runs, &measured)))
        return false;
    printf("%-16s %12.0f %11.0f %9.0f %10.2f %12.1f\n", bias->name,
           measured.errors.false_shadow_ppm, measured.errors.false_light_ppm,
           measured.errors.boundary_ppm, measured.detachment.texels, measured.ns_per_fragment);
    return picture_method(demo, number, bias, &measured);
}

static bool run_demo(demo_state *demo) {
    if (!open_demo(demo))
        return false;
    printf("columns: %llu triangles, %zu fragments, map of %d x %d texels\n",
           (unsigned long long)demo->scene->triangle_count, demo->frame.fragment_count, map_size,
           map_size);
    printf("%-16s %12s %11s %9s %10s %12s\n", "method", "false shadow", "false light", "boundary",
           "detachment", "ns/fragment");
    printf("%-16s %12s %11s %9s %10s %12s\n", "", "ppm", "ppm", "ppm", "texels", "one thread");
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    for (uint32_t i = 0; i < count; i++) {
        const shb_bias bias = methods[i].make();
        if (!show_method(demo, i, &bias))
            return false;
    }
    return write_image(demo, &demo->sheet.image, "methods");
}

int main(int argc, char **argv) {
    if (argc != 2 || argv[1][0] == '-') {
        fprintf(stderr, "usage: demo OUTDIR\n");
        return TOOL_USAGE;
    }
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    demo_state demo = {.directory = argv[1]};
    mkdir(demo.directory, 0777);
    const bool done = run_demo(&demo);
    if (done)
        printf("%u pictures in %s, all methods in %s/methods.ppm, %.1f s\n", demo.files,
               demo.directory, demo.directory, bench_seconds(BENCH_CLOCK_WALL) - start);
    close_demo(&demo);
    return done ? TOOL_OK : TOOL_FAILED;
}
