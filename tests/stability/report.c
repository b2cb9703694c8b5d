#include "report.h"

#include "method_list.h"

static const char *format_name(shb_format format) {
    return format == SHB_FORMAT_UNORM24   ? "unorm24"
           : format == SHB_FORMAT_UNORM16 ? "unorm16"
                                          : "float32";
}

static void print_rates(FILE *stream, const char *method, stability_setting setting,
                        const stability_rates *rates) {
    fprintf(stream, "%s\t%s\t%llu\t%llu\t%.3f\t%.3f\t%.3f\t%.3f\t%.3f\n", method,
            stability_setting_name(setting), (unsigned long long)rates->lit,
            (unsigned long long)rates->shadowed, rates->false_shadow_far, rates->false_light_far,
            rates->false_shadow_near, rates->false_light_near, rates->wrong);
}

static void print_row(FILE *stream, const stability_row *row) {
    const stability_case *c = row->subject;
    fprintf(stream, "%s\t%s\t%s%s\t%u\t", c->name, c->group, format_name(c->format),
            c->reversed ? "-reversed" : "", (unsigned)row->map_size);
    print_rates(stream, row->method, row->setting, &row->rates);
}

/* What becomes of a method's mean. */
typedef void print_mean(FILE *stream, stability_mean over, const char *method,
                        stability_setting setting, const stability_rates *mean,
                        const stability_row *worst);

static void print_means_over(FILE *stream, const stability_rows *rows, stability_mean over,
                             print_mean *print) {
    listed_method method;
    for (size_t i = 0; method_list_at(i, &method); i++)
        for (stability_setting s = STABILITY_DEFAULT; s < STABILITY_SETTINGS; s++) {
            const stability_row *worst;
            const stability_rates mean = stability_rows_mean(rows, over, method.name, s, &worst);
            if (worst)
                print(stream, over, method.name, s, &mean, worst);
        }
}

/* Every mean that there are rows of. */
static void print_means(FILE *stream, const stability_rows *rows, print_mean *print) {
    for (stability_mean over = STABILITY_RESOLVED; over < STABILITY_MEANS; over++)
        print_means_over(stream, rows, over, print);
}

static void print_tsv_mean(FILE *stream, stability_mean over, const char *method,
                           stability_setting setting, const stability_rates *mean,
                           const stability_row *worst) {
    const char *name = stability_mean_name(over);
    (void)worst;
    fprintf(stream, "%s\t%s\t-\t-\t", name, name);
    print_rates(stream, method, setting, mean);
}

void stability_print_tsv(FILE *stream, const stability_rows *rows) {
    fprintf(stream, "case\tgroup\tformat\tmap_size\tmethod\tsetting\tlit\tshadowed\tfs_far_ppm\t"
                    "fl_far_ppm\tfs_near_ppm\tfl_near_ppm\twrong_ppm\n");
    for (size_t i = 0; i < rows->count; i++)
        print_row(stream, &rows->rows[i]);
    print_means(stream, rows, print_tsv_mean);
}

static double unsure_ppm(const stability_certain *certain) {
    return certain->fragments ? 1e6 * (double)certain->unsure / (double)certain->fragments : 0;
}

/* Sums over the cases of a mean; ppm: mean over those that have fragments. */
static stability_certain sum_certain(const stability_rows *rows, stability_mean over, double *ppm) {
    stability_certain sum = {0};
    size_t any = 0;
    *ppm = 0;
    for (size_t i = 0; i < rows->certain_count; i++) {
        const stability_certain *one = &rows->certain[i];
        if (!stability_mean_has(over, one->subject))
            continue;
        sum.fragments += one->fragments;
        sum.unsure += one->unsure;
        sum.false_shadow += one->false_shadow;
        sum.false_light += one->false_light;
        *ppm += unsure_ppm(one);
        any += one->fragments > 0;
    }
    *ppm /= any ? (double)any : 1;
    return sum;
}

static void print_certain(FILE *stream, const char *name, const char *group, double ppm,
                          const stability_certain *certain) {
    fprintf(stream, "%s\t%s\t%llu\t%llu\t%.3f\t%llu\t%llu\n", name, group,
            (unsigned long long)certain->fragments, (unsigned long long)certain->unsure, ppm,
            (unsigned long long)certain->false_shadow, (unsigned long long)certain->false_light);
}

void stability_print_certain(FILE *stream, const stability_rows *rows) {
    fprintf(stream, "case\tgroup\tfragments\tunsure\tunsure_ppm\tfalse_shadow\tfalse_light\n");
    for (size_t i = 0; i < rows->certain_count; i++) {
        const stability_certain *one = &rows->certain[i];
        print_certain(stream, one->subject->name, one->subject->group, unsure_ppm(one), one);
    }
    for (stability_mean over = STABILITY_RESOLVED; over < STABILITY_MEANS; over++) {
        double ppm;
        const stability_certain sum = sum_certain(rows, over, &ppm);
        const char *name = stability_mean_name(over);
        print_certain(stream, name, name, ppm, &sum);
    }
}

static void print_readable_mean(FILE *stream, stability_mean over, const char *method,
                                stability_setting setting, const stability_rates *mean,
                                const stability_row *worst) {
    fprintf(stream, "%-8s %-16s %-8s %10.1f %10.1f %10.1f %10.1f %10.1f  %s %.0f\n",
            stability_mean_name(over), method, stability_setting_name(setting),
            mean->false_shadow_far, mean->false_light_far, mean->false_shadow_near,
            mean->false_light_near, mean->wrong, worst->subject->name, worst->rates.wrong);
}

void stability_print_means(FILE *stream, const stability_rows *rows) {
    fprintf(stream, "means over cases, ppm; far and near: from true shadow boundaries\n");
    fprintf(stream, "%-8s %-16s %-8s %10s %10s %10s %10s %10s  %s\n", "cases", "method", "setting",
            "false", "false", "false", "false", "wrong", "worst case");
    fprintf(stream, "%-8s %-16s %-8s %10s %10s %10s %10s %10s\n", "", "", "", "shadow far",
            "light far", "shad. near", "light near", "in all");
    print_means(stream, rows, print_readable_mean);
    if (!rows->certain_count)
        return;
    double mean;
    const stability_certain sum = sum_certain(rows, STABILITY_ALL, &mean);
    fprintf(
        stream,
        "certain answers: %llu wrong of %llu fragments, %.2f %% unsure, %.2f %% mean over cases\n",
        (unsigned long long)(sum.false_shadow + sum.false_light), (unsigned long long)sum.fragments,
        1e-4 * unsure_ppm(&sum), 1e-4 * mean);
}
