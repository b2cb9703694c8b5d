#include "summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

double report_wrong_away(const report_row *row) {
    const double away = row->wrong_ppm - row->boundary_ppm;
    return away > 0 ? away : 0; /* the file has six digits of both */
}

double report_wrong(const report_row *row) {
    return row->wrong_ppm;
}

double report_rms(const report_row *row) {
    return row->rms;
}

double report_dissimilarity(const report_row *row) {
    return 1 - row->ssim;
}

bool report_is_hard(const report_row *row) {
    return strcmp(row->filter, "hard") == 0;
}

bool report_is_mean(const report_row *row) {
    return strcmp(row->scene, REPORT_ALL) == 0;
}

bool report_share_pair(const report_row *a, const report_row *b) {
    return strcmp(a->scene, b->scene) == 0 && strcmp(a->light, b->light) == 0 &&
           report_is_hard(a) == report_is_hard(b);
}

static bool share_method(const report_row *a, const report_row *b) {
    return a->map_size == b->map_size && strcmp(a->method, b->method) == 0 &&
           strcmp(a->filter, b->filter) == 0;
}

size_t report_count_pairs(const report_rows *rows, bool hard) {
    size_t count = 0;
    for (size_t i = 0; i < rows->count; i++) {
        bool seen = report_is_mean(&rows->rows[i]) || report_is_hard(&rows->rows[i]) != hard;
        for (size_t k = 0; !seen && k < i; k++)
            seen = report_share_pair(&rows->rows[k], &rows->rows[i]);
        count += !seen;
    }
    return count;
}

/* The mean of values that may be missing. */
typedef struct mean {
    double sum;
    size_t count;
} mean;

static void mean_add(mean *m, double value) {
    if (isnan(value))
        return;
    m->sum += value;
    m->count++;
}

static double mean_of(const mean *m) {
    return m->count ? m->sum / (double)m->count : (double)NAN;
}

typedef struct means {
    mean map, shading, visibility, memory, triangles, fragments; /* the first three: logarithms */
    mean false_shadow, false_light, boundary, wrong, rms, ssim, detachment;
} means;

static void means_add(means *m, const report_row *row) {
    mean_add(&m->map, log(row->map_ms));
    mean_add(&m->shading, log(row->shading_ms));
    mean_add(&m->visibility, log(row->ns_per_fragment));
    mean_add(&m->memory, (double)row->memory_bytes);
    mean_add(&m->triangles, (double)row->triangles);
    mean_add(&m->fragments, (double)row->fragments);
    mean_add(&m->false_shadow, row->false_shadow_ppm);
    mean_add(&m->false_light, row->false_light_ppm);
    mean_add(&m->boundary, row->boundary_ppm);
    mean_add(&m->wrong, row->wrong_ppm);
    mean_add(&m->rms, row->rms);
    mean_add(&m->ssim, row->ssim);
    mean_add(&m->detachment, row->detachment_texels);
}

static report_row row_of_means(const report_row *like, const means *m) {
    report_row row = *like;
    snprintf(row.scene, sizeof row.scene, "%s", REPORT_ALL);
    snprintf(row.light, sizeof row.light, "%s", REPORT_ALL);
    row.map_ms = exp(mean_of(&m->map));
    row.shading_ms = exp(mean_of(&m->shading));
    row.ns_per_fragment = exp(mean_of(&m->visibility));
    row.memory_bytes = (uint64_t)mean_of(&m->memory);
    row.triangles = (uint64_t)mean_of(&m->triangles);
    row.fragments = (uint64_t)mean_of(&m->fragments);
    row.false_shadow_ppm = mean_of(&m->false_shadow);
    row.false_light_ppm = mean_of(&m->false_light);
    row.boundary_ppm = mean_of(&m->boundary);
    row.wrong_ppm = mean_of(&m->wrong);
    row.rms = mean_of(&m->rms);
    row.ssim = mean_of(&m->ssim);
    row.detachment_texels = mean_of(&m->detachment);
    return row;
}

bool report_add_means(report_rows *rows) {
    const size_t count = rows->count;
    const size_t pairs[2] = {report_count_pairs(rows, false), report_count_pairs(rows, true)};
    bool room = true;
    for (size_t i = 0; room && i < count; i++) {
        means m = {0};
        size_t first = count, found = 0;
        for (size_t k = 0; k < count; k++)
            if (share_method(&rows->rows[k], &rows->rows[i])) {
                first = k < first ? k : first;
                found++;
                means_add(&m, &rows->rows[k]);
            }
        if (first != i || found != pairs[report_is_hard(&rows->rows[i])])
            continue;
        const report_row row = row_of_means(&rows->rows[i], &m);
        room = report_rows_add(rows, &row);
    }
    return room;
}

/* Below 0: the first one is more right; among equals the one with fewer wrong fragments in all. */
static int compare_errors(const report_row *a, const report_row *b, report_error_fn *error_of) {
    const double first = error_of(a), second = error_of(b);
    if (first != second)
        return first < second ? -1 : 1;
    return (a->wrong_ppm > b->wrong_ppm) - (a->wrong_ppm < b->wrong_ppm);
}

bool report_is_on_front(const report_rows *rows, const report_row *row, report_error_fn *error_of) {
    const double ms = report_row_ms(row);
    for (size_t i = 0; i < rows->count; i++) {
        const report_row *other = &rows->rows[i];
        if (!report_share_pair(other, row))
            continue;
        const double other_ms = report_row_ms(other);
        const int compared = compare_errors(other, row, error_of);
        if (other_ms <= ms && compared <= 0 && (other_ms < ms || compared < 0))
            return false;
    }
    return !isnan(error_of(row));
}

/* Of the means of a kind that take at most so many milliseconds; of several the fastest. */
static const report_row *least_error(const report_rows *rows, bool hard, report_error_fn *error_of,
                                     double ms) {
    const report_row *best = NULL;
    for (size_t i = 0; i < rows->count; i++) {
        const report_row *row = &rows->rows[i];
        if (!report_is_mean(row) || report_is_hard(row) != hard || report_row_ms(row) > ms)
            continue;
        const int compared = best ? compare_errors(row, best, error_of) : -1;
        if (compared < 0 || (compared == 0 && report_row_ms(row) < report_row_ms(best)))
            best = row;
    }
    return best;
}

const report_row *report_fastest(const report_rows *rows, bool hard, report_error_fn *error_of,
                                 double limit) {
    double ms = (double)INFINITY;
    for (size_t i = 0; i < rows->count; i++) {
        const report_row *row = &rows->rows[i];
        if (report_is_mean(row) && report_is_hard(row) == hard && error_of(row) <= limit)
            ms = fmin(ms, report_row_ms(row));
    }
    return isinf(ms) ? NULL : least_error(rows, hard, error_of, 1.1 * ms);
}

const report_row *report_most_exact(const report_rows *rows, bool hard, report_error_fn *error_of) {
    const report_row *nearest = least_error(rows, hard, error_of, (double)INFINITY);
    return nearest ? report_fastest(rows, hard, error_of, error_of(nearest)) : NULL;
}
