#include "methods.h"

#include "method_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_among(const char *name, const char *const *names) {
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names != NULL;
}

report_methods report_list_methods(void) {
    const shb_filter hard = shb_filter_hard();
    listed_method listed;
    size_t count = 0;
    while (method_list_at(count, &listed))
        count++;
    report_methods list = {.methods = calloc(count, sizeof(report_method))};
    for (; list.methods && method_list_at(list.count, &listed); list.count++) {
        report_method *method = &list.methods[list.count];
        *method = (report_method){
            .bias = listed.method->make(), .with = hard, .occluders = listed.occluders};
        snprintf(method->name, sizeof method->name, "%s", listed.name);
        snprintf(method->filter, sizeof method->filter, "%s", hard.name);
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
