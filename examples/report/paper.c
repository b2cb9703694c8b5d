#include "paper.h"

#include "page_table.h"
#include "tool.h"

#include <math.h>

static double overall_ms(const paper_row *row) {
    return row->map_ms + row->camera_ms + row->shade_ms;
}

/* ---- measuring ---- */

static bench_plan plan_of(const paper_output *output) {
    return output->quick ? (bench_plan){2, 0} : (bench_plan){5, 0.05};
}

shb_result paper_compare(const paper_output *output, soft_work *work, soft_work *beside,
                         paper_row *row) {
    soft_work_times times[2];
    bench_times camera;
    shb_result result = soft_work_compare(work, beside, plan_of(output), times);
    if (!result)
        result =
            bench_measure(soft_work_camera(beside), BENCH_CLOCK_THREAD, plan_of(output), &camera);
    if (result)
        return result;
    row->map_ms = 1e3 * times[0].map;
    row->shade_ms = 1e3 * times[0].shade;
    row->camera_ms = 1e3 * camera.median;
    row->ratio = overall_ms(row) / (1e3 * (times[1].map + times[1].shade) + row->camera_ms);
    return SHB_OK;
}

static shb_result measure_case(const paper_output *output, const measure_frame *frame,
                               soft_work_desc desc, const paper_case *c, soft_work *beside,
                               paper_row *row) {
    soft_work work;
    desc.bias = c->bias;
    desc.filter = c->filter ? c->filter : "hard";
    shb_result result = soft_work_create(output->single, frame, &desc, &work);
    if (result)
        return result;
    if (!c->filter)
        work.filter = measure_even_filter(1);
    result = paper_compare(output, &work, beside, row);
    soft_work_destroy(&work);
    if (!c->filter && !result) {
        row->ratio *= 1 - row->map_ms / overall_ms(row);
        row->map_ms = 0;
    }
    return result;
}

shb_result paper_measure(const paper_output *output, const measure_frame *frame,
                         scene_light_kind light, uint32_t map_size, const char *group,
                         const paper_case *cases, size_t count, paper_row *rows) {
    soft_work beside;
    const soft_work_desc desc = {light, map_size, cases[0].bias, cases[0].filter, false};
    shb_result result = soft_work_create(output->single, frame, &desc, &beside);
    if (result)
        return result;
    for (size_t i = 0; i < count && !result; i++) {
        rows[i] = (paper_row){.group = group,
                              .method = cases[i].method,
                              .map_size = map_size,
                              .paper = cases[i].paper,
                              .rms = (double)NAN,
                              .ssim = (double)NAN};
        result = measure_case(output, frame, desc, &cases[i], &beside, &rows[i]);
    }
    soft_work_destroy(&beside);
    return result;
}

bool paper_open(const paper_output *output, const char *name, const uint32_t size[2],
                example_scene **scene, measure_frame *frame) {
    *frame = (measure_frame){0};
    *scene = tool_open_scene("report", name);
    return *scene &&
           tool_succeeds("report", name,
                         measure_frame_create(output->single, *scene, size[0], size[1], frame));
}

/* ---- writing ---- */

void paper_write_head(FILE *table) {
    fprintf(table, "table\tgroup\tmap_size\tmethod\tmap_ms\tcamera_ms\tshading_ms\toverall_ms\t"
                   "ratio\tpaper_ratio\trms\tssim\n");
}

static void write_number(FILE *table, double value, bool is_there) {
    if (is_there)
        fprintf(table, "\t%.5g", value);
    else
        fprintf(table, "\t-");
}

static void write_file_row(FILE *table, const char *what, const paper_row *row) {
    fprintf(table, "%s\t%s\t%u\t%s\t%.5g\t%.5g\t%.5g\t%.5g\t%.4g", what, row->group,
            (unsigned)row->map_size, row->method, row->map_ms, row->camera_ms, row->shade_ms,
            overall_ms(row), row->ratio);
    write_number(table, row->paper, row->paper > 0);
    write_number(table, row->rms, !isnan(row->rms));
    write_number(table, row->ssim, !isnan(row->ssim));
    fprintf(table, "\n");
}

static void write_cell(FILE *section, double value, bool is_there) {
    char text[48];
    report_format_number(text, sizeof text, value);
    fprintf(section, "<td>%s</td>", is_there ? text : "-");
}

static void write_page_row(FILE *section, const paper_row *row, bool judged) {
    fprintf(section, "<tr><th scope=\"row\">%s</th><td class=\"text\">%s</td><td>%u</td>",
            row->method, row->group, (unsigned)row->map_size);
    write_cell(section, row->map_ms, true);
    write_cell(section, row->camera_ms, true);
    write_cell(section, row->shade_ms, true);
    write_cell(section, overall_ms(row), true);
    write_cell(section, row->ratio, true);
    write_cell(section, row->paper, row->paper > 0);
    if (judged) {
        write_cell(section, row->rms, !isnan(row->rms));
        write_cell(section, row->ssim, !isnan(row->ssim));
    }
    fprintf(section, "</tr>\n");
}

void paper_write_rows(const paper_output *output, const char *what, const char *setting,
                      const paper_row *rows, size_t count, const char *why) {
    FILE *section = output->section;
    bool judged = false;
    for (size_t i = 0; i < count; i++) {
        judged |= !isnan(rows[i].rms);
        write_file_row(output->table, what, &rows[i]);
    }
    fprintf(
        section,
        "<h3>%s</h3>\n<p class=\"lead\">%s</p>\n<div class=\"scroll\" tabindex=\"0\" "
        "role=\"region\" aria-label=\"%s\">\n<table class=\"plain\">\n<caption>%s, measured "
        "here</caption>\n"
        "<thead><tr>"
        "<th class=\"text\" scope=\"col\">method</th><th class=\"text\" scope=\"col\">group</th>"
        "<th scope=\"col\">map</th><th scope=\"col\">map ms</th><th scope=\"col\">camera ms</th>"
        "<th scope=\"col\">shading ms</th><th scope=\"col\">overall ms</th>"
        "<th scope=\"col\">ratio here</th><th scope=\"col\">in the paper</th>%s"
        "</tr></thead>\n<tbody>\n",
        what, setting, what, what,
        judged ? "<th scope=\"col\">RMS</th><th scope=\"col\">SSIM</th>" : "");
    for (size_t i = 0; i < count; i++)
        write_page_row(section, &rows[i], judged);
    fprintf(section, "</tbody>\n</table>\n</div>\n<p>%s</p>\n", why);
}

void paper_write_chart(const paper_output *output, const char *title, const char *step_axis,
                       const char *const *steps, size_t step_count, const paper_row *rows,
                       size_t line_count) {
    enum { STEPS_MAX = 32 };
    double values[LINE_CHART_LINES_MAX][STEPS_MAX];
    chart_line lines[LINE_CHART_LINES_MAX];
    if (step_count > STEPS_MAX || line_count > LINE_CHART_LINES_MAX)
        return;
    for (size_t i = 0; i < line_count; i++) {
        for (size_t k = 0; k < step_count; k++)
            values[i][k] = overall_ms(&rows[k * line_count + i]);
        lines[i] = (chart_line){rows[i].method, values[i]};
    }
    const line_chart chart = {title, step_axis, "overall ms", steps, step_count, lines, line_count};
    line_chart_write(output->section, &chart);
}
