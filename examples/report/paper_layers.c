/* Weiskopf and Ertl 2003, table 1: pictures per second, which become times. */
#include "paper.h"

#include "tool.h"

enum { CASES = 4, FILTERS = 3, SIZES = 2 };

/* Pictures per second of constant bias and of both layers. */
static const struct {
    const char *group, *filter;
    double constant[SIZES], layers[SIZES];
} filters[FILTERS] = {{"no filtering", "hard", {106.2, 69.1}, {85.3, 30.6}},
                      {"bilinear", "pcf-smooth:size=2", {44.8, 36.6}, {40.6, 21.9}},
                      {"4 x 4 jittered", "jittered:size=4", {27.2, 23.9}, {25.5, 16.6}}};
static const double no_shadow = 167.5;
static const uint32_t sizes[SIZES] = {256, 2048};

static shb_result measure_group(const paper_output *output, const measure_frame *frame, int filter,
                                int size, paper_row *rows) {
    const double constant = filters[filter].constant[size];
    const double layers = constant / filters[filter].layers[size];
    const paper_case cases[CASES] = {
        {"constant", "constant", filters[filter].filter, 1},
        {"midpoint", "midpoint", filters[filter].filter, layers},
        {"dual-layer", "dual-layer", filters[filter].filter, layers},
        {"no shadow", "none", NULL, constant / no_shadow},
    };
    return paper_measure(output, frame, SCENE_DIRECTIONAL, sizes[size], filters[filter].group,
                         cases, CASES, rows);
}

static bool measure_table(const paper_output *output, const measure_frame *frame) {
    paper_row rows[FILTERS * SIZES * CASES];
    shb_result result = SHB_OK;
    for (int filter = 0; filter < FILTERS && !result; filter++)
        for (int size = 0; size < SIZES && !result; size++)
            result =
                measure_group(output, frame, filter, size, &rows[(filter * SIZES + size) * CASES]);
    if (!tool_succeeds("report", "Weiskopf and Ertl 2003, table 1", result))
        return false;
    paper_write_rows(
        output, "Weiskopf and Ertl 2003, table 1",
        "The paper: a factory of 13,284 triangles, picture of 1100 x 1100, maps of 256 and 2048. "
        "Here: the court of columns under its sun. No shadow is the same picture from a filter "
        "that looks at nothing, and no map.",
        rows, sizeof rows / sizeof *rows,
        "As in the paper, two layers cost little with a small map or an expensive filter, and most "
        "with a large map and none. One pass over the triangles keeps both, where a card drew the "
        "scene twice and combined the layers in a third pass, so that they cost less without a "
        "filter. With one they cost at least as much as in the paper: filters weigh less here than "
        "on a card of 2003, whose shaders ran them tap by tap, and the map weighs more.");
    return true;
}

bool paper_layers(const paper_output *output) {
    const uint32_t size[2] = {output->quick ? 480 : 1100, output->quick ? 480 : 1100};
    example_scene *scene;
    measure_frame frame;
    const bool done =
        paper_open(output, "columns", size, &scene, &frame) && measure_table(output, &frame);
    measure_frame_destroy(&frame);
    scene_close(scene);
    return done;
}
