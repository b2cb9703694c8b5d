/* stability: every bias method in many cases, with the papers' parameters and with parameters
 * tuned to the case, against the truth. */
#include "arguments.h"
#include "filters.h"
#include "heat_map.h"
#include "report.h"
#include "suite.h"
#include "tool.h"

#include <stdio.h>
#include <sys/stat.h>

static bool find_method(const char *name) {
    listed_method method;
    if (method_list_named(name, &method))
        return true;
    fprintf(stderr, "stability: --method: there is no \"%s\"\n", name);
    return false;
}

static bool find_case(const char *name) {
    const stability_case *c = stability_case_named(name);
    if (c && stability_case_exists(c))
        return true;
    fprintf(stderr,
            c ? "stability: --case: the file of \"%s\" is missing\n"
              : "stability: --case: there is no \"%s\"\n",
            name);
    return false;
}

static bool write_table(const char *directory, const char *name, const stability_rows *rows,
                        void (*print)(FILE *stream, const stability_rows *rows)) {
    char path[1024];
    if (snprintf(path, sizeof path, "%s/%s", directory, name) >= (int)sizeof path) {
        fprintf(stderr, "stability: --out: the path is too long\n");
        return false;
    }
    FILE *file = fopen(path, "w");
    if (!file)
        return tool_succeeds("stability", path, SHB_ERROR_FILE);
    print(file, rows);
    return tool_close_text("stability", file, path);
}

static bool write_files(const char *directory, const stability_rows *rows) {
    mkdir(directory, 0777);
    if (!write_table(directory, "stability.tsv", rows, stability_print_tsv) ||
        !write_table(directory, "certain.tsv", rows, stability_print_certain))
        return false;
    return tool_succeeds("stability", directory, heat_map_write(rows, directory));
}

static bool run_single_taps(shb_context *context, const stability_options *options) {
    stability_rows rows = {0};
    bool done = stability_run(context, options, &rows);
    if (done && options->tsv)
        stability_print_tsv(stdout, &rows);
    else if (done)
        stability_print_means(stdout, &rows);
    if (done && options->directory)
        done = write_files(options->directory, &rows);
    stability_rows_free(&rows);
    return done;
}

static int run(const stability_options *options) {
    shb_context *context = tool_create_context("stability", 0, SHB_ISA_BEST);
    const bool filters = options->box || options->pcss;
    const bool done = context && (filters ? stability_run_filter(context, options, stdout)
                                          : run_single_taps(context, options));
    shb_context_destroy(context);
    return done && fflush(stdout) == 0 ? TOOL_OK : TOOL_FAILED;
}

static const char notes[] =
    "Means are over ALL cases, and over those that floats have RESOLVED: without the groups gap,\n"
    "moved and near-far, whose gaps, positions or depths are finer than floats can tell.\n";

static bool read_options(int argc, char **argv, stability_options *options, int *exit_code) {
    bool help = false;
    const argument_spec arguments[] = {
        {"--quick", NULL, "few cases, small frames", ARGUMENT_FLAG, &options->quick, 0, 0},
        {"--method", "NAME", "only this bias method", ARGUMENT_TEXT, &options->method, 0, 0},
        {"--case", "NAME", "only this case", ARGUMENT_TEXT, &options->subject, 0, 0},
        {"--box", "N", "judge pcf over N x N texels, away from silhouettes in all of them",
         ARGUMENT_COUNT, &options->box, 1, 63},
        {"--pcss", "N", "judge pcss likewise, of a light whose widest kernel has N texels across",
         ARGUMENT_COUNT, &options->pcss, 1, 63},
        {"--size", "N", "texels on a side of maps where the case is not about it (1024)",
         ARGUMENT_COUNT, &options->map_size, 8, SHB_SIZE_MAX},
        {"--named", NULL, "name fragments by triangle and weights, not by rounded positions",
         ARGUMENT_FLAG, &options->named, 0, 0},
        {"--tsv", NULL, "print every row, tab-separated", ARGUMENT_FLAG, &options->tsv, 0, 0},
        {"--out", "DIR", "write stability.tsv, certain.tsv, heat.ppm and heat.svg", ARGUMENT_TEXT,
         &options->directory, 0, 0},
        {"--help", NULL, "print this", ARGUMENT_FLAG, &help, 0, 0},
    };
    if (!arguments_read(argc, argv, "stability [OPTIONS]", arguments,
                        sizeof arguments / sizeof *arguments, notes, exit_code))
        return false;
    *exit_code = TOOL_USAGE;
    return (!options->method || find_method(options->method)) &&
           (!options->subject || find_case(options->subject));
}

int main(int argc, char **argv) {
    stability_options options = {0};
    int exit_code;
    return read_options(argc, argv, &options, &exit_code) ? run(&options) : exit_code;
}
