#include "verdict.h"

#include "page_table.h"
#include "summary.h"

static void write_hard_errors(FILE *stream, const report_row *row) {
    char away[32], all[32];
    report_format_number(away, sizeof away, report_wrong_away(row));
    report_format_number(all, sizeof all, row->wrong_ppm);
    fprintf(stream, "%s wrong fragments per million away from shadow boundaries, %s in all", away,
            all);
}

/* "For hard shadows: exact-lists, map of 512. 7.6 ms a picture, 4.0 of them for the map; ..." */
static void write_choice(FILE *stream, const char *intent, const report_row *row) {
    char ms[32], map[32];
    const bool hard = report_is_hard(row);
    report_format_number(ms, sizeof ms, report_row_ms(row));
    report_format_number(map, sizeof map, row->map_ms);
    fprintf(stream,
            "%s <strong>%s%s%s</strong>, map of %u: %s ms a picture, %s of them for the map; ",
            intent, hard ? "" : row->filter, hard ? "" : " with ", row->method,
            (unsigned)row->map_size, ms, map);
    if (hard)
        write_hard_errors(stream, row);
    else
        fprintf(stream, "RMS error of visibility %.3f, structural similarity %.3f", row->rms,
                row->ssim);
    fprintf(stream, ".\n");
}

static void write_card(FILE *stream, const char *intent, const report_row *choice,
                       const char *other_intent, const report_row *other, const char *rule) {
    if (!choice)
        return;
    fprintf(stream, "<div class=\"verdict\">\n<p>");
    write_choice(stream, intent, choice);
    fprintf(stream, "</p>\n");
    if (other && other != choice) {
        fprintf(stream, "<p class=\"other\">");
        write_choice(stream, other_intent, other);
        fprintf(stream, "</p>\n");
    }
    fprintf(stream, "<small>%s</small>\n</div>\n", rule);
}

static void write_hard(FILE *stream, const report_rows *rows) {
    char rule[320];
    const report_row *clean = report_fastest(rows, true, report_wrong_away, REPORT_CLEAN_PPM);
    const report_row *rough = report_fastest(rows, true, report_wrong_away, REPORT_ROUGH_PPM);
    const report_row *nearest = report_most_exact(rows, true, report_wrong_away);
    snprintf(
        rule, sizeof rule,
        "The fastest with at most %d, or %d, wrong fragments per million away from boundaries, "
        "on the mean over %zu pairs of scene and light; every method with its default "
        "parameters.",
        REPORT_CLEAN_PPM, REPORT_ROUGH_PPM, report_count_pairs(rows, true));
    write_card(stream, "For hard shadows:", clean ? clean : nearest, "In the least time:", rough,
               rule);
}

static void write_soft(FILE *stream, const report_rows *rows) {
    char rule[320];
    const report_row *nearest = report_most_exact(rows, false, report_rms);
    const report_row *fast =
        nearest ? report_fastest(rows, false, report_rms, REPORT_SOFT_TIMES * nearest->rms) : NULL;
    snprintf(rule, sizeof rule,
             "The fastest whose visibility is at most %g times as far from the true soft shadow as "
             "the nearest of all, on the mean over %zu pairs of scene and light.",
             REPORT_SOFT_TIMES, report_count_pairs(rows, false));
    write_card(stream, "For soft shadows:", fast, "Nearest to the truth:", nearest, rule);
}

void report_write_verdict(FILE *stream, const report_rows *rows, bool hard) {
    if (hard)
        write_hard(stream, rows);
    else
        write_soft(stream, rows);
}
