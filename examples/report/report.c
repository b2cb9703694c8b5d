/* Speed against error, every method on every scene: report --help. */
#include "arguments.h"
#include "page.h"
#include "peers.h"
#include "readme.h"
#include "study.h"
#include "study_tuner.h"
#include "summary.h"
#include "survey.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

typedef struct report_command {
    report_options options;
    const char *peers;            /* what make peers printed, or NULL */
    const char *tuned;            /* a scene for the tuner alone, or NULL */
    const char *readme, *figures; /* a Markdown file for the report in brief, or NULL */
    bool help;
} report_command;

static bool read_command(int argc, char **argv, report_command *command, int *exit_code) {
    report_options *options = &command->options;
    const argument_spec arguments[] = {
        {NULL, "SCENE.obj ...", "scenes to measure; none: built-in ones and those of --meshes",
         ARGUMENT_TEXTS, (void *)options->operands, 0, REPORT_OPERANDS_MAX},
        {"--quick", NULL, "few scenes, small pictures, two map sizes", ARGUMENT_FLAG,
         &options->quick, 0, 0},
        {"--fresh", NULL, "measure everything anew", ARGUMENT_FLAG, &options->fresh, 0, 0},
        {"--out", "DIR", "directory of the report (build/out/report)", ARGUMENT_TEXT,
         &options->directory, 0, 0},
        {"--meshes", "DIR", "directory of further OBJ files (../shared/scenes)", ARGUMENT_TEXT,
         &options->meshes, 0, 0},
        {"--tune", "SCENE", "print the smallest constants of every method for one scene",
         ARGUMENT_TEXT, &command->tuned, 0, 0},
        {"--limit", "PPM", "of false shadow, for them (100)", ARGUMENT_COUNT, &options->limit_ppm,
         0, 1000000},
        {"--tune-map", "N", "size of the map that they are for (1024)", ARGUMENT_COUNT,
         &options->tuned_size, 8, 16384},
        {"--peers", "FILE", "what make peers printed, for report.tsv and the page", ARGUMENT_TEXT,
         &command->peers, 0, 0},
        {"--readme", "FILE", "Markdown file that takes the report in brief between its marks",
         ARGUMENT_TEXT, &command->readme, 0, 0},
        {"--figures", "DIR", "directory of the figures of that (examples/report)", ARGUMENT_TEXT,
         &command->figures, 0, 0},
        {"--threads", "N", "threads (all)", ARGUMENT_COUNT, &options->threads, 1, 256},
        {"--help", NULL, "print this", ARGUMENT_FLAG, &command->help, 0, 0},
    };
    static const char notes[] =
        "A run may be stopped: started again with the same options on the same machine, it\n"
        "keeps the rows of report.tsv and measures those that are missing. Rows older than\n"
        "the program do not count.\n";
    return arguments_read(argc, argv, "report [OPTIONS] [SCENE.obj ...]", arguments,
                          sizeof arguments / sizeof *arguments, notes, exit_code);
}

static bool write_page(const report_options *options, const char *settings, const report_rows *rows,
                       const peer_rows *peers) {
    char path[512], pictures[512];
    snprintf(path, sizeof path, "%s/index.html", options->directory);
    snprintf(pictures, sizeof pictures, "%s/pictures", options->directory);
    const report_page page = {rows, pictures, options->directory, settings, peers};
    if (!tool_succeeds("report", path, report_page_write(&page, path) ? SHB_OK : SHB_ERROR_FILE))
        return false;
    printf("the page: %s\n", path);
    return true;
}

/* Whether a file was written before this program: another program measured what it says. */
static bool is_outdated(const char *path) {
    struct stat file, program;
    return stat(path, &file) == 0 && stat("/proc/self/exe", &program) == 0 &&
           file.st_mtime < program.st_mtime;
}

/* The rows of an earlier run that still count; the file then has no others. */
static bool keep_rows(const report_options *options, const char *settings, const char *path,
                      report_rows *rows) {
    if (!options->fresh && !report_rows_read(rows, settings, path))
        return tool_succeeds("report", path, SHB_ERROR_MEMORY);
    if (rows->count)
        printf("%zu rows of an earlier run are kept; --fresh measures them anew\n", rows->count);
    return tool_succeeds("report", path, report_rows_replace(rows, path) ? SHB_OK : SHB_ERROR_FILE);
}

static bool read_peers(const char *path, peer_rows *peers) {
    if (!path || report_peers_read(peers, path))
        return true;
    fprintf(stderr, "report: %s: it cannot be read\n", path);
    return false;
}

/* The page and what else is made of all rows, which get their means. */
static bool show_rows(const report_command *command, const char *settings, const char *path,
                      report_rows *rows, const peer_rows *peers) {
    const report_readme readme = {rows, settings, command->readme, command->figures};
    return tool_succeeds("report", path,
                         report_peers_append(peers, path) ? SHB_OK : SHB_ERROR_FILE) &&
           tool_succeeds("report", "means", report_add_means(rows) ? SHB_OK : SHB_ERROR_MEMORY) &&
           write_page(&command->options, settings, rows, peers) &&
           (!command->readme || report_readme_write(&readme));
}

static bool write_report(shb_context *context, report_command *command) {
    report_options *options = &command->options;
    char path[512], settings[192];
    report_rows rows = {0};
    peer_rows peers = {0};
    snprintf(path, sizeof path, "%s/report.tsv", options->directory);
    report_settings(options, context, settings, sizeof settings);
    options->fresh |= is_outdated(path);
    bool done = read_peers(command->peers, &peers) && keep_rows(options, settings, path, &rows) &&
                report_survey(context, options, settings, path, &rows);
    if (done)
        printf("%zu rows: %s\n", rows.count, path);
    done = done && report_studies_run(context, options, settings) &&
           show_rows(command, settings, path, &rows, &peers);
    report_rows_free(&rows);
    free(peers.rows);
    return done;
}

/* Makes the directory and those above it. */
static void make_directories(const char *path) {
    char part[512];
    for (size_t i = 1; path[i] && i < sizeof part; i++)
        if (path[i] == '/') {
            snprintf(part, sizeof part, "%.*s", (int)i, path);
            mkdir(part, 0777);
        }
    mkdir(path, 0777);
}

int main(int argc, char **argv) {
    report_command command = {.figures = "examples/report",
                              .options = {.directory = "build/out/report",
                                          .meshes = "../shared/scenes",
                                          .limit_ppm = 100}};
    int exit_code;
    if (!read_command(argc, argv, &command, &exit_code))
        return exit_code;
    make_directories(command.options.directory);
    shb_context *context = tool_create_context("report", command.options.threads, SHB_ISA_BEST);
    const bool done =
        context && (command.tuned ? report_tune(context, &command.options, command.tuned)
                                  : write_report(context, &command));
    shb_context_destroy(context);
    return done ? TOOL_OK : TOOL_FAILED;
}
