#include "study.h"

#include "study_causes.h"
#include "study_papers.h"
#include "study_tuner.h"
#include "text_file.h"
#include "tool.h"

#include <stdlib.h>
#include <string.h>

enum { PATH_LENGTH = 512 };

static const report_study *const studies[] = {&report_study_causes, &report_study_tuner,
                                              &report_study_papers};
enum { STUDIES = sizeof studies / sizeof *studies };

static bool name_file(char path[PATH_LENGTH], const char *directory, const report_study *study,
                      const char *ending) {
    return snprintf(path, PATH_LENGTH, "%s/%s.%s", directory, study->name, ending) < PATH_LENGTH;
}

/* A section begins with the settings that it was measured with, and is complete where it ends. */
static void begin_section(FILE *section, const report_study *study, const char *settings) {
    fprintf(section,
            "<!-- %s -->\n<section aria-labelledby=\"%s-title\" id=\"%s\">\n"
            "<h2 id=\"%s-title\">%s</h2>\n",
            settings, study->name, study->name, study->name, study->title);
}

static void end_section(FILE *section) {
    fprintf(section, "</section>\n");
}

static bool is_kept(const char *path, const char *settings) {
    char head[256], error[256];
    size_t size;
    const int length = snprintf(head, sizeof head, "<!-- %s -->\n", settings);
    char *text = text_file_read(path, &size, error, sizeof error);
    const bool kept =
        text && strncmp(text, head, (size_t)length) == 0 && strstr(text, "</section>\n") != NULL;
    free(text);
    return kept;
}

static bool run_study(shb_context *context, const report_options *options, const char *settings,
                      const report_study *study) {
    char table_path[PATH_LENGTH], section_path[PATH_LENGTH];
    if (!name_file(table_path, options->directory, study, "tsv") ||
        !name_file(section_path, options->directory, study, "html"))
        return tool_succeeds("report", study->name, SHB_ERROR_FILE);
    if (!options->fresh && is_kept(section_path, settings))
        return true;
    remove(section_path);
    if (options->operands[0] && study->own_scenes)
        return true;
    FILE *table = fopen(table_path, "w"), *section = fopen(section_path, "w");
    bool done = tool_succeeds("report", table ? section_path : table_path,
                              table && section ? SHB_OK : SHB_ERROR_FILE);
    if (done) {
        begin_section(section, study, settings);
        done = study->run(context, options, table, section);
    }
    if (done)
        end_section(section);
    done = (!table || tool_close_text("report", table, table_path)) && done;
    return (!section || tool_close_text("report", section, section_path)) && done;
}

bool report_studies_run(shb_context *context, const report_options *options, const char *settings) {
    bool done = true;
    for (size_t i = 0; i < STUDIES && done; i++)
        done = run_study(context, options, settings, studies[i]);
    return done;
}

void report_studies_write(FILE *stream, const char *directory) {
    char path[PATH_LENGTH], error[256];
    size_t size;
    for (size_t i = 0; i < STUDIES; i++) {
        char *text = name_file(path, directory, studies[i], "html")
                         ? text_file_read(path, &size, error, sizeof error)
                         : NULL;
        if (text)
            fwrite(text, 1, size, stream);
        free(text);
    }
}
