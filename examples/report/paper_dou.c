/* Dou, Yan, Kerzner, Dai and Wyman 2014: table 1 and figure 10. The paper prints the table's
 * milliseconds; of the figure it tells in words that slope-scaled bias takes about 5 % more than
 * constant bias, adaptive bias about 20 %, and dual layers 50 % more than adaptive bias below a map
 * of 4096. */
#include "paper.h"

#include "tool.h"

#define HARD(name, bias, paper)                                                                    \
    { name, bias, "hard", paper }

static const paper_case table_cases[] = {
    HARD("constant", "constant", 1), HARD("slope", "slope", 6.647 / 6.327),
    HARD("adaptive", "adaptive", 7.319 / 6.327), HARD("dual-layer", "dual-layer", 9.890 / 6.327),
    HARD("exact, planes", "exact", 0)};
static const paper_case figure_cases[] = {
    HARD("constant", "constant", 1), HARD("slope", "slope", 1.05),
    HARD("adaptive", "adaptive", 1.2), HARD("dual-layer", "dual-layer", 1.2 * 1.5)};
enum {
    TABLE_CASES = sizeof table_cases / sizeof *table_cases,
    FIGURE_CASES = sizeof figure_cases / sizeof *figure_cases,
    SIZES = 5
};

static const uint32_t sizes[SIZES] = {512, 1024, 2048, 4096, 8192};
static const char *const size_names[SIZES] = {"512", "1024", "2048", "4096", "8192"};

static bool measure_table(const paper_output *output, const measure_frame *frame) {
    paper_row rows[TABLE_CASES];
    const bool done = tool_succeeds(
        "report", "Dou et al. 2014, table 1",
        paper_measure(output, frame, SCENE_SPOT, 1024, "hard", table_cases, TABLE_CASES, rows));
    if (done)
        paper_write_rows(
            output, "Dou et al. 2014, table 1",
            "The paper: Sponza of 20,000 polygons, picture and map of 1024 x 1024. Here: the court "
            "of columns under its spot light, 23,300 triangles.",
            rows, TABLE_CASES,
            "Slope and adaptive bias cost less beside constant bias than in the paper: all methods "
            "share "
            "the projection of the fragment, which is most of a shadow test in software, and the "
            "plane of a planar map takes a few more operations of vectors where the shader cuts a "
            "ray with a plane. Both layers are drawn in one pass over the triangles, so that the "
            "second costs less than the paper's second pass; asking them costs what asking one "
            "depth does, because the map keeps their combination.");
    return done;
}

static bool measure_figure(const paper_output *output, const measure_frame *frame) {
    paper_row rows[SIZES * FIGURE_CASES];
    const size_t size_count = output->quick ? 3 : SIZES;
    bool done = true;
    for (size_t k = 0; k < size_count && done; k++)
        done = tool_succeeds("report", "Dou et al. 2014, figure 10",
                             paper_measure(output, frame, SCENE_SPOT, sizes[k], "hard",
                                           figure_cases, FIGURE_CASES, &rows[k * FIGURE_CASES]));
    if (!done)
        return false;
    paper_write_rows(
        output, "Dou et al. 2014, figure 10",
        "The paper: a scene of 19 million polygons in paraboloid maps; it prints no numbers, but "
        "says about 5 % for slope, about 20 % for adaptive, and another 50 % for dual layers below "
        "4096. Here: the same court in a planar map.",
        rows, size_count * FIGURE_CASES,
        "The larger the map, the more of the time goes into drawing it, which constant, slope and "
        "adaptive bias share; only the ratio of dual layers grows, as the paper says of maps "
        "beyond "
        "4096.");
    paper_write_chart(output, "Dou et al. 2014, figure 10: time by size of the map",
                      "texels along a side", size_names, size_count, rows, FIGURE_CASES);
    return true;
}

bool paper_dou(const paper_output *output) {
    const uint32_t size[2] = {output->quick ? 512 : 1024, output->quick ? 512 : 1024};
    example_scene *scene;
    measure_frame frame;
    const bool done = paper_open(output, "columns", size, &scene, &frame) &&
                      measure_table(output, &frame) && measure_figure(output, &frame);
    measure_frame_destroy(&frame);
    scene_close(scene);
    return done;
}
