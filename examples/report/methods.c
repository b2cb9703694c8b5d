#include "methods.h"

#include "method_list.h"
#include "summary.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Filters with soft edges, and the methods of bias that go with them. */
static const char *const few[] = {"adaptive-soft", "exact-triangles", NULL};
static const char *const many[] = {"constant", "slope",         "normal-offset",   "receiver-plane",
                                   "adaptive", "adaptive-soft", "exact-triangles", NULL};
static const char *const adaptive[] = {"adaptive", "adaptive-soft", NULL};
static const struct {
    const char *filter;
    const char *const *biases;
} soft_filters[] = {
    {"pcf:size=5", many},
    {"pcf:size=11", few},
    {"pcf-smooth:size=5", few},
    {"jittered", few},
    {"poisson", few},
    {"pcss", many},
    {"variance", few},
    {"exponential-variance", few},
    {"moments", few},
    {"variance-soft", few},
    {"exponential-variance-soft", few},
    {"moments-soft", few},
    {"backprojection", adaptive},
    {"bitmask", adaptive},
};
enum { SOFT_FILTERS = sizeof soft_filters / sizeof *soft_filters, METHODS_MAX = 64 };

static void add(report_methods *list, const listed_method *listed, const char *filter) {
    report_method *method = &list->methods[list->count++];
    *method = (report_method){.bias = listed->method->make(), .occluders = listed->occluders};
    snprintf(method->name, sizeof method->name, "%s", listed->name);
    snprintf(method->filter, sizeof method->filter, "%s", filter);
}

static void add_hard(report_methods *list) {
    listed_method listed;
    for (size_t i = 0; method_list_at(i, &listed); i++)
        add(list, &listed, "hard");
}

static void add_soft(report_methods *list) {
    for (size_t i = 0; i < SOFT_FILTERS; i++)
        for (const char *const *bias = soft_filters[i].biases; *bias; bias++) {
            listed_method listed;
            shb_filter filter;
            if (method_list_named(*bias, &listed) &&
                shb_filter_parse(soft_filters[i].filter, &filter) == SHB_OK &&
                (filter.exact || !listed.occluders))
                add(list, &listed, soft_filters[i].filter);
        }
}

report_methods report_list_methods(bool soft) {
    report_methods list = {.methods = calloc(METHODS_MAX, sizeof(report_method))};
    if (list.methods && soft)
        add_soft(&list);
    else if (list.methods)
        add_hard(&list);
    return list;
}

shb_filter report_method_filter(const report_method *method, double light_width) {
    char text[96];
    shb_filter filter = shb_filter_hard();
    const char separator = strchr(method->filter, ':') ? ',' : ':';
    snprintf(text, sizeof text, "%s%clight=%g", method->filter, separator, light_width);
    if (shb_filter_parse(text, &filter) != SHB_OK)
        shb_filter_parse(method->filter, &filter);
    return filter;
}

static report_family family_of_bias(const char *method) {
    static const char *const planes[] = {"receiver-plane", "adaptive", "adaptive-soft", NULL};
    static const char *const layers[] = {"midpoint", "dual-layer", "back-face", NULL};
    if (strncmp(method, "exact", 5) == 0)
        return REPORT_EXACT;
    return tool_is_among(method, planes)   ? REPORT_PLANES
           : tool_is_among(method, layers) ? REPORT_LAYERS
                                           : REPORT_OFFSETS;
}

static report_family family_of_filter(const char *filter) {
    static const char *const moments[] = {"variance",
                                          "exponential-variance",
                                          "moments",
                                          "variance-soft",
                                          "exponential-variance-soft",
                                          "moments-soft",
                                          NULL};
    static const char *const texels[] = {"backprojection", "bitmask", NULL};
    if (strcmp(filter, "pcss") == 0)
        return REPORT_PLANES;
    return tool_is_among(filter, moments)  ? REPORT_LAYERS
           : tool_is_among(filter, texels) ? REPORT_EXACT
                                           : REPORT_OFFSETS;
}

report_family report_family_of(const report_row *row) {
    return report_is_hard(row) ? family_of_bias(row->method) : family_of_filter(row->filter);
}

const char *report_family_name(report_family family, bool hard) {
    static const char *const biases[REPORT_FAMILIES] = {
        "constants and offsets", "the receiver's plane", "other depths in the map",
        "exact: the occluder is asked"};
    static const char *const filters[REPORT_FAMILIES] = {
        "taps over a fixed size", "taps over the penumbra", "moments of distance",
        "texels before the light"};
    return hard ? biases[family] : filters[family];
}
