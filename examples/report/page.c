#include "page.h"

#include "assets.h"
#include "methods.h"
#include "page_images.h"
#include "page_table.h"
#include "scatter.h"
#include "study.h"
#include "text_file.h"
#include "verdict.h"

#include <stdio.h>
#include <string.h>

static void write_lines(FILE *stream, const char *const *lines) {
    while (*lines)
        fputs(*lines++, stream);
}

static void write_css(FILE *stream, const report_page *page) {
    (void)page;
    write_lines(stream, report_page_css);
}

static void write_js(FILE *stream, const report_page *page) {
    (void)page;
    write_lines(stream, report_page_js);
}

/* True for the first row of its scene. */
static bool is_first_of_scene(const report_rows *rows, size_t number) {
    for (size_t i = 0; i < number; i++)
        if (strcmp(rows->rows[i].scene, rows->rows[number].scene) == 0)
            return false;
    return true;
}

/* True for the first row of its scene, light and kind. */
static bool is_first_of_pair(const report_rows *rows, size_t number) {
    for (size_t i = 0; i < number; i++)
        if (report_share_pair(&rows->rows[i], &rows->rows[number]))
            return false;
    return true;
}

static void write_scenes(FILE *stream, const report_page *page) {
    fprintf(stream, "<option value=\"" REPORT_ALL "\">all, means</option>");
    for (size_t i = 0; i < page->rows->count; i++) {
        const char *scene = page->rows->rows[i].scene;
        if (is_first_of_scene(page->rows, i) && strcmp(scene, REPORT_ALL) != 0)
            fprintf(stream, "<option>%s</option>", scene);
    }
}

static void write_verdict(FILE *stream, const report_page *page) {
    fprintf(stream, "<div class=\"verdicts\">\n");
    report_write_verdict(stream, page->rows, true);
    report_write_verdict(stream, page->rows, false);
    fprintf(stream, "</div>\n");
}

static void write_legend_of(FILE *stream, bool hard) {
    fprintf(stream, "<ul class=\"legend\" data-kind=\"%s\"%s>\n", hard ? "hard" : "soft",
            hard ? "" : " hidden");
    for (int i = 0; i < REPORT_FAMILIES; i++) {
        fprintf(stream,
                "<li><svg class=\"family-%d\" viewBox=\"-8 -8 16 16\" aria-hidden=\"true\">", i);
        report_scatter_shape(stream, (report_family)i, 0, 0, 5.5);
        fprintf(stream, "</svg>%s</li>\n", report_family_name((report_family)i, hard));
    }
    fprintf(stream, "</ul>\n");
}

static void write_legend(FILE *stream, const report_page *page) {
    (void)page;
    write_legend_of(stream, true);
    write_legend_of(stream, false);
}

static void write_chart(FILE *stream, const report_page *page, report_scatter scatter) {
    const report_row *pair = scatter.pair;
    const bool is_all = strcmp(pair->scene, REPORT_ALL) == 0;
    fprintf(stream,
            "<div class=\"chart\" data-scene=\"%s\" data-light=\"%s\" data-kind=\"%s\"%s>\n",
            pair->scene, pair->light, report_is_hard(pair) ? "hard" : "soft",
            is_all && report_is_hard(pair) ? "" : " hidden");
    fprintf(stream, "<h3>%s</h3>\n", scatter.title);
    report_scatter_write(stream, page->rows, &scatter);
    fprintf(stream, "</div>\n");
}

static void write_charts(FILE *stream, const report_page *page) {
    for (size_t i = 0; i < page->rows->count; i++) {
        const report_row *row = &page->rows->rows[i];
        if (!is_first_of_pair(page->rows, i))
            continue;
        if (report_is_hard(row)) {
            write_chart(stream, page,
                        (report_scatter){"The bias alone: away from shadow boundaries",
                                         "wrong fragments per million", report_wrong_away, row,
                                         false});
            write_chart(stream, page,
                        (report_scatter){"Bias and resolution: everywhere",
                                         "wrong fragments per million", report_wrong, row, false});
        } else {
            write_chart(stream, page,
                        (report_scatter){"Distance from the true soft shadow", "RMS of visibility",
                                         report_rms, row, false});
            write_chart(stream, page,
                        (report_scatter){"Difference of structure", "1 - structural similarity",
                                         report_dissimilarity, row, false});
        }
    }
}

static void write_table(FILE *stream, const report_page *page) {
    report_page_table(stream, page->rows);
}

static void write_images(FILE *stream, const report_page *page) {
    report_page_images(stream, page->rows, page->pictures);
}

static void write_more(FILE *stream, const report_page *page) {
    report_peers_write(stream, page->peers);
    report_studies_write(stream, page->directory);
}

static void write_settings(FILE *stream, const report_page *page) {
    fprintf(stream,
            "<p>%zu rows of %zu pairs of scene and light. %s. Times are medians of runs in "
            "which the methods took turns. The truth is ray casting in double precision.</p>\n",
            page->rows->count,
            report_count_pairs(page->rows, true) + report_count_pairs(page->rows, false),
            page->settings);
}

/* What stands in the template where a line has nothing but "<!--name-->", or in the middle of one.
 */
static const struct {
    const char *marker;
    void (*write)(FILE *stream, const report_page *page);
} parts[] = {
    {"<!--css-->", write_css},           {"<!--js-->", write_js},
    {"<!--verdict-->", write_verdict},   {"<!--scenes-->", write_scenes},
    {"<!--legend-->", write_legend},     {"<!--charts-->", write_charts},
    {"<!--table-->", write_table},       {"<!--images-->", write_images},
    {"<!--settings-->", write_settings}, {"<!--more-->", write_more},
};

static void write_line(FILE *stream, const report_page *page, const char *line) {
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const char *marker = strstr(line, parts[i].marker);
        if (!marker)
            continue;
        fwrite(line, 1, (size_t)(marker - line), stream);
        parts[i].write(stream, page);
        line = marker + strlen(parts[i].marker);
    }
    fputs(line, stream);
}

bool report_page_write(const report_page *page, const char *path) {
    FILE *stream = fopen(path, "w");
    if (!stream)
        return false;
    for (const char *const *line = report_page_html; *line; line++)
        write_line(stream, page, *line);
    return text_file_close(stream);
}
