#include "rows.h"

#include <stdlib.h>
#include <string.h>

/* The array with room for one more; NULL: out of memory, it is as it was. */
static void *grow(void *array, size_t count, size_t *capacity, size_t size) {
    if (count < *capacity)
        return array;
    const size_t wanted = *capacity ? 2 * *capacity : 256;
    void *grown = realloc(array, wanted * size);
    *capacity = grown ? wanted : *capacity;
    return grown;
}

bool stability_rows_add(stability_rows *rows, stability_row row) {
    stability_row *grown = grow(rows->rows, rows->count, &rows->capacity, sizeof row);
    if (!grown)
        return false;
    rows->rows = grown;
    rows->rows[rows->count++] = row;
    return true;
}

bool stability_rows_add_certain(stability_rows *rows, stability_certain certain) {
    stability_certain *grown =
        grow(rows->certain, rows->certain_count, &rows->certain_capacity, sizeof certain);
    if (!grown)
        return false;
    rows->certain = grown;
    rows->certain[rows->certain_count++] = certain;
    return true;
}

void stability_rows_free(stability_rows *rows) {
    free(rows->rows);
    free(rows->certain);
    *rows = (stability_rows){0};
}

static double per_million(uint64_t part, uint64_t all) {
    return all ? 1e6 * (double)part / (double)all : 0;
}

stability_rates stability_rates_of(const shb_errors *errors) {
    return (stability_rates){
        .lit = errors->lit,
        .shadowed = errors->shadowed,
        .false_shadow_far = errors->false_shadow_ppm,
        .false_light_far = errors->false_light_ppm,
        .false_shadow_near = per_million(errors->boundary_shadow, errors->lit),
        .false_light_near = per_million(errors->boundary_light, errors->shadowed),
        .wrong = errors->wrong_ppm,
    };
}

const char *stability_setting_name(stability_setting setting) {
    return setting == STABILITY_TUNED ? "tuned" : "default";
}

static double divide(double sum, size_t count) {
    return count ? sum / (double)count : 0;
}

stability_rates stability_rows_mean(const stability_rows *rows, stability_mean over,
                                    const char *method, stability_setting setting,
                                    const stability_row **worst) {
    stability_rates sum = {0};
    size_t lit = 0, shadowed = 0, any = 0;
    *worst = NULL;
    for (size_t i = 0; i < rows->count; i++) {
        const stability_row *row = &rows->rows[i];
        const stability_rates *rates = &row->rates;
        if (row->setting != setting || strcmp(row->method, method) != 0 ||
            !stability_mean_has(over, row->subject))
            continue;
        sum.lit += rates->lit;
        sum.shadowed += rates->shadowed;
        sum.false_shadow_far += rates->false_shadow_far;
        sum.false_shadow_near += rates->false_shadow_near;
        sum.false_light_far += rates->false_light_far;
        sum.false_light_near += rates->false_light_near;
        sum.wrong += rates->wrong;
        lit += rates->lit > 0;
        shadowed += rates->shadowed > 0;
        any += rates->lit + rates->shadowed > 0;
        if (!*worst || rates->wrong > (*worst)->rates.wrong)
            *worst = row;
    }
    sum.false_shadow_far = divide(sum.false_shadow_far, lit);
    sum.false_shadow_near = divide(sum.false_shadow_near, lit);
    sum.false_light_far = divide(sum.false_light_far, shadowed);
    sum.false_light_near = divide(sum.false_light_near, shadowed);
    sum.wrong = divide(sum.wrong, any);
    return sum;
}
