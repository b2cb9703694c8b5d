#include "readme.h"

#include "page_table.h"
#include "scatter.h"
#include "summary.h"
#include "text_file.h"
#include "tool.h"
#include "verdict.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_LENGTH = 512 };

/* The first row of means of a kind; NULL: there is none. */
static const report_row *find_means(const report_rows *rows, bool hard) {
    for (size_t i = 0; i < rows->count; i++)
        if (report_is_mean(&rows->rows[i]) && report_is_hard(&rows->rows[i]) == hard)
            return &rows->rows[i];
    return NULL;
}

static report_scatter scatter_of(const report_row *means) {
    if (report_is_hard(means))
        return (report_scatter){"Hard shadows: time against error",
                                "wrong fragments per million away from boundaries",
                                report_wrong_away, means, true};
    return (report_scatter){"Soft shadows: time against error", "RMS error of visibility",
                            report_rms, means, true};
}

static bool write_figure(const report_readme *readme, bool hard) {
    const report_row *means = find_means(readme->rows, hard);
    char path[PATH_LENGTH];
    if (!means)
        return true;
    snprintf(path, sizeof path, "%s/%s.svg", readme->figures, hard ? "hard" : "soft");
    FILE *stream = fopen(path, "w");
    if (!stream)
        return tool_succeeds("report", path, SHB_ERROR_FILE);
    const report_scatter scatter = scatter_of(means);
    report_scatter_write(stream, readme->rows, &scatter);
    return tool_close_text("report", stream, path);
}

static void write_cell(FILE *stream, double value) {
    char text[32];
    report_format_number(text, sizeof text, value);
    fprintf(stream, " %s |", text);
}

static void write_row(FILE *stream, const report_row *row) {
    const bool hard = report_is_hard(row);
    fprintf(stream, "| `%s`%s%s%s | %u |", hard ? row->method : row->filter, hard ? "" : " with `",
            hard ? "" : row->method, hard ? "" : "`", (unsigned)row->map_size);
    write_cell(stream, report_row_ms(row));
    if (hard) {
        write_cell(stream, row->false_shadow_ppm);
        write_cell(stream, row->false_light_ppm);
        write_cell(stream, row->boundary_ppm);
    } else
        fprintf(stream, " %.3f | %.3f |", row->rms, row->ssim);
    write_cell(stream, (double)row->memory_bytes / 1e6);
    fprintf(stream, "\n");
}

static int by_time(const void *a, const void *b) {
    const double first = report_row_ms(*(const report_row *const *)a);
    const double second = report_row_ms(*(const report_row *const *)b);
    return (first > second) - (first < second);
}

/* The methods of the Pareto front, the fastest first. */
static bool write_table(FILE *stream, const report_rows *rows, const report_row *means) {
    const report_scatter scatter = scatter_of(means);
    const report_row **front = malloc(rows->count * sizeof *front);
    size_t count = 0;
    if (!front)
        return tool_succeeds("report", "table", SHB_ERROR_MEMORY);
    for (size_t i = 0; i < rows->count; i++)
        if (report_share_pair(&rows->rows[i], means) &&
            report_is_on_front(rows, &rows->rows[i], scatter.error_of))
            front[count++] = &rows->rows[i];
    qsort(front, count, sizeof *front, by_time);
    fputs(report_is_hard(means)
              ? "| method | map | ms | false shadow | false light | at boundaries | MB |\n"
                "|---|---:|---:|---:|---:|---:|---:|\n"
              : "| filter and method | map | ms | RMS | similarity | MB |\n"
                "|---|---:|---:|---:|---:|---:|\n",
          stream);
    for (size_t i = 0; i < count; i++)
        write_row(stream, front[i]);
    free(front);
    return true;
}

static bool write_kind(FILE *stream, const report_readme *readme, bool hard) {
    const verdict_marks code = {"`", "`"};
    const report_row *means = find_means(readme->rows, hard);
    if (!means)
        return true;
    const verdict v = report_find_verdict(readme->rows, hard);
    fprintf(stream, "\n![%s](%s/%s.svg)\n\n", scatter_of(means).title, readme->figures,
            hard ? "hard" : "soft");
    if (v.choice)
        report_write_choice(stream, v.intent, v.choice, code);
    if (v.other)
        report_write_choice(stream, v.other_intent, v.other, code);
    fprintf(stream, "%s\n\n", v.rule);
    return write_table(stream, readme->rows, means);
}

static bool write_part(FILE *stream, const report_readme *readme) {
    fprintf(stream, "%s; times are those of the map and a shaded picture together.\n",
            readme->settings);
    return write_kind(stream, readme, true) && write_kind(stream, readme, false);
}

/* The file anew with another part between begin and end. */
static bool write_file(const report_readme *readme, const char *text, const char *begin,
                       const char *end) {
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "%s.new", readme->path);
    FILE *stream = fopen(path, "w");
    if (!stream)
        return tool_succeeds("report", path, SHB_ERROR_FILE);
    fwrite(text, 1, (size_t)(begin - text), stream);
    fputs("\n", stream);
    const bool done = write_part(stream, readme);
    fprintf(stream, "\n%s", end);
    return tool_close_text("report", stream, path) && done &&
           tool_succeeds("report", readme->path,
                         rename(path, readme->path) == 0 ? SHB_OK : SHB_ERROR_FILE);
}

bool report_readme_write(const report_readme *readme) {
    char error[256];
    size_t size;
    char *text = text_file_read(readme->path, &size, error, sizeof error);
    if (!text) {
        fprintf(stderr, "report: %s\n", error);
        return false;
    }
    char *begin = strstr(text, REPORT_README_BEGIN);
    char *end = begin ? strstr(begin, REPORT_README_END) : NULL;
    if (!end)
        fprintf(stderr, "report: %s lacks one of the lines that enclose the report:\n%s%s",
                readme->path, REPORT_README_BEGIN, REPORT_README_END);
    const bool done = end && write_figure(readme, true) && write_figure(readme, false) &&
                      write_file(readme, text, begin + strlen(REPORT_README_BEGIN), end);
    free(text);
    return done;
}
