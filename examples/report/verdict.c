#include "verdict.h"

#include "page_table.h"
#include "summary.h"

/* "exact-triangles, map of 512: 27.7 ms a picture" */
static void write_choice(FILE *stream, const report_row *row) {
    char ms[32], map[32];
    report_format_number(ms, sizeof ms, report_row_ms(row));
    report_format_number(map, sizeof map, row->map_ms);
    fprintf(stream, "%s%s%s</strong>, map of %u: %s ms a picture, %s of them for the map",
            row->method, report_is_hard(row) ? "" : " with ",
            report_is_hard(row) ? "" : row->filter, (unsigned)row->map_size, ms, map);
}

static void write_ppm(FILE *stream, const report_row *row) {
    char away[32], all[32];
    report_format_number(away, sizeof away, report_wrong_away(row));
    report_format_number(all, sizeof all, row->wrong_ppm);
    fprintf(stream, ", %s wrong fragments per million away from boundaries, %s in all", away, all);
}

static void write_rms(FILE *stream, const report_row *row) {
    fprintf(stream, ", RMS %.3f, structural similarity %.3f", row->rms, row->ssim);
}

/* The rule comes behind the choice that it made. */
static void write_card(FILE *stream, const report_row *row, const char *intent, const char *rule) {
    if (!row)
        return;
    fprintf(stream, "<p class=\"verdict\">%s <strong>", intent);
    write_choice(stream, row);
    if (report_is_hard(row))
        write_ppm(stream, row);
    else
        write_rms(stream, row);
    fprintf(stream, ".<small>%s</small></p>\n", rule);
}

static void write_hard(FILE *stream, const report_rows *rows) {
    char rule[256];
    snprintf(rule, sizeof rule,
             "The fastest that leaves at most %d wrong fragments per million away from shadow "
             "boundaries, on the mean over %zu pairs of scene and light.",
             REPORT_CLEAN_PPM, report_count_pairs(rows));
    write_card(stream, report_fastest(rows, true, report_wrong_away, REPORT_CLEAN_PPM),
               "For hard shadows that are right:", rule);
    snprintf(rule, sizeof rule,
             "The same rule with a limit of %d, every method with its default "
             "parameters.",
             REPORT_ROUGH_PPM);
    write_card(stream, report_fastest(rows, true, report_wrong_away, REPORT_ROUGH_PPM),
               "For hard shadows in the least time:", rule);
}

static void write_soft(FILE *stream, const report_rows *rows) {
    char rule[256];
    snprintf(rule, sizeof rule,
             "The fastest whose visibility differs from the true soft shadow by at most %g (root "
             "mean square), on the mean over the same scenes.",
             REPORT_SOFT_RMS);
    const report_row *row = report_fastest(rows, false, report_rms, REPORT_SOFT_RMS);
    if (row)
        write_card(stream, row, "For soft shadows:", rule);
    else
        write_card(stream, report_most_exact(rows, false, report_rms), "For soft shadows:",
                   "None comes as near to the true soft shadow as wanted; this one comes nearest.");
}

void report_write_verdict(FILE *stream, const report_rows *rows, bool hard) {
    if (hard)
        write_hard(stream, rows);
    else
        write_soft(stream, rows);
}
