#include "verdict.h"

#include "page_table.h"
#include "summary.h"

static verdict find_hard(const report_rows *rows) {
    const report_row *clean = report_fastest(rows, true, report_wrong_away, REPORT_CLEAN_PPM);
    const report_row *nearest = report_most_exact(rows, true, report_wrong_away);
    verdict v = {.intent = "For hard shadows:",
                 .other_intent = "In the least time:",
                 .choice = clean ? clean : nearest,
                 .other = report_fastest(rows, true, report_wrong_away, REPORT_ROUGH_PPM)};
    snprintf(
        v.rule, sizeof v.rule,
        "The fastest with at most %d, or %d, wrong fragments per million away from boundaries, "
        "or the most right within a tenth of its time, on the mean over %zu pairs of scene and "
        "light; every method with its default parameters.",
        REPORT_CLEAN_PPM, REPORT_ROUGH_PPM, report_count_pairs(rows, true));
    return v;
}

static verdict find_soft(const report_rows *rows) {
    const report_row *nearest = report_most_exact(rows, false, report_rms);
    verdict v = {
        .intent = "For soft shadows:", .other_intent = "Nearest to the truth:", .other = nearest};
    if (nearest)
        v.choice = report_fastest(rows, false, report_rms, REPORT_SOFT_TIMES * nearest->rms);
    snprintf(v.rule, sizeof v.rule,
             "The fastest whose visibility is at most %g times as far from the true soft shadow as "
             "the nearest of all, or the nearest within a tenth of its time, on the mean over %zu "
             "pairs of scene and light.",
             REPORT_SOFT_TIMES, report_count_pairs(rows, false));
    return v;
}

verdict report_find_verdict(const report_rows *rows, bool hard) {
    verdict v = hard ? find_hard(rows) : find_soft(rows);
    if (v.other == v.choice)
        v.other = NULL;
    return v;
}

static void write_hard_errors(FILE *stream, const report_row *row) {
    char away[32], all[32];
    report_format_number(away, sizeof away, report_wrong_away(row));
    report_format_number(all, sizeof all, row->wrong_ppm);
    fprintf(stream, "%s wrong fragments per million away from shadow boundaries, %s in all", away,
            all);
}

void report_write_choice(FILE *stream, const char *intent, const report_row *choice,
                         verdict_marks marks) {
    char ms[32], map[32];
    const bool hard = report_is_hard(choice);
    report_format_number(ms, sizeof ms, report_row_ms(choice));
    report_format_number(map, sizeof map, choice->map_ms);
    fprintf(stream, "%s %s%s%s%s%s, map of %u: %s ms a picture, %s of them for the map; ", intent,
            marks.begin, hard ? "" : choice->filter, hard ? "" : " with ", choice->method,
            marks.end, (unsigned)choice->map_size, ms, map);
    if (hard)
        write_hard_errors(stream, choice);
    else
        fprintf(stream, "RMS error of visibility %.3f, structural similarity %.3f", choice->rms,
                choice->ssim);
    fprintf(stream, ".\n");
}

void report_write_verdict(FILE *stream, const report_rows *rows, bool hard) {
    const verdict_marks strong = {"<strong>", "</strong>"};
    const verdict v = report_find_verdict(rows, hard);
    if (!v.choice)
        return;
    fprintf(stream, "<div class=\"verdict\" id=\"%s-verdict\">\n<p>", hard ? "hard" : "soft");
    report_write_choice(stream, v.intent, v.choice, strong);
    if (v.other) {
        fprintf(stream, "</p>\n<p class=\"other\">");
        report_write_choice(stream, v.other_intent, v.other, strong);
    }
    fprintf(stream, "</p>\n<small>%s</small>\n</div>\n", v.rule);
}
