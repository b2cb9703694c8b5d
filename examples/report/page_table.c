#include "page_table.h"

#include "summary.h"

#include <math.h>
#include <string.h>

typedef struct table_column {
    const char *title;
    double (*value_of)(const report_row *row); /* NaN: none */
    bool soft;                                 /* for soft shadows alone */
} table_column;

static double map_size(const report_row *row) {
    return row->map_size;
}
static double map_ms(const report_row *row) {
    return row->map_ms;
}
static double shading_ms(const report_row *row) {
    return row->shading_ms;
}
static double nanoseconds(const report_row *row) {
    return row->ns_per_fragment;
}
static double megabytes(const report_row *row) {
    return (double)row->memory_bytes / 1e6;
}
static double false_shadow(const report_row *row) {
    return row->false_shadow_ppm;
}
static double false_light(const report_row *row) {
    return row->false_light_ppm;
}
static double boundary(const report_row *row) {
    return row->boundary_ppm;
}
static double similarity(const report_row *row) {
    return row->ssim;
}
static double detachment(const report_row *row) {
    return row->detachment_texels;
}

static const table_column columns[] = {
    {"map\ntexels", map_size, false},
    {"map\nms", map_ms, false},
    {"shading\nms", shading_ms, false},
    {"ns a\nfragment", nanoseconds, false},
    {"memory\nMB", megabytes, false},
    {"false\nshadow", false_shadow, false},
    {"false\nlight", false_light, false},
    {"at\nboundaries", boundary, false},
    {"wrong\nin all", report_wrong, false},
    {"RMS", report_rms, true},
    {"SSIM", similarity, true},
    {"detached\ntexels", detachment, false},
};
enum { COLUMNS = sizeof columns / sizeof *columns };

void report_format_number(char *text, size_t size, double value) {
    if (isnan(value) || isinf(value))
        snprintf(text, size, "-");
    else if (fabs(value) < 1e-9)
        snprintf(text, size, "0");
    else if (fabs(value) < 0.1)
        snprintf(text, size, "%.2g", value);
    else if (fabs(value) < 10)
        snprintf(text, size, "%.2f", value);
    else if (fabs(value) < 100)
        snprintf(text, size, "%.1f", value);
    else if (fabs(value) < 999.5)
        snprintf(text, size, "%.0f", value);
    else if (fabs(value) < 999999.5)
        snprintf(text, size, "%lld,%03lld", llround(value) / 1000, llround(value) % 1000);
    else
        snprintf(text, size, "%lld,%03lld,%03lld", llround(value) / 1000000,
                 llround(value) / 1000 % 1000, llround(value) % 1000);
}

/* A column that no row has a value for is left out. */
static bool is_used(const report_rows *rows, const table_column *column) {
    for (size_t i = 0; i < rows->count; i++)
        if (!isnan(column->value_of(&rows->rows[i])))
            return true;
    return false;
}

static void write_head(FILE *stream, const report_rows *rows) {
    fprintf(stream,
            "<table>\n<caption>Every method, filter and map size of the chosen "
            "scene and light</caption>\n<thead><tr><th class=\"text\" scope=\"col\"><button "
            "type=\"button\">method</button></th>");
    for (size_t k = 0; k < COLUMNS; k++)
        if (is_used(rows, &columns[k]))
            fprintf(stream, "<th scope=\"col\"%s><button type=\"button\">%s</button></th>",
                    columns[k].soft ? " data-kind=\"soft\" hidden" : "", columns[k].title);
    fprintf(stream, "</tr></thead>\n");
}

/* What stands below a method's picture: briefly, and in a sentence. */
static void write_summary(FILE *stream, const report_row *row) {
    char away[32], all[32], ms[32], shadow[32], light[32], boundaries[32];
    report_format_number(away, sizeof away, report_wrong_away(row));
    report_format_number(all, sizeof all, row->wrong_ppm);
    report_format_number(ms, sizeof ms, report_row_ms(row));
    report_format_number(shadow, sizeof shadow, row->false_shadow_ppm);
    report_format_number(light, sizeof light, row->false_light_ppm);
    report_format_number(boundaries, sizeof boundaries, row->boundary_ppm);
    if (report_is_hard(row))
        fprintf(stream,
                " data-brief=\"%s ppm, %s ms\" data-summary=\"%s ms; false shadow %s, false light "
                "%s away from boundaries, %s at them, %s wrong in all (parts per million)\"",
                away, ms, ms, shadow, light, boundaries, all);
    else
        fprintf(
            stream,
            " data-brief=\"RMS %.3f, %s ms\" data-summary=\"%s ms; RMS %.3f, structural "
            "similarity %.3f; light that is missing where all should be %s, that is there where "
            "none should be %s, wrong in penumbras %s (parts per million)\"",
            row->rms, ms, ms, row->rms, row->ssim, shadow, light, boundaries);
}

static void write_data(FILE *stream, const report_row *row) {
    fprintf(stream,
            "<tr data-scene=\"%s\" data-light=\"%s\" data-kind=\"%s\" data-filter=\"%s\" "
            "data-method=\"%s\" data-size=\"%u\"",
            row->scene, row->light, report_is_hard(row) ? "hard" : "soft", row->filter, row->method,
            (unsigned)row->map_size);
    write_summary(stream, row);
    fprintf(stream, "%s>",
            strcmp(row->scene, REPORT_ALL) == 0 && report_is_hard(row) ? "" : " hidden");
}

static void write_row(FILE *stream, const report_rows *rows, const report_row *row) {
    char text[48];
    const bool hard = report_is_hard(row);
    write_data(stream, row);
    fprintf(stream, "<th scope=\"row\" data-value=\"%s%s\">%s%s%s</th>", row->filter, row->method,
            hard ? "" : row->filter, hard ? "" : " with ", row->method);
    for (size_t k = 0; k < COLUMNS; k++) {
        if (!is_used(rows, &columns[k]))
            continue;
        const double value = columns[k].value_of(row);
        if (columns[k].value_of == map_size)
            snprintf(text, sizeof text, "%u", (unsigned)row->map_size);
        else if (columns[k].soft)
            snprintf(text, sizeof text, "%.3f", value);
        else
            report_format_number(text, sizeof text, value);
        if (columns[k].soft && hard)
            fprintf(stream, "<td data-kind=\"soft\" hidden data-value=\"\"></td>");
        else if (isnan(value))
            fprintf(stream, "<td data-value=\"\">-</td>");
        else
            fprintf(stream, "<td data-value=\"%.6g\">%s</td>", value, text);
    }
    fprintf(stream, "</tr>\n");
}

void report_page_table(FILE *stream, const report_rows *rows) {
    write_head(stream, rows);
    fprintf(stream, "<tbody>\n");
    for (size_t i = 0; i < rows->count; i++)
        write_row(stream, rows, &rows->rows[i]);
    fprintf(stream, "</tbody>\n</table>\n");
}
