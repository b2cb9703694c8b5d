#include "methods.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    shb_occluders occluders;
} exact_maps[] = {
    {"exact-planes", SHB_OCCLUDERS_PLANES},
    {"exact-triangles", SHB_OCCLUDERS_TRIANGLES},
    {"exact-lists", SHB_OCCLUDERS_LISTS},
};
enum { EXACT_MAPS = sizeof exact_maps / sizeof *exact_maps };

static bool is_exact(const shb_bias *bias) {
    return bias->needs & SHB_NEEDS_OCCLUDERS;
}

static bool is_among(const char *name, const char *const *names) {
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names != NULL;
}

static void add(report_methods *list, const char *name, const shb_bias *bias,
                const shb_filter *filter, shb_occluders occluders) {
    report_method *method = &list->methods[list->count++];
    *method = (report_method){.bias = *bias,
                              .with = *filter,
                              .occluders = occluders,
                              .soft = strcmp(filter->name, "hard") != 0};
    snprintf(method->name, sizeof method->name, "%s", name);
    snprintf(method->filter, sizeof method->filter, "%s", filter->name);
}

static void add_all(report_methods *list, const shb_bias *bias, const shb_filter *filter) {
    if (!is_exact(bias))
        add(list, bias->name, bias, filter, SHB_OCCLUDERS_NONE);
    for (size_t i = 0; is_exact(bias) && i < EXACT_MAPS; i++)
        add(list, exact_maps[i].name, bias, filter, exact_maps[i].occluders);
}

report_methods report_list_methods(void) {
    size_t bias_count;
    const shb_bias_method *biases = shb_bias_methods(&bias_count);
    const shb_filter hard = shb_filter_hard();
    report_methods list = {.methods = calloc(bias_count + EXACT_MAPS, sizeof(report_method))};
    for (size_t b = 0; list.methods && b < bias_count; b++) {
        const shb_bias bias = biases[b].make();
        add_all(&list, &bias, &hard);
    }
    return list;
}

report_family report_family_of(const char *method) {
    static const char *const planes[] = {"receiver-plane", "adaptive", "adaptive-soft", NULL};
    static const char *const layers[] = {"midpoint", "dual-layer", "back-face", NULL};
    if (strncmp(method, "exact", 5) == 0)
        return REPORT_EXACT;
    return is_among(method, planes)   ? REPORT_PLANES
           : is_among(method, layers) ? REPORT_LAYERS
                                      : REPORT_OFFSETS;
}

const char *report_family_name(report_family family) {
    static const char *const names[REPORT_FAMILIES] = {
        "constants and offsets", "the receiver's plane", "other depths in the map",
        "exact: the occluder is asked"};
    return names[family];
}
