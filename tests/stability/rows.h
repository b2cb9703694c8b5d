/* The results of the suite: one row a case, method and setting. */
#ifndef STABILITY_ROWS_H
#define STABILITY_ROWS_H

#include "cases.h"

#include "shadowbias/reference.h"

typedef enum stability_setting {
    STABILITY_DEFAULT = 0,
    STABILITY_TUNED,
    STABILITY_SETTINGS
} stability_setting;

typedef struct stability_rates {
    uint64_t lit, shadowed;
    double false_shadow_far, false_light_far; /* per million lit and shadowed fragments */
    double false_shadow_near, false_light_near;
    double wrong; /* per million of all fragments */
} stability_rates;

typedef struct stability_row {
    const stability_case *subject;
    const char *method;
    stability_setting setting;
    stability_rates rates;
    uint32_t map_size;
} stability_row;

/* What a map says for certain of a case's fragments. */
typedef struct stability_certain {
    const stability_case *subject;
    uint64_t fragments, unsure;
    uint64_t false_shadow, false_light; /* wrong all the same */
} stability_certain;

/* Rows in the order of cases, methods, settings. Zero-initialised is empty. */
typedef struct stability_rows {
    stability_row *rows;
    size_t count, capacity;
    stability_certain *certain; /* one a case */
    size_t certain_count, certain_capacity;
} stability_rows;

/* False: out of memory. */
bool stability_rows_add(stability_rows *rows, stability_row row);
bool stability_rows_add_certain(stability_rows *rows, stability_certain certain);
void stability_rows_free(stability_rows *rows);

stability_rates stability_rates_of(const shb_errors *errors);

const char *stability_setting_name(stability_setting setting);

/* Over the cases of a mean, of a method: fragments as sums, rates as means over the cases that have
 * such fragments. worst is the row with the highest rate of wrong fragments, NULL without rows. */
stability_rates stability_rows_mean(const stability_rows *rows, stability_mean over,
                                    const char *method, stability_setting setting,
                                    const stability_row **worst);

#endif
