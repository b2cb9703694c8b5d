#include "study_papers.h"

#include "paper.h"
#include "tool.h"

static bool run_papers(shb_context *context, const report_options *options, FILE *table,
                       FILE *section) {
    shb_context *single = tool_create_context("report", 1, SHB_ISA_BEST);
    const paper_output output = {single, context, options->quick, table, section};
    if (!single)
        return false;
    paper_write_head(table);
    fprintf(section,
            "<p class=\"lead\">Each method's time over that of the first of its group, here and in "
            "the paper. The papers measured graphics cards; here one thread of a processor draws "
            "the map, draws what the camera sees and shades it. Overall is all three. The first of "
            "a group is measured beside itself: what its ratio is away "
            "from 1 is noise.%s</p>\n",
            options->quick ? " A quick report takes smaller pictures than the papers." : "");
    const bool done =
        paper_dou(&output) && paper_ehm(&output) && paper_layers(&output) && paper_thesis(&output);
    shb_context_destroy(single);
    return done;
}

const report_study report_study_papers = {
    .name = "papers", .title = "The papers, measured again", .run = run_papers, .own_scenes = true};
