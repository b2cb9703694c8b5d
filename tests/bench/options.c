#include "options.h"

#include "arguments.h"
#include "light_work.h"
#include "tool.h"

#include "shadowbias/bias.h"

#include <stdio.h>
#include <string.h>

/* Below the list of options. */
static const char notes[] =
    "\n"
    "stages, and what their time is divided by:\n"
    "  depth        closest depth as the light sees it         triangle\n"
    "  camera       depth and ids as the camera sees it        triangle\n"
    "  dual         two closest depths as the light sees them  triangle\n"
    "  cull         everything lies beside the view            triangle\n"
    "  prepare      clusters of the scene's meshes             triangle\n"
    "  moving       maps of vertices that move each time       triangle\n"
    "  visibility   hard:METHOD, fragments of a camera's view  fragment\n"
    "  shade        shade:METHOD, Lambert under one light      fragment\n"
    "  frame        frame:METHOD, map, camera and shading      fragment\n"
    "  goals        times with a goal, by instruction set\n"
    "  ratios       two things by turns, with a goal\n"
    "  soft         filters under area lights: times, errors, goals\n"
    "depth, camera, dual and cull twice, the second time with clusters: so are drawings of goals\n"
    "and ratios.\n"
    "goals, ratios and soft have scenes and sizes of their own: --scene and --size leave them "
    "out.\n"
    "Made for measuring: height-field, hills, huge, stack, triangle and culled.\n"
    "size is that of the map, or of the picture for camera; the pictures of visibility, shade and\n"
    "frame have 1024 x 1024 pixels, or more until half a million fragments are in sight.\n"
    "hard:exact asks planes; by triangles, by lists and by points that name their triangles it is\n"
    "hard:exact-triangles, -triangles-named, -lists and -lists-named.\n"
    "moving draws depth alone, and with planes, triangles and lists for hard:exact.\n"
    "moving and shade have a map of 2048, frame the methods constant and adaptive, unless\n"
    "options name others.\n"
    "With one thread, times are its processor time; with more, time on the wall. Medians are\n"
    "of at least 15 runs (5 with --quick); scalar: of 3, or 1 with --quick or above 0.1 s.\n"
    "limit: the time to write the images once by 64-byte stores (visibility, shade and frame: to\n"
    "copy the bytes that they must read and write), one thread, divided by the time taken.\n"
    "Cycles come from a chain of additions timed at the start.\n";

static const char *const groups[] = {"depth",      "camera", "dual",  "cull",  "prepare", "moving",
                                     "visibility", "shade",  "frame", "goals", "ratios",  "soft"};

/* True for a stage of the exact method on a map of its own. */
static bool is_exact(const char *stage) {
    for (size_t i = 0; i < LIGHT_EXACT_KINDS; i++)
        if (strncmp(stage, "hard:", 5) == 0 && strcmp(stage + 5, light_exact_kinds[i].name) == 0)
            return true;
    return false;
}

/* True if some stage has the name that --only gives. */
static bool is_stage(const bench_options *options) {
    const char *method = strchr(options->only, ':');
    shb_bias bias;
    if (is_exact(options->only))
        return true;
    if (method && (strchr(method + 1, ':') || shb_bias_parse(method + 1, &bias)))
        return false;
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
        if (options_want(options, groups[i], NULL))
            return true;
    return false;
}

/* Prints what is wrong. */
static bool check_names(bench_options *options) {
    if (!tool_parse_isa(options->isa_name, &options->isa)) {
        fprintf(stderr, "bench: --isa: \"%s\" is not best, scalar, sse2, avx2, avx512 or neon\n",
                options->isa_name);
        return false;
    }
    if (!options->only || is_stage(options))
        return true;
    fprintf(stderr, "bench: --only: \"%s\" is no stage, see --help\n", options->only);
    return false;
}

bool options_read(int argc, char **argv, bench_options *options, int *exit_code) {
    *options = (bench_options){.folder = "../shared/scenes", .isa_name = "best", .threads = 1};
    const argument_spec arguments[] = {
        {"--only", "STAGE", "one group of stages or one stage, see below", ARGUMENT_TEXT,
         &options->only, 0, 0},
        {"--scene", "NAME|FILE", "one scene: built-in, made for measuring, or OBJ file",
         ARGUMENT_TEXT, &options->scene, 0, 0},
        {"--scenes", "FOLDER", "where OBJ files lie (../shared/scenes)", ARGUMENT_TEXT,
         &options->folder, 0, 0},
        {"--size", "N", "one size of map and picture (512, 1024, ... 8192)", ARGUMENT_COUNT,
         &options->size, 8, SHB_SIZE_MAX},
        {"--isa", "NAME", "at most best, scalar, sse2, avx2, avx512, neon (best)", ARGUMENT_TEXT,
         &options->isa_name, 0, 0},
        {"--threads", "N", "0: one a processor (1)", ARGUMENT_COUNT, &options->threads, 0, 256},
        {"--pin", NULL, "keep the main thread on its processor", ARGUMENT_FLAG, &options->pin, 0,
         0},
        {"--quick", NULL, "few scenes, sizes and methods: under 40 seconds", ARGUMENT_FLAG,
         &options->quick, 0, 0},
        {"--tsv", NULL, "tab-separated rows below one line of names", ARGUMENT_FLAG, &options->tsv,
         0, 0},
        {"--help", NULL, "print this", ARGUMENT_FLAG, &options->help, 0, 0},
    };
    if (!arguments_read(argc, argv, "bench [OPTIONS]", arguments,
                        sizeof arguments / sizeof *arguments, notes, exit_code))
        return false;
    *exit_code = TOOL_USAGE;
    return check_names(options);
}

bool options_want(const bench_options *options, const char *group, const char *stage) {
    if (!options->only || strcmp(options->only, group) == 0)
        return true;
    if (stage)
        return strcmp(options->only, stage) == 0;
    const char *prefix = strcmp(group, "visibility") == 0 ? "hard" : group;
    const size_t length = strlen(prefix);
    return strncmp(options->only, prefix, length) == 0 && options->only[length] == ':';
}

size_t options_sizes(const bench_options *options, const uint32_t **sizes) {
    static const uint32_t all[] = {512, 1024, 2048, 4096, 8192}, few[] = {1024, 2048};
    if (options->size) {
        *sizes = &options->size;
        return 1;
    }
    *sizes = options->quick ? few : all;
    return options->quick ? sizeof few / sizeof *few : sizeof all / sizeof *all;
}
